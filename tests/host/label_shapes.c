/* label_shapes.c: shapes as functions, grids, maps of them, and measures of their surfaces.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host/label_shapes.h"
#include "labels/surface_set.h"
#include "meshes/triangle_mesh.h"
#include "volumes/voxel_volume.h"

#define PI 3.14159265358979

host_port label_port;

int open_port(void **state)
{
    host_error error = {0};
    (void)state;
    return host_port_open(&label_port, 1, &error);
}

int close_port(void **state)
{
    (void)state;
    host_port_close(&label_port);
    return 0;
}

static double ball(const double p[3]) { return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 15.0; }

static double ellipsoid(const double p[3])
{
    return 10.0 * (sqrt(p[0] * p[0] / 400.0 + p[1] * p[1] / 100.0 + p[2] * p[2] / 144.0) - 1.0);
}

static double capsule(const double p[3])
{
    const double t = p[0] < -12.0 ? -12.0 : (p[0] > 12.0 ? 12.0 : p[0]);
    return sqrt((p[0] - t) * (p[0] - t) + p[1] * p[1] + p[2] * p[2]) - 7.0;
}

static double torus(const double p[3])
{
    const double ring = sqrt(p[0] * p[0] + p[1] * p[1]) - 14.0;
    return sqrt(ring * ring + p[2] * p[2]) - 5.0;
}

/* A plate of 3 mm with a round border. */
static double plate(const double p[3])
{
    const double out = sqrt(p[0] * p[0] + p[1] * p[1]) - 18.0, side = out > 0.0 ? out : 0.0;
    return sqrt(side * side + p[2] * p[2]) - 1.5;
}

const struct shape shapes[SHAPES] = {
    {"ball", ball}, {"ellipsoid", ellipsoid}, {"capsule", capsule}, {"torus", torus}, {"plate", plate}};

host_volume make_grid(double sx, double sy, double sz, double turn, double tilt, int handed)
{
    host_volume g;
    const double c = cos(turn), s = sin(turn), d = cos(tilt), t = sin(tilt), spacing[3] = {sx, sy, sz};
    const double rows[9] = {c, -s * d, s * t, s, c * d, -c * t, 0.0, t, d};
    double half[3], at[3];
    memset(&g, 0, sizeof g);
    for (unsigned k = 0; k < 9; k++)
        g.direction[k] = (float)(k % 3u == 2u && handed < 0 ? -rows[k] : rows[k]);
    for (unsigned k = 0; k < 3; k++) {
        g.spacing[k] = (float)spacing[k];
        g.size[k] = (uint32_t)(56.0 / spacing[k]);
        half[k] = 0.5 * (double)(g.size[k] - 1u) + 0.23;
    }
    host_volume_place(&g, half, at);
    for (unsigned k = 0; k < 3; k++)
        g.origin[k] = (float)-at[k];
    return g;
}

void place(const host_volume *g, size_t voxel, double at[3])
{
    const double index[3] = {(double)(voxel % g->size[0]), (double)(voxel / g->size[0] % g->size[1]),
                             (double)(voxel / g->size[0] / g->size[1])};
    host_volume_place(g, index, at);
}

host_label_map make_map(const host_volume *grid, uint32_t n)
{
    host_label_map map;
    memset(&map, 0, sizeof map);
    map.grid = *grid;
    map.n_layers = 1;
    map.n_labels = n;
    map.index = calloc(host_label_voxels(&map), sizeof *map.index);
    map.label = calloc(n, sizeof *map.label);
    assert_non_null(map.index);
    assert_non_null(map.label);
    for (uint32_t i = 0; i < n; i++)
        (void)snprintf(map.label[i].name, SMR_NAME_BYTES, "label_%u", i + 1u);
    return map;
}

void set_voxel(host_label_map *map, size_t voxel, uint16_t label)
{
    map->index[voxel] = label;
    map->label[label - 1u].voxels++;
}

host_label_map draw(const host_volume *grid, shape_function f)
{
    host_label_map map = make_map(grid, 1);
    for (size_t i = 0; i < host_label_voxels(&map); i++) {
        double at[3];
        place(grid, i, at);
        if (f(at) < 0.0)
            set_voxel(&map, i, 1);
    }
    return map;
}

int is_closed(const host_mesh *mesh)
{
    const smr_mesh view = host_mesh_view(mesh);
    host_half_edges edges;
    size_t v = 0, i = 0, end = 0;
    int good = mesh->n_triangles > 0;
    assert_int_equal(host_half_edges_make(&view, &edges), 0);
    assert_int_equal(edges.first[mesh->n_vertices], 3u * (size_t)mesh->n_triangles);
    for (v = 0; v < mesh->n_vertices; v++)
        for (i = edges.first[v]; i < edges.first[v + 1u]; i = end) {
            end = host_half_edges_end(&edges, v, i);
            good = good && end - i == 2u &&
                   (mesh->triangles[edges.edge[i].side] == v) != (mesh->triangles[edges.edge[i + 1u].side] == v);
        }
    host_half_edges_free(&edges);
    return good;
}

static void corner(const host_mesh *mesh, size_t t, unsigned c, double p[3])
{
    const float *const x = mesh->xyz + 3u * (size_t)mesh->triangles[3u * t + c];
    p[0] = (double)x[0];
    p[1] = (double)x[1];
    p[2] = (double)x[2];
}

double normal_error(const host_mesh *mesh, shape_function f)
{
    double sum = 0.0, all = 0.0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        double p[3][3], n[3], g[3], area = 0.0, length = 0.0, dot = 0.0;
        for (unsigned k = 0; k < 3; k++)
            corner(mesh, t, k, p[k]);
        for (unsigned k = 0; k < 3; k++) {
            const unsigned i = (k + 1u) % 3u, j = (k + 2u) % 3u;
            double at[3], up = 0.0;
            n[k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
            for (unsigned c = 0; c < 3; c++)
                at[c] = (p[0][c] + p[1][c] + p[2][c]) / 3.0;
            at[k] += 0.01;
            up = f(at);
            at[k] -= 0.02;
            g[k] = up - f(at);
        }
        for (unsigned k = 0; k < 3; k++) {
            area += n[k] * n[k];
            length += g[k] * g[k];
            dot += n[k] * g[k];
        }
        area = sqrt(area);
        dot /= area * sqrt(length) + 1e-30;
        sum += area * acos(dot > 1.0 ? 1.0 : (dot < -1.0 ? -1.0 : dot));
        all += area;
    }
    return sum / all * 180.0 / PI;
}

double mesh_volume(const host_mesh *mesh)
{
    double six = 0.0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        double a[3], b[3], c[3];
        corner(mesh, t, 0, a);
        corner(mesh, t, 1, b);
        corner(mesh, t, 2, c);
        six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return six / 6.0;
}

double dice_of(const host_mesh *mesh, const host_volume *grid, const uint16_t *index, shape_function f)
{
    host_filled filled;
    host_error error = {0};
    uint64_t a = 0, b = 0, both = 0;
    size_t voxel = 0;
    assert_int_equal(host_surface_fill(mesh, grid, &filled, &error), 0);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++, voxel++) {
                const uint32_t i = x - filled.low[0], j = y - filled.low[1], k = z - filled.low[2];
                const int in = i < filled.size[0] && j < filled.size[1] && k < filled.size[2] &&
                               filled.inside[((size_t)k * filled.size[1] + j) * filled.size[0] + i];
                double at[3];
                int true_in = index != NULL && index[voxel] == 1;
                if (index == NULL) {
                    place(grid, voxel, at);
                    true_in = f(at) < 0.0;
                }
                a += (uint64_t)in;
                b += (uint64_t)true_in;
                both += (uint64_t)(in && true_in);
            }
    assert_int_equal(a, filled.voxels);
    host_filled_free(&filled);
    return 2.0 * (double)both / (double)(a + b);
}
