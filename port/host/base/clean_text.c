/* clean_text.c: texts that may hold any bytes, such as file names, for formats that may not.
 * SPDX-License-Identifier: MIT */
#include "base/clean_text.h"

#include <string.h>

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
