/* exhaustive.c: what frama-c cannot show, by all values: the arena's sums in a size_t of 8 bits, and fixed point of all
 * floats.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "base/fixed_point.h"

/* The arena again, in numbers of 8 bits and slots aligned to 4. C widens all operands to int, so a product that would
 * wrap only does so where it is stored, as one of 64 bits does. */
#define smr_arena arena8
#define smr_arena_start arena8_start
#define smr_arena_take arena8_take
#define smr_arena_release arena8_release
#define smr_arena_measure arena8_measure
#define size_t uint8_t
#undef SIZE_MAX
#define SIZE_MAX 255u
#undef SMR_ALIGN
#define SMR_ALIGN 4u
#include "base/arena.c"
#undef size_t

static unsigned char memory[256] __attribute__((aligned(4)));

static int arena_fits(uint32_t used, uint32_t capacity, uint32_t count, uint32_t size)
{
    arena8 a = {memory, (uint8_t)capacity, (uint8_t)used, NULL};
    const unsigned char *const slot = arena8_take(&a, (uint8_t)count, (uint8_t)size);
    const uint32_t end = used + count * size;
    if (a.used != 255u && (a.used < end || a.used >= end + 4u || a.used % 4u != 0u))
        return 0;
    if (a.used == 255u && end + 16u < 255u - 4u)
        return 0; /* refused without need */
    return slot == NULL || (slot == memory + used && end <= capacity && a.used <= capacity);
}

/* The rule of smr_fixed() in double precision, which holds every sum exactly but that of the float addition. */
static uint32_t rule(float v)
{
    const float r = v + (signbit(v) ? -0.5f : 0.5f);
    const double limited = r < 1073741824.0f ? (r > -1073741824.0f ? (double)r : -1073741824.0) : 1073741824.0;
    return (uint32_t)(int32_t)limited;
}

int main(void)
{
    uint32_t failed = 0, bits = 0;
    for (uint32_t used = 0; used < 256u;
         used += used < 252u ? 4u : 3u) /* multiples of 4, and 255: an overflow before */
        for (uint32_t count = 0; count < 256u; count++)
            for (uint32_t size = 0; size < 256u; size++)
                for (uint32_t capacity = 0; capacity < 256u; capacity += 17u)
                    failed += !arena_fits(used, capacity, count, size);
    printf("%s the arena's sums in 8 bits\n", failed == 0u ? "ok" : "not ok");
    const uint32_t before = failed;
    do {
        const float v = smr_float_of(bits);
        failed += smr_fixed(v) != rule(v);
    } while (++bits != 0u);
    printf("%s fixed point of all 2^32 floats\n", failed == before ? "ok" : "not ok");
    return failed != 0u;
}
