/* report_path.h: the files of a directory of results.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_PATH_H
#define REPORT_PATH_H

#include "files/file_read.h"

/* "DIRECTORY/NAME", to be freed. NULL when out of memory, or where the name leads out of the directory. */
char *host_report_beside(const char *directory, const char *name);

/* 1 when there is such a file, of whatever kind. */
int host_report_there(const char *path);

/* Reads a report.json. 0, or -1 with the error filled; the error borrows the path. */
int host_report_bytes(const char *path, host_bytes *bytes, host_error *error);

#endif
