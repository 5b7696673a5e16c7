/* output_files.c: output files. An existing path that is no regular file (a device, a pipe) is written directly: a
 * rename would replace it. Signals are blocked while the set changes, so that their handler sees it whole.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "files/output_files.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "files/gzip_write.h"
#include "base/system.h"
#include "files/file_names.h"
#include "files/file_read.h"

typedef struct output_file {
    char *path;      /* owned */
    char *temporary; /* owned; NULL: the path is written directly */
    size_t inside;   /* where the path goes on behind the set's directory; 0: it need not lie there */
    size_t bytes;    /* of the content */
    uint32_t crc32;  /* of the content */
    int made;        /* 1: the temporary file has been made */
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

static char *join(const char *dir, const char *name, const char *tail)
{
    const size_t n = (dir != NULL ? strlen(dir) : 0) + strlen(name) + strlen(tail) + 3u;
    char *const path = malloc(n);
    if (path != NULL)
        (void)snprintf(path, n, "%s%s%s%s", dir != NULL ? dir : "", dir != NULL ? "/" : "", name, tail);
    return path;
}

static int make_directory(host_output *output, const char *path, host_error *error)
{
    char **const grown = realloc(output->made, (output->n_made + 1u) * sizeof *grown);
    char *const copy = join(NULL, path, "");
    if (grown != NULL)
        output->made = grown;
    if (grown == NULL || copy == NULL) {
        free(copy);
        return host_fail(error, "output", "free memory");
    }
    if (mkdir(path, 0777) == 0) {
        grown[output->n_made++] = copy;
        return 0;
    }
    int why = errno;
    free(copy);
    return why == EEXIST ? 0 : host_fail(error, "output", "a directory that can be made (%s)", strerror(why));
}

/* Makes the missing directories of the file's path. */
static int make_directories(host_output *output, const char *file, host_error *error)
{
    char *const path = join(NULL, file, "");
    int result = 0;
    if (path == NULL)
        return host_fail(error, "output", "free memory");
    for (size_t i = 1; result == 0 && path[i] != '\0'; i++) {
        if (path[i] != '/')
            continue;
        path[i] = '\0';
        result = make_directory(output, path, error);
        path[i] = '/';
    }
    free(path);
    return result;
}

/* The set that is being written; read by the handler of signals. */
static host_output *volatile unfinished;

/* Removes what is not finished. Only calls that a handler of signals may make. */
static void remove_unfinished(const host_output *output)
{
    for (size_t i = 0; i < output->n; i++) {
        const output_file *const file = &output->file[i];
        if (file->renamed && !file->replaced)
            (void)unlink(file->path);
        else if (file->made && !file->renamed)
            (void)unlink(file->temporary);
    }
    for (size_t i = output->n_made; i > 0; i--)
        (void)rmdir(output->made[i - 1u]);
}

/* Ends the program by the signal, as if it had not been caught: it is blocked until this returns. */
static void on_stop(int number)
{
    if (unfinished != NULL)
        remove_unfinished(unfinished);
    (void)signal(number, SIG_DFL);
    (void)raise(number);
}

host_output *host_output_begin(const char *directory)
{
    host_output *const output = calloc(1, sizeof *output);
    if (output == NULL)
        return NULL;
    output->directory = directory;
    unfinished = output;
    host_stop_catch(on_stop);
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

/* Waits until the data is on the disk. Some file systems cannot: EINVAL, ENOTSUP, ENOSYS. */
static int sync_data(int fd)
{
    while (fsync(fd) != 0)
        if (errno != EINTR)
            return errno == EINVAL || errno == ENOTSUP || errno == ENOSYS ? 0 : -1;
    return 0;
}

/* Waits until the names in the file's directory are on the disk. A directory that cannot be read is left out. */
static int sync_names(const output_file *file)
{
    char *const path = join(NULL, file->path, "");
    if (path == NULL) {
        errno = ENOMEM;
        return -1;
    }
    host_path_to_parent(path);
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    free(path);
    if (fd < 0)
        return errno == EACCES ? 0 : -1;
    int result = sync_data(fd);
    int why = errno;
    (void)close(fd);
    errno = why;
    return result;
}

static int open_file(output_file *file)
{
    host_stop_set before;
    if (file->temporary == NULL) /* may wait for a reader */
        return open(file->path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
    host_stop_block(&before);
    int fd = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOCTTY, 0666);
    file->made = fd >= 0;
    host_stop_restore(&before);
    return fd;
}

static int write_file(output_file *file, const host_buffer *content, host_error *error)
{
    const int fd = open_file(file);
    int failed = 0, why = errno;
    if (fd < 0)
        return host_fail(error, "output", "a file that can be written (%s)", strerror(why));
    failed = write_all(fd, content) != 0 || (file->temporary != NULL && sync_data(fd) != 0);
    why = errno;
    if (close(fd) != 0 && !failed) {
        failed = 1;
        why = errno;
    }
    return failed ? host_fail(error, "output", "room for %zu bytes (%s)", content->size, strerror(why)) : 0;
}

/* Adds an entry for the path, which the set takes over. NULL when out of memory. */
static output_file *new_file(host_output *output, char *path)
{
    output_file *const grown = path != NULL ? realloc(output->file, (output->n + 1u) * sizeof *grown) : NULL;
    if (grown == NULL) {
        free(path);
        return NULL;
    }
    output->file = grown;
    memset(&grown[output->n], 0, sizeof *grown);
    grown[output->n].path = path;
    return &grown[output->n++];
}

/* Adds an entry, makes its directories and finds its temporary name. NULL with the error filled. */
static output_file *prepare_file(host_output *output, const char *directory, const char *name, host_error *error)
{
    output_file *const file = new_file(output, join(directory, name, ""));
    struct stat st;
    char tail[48];
    if (file == NULL) {
        (void)host_fail(error, "output", "free memory");
        return NULL;
    }
    if (directory != NULL && make_directories(output, file->path, error) != 0)
        return NULL;
    file->inside = directory != NULL ? strlen(directory) + 1u : 0u;
    file->replaced = stat(file->path, &st) == 0;
    if (file->replaced && S_ISDIR(st.st_mode)) {
        (void)host_fail(error, name, "a file there, not a directory");
        return NULL;
    }
    if (file->replaced && host_file_was_read(file->path)) {
        (void)host_fail(error, name, "a path that is not one of the inputs");
        return NULL;
    }
    if (!file->replaced || S_ISREG(st.st_mode)) {
        (void)snprintf(tail, sizeof tail, ".%ld.tmp", (long)getpid());
        file->temporary = join(directory, name, tail);
        if (file->temporary == NULL) {
            (void)host_fail(error, "output", "free memory");
            return NULL;
        }
    }
    return file;
}

static int add(host_output *output, const char *directory, const char *name, const host_buffer *data, host_error *error)
{
    host_stop_set before;
    error->file = directory != NULL ? directory : name;
    if (data->failed)
        return host_fail(error, "output", "free memory");
    host_stop_block(&before);
    output_file *file = prepare_file(output, directory, name, error);
    host_stop_restore(&before);
    if (file == NULL)
        return -1;
    file->bytes = data->size;
    file->crc32 = host_crc32_of(data->data, data->size);
    return write_file(file, data, error);
}

size_t host_output_count(const host_output *output) { return output->n; }

host_output_fact host_output_fact_of(const host_output *output, size_t i)
{
    const output_file *const file = &output->file[i];
    const host_output_fact fact = {file->path + file->inside, file->inside > 0, file->bytes, file->crc32};
    return fact;
}

int host_output_add(host_output *set, const char *name, const host_buffer *content, host_error *error)
{
    return set == NULL ? host_fail(error, "output", "free memory") : add(set, set->directory, name, content, error);
}

int host_output_take(host_output *output, const char *name, host_buffer *content, int result, host_error *error)
{
    if (result == 0)
        result = host_output_add(output, name, content, error);
    host_buffer_free(content);
    return result;
}

int host_output_add_path(host_output *output, const char *path, const host_buffer *content, host_error *error)
{
    return output == NULL ? host_fail(error, "output", "free memory") : add(output, NULL, path, content, error);
}

static void free_output(host_output *output)
{
    unfinished = NULL;
    for (size_t i = 0; i < output->n; i++) {
        free(output->file[i].path);
        free(output->file[i].temporary);
    }
    for (size_t i = 0; i < output->n_made; i++)
        free(output->made[i]);
    free(output->file);
    free(output->made);
    free(output);
}

/* Renames the files first to end - 1, then waits until their new names are on the disk. */
static int rename_files(host_output *output, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        output_file *const file = &output->file[i];
        if (file->temporary != NULL && rename(file->temporary, file->path) != 0)
            return -1;
        file->renamed = file->temporary != NULL;
    }
    for (size_t i = first; i < end; i++)
        if (output->file[i].renamed && sync_names(&output->file[i]) != 0)
            return -1;
    return 0;
}

/* Removes the old last file: from here to its rename the set is recognisable as unfinished. */
static int remove_last(const host_output *output)
{
    const output_file *const last = &output->file[output->n - 1u];
    if (output->n == 1u || last->temporary == NULL || !last->replaced)
        return 0;
    return unlink(last->path) == 0 || errno == ENOENT ? sync_names(last) : -1;
}

static int rename_all(host_output *output)
{
    const size_t n = output->n;
    output_file *const last = &output->file[n - 1u];
    if (remove_last(output) != 0 || rename_files(output, 0, n - 1u) != 0)
        return -1;
    if (last->temporary == NULL)
        return 0;
    if (rename(last->temporary, last->path) != 0)
        return -1;
    last->renamed = 1;
    (void)sync_names(last); /* the set is whole: nothing is to be undone */
    return 0;
}

int host_output_end(host_output *output, int result, host_error *error)
{
    host_stop_set before;
    if (output == NULL)
        return result == 0 ? host_fail(error, "output", "free memory") : -1;
    host_stop_block(&before);
    if (result == 0 && output->n > 0 && rename_all(output) != 0)
        result = host_fail(error, "output", "names that can be given to files (%s)", strerror(errno));
    if (result != 0)
        remove_unfinished(output);
    free_output(output);
    host_stop_restore(&before);
    return result == 0 ? 0 : -1;
}

int host_output_file(const char *directory, const char *name, host_buffer *content, int result, host_error *error)
{
    host_output *const output = result == 0 ? host_output_begin(directory) : NULL;
    return host_output_end(output, host_output_take(output, name, content, result, error), error);
}
