/* points.c: a cloud of points as a ring: in a full cloud new points replace the oldest ones. A cloud has no search
 * tree, so adding a point has constant cost. For start poses and measures a cloud is copied into a surface with a
 * search tree, in which each point is a triangle without area that has the point's normal.
 * Bounds: one pass over the added points; the copy is built as a surface with as many triangles as points.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"
#include "base/arena.h"
#include "base/bytes.h"

#define SMR_NORMAL_LEAST 1.0e-3f /* length of the shortest normal; a shorter one counts as none */
#define SMR_NORMAL_MOST 1.0e3f   /* largest absolute entry of a normal */

_Static_assert(SMR_POINTS_BYTES(0) >= sizeof(smr_points) + 8u * SMR_ALIGN, "SMR_POINTS_BYTES is too small");

static void layout(smr_arena *a, uint32_t capacity, smr_points **self, smr_surface *s)
{
    *self = smr_arena_take(a, 1, sizeof **self);
    s->xyz = smr_arena_take(a, capacity, 3u * sizeof(float));
    s->normal = smr_arena_take(a, capacity, 3u * sizeof(float));
    s->area = smr_arena_take(a, capacity, sizeof(float));
}

smr_status smr_points_bytes(uint32_t capacity, size_t *bytes)
{
    smr_points *self;
    smr_surface s;
    if (bytes == NULL)
        return SMR_E_NULL;
    if (capacity == 0u || capacity > SMR_VERTICES_MAX)
        return SMR_E_INPUT;
    smr_arena a = smr_arena_measure();
    layout(&a, capacity, &self, &s);
    *bytes = a.used;
    return a.used == SIZE_MAX ? SMR_E_INPUT : SMR_OK;
}

static uint32_t guard_of(const smr_surface *s)
{
    const void *const slots[3] = {s->xyz, s->normal, s->area};
    return smr_byte_sum(s->capacity, slots, sizeof slots);
}

smr_status smr_points_open(uint32_t capacity, void *memory, size_t bytes, smr_points **points)
{
    smr_arena a;
    smr_points p = {.magic = SMR_POINTS_MAGIC,
                    .surface = {.magic = SMR_SURFACE_MAGIC, .capacity = capacity, .open = 1, .area_mean = 1.0f}};
    smr_points *self;
    size_t needed;
    if (points == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_arena_start(&a, memory, bytes));
    SMR_TRY(smr_points_bytes(capacity, &needed));
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(memory, bytes);
    layout(&a, capacity, &self, &p.surface);
    p.guard = guard_of(&p.surface);
    *self = p;
    *points = self;
    return SMR_OK;
}

/* Writes the unit normal; 0 for NULL or a too short normal. Returns 0 when the normal is not finite or too large. */
static int take_normal(const float *normal, smr_vec *unit)
{
    *unit = smr_v(0, 0, 0);
    if (normal == NULL)
        return 1;
    if (!smr_all_within(normal, 3, SMR_NORMAL_MOST))
        return 0;
    const smr_vec n = smr_load(normal);
    if (smr_dot(n, n) >= SMR_NORMAL_LEAST * SMR_NORMAL_LEAST)
        *unit = smr_unit(n);
    return 1;
}

static int legal_weight(float weight) { return weight >= 0.0f && weight <= SMR_WEIGHT_MAX; }

/* Checks points that smr_points_open() has opened. Errors: E_NULL, E_STATE, E_DAMAGED (an address or a count). */
static smr_status usable(const smr_points *points)
{
    if (points == NULL)
        return SMR_E_NULL;
    if (!smr_points_valid(points))
        return SMR_E_STATE;
    const smr_surface *s = &points->surface;
    return points->guard == guard_of(s) && points->next < s->capacity && s->n_vertices <= s->capacity ? SMR_OK
                                                                                                      : SMR_E_DAMAGED;
}

/* Returns 1 when coordinates, normals and weights of all n points are legal. */
static int can_add(const float *xyz, const float *normals, const float *weights, uint32_t n)
{
    smr_vec unit;
    for (size_t i = 0; i < n; i++)
        if (!smr_all_within(xyz + 3u * i, 3, SMR_COORD_MAX) ||
            !take_normal(normals == NULL ? NULL : normals + 3u * i, &unit) ||
            (weights != NULL && !legal_weight(weights[i])))
            return 0;
    return 1;
}

smr_status smr_points_add(smr_points *points, const float *xyz, const float *normals, const float *weights, uint32_t n)
{
    if (xyz == NULL && n > 0u)
        return SMR_E_NULL;
    SMR_TRY(usable(points));
    smr_surface *s = &points->surface;
    if (n > s->capacity || !can_add(xyz, normals, weights, n))
        return SMR_E_INPUT;
    for (size_t i = 0; i < n; i++) {
        smr_vec unit;
        const size_t at = points->next;
        (void)take_normal(normals == NULL ? NULL : normals + 3u * i, &unit);
        memcpy(s->xyz + 3u * at, xyz + 3u * i, 3u * sizeof(float));
        smr_store(s->normal + 3u * at, unit);
        s->area[at] = weights == NULL ? 1.0f : weights[i];
        points->next = points->next + 1u < s->capacity ? points->next + 1u : 0u;
        s->n_vertices = smr_max_u32(s->n_vertices, (uint32_t)at + 1u);
    }
    s->changes += n > 0u;
    return SMR_OK;
}

smr_status smr_points_weigh(smr_points *points, uint32_t index, float weight)
{
    SMR_TRY(usable(points));
    if (index >= points->surface.n_vertices || !legal_weight(weight))
        return SMR_E_INPUT;
    points->surface.area[index] = weight;
    points->surface.changes++;
    return SMR_OK;
}

smr_status smr_points_clear(smr_points *points)
{
    SMR_TRY(usable(points));
    points->next = points->surface.n_vertices = 0;
    points->surface.changes++;
    return SMR_OK;
}

smr_status smr_points_count(const smr_points *points, uint32_t *n)
{
    if (n == NULL)
        return SMR_E_NULL;
    SMR_TRY(usable(points));
    *n = points->surface.n_vertices;
    return SMR_OK;
}

static size_t index_bytes(uint32_t n) { return 3u * (size_t)n * sizeof(uint32_t); }

smr_status smr_points_surface_bytes(uint32_t n, size_t *bytes)
{
    SMR_TRY(smr_surface_bytes(n, n, bytes));
    if (*bytes > SIZE_MAX - index_bytes(n))
        return SMR_E_INPUT;
    *bytes += index_bytes(n);
    return SMR_OK;
}

smr_status smr_points_surface_begin(const smr_points *points, void *memory, size_t bytes, smr_surface **surface)
{
    size_t needed;
    if (memory == NULL || surface == NULL)
        return SMR_E_NULL;
    SMR_TRY(usable(points));
    const smr_surface *cloud = &points->surface;
    const uint32_t n = cloud->n_vertices;
    SMR_TRY(smr_points_surface_bytes(n, &needed));
    if ((uintptr_t)memory % SMR_ALIGN != 0u)
        return SMR_E_ALIGN;
    if (bytes < needed)
        return SMR_E_ARENA;
    uint32_t *index = (void *)((unsigned char *)memory + needed - index_bytes(n));
    const smr_mesh mesh = {cloud->xyz, index, n, n};
    SMR_TRY(smr_surface_begin(&mesh, memory, needed - index_bytes(n), surface));
    smr_arena_release(index, index_bytes(n));
    (*surface)->work.index = index;
    (*surface)->work.cloud = cloud;
    (*surface)->work.changes = cloud->changes;
    return SMR_OK;
}

smr_status smr_points_surface(const smr_points *points, void *memory, size_t bytes, smr_surface **surface)
{
    SMR_TRY(smr_points_surface_begin(points, memory, bytes, surface));
    return smr_surface_step(*surface, 0, NULL, 0);
}
