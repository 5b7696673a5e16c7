/* The log file of a registration: what its command line was, the files that it read with their checksums, and the library's own
 * log. Enough to read the same inputs again and to repeat every tick (smr replay). The bytes are in docs/SPEC.md.
 * SPDX-License-Identifier: MIT */
#ifndef LOG_FILE_H
#define LOG_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/byte_buffer.h"

#define HOST_LOG_TICKS_MAX 1000000u /* recorded at most */
#define HOST_LOG_ARGUMENTS_MAX 4096u
#define HOST_LOG_INPUTS_MAX 8192u

/* A file that the registration read. */
typedef struct host_log_input {
    const char *path;
    uint64_t bytes, checksum; /* as it lies on disk */
} host_log_input;

typedef struct host_log {
    char **argument;       /* [n_arguments], behind "smr register"; owned array of texts in memory */
    host_log_input *input; /* [n_inputs]; owned */
    uint32_t n_arguments, n_inputs;
    unsigned char *log; /* the library's, in memory */
    size_t log_bytes;
    void *memory; /* owned */
} host_log;

/* Checksum of bytes, continuing from sum (0 to start) where all parts but the last are multiples of 8 bytes. */
uint64_t host_log_checksum(uint64_t sum, const unsigned char *bytes, size_t n);

/* A file's size and checksum. 0, or -1 with the error filled. */
int host_log_measure(const char *path, host_log_input *input, host_error *error);

/* Writes all of it; the buffer remembers failure. */
void host_log_write(const host_log *log, host_buffer *out);

/* Reads a log file, which may come from anywhere. 0, or -1 with the error filled and the log empty. */
int host_log_read(const char *path, host_log *log, host_error *error);
void host_log_free(host_log *log);

#endif
