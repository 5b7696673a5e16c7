/* Results on disk: all of them or none. Files are written under other names and renamed at the end.
 * SPDX-License-Identifier: MIT */
#ifndef OUTPUT_FILES_H
#define OUTPUT_FILES_H

#include "base/byte_buffer.h"

typedef struct host_output host_output;

/* Checks early, without changing anything, that the directory is there or could be made. */
int host_output_check(const char *directory, host_error *error);

/* The same for a file, whose directory must be there, or is `directory`, which will be made and gets report.json
 * and NAME.ply. */
int host_output_check_file(const char *path, const char *directory, host_error *error);

/* Starts a set of files in a directory, made when needed; NULL: names are paths. NULL without memory.
 * The directory's text is borrowed. */
host_output *host_output_begin(const char *directory);

/* Writes one file's content; its name may begin with directories of its own.
 * After a failure the set can only be abandoned. */
int host_output_add(host_output *output, const char *name, const host_buffer *content, host_error *error);

/* Gives all files their names; on failure takes back what it can. Frees the set either way. */
int host_output_commit(host_output *output, host_error *error);

/* Removes what was written and the directories that were made. NULL is allowed. */
void host_output_abandon(host_output *output);

#endif
