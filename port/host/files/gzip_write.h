/* gzip_write.h: packs bytes as a gzip file.
 * SPDX-License-Identifier: MIT */
#ifndef GZIP_WRITE_H
#define GZIP_WRITE_H

#include "base/byte_buffer.h"

/* Appends a gzip file of n bytes to the buffer, which stores failure. Packs runs and repeats, as label maps have them,
 * well, other data hardly. */
void host_gzip_write(const unsigned char *data, size_t n, host_buffer *out);

#endif
