/* log_file.h: the log file of a registration: its command line, the files it read with their checksums, and the
 * library's log. smr replay reads the same inputs again and repeats every tick from it. docs/SPEC.md describes the
 * bytes.
 * SPDX-License-Identifier: MIT */
#ifndef LOG_FILE_H
#define LOG_FILE_H

#include "base/byte_buffer.h"

#define HOST_LOG_TICKS_MAX 1000000u /* most ticks recorded */
#define HOST_LOG_ARGUMENTS_MAX 4096u
#define HOST_LOG_INPUTS_MAX 8192u

/* An input file of the registration. */
typedef struct host_log_input {
    const char *path;
    uint64_t bytes, checksum; /* of the file on disk, packed or not */
} host_log_input;

typedef struct host_log {
    char **argument;       /* [n_arguments], after "smr register"; the array is owned, its texts lie in `memory` */
    host_log_input *input; /* [n_inputs]; owned */
    uint32_t n_arguments, n_inputs;
    unsigned char *log; /* the library's log; lies in `memory` */
    size_t log_bytes;
    void *memory; /* owned */
} host_log;

/* Checksum of bytes, continued from sum (0 at the start). All parts but the last must be multiples of 8 bytes. */
uint64_t host_log_checksum(uint64_t sum, const unsigned char *bytes, size_t n);

/* Finds the file's size and checksum. 0, or -1 with the error filled. */
int host_log_measure(const char *path, host_log_input *input, host_error *error);

/* Writes the whole log file into the buffer, which stores failure. */
void host_log_write(const host_log *log, host_buffer *out);

/* Reads an untrusted log file. 0, or -1 with the error filled and the log empty. */
int host_log_read(const char *path, host_log *log, host_error *error);
void host_log_free(host_log *log);

#endif
