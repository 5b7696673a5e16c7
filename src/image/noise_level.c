/* noise_level.c: the noise of an image: the standard deviation of what differs between neighbouring voxels and is no
 * edge. Method: at places all over the image the 3 x 3 mask 1 -2 1, -2 4 -2, 1 -2 1 (Immerkaer 1996), which is 0 on
 * planes and straight edges; the median of absolute values, which few corners and textures do not move.
 * Bounds: two passes of SMR_PLACES cubed places, nine samples each.
 * SPDX-License-Identifier: MIT */
#include "image/volume.h"

#define SMR_PLACES 16u      /* number of places along each axis */
#define SMR_BINS 256u       /* of the histogram that the median is read from */
#define SMR_BINS_MEAN 32.0f /* number of bins below the mean absolute value */
#define SMR_MASK_SD 4.05f   /* median absolute value of the mask on unit normal noise: 6 * 0.6745 */

/* Nine voxels in a plane. */
typedef struct patch {
    float sum;  /* of their intensities */
    float bend; /* absolute value of the mask, intensity */
} patch;

/* Writes the world coordinates of the step from voxel to voxel along an axis. */
static smr_vec voxel_step(const smr_volume *v, uint32_t axis)
{
    const float *d = v->direction + axis;
    return smr_scale(smr_v(d[0], d[3], d[6]), v->spacing[axis]);
}

/* Looks at a place, in the plane of two axes. Returns 0 when a sample lies outside the image. */
static int look(const smr_grid *grid, uint32_t place, const uint32_t axis[2], patch *p)
{
    const smr_volume *v = &grid->volume;
    const smr_vec along = voxel_step(v, axis[0]), across = voxel_step(v, axis[1]);
    smr_vec at = smr_sub(smr_load(v->origin), smr_add(along, across));
    for (uint32_t a = 0; a < 3u; a++, place /= SMR_PLACES) {
        const uint32_t inner = v->size[a] > 2u ? v->size[a] - 2u : 1u, first = v->size[a] > 2u ? 1u : 0u;
        const uint32_t index = first + place % SMR_PLACES * inner / SMR_PLACES;
        at = smr_add(at, smr_scale(voxel_step(v, a), (float)index));
    }
    *p = (patch){0.0f, 0.0f};
    for (uint32_t row = 0; row < 3u; row++, at = smr_add(at, across)) {
        float value[3];
        uint8_t inside[3];
        if (smr_grid_line(grid, at, along, 3, value, inside) < 3u)
            return 0;
        p->sum += value[0] + value[1] + value[2];
        p->bend += (value[0] - 2.0f * value[1] + value[2]) * (row == 1u ? -2.0f : 1.0f);
    }
    p->bend = smr_abs(p->bend);
    return 1;
}

/* Returns the median of the mask's absolute values where the image is brighter than in the mean: not in air. */
static float median(const smr_grid *grid, const uint32_t axis[2], float mean, float bend)
{
    uint16_t bin[SMR_BINS] = {0};
    uint32_t n = 0, below = 0, k = 0;
    patch p;
    for (uint32_t i = 0; i < SMR_PLACES * SMR_PLACES * SMR_PLACES; i++)
        if (look(grid, i, axis, &p) && p.sum >= mean) {
            bin[(uint32_t)smr_min(p.bend / bend * SMR_BINS_MEAN, (float)(SMR_BINS - 1u))]++;
            n++;
        }
    for (; k + 1u < SMR_BINS && below + bin[k] < smr_ceil_div(n, 2); k++)
        below += bin[k];
    return k == 0u ? 0.0f : ((float)k + 0.5f) * (bend / SMR_BINS_MEAN);
}

float smr_grid_noise(const smr_grid *grid)
{
    const smr_volume *v = &grid->volume;
    const uint32_t coarse = v->spacing[2] >= smr_max(v->spacing[0], v->spacing[1])   ? 2u
                            : v->spacing[1] >= smr_max(v->spacing[0], v->spacing[2]) ? 1u
                                                                                     : 0u;
    const uint32_t axis[2] = {coarse == 0u ? 1u : 0u, coarse == 2u ? 1u : 2u};
    float n = 0.0f, sum = 0.0f, bend = 0.0f;
    patch p;
    for (uint32_t i = 0; i < SMR_PLACES * SMR_PLACES * SMR_PLACES; i++)
        if (look(grid, i, axis, &p)) {
            sum += p.sum;
            bend += p.bend;
            n += 1.0f;
        }
    return bend > 0.0f && smr_within(bend, 1.0e30f) ? median(grid, axis, sum / n, bend / n) * (1.0f / SMR_MASK_SD)
                                                    : 0.0f;
}
