/* page_data.c: base64 (RFC 4648), numbers as 16 bits, and the page around the data.
 * SPDX-License-Identifier: MIT */
#include "html/page_data.h"
#include <float.h>
#include <string.h>

#define UNKNOWN 65535u /* a value that is not known */
#define MOST 65534.0f  /* the largest value */

/* The page without its data: what stands before them and behind. Made from report_page.html by embed_page.sh. */
extern const unsigned char host_report_page_head[], host_report_page_tail[];
extern const size_t host_report_page_head_bytes, host_report_page_tail_bytes;

void host_page_bytes(host_json *json, const char *key, const void *bytes, size_t n)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *const b = bytes;
    host_buffer *const out = json->out;
    host_json_text(json, key, "");
    if (n > SIZE_MAX / 2u || host_buffer_reserve(out, n / 3u * 4u + 8u) != 0) {
        out->failed = 1;
        return;
    }
    out->size--; /* the closing quote */
    for (size_t i = 0; i < n; i += 3u) {
        const size_t left = n - i;
        const uint32_t v =
            (uint32_t)b[i] << 16 | (left > 1u ? (uint32_t)b[i + 1u] : 0u) << 8 | (left > 2u ? (uint32_t)b[i + 2u] : 0u);
        unsigned char *const to = out->data + out->size;
        to[0] = (unsigned char)digit[v >> 18];
        to[1] = (unsigned char)digit[v >> 12 & 63u];
        to[2] = (unsigned char)(left > 1u ? digit[v >> 6 & 63u] : '=');
        to[3] = (unsigned char)(left > 2u ? digit[v & 63u] : '=');
        out->size += 4u;
    }
    host_buffer_add(out, "\"", 1);
}

static void put_u16(host_buffer *out, uint32_t value)
{
    const unsigned char b[2] = {(unsigned char)(value & 255u), (unsigned char)(value >> 8 & 255u)};
    host_buffer_add(out, b, 2);
}

/* Adds the bytes and frees them. */
static void put_bytes(host_json *json, const char *key, host_buffer *bytes)
{
    host_page_bytes(json, key, bytes->data, bytes->size);
    json->out->failed |= bytes->failed;
    host_buffer_free(bytes);
}

void host_page_points(host_json *json, const char *key, const float *xyz, const uint32_t *keep, size_t n)
{
    host_buffer bytes = {0};
    host_box box = {0};
    for (size_t i = 0; i < n; i++)
        host_box_add(&box, xyz + 3u * (keep != NULL ? keep[i] : i), 1);
    for (size_t i = 0; i < 3u * n; i++) {
        const float v = xyz[3u * (keep != NULL ? keep[i / 3u] : i / 3u) + i % 3u] - box.low[i % 3u];
        const float side = box.high[i % 3u] - box.low[i % 3u];
        put_u16(&bytes, side > 0.0f ? (uint32_t)(v / side * 65535.0f + 0.5f) : 0u);
    }
    host_json_open(json, key, '{');
    host_json_list(json, "low", box.low, 3);
    host_json_list(json, "high", box.high, 3);
    put_bytes(json, "at", &bytes);
    host_json_close(json, '}');
}

void host_page_values(host_json *json, const char *key, const float *value, const uint32_t *keep, size_t n)
{
    host_buffer bytes = {0};
    float most = 0.0f;
    for (size_t i = 0; i < n; i++)
        if (value[keep[i]] > most && value[keep[i]] <= FLT_MAX)
            most = value[keep[i]];
    const float unit = most > 1e-6f ? most / MOST : 1e-6f;
    for (size_t i = 0; i < n; i++) {
        const float v = value[keep[i]] / unit;
        if (!(v >= 0.0f && v <= MOST + 1.0f)) /* written so that NaN is not known */
            put_u16(&bytes, UNKNOWN);
        else
            put_u16(&bytes, v < MOST ? (uint32_t)(v + 0.5f) : UNKNOWN - 1u);
    }
    host_json_open(json, key, '{');
    host_json_number(json, "unit", (double)unit);
    put_bytes(json, "at", &bytes);
    host_json_close(json, '}');
}

void host_page_triangles(host_json *json, const host_page_mesh *mesh)
{
    host_buffer bytes = {0};
    host_json_count(json, "vertices", mesh->n_vertices);
    host_json_count(json, "triangles", mesh->n_triangles);
    for (size_t i = 0; i < 3u * (size_t)mesh->n_triangles; i++)
        if (mesh->n_vertices <= 65536u)
            put_u16(&bytes, mesh->triangles[i]);
        else
            host_buffer_u32(&bytes, mesh->triangles[i]);
    put_bytes(json, "index", &bytes);
}

/* The value of a setting in the struct at `base`: a list of numbers. */
static void put_setting(const smr_setting *s, const void *base, const char *key, host_json *json)
{
    const unsigned char *const at = (const unsigned char *)base + s->offset;
    host_json_open(json, key, '[');
    for (uint32_t i = 0; i < s->bytes / 4u; i++) {
        float number = 0.0f;
        uint32_t count = 0;
        memcpy(&number, at + 4u * (size_t)i, 4);
        memcpy(&count, at + 4u * (size_t)i, 4);
        if (s->kind == SMR_SETTING_NUMBER)
            host_json_number(json, NULL, (double)number);
        else
            host_json_count(json, NULL, count);
    }
    host_json_close(json, ']');
}

static void put_table(const smr_setting *s, uint32_t n, const void *now, const void *standard, host_json *json)
{
    const char *group = "";
    for (uint32_t i = 0; i < n; i++) {
        if (s[i].kind == SMR_SETTING_GROUP)
            group = s[i].name;
        if (s[i].kind == SMR_SETTING_GROUP || s[i].kind == SMR_SETTING_POINTER)
            continue;
        host_json_open(json, NULL, '{');
        host_json_text(json, "group", group);
        host_json_text(json, "name", s[i].name);
        host_json_text(json, s[i].kind == SMR_SETTING_CHOICE ? "words" : "unit", s[i].unit);
        host_json_flag(json, "switch", s[i].kind == SMR_SETTING_SWITCH);
        host_json_text(json, "text", s[i].text);
        put_setting(&s[i], now, "value", json);
        put_setting(&s[i], standard, "default", json);
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

void host_page_write(const host_buffer *json, host_buffer *out)
{
    int text = 0, escaped = 0;
    host_buffer_add(out, host_report_page_head, host_report_page_head_bytes);
    for (size_t i = 0; i < json->size; i++) {
        const unsigned char c = json->data[i];
        if (c == '<')
            host_buffer_add(out, "\\u003c", 6);
        else if (text || (c != ' ' && c != '\n'))
            host_buffer_add(out, &c, 1);
        if (c == '"' && !escaped)
            text = !text;
        escaped = text && c == '\\' && !escaped;
    }
    host_buffer_add(out, host_report_page_tail, host_report_page_tail_bytes);
    out->failed |= json->failed;
}
