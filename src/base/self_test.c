/* self_test.c: tests whether compiler and processor do float arithmetic as the library's bits need it (docs/SPEC.md,
 * section 1). Inputs are volatile, so that the compiler computes nothing. No probe raises a floating-point trap.
 * Bounds: about a hundred operations, under a hundred bytes of stack.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"

#define SMR_PROBES 4u /* products in a probe, enough to be vectorised: vector units may flush in a mode of their own */

/* Returns v by way of volatile memory, so that the compiler cannot compute with v beforehand. */
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

typedef float probes __attribute__((vector_size(4 * SMR_PROBES))); /* as lanes are (lanes.h) */

/* Returns 1 when the bits of each of the SMR_PROBES products a[i] * b[i], also as lanes, equal `bits`. */
static int products_are(const float *a, const float *b, uint32_t bits)
{
    float product[SMR_PROBES];
    probes left, right;
    int same = 1;
    memcpy(&left, a, sizeof left);
    memcpy(&right, b, sizeof right);
    const volatile probes at_once = left * right; /* volatile: else compilers multiply one by one */
    for (uint32_t i = 0; i < SMR_PROBES; i++)
        same &= smr_float_bits(at_once[i]) == bits;
    for (uint32_t i = 0; i < SMR_PROBES; i++)
        product[i] = a[i] * b[i];
    for (uint32_t i = 0; i < SMR_PROBES; i++)
        same &= smr_float_bits(product[i]) == bits;
    return same;
}

/* Returns 1 when product and sum are rounded only once: (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24 then keeps the last term,
 * which a float loses. Each product has its own inputs, because compilers do not fuse a product that is used twice. */
static int fused(void)
{
    const float x = 1.000244140625f, z = number(1.00048828125f), lost = 5.9604644775390625e-8f; /* lost = 2^-24 */
    const float less = number(x) * number(x) - z, more = z - number(x) * number(x);
    const float sum = number(x) * number(x) + -z;
    return less == lost || more == -lost || sum == lost;
}

/* Returns 1 when results or inputs below 2^-126 are flushed to 0: 2^-126 / 2 or 2^-149 * 2^30 is then 0. */
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

/* Returns 1 when (a + b) - a is b for 2^24 and 1: sums keep more bits than a float, which cannot hold 2^24 + 1. */
static int excess(void)
{
    const float a = number(16777216.0f), b = number(1.0f);
    return (a + b) - a == 1.0f;
}

/* Returns 1 when a sum, quotient, root or conversion is not rounded to the nearest float, halves to even. */
static int rounded(void)
{
    const float one = number(1.0f), step = number(1.1920928955078125e-7f); /* step: 2^-23, from 1 to the next float */
    const float next = one + step, down = one + 0.25f * step, up = one + 0.75f * step;
    const int nearest = down == one && up == next && -one - 0.25f * step == -one && -one - 0.75f * step == -next;
    const int even = one + 0.5f * step == one && next + 0.5f * step == one + 2.0f * step;
    const volatile int32_t odd = 16777217;
    const float quotient = one / number(3.0f), root = SMR_SQRT(number(2.0f));
    return !nearest || !even || (float)odd != number(16777216.0f) || smr_float_bits(quotient) != 0x3eaaaaabu ||
           smr_float_bits(root) != 0x3fb504f3u;
}

/* Returns SMR_FLOAT_... of each fault found. Excess bits would look like other faults: then only flushing is added. */
uint32_t smr_self_test(void)
{
    const uint32_t flush = flushed() ? SMR_FLOAT_FLUSHED : 0u;
    if (excess())
        return SMR_FLOAT_EXCESS | flush;
    return (fused() ? SMR_FLOAT_FUSED : 0u) | flush | (rounded() ? SMR_FLOAT_ROUNDING : 0u);
}
