/* surface_distances.c: distances between surfaces, over area and over vertices; folds; targets of points.
 * SPDX-License-Identifier: MIT */
#include "measure/surface_distances.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "measure/sample_order.h"

static int by_distance(const void *a, const void *b)
{
    const host_weighted *const x = a, *const y = b;
    const int mm = (x->mm > y->mm) - (x->mm < y->mm);
    return mm != 0 ? mm : (x->weight > y->weight) - (x->weight < y->weight);
}

/* Sorts by distance, and equal distances by weight. Distances are not negative, so their bits are in their order. */
static void sort(host_weighted *value, size_t n)
{
    host_keyed *const list = calloc(2u * n, sizeof *list);
    for (size_t i = 0; list != NULL && i < n; i++)
        memcpy(&list[i], &value[i], sizeof *list);
    if (list != NULL) {
        host_sort_keys(list, list + n, n);
        memcpy(value, list + n, n * sizeof *value);
    }
    for (size_t i = 0, end = 1; list != NULL && i < n; i = end++) {
        while (end < n && !(value[end].mm > value[i].mm))
            end++;
        if (end - i > 1u)
            qsort(value + i, end - i, sizeof *value, by_distance);
    }
    if (list == NULL)
        qsort(value, n, sizeof *value, by_distance);
    free(list);
}

_Static_assert(sizeof(host_keyed) == sizeof(host_weighted), "a distance's bits are the key, its weight's the item");

host_stats host_stats_of(host_weighted *value, size_t n)
{
    host_stats stats = {0.0, 0.0, 0.0, 0.0, 0, 0.0};
    double sum = 0.0, squares = 0.0, all = 0.0, below = 0.0;
    size_t i = 0;
    stats.n = n;
    if (n == 0)
        return stats;
    sort(value, n);
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
    host_samples_weigh(&query->samples, &query->mesh, seen, weight);
    for (size_t i = 0; i < n; i++)
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
    int result = -1;
    for (uint32_t q = 0; q < n_queries; q++) {
        most = queries[q].samples.n > most ? queries[q].samples.n : most;
        all += queries[q].samples.n;
    }
    float *weight = malloc((most + 1u) * sizeof *weight);
    host_weighted *value = malloc((all + 1u) * sizeof *value);
    if (weight != NULL && value != NULL) {
        result = 0;
        for (uint32_t q = 0; q < n_queries; q++)
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

int host_vertex_stats(const host_query *queries, uint32_t n, const unsigned char *const *seen, host_stats *stats)
{
    return stats_of(queries, n, seen, 0, stats);
}

#define CENTROID_SHARE (27.0 / 60.0)
#define MIDDLE_SHARE (8.0 / 60.0)
#define CORNER_SHARE (3.0 / 60.0)

/* Numbers the edges from *n on, and puts their midpoints there. */
static int place_middles(const smr_mesh *mesh, host_samples *samples)
{
    host_half_edges edges;
    size_t end = 0;
    if (host_half_edges_make(mesh, &edges) != 0)
        return -1;
    for (size_t v = 0; v < mesh->n_vertices; v++)
        for (size_t i = edges.first[v]; i < edges.first[v + 1u]; i = end) {
            const float *const a = mesh->xyz + 3u * v, *const b = mesh->xyz + 3u * (size_t)edges.edge[i].other;
            end = host_half_edges_end(&edges, v, i);
            for (size_t k = i; k < end; k++)
                samples->middle[edges.edge[k].side] = (uint32_t)samples->n;
            for (int c = 0; c < 3; c++)
                samples->xyz[3u * samples->n + (size_t)c] = 0.5f * (a[c] + b[c]);
            samples->n++;
        }
    host_half_edges_free(&edges);
    return 0;
}

static void place_centroids(const smr_mesh *mesh, host_samples *samples)
{
    for (size_t t = 0; t < mesh->n_triangles; t++, samples->n++) {
        const uint32_t *const at = mesh->triangles + 3u * t;
        for (size_t c = 0; c < 3; c++) {
            const double sum = (double)mesh->xyz[3u * (size_t)at[0] + c] + (double)mesh->xyz[3u * (size_t)at[1] + c] +
                               (double)mesh->xyz[3u * (size_t)at[2] + c];
            samples->xyz[3u * samples->n + c] = (float)(sum / 3.0);
        }
    }
}

int host_samples_make(const smr_mesh *mesh, host_samples *samples)
{
    const size_t sides = 3u * (size_t)mesh->n_triangles;
    memset(samples, 0, sizeof *samples);
    samples->xyz = malloc(((size_t)mesh->n_vertices + sides + mesh->n_triangles) * 3u * sizeof(float));
    samples->middle = malloc(sides * sizeof(uint32_t) + 1u);
    if (samples->xyz != NULL && samples->middle != NULL) {
        memcpy(samples->xyz, mesh->xyz, 3u * (size_t)mesh->n_vertices * sizeof(float));
        memset(samples->middle, 0xff, sides * sizeof(uint32_t));
        samples->n = samples->n_vertices = mesh->n_vertices;
        if (place_middles(mesh, samples) == 0) {
            place_centroids(mesh, samples);
            return 0;
        }
    }
    host_samples_free(samples);
    return -1;
}

void host_samples_free(host_samples *samples)
{
    free(samples->xyz);
    free(samples->middle);
    memset(samples, 0, sizeof *samples);
}

/* The normal of a triangle, not normalised. */
static void normal_of(const float *xyz, const uint32_t *at, double n[3])
{
    double e[2][3];
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++)
            e[k][i] = (double)xyz[3u * (size_t)at[k + 1] + (size_t)i] - (double)xyz[3u * (size_t)at[0] + (size_t)i];
    for (int i = 0; i < 3; i++)
        n[i] = e[0][(i + 1) % 3] * e[1][(i + 2) % 3] - e[0][(i + 2) % 3] * e[1][(i + 1) % 3];
}

static double area_of(const float *xyz, const uint32_t *corner)
{
    double n[3];
    normal_of(xyz, corner, n);
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static void add(float *sum, size_t i, double area) { sum[i] = (sum[i] > 0.0f ? sum[i] : 0.0f) + (float)area; }

/* Returns the area of the triangles that count. */
static double weigh_triangles(const host_samples *samples, const smr_mesh *mesh, const unsigned char *seen, float *sum)
{
    const size_t first_centroid = samples->n - mesh->n_triangles;
    double all = 0.0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *const corner = mesh->triangles + 3u * t, *const middle = samples->middle + 3u * t;
        const double area = area_of(mesh->xyz, corner);
        if (seen != NULL && (!seen[corner[0]] || !seen[corner[1]] || !seen[corner[2]]))
            continue;
        add(sum, first_centroid + t, CENTROID_SHARE * area);
        for (size_t c = 0; c < 3; c++) {
            add(sum, corner[c], CORNER_SHARE * area);
            if (middle[c] != SMR_NONE)
                add(sum, middle[c], MIDDLE_SHARE * area);
        }
        all += area;
    }
    return all;
}

void host_samples_weigh(const host_samples *samples, const smr_mesh *mesh, const unsigned char *seen, float *weight)
{
    double area = 0.0;
    for (size_t i = 0; i < samples->n; i++)
        weight[i] = mesh->n_triangles == 0 && (seen == NULL || seen[i]) ? 1.0f : HOST_NOT_COUNTED;
    if (mesh->n_triangles > 0)
        area = weigh_triangles(samples, mesh, seen, weight);
    for (size_t i = 0; mesh->n_triangles > 0 && !(area > 0.0) && i < samples->n; i++)
        weight[i] = weight[i] < 0.0f ? weight[i] : 1.0f;
}

static int is_fold(const float *xyz, const uint32_t *a, const uint32_t *b)
{
    double m[3], n[3];
    normal_of(xyz, a, m);
    normal_of(xyz, b, n);
    return m[0] * n[0] + m[1] * n[1] + m[2] * n[2] < 0.0;
}

/* The triangle's height over one of its sides. */
static double height_over(const float *xyz, const uint32_t *triangle, uint32_t side)
{
    const float *const p = xyz + 3u * (size_t)triangle[side], *const q = xyz + 3u * (size_t)triangle[(side + 1u) % 3u];
    const double x = (double)p[0] - (double)q[0], y = (double)p[1] - (double)q[1], z = (double)p[2] - (double)q[2];
    const double length = sqrt(x * x + y * y + z * z);
    return length > 0.0 ? 2.0 * area_of(xyz, triangle) / length : 0.0;
}

int host_count_folds(const smr_mesh *mesh, const float *source_xyz, host_folds *folds)
{
    host_half_edges edges;
    size_t end = 0;
    *folds = (host_folds){0, 0, 0.0};
    if (host_half_edges_make(mesh, &edges) != 0)
        return -1;
    for (size_t v = 0; v < mesh->n_vertices; v++)
        for (size_t i = edges.first[v]; i < edges.first[v + 1u]; i = end) {
            end = host_half_edges_end(&edges, v, i);
            if (end - i != 2u)
                continue;
            const uint32_t side[2] = {edges.edge[i].side, edges.edge[i + 1u].side};
            const uint32_t *a = mesh->triangles + 3u * (size_t)(side[0] / 3u);
            const uint32_t *b = mesh->triangles + 3u * (size_t)(side[1] / 3u);
            if (!is_fold(mesh->xyz, a, b))
                continue;
            folds->all++;
            if (source_xyz != NULL && is_fold(source_xyz, a, b))
                continue;
            folds->n++;
            folds->deepest_mm = fmax(folds->deepest_mm, fmin(height_over(mesh->xyz, a, side[0] % 3u),
                                                             height_over(mesh->xyz, b, side[1] % 3u)));
        }
    host_half_edges_free(&edges);
    return 0;
}

smr_points *host_points_make(const host_mesh *mesh, void **memory)
{
    smr_points *points = NULL;
    size_t bytes = 0;
    *memory = NULL;
    if (smr_points_bytes(mesh->n_vertices, &bytes) == SMR_OK)
        *memory = host_alloc(bytes);
    if (*memory != NULL && smr_points_open(mesh->n_vertices, *memory, bytes, &points) == SMR_OK &&
        smr_points_add(points, mesh->xyz, mesh->normals, NULL, mesh->n_vertices) == SMR_OK)
        return points;
    free(*memory);
    *memory = NULL;
    return NULL;
}

smr_surface *host_points_surface(const host_mesh *mesh, void **memory)
{
    void *cloud = NULL;
    const smr_points *const points = host_points_make(mesh, &cloud);
    smr_surface *surface = NULL;
    size_t bytes = 0;
    *memory = NULL;
    if (points != NULL && smr_points_surface_bytes(mesh->n_vertices, &bytes) == SMR_OK)
        *memory = host_alloc(bytes);
    if (*memory == NULL || smr_points_surface(points, *memory, bytes, &surface) != SMR_OK) {
        free(*memory);
        *memory = NULL;
        surface = NULL;
    }
    free(cloud);
    return surface;
}

#define CHUNK 256u /* points per task */

float host_distance(const smr_surface *surface, const float point[3])
{
    float mm = -1.0f;
    return smr_surface_distances(surface, point, 1, &mm) == SMR_OK && mm >= 0.0f ? mm : NAN;
}

typedef struct chunk {
    const host_query *query;
    size_t first, n;
    int failed;
} chunk;

static void run_chunk(void *arg, uint32_t task, uint32_t worker)
{
    chunk *const c = (chunk *)arg + task;
    const uint32_t *const order = c->query->order + c->first;
    float xyz[CHUNK][3], mm[CHUNK];
    (void)worker;
    for (size_t i = 0; i < c->n; i++)
        memcpy(xyz[i], c->query->samples.xyz + 3u * (size_t)order[i], sizeof xyz[i]);
    c->failed = smr_surface_distances(c->query->surface, xyz[0], (uint32_t)c->n, mm) != SMR_OK;
    for (size_t i = 0; i < c->n && !c->failed; i++) {
        c->query->mm[order[i]] = mm[i];
        c->failed = mm[i] < 0.0f;
    }
}

static void place_samples(void *arg, uint32_t task, uint32_t worker)
{
    host_query *const query = (host_query *)arg + task;
    (void)worker;
    if (host_samples_make(&query->mesh, &query->samples) == 0)
        query->mm = malloc(sizeof(float) * query->samples.n);
    query->order = host_sample_order(query->samples.xyz, query->samples.n);
}

int host_distances(const smr_port *port, host_query *queries, uint32_t n_queries)
{
    size_t n = 0, at = 0;
    int failed = 0;
    host_parallel(port, place_samples, queries, n_queries);
    for (uint32_t q = 0; q < n_queries; q++) {
        n += (queries[q].samples.n + CHUNK - 1u) / CHUNK;
        failed |= queries[q].mm == NULL || queries[q].order == NULL;
    }
    chunk *chunks = failed ? NULL : calloc(n + 1u, sizeof *chunks);
    if (chunks == NULL)
        return -1;
    for (uint32_t q = 0; q < n_queries; q++)
        for (size_t i = 0; i < queries[q].samples.n; i += CHUNK) {
            const size_t left = queries[q].samples.n - i;
            chunks[at++] = (chunk){&queries[q], i, left < CHUNK ? left : CHUNK, 0};
        }
    host_parallel(port, run_chunk, chunks, (uint32_t)n);
    for (size_t i = 0; i < n; i++)
        failed |= chunks[i].failed;
    free(chunks);
    return failed ? -1 : 0;
}

void host_queries_free(host_query *queries, uint32_t n_queries)
{
    for (uint32_t q = 0; queries != NULL && q < n_queries; q++) {
        host_samples_free(&queries[q].samples);
        free(queries[q].mm);
        free(queries[q].order);
        queries[q].mm = NULL;
        queries[q].order = NULL;
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
