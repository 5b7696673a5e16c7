/* number_types.h: number types as files name them, and numbers from a file's bytes.
 * SPDX-License-Identifier: MIT */
#ifndef NUMBER_TYPES_H
#define NUMBER_TYPES_H

#include <stddef.h>

typedef enum host_type {
    HOST_TYPE_NONE = 0,
    HOST_TYPE_I8,
    HOST_TYPE_U8,
    HOST_TYPE_I16,
    HOST_TYPE_U16,
    HOST_TYPE_I32,
    HOST_TYPE_U32,
    HOST_TYPE_I64,
    HOST_TYPE_F32,
    HOST_TYPE_F64
} host_type;

/* Bytes of one number of the type. */
size_t host_type_bytes(host_type type);

/* Converts one number from bytes in the given order. Whole numbers beyond 2^53 are rounded. */
double host_type_read(host_type type, const unsigned char *bytes, int big_endian);

#endif
