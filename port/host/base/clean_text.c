/* clean_text.c: texts that may hold any bytes, such as file names, for formats that may not.
 * SPDX-License-Identifier: MIT */
#include "base/clean_text.h"

size_t host_utf8_bytes(const char *text)
{
    const unsigned char *const c = (const unsigned char *)text;
    const size_t n = c[0] < 0x80 ? 1u : c[0] < 0xc2 ? 0u : c[0] < 0xe0 ? 2u : c[0] < 0xf0 ? 3u : c[0] < 0xf5 ? 4u : 0u;
    size_t i = 0;
    for (i = 1; i < n; i++)
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
