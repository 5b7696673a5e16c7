/* output_check.c: checks, before a command's work, that its results can be written.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "files/file_names.h"
#include "files/output_files.h"

static char *copy_of(const char *path)
{
    const size_t n = strlen(path) + 1u;
    char *const copy = malloc(n < 2u ? 2u : n); /* "." is the parent of "" */
    if (copy != NULL)
        memcpy(copy, path, n);
    return copy;
}

int host_output_check(const char *directory, host_error *error)
{
    struct stat st;
    char *const path = copy_of(directory);
    int result = 0;
    error->file = directory;
    if (path == NULL)
        return host_fail(error, "output", "free memory");
    while (stat(path, &st) != 0 && errno == ENOENT && strcmp(path, "/") != 0 && strcmp(path, ".") != 0)
        host_path_to_parent(path);
    if (stat(path, &st) != 0)
        result = host_fail(error, "output", "a directory that can be made (%s)", strerror(errno));
    else if (!S_ISDIR(st.st_mode))
        result = host_fail(error, "output", "a directory, but %.80s is none", path);
    else if (access(path, W_OK | X_OK) != 0)
        result = host_fail(error, "output", "a directory that can be written (%s)", strerror(errno));
    free(path);
    return result;
}

/* 1 when the paths are equal but for slashes at the end. */
static int same_path(const char *a, const char *b)
{
    size_t n = strlen(a), m = strlen(b);
    while (n > 1 && a[n - 1u] == '/')
        n--;
    while (m > 1 && b[m - 1u] == '/')
        m--;
    return n == m && memcmp(a, b, n) == 0;
}

/* 1 when both paths lead to the same directory. */
static int same_directory(const char *a, const char *b)
{
    struct stat of_a, of_b;
    return same_path(a, b) ||
           (stat(a, &of_a) == 0 && stat(b, &of_b) == 0 && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino);
}

/* 1 when a result could have this file's name. */
static int is_result(const char *path)
{
    static const char *const names[] = {"report.json", "report.html", "carry.bin", "field.nrrd"};
    static const char *const ends[] = {".ply", ".stl", ".vtk", ".obj", ".mrk.json"};
    const char *const slash = strrchr(path, '/'), *const name = slash != NULL ? slash + 1 : path;
    const size_t n = strlen(name);
    int found = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        found |= strcmp(name, names[i]) == 0;
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        found |= n > strlen(ends[i]) && strcmp(name + n - strlen(ends[i]), ends[i]) == 0;
    return found;
}

int host_output_check_file(const char *path, const char *directory, host_error *error)
{
    struct stat st;
    char *const parent = copy_of(path);
    int result = 0;
    error->file = path;
    if (parent == NULL)
        return host_fail(error, "output", "free memory");
    host_path_to_parent(parent);
    if ((stat(path, &st) == 0 && S_ISDIR(st.st_mode)) || path[strlen(path) - 1u] == '/' || same_path(path, directory))
        result = host_fail(error, "output", "a file, not a directory");
    else if (same_directory(parent, directory) && is_result(path))
        result = host_fail(error, "output", "a name that no result has");
    else if (same_path(parent, directory))
        result = 0; /* host_output_check checks the directory */
    else if (stat(parent, &st) != 0 || !S_ISDIR(st.st_mode))
        result = host_fail(error, "output", "a directory that is there, %.80s is none", parent);
    else if (access(parent, W_OK | X_OK) != 0)
        result = host_fail(error, "output", "a directory that can be written (%s)", strerror(errno));
    free(parent);
    return result;
}
