/* byte_buffer.h: a growing array of bytes for output. A failure is stored; the caller checks `failed` once, at the end.
 * SPDX-License-Identifier: MIT */
#ifndef BYTE_BUFFER_H
#define BYTE_BUFFER_H

#include <stddef.h>
#include <stdint.h>

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

#endif
