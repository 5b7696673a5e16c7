/* relative_path.c: the name of a file as another file's directory sees it.
 * SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700

#include "files/relative_path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/file_names.h"

/* The directory of a file, from the root, without links. Owned by the caller; NULL when there is none. */
static char *directory_of(const char *file)
{
    const size_t n = strlen(file) + 2u; /* "." is the parent of "" */
    char *const copy = malloc(n);
    char *found = NULL;
    if (copy == NULL)
        return NULL;
    (void)snprintf(copy, n, "%s", file);
    host_path_to_parent(copy);
    found = realpath(copy, NULL);
    free(copy);
    if (found != NULL && strcmp(found, "/") == 0)
        found[0] = '\0';
    return found;
}

/* Bytes of the directories that both have, from the root: a path ends there, or a slash follows. */
static size_t common(const char *a, const char *b)
{
    size_t i = 0, end = 0;
    for (i = 0; a[i] != '\0' && a[i] == b[i]; i++)
        if (a[i] == '/')
            end = i;
    return (a[i] == '\0' || a[i] == '/') && (b[i] == '\0' || b[i] == '/') ? i : end;
}

/* What leads from one directory to a file in another. */
static char *join(const char *from, const char *to, const char *name)
{
    const size_t same = common(from, to);
    size_t up = 0, n = 0, i = 0;
    char *path = NULL;
    for (i = same; from[i] != '\0'; i++)
        up += from[i] == '/';
    n = 3u * up + strlen(to + same) + strlen(name) + 2u;
    path = malloc(n);
    if (path == NULL)
        return NULL;
    for (i = 0; i < up; i++)
        memcpy(path + 3u * i, "../", 3);
    to += same + (to[same] == '/');
    (void)snprintf(path + 3u * up, n - 3u * up, "%s%s%s", to, *to != '\0' ? "/" : "", name);
    return path;
}

char *host_relative_path(const char *from, const char *file)
{
    const char *const slash = strrchr(file, '/');
    char *const a = directory_of(from), *const b = directory_of(file);
    char *const path = a != NULL && b != NULL ? join(a, b, slash != NULL ? slash + 1 : file) : NULL;
    free(a);
    free(b);
    return path;
}
