/* fold_count.c: counts folds. A counting sort groups half-edges by their smaller vertex; each group is then sorted by
 * the other vertex, so that the triangles of an edge are neighbours in the list.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "measure/surface_distances.h"

typedef struct half_edge {
    uint32_t other; /* the larger vertex */
    uint32_t triangle;
} half_edge;

static int by_vertex(const void *a, const void *b)
{
    const half_edge *const x = a, *const y = b;
    return (x->other > y->other) - (x->other < y->other);
}

/* The normal of a triangle, not normalised. */
static void normal_of(const float *xyz, const uint32_t *triangle, double n[3])
{
    double e[2][3];
    int i = 0, k = 0;
    for (k = 0; k < 2; k++)
        for (i = 0; i < 3; i++)
            e[k][i] = (double)xyz[3u * (size_t)triangle[k + 1] + (size_t)i] -
                      (double)xyz[3u * (size_t)triangle[0] + (size_t)i];
    for (i = 0; i < 3; i++)
        n[i] = e[0][(i + 1) % 3] * e[1][(i + 2) % 3] - e[0][(i + 2) % 3] * e[1][(i + 1) % 3];
}

static int is_fold(const float *xyz, const uint32_t *a, const uint32_t *b)
{
    double m[3], n[3];
    normal_of(xyz, a, m);
    normal_of(xyz, b, n);
    return m[0] * n[0] + m[1] * n[1] + m[2] * n[2] < 0.0;
}

/* Puts the half-edges with smaller vertex v into edge[first[v]] to edge[first[v + 1] - 1]. */
static void group(const smr_mesh *mesh, size_t *first, half_edge *edge)
{
    size_t i = 0, v = 0;
    int pass = 0;
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < 3u * (size_t)mesh->n_triangles; i++) {
            const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
            const uint32_t low = a < b ? a : b;
            if (a == b)
                continue;
            if (pass == 0) {
                first[low + 2u]++;
            } else {
                half_edge *const to = &edge[first[low + 1u]++];
                to->other = a < b ? b : a;
                to->triangle = (uint32_t)(i / 3u);
            }
        }
        for (v = 2; pass == 0 && v < (size_t)mesh->n_vertices + 2u; v++)
            first[v] += first[v - 1u];
    }
}

int host_count_folds(const smr_mesh *mesh, const float *source_xyz, uint64_t *folds, uint64_t *absolute)
{
    size_t *const first = calloc((size_t)mesh->n_vertices + 2u, sizeof *first);
    half_edge *const edge = malloc(3u * (size_t)mesh->n_triangles * sizeof *edge + 1u);
    size_t v = 0, i = 0, next = 0;
    *folds = 0;
    *absolute = 0;
    if (first == NULL || edge == NULL) {
        free(first);
        free(edge);
        return -1;
    }
    group(mesh, first, edge);
    for (v = 0; v < mesh->n_vertices; v++) {
        qsort(edge + first[v], first[v + 1u] - first[v], sizeof *edge, by_vertex);
        for (i = first[v]; i < first[v + 1u]; i = next) {
            const uint32_t *a = NULL, *b = NULL;
            for (next = i + 1u; next < first[v + 1u] && edge[next].other == edge[i].other; next++)
                continue;
            if (next - i != 2u)
                continue;
            a = mesh->triangles + 3u * (size_t)edge[i].triangle;
            b = mesh->triangles + 3u * (size_t)edge[i + 1u].triangle;
            if (!is_fold(mesh->xyz, a, b))
                continue;
            *absolute += 1;
            *folds += source_xyz == NULL || !is_fold(source_xyz, a, b);
        }
    }
    free(first);
    free(edge);
    return 0;
}
