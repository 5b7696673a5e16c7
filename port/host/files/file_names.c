/* file_names.c: base name and extension of a file's path.
 * SPDX-License-Identifier: MIT */
#include "files/file_names.h"

#include <string.h>

static char lower(char c) { return (c >= 'A' && c <= 'Z') ? (char)(c - 'A' + 'a') : c; }

static int ends_with(const char *text, size_t n, const char *end)
{
    const size_t k = strlen(end);
    size_t i = 0;
    if (n < k)
        return 0;
    for (i = 0; i < k; i++)
        if (lower(text[n - k + i]) != end[i])
            return 0;
    return 1;
}

int host_is_packed_name(const char *path) { return ends_with(path, strlen(path), ".gz"); }

/* Length of the path without ".gz". */
static size_t unpacked_length(const char *path) { return strlen(path) - (host_is_packed_name(path) ? 3u : 0u); }

int host_has_extension(const char *path, const char *extension)
{
    return ends_with(path, unpacked_length(path), extension);
}

size_t host_base_name(const char *path, char *name, size_t bytes)
{
    const char *const slash = strrchr(path, '/');
    const char *const start = slash != NULL ? slash + 1 : path;
    size_t n = unpacked_length(path) - (size_t)(start - path);
    size_t i = n, copied = 0;
    while (i > 1 && start[i - 1u] != '.')
        i--;
    if (i > 1) /* a dot that is not the first character starts the extension */
        n = i - 1u;
    copied = n < bytes ? n : bytes - 1u;
    memcpy(name, start, copied);
    name[copied] = '\0';
    return n;
}

void host_path_to_parent(char *path)
{
    size_t n = strlen(path);
    while (n > 1 && path[n - 1u] == '/')
        n--;
    while (n > 0 && path[n - 1u] != '/')
        n--;
    while (n > 1 && path[n - 1u] == '/')
        n--;
    if (n == 0)
        path[n++] = '.';
    path[n] = '\0';
}
