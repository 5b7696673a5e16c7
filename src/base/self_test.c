/* self_test.c: tests whether compiler and processor do float arithmetic as the library's bits need it (docs/SPEC.md,
 * section 1). Inputs are volatile, so that the compiler computes nothing. No probe raises a floating-point trap.
 * Bounds: about a hundred operations, under a hundred bytes of stack.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"

#define SMR_PROBES 4u /* operations of each probe, enough to be vectorised: vector units may have a mode of their own */

/* Returns v in a way that the compiler cannot compute beforehand. */
static float number(float v)
{
    const volatile float at = v;
    return at;
}

static float number_of_bits(uint32_t bits)
{
    const volatile uint32_t at = bits;
    return smr_float_of(at);
}

/* Returns 1 when each of the SMR_PROBES products a[i] * b[i] has these bits. */
static int products_are(const float *a, const float *b, uint32_t bits)
{
    float product[SMR_PROBES];
    int same = 1;
    for (uint32_t i = 0; i < SMR_PROBES; i++)
        product[i] = a[i] * b[i];
    for (uint32_t i = 0; i < SMR_PROBES; i++)
        same &= smr_float_bits(product[i]) == bits;
    return same;
}

/* Returns 1 when products and sums are fused: (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24 then keeps the last term, which a float
 * loses. Each product has inputs of its own, because compilers do not fuse a product that is used twice. */
static int fused(void)
{
    const float x = 1.000244140625f, z = number(1.00048828125f), lost = 5.9604644775390625e-8f; /* 2^-24 */
    const float less = number(x) * number(x) - z, more = z - number(x) * number(x);
    const float sum = number(x) * number(x) + -z;
    return less == lost || more == -lost || sum == lost;
}

/* Returns 1 when results or inputs below 2^-126 are flushed: 2^-126 / 2 or 2^-149 * 2^30 is then 0. */
static int flushed(void)
{
    float small[SMR_PROBES], half[SMR_PROBES], smallest[SMR_PROBES], large[SMR_PROBES];
    for (uint32_t i = 0; i < SMR_PROBES; i++) {
        small[i] = number_of_bits(0x00800000u);
        half[i] = number(0.5f);
        smallest[i] = number_of_bits(1u);
        large[i] = number(1073741824.0f);
    }
    const float difference = number_of_bits(0x00800001u) - number_of_bits(0x00800000u);
    return !products_are(small, half, 0x00400000u) || !products_are(smallest, large, 0x04000000u) ||
           smr_float_bits(difference) != 1u;
}

/* Returns 1 when sums keep more bits than a float, or the compiler takes a + b - a for b: 2^24 + 1 has no float. */
static int excess(void)
{
    const float a = number(16777216.0f), b = number(1.0f);
    return (a + b) - a == 1.0f;
}

/* Returns 1 unless sums, quotients, roots and conversions round to the nearest float, and halves to even. */
static int rounded(void)
{
    const float one = number(1.0f), step = number(1.1920928955078125e-7f); /* 2^-23, from one float to the next */
    const float next = one + step, down = one + 0.25f * step, up = one + 0.75f * step;
    const int nearest = down == one && up == next && -one - 0.25f * step == -one && -one - 0.75f * step == -next;
    const int even = one + 0.5f * step == one && next + 0.5f * step == one + 2.0f * step;
    const volatile int32_t odd = 16777217;
    const float quotient = one / number(3.0f), root = SMR_SQRT(number(2.0f));
    return !nearest || !even || (float)odd != number(16777216.0f) || smr_float_bits(quotient) != 0x3eaaaaabu ||
           smr_float_bits(root) != 0x3fb504f3u;
}

/* With excess bits, sums and quotients also look fused and wrongly rounded: only the excess is reported then. */
uint32_t smr_self_test(void)
{
    const uint32_t flush = flushed() ? SMR_FLOAT_FLUSHED : 0u;
    if (excess())
        return SMR_FLOAT_EXCESS | flush;
    return (fused() ? SMR_FLOAT_FUSED : 0u) | flush | (rounded() ? SMR_FLOAT_ROUNDING : 0u);
}
