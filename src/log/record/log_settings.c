/* log_settings.c: the configuration in a log's header. Versions 2 and 3 write each setting with its number in the table
 * of settings; a missing setting has its default, but settle_share and strain_most 0 where settle_share is missing, and
 * image.rest and forces.curvature 0.
 * reference_prior, budget_exact and strain_most are written only where they differ from the default. Before
 * version 3 every target was whole. Version 1 has the struct of library 0.1 as it lay in memory: its words are the
 * numbers up to 44, with the cookie as word 0.
 * Bounds: SMR_LOG_CONFIG_WORDS words, the table's rows for each of them.
 * SPDX-License-Identifier: MIT */
#include "base/settings.h"
#include "log/record/log_format.h"

#define SMR_LOG_WORDS_V1 45u /* number of 32-bit words of the configuration in a log of version 1 */
#define SMR_LOG_COVERAGE 3u  /* first version of logs with partial targets; in older logs targets are whole */

typedef struct log_row {
    uint32_t number, offset, n; /* the setting's number, offset in smr_config, and number of words; 0: not in logs */
} log_row;

static const log_row rows[] = {
#define SMR_GROUP(title)
#define SMR_SETTING(kind, number, path, name, unit, low, high, ends, value, in_image, text)                            \
    {number, (uint32_t)offsetof(smr_config, path),                                                                     \
     (number) > 0 ? (uint32_t)(sizeof(((smr_config *)NULL)->path) / 4u) : 0u},
#include "base/settings_config.def"
};

#define SMR_LOG_ROWS (sizeof rows / sizeof rows[0])
#define SMR_LOG_VISITED_WORDS ((SMR_LOG_ROWS + 31u) / 32u) /* words of a set of settings, a bit for each */

/* Numbers of the settings in the order in which logs hold the settings, which is that of library 0.2. */
static const uint8_t written[] = {1,  2,  29, 43, 44, 38, 7,  45, 4,  5,  6,  50, 46, 48, 49, 47, 20, 21, 23,
                                  24, 25, 27, 3,  8,  9,  10, 11, 19, 22, 26, 28, 12, 13, 16, 30, 31, 32, 33,
                                  35, 34, 36, 37, 41, 42, 39, 40, 60, 61, 62, 63, 64, 65, 55, 56, 57, 58, 59,
                                  75, 69, 70, 71, 72, 73, 76, 66, 67, 68, 51, 52, 53, 77, 54, 78, 74, 79};

_Static_assert(sizeof written == SMR_LOG_ROWS - 1u, "every setting but attract is written");

/* Returns the index of the row with this number; SMR_LOG_ROWS when no row has the number. */
static size_t row_of(uint32_t number)
{
    size_t i = 0;
    while (i < SMR_LOG_ROWS && rows[i].number != number)
        i++;
    return i;
}

void smr_log_put_config(unsigned char *to, const smr_config *config)
{
    for (size_t i = 0; i < sizeof written; i++) {
        const log_row *row = &rows[row_of(written[i])];
        if ((row->number == SMR_LOG_EXACT && !config->basic.budget_exact) ||
            (row->number == SMR_LOG_PRIOR && !smr_log_has_prior(config)) ||
            (row->number == SMR_LOG_STRAIN && !smr_log_has_strain(config)))
            continue;
        smr_log_put32(to, row->number | row->n << 16);
        to += 4;
        for (uint32_t k = 0; k < row->n; k++, to += 4) {
            uint32_t word;
            memcpy(&word, (const unsigned char *)config + row->offset + 4u * k, sizeof word);
            smr_log_put32(to, word);
        }
    }
}

static void set(smr_config *config, const log_row *row, const unsigned char *from)
{
    for (uint32_t k = 0; k < row->n; k++) {
        const uint32_t word = smr_log_get32(from + 4u * k);
        memcpy((unsigned char *)config + row->offset + 4u * k, &word, sizeof word);
    }
}

static smr_status get_numbered(const unsigned char *from, uint32_t n_words, smr_config *config)
{
    uint32_t visited[SMR_LOG_VISITED_WORDS] = {0};
    for (uint32_t at = 0; at < n_words;) {
        const uint32_t head = smr_log_get32(from + 4u * at);
        const size_t i = row_of(head & 0xffffu);
        if (i == SMR_LOG_ROWS || rows[i].n == 0u || head >> 16 != rows[i].n ||
            (visited[i / 32u] >> i % 32u & 1u) != 0u || n_words - at - 1u < rows[i].n)
            return SMR_E_LOG;
        visited[i / 32u] |= 1u << i % 32u;
        set(config, &rows[i], from + 4u * ((size_t)at + 1u));
        if (rows[i].number == SMR_LOG_SETTLE) /* written before strain_most, by libraries that know both */
            config->motion.strain_most = SMR_STRAIN;
        at += 1u + rows[i].n;
    }
    return SMR_OK;
}

smr_status smr_log_get_config(const unsigned char *from, uint32_t n_words, uint32_t version, smr_config *config)
{
    *config = smr_config_default();
    config->motion.settle_share = config->motion.strain_most = 0.0f; /* older logs have none of the three */
    config->image.rest = 0;
    config->forces.curvature = 0.0f;
    if (version < SMR_LOG_COVERAGE)
        config->partial.coverage = SMR_COVERAGE_WHOLE;
    if (version == 2u || version == SMR_LOG_VERSION)
        return get_numbered(from, n_words, config);
    if (version != 1u || n_words != SMR_LOG_WORDS_V1)
        return SMR_E_LOG;
    for (size_t i = 0; i < SMR_LOG_ROWS; i++)
        if (rows[i].number + rows[i].n <= SMR_LOG_WORDS_V1)
            set(config, &rows[i], from + 4u * (size_t)rows[i].number);
    return SMR_OK;
}
