/* thick_line.c: samples of an image with noise: means over a line, lines beside it and neighbours along it. The lines
 * beside it lie along the surface, where an edge does not blur. Distances are in voxels: noise differs between voxels.
 * Bounds: the line, SMR_LINES_BESIDE lines of every third sample, and 2 SMR_ALONG + 1 multiply-adds a sample.
 * SPDX-License-Identifier: MIT */
#include "image/intensity_profile.h"
#include "image/volume.h"

#define SMR_LINES_BESIDE 20u   /* number of lines beside a line in an image with much noise */
#define SMR_LINES_LITTLE 8u    /* number of lines beside a line in an image with little noise */
#define SMR_LINES_FEW 4u       /* number of lines beside a line where many vertices are active */
#define SMR_LITTLE 1.5f        /* largest noise that counts as little */
#define SMR_EVERY 3u           /* a line beside has every SMR_EVERY-th sample; successive lines have different ones */
#define SMR_OWN 12u            /* weight of samples of the line itself */
#define SMR_ALONG 8u           /* largest number of neighbours along the line to either side that count */
#define SMR_ALONG_MOST 2.1f    /* largest distance of these neighbours / smallest voxel size */
#define SMR_TALL 2.0f          /* largest distance between lines / smallest voxel size */
#define SMR_ALONG_LEAST2 0.02f /* squared length on the surface of a unit axis below which another axis is taken */

/* Steps along the surface to the lines beside a line, and the weights of their samples, near ones first. */
static const struct {
    int8_t u, v;
    uint8_t weight;
} beside[SMR_LINES_BESIDE] = {{0, 1, 26},  {1, 0, 26}, {0, -1, 26}, {-1, 0, 26}, {1, 1, 18}, {-1, -1, 18}, {1, -1, 18},
                              {-1, 1, 18}, {0, 2, 7},  {2, 0, 7},   {0, -2, 7},  {-2, 0, 7}, {1, 2, 3},    {-1, -2, 3},
                              {1, -2, 3},  {-1, 2, 3}, {2, 1, 3},   {-2, -1, 3}, {2, -1, 3}, {-2, 1, 3}};

/* Writes two directions at right angles to a line, side[0] near the longest voxel axis. Each is as long as from voxel
 * to voxel in its direction, and at most `most` mm. */
static void across(const smr_grid *grid, smr_vec along, float most, smr_vec side[2])
{
    const smr_vec normal = smr_scale(along, 1.0f / smr_length(along));
    uint32_t axis = smr_longest_axis(&grid->volume);
    for (uint32_t turn = 0; turn < 2u; turn++, axis = (axis + 1u) % 3u) {
        const float *d = grid->volume.direction + axis;
        side[1] = smr_cross(normal, smr_v(d[0], d[3], d[6]));
        if (smr_dot(side[1], side[1]) > SMR_ALONG_LEAST2)
            break;
    }
    side[0] = smr_cross(side[1], normal);
    for (uint32_t i = 0; i < 2u; i++)
        side[i] =
            smr_scale(side[i], smr_min(1.0f / smr_length(smr_grid_vector(grid, side[i])), most / smr_length(side[i])));
}

/* Replaces weighted sums value[n], of samples inside the image, by means over neighbours nearer than `reach` samples,
 * whose weights fall with the distance d as (1 - (d / reach)^2)^2. */
static void smooth_along(float reach, uint32_t n, float *value, const uint8_t *weight, const uint8_t *inside)
{
    float kernel[SMR_ALONG + 1u], mean[SMR_LINE_MAX];
    uint32_t size = 0;
    for (; size <= SMR_ALONG && (float)size < reach; size++) {
        const float d = (float)size / reach, w = 1.0f - d * d;
        kernel[size] = w * w;
    }
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t first = k + 1u > size ? k + 1u - size : 0u, last = smr_min_u32(k + size, n);
        float sum = 0.0f, all = 0.0f;
        for (uint32_t i = first; inside[k] && i < last; i++) {
            const float w = kernel[i > k ? i - k : k - i];
            sum += w * value[i];
            all += w * (float)weight[i];
        }
        mean[k] = inside[k] ? sum / all : 0.0f;
    }
    memcpy(value, mean, n * sizeof *value);
}

/* Adds every SMR_EVERY-th sample of a line from sample `first` to the sums value[n], and to the sums of weights. */
static void add_line(const smr_grid *grid, smr_vec at, smr_vec spacing, uint32_t first, uint32_t n, uint8_t each,
                     float *value, uint8_t *weight)
{
    float other[SMR_LINE_MAX / SMR_EVERY + 1u];
    uint8_t inside[SMR_LINE_MAX / SMR_EVERY + 1u];
    const uint32_t some = n > first ? smr_ceil_div(n - first, SMR_EVERY) : 0u;
    const smr_vec start = smr_add(at, smr_scale(spacing, (float)first));
    (void)smr_grid_line(grid, start, smr_scale(spacing, (float)SMR_EVERY), some, other, inside);
    for (uint32_t i = 0, k = first; i < some; i++, k += SMR_EVERY) {
        value[k] += (float)each * other[i]; /* 0 outside the image */
        weight[k] = (uint8_t)(weight[k] + (inside[i] ? each : 0u));
    }
}

uint32_t smr_grid_thick_line(const smr_grid *grid, float noise, int few, smr_vec start, smr_vec spacing, uint32_t n,
                             float *value, uint8_t *inside)
{
    const uint32_t count = smr_grid_line(grid, start, spacing, n, value, inside);
    const uint32_t lines = few ? SMR_LINES_FEW : noise > SMR_LITTLE ? SMR_LINES_BESIDE : SMR_LINES_LITTLE;
    const float *const size = grid->volume.spacing, voxel = smr_min(size[0], smr_min(size[1], size[2]));
    const float reach = smr_min(0.8f + 0.4f * noise, SMR_ALONG_MOST) * voxel / smr_length(spacing);
    uint8_t weight[SMR_LINE_MAX];
    smr_vec side[2];
    if (count == 0u)
        return 0;
    for (uint32_t k = 0; k < n; k++) {
        value[k] *= (float)SMR_OWN;
        weight[k] = inside[k] ? SMR_OWN : 0u;
    }
    across(grid, spacing, smr_max(SMR_TALL, noise) * voxel, side);
    for (uint32_t i = 0; i < lines; i++) {
        const smr_vec off = smr_add(smr_scale(side[0], (float)beside[i].u), smr_scale(side[1], (float)beside[i].v));
        add_line(grid, smr_add(start, off), spacing, i % SMR_EVERY, n, beside[i].weight, value, weight);
    }
    smooth_along(reach, n, value, weight, inside);
    return count;
}
