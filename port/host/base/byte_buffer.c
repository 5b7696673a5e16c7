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
