/* carry_field.c: computes a displacement field, and fits it to the vertices.
 * Method of the fit: Kaczmarz (1937): what interpolation misses at a vertex is given to the eight voxels around it, in
 * turn for all vertices, SWEEPS times or until none misses by more than FIT_MM.
 * SPDX-License-Identifier: MIT */
#include "carry/carry_field.h"

#include <stdlib.h>
#include <string.h>

#include "volumes/volume_write.h"

#define SWEEPS 60u
#define FIT_SPACING_MM 5.0f /* coarser grids have too few voxels for the vertices, and are left */
#define FIT_MM 0.002

/* Displacements of slice z; xyz: scratch, [n] places. */
static int64_t fill_slice(host_carried *c, const host_volume *grid, uint32_t z, uint32_t inverse, float *xyz, float *to,
                          host_error *error)
{
    const uint32_t n = grid->size[0] * grid->size[1];
    int64_t missed = 0;
    uint32_t i = 0, k = 0;
    for (i = 0; i < n; i++) {
        const double index[3] = {(double)(i % grid->size[0]), (double)(i / grid->size[0]), (double)z};
        double at[3];
        host_volume_place(grid, index, at);
        for (k = 0; k < 3; k++)
            xyz[3u * (size_t)i + k] = to[3u * (size_t)i + k] = (float)at[k];
    }
    missed = host_carried_points(c, inverse, to, n, NULL, error);
    for (i = 0; i < 3u * n; i++)
        to[i] -= xyz[i];
    return missed;
}

/* A vertex and what the field should be there. */
typedef struct knot {
    size_t at[8];
    double weight[8], wanted[3], sum2; /* sum of the squared weights */
} knot;

/* 0 for a vertex outside the grid, which has no eight voxels around it. */
static int find_knot(const host_carried *c, const host_volume *grid, const double to_index[9], uint32_t inverse,
                     uint32_t v, knot *found)
{
    double from[3], to[3], share[3], index[3] = {0};
    uint32_t low[3], k = 0, corner = 0;
    for (k = 0; k < 3; k++) {
        const double rest = (double)c->shape.rest[3u * (size_t)v + k], now = (double)c->shape.now[3u * (size_t)v + k];
        const double own = (int)k == c->shape.mirror ? 0.0 - rest : rest;
        from[k] = inverse ? now : own;
        to[k] = inverse ? own : now;
    }
    for (k = 0; k < 9; k++)
        index[k / 3u] += to_index[k] * (from[k % 3u] - (double)grid->origin[k % 3u]);
    for (k = 0; k < 3; k++) {
        if (!(index[k] >= 0.0 && index[k] < (double)(grid->size[k] - 1u)))
            return 0;
        low[k] = (uint32_t)index[k];
        share[k] = index[k] - (double)low[k];
        found->wanted[k] = to[k] - from[k];
    }
    found->sum2 = 0.0;
    for (corner = 0; corner < 8u; corner++) {
        found->weight[corner] = 1.0;
        found->at[corner] = 0;
        for (k = 3; k-- > 0u;) {
            const uint32_t up = corner >> k & 1u;
            found->weight[corner] *= up ? share[k] : 1.0 - share[k];
            found->at[corner] = found->at[corner] * grid->size[k] + low[k] + up;
        }
        found->sum2 += found->weight[corner] * found->weight[corner];
    }
    return 1;
}

/* Returns by how much the field missed the knot, squared. */
static double fit_knot(const knot *at, float *field)
{
    double miss2 = 0.0;
    uint32_t k = 0, corner = 0;
    for (k = 0; k < 3; k++) {
        double miss = at->wanted[k];
        for (corner = 0; corner < 8u; corner++)
            miss -= at->weight[corner] * (double)field[3u * at->at[corner] + k];
        miss2 += miss * miss;
        miss /= at->sum2;
        for (corner = 0; corner < 8u; corner++)
            field[3u * at->at[corner] + k] =
                (float)((double)field[3u * at->at[corner] + k] + at->weight[corner] * miss);
    }
    return miss2;
}

void host_carried_field_fit(const host_carried *c, const host_volume *grid, uint32_t inverse, float *field)
{
    double to_index[9], worst2 = 1.0;
    uint32_t sweep = 0, v = 0;
    if (!(grid->spacing[0] <= FIT_SPACING_MM && grid->spacing[1] <= FIT_SPACING_MM &&
          grid->spacing[2] <= FIT_SPACING_MM))
        return;
    host_volume_to_index(grid, to_index);
    for (sweep = 0; sweep < SWEEPS && worst2 > FIT_MM * FIT_MM; sweep++) {
        worst2 = 0.0;
        for (v = 0; v < c->shape.n_vertices; v++) {
            knot at;
            if (find_knot(c, grid, to_index, inverse, v, &at)) {
                const double miss2 = fit_knot(&at, field);
                worst2 = miss2 > worst2 ? miss2 : worst2;
            }
        }
    }
}

int64_t host_carried_field(host_carried *c, const host_volume *grid, uint32_t inverse, float *field, host_error *error)
{
    const uint64_t n = (uint64_t)grid->size[0] * grid->size[1];
    float *const xyz = n <= SMR_VERTICES_MAX ? malloc(3u * (size_t)n * sizeof *xyz) : NULL;
    int64_t missed = 0, bad = 0;
    uint32_t z = 0;
    if (xyz == NULL)
        return host_fail(error, "size", "slices of at most %u voxels, and free memory", SMR_VERTICES_MAX);
    for (z = 0; z < grid->size[2] && bad >= 0; z++) {
        bad = fill_slice(c, grid, z, inverse, xyz, field + 3u * (size_t)n * z, error);
        missed += bad;
    }
    free(xyz);
    if (bad < 0)
        return -1;
    host_carried_field_fit(c, grid, inverse, field);
    return missed;
}

void host_carried_field_file(const host_volume *grid, uint32_t inverse, const float *field, const char *path,
                             host_buffer *out)
{
    host_volume_write_header(grid, HOST_FLOAT32, 3,
                             inverse ? "displacement field type:=resampling\nintent_code:=1006\n"
                                     : "displacement field type:=modeling\nintent_code:=1006\n",
                             path, out);
    host_volume_write_values(field, HOST_FLOAT32, (size_t)3u * grid->size[0] * grid->size[1] * grid->size[2], out);
}
