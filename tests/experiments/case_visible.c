/* case_visible.c: which triangles of a target a partial view has: one side, patches, an end.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Triangles whose normals lie within an angle of the direction. */
static void keep_facing(const host_mesh *mesh, const double direction[3], double degrees, unsigned char *keep)
{
    const double least = cos(degrees * acos(-1.0) / 180.0);
    uint32_t t = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        double n[3];
        case_triangle_normal(mesh, t, n);
        keep[t] = dot(n, direction) > least * sqrt(dot(n, n));
    }
}

/* Across the long axis: the view of somebody who stands beside the bone. */
static void find_side(oracle_random *r, const double axes[9], double out[3])
{
    const double angle = oracle_uniform(r, 0.0, 2.0 * acos(-1.0));
    int c = 0;
    for (c = 0; c < 3; c++)
        out[c] = cos(angle) * axes[3 + c] + sin(angle) * axes[6 + c];
}

typedef struct ranked {
    double value, area;
    uint32_t triangle;
} ranked;

static int by_value(const void *a, const void *b)
{
    const ranked *const x = a, *const y = b;
    if (x->value != y->value)
        return x->value < y->value ? -1 : 1;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

/* The triangles of the smallest values whose areas make the share. */
static void keep_share(const host_mesh *mesh, const double *value, double share, unsigned char *keep)
{
    ranked *const list = case_alloc(mesh->n_triangles, sizeof *list);
    double left = share * case_area(mesh);
    uint32_t t = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        double n[3];
        case_triangle_normal(mesh, t, n);
        list[t].area = 0.5 * sqrt(dot(n, n));
        list[t].value = value[t];
        list[t].triangle = t;
    }
    qsort(list, mesh->n_triangles, sizeof *list, by_value);
    for (t = 0; t < mesh->n_triangles && left > 0.0; t++) {
        keep[list[t].triangle] = 1;
        left -= list[t].area;
    }
    free(list);
}

static double edge_length(const host_mesh *mesh, uint32_t a, uint32_t b)
{
    double d[3];
    int c = 0;
    for (c = 0; c < 3; c++)
        d[c] = (double)mesh->xyz[3u * (size_t)a + (size_t)c] - (double)mesh->xyz[3u * (size_t)b + (size_t)c];
    return sqrt(dot(d, d));
}

/* Lengths of paths along edges from the vertices where `from` is 0: passes over all triangles until none shortens. */
static void spread_distance(const host_mesh *mesh, double *from)
{
    int changed = 1;
    uint32_t i = 0;
    while (changed) {
        changed = 0;
        for (i = 0; i < 6u * mesh->n_triangles; i++) { /* forwards, then backwards */
            const uint32_t at = i < 3u * mesh->n_triangles ? i : 6u * mesh->n_triangles - 1u - i;
            const uint32_t a = mesh->triangles[at], b = mesh->triangles[at % 3u == 2u ? at - 2u : at + 1u];
            const double length = edge_length(mesh, a, b);
            if (from[a] + length < from[b]) {
                from[b] = from[a] + length;
                changed = 1;
            } else if (from[b] + length < from[a]) {
                from[a] = from[b] + length;
                changed = 1;
            }
        }
    }
}

/* Each further place is the farthest of a few random vertices from those chosen before. */
static void keep_patches(const host_mesh *mesh, const case_options *options, oracle_random *r, unsigned char *keep)
{
    double *const from = case_alloc(mesh->n_vertices, sizeof *from);
    double *const value = case_alloc(mesh->n_triangles, sizeof *value);
    uint32_t i = 0;
    int k = 0, tries = 0;
    for (i = 0; i < mesh->n_vertices; i++)
        from[i] = 1e9;
    for (k = 0; k < options->patches; k++) {
        uint32_t best = oracle_below(r, mesh->n_vertices);
        for (tries = 0; tries < 4; tries++) {
            const uint32_t v = oracle_below(r, mesh->n_vertices);
            best = from[v] > from[best] ? v : best;
        }
        from[best] = 0.0;
        spread_distance(mesh, from);
    }
    for (i = 0; i < mesh->n_triangles; i++)
        for (k = 0; k < 3; k++)
            value[i] += from[mesh->triangles[3u * (size_t)i + (size_t)k]];
    keep_share(mesh, value, options->share, keep);
    free(from);
    free(value);
}

static void keep_end(const host_mesh *mesh, const case_options *options, const double axes[9], unsigned char *keep)
{
    const double sign = options->seed % 2u == 1u ? -1.0 : 1.0;
    double *const value = case_alloc(mesh->n_triangles, sizeof *value);
    uint32_t t = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        double p[3];
        case_centre(mesh, t, p);
        value[t] = sign * dot(p, axes);
    }
    keep_share(mesh, value, options->share, keep);
    free(value);
}

unsigned char *case_visible(const host_mesh *mesh, const case_options *options, const double axes[9])
{
    static const double front[3] = {0.0, -1.0, 0.0};
    unsigned char *const keep = case_alloc(mesh->n_triangles, 1);
    oracle_random r = oracle_seed(7000u + options->seed);
    double side[3];
    switch (options->part) {
    case CASE_SIDE:
        find_side(&r, axes, side);
        keep_facing(mesh, side, options->side_deg, keep);
        break;
    case CASE_PATCHES: keep_patches(mesh, options, &r, keep); break;
    case CASE_END: keep_end(mesh, options, axes, keep); break;
    case CASE_FRONT: keep_facing(mesh, front, 90.0, keep); break;
    default: memset(keep, 1, mesh->n_triangles); break;
    }
    return keep;
}
