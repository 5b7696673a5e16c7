/* memory.c: aligned memory from the system.
 * SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE /* madvise */

#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

void *host_alloc(size_t bytes)
{
    const size_t slots = bytes / 64u + 1u;
    return bytes > SIZE_MAX - 128u ? NULL : aligned_alloc(64u, slots * 64u);
}

#define HUGE_PAGE ((size_t)2u << 20)

void *host_alloc_scattered(size_t bytes)
{
    void *data = NULL;
    if (bytes < HUGE_PAGE || bytes > SIZE_MAX - 2u * HUGE_PAGE)
        return host_alloc(bytes);
    data = aligned_alloc(HUGE_PAGE, (bytes / HUGE_PAGE + 1u) * HUGE_PAGE);
#if defined(MADV_HUGEPAGE)
    if (data != NULL) /* only a hint; the last, partly used huge page keeps small pages */
        (void)madvise(data, bytes / HUGE_PAGE * HUGE_PAGE, MADV_HUGEPAGE);
#endif
    return data;
}
