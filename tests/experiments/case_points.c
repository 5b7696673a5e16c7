/* case_points.c: clouds of points on the visible part of a case, and registrations onto them.
 * SPDX-License-Identifier: MIT */
#include "case_points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/system.h"

typedef struct place {
    double along;
    uint32_t index;
} place;

case_cloud case_sample(const host_mesh *mesh, uint32_t n, double noise_mm, uint32_t seed)
{
    oracle_random r = oracle_seed(9000u + seed);
    double *const below = case_alloc(mesh->n_triangles + 1u, sizeof *below);
    case_cloud cloud = {case_alloc(3u * (size_t)n, sizeof(float)), case_alloc(3u * (size_t)n, sizeof(float)), n};
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < mesh->n_triangles; i++) {
        double normal[3];
        case_triangle_normal(mesh, i, normal);
        below[i + 1u] = below[i] + sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    }
    for (i = 0; i < n; i++) {
        const double at = oracle_uniform(&r, 0.0, below[mesh->n_triangles]), u = sqrt(oracle_uniform(&r, 0.0, 1.0));
        const double v = oracle_uniform(&r, 0.0, 1.0);
        uint32_t low = 0, high = mesh->n_triangles;
        double normal[3], length = 0.0;
        while (high - low > 1u)
            if (below[(low + high) / 2u] <= at)
                low = (low + high) / 2u;
            else
                high = (low + high) / 2u;
        case_triangle_normal(mesh, low, normal);
        length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        for (c = 0; c < 3; c++) {
            const uint32_t *const t = mesh->triangles + 3u * (size_t)low;
            const double p[3] = {(double)mesh->xyz[3u * (size_t)t[0] + (size_t)c],
                                 (double)mesh->xyz[3u * (size_t)t[1] + (size_t)c],
                                 (double)mesh->xyz[3u * (size_t)t[2] + (size_t)c]};
            cloud.xyz[3u * (size_t)i + (size_t)c] =
                (float)((1.0 - u) * p[0] + u * (1.0 - v) * p[1] + u * v * p[2] + noise_mm * case_normal_random(&r));
            cloud.normal[3u * (size_t)i + (size_t)c] = length > 0.0 ? (float)(normal[c] / length) : 0.0f;
        }
    }
    free(below);
    return cloud;
}

void case_cloud_free(case_cloud *cloud)
{
    free(cloud->xyz);
    free(cloud->normal);
}

static int by_place(const void *a, const void *b)
{
    const place *const x = a, *const y = b;
    return (x->along > y->along) - (x->along < y->along);
}

/* Sorts the points along the model's long axis, as a hand that moves would give them. */
static void sweep(case_cloud *cloud, const host_mesh *model)
{
    place *const list = case_alloc(cloud->n, sizeof *list);
    float *const xyz = case_alloc(3u * (size_t)cloud->n, sizeof *xyz);
    float *const normal = case_alloc(3u * (size_t)cloud->n, sizeof *normal);
    double axes[9];
    uint32_t i = 0;
    int c = 0;
    case_axes(&model, 1, axes);
    for (i = 0; i < cloud->n; i++) {
        list[i].index = i;
        for (c = 0; c < 3; c++)
            list[i].along += axes[c] * (double)cloud->xyz[3u * (size_t)i + (size_t)c];
    }
    qsort(list, cloud->n, sizeof *list, by_place);
    for (i = 0; i < cloud->n; i++) {
        memcpy(xyz + 3u * (size_t)i, cloud->xyz + 3u * (size_t)list[i].index, 12);
        memcpy(normal + 3u * (size_t)i, cloud->normal + 3u * (size_t)list[i].index, 12);
    }
    case_cloud_free(cloud);
    free(list);
    cloud->xyz = xyz;
    cloud->normal = normal;
}

/* Everything of a registration in the program's own memory. */
typedef struct runner {
    void *scratch, *prepared, *arena, *memory;
    const smr_model *model;
    smr_points *points;
    smr *s;
} runner;

static smr_status prepare(runner *r, const host_mesh *mesh)
{
    const smr_structure one = {"bone", host_mesh_view(mesh)};
    const smr_prepare_config config = smr_prepare_config_default();
    size_t scratch = 0, bytes = 0;
    smr_status status = smr_prepare_bytes(&one, 1, &config, &scratch);
    r->scratch = host_alloc(scratch);
    if (status == SMR_OK)
        status = smr_prepare(&one, 1, &config, r->scratch, scratch, NULL, 0, &bytes);
    r->prepared = host_alloc(bytes);
    if (status == SMR_OK)
        status = smr_prepare(&one, 1, &config, r->scratch, scratch, r->prepared, bytes, &bytes);
    return status == SMR_OK ? smr_model_open(r->prepared, bytes, &r->model) : status;
}

static smr_status begin(runner *r, const host_mesh *mesh, uint32_t n)
{
    smr_config config = smr_config_default();
    size_t arena = 0, bytes = 0;
    smr_status status = prepare(r, mesh);
    config.basic.n_target_vertices = n;
    if (status == SMR_OK)
        status = smr_arena_bytes(r->model, &config, &arena);
    if (status == SMR_OK)
        status = smr_points_bytes(n, &bytes);
    r->arena = host_alloc(arena);
    r->memory = host_alloc(bytes);
    if (status == SMR_OK)
        status = smr_points_open(n, r->memory, bytes, &r->points);
    if (status == SMR_OK)
        status = smr_init(r->model, &config, NULL, r->arena, arena, &r->s);
    return status;
}

/* Ticks to the end; points come before them. */
static smr_status run(const runner *r, const case_cloud *cloud, const case_feed *feed)
{
    const uint32_t step = feed->per_tick > 0u ? feed->per_tick : cloud->n;
    smr_tick_report report = {0};
    smr_status status = SMR_OK;
    uint32_t at = 0;
    while (status == SMR_OK && !report.done) {
        const uint32_t n = cloud->n - at < step ? cloud->n - at : step;
        if (n > 0u) {
            status = smr_points_add(r->points, cloud->xyz + 3u * (size_t)at,
                                    feed->normals ? cloud->normal + 3u * (size_t)at : NULL, NULL, n);
            if (status == SMR_OK)
                status = smr_set_points(r->s, SMR_ALL, r->points);
            at += n;
        }
        if (status == SMR_OK)
            status = smr_tick(r->s, 0, &report);
    }
    return status;
}

int case_run_points(const case_data *data, const case_feed *feed, double noise_mm, uint32_t seed, case_row *row)
{
    static const char *const names[] = {"good", "look", "failed"};
    const host_mesh *const mesh = &data->body[0].model;
    case_cloud cloud = case_sample(&data->body[0].target, feed->n, noise_mm, seed);
    float *const xyz = case_alloc(3u * (size_t)mesh->n_vertices, sizeof *xyz);
    const float *const list[1] = {xyz};
    smr_verdict verdict;
    runner r;
    smr_status status = SMR_OK;
    double started = 0.0;
    memset(&r, 0, sizeof r);
    if (feed->sweep)
        sweep(&cloud, mesh);
    status = begin(&r, mesh, feed->n);
    started = host_seconds();
    if (status == SMR_OK)
        status = run(&r, &cloud, feed);
    row->seconds = host_seconds() - started;
    if (status == SMR_OK)
        status = smr_get_positions(r.s, 0, xyz);
    if (status == SMR_OK)
        status = smr_get_verdict(r.s, SMR_ALL, &verdict);
    if (status == SMR_OK) {
        row->result = case_measure(data, list);
        row->expected = (double)verdict.expected_error_mm;
        (void)snprintf(row->verdict, sizeof row->verdict, "%s", names[verdict.level]);
    }
    case_cloud_free(&cloud);
    free(xyz);
    free(r.scratch);
    free(r.prepared);
    free(r.arena);
    free(r.memory);
    return status == SMR_OK;
}
