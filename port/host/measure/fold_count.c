/* fold_count.c: counts folds.
 * SPDX-License-Identifier: MIT */
#include "measure/half_edges.h"
#include "measure/surface_distances.h"

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

int host_count_folds(const smr_mesh *mesh, const float *source_xyz, uint64_t *folds, uint64_t *absolute)
{
    host_half_edges edges;
    size_t v = 0, i = 0, end = 0;
    *folds = 0;
    *absolute = 0;
    if (host_half_edges_make(mesh, &edges) != 0)
        return -1;
    for (v = 0; v < mesh->n_vertices; v++)
        for (i = edges.first[v]; i < edges.first[v + 1u]; i = end) {
            const uint32_t *a = NULL, *b = NULL;
            end = host_half_edges_end(&edges, v, i);
            if (end - i != 2u)
                continue;
            a = mesh->triangles + 3u * (size_t)(edges.edge[i].side / 3u);
            b = mesh->triangles + 3u * (size_t)(edges.edge[i + 1u].side / 3u);
            if (!is_fold(mesh->xyz, a, b))
                continue;
            *absolute += 1;
            *folds += source_xyz == NULL || !is_fold(source_xyz, a, b);
        }
    host_half_edges_free(&edges);
    return 0;
}
