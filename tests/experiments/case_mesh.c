/* case_mesh.c: areas, normals, cuts and subdivision of triangle meshes.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *case_alloc(size_t n, size_t size)
{
    void *const memory = calloc(n > 0 ? n : 1u, size);
    if (memory == NULL) {
        (void)fputs("case: out of memory\n", stderr);
        exit(1);
    }
    return memory;
}

static const float *corner(const host_mesh *mesh, uint32_t triangle, int k)
{
    return mesh->xyz + 3u * (size_t)mesh->triangles[3u * (size_t)triangle + (size_t)k];
}

void case_triangle_normal(const host_mesh *mesh, uint32_t triangle, double out[3])
{
    const float *const a = corner(mesh, triangle, 0), *const b = corner(mesh, triangle, 1),
                       *const c = corner(mesh, triangle, 2);
    double u[3], v[3];
    int i = 0;
    for (i = 0; i < 3; i++) {
        u[i] = (double)b[i] - (double)a[i];
        v[i] = (double)c[i] - (double)a[i];
    }
    for (i = 0; i < 3; i++)
        out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

double case_area(const host_mesh *mesh)
{
    double sum = 0.0, n[3];
    uint32_t t = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        case_triangle_normal(mesh, t, n);
        sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return sum;
}

void case_centre(const host_mesh *mesh, uint32_t triangle, double out[3])
{
    int i = 0;
    for (i = 0; i < 3; i++)
        out[i] = ((double)corner(mesh, triangle, 0)[i] + (double)corner(mesh, triangle, 1)[i] +
                  (double)corner(mesh, triangle, 2)[i]) /
                 3.0;
}

double *case_vertex_normals(const host_mesh *mesh)
{
    double *const normal = case_alloc(3u * (size_t)mesh->n_vertices, sizeof *normal);
    uint32_t t = 0, i = 0;
    int k = 0, c = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        double n[3];
        case_triangle_normal(mesh, t, n);
        for (k = 0; k < 3; k++)
            for (c = 0; c < 3; c++)
                normal[3u * (size_t)mesh->triangles[3u * (size_t)t + (size_t)k] + (size_t)c] += n[c];
    }
    for (i = 0; i < mesh->n_vertices; i++) {
        double *const n = normal + 3u * (size_t)i;
        const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (c = 0; c < 3; c++)
            n[c] = length > 0.0 ? n[c] / length : 0.0;
    }
    return normal;
}

host_mesh case_new_mesh(uint32_t n_vertices, uint32_t n_triangles)
{
    host_mesh mesh = {0};
    mesh.xyz = case_alloc(3u * (size_t)n_vertices, sizeof *mesh.xyz);
    mesh.triangles = case_alloc(3u * (size_t)n_triangles, sizeof *mesh.triangles);
    mesh.n_vertices = n_vertices;
    mesh.n_triangles = n_triangles;
    return mesh;
}

host_mesh case_copy(const host_mesh *mesh)
{
    host_mesh copy = case_new_mesh(mesh->n_vertices, mesh->n_triangles);
    memcpy(copy.xyz, mesh->xyz, 3u * (size_t)mesh->n_vertices * sizeof *copy.xyz);
    memcpy(copy.triangles, mesh->triangles, 3u * (size_t)mesh->n_triangles * sizeof *copy.triangles);
    return copy;
}

host_mesh case_cut(const host_mesh *mesh, const unsigned char *keep)
{
    host_mesh cut = case_new_mesh(mesh->n_vertices, mesh->n_triangles);
    uint32_t *const number = case_alloc(mesh->n_vertices, sizeof *number);
    uint32_t t = 0;
    int k = 0;
    cut.n_vertices = cut.n_triangles = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        for (k = 0; keep[t] && k < 3; k++) {
            const uint32_t v = mesh->triangles[3u * (size_t)t + (size_t)k];
            if (number[v] == 0) {
                memcpy(cut.xyz + 3u * (size_t)cut.n_vertices, mesh->xyz + 3u * (size_t)v, 3u * sizeof *cut.xyz);
                number[v] = ++cut.n_vertices;
            }
            cut.triangles[3u * (size_t)cut.n_triangles + (size_t)k] = number[v] - 1u;
        }
        cut.n_triangles += keep[t] != 0;
    }
    free(number);
    return cut;
}

typedef struct half_edge {
    uint32_t low, high, at; /* its vertices, and 3 * triangle + corner */
} half_edge;

static int by_vertices(const void *a, const void *b)
{
    const half_edge *const x = a, *const y = b;
    if (x->low != y->low)
        return x->low < y->low ? -1 : 1;
    if (x->high != y->high)
        return x->high < y->high ? -1 : 1;
    return (x->at > y->at) - (x->at < y->at);
}

uint32_t case_number_edges(const host_mesh *mesh, uint32_t *edge)
{
    const uint32_t n = 3u * mesh->n_triangles;
    half_edge *const edges = case_alloc(n, sizeof *edges);
    uint32_t i = 0, count = 0;
    for (i = 0; i < n; i++) {
        const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
        edges[i].low = a < b ? a : b;
        edges[i].high = a < b ? b : a;
        edges[i].at = i;
    }
    qsort(edges, n, sizeof *edges, by_vertices);
    for (i = 0; i < n; i++) {
        count += i == 0 || edges[i].low != edges[i - 1u].low || edges[i].high != edges[i - 1u].high;
        edge[edges[i].at] = count - 1u;
    }
    free(edges);
    return count;
}

host_mesh case_subdivide(const host_mesh *mesh)
{
    uint32_t *const edge = case_alloc(3u * (size_t)mesh->n_triangles, sizeof *edge);
    const uint32_t n = mesh->n_vertices, n_edges = case_number_edges(mesh, edge);
    host_mesh fine = case_new_mesh(n + n_edges, 4u * mesh->n_triangles);
    uint32_t i = 0, t = 0;
    int c = 0;
    memcpy(fine.xyz, mesh->xyz, 3u * (size_t)n * sizeof *fine.xyz);
    for (i = 0; i < 3u * mesh->n_triangles; i++) {
        const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
        for (c = 0; c < 3; c++)
            fine.xyz[3u * (size_t)(n + edge[i]) + (size_t)c] =
                0.5f * (mesh->xyz[3u * (size_t)a + (size_t)c] + mesh->xyz[3u * (size_t)b + (size_t)c]);
    }
    for (t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *const v = mesh->triangles + 3u * (size_t)t, *const e = edge + 3u * (size_t)t;
        const uint32_t four[12] = {v[0], n + e[0], n + e[2], v[1],     n + e[1], n + e[0],
                                   v[2], n + e[2], n + e[1], n + e[0], n + e[1], n + e[2]};
        memcpy(fine.triangles + 12u * (size_t)t, four, sizeof four);
    }
    free(edge);
    return fine;
}

void case_axes(const host_mesh *const *mesh, uint32_t n, double axes[9])
{
    double mean[3] = {0.0, 0.0, 0.0}, spread[9] = {0.0}, value[3], v[9], count = 0.0;
    uint32_t m = 0, i = 0;
    int r = 0, c = 0;
    for (m = 0; m < n; m++)
        for (i = 0; i < mesh[m]->n_vertices; i++, count += 1.0)
            for (c = 0; c < 3; c++)
                mean[c] += (double)mesh[m]->xyz[3u * (size_t)i + (size_t)c];
    for (m = 0; m < n; m++)
        for (i = 0; i < mesh[m]->n_vertices; i++)
            for (r = 0; r < 9; r++)
                spread[r] += ((double)mesh[m]->xyz[3u * (size_t)i + (size_t)(r / 3)] - mean[r / 3] / count) *
                             ((double)mesh[m]->xyz[3u * (size_t)i + (size_t)(r % 3)] - mean[r % 3] / count);
    oracle_eigen(spread, value, v);
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++)
            axes[3 * r + c] = v[3 * c + r];
    for (c = 0; axes[2] < 0.0 && c < 3; c++) /* the long axis points up */
        axes[c] = -axes[c];
}
