/* stop_tool.c: preloaded into smr, fails or signals at the n-th system call that makes, writes, syncs, renames or
 * removes an output file. SMR_STOP_AT: n, from 1. SMR_STOP_BY: "fail" (this call), "broken" (this and all later ones),
 * or a signal's number, sent before the call. SMR_STOP_COUNT: a file that gets the number of calls.
 * SPDX-License-Identifier: MIT */
#define _GNU_SOURCE

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static long calls;

/* The next definition of a function, as the function pointer at `to`. */
static void find(void *to, const char *name)
{
    void *const found = dlsym(RTLD_NEXT, name);
    memcpy(to, &found, sizeof found);
}

/* Counts a call. 1 when it shall fail. */
static int stop(void)
{
    const char *const at = getenv("SMR_STOP_AT"), *const by = getenv("SMR_STOP_BY");
    const long n = at != NULL ? atol(at) : 0;
    calls++;
    if (n == 0 || by == NULL || calls < n)
        return 0;
    errno = EIO;
    if (strcmp(by, "broken") == 0)
        return 1;
    if (calls > n)
        return 0;
    if (strcmp(by, "fail") == 0)
        return 1;
    (void)kill(getpid(), atoi(by));
    return 0;
}

static int stop_open(const char *path, int flags, mode_t mode)
{
    int (*real)(const char *, int, ...) = NULL;
    find(&real, "open");
    if ((flags & (O_CREAT | O_DIRECTORY)) != 0 && stop())
        return -1;
    return real(path, flags, mode);
}

#define STOP_OPEN(name)                                                                                                \
    int name(const char *path, int flags, ...)                                                                         \
    {                                                                                                                  \
        mode_t mode = 0;                                                                                               \
        va_list list;                                                                                                  \
        va_start(list, flags);                                                                                         \
        if ((flags & O_CREAT) != 0)                                                                                    \
            mode = va_arg(list, mode_t);                                                                               \
        va_end(list);                                                                                                  \
        return stop_open(path, flags, mode);                                                                           \
    }
STOP_OPEN(open)
STOP_OPEN(open64)

ssize_t write(int fd, const void *data, size_t n)
{
    ssize_t (*real)(int, const void *, size_t) = NULL;
    find(&real, "write");
    return fd > 2 && stop() ? -1 : real(fd, data, n);
}

int fsync(int fd)
{
    int (*real)(int) = NULL;
    find(&real, "fsync");
    return stop() ? -1 : real(fd);
}

int rename(const char *from, const char *to)
{
    int (*real)(const char *, const char *) = NULL;
    find(&real, "rename");
    return stop() ? -1 : real(from, to);
}

/* The calls whose only argument is a path. */
#define STOP_PATH(name)                                                                                                \
    int name(const char *path)                                                                                         \
    {                                                                                                                  \
        int (*real)(const char *) = NULL;                                                                              \
        find(&real, #name);                                                                                            \
        return stop() ? -1 : real(path);                                                                               \
    }
STOP_PATH(unlink)
STOP_PATH(rmdir)

int mkdir(const char *path, mode_t mode)
{
    int (*real)(const char *, mode_t) = NULL;
    find(&real, "mkdir");
    return stop() ? -1 : real(path, mode);
}

__attribute__((destructor)) static void tell(void)
{
    const char *const path = getenv("SMR_STOP_COUNT");
    FILE *const file = path != NULL ? fopen(path, "w") : NULL;
    if (file == NULL)
        return;
    (void)fprintf(file, "%ld\n", calls);
    (void)fclose(file);
}
