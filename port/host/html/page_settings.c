/* page_settings.c: the library's tables of settings, with the values of a registration.
 * SPDX-License-Identifier: MIT */
#include "html/page_settings.h"

#include <stdio.h>
#include <string.h>

#define VALUE_TEXT 512

/* One number, or the word of a choice. */
static int print_one(const smr_setting *s, double value, char *to, size_t bytes)
{
    const char *word = s->unit;
    if (s->kind == SMR_SETTING_SWITCH)
        return snprintf(to, bytes, "%s", value > 0.0 ? "on" : "off");
    if (s->kind != SMR_SETTING_CHOICE)
        return snprintf(to, bytes, "%.7g", value);
    for (; value >= 1.0 && strchr(word, '|') != NULL; value -= 1.0)
        word = strchr(word, '|') + 1;
    return snprintf(to, bytes, "%.*s", (int)strcspn(word, "|"), word);
}

/* The value of a setting in the struct at `base`; arrays as "a, b, c" up to the last that is not 0. */
static void print_value(const smr_setting *s, const void *base, char *to)
{
    const unsigned char *const at = (const unsigned char *)base + s->offset;
    const uint32_t n = s->bytes / 4u;
    uint32_t i = 0, used = 1;
    float number[64];
    size_t length = 0;
    to[0] = '\0';
    if (n == 0 || n > sizeof number / sizeof number[0])
        return;
    for (i = 0; i < n; i++) {
        uint32_t count = 0;
        memcpy(&number[i], at + 4u * (size_t)i, 4);
        memcpy(&count, at + 4u * (size_t)i, 4);
        if (s->kind != SMR_SETTING_NUMBER)
            number[i] = (float)count;
        if (number[i] > 0.0f || number[i] < 0.0f)
            used = i + 1u;
    }
    for (i = 0; i < used && length + 32u < VALUE_TEXT; i++) {
        length += (size_t)snprintf(to + length, VALUE_TEXT - length, "%s", i > 0 ? ", " : "");
        length += (size_t)print_one(s, (double)number[i], to + length, VALUE_TEXT - length);
    }
}

static void put_table(const smr_setting *s, uint32_t n, const void *now, const void *standard, host_json *json)
{
    const char *group = "";
    uint32_t i = 0;
    for (i = 0; i < n; i++) {
        char value[VALUE_TEXT], usual[VALUE_TEXT];
        if (s[i].kind == SMR_SETTING_GROUP)
            group = s[i].name;
        if (s[i].kind == SMR_SETTING_GROUP || s[i].kind == SMR_SETTING_POINTER)
            continue;
        print_value(&s[i], now, value);
        print_value(&s[i], standard, usual);
        host_json_open(json, NULL, '{');
        host_json_text(json, "group", group);
        host_json_text(json, "name", s[i].name);
        host_json_text(json, "unit", s[i].kind == SMR_SETTING_CHOICE ? "" : s[i].unit);
        host_json_text(json, "text", s[i].text);
        host_json_text(json, "value", value);
        host_json_text(json, "default", usual);
        host_json_close(json, '}');
    }
}

void host_page_settings(const host_options *options, const smr_config *config, int prepared, host_json *json)
{
    const smr_config standard = options->image_target ? smr_config_default_image() : smr_config_default();
    const smr_prepare_config prepare = smr_prepare_config_default();
    uint32_t n = 0;
    const smr_setting *s = smr_config_settings(&n);
    host_json_open(json, "settings", '[');
    put_table(s, n, config, &standard, json);
    s = smr_prepare_settings(&n);
    if (!prepared)
        put_table(s, n, &options->prepare, &prepare, json);
    host_json_close(json, ']');
}
