/* number_types.c: numbers from the bytes of a file: whole and floating-point, in either byte order.
 * SPDX-License-Identifier: MIT */
#include "base/number_types.h"

#include <stdint.h>
#include <string.h>

size_t host_type_bytes(host_type type)
{
    static const unsigned char bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 4, 8};
    return bytes[type];
}

static uint64_t gather(const unsigned char *bytes, size_t n, int big_endian)
{
    uint64_t v = 0;
    size_t i = 0;
    for (i = 0; i < n; i++)
        v = (v << 8) | bytes[big_endian ? i : n - 1u - i];
    return v;
}

static double from_bits(host_type type, uint64_t v)
{
    const uint32_t low = (uint32_t)v;
    float f = 0.0f;
    double d = 0.0;
    if (type == HOST_TYPE_F32) {
        memcpy(&f, &low, sizeof f);
        return (double)f;
    }
    memcpy(&d, &v, sizeof d);
    return d;
}

double host_type_read(host_type type, const unsigned char *bytes, int big_endian)
{
    const uint64_t v = gather(bytes, host_type_bytes(type), big_endian);
    switch (type) {
    case HOST_TYPE_I8: return v < 128u ? (double)v : (double)v - 256.0;
    case HOST_TYPE_I16: return v < 32768u ? (double)v : (double)v - 65536.0;
    case HOST_TYPE_I32: return v < 2147483648u ? (double)v : (double)v - 4294967296.0;
    case HOST_TYPE_I64: return v < (1ull << 63) ? (double)v : -(double)(~v + 1u);
    case HOST_TYPE_U8:
    case HOST_TYPE_U16:
    case HOST_TYPE_U32: return (double)v;
    case HOST_TYPE_F32:
    case HOST_TYPE_F64: return from_bits(type, v);
    case HOST_TYPE_NONE:
    default: return 0.0;
    }
}
