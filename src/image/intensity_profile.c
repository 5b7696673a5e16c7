/* intensity_profile.c: packs a reference intensity profile (paper 2.1) into bytes between its minimum and maximum.
 * SPDX-License-Identifier: MIT */
#include "image/intensity_profile.h"

#define SMR_FLAT 1.0e-30f /* intensity: smaller ranges count as 0, so that 255 / range stays finite */

void smr_profile_pack(const float *value, const unsigned char *inside, uint32_t n, uint8_t *packed, float *low,
                      float *range)
{
    float lo = value[0], hi = value[0];
    int all_inside = 1;
    for (uint32_t k = 0; k < n; k++) {
        all_inside &= inside[k] != 0;
        lo = smr_min(lo, value[k]);
        hi = smr_max(hi, value[k]);
    }
    *low = all_inside ? lo : 0.0f;
    *range = all_inside && hi - lo > smr_max(1.0e-6f * (smr_abs(lo) + smr_abs(hi)), SMR_FLAT) ? hi - lo : 0.0f;
    for (uint32_t k = 0; k < n; k++)
        packed[k] = *range > 0.0f ? (uint8_t)((value[k] - lo) * (255.0f / *range) + 0.5f) : 0u;
}
