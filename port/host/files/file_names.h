/* file_names.h: names and kinds of files.
 * SPDX-License-Identifier: MIT */
#ifndef FILE_NAMES_H
#define FILE_NAMES_H

#include <stddef.h>
#include "base/error_line.h"

/* Copies the file's name without directories, ".gz" and extension into name[bytes], with a NUL. A longer name is
 * cut. Returns the length of the whole name. */
size_t host_base_name(const char *path, char *name, size_t bytes);

/* 1 when the path, without ".gz", ends with the extension (".ply"), regardless of case. */
int host_has_extension(const char *path, const char *extension);

/* 1 when the path ends with ".gz", regardless of case. */
int host_is_packed_name(const char *path);

/* 1 when the n bytes start with the text. */
int host_starts_with(const unsigned char *head, size_t n, const char *text);

/* "DIRECTORY/NAME", to be freed. NULL when out of memory. */
char *host_path_in(const char *directory, const char *name);

/* Replaces the path by its parent: "a/b" -> "a", "/a" -> "/", "a" -> ".". The array has room for two bytes or more. */
void host_path_to_parent(char *path);

/* The path of `file` from the directory of the file `from`: "../data/a.ply". Both directories must exist; symbolic
 * links among them are followed, since ".." goes up from where a link leads. Owned by the caller; NULL when a directory
 * cannot be found, or out of memory. */
char *host_relative_path(const char *from, const char *file);

enum { HOST_KIND_UNKNOWN, HOST_KIND_SURFACE, HOST_KIND_VOLUME, HOST_KIND_LANDMARKS, HOST_KIND_MODEL, HOST_KIND_DICOM };

/* The kind of the file at the path, HOST_KIND_...; UNKNOWN when it cannot be read. */
int host_file_kind(const char *path);

/* Adds to the error what was found in place of the expected content: the kind of the file that starts with these n
 * bytes, for DICOM the command that converts it. Adds nothing when the kind is unknown. */
void host_kind_found(host_error *error, const char *path, const unsigned char *head, size_t n);

/* Fills the error of a path that is a directory. Returns -1. */
int host_kind_refuse_directory(host_error *error, const char *path);

#endif
