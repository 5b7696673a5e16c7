/* file_read.h: reads whole files into memory, with size limits; .gz files through the system's gzip.
 * SPDX-License-Identifier: MIT */
#ifndef FILE_READ_H
#define FILE_READ_H

#include <stddef.h>
#include "base/error_line.h"

/* Largest file read, bytes. The largest legal mesh as binary PLY fits. */
#define HOST_FILE_MAX ((size_t)160u << 20)
/* Largest size of a compressed file after unpacking, bytes: smaller, since a tiny file may unpack to this size. */
#define HOST_UNPACKED_MAX ((size_t)128u << 20)
/* A host_accept sees at most this many bytes from the start of a file. */
#define HOST_HEAD_BYTES 4096u

typedef struct host_bytes {
    unsigned char *data; /* owned; 64-byte aligned unless it was unpacked */
    size_t size;
} host_bytes;

/* The start of a file. */
typedef struct host_head {
    const char *path;
    const unsigned char *data; /* [n] */
    size_t n, total;           /* total: the file's size, 0 when unknown (compressed) */
} host_head;

/* Decides by the start of a file. Returns 0 to read on, -1 with the error filled to stop before reading it all. */
typedef int (*host_accept)(const host_head *head, host_error *error);

/* Reads a regular file and unpacks it when it is a gzip file. 0, or -1 with the error filled. */
int host_file_read(const char *path, host_accept accept, host_bytes *bytes, host_error *error);

/* 1 when this run has read the file, under this path or another: results must not replace it. */
int host_file_was_read(const char *path);

/* A file that this run has read: its name as it was given, and its bytes on disk, packed or not. */
typedef struct host_input {
    const char *path; /* stays until the program ends or forgets it */
    uint64_t bytes;
    uint32_t crc32; /* 0 unless host_file_keep_checksums() was called before */
} host_input;

/* The files that this run has read so far, in the order of opening. */
size_t host_file_count(void);

/* Forgets files from number first on, as if they had not been read. */
void host_file_forget(size_t first);

/* From here on files that are read get a checksum, which costs time. */
void host_file_keep_checksums(void);

/* Those files but numbers first to end - 1, sorted by name, each once. Returns their number, or -1 when out of memory;
 * free(*inputs). */
int host_file_list(size_t first, size_t end, host_input **inputs);

/* Calls take(context, block, n) for the blocks of an open file, of a multiple of 8 bytes but for the last one. 0, or -1
 * with the error filled. */
int host_file_blocks(int fd, void (*take)(void *context, const unsigned char *block, size_t n), void *context,
                     host_error *error);

/* Finds the size and the checksum of the rest of an open file. 0, or -1 with the error filled. */
int host_file_sum(int fd, uint64_t *bytes, uint32_t *crc32, host_error *error);

void host_file_free(host_bytes *bytes);

#endif
