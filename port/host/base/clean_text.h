/* clean_text.h: texts that may hold any bytes, such as file names, for formats that may not: CSV, XML.
 * SPDX-License-Identifier: MIT */
#ifndef CLEAN_TEXT_H
#define CLEAN_TEXT_H

#include <stddef.h>

#include "base/byte_buffer.h"

/* Bytes of the UTF-8 character at text, 0 when it is none: cut off, longer than needed, half of a pair, beyond the last
 * character. text ends with a NUL. */
size_t host_utf8_bytes(const char *text);

/* The next character of a text: its first byte, with control characters as ' ' and what is no UTF-8 as '?'; *bytes: how
 * many to go on by. */
char host_clean_next(const char *text, size_t *bytes);

/* Appends a text and the tail, which needs no quotes, as one field: within quotes, its own twice, where RFC 4180 or a
 * program that takes semicolons wants it. */
void host_csv_text(host_buffer *out, const char *text, const char *tail);

/* Appends a text, within an element or within an attribute's quotes. Control characters, bytes that are no UTF-8 and
 * characters that XML does not have become question marks. */
void host_xml_text(host_buffer *out, const char *text);

/* Appends ' key="text"'. */
void host_xml_attribute(host_buffer *out, const char *key, const char *text);

/* Likewise for the name of a file, in which readers decode %41: a per cent sign, control characters and bytes that are
 * no UTF-8 are written so, and the name that is read is the file's. */
void host_xml_file(host_buffer *out, const char *key, const char *path);

#endif
