/* distance_stats.c: statistics of distances, over the area of surfaces or over their vertices.
 * SPDX-License-Identifier: MIT */
#include "measure/surface_distances.h"

#include <math.h>
#include <stdlib.h>

static int by_distance(const void *a, const void *b)
{
    const host_weighted *const x = a, *const y = b;
    const int mm = (x->mm > y->mm) - (x->mm < y->mm);
    return mm != 0 ? mm : (x->weight > y->weight) - (x->weight < y->weight);
}

host_stats host_stats_of(host_weighted *value, size_t n)
{
    host_stats stats = {0.0, 0.0, 0.0, 0.0, 0, 0.0};
    double sum = 0.0, squares = 0.0, all = 0.0, below = 0.0;
    size_t i = 0;
    stats.n = n;
    if (n == 0)
        return stats;
    qsort(value, n, sizeof *value, by_distance);
    for (i = 0; i < n; i++) {
        const double mm = (double)value[i].mm, weight = (double)value[i].weight;
        sum += weight * mm;
        squares += weight * mm * mm;
        all += weight;
    }
    for (i = 0; i + 1u < n && 20.0 * (below += (double)value[i].weight) < 19.0 * all;)
        i++;
    stats.weight = all;
    stats.mean = sum / all;
    stats.rms = sqrt(squares / all);
    stats.max = (double)value[n - 1u].mm;
    stats.p95 = (double)value[i].mm;
    return stats;
}

/* Collects what counts of one query behind the `at` values before; returns how many there are then. */
static size_t collect(const host_query *query, const unsigned char *seen, int by_area, float *weight,
                      host_weighted *value, size_t at)
{
    const size_t n = by_area ? query->samples.n : query->samples.n_vertices;
    size_t i = 0;
    host_samples_weigh(&query->samples, &query->mesh, seen, weight);
    for (i = 0; i < n; i++)
        if (weight[i] >= 0.0f) {
            value[at].mm = query->mm[i];
            value[at++].weight = by_area ? weight[i] : 1.0f;
        }
    return at;
}

static int stats_of(const host_query *queries, uint32_t n_queries, const unsigned char *const *seen, int by_area,
                    host_stats *stats)
{
    size_t most = 0, all = 0, n = 0;
    uint32_t q = 0;
    int result = -1;
    float *weight = NULL;
    host_weighted *value = NULL;
    for (q = 0; q < n_queries; q++) {
        most = queries[q].samples.n > most ? queries[q].samples.n : most;
        all += queries[q].samples.n;
    }
    weight = malloc((most + 1u) * sizeof *weight);
    value = malloc((all + 1u) * sizeof *value);
    if (weight != NULL && value != NULL) {
        result = 0;
        for (q = 0; q < n_queries; q++)
            n = collect(&queries[q], seen == NULL ? NULL : seen[q], by_area, weight, value, n);
        *stats = host_stats_of(value, n);
    }
    free(weight);
    free(value);
    return result;
}

int host_area_stats(const host_query *queries, uint32_t n_queries, const unsigned char *const *seen, host_stats *stats)
{
    return stats_of(queries, n_queries, seen, 1, stats);
}

int host_vertex_stats(const host_query *queries, uint32_t n_queries, const unsigned char *const *seen,
                      host_stats *stats)
{
    return stats_of(queries, n_queries, seen, 0, stats);
}
