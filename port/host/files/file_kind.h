/* file_kind.h: what a file is, by its first bytes or its extension: for commands that take several kinds, and for the
 * error when another kind was expected.
 * SPDX-License-Identifier: MIT */
#ifndef FILE_KIND_H
#define FILE_KIND_H

#include <stddef.h>

#include "base/error_line.h"

enum {
    HOST_KIND_UNKNOWN = 0,
    HOST_KIND_SURFACE,
    HOST_KIND_VOLUME,
    HOST_KIND_LANDMARKS,
    HOST_KIND_MODEL,
    HOST_KIND_DICOM
};

/* The kind of the file at the path, HOST_KIND_...; UNKNOWN when it cannot be read. */
int host_file_kind(const char *path);

/* Adds to the error what was found in place of the expected content: the kind of the file that starts with these n
 * bytes, for DICOM the command that converts it. Adds nothing when the kind is unknown. */
void host_kind_found(host_error *error, const char *path, const unsigned char *head, size_t n);

/* Fills the error of a path that is a directory. Returns -1. */
int host_kind_refuse_directory(host_error *error, const char *path);

#endif
