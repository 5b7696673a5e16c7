/* memory.h: aligned memory from the system.
 * SPDX-License-Identifier: MIT */
#ifndef MEMORY_H
#define MEMORY_H

#include <stddef.h>

/* At least one byte at a 64-byte aligned address; NULL when out of memory. Released by free(). */
void *host_alloc(size_t bytes);

/* Like host_alloc, for large arrays with scattered reads, such as voxels. Uses huge pages where the system has them:
 * with pages of 4 KB the address look-ups take as long as the reads. */
void *host_alloc_scattered(size_t bytes);

#endif
