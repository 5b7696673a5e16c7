/* Names of files: the base name and the extension; ".gz" is not part of either.
 * SPDX-License-Identifier: MIT */
#ifndef FILE_NAMES_H
#define FILE_NAMES_H

#include <stddef.h>

/* A file's name without directories, ".gz" and extension, as [bytes] with a NUL; cut when it is longer. */
void host_base_name(const char *path, char *name, size_t bytes);

/* Whether the path ends like ".ply", ".gz" aside and regardless of case. */
int host_has_extension(const char *path, const char *extension);

#endif
