/* gzip_write.h: packs bytes as gzip; its checksum, by which reports name input files, too.
 * SPDX-License-Identifier: MIT */
#ifndef GZIP_WRITE_H
#define GZIP_WRITE_H

#include "base/byte_buffer.h"

typedef struct host_crc32 {
    uint32_t table[8][256]; /* [k][byte]: the byte's remainder, followed by k zero bytes */
    uint32_t state;
} host_crc32;

void host_crc32_start(host_crc32 *crc);
void host_crc32_add(host_crc32 *crc, const void *data, size_t n);
uint32_t host_crc32_end(const host_crc32 *crc);

/* The checksum of n bytes. */
uint32_t host_crc32_of(const void *data, size_t n);

/* Appends a gzip file of n bytes to the buffer, which stores failure. Packs runs and repeats, as label maps have them,
 * well, other data hardly. */
void host_gzip_write(const unsigned char *data, size_t n, host_buffer *out);

#endif
