/* A strict scanner of JSON (RFC 8259) that calls back for members and elements and keeps nothing.
 * SPDX-License-Identifier: MIT */
#ifndef JSON_SCAN_H
#define JSON_SCAN_H

#include <stddef.h>

#include "base/error_line.h"
#include "base/text_scan.h"

/* A JSON text being read. Every function returns 0, or -1 with the error filled. */
typedef struct host_scan {
    host_text text;
    host_error *error;
    int depth;
} host_scan;

/* Called at a member's value or at a list's element, which it must read; key is NULL in a list. */
typedef int (*host_scan_each)(host_scan *scan, const char *key, void *context);

int host_scan_fail(const host_scan *scan, const char *expected);
int host_scan_object(host_scan *scan, host_scan_each each, void *context);
int host_scan_list(host_scan *scan, host_scan_each each, void *context);
/* At most bytes - 1 of the text and a NUL; *n is its whole length. to NULL: only passes it. */
int host_scan_text(host_scan *scan, char *to, size_t bytes, size_t *n);
int host_scan_number(host_scan *scan, double *value);
int host_scan_skip(host_scan *scan);
/* The first character of the next value, 0 at the end. */
char host_scan_next(host_scan *scan);
/* Nothing but white space is left. */
int host_scan_end(host_scan *scan);

#endif
