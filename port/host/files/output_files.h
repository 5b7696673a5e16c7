/* output_files.h: output files: all or none. They are written under temporary names and renamed at the end, the last
 * one last: an old last file is removed before, so that a set which was cut off lacks it. SIGINT, SIGTERM and SIGHUP
 * remove the temporary files before they end the program; while files are renamed they wait.
 * SPDX-License-Identifier: MIT */
#ifndef OUTPUT_FILES_H
#define OUTPUT_FILES_H

#include "base/byte_buffer.h"

typedef struct host_output host_output;

/* Checks that the directory exists or can be made; changes nothing. 0, or -1 with the error filled. */
int host_output_check(const char *directory, host_error *error);

/* Checks that the file can be written; changes nothing. Its directory must exist or be `directory`, which will be made
 * and where report.json, report.html, carry.bin, field.nrrd and all names of surfaces and markups are taken. 0, or -1
 * with the error filled. */
int host_output_check_file(const char *path, const char *directory, host_error *error);

/* Starts a set of files in a directory, which is made when missing; NULL: file names are paths. The directory's text
 * is borrowed. There is one set at a time, written by the main thread. NULL when out of memory, which the other
 * functions take and refuse. */
host_output *host_output_begin(const char *directory);

/* Writes one file under a temporary name. The name may contain directories. After a failure the set can only be
 * abandoned. 0, or -1 with the error filled. */
int host_output_add(host_output *output, const char *name, const host_buffer *content, host_error *error);

/* Likewise, and frees the content. result: -1 when it could not be made, and nothing is written. */
int host_output_take(host_output *output, const char *name, host_buffer *content, int result, host_error *error);

/* Adds a file that need not be in the set's directory; otherwise like host_output_add. */
int host_output_add_path(host_output *output, const char *path, const host_buffer *content, host_error *error);

/* A file of the set. */
typedef struct host_output_fact {
    const char *name; /* the set's, until it is freed */
    int inside;       /* 1: lies in the set's directory, and `name` is without it */
    uint64_t bytes;
    uint32_t crc32;
} host_output_fact;

/* The files added so far, in that order. */
size_t host_output_count(const host_output *output);
host_output_fact host_output_fact_of(const host_output *output, size_t i);

/* Ends a set. result 0: all files get their names; on failure what can be undone is, and an old last file is gone.
 * Another: all is removed. Returns 0, or -1 with the error filled. */
int host_output_end(host_output *output, int result, host_error *error);

/* Writes a set of one file, as host_output_take() does. 0, or -1 with the error filled. */
int host_output_file(const char *directory, const char *name, host_buffer *content, int result, host_error *error);

#endif
