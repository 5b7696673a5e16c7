/* surface_distances.c: point-to-surface distances, computed by all threads, and their statistics.
 * SPDX-License-Identifier: MIT */
#include "measure/surface_distances.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/threads.h"

#define CHUNK 256u                    /* points per task */
#define FAR_MM (4.0f * SMR_COORD_MAX) /* mm; larger than the distance of any two legal points */

typedef struct chunk {
    const host_query *query;
    size_t first, n;
    int failed;
} chunk;

static void run_chunk(void *arg, uint32_t task, uint32_t worker)
{
    chunk *const c = (chunk *)arg + task;
    size_t i = 0;
    (void)worker;
    for (i = c->first; i < c->first + c->n; i++) {
        smr_closest hit;
        memset(&hit, 0, sizeof hit);
        hit.triangle = SMR_NONE;
        if (smr_surface_closest(c->query->surface, c->query->xyz + 3u * i, NULL, -1.0f, FAR_MM, &hit) != SMR_OK ||
            hit.triangle == SMR_NONE)
            c->failed = 1;
        c->query->mm[i] = hit.distance;
    }
}

int host_distances(const smr_port *port, const host_query *queries, uint32_t n_queries)
{
    chunk *chunks = NULL;
    size_t n = 0, at = 0, i = 0;
    uint32_t q = 0;
    int failed = 0;
    for (q = 0; q < n_queries; q++)
        n += (queries[q].n + CHUNK - 1u) / CHUNK;
    chunks = calloc(n + 1u, sizeof *chunks);
    if (chunks == NULL)
        return -1;
    for (q = 0; q < n_queries; q++)
        for (i = 0; i < queries[q].n; i += CHUNK) {
            chunks[at].query = &queries[q];
            chunks[at].first = i;
            chunks[at].n = queries[q].n - i < CHUNK ? queries[q].n - i : CHUNK;
            at++;
        }
    host_parallel(port, run_chunk, chunks, (uint32_t)n);
    for (i = 0; i < n; i++)
        failed |= chunks[i].failed;
    free(chunks);
    return failed ? -1 : 0;
}

static int by_value(const void *a, const void *b)
{
    float x = 0.0f, y = 0.0f;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

host_stats host_stats_of(float *mm, size_t n)
{
    host_stats stats = {0.0, 0.0, 0.0, 0.0, 0};
    double sum = 0.0, squares = 0.0;
    size_t i = 0;
    stats.n = n;
    if (n == 0)
        return stats;
    qsort(mm, n, sizeof *mm, by_value);
    for (i = 0; i < n; i++) {
        sum += (double)mm[i];
        squares += (double)mm[i] * (double)mm[i];
    }
    stats.mean = sum / (double)n;
    stats.rms = sqrt(squares / (double)n);
    stats.max = (double)mm[n - 1u];
    stats.p95 = (double)mm[(n * 95u + 99u) / 100u - 1u];
    return stats;
}

smr_surface *host_surface_make(const smr_mesh *mesh, void **memory)
{
    size_t bytes = 0;
    smr_surface *surface = NULL;
    *memory = NULL;
    if (smr_surface_bytes(mesh->n_vertices, mesh->n_triangles, &bytes) == SMR_OK)
        *memory = host_alloc(bytes);
    if (*memory != NULL && smr_surface_build(mesh, *memory, bytes, &surface) == SMR_OK)
        return surface;
    free(*memory);
    *memory = NULL;
    return NULL;
}
