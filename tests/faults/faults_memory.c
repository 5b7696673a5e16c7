/* faults_memory.c: memory whose bits a campaign flips.
 * SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "faults_memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define FAULTS_CANARY 0x5a

static void *mapped(void *p)
{
    if (p != MAP_FAILED)
        return p;
    perror("faults: mmap");
    exit(2);
}

faults_block faults_alloc(size_t bytes)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), all = (bytes + page - 1u) / page * page;
    const size_t room =
        (all - bytes) / 64u * 64u; /* the block ends as near to the guard page as its alignment allows */
    const int file = memfd_create("faults", 0), both = PROT_READ | PROT_WRITE;
    faults_block b = {NULL, NULL, bytes, all};
    if (file < 0 || ftruncate(file, (off_t)all) != 0) {
        perror("faults: memory");
        exit(2);
    }
    unsigned char *guarded = mapped(mmap(NULL, all + 2u * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    b.use = (unsigned char *)mapped(mmap(guarded + page, all, both, MAP_SHARED | MAP_FIXED, file, 0)) + room;
    b.own = (unsigned char *)mapped(mmap(NULL, all, both, MAP_SHARED, file, 0)) + room;
    (void)close(file);
    faults_frame_mend(&b);
    return b;
}

static size_t room_of(const faults_block *b) { return (b->mapped - b->bytes) / 64u * 64u; }

void faults_writable(const faults_block *b, int writable)
{
    if (mprotect(b->use - room_of(b), b->mapped, writable ? PROT_READ | PROT_WRITE : PROT_READ) != 0)
        exit(2);
}

void faults_frame_mend(const faults_block *b)
{
    memset(b->own - room_of(b), FAULTS_CANARY, room_of(b));
    memset(b->own + b->bytes, FAULTS_CANARY, b->mapped - b->bytes - room_of(b));
}

int faults_frame_intact(const faults_block *b)
{
    int intact = 1;
    for (const unsigned char *p = b->own - room_of(b); p < b->own; p++)
        intact &= *p == FAULTS_CANARY;
    for (const unsigned char *p = b->own + b->bytes; p < b->own - room_of(b) + b->mapped; p++)
        intact &= *p == FAULTS_CANARY;
    return intact;
}
