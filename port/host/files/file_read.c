/* file_read.c: reads whole files. Sizes come from the file system, never from the file's own header.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "files/file_read.h"
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#include "files/gzip_write.h"
#include "base/system.h"
#include "files/file_names.h"

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
    if (*capacity >= HOST_UNPACKED_MAX)
        return host_fail(error, "file", "at most %zu MB after unpacking", HOST_UNPACKED_MAX >> 20);
    if (next > HOST_UNPACKED_MAX)
        next = HOST_UNPACKED_MAX;
    unsigned char *data = realloc(bytes->data, next);
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
        if (bytes->size == capacity && grow(bytes, &capacity, error) != 0)
            return -1;
        ssize_t r = read(from, bytes->data + bytes->size, capacity - bytes->size);
        if (r < 0 && errno == EINTR)
            continue;
        if (r < 0)
            return host_fail(error, "file", "a readable pipe from gzip (%s)", strerror(errno));
        bytes->size += (size_t)r;
        if (!asked && accept != NULL && bytes->size > 0 && (r == 0 || bytes->size >= HOST_HEAD_BYTES)) {
            const size_t head = bytes->size < HOST_HEAD_BYTES ? bytes->size : HOST_HEAD_BYTES;
            asked = 1;
            if (accept(&(host_head){path, bytes->data, head, r == 0 ? bytes->size : 0}, error) != 0) {
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

/* Unpacks the file open at fd, from its start, into at most HOST_UNPACKED_MAX bytes. 0, or -1 with the error filled. */
static int host_gzip_read(int fd, const char *path, host_accept accept, host_bytes *bytes, host_error *error)
{
    int ends[2] = {-1, -1};
    if (pipe(ends) != 0)
        return host_fail(error, "file", "a pipe to gzip (%s)", strerror(errno));
    /* The gzip of another thread must not inherit these: it would keep the pipe open. */
    (void)fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    (void)fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    pid_t child = fork();
    if (child == 0)
        run_gzip(fd, ends[1]);
    (void)close(ends[1]);
    if (child < 0) {
        (void)close(ends[0]);
        return host_fail(error, "file", "a process for gzip (%s)", strerror(errno));
    }
    int result = drain(ends[0], path, accept, bytes, error);
    (void)close(ends[0]);
    result = finish(child, result, bytes, error);
    if (result != 0)
        host_file_free(bytes);
    return result;
}

void host_file_free(host_bytes *bytes)
{
    free(bytes->data);
    bytes->data = NULL;
    bytes->size = 0;
}

/* Reads n bytes, or fewer at the end of the file. */
static int read_up_to(int fd, unsigned char *to, size_t n, size_t *got, host_error *error)
{
    *got = 0;
    while (*got < n) {
        const ssize_t r = read(fd, to + *got, n - *got);
        if (r < 0 && errno == EINTR)
            continue;
        if (r < 0)
            return host_fail(error, "file", "a readable file (%s)", strerror(errno));
        if (r == 0)
            break;
        *got += (size_t)r;
    }
    return 0;
}

static int read_plain(int fd, const char *path, size_t size, host_accept accept, host_bytes *bytes, host_error *error)
{
    const size_t first = size < HOST_HEAD_BYTES ? size : HOST_HEAD_BYTES;
    unsigned char head[HOST_HEAD_BYTES] = {0};
    size_t got = 0, rest = 0;
    if (read_up_to(fd, head, first, &got, error) != 0)
        return -1;
    if (accept != NULL && accept(&(host_head){path, head, got, size}, error) != 0) {
        host_kind_found(error, path, head, got);
        return -1;
    }
    bytes->data = host_alloc(size);
    if (bytes->data == NULL)
        return host_fail(error, "file", "%zu bytes of free memory", size);
    memcpy(bytes->data, head, got);
    /* If the file has become shorter meanwhile, its reader reports it as truncated. */
    if (got == first && read_up_to(fd, bytes->data + got, size - got, &rest, error) != 0) {
        host_file_free(bytes);
        return -1;
    }
    bytes->size = got + rest;
    return 0;
}

/* The files read so far. Locked, since several threads read files. */
static struct {
    pthread_mutex_t lock;
    struct file_id {
        dev_t device;
        ino_t number;
        char *path; /* owned, until the program ends or forgets it */
        host_input input;
    } * file;
    size_t n;
    int checksums; /* 1: they are kept */
} seen = {PTHREAD_MUTEX_INITIALIZER, NULL, 0, 0};

void host_file_keep_checksums(void) { seen.checksums = 1; }

static int rewind_file(int fd, host_error *error)
{
    return lseek(fd, 0, SEEK_SET) == 0 ? 0
                                       : host_fail(error, "file", "a file that can be rewound (%s)", strerror(errno));
}

int host_file_blocks(int fd, void (*take)(void *context, const unsigned char *block, size_t n), void *context,
                     host_error *error)
{
    enum { BLOCK = 1 << 16 };
    unsigned char *const block = malloc(BLOCK);
    size_t got = BLOCK;
    int result = block != NULL ? 0 : host_fail(error, "file", "free memory");
    while (result == 0 && got == BLOCK) {
        result = read_up_to(fd, block, BLOCK, &got, error);
        if (result == 0)
            take(context, block, got);
    }
    free(block);
    return result;
}

typedef struct sum {
    host_crc32 crc;
    uint64_t bytes;
} sum;

static void add_block(void *context, const unsigned char *block, size_t n)
{
    sum *const s = context;
    host_crc32_add(&s->crc, block, n);
    s->bytes += n;
}

int host_file_sum(int fd, uint64_t *bytes, uint32_t *crc32, host_error *error)
{
    sum *const s = calloc(1, sizeof *s);
    if (s == NULL)
        return host_fail(error, "file", "free memory");
    host_crc32_start(&s->crc);
    int result = host_file_blocks(fd, add_block, s, error);
    *bytes = s->bytes;
    *crc32 = host_crc32_end(&s->crc);
    free(s);
    return result;
}

/* Adds the checksum of an open file, which was read, to what is known of it. */
static int keep_checksum(int fd, size_t index, host_error *error)
{
    uint64_t bytes = 0;
    uint32_t crc32 = 0;
    if (rewind_file(fd, error) != 0 || host_file_sum(fd, &bytes, &crc32, error) != 0)
        return -1;
    (void)pthread_mutex_lock(&seen.lock);
    seen.file[index].input.crc32 = crc32;
    (void)pthread_mutex_unlock(&seen.lock);
    return 0;
}

/* *index: the file's number from here on. */
static int remember(const char *path, const struct stat *st, size_t *index)
{
    const size_t bytes = strlen(path) + 1u;
    char *const name = malloc(bytes);
    if (name == NULL)
        return -1;
    memcpy(name, path, bytes);
    (void)pthread_mutex_lock(&seen.lock);
    struct file_id *grown = realloc(seen.file, (seen.n + 1u) * sizeof *grown);
    if (grown != NULL) {
        seen.file = grown;
        seen.file[seen.n].path = name;
        seen.file[seen.n].input.path = name;
        seen.file[seen.n].input.bytes = (uint64_t)st->st_size;
        seen.file[seen.n].input.crc32 = 0;
        seen.file[seen.n].device = st->st_dev;
        seen.file[seen.n].number = st->st_ino;
        *index = seen.n++;
    }
    (void)pthread_mutex_unlock(&seen.lock);
    if (grown == NULL)
        free(name);
    return grown != NULL ? 0 : -1;
}

size_t host_file_count(void)
{
    (void)pthread_mutex_lock(&seen.lock);
    size_t n = seen.n;
    (void)pthread_mutex_unlock(&seen.lock);
    return n;
}

void host_file_forget(size_t first)
{
    (void)pthread_mutex_lock(&seen.lock);
    while (seen.n > first)
        free(seen.file[--seen.n].path);
    (void)pthread_mutex_unlock(&seen.lock);
}

static host_input file_input(size_t i)
{
    (void)pthread_mutex_lock(&seen.lock);
    host_input input = seen.file[i].input;
    (void)pthread_mutex_unlock(&seen.lock);
    return input;
}

static int by_path(const void *a, const void *b)
{
    return strcmp(((const host_input *)a)->path, ((const host_input *)b)->path);
}

int host_file_list(size_t first, size_t end, host_input **inputs)
{
    const size_t all = host_file_count();
    host_input *const list = calloc(all + 1u, sizeof *list);
    size_t n = 0, kept = 0;
    *inputs = list;
    if (list == NULL)
        return -1;
    for (size_t i = 0; i < all; i++)
        if (i < first || i >= end)
            list[n++] = file_input(i);
    qsort(list, n, sizeof *list, by_path);
    for (size_t i = 0; i < n; i++)
        if (i == 0 || strcmp(list[i].path, list[kept - 1u].path) != 0)
            list[kept++] = list[i];
    return (int)kept;
}

int host_file_was_read(const char *path)
{
    struct stat st;
    int found = 0;
    if (stat(path, &st) != 0)
        return 0;
    (void)pthread_mutex_lock(&seen.lock);
    for (size_t i = 0; i < seen.n && !found; i++)
        found = seen.file[i].device == st.st_dev && seen.file[i].number == st.st_ino;
    (void)pthread_mutex_unlock(&seen.lock);
    return found;
}

static int read_open(int fd, const char *path, host_accept accept, host_bytes *bytes, size_t *index, host_error *error)
{
    struct stat st;
    unsigned char magic[2] = {0, 0};
    size_t got = 0;
    if (fstat(fd, &st) != 0)
        return host_fail(error, "file", "a readable file (%s)", strerror(errno));
    if (S_ISDIR(st.st_mode))
        return host_kind_refuse_directory(error, path);
    if (!S_ISREG(st.st_mode))
        return host_fail(error, "file", "a regular file");
    if (remember(path, &st, index) != 0)
        return host_fail(error, "file", "free memory");
    if (st.st_size == 0)
        return host_fail(error, "file", "data, but the file is empty");
    if ((uint64_t)st.st_size > HOST_FILE_MAX)
        return host_fail(error, "file", "at most %zu MB", HOST_FILE_MAX >> 20);
    if (read_up_to(fd, magic, 2, &got, error) != 0)
        return -1;
    if (rewind_file(fd, error) != 0)
        return -1;
    if (magic[0] == 0x1f && magic[1] == 0x8b)
        return host_gzip_read(fd, path, accept, bytes, error);
    return read_plain(fd, path, (size_t)st.st_size, accept, bytes, error);
}

int host_file_read(const char *path, host_accept accept, host_bytes *bytes, host_error *error)
{
    /* Without O_NONBLOCK, opening a named pipe without a writer would block for ever. */
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    size_t index = 0;
    bytes->data = NULL;
    bytes->size = 0;
    error->file = path;
    if (fd < 0)
        return host_fail(error, "file", "a readable file (%s)", strerror(errno));
    int result = read_open(fd, path, accept, bytes, &index, error);
    if (result == 0 && seen.checksums && keep_checksum(fd, index, error) != 0) {
        host_file_free(bytes);
        result = -1;
    }
    (void)close(fd);
    return result;
}
