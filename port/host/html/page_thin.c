/* page_thin.c: vertex clustering (J. Rossignac, P. Borrel, 1993): vertices in one cube become the first of them.
 * SPDX-License-Identifier: MIT */
#include "html/page_thin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct place {
    uint64_t cube;
    uint32_t vertex;
} place;

static int by_cube(const void *a, const void *b)
{
    const place *const x = a, *const y = b;
    if (x->cube != y->cube)
        return x->cube < y->cube ? -1 : 1;
    return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

/* The number of a cube, 21 bits an axis. cell_mm 0: each vertex has its own. */
static uint64_t cube_of(const float *xyz, uint32_t vertex, float cell_mm)
{
    uint64_t cube = 0;
    int c = 0;
    if (!(cell_mm > 0.0f))
        return vertex;
    for (c = 0; c < 3; c++) {
        const double at = floor((double)xyz[3u * (size_t)vertex + (size_t)c] / (double)cell_mm) + 1048576.0;
        cube = cube << 21 | (at > 0.0 ? at < 2097151.0 ? (uint64_t)at : 2097151u : 0u);
    }
    return cube;
}

/* to[i]: the first vertex in the cube of vertex i. */
static int find_first(const host_mesh *mesh, float cell_mm, uint32_t *to)
{
    place *const list = malloc(((size_t)mesh->n_vertices + 1u) * sizeof *list);
    uint32_t i = 0, first = 0;
    if (list == NULL)
        return -1;
    for (i = 0; i < mesh->n_vertices; i++)
        list[i] = (place){cube_of(mesh->xyz, i, cell_mm), i};
    if (cell_mm > 0.0f)
        qsort(list, mesh->n_vertices, sizeof *list, by_cube);
    for (i = 0; i < mesh->n_vertices; i++) {
        if (i == 0 || list[i].cube != list[i - 1u].cube)
            first = list[i].vertex;
        to[list[i].vertex] = first;
    }
    free(list);
    return 0;
}

/* Numbers the kept vertices: number[i] of those that are their cube's first. */
static void keep_first(const host_mesh *mesh, const uint32_t *to, uint32_t *number, host_page_mesh *out)
{
    uint32_t i = 0;
    for (i = 0; i < mesh->n_vertices; i++)
        if (to[i] == i) {
            number[i] = out->n_vertices;
            out->keep[out->n_vertices++] = i;
        }
    for (i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *const t = mesh->triangles + 3u * (size_t)i;
        const uint32_t a = to[t[0]], b = to[t[1]], c = to[t[2]];
        uint32_t *const put = out->triangles + 3u * (size_t)out->n_triangles;
        if (a == b || b == c || c == a)
            continue;
        put[0] = number[a];
        put[1] = number[b];
        put[2] = number[c];
        out->n_triangles++;
    }
}

int host_page_thin(const host_mesh *mesh, float cell_mm, host_page_mesh *out)
{
    const size_t n = (size_t)mesh->n_vertices + 1u;
    uint32_t *const to = malloc(n * sizeof *to), *const number = malloc(n * sizeof *number);
    int result = -1;
    memset(out, 0, sizeof *out);
    out->keep = malloc(n * sizeof *out->keep);
    out->triangles = malloc((3u * (size_t)mesh->n_triangles + 1u) * sizeof *out->triangles);
    if (to != NULL && number != NULL && out->keep != NULL && out->triangles != NULL &&
        find_first(mesh, cell_mm, to) == 0) {
        keep_first(mesh, to, number, out);
        result = 0;
    }
    free(to);
    free(number);
    return result;
}

void host_page_mesh_free(host_page_mesh *mesh)
{
    free(mesh->keep);
    free(mesh->triangles);
    memset(mesh, 0, sizeof *mesh);
}

float host_page_edge(const host_mesh *mesh)
{
    double sum = 0.0;
    uint32_t i = 0;
    for (i = 0; i < mesh->n_triangles; i++) {
        const float *const a = mesh->xyz + 3u * (size_t)mesh->triangles[3u * (size_t)i];
        const float *const b = mesh->xyz + 3u * (size_t)mesh->triangles[3u * (size_t)i + 1u];
        const double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1];
        const double z = (double)b[2] - (double)a[2];
        sum += sqrt(x * x + y * y + z * z);
    }
    return mesh->n_triangles > 0 ? (float)(sum / mesh->n_triangles) : 0.0f;
}

size_t host_page_mesh_bytes(uint32_t n_vertices, uint32_t n_triangles, size_t vertex_bytes)
{
    return n_vertices * vertex_bytes + (size_t)n_triangles * (n_vertices > 65536u ? 12u : 6u);
}
