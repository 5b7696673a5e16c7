/* Memory that is aligned for the library, from the system.
 * SPDX-License-Identifier: MIT */
#ifndef MEMORY_H
#define MEMORY_H

#include <stddef.h>

/* Memory on a 64-byte address, at least one byte; NULL when there is none. Ends with free(). */
void *host_alloc(size_t bytes);

/* The same for many MB that are read all over, voxels above all: on huge pages if the system has them. With pages of 4 KB
 * the processor looks for their addresses as long as for the bytes. */
void *host_alloc_scattered(size_t bytes);

#endif
