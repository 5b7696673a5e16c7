/* file_checksum.c: whether a file is still the one that a report names.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "files/file_checksum.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/crc32.h"

enum { BLOCK = 1 << 16 };

typedef struct check {
    unsigned char block[BLOCK];
    host_crc32 crc;
} check;

/* Reads as many bytes as there should be; one more or one fewer is another file. */
static int same_content(int fd, uint64_t bytes, uint32_t crc32)
{
    check *const c = malloc(sizeof *c);
    uint64_t left = bytes;
    ssize_t got = 1;
    int same = 0;
    if (c == NULL)
        return 0;
    host_crc32_start(&c->crc);
    while (got > 0) {
        got = read(fd, c->block, BLOCK);
        if (got < 0 && errno == EINTR)
            got = 1;
        else if (got <= 0 || (uint64_t)got > left)
            break;
        else {
            host_crc32_add(&c->crc, c->block, (size_t)got);
            left -= (uint64_t)got;
        }
    }
    same = got == 0 && left == 0 && host_crc32_end(&c->crc) == crc32;
    free(c);
    return same;
}

int host_file_is(const char *path, uint64_t bytes, uint32_t crc32)
{
    /* Without O_NONBLOCK, opening a named pipe without a writer would block for ever. */
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat st;
    int same = 0;
    if (fd < 0)
        return 0;
    same =
        fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && (uint64_t)st.st_size == bytes && same_content(fd, bytes, crc32);
    (void)close(fd);
    return same;
}
