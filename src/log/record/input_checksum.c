/* input_checksum.c: checksums of whole inputs for the log, by which a replay detects other inputs.
 * Bounds: one pass over points, triangles or voxels.
 * SPDX-License-Identifier: MIT */
#include "log/record/log_format.h"

#define SMR_GOLDEN 0x9e3779b97f4a7c15u /* 2^64 divided by the golden ratio */

/* Returns the checksum `sum` continued by one more value. */
static uint64_t add(uint64_t sum, uint64_t value) { return smr_mix(sum * SMR_GOLDEN + value); }

static uint64_t add_points(uint64_t sum, const float *xyz, uint32_t n)
{
    for (size_t i = 0; i < n; i++) {
        const float *p = xyz + 3u * i;
        sum = add(add(sum, (uint64_t)smr_float_bits(p[0]) << 32 | smr_float_bits(p[1])), smr_float_bits(p[2]));
    }
    return sum;
}

static uint64_t add_values(uint64_t sum, const float *value, size_t n)
{
    for (size_t i = 0; i < n; i++)
        sum = add(sum, smr_float_bits(value[i]));
    return sum;
}

/* Returns sum, but 1 when sum is 0, because a checksum of 0 stands for no input. */
static uint64_t closed(uint64_t sum) { return sum == 0u ? 1u : sum; }

uint64_t smr_points_checksum(const float *xyz, uint32_t n) { return closed(add_points(n, xyz, n)); }

static uint64_t add_cloud(const smr_surface *s)
{
    const uint64_t sum = add_points(add_points(s->n_vertices, s->xyz, s->n_vertices), s->normal, s->n_vertices);
    return add_values(sum, s->area, s->n_vertices);
}

uint64_t smr_target_checksum(const smr_surface *surface)
{
    return smr_is_cloud(surface) ? closed(add(add_cloud(surface), surface->capacity)) : smr_surface_checksum(surface);
}

uint64_t smr_goals_checksum(const smr_goals *goals, uint32_t n)
{
    return closed(add_values(add_points(n, goals->xyz, n), goals->weights, goals->weights != NULL ? n : 0u));
}

static uint64_t motion_checksum(const smr_motion *motion, uint32_t n)
{
    uint64_t sum = add(n, (motion->mass != NULL ? 1u : 0u) + (motion->velocity != NULL ? 2u : 0u));
    sum = add_values(sum, motion->mass, motion->mass != NULL ? n : 0u);
    return closed(motion->velocity != NULL ? add_points(sum, motion->velocity, n) : sum);
}

uint64_t smr_surface_checksum(const smr_surface *s)
{
    const uint32_t nt = s->tree.n_triangles;
    const float origin[3] = {s->origin.x, s->origin.y, s->origin.z};
    uint64_t sum = add_points((uint64_t)s->n_vertices << 32 | nt, origin, 1);
    sum = add_points(sum, s->xyz, s->n_vertices);
    for (size_t k = 0; k < nt; k++) {
        const uint32_t *t = s->triangle + 3u * k;
        sum = add(add(sum, (uint64_t)t[0] << 32 | t[1]), (uint64_t)t[2] << 32 | s->original[k]);
    }
    return closed(sum);
}

/* Returns voxel i, of 1, 2 or 4 bytes, as a number. */
static uint32_t voxel(const void *voxels, uint32_t bytes, size_t i)
{
    uint32_t four;
    if (bytes < 4u)
        return bytes == 2u ? ((const uint16_t *)voxels)[i] : ((const uint8_t *)voxels)[i];
    memcpy(&four, (const float *)voxels + i, sizeof four);
    return four;
}

static uint64_t add_voxels(uint64_t sum, const void *voxels, uint32_t bytes, size_t n)
{
    const uint32_t share = 8u / bytes; /* number of voxels in a word of 8 bytes */
    for (size_t i = 0; i < n; i += share) {
        const size_t last = n - i < share ? n : i + share;
        uint64_t word = 0;
        for (size_t k = i; k < last; k++)
            word = word << (8u * bytes) | voxel(voxels, bytes, k);
        sum = add(sum, word);
    }
    return sum;
}

uint64_t smr_volume_checksum(const smr_volume *v)
{
    const uint32_t bytes = v->type <= SMR_VOXEL_INT8 ? 1u : (v->type <= SMR_VOXEL_INT16 ? 2u : 4u);
    const size_t n = (size_t)v->size[0] * v->size[1] * v->size[2];
    uint64_t sum = v->type * 2u + (v->mask != NULL);
    for (uint32_t a = 0; a < 3u; a++)
        sum = add(sum, v->size[a]);
    sum = add_points(add_points(sum, v->origin, 1), v->spacing, 1);
    sum = add_voxels(add_points(sum, v->direction, 3), v->voxels, bytes, n);
    return closed(v->mask != NULL ? add_voxels(sum, v->mask, 1, n) : sum);
}

uint64_t smr_log_checksum(uint32_t kind, const void *what, uint32_t n)
{
    if (what == NULL)
        return 0;
    switch (kind) {
    case SMR_LOG_POINTS: return closed(add_cloud(&((const smr_points *)what)->surface));
    case SMR_LOG_VOLUME: return smr_volume_checksum(what);
    case SMR_LOG_POSITIONS: return smr_points_checksum(what, n);
    case SMR_LOG_MOTION: return motion_checksum(what, n);
    case SMR_LOG_GOALS: return ((const smr_goals *)what)->xyz == NULL ? 0u : smr_goals_checksum(what, n);
    default: return smr_surface_checksum(what);
    }
}
