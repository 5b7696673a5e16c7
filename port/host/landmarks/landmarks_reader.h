/* What the readers of landmark files share: the set under construction, and a strict scanner of JSON.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARKS_READER_H
#define LANDMARKS_READER_H

#include <stddef.h>

#include "landmarks/landmarks.h"
#include "base/text_scan.h"

/* Adds one landmark found at a line; refuses what the struct's promises do not allow. */
int host_landmarks_add(host_landmarks *landmarks, host_error *error, uint32_t line, host_word label,
                       const double xyz[3]);

/* The system a file names: turns the landmarks from `first` on into LPS; -1 for an unknown one. */
int host_landmarks_turn(host_landmarks *landmarks, host_error *error, uint32_t line, host_word system, uint32_t first);

int host_read_markups(host_landmarks *landmarks, const char *data, size_t n, host_error *error);
/* slicer 1: the file's name says .fcsv, so that it must name its coordinate system. */
int host_read_landmark_table(host_landmarks *landmarks, const char *data, size_t n, int slicer, host_error *error);

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
