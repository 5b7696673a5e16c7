/* fuzz_save.c: any bytes as the kept values of a save are refused, or restored and run without harm: positions stay
 * finite. The header is valid and the checksum is repaired first, so that the fuzzer gets past them; bytes that are
 * missing are those of a good save.
 * SPDX-License-Identifier: MIT */
#include "fuzz/fuzz_targets.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "property/rig.h"
#include "unit/unit_save.h"

#define FUZZ_SAVE_TICKS 4u

/* The save that the bytes change: their first one says which, seldom one with an image, whose noise takes long. */
static const unit_save *fuzz_saved(uint32_t first)
{
    static unit_save u[2]; /* made once, kept */
    const uint32_t k = first % 8u != 0u;
    if (u[k].bytes == 0u)
        unit_save_make(&u[k], k == 0u ? UNIT_SAVE_FEW : UNIT_SAVE_SURFACES);
    return &u[k];
}

static int fuzz_save_finite(const unit_save *u, const smr *s)
{
    static float xyz[3 * 200];
    int good = 1;
    for (uint32_t i = 0; i < 2u; i++)
        good &= smr_get_positions(s, i, xyz) == SMR_OK && rig_finite(xyz, u->ball[i].n_vertices);
    return good;
}

/* The bytes as kept values of this save. */
static int fuzz_save_of(const unit_save *u, const uint8_t *values, size_t size)
{
    static unsigned char saved[UNIT_SAVE_BYTES];
    size_t end = 0;
    const size_t first = unit_save_values(u->saved, &end);
    smr_status status;
    smr_verdict verdict;
    memcpy(saved, u->saved, u->bytes);
    if (size > 0u)
        memcpy(saved + first, values, size < end - first ? size : end - first);
    unit_save_seal(saved, u->bytes);
    smr *s = unit_save_restored(u, saved, u->bytes, 0, &status);
    if (s == NULL)
        return status == SMR_E_SAVE ? 0 : -1;
    (void)smr_set_surface(s, SMR_ALL, u->surface);
    if (u->what != UNIT_SAVE_SURFACES)
        (void)smr_set_volume(s, &u->volume);
    (void)smr_set_log(s, NULL, 0);
    int good = fuzz_save_finite(u, s);
    for (uint32_t i = 0; i < FUZZ_SAVE_TICKS && good; i++) {
        (void)smr_tick(s, 0, NULL);
        good = fuzz_save_finite(u, s);
    }
    (void)smr_get_verdict(s, SMR_ALL, &verdict);
    if (!good)
        (void)fprintf(stderr, "fuzz_save: a position is not finite\n");
    return good ? 1 : -1;
}

int fuzz_save(const uint8_t *data, size_t size)
{
    return size > 0u ? fuzz_save_of(fuzz_saved(data[0]), data + 1, size - 1u) : fuzz_save_of(fuzz_saved(1), NULL, 0);
}

SMR_FUZZER(fuzz_save)
