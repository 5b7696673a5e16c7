/* json_scan.h: a strict JSON scanner (RFC 8259): calls back for members and elements and stores nothing.
 * SPDX-License-Identifier: MIT */
#ifndef JSON_SCAN_H
#define JSON_SCAN_H

#include "base/error_line.h"
#include "base/text_scan.h"

/* A JSON text being read. The functions return 0, or -1 with the error filled, unless they say otherwise. */
typedef struct host_scan {
    host_text text;
    host_error *error;
    int depth;
} host_scan;

/* Called at a member's value, or at a value; must read it. */
typedef int (*host_scan_member)(host_scan *scan, const char *key, void *context);
typedef int (*host_scan_value)(host_scan *scan, void *context);

/* A key, and where its value goes. */
typedef struct host_scan_field {
    const char *key;
    host_scan_value read;
    size_t offset; /* in the struct, of what `read` gets */
} host_scan_field;

/* The keys that an object may have; others are skipped. */
typedef struct host_scan_members {
    const host_scan_field *fields;
    size_t n;
    void *to;           /* the struct */
    unsigned has, once; /* bits of fields: those read, those that may be read once */
} host_scan_members;

int host_scan_fail(const host_scan *scan, const char *expected);
int host_scan_object(host_scan *scan, host_scan_member each, void *context);
int host_scan_struct(host_scan *scan, host_scan_members *to);
int host_scan_list(host_scan *scan, host_scan_value each, void *context);
/* Copies at most bytes - 1 bytes of the text and a NUL; *n: length of the whole text. to NULL: skips the text. */
int host_scan_text(host_scan *scan, char *to, size_t bytes, size_t *n);
int host_scan_number(host_scan *scan, double *value);
int host_scan_skip(host_scan *scan);
/* Returns the first character of the next value, 0 at the end. */
char host_scan_peek(host_scan *scan);
/* Checks that only white space is left. */
int host_scan_end(host_scan *scan);

#endif
