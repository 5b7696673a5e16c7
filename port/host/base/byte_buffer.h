/* byte_buffer.h: a growing array of bytes for output: a failure is stored, and the caller checks `failed` once, at the
 * end; texts that may hold any bytes, such as file names, for formats that may not: CSV, XML.
 * SPDX-License-Identifier: MIT */
#ifndef BYTE_BUFFER_H
#define BYTE_BUFFER_H

#include <stddef.h>
#include "base/error_line.h"

typedef struct host_buffer {
    unsigned char *data; /* owned */
    size_t size, capacity;
    int failed; /* 1: out of memory; the content is invalid */
} host_buffer;

/* Reserves n more bytes at data + size. 0, or -1 when out of memory. */
int host_buffer_reserve(host_buffer *buffer, size_t n);
void host_buffer_add(host_buffer *buffer, const void *bytes, size_t n);
void host_buffer_print(host_buffer *buffer, const char *format, ...) HOST_PRINTF(2, 3);
/* Appends the value in little-endian order. */
void host_buffer_u32(host_buffer *buffer, uint32_t value);
void host_buffer_f32(host_buffer *buffer, float value);
void host_buffer_free(host_buffer *buffer);

/* Bytes of the UTF-8 character at text, 0 when it is none: cut off, longer than needed, half of a pair, beyond the last
 * character. text ends with a NUL. */
size_t host_utf8_bytes(const char *text);

/* The next character of a text: its first byte, with control characters as ' ' and what is no UTF-8 as '?'; *bytes: its
 * length. */
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
