/* file_names.h: base name and extension of a file's path; ".gz" belongs to neither.
 * SPDX-License-Identifier: MIT */
#ifndef FILE_NAMES_H
#define FILE_NAMES_H

#include <stddef.h>

/* Copies the file's name without directories, ".gz" and extension into name[bytes], with a NUL. A longer name is
 * cut. Returns the length of the whole name. */
size_t host_base_name(const char *path, char *name, size_t bytes);

/* 1 when the path, without ".gz", ends with the extension (".ply"), regardless of case. */
int host_has_extension(const char *path, const char *extension);

/* 1 when the path ends with ".gz", regardless of case. */
int host_is_packed_name(const char *path);

/* Replaces the path by its parent: "a/b" -> "a", "/a" -> "/", "a" -> ".". The array has room for two bytes or more. */
void host_path_to_parent(char *path);

#endif
