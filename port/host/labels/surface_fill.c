/* surface_fill.c: finds the voxels inside a closed surface by parity along rays.
 *
 * Vertices are rounded to whole parts of a voxel, at least 2^-8 and at most 2^-20. The test of a ray against a
 * triangle's side is then exact in 64 bits. A ray that meets a side counts as shifted by (e, e^2) across its
 * direction, e infinitely small, so two triangles at one side never both count, or neither.
 * SPDX-License-Identifier: MIT */
#include "labels/surface_set.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BITS 29 /* of rounded coordinates: products of two differences fit 64 bits */
#define SHIFT_MOST 20
#define SHIFT_LEAST 8

typedef struct filler {
    int64_t *at; /* [n_vertices][3] rounded indices; owned */
    int shift;   /* voxels are 2^shift units */
    const host_mesh *mesh;
    host_filled *filled;
} filler;

/* The vertices' places in the grid, in voxels. Returns the largest number among them. */
static double to_voxels(const host_mesh *mesh, const host_volume *grid, double *index)
{
    double m[9], most = 0.0;
    host_volume_to_index(grid, m);
    for (size_t v = 0; v < mesh->n_vertices; v++)
        for (size_t k = 0; k < 3u; k++) {
            double sum = 0.0;
            for (size_t j = 0; j < 3u; j++)
                sum += m[3u * k + j] * ((double)mesh->xyz[3u * v + j] - (double)grid->origin[j]);
            index[3u * v + k] = sum;
            most = fabs(sum) > most ? fabs(sum) : most;
        }
    for (size_t k = 0; k < 3u; k++)
        most = (double)grid->size[k] > most ? (double)grid->size[k] : most;
    return most;
}

static int round_vertices(filler *f, const host_volume *grid, host_error *error)
{
    const size_t n = 3u * (size_t)f->mesh->n_vertices;
    double *const index = malloc(n * sizeof *index + 1u);
    f->at = malloc(n * sizeof *f->at + 1u);
    if (index == NULL || f->at == NULL) {
        free(index);
        return host_fail(error, "surface", "free memory");
    }
    double most = to_voxels(f->mesh, grid, index);
    f->shift = SHIFT_MOST;
    while (f->shift > SHIFT_LEAST && most * (double)(1 << f->shift) >= (double)(1 << BITS))
        f->shift--;
    if (!(most * (double)(1 << f->shift) < (double)(1 << BITS))) {
        free(index);
        return host_fail(error, "surface", "vertices within %d voxels of the volume, found %.0f",
                         1 << (BITS - SHIFT_LEAST), most);
    }
    for (size_t i = 0; i < n; i++)
        f->at[i] = (int64_t)floor(index[i] * (double)(1 << f->shift) + 0.5);
    free(index);
    return 0;
}

/* The whole voxel at a rounded place or the next one after it. */
static int64_t voxel_from(int64_t at, int shift) { return -((-at) >> shift); }

/* The box of voxels around the vertices. */
static void find_box(const filler *f, const host_volume *grid)
{
    for (unsigned k = 0; k < 3u; k++) {
        int64_t low = INT64_MAX, high = INT64_MIN, from = 0, to = 0;
        for (size_t v = 0; v < f->mesh->n_vertices; v++) {
            const int64_t x = f->at[3u * v + k];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        from = voxel_from(low, f->shift);
        to = high >> f->shift;
        from = from < 0 ? 0 : from;
        to = to >= (int64_t)grid->size[k] ? (int64_t)grid->size[k] - 1 : to;
        f->filled->low[k] = from <= to ? (uint32_t)from : 0;
        f->filled->size[k] = from <= to ? (uint32_t)(to - from + 1) : 0;
    }
}

/* Twice the area of the triangle a, b, ray, seen along the rays: positive when counterclockwise. */
static int64_t turn(const int64_t *a, const int64_t *b, int64_t y, int64_t z)
{
    return (b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1]);
}

/* The side of a, b on which the shifted ray lies: 1 or -1; 0 when a and b are at one place. */
static int side_of(const int64_t *a, const int64_t *b, int64_t area)
{
    if (area != 0)
        return area > 0 ? 1 : -1;
    if (b[2] != a[2])
        return b[2] < a[2] ? 1 : -1;
    return (b[1] > a[1]) - (b[1] < a[1]);
}

/* Marks the first voxel behind a triangle on the ray (y, z), when the ray meets it. */
static void mark_ray(const filler *f, const int64_t *const p[3], int64_t y, int64_t z)
{
    host_filled *const in = f->filled;
    const int64_t ry = y * ((int64_t)1 << f->shift), rz = z * ((int64_t)1 << f->shift);
    int64_t area[3];
    int side[3];
    double x = 0.0, all = 0.0;
    for (unsigned k = 0; k < 3u; k++) {
        const int64_t *const a = p[(k + 1u) % 3u], *const b = p[(k + 2u) % 3u];
        area[k] = turn(a, b, ry, rz);
        side[k] = side_of(a, b, area[k]);
    }
    if (side[0] == 0 || side[0] != side[1] || side[1] != side[2] || (area[0] | area[1] | area[2]) == 0)
        return;
    for (unsigned k = 0; k < 3u; k++) {
        x += (double)area[k] * (double)p[k][0];
        all += (double)area[k];
    }
    x = ceil(x / all / (double)(1 << f->shift)) - (double)in->low[0];
    if (x < (double)in->size[0]) {
        const size_t row = (size_t)(z - (int64_t)in->low[2]) * in->size[1] + (size_t)(y - (int64_t)in->low[1]);
        in->inside[row * in->size[0] + (x > 0.0 ? (size_t)x : 0u)] ^= 1u;
    }
}

/* The rays of the box that may meet a triangle, along axis k. */
static void ray_range(const filler *f, const int64_t *const p[3], unsigned k, int64_t range[2])
{
    const int64_t least = (int64_t)f->filled->low[k], most = least + (int64_t)f->filled->size[k] - 1;
    int64_t low = p[0][k], high = p[0][k];
    for (unsigned c = 1; c < 3u; c++) {
        low = p[c][k] < low ? p[c][k] : low;
        high = p[c][k] > high ? p[c][k] : high;
    }
    range[0] = voxel_from(low, f->shift);
    range[1] = high >> f->shift;
    range[0] = range[0] < least ? least : range[0];
    range[1] = range[1] > most ? most : range[1];
}

static void mark_triangle(const filler *f, const uint32_t *triangle)
{
    const int64_t *const p[3] = {f->at + 3u * (size_t)triangle[0], f->at + 3u * (size_t)triangle[1],
                                 f->at + 3u * (size_t)triangle[2]};
    int64_t rows[2], slices[2], y = 0, z = 0;
    ray_range(f, p, 1, rows);
    ray_range(f, p, 2, slices);
    for (z = slices[0]; z <= slices[1]; z++)
        for (y = rows[0]; y <= rows[1]; y++)
            mark_ray(f, p, y, z);
}

/* From marks to insides: each mark turns all voxels behind it. */
static void fill_rows(host_filled *filled)
{
    const size_t rows = (size_t)filled->size[1] * filled->size[2];
    for (size_t row = 0; row < rows; row++) {
        unsigned char *const at = filled->inside + row * filled->size[0];
        unsigned inside = 0;
        for (size_t x = 0; x < filled->size[0]; x++) {
            inside ^= at[x];
            at[x] = (unsigned char)inside;
            filled->voxels += inside;
        }
    }
}

int host_surface_fill(const host_mesh *mesh, const host_volume *grid, host_filled *filled, host_error *error)
{
    filler f = {NULL, 0, mesh, filled};
    size_t n = 0;
    memset(filled, 0, sizeof *filled);
    int result = round_vertices(&f, grid, error);
    if (result == 0) {
        find_box(&f, grid);
        n = (size_t)filled->size[0] * filled->size[1] * filled->size[2];
        filled->inside = host_alloc(n);
        if (filled->inside == NULL)
            result = host_fail(error, "surface", "free memory");
    }
    if (result == 0 && n > 0) {
        memset(filled->inside, 0, n);
        for (size_t i = 0; i < mesh->n_triangles; i++)
            mark_triangle(&f, mesh->triangles + 3u * i);
        fill_rows(filled);
    }
    free(f.at);
    return result;
}

void host_filled_free(host_filled *filled)
{
    free(filled->inside);
    memset(filled, 0, sizeof *filled);
}

int64_t host_open_edges(const host_mesh *mesh)
{
    const smr_mesh view = host_mesh_view(mesh);
    host_half_edges edges;
    size_t end = 0;
    int64_t n = 0;
    if (host_half_edges_make(&view, &edges) != 0)
        return -1;
    for (size_t v = 0; v < mesh->n_vertices; v++)
        for (size_t i = edges.first[v]; i < edges.first[v + 1u]; i = end) {
            end = host_half_edges_end(&edges, v, i);
            n += (int64_t)((end - i) % 2u);
        }
    host_half_edges_free(&edges);
    return n;
}
