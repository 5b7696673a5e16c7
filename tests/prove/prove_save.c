/* prove_save.c: the reader of saves. smr_save_info() reads nothing outside any bytes, whatever lengths they state; each
 * kind of value is read within the saved bytes and stored within its slot, or marks the save as wrong.
 * SPDX-License-Identifier: MIT */
#include "base/save_fields.c"
#include "log/record/log_settings.c"
#include "registration/api/restore.c"
#include "prove.h"

#define PROVE_BYTES 20u /* bytes of a save's values */

static unsigned char memory[SMR_SAVED_FIXED + 6u], kept[PROVE_BYTES];
static uint32_t slot[PROVE_BYTES];

smr_config smr_config_default(void)
{
    static smr_config config;
    return config;
}

uint32_t smr_crc32(SMR_UNUSED uint32_t crc, const void *data, size_t n)
{
    //@ assert n == 0 || \valid_read((const char *)data + (0 .. n - 1));
    return PROVE_ANY(0, UINT32_MAX);
}

/* stated: bytes that the header states, or 256 for any number from 256 on; n_config: as in prove_bytes(). */
static void any_header(uint32_t length, uint32_t stated, uint32_t n_config)
{
    unsigned char *saved = memory + sizeof memory - length;
    smr_saved_info info;
    PROVE_HOSTILE(saved, length);
    if (length >= SMR_SAVED_FIXED) {
        smr_log_put32(saved + 4u * SMR_SAVED_AT_BYTES, stated);
        if (stated == 256u)
            prove_bytes(saved + 4u * SMR_SAVED_AT_BYTES, 2);
        prove_bytes(saved + 4u * SMR_SAVED_AT_CONFIG_WORDS, n_config);
    }
    if (smr_save_info(saved, length, &info) == SMR_OK) {
        //@ assert info.bytes <= length;
    }
}

/* A slot of `count` values, at the end of the memory of slots; values from byte `at` of the save on. */
static void any_values(uint32_t mode, uint32_t at, uint32_t count, int stored)
{
    smr_keeper k = {.mode = mode, .from = kept, .at = at, .bytes = PROVE_BYTES};
    uint32_t *end = slot + PROVE_BYTES;
    words(&k, stored ? end - count : NULL, count, PROVE_ANY(0, UINT32_MAX), (int)PROVE_ANY(0, 1));
    //@ assert k.wrong != 0 || k.at <= k.bytes;
    k.at = at;
    k.wrong = 0;
    floats(&k, stored ? (float *)end - count : NULL, count, -1.0f, 1.0f);
    //@ assert k.wrong != 0 || k.at <= k.bytes;
    k.at = at;
    k.wrong = 0;
    bytes(&k, stored ? (uint8_t *)end - count : NULL, count, PROVE_ANY(0, 255));
    //@ assert k.wrong != 0 || k.at <= k.bytes;
}

int main(void)
{
    PROVE_HOSTILE(kept, sizeof kept);
    for (uint32_t length = SMR_SAVED_FIXED - 1u; length <= sizeof memory; length++)
        for (uint32_t n = 0; n <= 4u; n++) {
            any_header(length, SMR_SAVED_FIXED + 3u, n);
            any_header(length, length, n);
            any_header(length, length + 1u, n);
            any_header(length, 256, n);
        }
    for (uint32_t left = 0; left <= 9u; left += 3u)
        for (uint32_t count = 0; count <= 9u; count += 1u + (count > 3u)) {
            any_values(SMR_KEEP_CHECK, PROVE_BYTES - left, count, 0);
            any_values(SMR_KEEP_RESTORE, PROVE_BYTES - left, count, 1);
        }
    any_values(SMR_KEEP_CHECK, PROVE_BYTES + 1u, 0, 0);
    any_values(SMR_KEEP_CHECK, PROVE_ANY(0, PROVE_BYTES), PROVE_ANY(PROVE_BYTES + 1u, UINT32_MAX), 0);
    return 0;
}
