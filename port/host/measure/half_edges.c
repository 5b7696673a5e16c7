/* half_edges.c: groups half-edges by their smaller vertex with a counting sort, then sorts each group by the other one.
 * SPDX-License-Identifier: MIT */
#include "measure/half_edges.h"

#include <stdlib.h>
#include <string.h>

static int by_vertex(const void *a, const void *b)
{
    const host_half_edge *const x = a, *const y = b;
    const int other = (x->other > y->other) - (x->other < y->other);
    return other != 0 ? other : (x->side > y->side) - (x->side < y->side);
}

static void group(const smr_mesh *mesh, host_half_edges *edges)
{
    size_t *const first = edges->first;
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
                host_half_edge *const to = &edges->edge[first[low + 1u]++];
                to->other = a < b ? b : a;
                to->side = (uint32_t)i;
            }
        }
        for (v = 2; pass == 0 && v < (size_t)mesh->n_vertices + 2u; v++)
            first[v] += first[v - 1u];
    }
}

int host_half_edges_make(const smr_mesh *mesh, host_half_edges *edges)
{
    size_t v = 0;
    edges->first = calloc((size_t)mesh->n_vertices + 2u, sizeof *edges->first);
    edges->edge = malloc(3u * (size_t)mesh->n_triangles * sizeof *edges->edge + 1u);
    if (edges->first == NULL || edges->edge == NULL) {
        host_half_edges_free(edges);
        return -1;
    }
    group(mesh, edges);
    for (v = 0; v < mesh->n_vertices; v++)
        qsort(edges->edge + edges->first[v], edges->first[v + 1u] - edges->first[v], sizeof *edges->edge, by_vertex);
    return 0;
}

void host_half_edges_free(host_half_edges *edges)
{
    free(edges->first);
    free(edges->edge);
    memset(edges, 0, sizeof *edges);
}
