/* Whole files in memory: reading with limits, .gz through the system's gzip.
 * SPDX-License-Identifier: MIT */
#ifndef FILE_READ_H
#define FILE_READ_H

#include <stddef.h>

#include "base/error_line.h"

/* Bytes: the largest file read. It holds the largest legal mesh as binary PLY. */
#define HOST_FILE_MAX ((size_t)160u << 20)
/* Bytes a compressed file may grow to: smaller, since a tiny file can claim it. */
#define HOST_UNPACKED_MAX ((size_t)128u << 20)
/* Bytes from the start of a file that a host_accept sees, at most. */
#define HOST_HEAD_BYTES 4096u

typedef struct host_bytes {
    unsigned char *data; /* owned; on a 64-byte address unless it was unpacked */
    size_t size;
} host_bytes;

/* Looks at the first bytes of a file; total is the file's size, 0 when it is not known (compressed).
 * Returns 0 to read on, -1 with the error filled to stop before a large file is read in vain. */
typedef int (*host_accept)(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error);

/* Reads a regular file; unpacks it when it starts like a gzip file. 0, or -1 with the error filled. */
int host_file_read(const char *path, host_accept accept, host_bytes *bytes, host_error *error);

/* 1 when this file was read by this run: results must not replace it. path need not be how it was named then. */
int host_file_was_read(const char *path);

/* The files read by this run so far, in the order in which they were opened; names as they were given then. */
size_t host_file_count(void);
const char *host_file_name(size_t i);

void host_file_free(host_bytes *bytes);

#endif
