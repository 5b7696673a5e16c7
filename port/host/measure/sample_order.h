/* sample_order.h: sorts by keys, and an order in which positions near each other are neighbours.
 * SPDX-License-Identifier: MIT */
#ifndef SAMPLE_ORDER_H
#define SAMPLE_ORDER_H

#include <stddef.h>
#include <stdint.h>

/* A key, and what is sorted by it. */
typedef struct host_keyed {
    uint32_t key, item;
} host_keyed;

/* Sorts n entries by key into sorted[n]; entries with equal keys keep their order. list[n] is scratch afterwards. */
void host_sort_keys(host_keyed *list, host_keyed *sorted, size_t n);

/* Returns the indexes [n] of positions xyz[n][3] along a Z-order curve through their box; owned by the caller. NULL:
 * out of memory. */
uint32_t *host_sample_order(const float *xyz, size_t n);

#endif
