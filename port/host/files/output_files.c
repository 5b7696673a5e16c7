/* output_files.c: output files. An existing path that is no regular file (a device, a pipe) is written directly: a
 * rename would replace it.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "files/output_files.h"
#include "files/file_read.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct output_file {
    char *path;      /* owned */
    char *temporary; /* owned; NULL: the path is written directly */
    int renamed;     /* 1: the temporary file has been renamed to the path */
    int replaced;    /* 1: the path existed before */
} output_file;

struct host_output {
    const char *directory;
    char **made; /* directories made, a parent before its children; owned */
    size_t n_made;
    output_file *file; /* owned */
    size_t n;
};

static char *join(const char *directory, const char *name, const char *tail)
{
    const size_t n = (directory != NULL ? strlen(directory) : 0) + strlen(name) + strlen(tail) + 3u;
    char *const path = malloc(n);
    if (path != NULL)
        (void)snprintf(path, n, "%s%s%s%s", directory != NULL ? directory : "", directory != NULL ? "/" : "", name,
                       tail);
    return path;
}

/* Replaces the path by its parent: "a/b" -> "a", "/a" -> "/", "a" -> ".". */
static void to_parent(char *path)
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

int host_output_check(const char *directory, host_error *error)
{
    struct stat st;
    char *const path = join(NULL, directory, "");
    int result = 0;
    error->file = directory;
    if (path == NULL)
        return host_fail(error, "output", "free memory");
    while (stat(path, &st) != 0 && errno == ENOENT && strcmp(path, "/") != 0 && strcmp(path, ".") != 0)
        to_parent(path);
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
    const char *const slash = strrchr(path, '/'), *const name = slash != NULL ? slash + 1 : path;
    const size_t n = strlen(name);
    return strcmp(name, "report.json") == 0 || (n > 4u && strcmp(name + n - 4u, ".ply") == 0);
}

int host_output_check_file(const char *path, const char *directory, host_error *error)
{
    struct stat st;
    char *const parent = join(NULL, path, "");
    int result = 0;
    error->file = path;
    if (parent == NULL)
        return host_fail(error, "output", "free memory");
    to_parent(parent);
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

static int make_directory(host_output *output, const char *path, host_error *error)
{
    char **grown = NULL;
    if (mkdir(path, 0777) != 0)
        return errno == EEXIST ? 0 : host_fail(error, "output", "a directory that can be made (%s)", strerror(errno));
    grown = realloc(output->made, (output->n_made + 1u) * sizeof *grown);
    if (grown != NULL) {
        output->made = grown;
        grown[output->n_made] = join(NULL, path, "");
    }
    if (grown == NULL || grown[output->n_made] == NULL) {
        (void)rmdir(path);
        return host_fail(error, "output", "free memory");
    }
    output->n_made++;
    return 0;
}

/* Makes the missing directories of the file's path. */
static int make_directories(host_output *output, const char *file, host_error *error)
{
    char *const path = join(NULL, file, "");
    size_t i = 0;
    int result = 0;
    if (path == NULL)
        return host_fail(error, "output", "free memory");
    for (i = 1; result == 0 && path[i] != '\0'; i++) {
        if (path[i] != '/')
            continue;
        path[i] = '\0';
        result = make_directory(output, path, error);
        path[i] = '/';
    }
    free(path);
    return result;
}

host_output *host_output_begin(const char *directory)
{
    host_output *const output = calloc(1, sizeof *output);
    if (output != NULL)
        output->directory = directory;
    return output;
}

static int write_all(int fd, const host_buffer *content)
{
    size_t at = 0;
    while (at < content->size) {
        const ssize_t n = write(fd, content->data + at, content->size - at);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return -1;
        at += (size_t)n;
    }
    return 0;
}

static int write_file(const output_file *file, const host_buffer *content, host_error *error)
{
    const char *const path = file->temporary != NULL ? file->temporary : file->path;
    const int flags = file->temporary != NULL ? O_WRONLY | O_CREAT | O_EXCL : O_WRONLY;
    const int fd = open(path, flags | O_CLOEXEC | O_NOCTTY, 0666);
    int failed = 0, why = errno;
    if (fd < 0)
        return host_fail(error, "output", "a file that can be written (%s)", strerror(why));
    failed = write_all(fd, content);
    why = errno;
    if (close(fd) != 0 && !failed) {
        failed = 1;
        why = errno;
    }
    return failed ? host_fail(error, "output", "room for %zu bytes (%s)", content->size, strerror(why)) : 0;
}

int host_output_add(host_output *output, const char *name, const host_buffer *content, host_error *error)
{
    output_file *grown = NULL, *file = NULL;
    struct stat st;
    char tail[48];
    error->file = output->directory != NULL ? output->directory : name;
    if (!content->failed)
        grown = realloc(output->file, (output->n + 1u) * sizeof *grown);
    if (grown == NULL)
        return host_fail(error, "output", "free memory");
    output->file = grown;
    file = &grown[output->n];
    memset(file, 0, sizeof *file);
    file->path = join(output->directory, name, "");
    if (file->path == NULL)
        return host_fail(error, "output", "free memory");
    output->n++;
    if (output->directory != NULL && make_directories(output, file->path, error) != 0)
        return -1;
    file->replaced = stat(file->path, &st) == 0;
    if (file->replaced && S_ISDIR(st.st_mode))
        return host_fail(error, name, "a file there, not a directory");
    if (file->replaced && host_file_was_read(file->path))
        return host_fail(error, name, "a path that is not one of the inputs");
    if (!file->replaced || S_ISREG(st.st_mode)) {
        (void)snprintf(tail, sizeof tail, ".%ld.tmp", (long)getpid());
        file->temporary = join(output->directory, name, tail);
        if (file->temporary == NULL)
            return host_fail(error, "output", "free memory");
    }
    return write_file(file, content, error);
}

static void free_output(host_output *output)
{
    size_t i = 0;
    for (i = 0; i < output->n; i++) {
        free(output->file[i].path);
        free(output->file[i].temporary);
    }
    for (i = 0; i < output->n_made; i++)
        free(output->made[i]);
    free(output->file);
    free(output->made);
    free(output);
}

void host_output_abandon(host_output *output)
{
    size_t i = 0;
    if (output == NULL)
        return;
    for (i = 0; i < output->n; i++) {
        const output_file *const file = &output->file[i];
        if (file->renamed && !file->replaced)
            (void)unlink(file->path);
        else if (file->temporary != NULL && !file->renamed)
            (void)unlink(file->temporary);
    }
    for (i = output->n_made; i > 0; i--)
        (void)rmdir(output->made[i - 1u]);
    free_output(output);
}

int host_output_commit(host_output *output, host_error *error)
{
    size_t i = 0;
    for (i = 0; i < output->n; i++) {
        output_file *const file = &output->file[i];
        if (file->temporary == NULL)
            continue;
        if (rename(file->temporary, file->path) != 0) {
            (void)host_fail(error, "output", "a name that can be given to a file (%s)", strerror(errno));
            host_output_abandon(output);
            return -1;
        }
        file->renamed = 1;
    }
    free_output(output);
    return 0;
}
