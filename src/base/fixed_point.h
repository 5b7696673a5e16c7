/* fixed_point.h: exact sums in 32-bit fixed point that wraps around in uint32_t. Each term is rounded once. Integer
 * addition is exact and associative, so any order, vector width and number of threads gives the same bits, and the
 * chain Sigma_i = Sigma_k + zeta+ - zeta- (paper 2.2) does not drift. Partial sums may wrap; the final sum must fit.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FIXED_POINT_H
#define SMR_FIXED_POINT_H

#include "base/bytes.h"
#include "base/vec.h"

/* Returns the factor s from floats to fixed point: the largest power of two in 2^-60 .. 2^60 with bound * s <= 2^30.
 * bound: the largest absolute value of a final sum, finite and not negative; 0 gives s = 1. */
static inline float smr_fixed_scale(float bound)
{
    if (!(bound > 0.0f))
        return 1.0f;
    /* bound is m 2^e with 1 <= m < 2, as its bits tell. The scale is 2^(29 - e), or 2^(30 - e) when m is 1. */
    const uint32_t bits = smr_float_bits(bound);
    const int e = (int)(bits >> 23) - 127, fits = 29 - e + ((bits & 0x7fffffu) == 0u ? 1 : 0);
    const int power = fits < -60 ? -60 : (fits > 60 ? 60 : fits);
    return smr_float_of((uint32_t)(power + 127) << 23);
}

/* Returns 0.5 with the sign of v, without a branch: compilers vectorise loops that call the function. */
static inline float smr_half_like(float v) { return smr_float_of((smr_float_bits(v) & 0x80000000u) | 0x3f000000u); }

/* Returns v rounded to the nearest integer, halves away from zero, as two's complement. Odd integers of
 * 2^23 .. 2^24 grow by 1 in size, to even integers; values beyond +-2^30 become that limit, and NaN becomes 2^30. */
static inline uint32_t smr_fixed(float v)
{
    const float limit = 1073741824.0f;
    float r = v + smr_half_like(v);
    r = r < limit ? r : limit;
    r = r > -limit ? r : -limit;
    return (uint32_t)(int32_t)r;
}

/* Returns a final sum as a float: the signed value of `sum` times inverse_scale. */
static inline float smr_unfix(uint32_t sum, float inverse_scale) { return (float)smr_signed(sum) * inverse_scale; }

/* Returns the three sums at `sum` as a vector of floats: their signed values times inverse_scale. */
static inline smr_vec smr_unfix3(const uint32_t *sum, float inverse_scale)
{
    return smr_v(smr_unfix(sum[0], inverse_scale), smr_unfix(sum[1], inverse_scale), smr_unfix(sum[2], inverse_scale));
}

#endif
