/* register_evaluate.c: measures the result of a registration: positions, distances in both directions, folds.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "register/register_job.h"

/* A target, and the surface of all structures that are registered to it. */
typedef struct pair {
    const host_target *target;
    smr_surface *result;
    void *memory;   /* memory of `result`; owned */
    uint32_t index; /* index of the target */
    const host_job *job;
} pair;

static int copy_result(host_job *job, uint32_t i, host_error *error)
{
    const host_mesh *const rest = &job->model.part[i].mesh;
    host_result *const result = &job->result[i];
    error->file = "register";
    memset(&result->mesh, 0, sizeof result->mesh);
    if (host_mesh_append(&result->mesh, rest) != 0)
        return host_fail_at(error, "structure", i, "free memory");
    if (smr_get_positions(job->state, i, result->mesh.xyz) != SMR_OK ||
        smr_get_structure_report(job->state, i, &result->report) != SMR_OK)
        return host_fail_at(error, "structure", i, "positions from the library");
    return 0;
}

/* Tasks of one parallel loop: the folds of a structure, or the result's surface for a target. */
static void count_folds(void *arg, uint32_t task, uint32_t worker)
{
    host_job *const job = arg;
    host_result *const result = &job->result[task];
    const smr_mesh view = host_mesh_view(&result->mesh);
    (void)worker;
    if (host_count_folds(&view, job->model.part[task].mesh.xyz, &result->folds, &result->folds_absolute) != 0)
        result->folds_absolute = UINT64_MAX;
}

static void build_result(void *arg, uint32_t task, uint32_t worker)
{
    pair *const p = (pair *)arg + task;
    host_mesh whole;
    uint32_t i = 0;
    int result = 0;
    (void)worker;
    memset(&whole, 0, sizeof whole);
    for (i = 0; result == 0 && i < p->job->model.n_parts; i++)
        if (p->job->result[i].target == p->index)
            result = host_mesh_append(&whole, &p->job->result[i].mesh);
    if (result == 0) {
        const smr_mesh view = host_mesh_view(&whole);
        p->result = host_surface_make(&view, &p->memory);
    }
    host_mesh_free(&whole);
}

/* Queries for the vertices of all structures with a target, then of all targets in use; one array of distances. */
static uint32_t make_queries(const host_job *job, const pair *pairs, uint32_t n_pairs, host_query *query, float *mm)
{
    uint32_t i = 0, n = 0;
    for (i = 0; i < job->model.n_parts; i++) {
        const host_result *const result = &job->result[i];
        if (result->target == HOST_NO_TARGET)
            continue;
        query[n].surface = job->target[result->target].surface;
        query[n].xyz = result->mesh.xyz;
        query[n].n = result->mesh.n_vertices;
        query[n++].mm = mm;
        mm += result->mesh.n_vertices;
    }
    for (i = 0; i < n_pairs; i++) {
        query[n].surface = pairs[i].result;
        query[n].xyz = pairs[i].target->mesh.xyz;
        query[n].n = pairs[i].target->mesh.n_vertices;
        query[n++].mm = mm;
        mm += pairs[i].target->mesh.n_vertices;
    }
    return n;
}

/* Statistics per structure, then over all: sorting all distances destroys the order by structure. */
static void summarise(host_job *job, const pair *pairs, uint32_t n_pairs, const host_query *query)
{
    uint32_t i = 0, q = 0;
    size_t n = 0;
    float *mm = query[0].mm;
    for (i = 0; i < job->model.n_parts; i++) {
        if (job->result[i].target == HOST_NO_TARGET)
            continue;
        job->result[i].to_target = host_stats_of(query[q].mm, query[q].n);
        n += query[q++].n;
    }
    job->to_target = host_stats_of(mm, n);
    mm += n;
    for (i = 0, n = 0; i < n_pairs; i++) {
        const host_stats stats = host_stats_of(query[q].mm, query[q].n);
        if (pairs[i].target->users == 1)
            job->result[pairs[i].target->user].to_result = stats;
        n += query[q++].n;
    }
    job->to_result = host_stats_of(mm, n);
}

static int measure(host_job *job, pair *pairs, host_query *query)
{
    uint32_t i = 0, n_pairs = 0;
    size_t n = 1;
    float *mm = NULL;
    int result = 0;
    for (i = 0; i < job->n_targets; i++) {
        if (job->target[i].users == 0)
            continue;
        pairs[n_pairs].target = &job->target[i];
        pairs[n_pairs].index = i;
        pairs[n_pairs++].job = job;
        n += job->target[i].mesh.n_vertices;
    }
    host_parallel(&job->port.port, build_result, pairs, n_pairs);
    for (i = 0; i < n_pairs; i++)
        result |= pairs[i].result == NULL ? -1 : 0;
    for (i = 0; i < job->model.n_parts; i++)
        n += job->result[i].mesh.n_vertices;
    mm = malloc(n * sizeof *mm);
    if (mm == NULL)
        result = -1;
    if (result == 0)
        result = host_distances(&job->port.port, query, make_queries(job, pairs, n_pairs, query, mm));
    if (result == 0)
        summarise(job, pairs, n_pairs, query);
    for (i = 0; i < n_pairs; i++)
        free(pairs[i].memory);
    free(mm);
    return result;
}

/* Distances between vertices with the same index, for structures whose truth has as many vertices. */
static int measure_vertices(host_job *job)
{
    uint32_t i = 0;
    size_t n = 0, all = 0, k = 0;
    float *mm = NULL;
    for (i = 0; i < job->model.n_parts; i++)
        n += job->result[i].mesh.n_vertices;
    mm = malloc((n + 1u) * sizeof *mm);
    if (mm == NULL)
        return -1;
    for (i = 0; i < job->model.n_parts; i++) {
        host_result *const result = &job->result[i];
        const host_mesh *const truth = &job->target[result->target].mesh;
        if (truth->n_vertices != result->mesh.n_vertices)
            continue;
        for (k = 0; k < truth->n_vertices; k++) {
            const float *const a = truth->xyz + 3u * k, *const b = result->mesh.xyz + 3u * k;
            const double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1];
            const double z = (double)a[2] - (double)b[2];
            mm[all + k] = (float)sqrt(x * x + y * y + z * z);
        }
        result->by_vertex = host_stats_of(mm + all, k);
        all += k;
    }
    job->by_vertex = host_stats_of(mm, all);
    free(mm);
    return 0;
}

/* Distances to all targets, or to the truth when the target is an image. */
static int measure_all(host_job *job, host_error *error)
{
    pair *pairs = NULL;
    host_query *query = NULL;
    int result = -1;
    if (job->n_targets == 0)
        return 0;
    if (job->options->image_target && host_job_make_surfaces(job, error) != 0) {
        error->file = job->options->truth; /* the target's own path is freed with the job */
        return -1;
    }
    pairs = calloc(job->n_targets, sizeof *pairs);
    query = calloc((size_t)job->n_targets + job->model.n_parts, sizeof *query);
    if (pairs != NULL && query != NULL)
        result = measure(job, pairs, query);
    if (result == 0 && job->options->image_target)
        result = measure_vertices(job);
    free(pairs);
    free(query);
    error->file = "register";
    return result == 0 ? 0 : host_fail(error, "result", "surfaces that can be measured, and free memory for it");
}

int host_job_evaluate(host_job *job, host_error *error)
{
    const double start = host_seconds();
    uint32_t i = 0;
    for (i = 0; i < job->model.n_parts; i++)
        if (copy_result(job, i, error) != 0)
            return -1;
    if (measure_all(job, error) != 0)
        return -1;
    error->file = "register";
    host_parallel(&job->port.port, count_folds, job, job->model.n_parts);
    for (i = 0; i < job->model.n_parts; i++) {
        if (job->result[i].folds_absolute == UINT64_MAX)
            return host_fail(error, "result", "free memory");
        job->folds += job->result[i].folds;
        job->folds_absolute += job->result[i].folds_absolute;
    }
    job->measure_s += host_seconds() - start;
    return 0;
}
