/* json_write.c: writes JSON: two spaces per level, one item per line; or all on one line.
 * SPDX-License-Identifier: MIT */
#include "report/json_write.h"
#include <inttypes.h>
#include <math.h>

static void put_text(host_json *json, const char *text)
{
    host_buffer_add(json->out, "\"", 1);
    while (*text != '\0') {
        const unsigned char c = (unsigned char)*text;
        const size_t n = host_utf8_bytes(text);
        if (c == '"' || c == '\\')
            host_buffer_print(json->out, "\\%c", c);
        else if (c < 32 || c == 127)
            host_buffer_print(json->out, "\\u%04x", c);
        else if (n == 0)
            host_buffer_add(json->out, "?", 1);
        else
            host_buffer_add(json->out, text, n);
        text += n > 0 ? n : 1u;
    }
    host_buffer_add(json->out, "\"", 1);
}

static void new_line(host_json *json)
{
    if (json->one_line)
        return;
    host_buffer_add(json->out, "\n", 1);
    for (int i = 0; i < json->depth; i++)
        host_buffer_add(json->out, "  ", 2);
}

static void start_item(host_json *json, const char *key)
{
    if (!json->fresh)
        host_buffer_add(json->out, ", ", json->one_line ? 2 : 1);
    if (json->depth > 0)
        new_line(json);
    json->fresh = 0;
    if (key != NULL) {
        put_text(json, key);
        host_buffer_add(json->out, ": ", 2);
    }
}

void host_json_open(host_json *json, const char *key, char bracket)
{
    start_item(json, key);
    host_buffer_add(json->out, &bracket, 1);
    json->depth++;
    json->fresh = 1;
}

int host_json_object(host_json *json, const char *key, int known)
{
    if (known)
        host_json_open(json, key, '{');
    else
        host_json_null(json, key);
    return known;
}

void host_json_close(host_json *json, char bracket)
{
    json->depth--;
    if (!json->fresh)
        new_line(json);
    host_buffer_add(json->out, &bracket, 1);
    json->fresh = 0;
    if (json->depth == 0)
        host_buffer_add(json->out, "\n", 1);
}

void host_json_text(host_json *json, const char *key, const char *value)
{
    start_item(json, key);
    put_text(json, value);
}

void host_json_count(host_json *json, const char *key, uint64_t value)
{
    start_item(json, key);
    host_buffer_print(json->out, "%" PRIu64, value);
}

void host_json_flag(host_json *json, const char *key, int value)
{
    start_item(json, key);
    host_buffer_print(json->out, "%s", value ? "true" : "false");
}

void host_json_number(host_json *json, const char *key, double value)
{
    start_item(json, key);
    if (isfinite(value))
        host_buffer_print(json->out, "%.7g", value);
    else
        host_buffer_print(json->out, "null");
}

void host_json_list(host_json *json, const char *key, const float *value, size_t n)
{
    host_json_open(json, key, '[');
    for (size_t i = 0; i < n; i++)
        host_json_number(json, NULL, (double)value[i]);
    host_json_close(json, ']');
}

void host_json_raw(host_json *json, const char *key, const host_buffer *value)
{
    start_item(json, key);
    host_buffer_add(json->out, value->data, value->size);
    json->out->failed |= value->failed;
}

void host_json_null(host_json *json, const char *key)
{
    start_item(json, key);
    host_buffer_print(json->out, "null");
}

void host_json_stats(host_json *json, const char *key, const host_stats *stats)
{
    if (!host_json_object(json, key, stats->n > 0))
        return;
    host_json_number(json, "mean", stats->mean);
    host_json_number(json, "rms", stats->rms);
    host_json_number(json, "p95", stats->p95);
    host_json_number(json, "max", stats->max);
    host_json_close(json, '}');
}
