/* What went wrong, where, and what was expected instead: the one line a failed command prints.
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
    const char *file;   /* borrowed: the file or the option at fault; NULL when nothing went wrong yet */
    char place[96];     /* "header line 5", "face 1234"; counts of vertices and faces start at 0 */
    char expected[240]; /* what should have been there */
} host_error;

/* Both fill the error and return -1, so that a caller can write: return host_fail(...). */
int host_fail(host_error *error, const char *place, const char *expected, ...) HOST_PRINTF(3, 4);
int host_fail_at(host_error *error, const char *unit, uint64_t number, const char *expected, ...) HOST_PRINTF(4, 5);

/* Prints "smr: FILE: PLACE: expected ..." as one line on stderr, control characters replaced. */
void host_error_print(const host_error *error);

#endif
