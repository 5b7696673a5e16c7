/* Growing bytes for output. Failure is remembered and asked for once, at the end.
 * SPDX-License-Identifier: MIT */
#ifndef BYTE_BUFFER_H
#define BYTE_BUFFER_H

#include <stddef.h>
#include <stdint.h>

#include "base/error_line.h"

typedef struct host_buffer {
    unsigned char *data; /* owned */
    size_t size, capacity;
    int failed; /* 1: memory ended; the content is not to be used */
} host_buffer;

/* Room for n more bytes at data + size; 0 on success. */
int host_buffer_reserve(host_buffer *buffer, size_t n);
void host_buffer_add(host_buffer *buffer, const void *bytes, size_t n);
void host_buffer_print(host_buffer *buffer, const char *format, ...) HOST_PRINTF(2, 3);
/* Little-endian. */
void host_buffer_u32(host_buffer *buffer, uint32_t value);
void host_buffer_f32(host_buffer *buffer, float value);
void host_buffer_free(host_buffer *buffer);

#endif
