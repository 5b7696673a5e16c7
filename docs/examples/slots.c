/* slots.c: saves in two slots of flash. Power that fails at any word of a save leaves the old one or the new one.
 * SPDX-License-Identifier: MIT */
#include <smr.h>
#include <stdio.h>
#include <string.h>

enum { NV = 60, UNIT = 8, SAVE = (SMR_SAVE_BYTES(NV, 1, 0, 0, SMR_METHOD_RIGID) / UNIT + 1) * UNIT };
static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 18], prepared[1 << 17], arena[1 << 16], saved[SAVE];
static const unsigned char erased[UNIT] = {255, 255, 255, 255, 255, 255, 255, 255};
static struct { uint32_t head[UNIT / 4]; unsigned char save[SAVE]; } flash[2], before[2]; /* head: serial number */
static uint32_t power = UINT32_MAX; /* units of flash that can still be erased or written; the last one is torn */

static int put(void *to, size_t at, const void *from)
{
    memcpy((char *)to + at, from, power > 1 ? UNIT : power * UNIT / 2);
    return (power -= power > 0) > 0;
}

/* Returns the slot of the newest whole save, 0 or 1. */
static int newest(uint32_t serial[2])
{
    smr_saved_info info;
    for (int k = 0; k < 2; k++)
        serial[k] = flash[k].head[0] == ~flash[k].head[1] && smr_save_info(flash[k].save, SAVE, &info) == SMR_OK
                        ? flash[k].head[0] : 0;
    return serial[1] > serial[0];
}

static int save(const smr *s)
{
    uint32_t serial[2], head[UNIT / 4] = {0};
    const int to = !newest(serial);
    if (smr_save(s, saved, SAVE) != SMR_OK) return 0;
    head[1] = ~(head[0] = serial[!to] + 1);
    for (size_t at = 0; at < sizeof flash[to]; at += UNIT) if (!put(&flash[to], at, erased)) return 0; /* head first */
    for (size_t at = 0; at < SAVE; at += UNIT) if (!put(flash[to].save, at, saved + at)) return 0;
    return put(flash[to].head, 0, head);
}

int main(void)
{
    const smr_structure points = {"points", {(float[3 * NV]){0}, NULL, NV, 0}};
    const smr_prepare_config prepare = smr_prepare_config_default();
    const smr_config config = smr_config_default();
    const smr_model *model;
    smr *s;
    size_t n;
    uint32_t serial[2], lost = 0, cut = 0;
    smr_status status = smr_prepare(&points, 1, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &n);
    if (status == SMR_OK) status = smr_model_open(prepared, n, &model);
    if (status == SMR_OK) status = smr_init(model, &config, NULL, arena, sizeof arena, &s);
    if (status != SMR_OK || !save(s) || smr_tick(s, 0, NULL) != SMR_OK || smr_save_bytes(s, &n) != SMR_OK) return 1;
    memcpy(before, flash, sizeof flash);
    for (int done = 0, k; !done; cut++) { /* the power fails after `cut` units; then the newest save is read */
        memcpy(flash, before, sizeof flash), power = cut;
        done = save(s), k = newest(serial);
        lost += serial[k] == 0 || memcmp(flash[k].save, k == 1 ? before[1].save : saved, n) != 0;
    }
    return printf("power fails at %u points of a save: %u lost\n", cut, lost) < 0 || lost > 0 || newest(serial) != 0;
}
