/* noise_level.c: the noise of an image: the standard deviation of what differs between neighbouring voxels and is no
 * edge. Method: at places all over the image the 3 x 3 mask 1 -2 1, -2 4 -2, 1 -2 1 (Immerkaer 1996), which is 0 on
 * planes and straight edges; the median of absolute values, which few corners and textures do not move.
 * Bounds: two passes of SMR_PLACES cubed places, nine samples each.
 * SPDX-License-Identifier: MIT */
#include "image/volume.h"

#define SMR_PLACES 16u      /* number of places along each axis */
#define SMR_BINS 256u       /* of the histogram that the median is read from */
#define SMR_BINS_MEAN 32.0f /* number of bins below the mean absolute value */
#define SMR_LARGEST 1.0e30f /* intensity: larger sums, and NaN, give the noise 0 */
#define SMR_MASK_SD 4.05f   /* median absolute value of the mask on unit normal noise: 6 * 0.6745 */

uint32_t smr_longest_axis(const smr_volume *v)
{
    const float *const s = v->spacing;
    return s[2] >= smr_max(s[0], s[1]) ? 2u : s[1] >= s[0] ? 1u : 0u;
}

/* Steps from voxel to voxel, mm: along two axes in whose plane noise is measured, and along the longest voxel axis. */
typedef struct strides {
    smr_vec step[3];
    uint32_t axis[3]; /* axes of the steps */
} strides;

static strides steps_of(const smr_volume *v)
{
    strides s;
    const uint32_t longest = smr_longest_axis(v);
    for (uint32_t i = 0; i < 3u; i++) {
        const uint32_t a = (longest + 1u + i) % 3u;
        const float *d = v->direction + a;
        s.axis[i] = a;
        s.step[i] = smr_scale(smr_v(d[0], d[3], d[6]), v->spacing[a]);
    }
    return s;
}

/* Writes the sum of nine voxels at a place, and the absolute value of the mask. Returns 0 when one lies outside. */
static int look(const smr_grid *grid, const strides *s, uint32_t place, float *sum, float *bend)
{
    smr_vec at = smr_load(grid->volume.origin);
    for (uint32_t i = 0; i < 3u; i++, place /= SMR_PLACES) {
        const uint32_t size = grid->volume.size[s->axis[i]], inner = smr_max_u32(size, 3u) - 2u;
        const uint32_t first = place % SMR_PLACES * inner / SMR_PLACES + (i == 2u && size > 2u ? 1u : 0u);
        at = smr_add(at, smr_scale(s->step[i], (float)first));
    }
    *sum = *bend = 0.0f;
    for (uint32_t row = 0; row < 3u; row++, at = smr_add(at, s->step[1])) {
        float value[3];
        uint8_t inside[3];
        if (smr_grid_line(grid, at, s->step[0], 3, value, inside) < 3u)
            return 0;
        *sum += value[0] + value[1] + value[2];
        *bend += (value[0] - 2.0f * value[1] + value[2]) * (row == 1u ? -2.0f : 1.0f);
    }
    *bend = smr_abs(*bend);
    return 1;
}

float smr_grid_noise(const smr_grid *grid)
{
    const strides s = steps_of(&grid->volume);
    uint16_t bin[SMR_BINS] = {0};
    uint32_t n = 0, k = 0;
    float mean = 0.0f, size = 0.0f, sum, bend; /* of the nine voxels' sums; of a bin */
    for (uint32_t i = 0; i < 2u * SMR_PLACES * SMR_PLACES * SMR_PLACES;
         i++) { /* first all places, then the bright ones */
        const uint32_t place = i % (SMR_PLACES * SMR_PLACES * SMR_PLACES);
        if (place == 0u && i > 0u) {
            if (!smr_within(size, SMR_LARGEST) || !(size > 0.0f))
                return 0.0f;
            const float per = 1.0f / (float)n; /* one quotient: two would be lanes of a vector that divides 0 by 0 */
            mean *= per;
            size *= per * (1.0f / SMR_BINS_MEAN);
            n = 0;
        }
        if (!look(grid, &s, place, &sum, &bend) || (place < i && sum < mean))
            continue;
        n++;
        if (place < i) {
            bin[(uint32_t)smr_min(bend / size, (float)(SMR_BINS - 1u))]++;
        } else {
            mean += sum;
            size += bend;
        }
    }
    for (uint32_t left = n / 2u; k + 1u < SMR_BINS && bin[k] <= left; k++)
        left -= bin[k];
    return k == 0u || n == 0u ? 0.0f : ((float)k + 0.5f) * size * (1.0f / SMR_MASK_SD);
}
