/* faults_memory.h: memory whose bits a campaign flips: guard pages around it, and a second view of what the library
 * may only read.
 * SPDX-License-Identifier: MIT */
#ifndef FAULTS_MEMORY_H
#define FAULTS_MEMORY_H

#include <stddef.h>
#include <stdint.h>

/* A block: `use` is what the library gets, `own` the campaign's view of the same bytes, which can always be written. */
typedef struct faults_block {
    unsigned char *use, *own;
    size_t bytes, mapped;
} faults_block;

/* A block of `bytes`, aligned to 64, between two pages without access. Ends the program where there is no memory. */
faults_block faults_alloc(size_t bytes);

/* The library may read and write the block (1), or only read it (0). */
void faults_writable(const faults_block *b, int writable);

/* 1: the bytes of the block's pages outside the block are as faults_alloc() left them. */
int faults_frame_intact(const faults_block *b);
void faults_frame_mend(const faults_block *b);

#endif
