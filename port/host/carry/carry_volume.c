/* carry_volume.c: resamples an image on a grid of the result's space.
 * SPDX-License-Identifier: MIT */
#include "carry/carry_volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "volumes/volume_write.h"

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
    case HOST_UINT8: ((uint8_t *)v->voxels)[i] = (uint8_t)whole; break;
    case HOST_INT8: ((int8_t *)v->voxels)[i] = (int8_t)whole; break;
    case HOST_UINT16: ((uint16_t *)v->voxels)[i] = (uint16_t)whole; break;
    case HOST_INT16: ((int16_t *)v->voxels)[i] = (int16_t)whole; break;
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
        double weight = 1.0;
        size_t i = 0;
        for (k = 3; k-- > 0u;) {
            const uint32_t up = corner >> k & 1u;
            weight *= up ? share[k] : 1.0 - share[k];
            i = i * v->size[k] + at[k] + up;
        }
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
        double weight = 1.0;
        size_t i = 0;
        for (k = 3; k-- > 0u;) {
            const uint32_t up = corner >> k & 1u;
            weight *= up ? share[k] : 1.0 - share[k];
            i = i * w->n[k] + at[k] + up;
        }
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
    uint32_t i = 0, k = 0;
    (void)worker;
    for (i = 0; i < n; i++) {
        const uint32_t voxel_at[3] = {i % out->size[0], i / out->size[0], z};
        const double index[3] = {(double)voxel_at[0], (double)voxel_at[1], (double)z};
        double at[3], d[3], in[3] = {0};
        host_volume_place(out, index, at);
        displacement(w, voxel_at, d);
        for (k = 0; k < 3; k++)
            at[k] += d[k] - (double)w->image->origin[k];
        for (k = 0; k < 9; k++)
            in[k / 3u] += w->to_index[k] * at[k % 3u];
        put_voxel(out, (size_t)z * n + i, sample(w->image, in));
    }
}

/* Displacements of the lattice, a layer at a time. */
static int64_t fill_lattice(host_carried *c, warp *w, host_error *error)
{
    const uint32_t n = w->n[0] * w->n[1];
    int64_t missed = 0;
    uint32_t z = 0, i = 0, k = 0;
    for (z = 0; z < w->n[2]; z++) {
        float *const to = w->moved + 3u * (size_t)n * z;
        int64_t bad = 0;
        for (i = 0; i < n; i++) {
            const double index[3] = {(double)(i % w->n[0]) * (double)w->step[0],
                                     (double)(i / w->n[0]) * (double)w->step[1], (double)z * (double)w->step[2]};
            double at[3];
            host_volume_place(w->out, index, at);
            for (k = 0; k < 3; k++)
                to[3u * (size_t)i + k] = (float)at[k];
        }
        bad = host_carried_points(c, 1, to, n, NULL, error);
        if (bad < 0)
            return -1;
        missed += bad;
        for (i = 0; i < n; i++) {
            const double index[3] = {(double)(i % w->n[0]) * (double)w->step[0],
                                     (double)(i / w->n[0]) * (double)w->step[1], (double)z * (double)w->step[2]};
            double at[3];
            host_volume_place(w->out, index, at);
            for (k = 0; k < 3; k++)
                to[3u * (size_t)i + k] -= (float)at[k];
        }
    }
    return missed;
}

int64_t host_carried_volume(host_carried *c, const host_volume *image, host_volume *out, host_error *error)
{
    warp w;
    int64_t missed = -1;
    uint32_t k = 0;
    memset(&w, 0, sizeof w);
    w.image = image;
    w.out = out;
    out->type = image->type;
    for (k = 0; k < 3; k++) {
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
