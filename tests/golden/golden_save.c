/* golden_save.c: interrupts a golden registration.
 * SPDX-License-Identifier: MIT */
#include "golden_save.h"
#include "golden.h"
#include <string.h>

enum { HEAD_BYTES = 16, CHECKSUM_BYTES = 4 }; /* magic, format, size, version of the library; the checksum at the end */

smr_status golden_interrupt(golden_saves *saves, const golden_inputs *inputs, smr **s)
{
    unsigned char *const saved = saves->memory + saves->used;
    const size_t left = saves->bytes - saves->used;
    smr_saved_info info;
    smr_config config;
    unsigned char *const made = saves->given ? inputs->arena : saved;
    smr_status status = smr_save(*s, made, saves->given ? inputs->arena_bytes : left);
    if (status == SMR_OK)
        status = smr_save_info(saved, left, &info);
    if (status == SMR_OK && memcmp(made, saved, info.bytes) != 0)
        status = SMR_E_STATE;
    if (status != SMR_OK)
        return status;
    config = info.config;
    config.basic.n_workers = 1;
    status = smr_restore(inputs->model, &config, NULL, saved, left, inputs->arena, inputs->arena_bytes, s);
    if (status == SMR_OK && inputs->target != NULL)
        status = smr_set_surface(*s, SMR_ALL, inputs->target);
    if (status == SMR_OK && inputs->volume != NULL)
        status = smr_set_volume(*s, inputs->volume);
    saves->used += info.bytes;
    saves->checksums ^= golden_crc(saved + HEAD_BYTES, info.bytes - HEAD_BYTES - CHECKSUM_BYTES);
    return status;
}
