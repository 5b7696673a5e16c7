/* report_path.c: the files of a directory of results.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "cohort/report_path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* 1 when the name stays in its directory: no empty part, and none that starts with a dot. */
static int stays_inside(const char *name)
{
    for (;;) {
        if (*name == '\0' || *name == '/' || *name == '.')
            return 0;
        name += strcspn(name, "/");
        if (*name == '\0')
            return 1;
        name++;
    }
}

char *host_report_beside(const char *directory, const char *name)
{
    const size_t n = strlen(directory) + strlen(name) + 2u;
    char *path = NULL;
    path = stays_inside(name) ? malloc(n) : NULL;
    if (path != NULL)
        (void)snprintf(path, n, "%s/%s", directory, name);
    return path;
}

int host_report_there(const char *path)
{
    struct stat st;
    return lstat(path, &st) == 0;
}

static int is_object(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    size_t i = 0;
    (void)path;
    (void)total;
    while (i < n && (head[i] == ' ' || head[i] == '\n' || head[i] == '\r' || head[i] == '\t'))
        i++;
    return i < n && head[i] == '{' ? 0 : host_fail(error, "content", "an object in braces");
}

int host_report_bytes(const char *path, host_bytes *bytes, host_error *error)
{
    return host_file_read(path, is_object, bytes, error);
}
