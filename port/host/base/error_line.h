/* error_line.h: the line that a failed command prints: the file or option, the place in it, and what was expected
 * there.
 * SPDX-License-Identifier: MIT */
#ifndef ERROR_LINE_H
#define ERROR_LINE_H

#include <stdint.h>

#if defined(__GNUC__)
#define HOST_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define HOST_PRINTF(text, first)
#endif

typedef struct host_error {
    const char *file;   /* the file or option at fault; borrowed; NULL while there is no error */
    char place[96];     /* "header line 5", "face 1234"; vertices and faces are numbered from 0 */
    char expected[240]; /* what the place should contain */
} host_error;

/* Fill the error. Return -1, so that a caller can write: return host_fail(...). */
int host_fail(host_error *error, const char *place, const char *expected, ...) HOST_PRINTF(3, 4);
int host_fail_of(host_error *error, const char *file, const char *place, const char *expected, ...) HOST_PRINTF(4, 5);
int host_fail_at(host_error *error, const char *unit, uint64_t number, const char *expected, ...) HOST_PRINTF(4, 5);

/* Copies the file's name, which is about to be freed. One error at a time. */
void host_error_keep(host_error *error);

/* Prints "smr: FILE: PLACE: expected ..." as one line on stderr, control characters replaced. */
void host_error_print(const host_error *error);

#endif
