/* fixed_point.h: exact sums. Quantities are rounded once to 32-bit fixed point and summed with wrap-around in
 * uint32_t: integer addition is exact and associative, so any order, any vector width and any number of
 * threads gives the same bits, and the update chain of paper 2.2 cannot drift. Partial sums may wrap as
 * long as the final sum fits; smr_fixed_scale() chooses the scale so that it does.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FIXED_POINT_H
#define SMR_FIXED_POINT_H

#include "base/bytes.h"

/* The largest power of two s with bound * s <= 2^30, within 2^-60 .. 2^60; 1 for a bound of zero.
 * bound: largest absolute final sum, finite and not negative. */
static inline float smr_fixed_scale(float bound)
{
    if (!(bound > 0.0f))
        return 1.0f;
    /* bound = m 2^e with 1 <= m < 2: s = 2^(29 - e), or twice that when m is 1. Read from the bits, so that it always takes as long. */
    const uint32_t bits = smr_float_bits(bound);
    const int e = (int)(bits >> 23) - 127, fits = 29 - e + ((bits & 0x7fffffu) == 0u ? 1 : 0);
    const int power = fits < -60 ? -60 : (fits > 60 ? 60 : fits);
    const uint32_t scale = (uint32_t)(power + 127) << 23;
    float s;
    memcpy(&s, &scale, sizeof s);
    return s;
}

/* Rounds to the nearest integer, halves away from zero (odd integers within 2^23 .. 2^24 to the even one above);
 * beyond +-2^30 (and for NaN) to the limit. */
static inline uint32_t smr_fixed(float v)
{
    const float limit = 1073741824.0f;
    float r = v + (v < 0.0f ? -0.5f : 0.5f);
    r = r < limit ? r : limit;
    r = r > -limit ? r : -limit;
    return (uint32_t)(int32_t)r;
}

/* A final sum back to float. */
static inline float smr_unfix(uint32_t sum, float inverse_scale)
{
    int32_t v;
    memcpy(&v, &sum, sizeof v);
    return (float)v * inverse_scale;
}

#endif
