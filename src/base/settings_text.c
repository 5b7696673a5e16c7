/* settings_text.c: the tables of settings with their texts, for programs that print them; others do not link the texts.
 * SPDX-License-Identifier: MIT */
#include "base/settings.h"

/* Kinds that only the tables have: an INDEX is described as a COUNT, and a VECTOR as a NUMBER. */
#define SMR_SETTING_INDEX SMR_SETTING_COUNT
#define SMR_SETTING_VECTOR SMR_SETTING_NUMBER

/* Initialisers of parts of an smr_setting, from a row of a table, in the order of the struct. */
#define SMR_ROW_PLACE(type, kind, number, path)                                                                        \
    SMR_SETTING_##kind, (number), (uint32_t)offsetof(type, path), (uint32_t)sizeof(((type *)NULL)->path)
#define SMR_ROW_VALUES(low, high, ends, value, in_image)                                                               \
    SMR_ENDS_##ends == SMR_ENDS_OPEN, SMR_ENDS_##ends == SMR_ENDS_OR_ZERO, (double)(low), (double)(high),              \
        (double)(value), (double)(in_image)
#define SMR_ROW_TEXT(type, kind, number, path, name, unit, low, high, ends, value, in_image, text)                     \
    {#name, unit, text, SMR_ROW_PLACE(type, kind, number, path), SMR_ROW_VALUES(low, high, ends, value, in_image)},
#define SMR_ROW_TITLE(title) {title, "", "", SMR_SETTING_GROUP, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0, 0.0},

static const smr_setting config_settings[] = {
#define SMR_GROUP(title) SMR_ROW_TITLE(title)
#define SMR_SETTING(...) SMR_ROW_TEXT(smr_config, __VA_ARGS__)
#include "base/settings_config.def"
};

static const smr_setting prepare_settings[] = {
#define SMR_GROUP(title) SMR_ROW_TITLE(title)
#define SMR_SETTING(...) SMR_ROW_TEXT(smr_prepare_config, __VA_ARGS__)
#include "base/settings_prepare.def"
};

static const smr_setting *counted(const smr_setting *table, size_t bytes, uint32_t *n)
{
    if (n != NULL)
        *n = (uint32_t)(bytes / sizeof *table);
    return table;
}

const smr_setting *smr_config_settings(uint32_t *n) { return counted(config_settings, sizeof config_settings, n); }
const smr_setting *smr_prepare_settings(uint32_t *n) { return counted(prepare_settings, sizeof prepare_settings, n); }
