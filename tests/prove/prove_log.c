/* prove_log.c: smr_log_open() and smr_log_next() read nothing outside any bytes, and a record that is read advances
 * the reader within the log. Every length of the log, every length of a record, and any bytes; checksums hold always
 * or not. A record depends on the rest of the log alone, so one record is enough.
 * SPDX-License-Identifier: MIT */
#include "log/record/log_settings.c"
#include "log/replay/log_read.c"
#include "prove.h"

static unsigned char memory[SMR_LOG_FIXED + 4u * SMR_LOG_WORDS_V1 + 4u];
static uint32_t words; /* length of the content of the record that the log holds */

uint32_t smr_log_words(SMR_UNUSED uint32_t kind) { return words; }

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

static void any_record(uint32_t length)
{
    smr_log_reader reader = {memory + sizeof memory - length, length, 0, 0};
    smr_log_record record;
    if (smr_log_next(&reader, &record) == SMR_OK) {
        //@ assert reader.at <= reader.bytes;
        //@ assert reader.at > 0 || length == 0;
    }
}

/* n_config: as in prove_bytes(), or SMR_LOG_WORDS_V1. */
static void any_header(uint32_t length, uint32_t n_config, uint32_t version)
{
    unsigned char *log = memory + sizeof memory - length;
    smr_log_reader reader;
    smr_log_info info;
    PROVE_HOSTILE(log, length);
    if (length >= SMR_LOG_FIXED) {
        smr_log_put32(log + 4, version);
        if (n_config <= 4u)
            prove_bytes(log + 24, n_config);
        else
            smr_log_put32(log + 24, n_config);
    }
    if (smr_log_open(log, length, &reader, &info) == SMR_OK) {
        //@ assert reader.at <= reader.bytes;
    }
}

/* A configuration of one setting, row `row` of the table or, for row SMR_LOG_ROWS, one of any number and length, whose
 * value is `missing` words too short. A setting depends on the words from its head on alone, so one is enough. */
static void any_setting(size_t row, uint32_t missing)
{
    smr_config config;
    const uint32_t n = row < SMR_LOG_ROWS ? 1u + rows[row].n - missing : 1u;
    unsigned char *from = memory + sizeof memory - 4u * n;
    PROVE_HOSTILE(from, 4u * n);
    if (row < SMR_LOG_ROWS)
        smr_log_put32(from, rows[row].number | rows[row].n << 16);
    (void)smr_log_get_config(from, n, PROVE_ANY(2, 3), &config);
}

int main(void)
{
    PROVE_HOSTILE(memory, sizeof memory);
    for (words = 0; words <= SMR_LOG_WORDS; words++)
        for (uint32_t length = 0; length <= SMR_LOG_FRAME + 4u * words + 1u; length++)
            any_record(length);
    for (uint32_t n = 0; n <= 4u; n++)
        for (uint32_t more = 0; more <= 7u; more++)
            any_header(SMR_LOG_FIXED + more, n, 3);
    for (size_t row = 0; row <= SMR_LOG_ROWS; row++)
        for (uint32_t missing = 0; missing <= 1u; missing++)
            any_setting(row, row < SMR_LOG_ROWS && rows[row].n > 0u ? missing : 0u);
    for (uint32_t n = SMR_LOG_WORDS_V1 - 1u; n <= SMR_LOG_WORDS_V1; n++)
        any_header(sizeof memory, n, 1);
    for (uint32_t length = 0; length < SMR_LOG_FIXED + 4u; length++)
        any_header(length, 1, PROVE_ANY(0, UINT32_MAX));
    return 0;
}
