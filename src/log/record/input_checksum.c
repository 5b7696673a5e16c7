/* input_checksum.c: checksums of whole inputs for the log, by which a replay detects other inputs.
 * Bounds: one pass over points, triangles or voxels.
 * SPDX-License-Identifier: MIT */
#include "log/record/log_format.h"

#define SMR_GOLDEN 0x9e3779b97f4a7c15u /* 2^64 divided by the golden ratio */

static uint64_t add(uint64_t sum, uint64_t value) { return smr_mix(sum * SMR_GOLDEN + value); }

/* Kinds of parts: one value; points; floats; a surface's triangles; voxels of 1, 2 or 4 bytes. */
enum { ONE = 1, POINTS, VALUES, TRIANGLES, VOXELS = 8 };

static void add_part(smr_input_sum *s, uint32_t kind, const void *at, uint64_t n)
{
    s->part[s->n_parts++] = (smr_input_part){kind, at, n};
}

/* Returns voxel i, of 1, 2 or 4 bytes, as a number. */
static uint32_t voxel(const void *voxels, uint32_t bytes, uint64_t i)
{
    uint32_t four;
    if (bytes < 4u)
        return bytes == 2u ? ((const uint16_t *)voxels)[i] : ((const uint8_t *)voxels)[i];
    memcpy(&four, (const float *)voxels + i, sizeof four);
    return four;
}

/* Adds the voxels first .. last-1, eight bytes at a time. */
static uint64_t add_voxels(uint64_t sum, const void *voxels, uint32_t bytes, uint64_t first, uint64_t last)
{
    const uint32_t share = 8u / bytes; /* number of voxels in a word of 8 bytes */
    for (uint64_t i = first; i < last; i += share) {
        const uint64_t end = last - i < share ? last : i + share;
        uint64_t word = 0;
        for (uint64_t k = i; k < end; k++)
            word = word << (8u * bytes) | voxel(voxels, bytes, k);
        sum = add(sum, word);
    }
    return sum;
}

/* Returns the sum continued by the items first .. last-1 of a part. */
static uint64_t add_items(uint64_t sum, const smr_input_part *part, uint64_t first, uint64_t last)
{
    if (part->kind > VOXELS)
        return add_voxels(sum, part->at, part->kind - VOXELS, first, last);
    for (size_t i = (size_t)first; i < last; i++) {
        const float *p = part->kind == POINTS ? (const float *)part->at + 3u * i : part->at;
        const smr_surface *s = part->at;
        const uint32_t *t = part->kind == TRIANGLES ? s->triangle + 3u * i : NULL;
        switch (part->kind) {
        case POINTS:
            sum = add(sum, (uint64_t)smr_float_bits(p[0]) << 32 | smr_float_bits(p[1]));
            sum = add(sum, smr_float_bits(p[2]));
            break;
        case VALUES: sum = add(sum, smr_float_bits(p[i])); break;
        default: sum = add(add(sum, (uint64_t)t[0] << 32 | t[1]), (uint64_t)t[2] << 32 | s->original[i]); break;
        }
    }
    return sum;
}

int smr_sum_add(smr_input_sum *s, uint32_t most)
{
    if (s->at_part < s->n_parts) {
        const smr_input_part *part = &s->part[s->at_part];
        const uint64_t items = part->kind > VOXELS ? 4u * (uint64_t)most : most, left = part->n - s->at;
        const uint64_t end = left < items ? part->n : s->at + items;
        s->sum = part->kind == ONE ? add(s->sum, part->n) : add_items(s->sum, part, s->at, end);
        s->at = end;
        s->at_part += part->kind == ONE || end == part->n;
        s->at = s->at_part < s->n_parts && end == part->n ? 0u : s->at;
    }
    if (s->at_part < s->n_parts)
        return 0;
    s->sum = s->sum == 0u ? 1u : s->sum; /* a checksum of 0 stands for no input */
    return 1;
}

static smr_input_sum sum_from(uint64_t sum) { return (smr_input_sum){.sum = sum}; }

static uint64_t at_once(smr_input_sum s)
{
    while (!smr_sum_add(&s, UINT32_MAX))
        ;
    return s.sum;
}

uint64_t smr_points_checksum(const float *xyz, uint32_t n)
{
    smr_input_sum s = sum_from(n);
    add_part(&s, POINTS, xyz, n);
    return at_once(s);
}

static smr_input_sum sum_of_cloud(const smr_surface *c)
{
    smr_input_sum s = sum_from(c->n_vertices);
    add_part(&s, POINTS, c->xyz, c->n_vertices);
    add_part(&s, POINTS, c->normal, c->n_vertices);
    add_part(&s, VALUES, c->area, c->n_vertices);
    return s;
}

uint64_t smr_cloud_checksum(const smr_points *points) { return at_once(sum_of_cloud(&points->surface)); }

smr_input_sum smr_sum_of_target(const smr_surface *surface)
{
    const uint32_t nt = surface->tree.n_triangles;
    smr_input_sum s =
        smr_is_cloud(surface) ? sum_of_cloud(surface) : sum_from((uint64_t)surface->n_vertices << 32 | nt);
    if (smr_is_cloud(surface)) {
        add_part(&s, ONE, NULL, surface->capacity);
        return s;
    }
    add_part(&s, POINTS, &surface->origin, 1);
    add_part(&s, POINTS, surface->xyz, surface->n_vertices);
    add_part(&s, TRIANGLES, surface, nt);
    add_part(&s, VALUES, &surface->noise_mm, surface->noise_mm > 0.0f); /* a refit's is the build's */
    return s;
}

uint64_t smr_target_checksum(const smr_surface *surface) { return at_once(smr_sum_of_target(surface)); }

smr_input_sum smr_sum_of_goals(const smr_goals *goals, uint32_t n)
{
    smr_input_sum s = sum_from(n);
    add_part(&s, POINTS, goals->xyz, n);
    add_part(&s, VALUES, goals->weights, goals->weights != NULL ? n : 0u);
    return s;
}

uint64_t smr_goals_checksum(const smr_goals *goals, uint32_t n) { return at_once(smr_sum_of_goals(goals, n)); }

uint64_t smr_motion_checksum(const smr_motion *motion, uint32_t n)
{
    smr_input_sum s = sum_from(add(n, (motion->mass != NULL ? 1u : 0u) + (motion->velocity != NULL ? 2u : 0u)));
    add_part(&s, VALUES, motion->mass, motion->mass != NULL ? n : 0u);
    add_part(&s, POINTS, motion->velocity, motion->velocity != NULL ? n : 0u);
    return at_once(s);
}

smr_input_sum smr_sum_of_volume(const smr_volume *v)
{
    const uint32_t bytes = v->type <= SMR_VOXEL_INT8 ? 1u : (v->type <= SMR_VOXEL_INT16 ? 2u : 4u);
    const uint64_t n = (uint64_t)v->size[0] * v->size[1] * v->size[2];
    smr_input_sum s = sum_from(v->type * 2u + (v->mask != NULL));
    for (uint32_t a = 0; a < 3u; a++)
        add_part(&s, ONE, NULL, v->size[a]);
    add_part(&s, POINTS, v->origin, 1);
    add_part(&s, POINTS, v->spacing, 1);
    add_part(&s, POINTS, v->direction, 3);
    add_part(&s, VOXELS + bytes, v->voxels, n);
    add_part(&s, VOXELS + 1u, v->mask, v->mask != NULL ? n : 0u);
    return s;
}

uint64_t smr_volume_checksum(const smr_volume *volume) { return at_once(smr_sum_of_volume(volume)); }

uint64_t smr_log_checksum(uint32_t kind, const void *what, uint32_t n)
{
    if (what == NULL)
        return 0;
    switch (kind) {
    case SMR_LOG_POINTS: return smr_cloud_checksum(what);
    case SMR_LOG_VOLUME: return smr_volume_checksum(what);
    case SMR_LOG_POSITIONS:
    case SMR_LOG_ALL_POSITIONS: return smr_points_checksum(what, n);
    case SMR_LOG_MOTION: return smr_motion_checksum(what, n);
    case SMR_LOG_GOALS: return ((const smr_goals *)what)->xyz == NULL ? 0u : smr_goals_checksum(what, n);
    default: return smr_target_checksum(what);
    }
}
