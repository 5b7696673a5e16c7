/* register_trace.c: the trace of a registration: a table with a row for the start and one for each iteration. What is
 * measured between ticks does not count in their times and changes no bit.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "register/register_job.h"

/* A column's number, empty where nothing was measured. */
static void put(host_buffer *out, int measured, double value)
{
    if (measured && isfinite(value))
        host_buffer_print(out, ",%.6g", value);
    else
        host_buffer_print(out, ",");
}

/* Distances between the positions of the row before and these, mm; takes these over. */
static void take_steps(host_job *job, double *mean, double *max)
{
    float *before = job->trace_xyz;
    size_t n = 0, k = 0;
    uint32_t i = 0;
    *mean = *max = 0.0;
    for (i = 0; i < job->model.n_parts; i++) {
        const host_mesh *const mesh = &job->result[i].mesh;
        for (k = 0; k < mesh->n_vertices; k++) {
            const float *const a = before + 3u * k, *const b = mesh->xyz + 3u * k;
            const double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1];
            const double z = (double)b[2] - (double)a[2], step = sqrt(x * x + y * y + z * z);
            *mean += step;
            *max = step > *max ? step : *max;
        }
        memcpy(before, mesh->xyz, 3u * sizeof *before * mesh->n_vertices);
        before += 3u * (size_t)mesh->n_vertices;
        n += mesh->n_vertices;
    }
    *mean /= n > 0 ? (double)n : 1.0;
}

/* The row of the positions as they are. */
static int add_row(host_job *job, host_error *error)
{
    host_buffer *const out = &job->trace;
    const smr_tick_report *const last = &job->last;
    const host_stats *const to = &job->area.to_target, *const from = &job->area.to_result;
    const int moves = last->iteration > 0;
    smr_verdict verdict;
    double mean = 0.0, max = 0.0;
    if (host_job_evaluate(job, error) != 0)
        return -1;
    error->file = "register";
    if (smr_get_verdict(job->state, SMR_ALL, &verdict) != SMR_OK)
        return host_fail(error, "trace", "an iteration that can be measured");
    take_steps(job, &mean, &max);
    host_buffer_print(out, "%" PRIu32, last->iteration);
    put(out, 1, (double)job->model.info.radius_mm[job->last.details.radius]);
    put(out, 1, 1e3 * job->ticks_s);
    put(out, to->n > 0, to->mean);
    put(out, from->n > 0, from->mean);
    put(out, to->n + from->n > 0, fmax(to->max, from->max));
    put(out, job->by_vertex.n > 0, job->by_vertex.mean);
    put(out, verdict.image_similarity > -1.0f, (double)verdict.image_similarity);
    put(out, 1, (double)verdict.strain);
    put(out, moves, mean);
    put(out, moves, max);
    put(out, moves, last->details.n_taken);
    put(out, moves, last->n_forces);
    put(out, moves && last->residual_mean_mm >= 0.0f, (double)last->residual_mean_mm);
    put(out, 1, last->details.plastic_updates);
    put(out, 1, (double)job->folds);
    host_buffer_print(out, "\n");
    return out->failed ? host_fail(error, "trace", "free memory") : 0;
}

int host_job_trace_row(host_job *job, host_error *error)
{
    const double start = host_seconds();
    const int result = add_row(job, error);
    job->trace_s += host_seconds() - start;
    return result;
}

int host_job_trace_begin(host_job *job, host_error *error)
{
    size_t n = 0;
    uint32_t i = 0;
    for (i = 0; i < job->model.n_parts; i++)
        n += job->model.part[i].mesh.n_vertices;
    job->trace_xyz = calloc(3u * n + 1u, sizeof *job->trace_xyz);
    if (job->trace_xyz == NULL)
        return host_fail(error, "trace", "free memory");
    host_buffer_print(
        &job->trace, "iteration,radius_mm,time_ms,mean_to_mm,mean_from_mm,hausdorff_mm,vertex_mm,likeness,strain_share,"
                     "moved_mean_mm,moved_max_mm,active,forces,residual_mm,reference_updates,folds\n");
    return host_job_trace_row(job, error);
}
