/* prove_fixed.c: fixed-point sums are defined for all floats: no shift or conversion overflows, for any bound, any
 * value, infinities and NaN included, and any sum.
 * SPDX-License-Identifier: MIT */
#include "base/fixed_point.h"
#include "prove.h"

int main(void)
{
    uint32_t bits, sum[3];
    PROVE_HOSTILE(&bits, sizeof bits);
    PROVE_HOSTILE(sum, sizeof sum);
    const float scale = smr_fixed_scale(smr_float_of(bits));
    //@ assert \is_finite(scale);
    (void)smr_fixed(smr_float_of(bits));
    const smr_vec v = smr_unfix3(sum, Frama_C_float_interval(8.6e-19f, 1.2e18f));
    //@ assert \is_finite(v.x);
    const float whole = smr_whole_number(smr_float_of(bits));
    //@ assert -1073741824.0 <= whole <= 1073741824.0;
    return 0;
}
