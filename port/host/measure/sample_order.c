/* sample_order.c: sorts by keys, digit by digit; the order of positions along a Z-order curve (Morton 1966).
 * SPDX-License-Identifier: MIT */
#include "measure/sample_order.h"
#include <math.h>
#include <stdlib.h>

#define DIGIT_BITS 11
#define DIGITS (1u << DIGIT_BITS)

static void sort_pass(const host_keyed *from, host_keyed *to, size_t n, int pass)
{
    size_t start[DIGITS] = {0}, sum = 0;
    for (size_t i = 0; i < n; i++)
        start[from[i].key >> (DIGIT_BITS * pass) & (DIGITS - 1u)]++;
    for (size_t d = 0; d < DIGITS; d++) {
        const size_t count = start[d];
        start[d] = sum;
        sum += count;
    }
    for (size_t i = 0; i < n; i++)
        to[start[from[i].key >> (DIGIT_BITS * pass) & (DIGITS - 1u)]++] = from[i];
}

void host_sort_keys(host_keyed *list, host_keyed *sorted, size_t n)
{
    sort_pass(list, sorted, n, 0);
    sort_pass(sorted, list, n, 1);
    sort_pass(list, sorted, n, 2);
}

#define CELLS 1023.0f /* cells along the box's longest side */

/* Moves bit k of a cell's number, 0 .. 1023, to bit 3 k. */
static uint32_t spread(uint32_t cell)
{
    cell = (cell | cell << 16) & 0x030000ffu;
    cell = (cell | cell << 8) & 0x0300f00fu;
    cell = (cell | cell << 4) & 0x030c30c3u;
    return (cell | cell << 2) & 0x09249249u;
}

uint32_t *host_sample_order(const float *xyz, size_t n)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, side = 0.0f;
    host_keyed *const list = calloc(2u * n + 1u, sizeof *list), *const sorted = list + n;
    uint32_t *const order = malloc((n + 1u) * sizeof *order);
    for (size_t i = 0; i < 3u * n; i++)
        low[i % 3u] = fminf(low[i % 3u], xyz[i]);
    for (size_t i = 0; i < 3u * n; i++)
        side = fmaxf(side, xyz[i] - low[i % 3u]);
    const float per = side > 0.0f ? CELLS / side : 0.0f;
    for (uint32_t i = 0; list != NULL && i < n; i++) {
        uint32_t key = 0;
        for (uint32_t c = 0; c < 3; c++)
            key |= spread((uint32_t)(per * (xyz[3u * (size_t)i + c] - low[c]))) << c;
        list[i] = (host_keyed){key, i};
    }
    if (list != NULL && order != NULL) {
        host_sort_keys(list, sorted, n);
        for (size_t i = 0; i < n; i++)
            order[i] = sorted[i].item;
        free(list);
        return order;
    }
    free(list);
    free(order);
    return NULL;
}
