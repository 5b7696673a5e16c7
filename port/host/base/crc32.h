/* crc32.h: the checksum by which reports name input files: CRC-32 of IEEE 802.3, as zlib, gzip and PNG have it.
 * SPDX-License-Identifier: MIT */
#ifndef CRC32_H
#define CRC32_H

#include <stddef.h>
#include <stdint.h>

typedef struct host_crc32 {
    uint32_t table[8][256]; /* [k][byte]: the byte's remainder, followed by k zero bytes */
    uint32_t state;
} host_crc32;

void host_crc32_start(host_crc32 *crc);
void host_crc32_add(host_crc32 *crc, const void *data, size_t n);
uint32_t host_crc32_end(const host_crc32 *crc);

#endif
