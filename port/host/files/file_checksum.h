/* file_checksum.h: whether a file is still the one that a report names.
 * SPDX-License-Identifier: MIT */
#ifndef FILE_CHECKSUM_H
#define FILE_CHECKSUM_H

#include <stdint.h>

/* 1 when the path leads to a regular file of so many bytes with this checksum (base/crc32.h). Does not count as
 * reading it (files/file_read.h). */
int host_file_is(const char *path, uint64_t bytes, uint32_t crc32);

#endif
