/* clean_text.h: texts that may hold any bytes, such as file names, for formats that may not.
 * SPDX-License-Identifier: MIT */
#ifndef CLEAN_TEXT_H
#define CLEAN_TEXT_H

#include <stddef.h>

/* Bytes of the UTF-8 character at text, 0 when it is none: cut off, longer than needed, half of a pair, beyond the last
 * character. text ends with a NUL. */
size_t host_utf8_bytes(const char *text);

/* The next character of a text: its first byte, with control characters as ' ' and what is no UTF-8 as '?'; *bytes: how
 * many to go on by. */
char host_clean_next(const char *text, size_t *bytes);

#endif
