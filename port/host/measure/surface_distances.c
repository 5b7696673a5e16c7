/* surface_distances.c: point-to-surface distances, computed by all threads.
 * SPDX-License-Identifier: MIT */
#include "measure/surface_distances.h"

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
        const float *const p = c->query->samples.xyz + 3u * i;
        smr_closest hit;
        memset(&hit, 0, sizeof hit);
        hit.triangle = SMR_NONE;
        if (smr_surface_closest(c->query->surface, p, NULL, -1.0f, FAR_MM, &hit) != SMR_OK || hit.triangle == SMR_NONE)
            c->failed = 1;
        c->query->mm[i] = hit.distance;
    }
}

static void place_samples(void *arg, uint32_t task, uint32_t worker)
{
    host_query *const query = (host_query *)arg + task;
    (void)worker;
    if (host_samples_make(&query->mesh, &query->samples) == 0)
        query->mm = malloc(sizeof(float) * query->samples.n);
}

int host_distances(const smr_port *port, host_query *queries, uint32_t n_queries)
{
    chunk *chunks = NULL;
    size_t n = 0, at = 0, i = 0;
    uint32_t q = 0;
    int failed = 0;
    host_parallel(port, place_samples, queries, n_queries);
    for (q = 0; q < n_queries; q++) {
        n += (queries[q].samples.n + CHUNK - 1u) / CHUNK;
        failed |= queries[q].mm == NULL;
    }
    chunks = failed ? NULL : calloc(n + 1u, sizeof *chunks);
    if (chunks == NULL)
        return -1;
    for (q = 0; q < n_queries; q++)
        for (i = 0; i < queries[q].samples.n; i += CHUNK) {
            chunks[at].query = &queries[q];
            chunks[at].first = i;
            chunks[at].n = queries[q].samples.n - i < CHUNK ? queries[q].samples.n - i : CHUNK;
            at++;
        }
    host_parallel(port, run_chunk, chunks, (uint32_t)n);
    for (i = 0; i < n; i++)
        failed |= chunks[i].failed;
    free(chunks);
    return failed ? -1 : 0;
}

void host_queries_free(host_query *queries, uint32_t n_queries)
{
    uint32_t q = 0;
    for (q = 0; queries != NULL && q < n_queries; q++) {
        host_samples_free(&queries[q].samples);
        free(queries[q].mm);
        queries[q].mm = NULL;
    }
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
