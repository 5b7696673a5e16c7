/* page_bytes.c: base64, ASCII JSON, and numbers as 16 bits, little-endian.
 * SPDX-License-Identifier: MIT */
#include "html/page_bytes.h"

#include <float.h>
#include <math.h>

#define LINE 96u      /* bytes in one line of base64 */
#define NONE 65535u   /* what is not known */
#define MOST 65534.0f /* the largest value */

void host_page_base64(host_buffer *out, const unsigned char *bytes, size_t n)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t i = 0;
    if (n > SIZE_MAX / 2u || host_buffer_reserve(out, n / 3u * 4u + n / LINE + 8u) != 0) {
        out->failed = 1;
        return;
    }
    for (i = 0; i < n; i += 3u) {
        const size_t left = n - i;
        const uint32_t b1 = left > 1u ? bytes[i + 1u] : 0u, b2 = left > 2u ? bytes[i + 2u] : 0u;
        const uint32_t v = (uint32_t)bytes[i] << 16 | b1 << 8 | b2;
        unsigned char *const to = out->data + out->size;
        to[0] = (unsigned char)digit[v >> 18];
        to[1] = (unsigned char)digit[v >> 12 & 63u];
        to[2] = (unsigned char)(left > 1u ? digit[v >> 6 & 63u] : '=');
        to[3] = (unsigned char)(left > 2u ? digit[v & 63u] : '=');
        out->size += 4u;
        if (i % LINE == LINE - 3u)
            out->data[out->size++] = '\n';
    }
}

/* Reads one character of UTF-8. Returns its bytes, 0 when they are none: too long, of a surrogate, cut off. */
static size_t read_utf8(const unsigned char *c, size_t n, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t bytes = c[0] < 0x80   ? 1u
                         : c[0] < 0xc2 ? 0u
                         : c[0] < 0xe0 ? 2u
                         : c[0] < 0xf0 ? 3u
                         : c[0] < 0xf5 ? 4u
                                       : 0u;
    size_t i = 0;
    if (bytes == 0 || bytes > n)
        return 0;
    *code = bytes == 1u ? c[0] : c[0] & (0xffu >> (bytes + 1u));
    for (i = 1; i < bytes; i++) {
        if ((c[i] & 0xc0) != 0x80)
            return 0;
        *code = *code << 6 | (c[i] & 0x3fu);
    }
    return *code < least[bytes] || *code > 0x10ffff || (*code >= 0xd800 && *code < 0xe000) ? 0 : bytes;
}

static void put_code(host_buffer *out, uint32_t code)
{
    if (code >= 0x10000) {
        host_buffer_print(out, "\\u%04x", (unsigned)(0xd800u + ((code - 0x10000u) >> 10)));
        code = 0xdc00u + ((code - 0x10000u) & 0x3ffu);
    }
    host_buffer_print(out, "\\u%04x", (unsigned)code);
}

void host_page_json(host_buffer *out, const unsigned char *json, size_t n)
{
    size_t i = 0;
    int text = 0, escaped = 0;
    while (i < n) {
        uint32_t code = '?';
        const size_t bytes = read_utf8(json + i, n - i, &code);
        const unsigned char c = json[i];
        i += bytes > 0 ? bytes : 1u;
        if (bytes == 0)
            host_buffer_add(out, "?", 1);
        else if (code > 126 || code == '<' || code == '>' || code == '&')
            put_code(out, code);
        else if (text || (code != ' ' && code != '\n'))
            host_buffer_add(out, &c, 1);
        if (c == '"' && !escaped)
            text = !text;
        escaped = text && c == '\\' && !escaped;
    }
}

static void put_u16(host_buffer *out, uint32_t value)
{
    unsigned char b[2];
    b[0] = (unsigned char)(value & 255u);
    b[1] = (unsigned char)(value >> 8 & 255u);
    host_buffer_add(out, b, 2);
}

double host_page_values(host_buffer *out, const float *value, size_t n)
{
    float most = 0.0f, unit = 0.0f;
    size_t i = 0;
    for (i = 0; i < n; i++)
        if (value[i] > most && value[i] <= FLT_MAX)
            most = value[i];
    unit = most > 1e-6f ? most / MOST : 1e-6f;
    for (i = 0; i < n; i++) {
        const float v = value[i] / unit;
        if (!(v >= 0.0f && v <= MOST + 1.0f)) /* written so that NaN is none */
            put_u16(out, NONE);
        else
            put_u16(out, v < MOST ? (uint32_t)(v + 0.5f) : NONE - 1u);
    }
    return (double)unit;
}

host_page_box host_page_box_empty(void)
{
    return (host_page_box){{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
}

void host_page_box_add(host_page_box *box, const float *xyz, size_t n)
{
    size_t i = 0;
    int c = 0;
    for (i = 0; i < n; i++)
        for (c = 0; c < 3; c++) {
            const float v = xyz[3u * i + (size_t)c];
            box->low[c] = v < box->low[c] ? v : box->low[c];
            box->high[c] = v > box->high[c] ? v : box->high[c];
        }
}

float host_page_box_side(const host_page_box *box)
{
    float most = 0.0f;
    int c = 0;
    for (c = 0; c < 3; c++)
        if (box->high[c] >= box->low[c] && box->high[c] - box->low[c] > most)
            most = box->high[c] - box->low[c];
    return most;
}

void host_page_points(host_buffer *out, const host_page_box *box, const float *xyz, const uint32_t *keep, size_t n)
{
    size_t i = 0, c = 0;
    for (i = 0; i < n; i++)
        for (c = 0; c < 3u; c++) {
            const float side = box->high[c] - box->low[c];
            const float v = xyz[3u * (keep != NULL ? keep[i] : i) + c];
            const float share = side > 0.0f ? (v - box->low[c]) / side : 0.0f;
            put_u16(out, share > 0.0f ? share < 1.0f ? (uint32_t)(share * 65535.0f + 0.5f) : 65535u : 0u);
        }
}
