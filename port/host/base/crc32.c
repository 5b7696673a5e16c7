/* crc32.c: CRC-32 (polynomial 0xEDB88320, reflected), eight bytes at a time; "123456789" gives cbf43926.
 * Source: Kounavis and Berry 2005, slicing by 8.
 * SPDX-License-Identifier: MIT */
#include "base/crc32.h"

void host_crc32_start(host_crc32 *crc)
{
    uint32_t i = 0, k = 0;
    for (i = 0; i < 256; i++) {
        uint32_t left = i;
        for (k = 0; k < 8; k++)
            left = left >> 1 ^ ((left & 1u) != 0 ? 0xedb88320u : 0u);
        crc->table[0][i] = left;
    }
    for (k = 1; k < 8; k++)
        for (i = 0; i < 256; i++)
            crc->table[k][i] = crc->table[k - 1u][i] >> 8 ^ crc->table[0][crc->table[k - 1u][i] & 0xffu];
    crc->state = 0xffffffffu;
}

void host_crc32_add(host_crc32 *crc, const void *data, size_t n)
{
    const unsigned char *p = data;
    uint32_t(*const t)[256] = crc->table;
    uint32_t s = crc->state;
    for (; n >= 8u; n -= 8u, p += 8) {
        s ^= (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
        s = t[7][s & 0xffu] ^ t[6][s >> 8 & 0xffu] ^ t[5][s >> 16 & 0xffu] ^ t[4][s >> 24] ^ t[3][p[4]] ^ t[2][p[5]] ^
            t[1][p[6]] ^ t[0][p[7]];
    }
    for (; n > 0u; n--, p++)
        s = s >> 8 ^ t[0][(s ^ *p) & 0xffu];
    crc->state = s;
}

uint32_t host_crc32_end(const host_crc32 *crc) { return ~crc->state; }
