/* carry_volume.c: what a result carries on a grid: volumes, and displacement fields.
 * SPDX-License-Identifier: MIT */
#include "carry/carry_volume.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SWEEPS 60u
#define FIT_GRID_MM 5.0f /* coarser grids have too few voxels for the vertices, and are left */
#define FIT_MM 0.002

/* Displacements of slice z; xyz: scratch, [n] places. */
static int64_t fill_slice(host_carried *c, const host_volume *grid, uint32_t z, uint32_t inverse, float *xyz, float *to,
                          host_error *error)
{
    const uint32_t n = grid->size[0] * grid->size[1];
    for (uint32_t i = 0; i < n; i++) {
        const double index[3] = {(double)(i % grid->size[0]), (double)(i / grid->size[0]), (double)z};
        double at[3];
        host_volume_place(grid, index, at);
        for (uint32_t k = 0; k < 3; k++)
            xyz[3u * (size_t)i + k] = to[3u * (size_t)i + k] = (float)at[k];
    }
    int64_t missed = host_carried_points(c, inverse, to, n, NULL, error);
    for (uint32_t i = 0; i < 3u * n; i++)
        to[i] -= xyz[i];
    return missed;
}

/* The share of a corner of eight points around a place between them. *i: the number of that point. */
static double corner_share(const uint32_t size[3], const uint32_t low[3], const double share[3], uint32_t corner,
                           size_t *i)
{
    double weight = 1.0;
    *i = 0;
    for (uint32_t k = 3; k-- > 0u;) {
        const uint32_t up = corner >> k & 1u;
        weight *= up ? share[k] : 1.0 - share[k];
        *i = *i * size[k] + low[k] + up;
    }
    return weight;
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
        found->weight[corner] = corner_share(grid->size, low, share, corner, &found->at[corner]);
        found->sum2 += found->weight[corner] * found->weight[corner];
    }
    return 1;
}

/* Returns by how much the field missed the knot, squared. */
static double fit_knot(const knot *at, float *field)
{
    double miss2 = 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        double off = at->wanted[k];
        for (uint32_t corner = 0; corner < 8u; corner++)
            off -= at->weight[corner] * (double)field[3u * at->at[corner] + k];
        miss2 += off * off;
        off /= at->sum2;
        for (uint32_t corner = 0; corner < 8u; corner++)
            field[3u * at->at[corner] + k] = (float)((double)field[3u * at->at[corner] + k] + at->weight[corner] * off);
    }
    return miss2;
}

void host_carried_field_fit(const host_carried *c, const host_volume *grid, uint32_t inverse, float *field)
{
    double to_index[9], worst2 = 1.0;
    if (!(grid->spacing[0] <= FIT_GRID_MM && grid->spacing[1] <= FIT_GRID_MM && grid->spacing[2] <= FIT_GRID_MM))
        return;
    host_volume_to_index(grid, to_index);
    for (uint32_t sweep = 0; sweep < SWEEPS && worst2 > FIT_MM * FIT_MM; sweep++) {
        worst2 = 0.0;
        for (uint32_t v = 0; v < c->shape.n_vertices; v++) {
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
    if (xyz == NULL)
        return host_fail(error, "size", "slices of at most %u voxels, and free memory", SMR_VERTICES_MAX);
    for (uint32_t z = 0; z < grid->size[2] && bad >= 0; z++) {
        bad = fill_slice(c, grid, z, inverse, xyz, field + 3u * (size_t)n * z, error);
        missed += bad;
    }
    free(xyz);
    if (bad < 0)
        return -1;
    host_carried_field_fit(c, grid, inverse, field);
    return missed;
}

/* 1 where a cell's edges at one of its corners span no volume, or one of the other sign than those of the grid do. */
static int cell_folds(const host_volume *grid, const float *field, double sign, size_t first, const size_t stride[3])
{
    double edge[3][3], whole[3][3];
    for (uint32_t corner = 0; corner < 8u; corner++) {
        size_t at = first;
        for (uint32_t k = 0; k < 3; k++)
            at += (corner >> k & 1u) != 0 ? stride[k] : 0;
        for (uint32_t a = 0; a < 3; a++) {
            const size_t low = at - ((corner >> a & 1u) != 0 ? stride[a] : 0), high = low + stride[a];
            for (uint32_t k = 0; k < 3; k++) {
                whole[a][k] = (double)grid->direction[3u * k + a] * (double)grid->spacing[a];
                edge[a][k] = whole[a][k] + (double)field[3u * high + k] - (double)field[3u * low + k];
            }
        }
        if (!(sign * host_determinant(edge) * host_determinant(whole) > 0.0))
            return 1;
    }
    return 0;
}

uint64_t host_field_folds(const host_volume *grid, const float *field, int mirrors)
{
    const size_t stride[3] = {1, grid->size[0], (size_t)grid->size[0] * grid->size[1]};
    uint64_t n = 0;
    for (uint32_t z = 0; z + 1u < grid->size[2]; z++)
        for (uint32_t y = 0; y + 1u < grid->size[1]; y++)
            for (uint32_t x = 0; x + 1u < grid->size[0]; x++)
                n += (uint64_t)cell_folds(grid, field, mirrors ? -1.0 : 1.0, x + y * stride[1] + z * stride[2], stride);
    return n;
}

void host_carried_field_file(const host_volume *grid, uint32_t inverse, const float *field, const char *path,
                             host_buffer *out)
{
    host_volume_write_header(grid, SMR_VOXEL_FLOAT, 3,
                             inverse ? "displacement field type:=resampling\nintent_code:=1006\n"
                                     : "displacement field type:=modeling\nintent_code:=1006\n",
                             path, out);
    host_volume_write_values(field, SMR_VOXEL_FLOAT, (size_t)3u * grid->size[0] * grid->size[1] * grid->size[2], out);
}

#define LATTICE_MM 5.0 /* over it displacements are interpolated */

typedef struct warp {
    const host_volume *image;
    host_volume *out;
    uint32_t step[3], n[3]; /* voxels between points of the lattice, and its points */
    float *moved;           /* [n[2]][n[1]][n[0]][3] mm, from a point of the result to the model's; owned */
    double to_index[9];     /* of the image: index = to_index (place - origin) */
} warp;

static void put_voxel(host_volume *v, size_t i, double value)
{
    const double whole = floor(value + 0.5);
    switch (v->type) {
    case SMR_VOXEL_UINT8: ((uint8_t *)v->voxels)[i] = (uint8_t)whole; break;
    case SMR_VOXEL_INT8: ((int8_t *)v->voxels)[i] = (int8_t)whole; break;
    case SMR_VOXEL_UINT16: ((uint16_t *)v->voxels)[i] = (uint16_t)whole; break;
    case SMR_VOXEL_INT16: ((int16_t *)v->voxels)[i] = (int16_t)whole; break;
    default: ((float *)v->voxels)[i] = (float)value;
    }
}

/* Splits a place along an axis of n points into the point before it and a share. 0 outside. */
static int split(double x, uint32_t n, uint32_t *at, double *share)
{
    if (!(x >= 0.0 && x <= (double)(n - 1u)))
        return 0;
    *at = (uint32_t)x;
    if (*at + 1u >= n && n > 1u)
        *at = n - 2u;
    *share = x - (double)*at;
    return 1;
}

/* The image between voxels; 0 outside. Neighbours of share 0 are not looked at. */
static double sample(const host_volume *v, const double index[3])
{
    uint32_t at[3], corner = 0, k = 0;
    double share[3], sum = 0.0;
    for (k = 0; k < 3; k++)
        if (!split(index[k], v->size[k], &at[k], &share[k]))
            return 0.0;
    for (corner = 0; corner < 8u; corner++) {
        size_t i = 0;
        const double weight = corner_share(v->size, at, share, corner, &i);
        if (weight > 0.0)
            sum += weight * host_voxel(v->voxels, v->type, i);
    }
    return sum;
}

/* The displacement between points of the lattice, at a voxel. */
static void displacement(const warp *w, const uint32_t index[3], double d[3])
{
    uint32_t at[3], corner = 0, k = 0;
    double share[3];
    memset(d, 0, 3u * sizeof *d);
    for (k = 0; k < 3; k++) {
        at[k] = index[k] / w->step[k];
        share[k] = (double)(index[k] % w->step[k]) / (double)w->step[k];
    }
    for (corner = 0; corner < 8u; corner++) {
        size_t i = 0;
        const double weight = corner_share(w->n, at, share, corner, &i);
        for (k = 0; k < 3 && weight > 0.0; k++)
            d[k] += weight * (double)w->moved[3u * i + k];
    }
}

/* One slice of the result. */
static void run_slice(void *arg, uint32_t z, uint32_t worker)
{
    const warp *const w = arg;
    host_volume *const out = w->out;
    const uint32_t n = out->size[0] * out->size[1];
    (void)worker;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t voxel_at[3] = {i % out->size[0], i / out->size[0], z};
        const double index[3] = {(double)voxel_at[0], (double)voxel_at[1], (double)z};
        double at[3], d[3], in[3] = {0};
        host_volume_place(out, index, at);
        displacement(w, voxel_at, d);
        for (uint32_t k = 0; k < 3; k++)
            at[k] += d[k] - (double)w->image->origin[k];
        for (uint32_t k = 0; k < 9; k++)
            in[k / 3u] += w->to_index[k] * at[k % 3u];
        put_voxel(out, (size_t)z * n + i, sample(w->image, in));
    }
}

/* The place of point i of the lattice, in layer z. */
static void lattice_place(const warp *w, uint32_t i, uint32_t z, double at[3])
{
    const double index[3] = {(double)(i % w->n[0]) * (double)w->step[0], (double)(i / w->n[0]) * (double)w->step[1],
                             (double)z * (double)w->step[2]};
    host_volume_place(w->out, index, at);
}

/* Displacements of the lattice, a layer at a time. */
static int64_t fill_lattice(host_carried *c, warp *w, host_error *error)
{
    const uint32_t n = w->n[0] * w->n[1];
    int64_t missed = 0;
    for (uint32_t z = 0; z < w->n[2]; z++) {
        float *const to = w->moved + 3u * (size_t)n * z;
        double at[3];
        for (uint32_t i = 0; i < n; i++) {
            lattice_place(w, i, z, at);
            for (uint32_t k = 0; k < 3; k++)
                to[3u * (size_t)i + k] = (float)at[k];
        }
        const int64_t bad = host_carried_points(c, 1, to, n, NULL, error);
        if (bad < 0)
            return -1;
        missed += bad;
        for (uint32_t i = 0; i < n; i++) {
            lattice_place(w, i, z, at);
            for (uint32_t k = 0; k < 3; k++)
                to[3u * (size_t)i + k] -= (float)at[k];
        }
    }
    return missed;
}

int64_t host_carried_volume(host_carried *c, const host_volume *image, host_volume *out, host_error *error)
{
    warp w = {0};
    int64_t missed = -1;
    w.image = image;
    w.out = out;
    out->type = image->type;
    for (uint32_t k = 0; k < 3; k++) {
        const double step = LATTICE_MM / (double)out->spacing[k];
        w.step[k] = step >= 1.5 ? (uint32_t)(step + 0.5) : 1u;
        w.n[k] = (out->size[k] - 1u) / w.step[k] + 2u;
    }
    host_volume_to_index(image, w.to_index);
    out->voxels = host_alloc((size_t)out->size[0] * out->size[1] * out->size[2] * host_volume_voxel_bytes(out->type));
    if ((uint64_t)w.n[0] * w.n[1] <= SMR_VERTICES_MAX)
        w.moved = malloc(3u * sizeof *w.moved * w.n[0] * w.n[1] * w.n[2]);
    if (out->voxels == NULL || w.moved == NULL)
        (void)host_fail(error, "size", "slices of at most %u voxels, and free memory", SMR_VERTICES_MAX);
    else
        missed = fill_lattice(c, &w, error);
    if (missed >= 0)
        host_parallel(&c->port.port, run_slice, &w, out->size[2]);
    free(w.moved);
    return missed;
}
