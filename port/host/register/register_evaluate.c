/* register_evaluate.c: measures the result of a registration: positions, distances in both directions, folds.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "register/register_job.h"

#define LIKENESS_LEAST 0.5f /* below, the library's verdict on an image is failed */

static int copy_result(host_job *job, uint32_t i, host_error *error)
{
    const host_mesh *const rest = &job->model.part[i].mesh;
    host_result *const result = &job->result[i];
    error->file = "register";
    if (result->mesh.xyz == NULL && host_mesh_append(&result->mesh, rest) != 0)
        return host_fail_at(error, "structure", i, "free memory");
    if (smr_get_positions(job->state, i, result->mesh.xyz) != SMR_OK ||
        smr_get_structure_report(job->state, i, &result->report) != SMR_OK)
        return host_fail_at(error, "structure", i, "positions from the library");
    return 0;
}

/* Tasks of one parallel loop: the folds of a structure. */
static void count_folds(void *arg, uint32_t task, uint32_t worker)
{
    host_job *const job = arg;
    host_result *const result = &job->result[task];
    const smr_mesh view = host_mesh_view(&result->mesh);
    (void)worker;
    if (host_count_folds(&view, job->model.part[task].mesh.xyz, &result->folds, &result->folds_absolute) != 0)
        result->folds_absolute = UINT64_MAX;
}

/* Distances between vertices with the same index, for structures whose truth has as many vertices. */
static int measure_vertices(host_job *job)
{
    uint32_t i = 0;
    size_t n = 0, all = 0, k = 0;
    host_weighted *value = NULL;
    for (i = 0; i < job->model.n_parts; i++)
        n += job->result[i].mesh.n_vertices;
    value = malloc((n + 1u) * sizeof *value);
    if (value == NULL)
        return -1;
    for (i = 0; i < job->model.n_parts; i++) {
        host_result *const result = &job->result[i];
        const host_mesh *const truth = result->target != HOST_NO_TARGET ? &job->target[result->target].mesh : NULL;
        if (truth == NULL || job->truth_map != NULL || truth->n_vertices != result->mesh.n_vertices)
            continue;
        for (k = 0; k < truth->n_vertices; k++) {
            const float *const a = truth->xyz + 3u * k, *const b = result->mesh.xyz + 3u * k;
            const double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1];
            const double z = (double)a[2] - (double)b[2];
            value[all + k] = (host_weighted){(float)sqrt(x * x + y * y + z * z), 1.0f};
        }
        result->by_vertex = host_stats_of(value + all, k);
        all += k;
    }
    job->by_vertex = host_stats_of(value, all);
    free(value);
    return 0;
}

/* Distances to all targets, or to the truth when the target is an image. */
static int measure_all(host_job *job, host_error *error)
{
    int result = 0;
    if (job->n_targets == 0)
        return 0;
    if (job->options->image_target && host_job_make_surfaces(job, error) != 0) {
        error->file = job->options->truth; /* the target's own path is freed with the job */
        return -1;
    }
    result = host_job_distances(job);
    if (result == 0 && job->options->image_target)
        result = measure_vertices(job);
    error->file = "register";
    return result == 0 ? 0 : host_fail(error, "result", "surfaces that can be measured, and free memory for it");
}

/* What the meshes of the results say, wherever they come from. */
static int measure(host_job *job, host_error *error)
{
    const double start = host_seconds();
    uint32_t i = 0;
    if (job->goals != NULL && host_landmark_goals_measure(job->goals, job->state) != SMR_OK)
        return host_fail(error, "result", "landmarks from the library");
    if (measure_all(job, error) != 0)
        return -1;
    error->file = "register";
    job->folds = job->folds_absolute = 0;
    host_parallel(&job->port.port, count_folds, job, job->model.n_parts);
    for (i = 0; i < job->model.n_parts; i++) {
        if (job->result[i].folds_absolute == UINT64_MAX)
            return host_fail(error, "result", "free memory");
        job->folds += job->result[i].folds;
        job->folds_absolute += job->result[i].folds_absolute;
    }
    host_job_measure_labels(job);
    if (host_job_measure_contact(job, error) != 0)
        return -1;
    job->measure_s += host_seconds() - start;
    return 0;
}

int host_job_copy_results(host_job *job, host_error *error)
{
    uint32_t i = 0;
    for (i = 0; i < job->model.n_parts; i++)
        if (copy_result(job, i, error) != 0)
            return -1;
    return 0;
}

int host_job_evaluate(host_job *job, host_error *error)
{
    return host_job_copy_results(job, error) != 0 ? -1 : measure(job, error);
}

int host_job_remember_start(host_job *job, host_error *error)
{
    size_t n = 0, at = 0;
    uint32_t i = 0;
    for (i = 0; i < job->model.n_parts; i++)
        n += 3u * (size_t)job->model.part[i].mesh.n_vertices;
    error->file = "register";
    free(job->begun_xyz);
    job->begun_xyz = malloc((n + 1u) * sizeof *job->begun_xyz);
    if (job->begun_xyz == NULL)
        return host_fail(error, "start", "free memory");
    for (i = 0; i < job->model.n_parts; at += 3u * (size_t)job->model.part[i].mesh.n_vertices, i++)
        if (smr_get_positions(job->state, i, job->begun_xyz + at) != SMR_OK)
            return host_fail_at(error, "structure", i, "positions from the library");
    return 0;
}

int host_job_keep_start(host_job *job, host_error *error)
{
    const float *xyz = job->begun_xyz;
    uint32_t i = 0;
    if (xyz == NULL || (job->measures.reasons & SMR_REASON_SIMILARITY) == 0 ||
        !(job->measures.image_similarity < LIKENESS_LEAST))
        return 0;
    for (i = 0; i < job->model.n_parts; i++) {
        const size_t n = 3u * (size_t)job->result[i].mesh.n_vertices;
        memcpy(job->result[i].mesh.xyz, xyz, n * sizeof *xyz);
        job->result[i].report.moved_mean_mm = job->result[i].report.moved_max_mm = 0.0f;
        job->result[i].verdict.expected_error_mm = (double)NAN;
        xyz += n;
    }
    job->kept_start = 1;
    job->verdict.expected_error_mm = (double)NAN; /* it was of what is not written */
    host_verdict_add(&job->verdict, HOST_VERDICT_FAILED, "the start is written instead of what was found");
    return measure(job, error);
}
