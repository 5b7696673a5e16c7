/* stop_tool.c: preloaded into smr, fails or signals at the n-th call of a kind. SMR_STOP_AT: n, from 1. SMR_STOP_OF:
 * "out" (calls that make, write, sync, rename or remove an output file; the default), "in" (open, read or close another
 * file) or "memory". SMR_STOP_BY: "fail" (this call), "broken" (this and all later ones), "full" (no room from this
 * call on, which writes half), "power" (goes before the call), "torn" (goes in its midst), or a signal's number, sent
 * before the call. What was not synced is half lost with the power. SMR_STOP_COUNT: a file that gets the number of
 * calls.
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

enum { OUT, IN, MEMORY, WRITE };
enum { FILES_MAX = 256 };
static long calls;
static unsigned char dirty[FILES_MAX]; /* 1: written, and not synced since; a closed one stays open by another number */
static int full;                       /* 1: SMR_STOP_BY is "full", and it is */

void *__libc_malloc(size_t n);
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *old, size_t n);
void *__libc_memalign(size_t align, size_t n);

/* The next definition of a function, as the function pointer at `to`. */
static void find(void *to, const char *name)
{
    void *const found = dlsym(RTLD_NEXT, name);
    memcpy(to, &found, sizeof found);
}

static void cut_power(void)
{
    int (*sync)(int) = NULL;
    find(&sync, "fsync");
    for (int fd = 0; fd < FILES_MAX; fd++) {
        struct stat st;
        if (dirty[fd] && fstat(fd, &st) == 0)
            (void)ftruncate(fd, st.st_size / 2);
    }
    (void)kill(getpid(), SIGKILL);
}

/* Counts a call. 1 when it shall fail; 2: a write shall be cut in its midst. */
static int stop(int kind)
{
    static const char *const kinds[] = {"out", "in", "memory", "out"};
    const char *const at = getenv("SMR_STOP_AT"), *const by = getenv("SMR_STOP_BY"), *const of = getenv("SMR_STOP_OF");
    const long n = at != NULL ? atol(at) : 0;
    if (strcmp(of != NULL ? of : "out", kinds[kind]) != 0)
        return 0;
    calls++;
    if (n == 0 || by == NULL || calls < n)
        return 0;
    full = strcmp(by, "full") == 0;
    errno = kind == MEMORY ? ENOMEM : full ? ENOSPC : EIO;
    if (full)
        return calls == n ? 2 : 1;
    if (strcmp(by, "broken") == 0)
        return 1;
    if (calls > n)
        return 0;
    if (strcmp(by, "fail") == 0)
        return 1;
    if (strcmp(by, "torn") == 0 && kind == WRITE)
        return 2;
    if (strcmp(by, "power") == 0 || strcmp(by, "torn") == 0)
        cut_power();
    (void)kill(getpid(), atoi(by));
    return 0;
}

static int stop_open(const char *path, int flags, mode_t mode)
{
    int (*real)(const char *, int, ...) = NULL;
    find(&real, "open");
    return stop((flags & (O_CREAT | O_DIRECTORY)) != 0 ? OUT : IN) ? -1 : real(path, flags, mode);
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

FILE *fopen(const char *path, const char *mode)
{
    FILE *(*real)(const char *, const char *) = NULL;
    find(&real, "fopen");
    return mode[0] == 'r' && stop(IN) ? NULL : real(path, mode);
}

ssize_t read(int fd, void *data, size_t n)
{
    ssize_t (*real)(int, void *, size_t) = NULL;
    find(&real, "read");
    return fd > 2 && stop(IN) ? -1 : real(fd, data, n);
}

ssize_t write(int fd, const void *data, size_t n)
{
    ssize_t (*real)(int, const void *, size_t) = NULL;
    find(&real, "write");
    const int how = fd > 2 ? stop(WRITE) : 0;
    if (how == 1)
        return -1;
    if (fd > 2 && fd < FILES_MAX)
        dirty[fd] = 1;
    const ssize_t done = real(fd, data, how == 2 ? n / 2u : n);
    if (how == 2 && !full)
        cut_power();
    return done;
}

int fsync(int fd)
{
    int (*real)(int) = NULL;
    find(&real, "fsync");
    if (stop(OUT) && !full)
        return -1;
    if (fd >= 0 && fd < FILES_MAX)
        dirty[fd] = 0;
    return getenv("SMR_STOP_AT") != NULL ? 0 : real(fd); /* which the disk need not be asked for */
}

int close(int fd)
{
    int (*real)(int) = NULL;
    find(&real, "close");
    if (fd > 2 && fd < FILES_MAX && dirty[fd]) {
        const int kept = fcntl(fd, F_DUPFD_CLOEXEC, FILES_MAX / 2);
        dirty[fd] = 0;
        if (kept >= 0 && kept < FILES_MAX)
            dirty[kept] = 1;
    }
    const int result = real(fd);
    return fd > 2 && stop(IN) ? -1 : result;
}

int rename(const char *from, const char *to)
{
    int (*real)(const char *, const char *) = NULL;
    find(&real, "rename");
    return stop(OUT) && !full ? -1 : real(from, to);
}

/* The calls whose only argument is a path. */
#define STOP_PATH(name)                                                                                                \
    int name(const char *path)                                                                                         \
    {                                                                                                                  \
        int (*real)(const char *) = NULL;                                                                              \
        find(&real, #name);                                                                                            \
        return stop(OUT) && !full ? -1 : real(path);                                                                   \
    }
STOP_PATH(unlink)
STOP_PATH(rmdir)

int mkdir(const char *path, mode_t mode)
{
    int (*real)(const char *, mode_t) = NULL;
    find(&real, "mkdir");
    return stop(OUT) ? -1 : real(path, mode);
}

void *malloc(size_t n) { return stop(MEMORY) ? NULL : __libc_malloc(n); }
void *calloc(size_t n, size_t size) { return stop(MEMORY) ? NULL : __libc_calloc(n, size); }
void *realloc(void *old, size_t n) { return stop(MEMORY) ? NULL : __libc_realloc(old, n); }
void *aligned_alloc(size_t align, size_t n) { return stop(MEMORY) ? NULL : __libc_memalign(align, n); }

__attribute__((destructor)) static void tell(void)
{
    const char *const path = getenv("SMR_STOP_COUNT");
    FILE *const file = path != NULL ? fopen(path, "w") : NULL;
    if (file == NULL)
        return;
    (void)fprintf(file, "%ld\n", calls);
    (void)fclose(file);
}
