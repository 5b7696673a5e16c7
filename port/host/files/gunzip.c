/* gunzip.c: unpacks a file: gzip runs as a child process with the file as its input and a pipe as its output.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "files/gunzip.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/file_kind.h"

#define FIRST_CAPACITY ((size_t)256u << 10)
#define NO_PROGRAM 127

/* Runs in the child: only calls that are safe after fork in a program with threads. */
static void run_gzip(int fd, int to)
{
    const int null = open("/dev/null", O_WRONLY);
    sigset_t none;
    (void)sigemptyset(&none);
    (void)sigprocmask(SIG_SETMASK, &none, NULL); /* the thread that forked blocks signals */
    if (dup2(fd, 0) == 0 && dup2(to, 1) == 1 && null >= 0 && dup2(null, 2) == 2)
        (void)execlp("gzip", "gzip", "-dc", (char *)NULL);
    _exit(NO_PROGRAM);
}

static int grow(host_bytes *bytes, size_t *capacity, host_error *error)
{
    size_t next = *capacity == 0 ? FIRST_CAPACITY : *capacity * 2u;
    unsigned char *data = NULL;
    if (*capacity >= HOST_UNPACKED_MAX)
        return host_fail(error, "file", "at most %zu MB after unpacking", HOST_UNPACKED_MAX >> 20);
    if (next > HOST_UNPACKED_MAX)
        next = HOST_UNPACKED_MAX;
    data = realloc(bytes->data, next);
    if (data == NULL)
        return host_fail(error, "file", "%zu bytes of free memory", next);
    bytes->data = data;
    *capacity = next;
    return 0;
}

static int drain(int from, const char *path, host_accept accept, host_bytes *bytes, host_error *error)
{
    size_t capacity = 0;
    int asked = 0;
    for (;;) {
        ssize_t r = 0;
        if (bytes->size == capacity && grow(bytes, &capacity, error) != 0)
            return -1;
        r = read(from, bytes->data + bytes->size, capacity - bytes->size);
        if (r < 0 && errno == EINTR)
            continue;
        if (r < 0)
            return host_fail(error, "file", "a readable pipe from gzip (%s)", strerror(errno));
        bytes->size += (size_t)r;
        if (!asked && accept != NULL && bytes->size > 0 && (r == 0 || bytes->size >= HOST_HEAD_BYTES)) {
            const size_t head = bytes->size < HOST_HEAD_BYTES ? bytes->size : HOST_HEAD_BYTES;
            asked = 1;
            if (accept(path, bytes->data, head, r == 0 ? bytes->size : 0, error) != 0) {
                host_kind_found(error, path, bytes->data, head);
                return -1;
            }
        }
        if (r == 0)
            return 0;
    }
}

/* Waits for the child; kills it first when reading failed. 0 when gzip succeeded, else -1 with the error filled. */
static int finish(pid_t child, int result, const host_bytes *bytes, host_error *error)
{
    int status = 0;
    if (result != 0)
        (void)kill(child, SIGKILL);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    if (result != 0)
        return -1;
    if (WIFEXITED(status) && WEXITSTATUS(status) == NO_PROGRAM)
        return host_fail(error, "file", "the gzip program to unpack it");
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        return host_fail(error, "file", "a whole gzip file");
    if (bytes->size == 0)
        return host_fail(error, "file", "data, but the file is empty after unpacking");
    return 0;
}

int host_gzip_read(int fd, const char *path, host_accept accept, host_bytes *bytes, host_error *error)
{
    int ends[2] = {-1, -1};
    int result = 0;
    pid_t child = 0;
    if (pipe(ends) != 0)
        return host_fail(error, "file", "a pipe to gzip (%s)", strerror(errno));
    /* The gzip of another thread must not inherit these: it would keep the pipe open. */
    (void)fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    (void)fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    child = fork();
    if (child == 0)
        run_gzip(fd, ends[1]);
    (void)close(ends[1]);
    if (child < 0) {
        (void)close(ends[0]);
        return host_fail(error, "file", "a process for gzip (%s)", strerror(errno));
    }
    result = drain(ends[0], path, accept, bytes, error);
    (void)close(ends[0]);
    result = finish(child, result, bytes, error);
    if (result != 0)
        host_file_free(bytes);
    return result;
}
