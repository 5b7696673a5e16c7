/* byte_buffer.c: a growing array of bytes for output.
 * SPDX-License-Identifier: MIT */
#include "base/byte_buffer.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_CAPACITY 4096u

int host_buffer_reserve(host_buffer *buffer, size_t n)
{
    size_t capacity = buffer->capacity < FIRST_CAPACITY ? FIRST_CAPACITY : buffer->capacity;
    if (buffer->failed)
        return -1;
    if (n <= buffer->capacity - buffer->size)
        return 0;
    while (capacity - buffer->size < n && capacity <= SIZE_MAX / 2u)
        capacity *= 2u;
    unsigned char *data = capacity - buffer->size < n ? NULL : realloc(buffer->data, capacity);
    if (data == NULL) {
        buffer->failed = 1;
        return -1;
    }
    buffer->data = data;
    buffer->capacity = capacity;
    return 0;
}

void host_buffer_add(host_buffer *buffer, const void *bytes, size_t n)
{
    if (host_buffer_reserve(buffer, n) != 0)
        return;
    memcpy(buffer->data + buffer->size, bytes, n);
    buffer->size += n;
}

void host_buffer_print(host_buffer *buffer, const char *format, ...)
{
    va_list list, again;
    va_start(list, format);
    va_copy(again, list);
    int n = vsnprintf(NULL, 0, format, list);
    va_end(list);
    if (n < 0) {
        buffer->failed = 1;
    } else if (host_buffer_reserve(buffer, (size_t)n + 1u) == 0) {
        (void)vsnprintf((char *)buffer->data + buffer->size, (size_t)n + 1u, format, again);
        buffer->size += (size_t)n;
    }
    va_end(again);
}

void host_buffer_u32(host_buffer *buffer, uint32_t value)
{
    unsigned char b[4];
    b[0] = (unsigned char)(value & 255u);
    b[1] = (unsigned char)((value >> 8) & 255u);
    b[2] = (unsigned char)((value >> 16) & 255u);
    b[3] = (unsigned char)(value >> 24);
    host_buffer_add(buffer, b, 4);
}

void host_buffer_f32(host_buffer *buffer, float value)
{
    uint32_t bits = 0;
    memcpy(&bits, &value, 4);
    host_buffer_u32(buffer, bits);
}

void host_buffer_free(host_buffer *buffer)
{
    free(buffer->data);
    memset(buffer, 0, sizeof *buffer);
}

size_t host_utf8_bytes(const char *text)
{
    const unsigned char *const c = (const unsigned char *)text;
    const size_t n = c[0] < 0x80 ? 1u : c[0] < 0xc2 ? 0u : c[0] < 0xe0 ? 2u : c[0] < 0xf0 ? 3u : c[0] < 0xf5 ? 4u : 0u;
    for (size_t i = 1; i < n; i++)
        if ((c[i] & 0xc0) != 0x80)
            return 0;
    if ((c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xf0 && c[1] < 0x90))
        return 0; /* longer than needed */
    if ((c[0] == 0xed && c[1] > 0x9f) || (c[0] == 0xf4 && c[1] > 0x8f))
        return 0; /* halves of pairs; beyond the last character */
    return n;
}

char host_clean_next(const char *text, size_t *bytes)
{
    const unsigned char c = (unsigned char)text[0];
    *bytes = host_utf8_bytes(text);
    if (*bytes == 0) {
        *bytes = 1;
        return '?';
    }
    return c < 32 || c == 127 ? ' ' : text[0];
}

void host_csv_text(host_buffer *out, const char *text, const char *tail)
{
    const char *const quote = strpbrk(text, ",;\"\r\n") != NULL ? "\"" : "";
    host_buffer_print(out, "%s", quote);
    for (; *text != '\0'; text++)
        host_buffer_add(out, *text == '"' ? "\"\"" : text, *text == '"' ? 2 : 1);
    host_buffer_print(out, "%s%s", tail, quote);
}

/* Bytes of the character at c, which is one that XML and its attributes keep as it is; 0: it is none. */
static size_t character(const unsigned char *c)
{
    const size_t n = host_utf8_bytes((const char *)c);
    if (n == 1u)
        return c[0] >= 0x20 && c[0] != 0x7f ? 1u : 0u;
    if (n == 3u && c[0] == 0xef && c[1] == 0xbf && c[2] > 0xbd)
        return 0; /* U+FFFE and U+FFFF */
    if (n == 2u && c[0] == 0xc2 && c[1] < 0xa0)
        return 0; /* the other control characters */
    return n;
}

/* escapes: 1 writes what cannot stand in XML, and per cent signs, as in a URI. */
static void put(host_buffer *out, const char *text, int escapes)
{
    const unsigned char *c = (const unsigned char *)text;
    while (*c != '\0') {
        const size_t n = character(c);
        if (n == 0 && !escapes)
            host_buffer_add(out, "?", 1);
        else if (n == 0 || (*c == '%' && escapes))
            host_buffer_print(out, "%%%02X", (unsigned)*c);
        else if (*c == '&')
            host_buffer_add(out, "&amp;", 5);
        else if (*c == '<')
            host_buffer_add(out, "&lt;", 4);
        else if (*c == '>')
            host_buffer_add(out, "&gt;", 4);
        else if (*c == '"')
            host_buffer_add(out, "&quot;", 6);
        else
            host_buffer_add(out, c, n);
        c += n > 0 ? n : 1u;
    }
}

void host_xml_text(host_buffer *out, const char *text) { put(out, text, 0); }

void host_xml_attribute(host_buffer *out, const char *key, const char *text)
{
    host_buffer_print(out, " %s=\"", key);
    put(out, text, 0);
    host_buffer_add(out, "\"", 1);
}

void host_xml_file(host_buffer *out, const char *key, const char *path)
{
    host_buffer_print(out, " %s=\"", key);
    put(out, path, 1);
    host_buffer_add(out, "\"", 1);
}
