/* fixed.h: exact sums. Quantities are rounded once to 32-bit fixed point and summed with wrap-around in
 * uint32_t: integer addition is exact and associative, so any order, any vector width and any number of
 * threads gives the same bits, and the update chain of paper 2.2 cannot drift. Partial sums may wrap as
 * long as the final sum fits; smr_fixed_scale() chooses the scale so that it does.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FIXED_H
#define SMR_FIXED_H

#include "base/base.h"

/* The largest power of two s with bound * s <= 2^30, within 2^-60 .. 2^60; 1 for a bound of zero.
 * bound: largest absolute final sum, finite and not negative. */
static inline float smr_fixed_scale(float bound)
{
    float s = 1.0f;
    if (!(bound > 0.0f))
        return 1.0f;
    for (int i = 0; i < 60 && bound * s > 1073741824.0f; i++)
        s *= 0.5f;
    for (int i = 0; i < 60 && bound * s <= 536870912.0f; i++)
        s *= 2.0f;
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
