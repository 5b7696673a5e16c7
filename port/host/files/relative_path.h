/* relative_path.h: the name of a file as another file's directory sees it.
 * SPDX-License-Identifier: MIT */
#ifndef RELATIVE_PATH_H
#define RELATIVE_PATH_H

/* The path of `file` from the directory of the file `from`: "../data/a.ply". Both directories must exist; symbolic
 * links among them are followed, since ".." goes up from where a link leads. Owned by the caller; NULL when a directory
 * cannot be found, or out of memory. */
char *host_relative_path(const char *from, const char *file);

#endif
