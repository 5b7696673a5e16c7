/* bench_job.c: the benchmarks' data, the computed thigh or files, and their registrations.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "bench/bench_job.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Moves the surfaces of a part of the thigh into the job, as structure i. The thigh keeps its images and landmarks. */
static void take_structure(host_bench *bench, uint32_t part, uint32_t i)
{
    host_job *const job = &bench->job;
    host_mesh *const model = &bench->thigh->mesh[HOST_THIGH_MODEL][part];
    host_mesh *const truth = &bench->thigh->mesh[HOST_THIGH_PATIENT][part];
    const char *const name = bench->thigh->thigh.part[part].name;
    strncpy(job->model.part[i].name, name, sizeof job->model.part[i].name - 1u);
    strncpy(job->target[i].name, name, sizeof job->target[i].name - 1u);
    job->model.part[i].mesh = *model;
    job->target[i].mesh = *truth;
    job->target[i].path = name;
    job->target[i].users = 1;
    job->target[i].user = i;
    job->result[i].target = i;
    memset(model, 0, sizeof *model);
    memset(truth, 0, sizeof *truth);
}

static int take_thigh(host_bench *bench, host_error *error)
{
    host_job *const job = &bench->job;
    float from[FIXTURE_THIGH_LANDMARKS][3], to[FIXTURE_THIGH_LANDMARKS][3];
    job->model.part = calloc(FIXTURE_THIGH_PARTS, sizeof *job->model.part);
    job->target = calloc(FIXTURE_THIGH_PARTS, sizeof *job->target);
    job->result = calloc(FIXTURE_THIGH_PARTS, sizeof *job->result);
    if (job->model.part == NULL || job->target == NULL || job->result == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < FIXTURE_THIGH_LANDMARKS; i++) {
        (void)host_thigh_landmark(bench->thigh, HOST_THIGH_MODEL, i, from[i]);
        (void)host_thigh_landmark(bench->thigh, HOST_THIGH_PATIENT, i, to[i]);
    }
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++)
        if (!bench->given->figure1 || strcmp(bench->thigh->thigh.part[i].name, "femur") == 0)
            take_structure(bench, i, job->n_targets++);
    job->model.n_parts = job->n_targets;
    if (!bench->given->figure1) {
        job->reference.view = host_thigh_image(bench->thigh, HOST_THIGH_MODEL);
        job->image.view = host_thigh_image(bench->thigh, HOST_THIGH_PATIENT);
    }
    job->n_landmarks = FIXTURE_THIGH_LANDMARKS;
    return host_job_place_pairs(job, from[0], to[0], error);
}

int host_bench_load(host_bench *bench, const host_options *asked, host_error *error)
{
    memset(bench, 0, sizeof *bench);
    bench->given = asked;
    bench->options = *asked;
    bench->options.quiet = 1;
    if (asked->figure1 && asked->model.n == 0) /* a spline would leave little to do */
        bench->options.align = HOST_ALIGN_SIMILARITY;
    bench->job.options = &bench->options;
    if (host_port_open(&bench->job.port, asked->threads, error) != 0)
        return -1;
    if (asked->model.n > 0) /* surfaces: the benchmarks prepare them anew, a .smr is refused */
        return host_job_load(&bench->job, error) != 0 || host_job_match(&bench->job, error) != 0
                   ? -1
                   : host_job_start(&bench->job, error);
    error->file = "bench";
    bench->thigh = calloc(1, sizeof *bench->thigh);
    if (bench->thigh == NULL)
        return host_fail(error, "start", "free memory");
    if (host_thigh_make(bench->thigh, &bench->job.port.port, asked->seed, asked->small, !asked->figure1, error) != 0)
        return -1;
    return take_thigh(bench, error);
}

void host_bench_free(host_bench *bench)
{
    host_job_free(&bench->job);
    if (bench->thigh != NULL)
        host_thigh_free(bench->thigh);
    free(bench->thigh);
    memset(bench, 0, sizeof *bench);
}

int host_bench_prepare(host_bench *bench, smr_prepare_config config, int image, host_error *error)
{
    host_job *const job = &bench->job;
    free(job->model.prepared);
    free(job->start_xyz);
    job->model.prepared = NULL;
    job->start_xyz = NULL;
    config.reference = image ? &job->reference.view : NULL;
    return host_model_prepare(&job->model, &config, error) != 0 ? -1 : host_job_warp(job, error);
}

smr_status host_bench_start(const host_bench *bench)
{
    const host_job *const job = &bench->job;
    smr_pose pose = job->pose;
    if (job->start_xyz != NULL)
        return host_job_put_start(job);
    if (job->options->align == HOST_ALIGN_NONE) {
        memset(&pose, 0, sizeof pose);
        for (uint32_t i = 0; i < 3; i++)
            pose.m[i][i] = 1.0f;
    }
    return smr_set_pose(job->state, &pose);
}

int host_bench_init(host_bench *bench, const smr_config *config, const smr_port *port, int image, host_error *error)
{
    host_job *const job = &bench->job;
    smr_status status = smr_arena_bytes(job->model.model, config, &job->arena_bytes);
    free(job->arena);
    job->arena = status == SMR_OK ? host_alloc(job->arena_bytes) : NULL;
    if (status == SMR_OK && job->arena == NULL)
        status = SMR_E_ARENA;
    if (status == SMR_OK)
        status = smr_init(job->model.model, config, port, job->arena, job->arena_bytes, &job->state);
    if (status == SMR_OK)
        status = host_bench_start(bench);
    if (status == SMR_OK && image)
        status = smr_set_volume(job->state, &job->image.view);
    for (uint32_t i = 0; !image && status == SMR_OK && i < job->model.n_parts; i++)
        if (job->result[i].target != HOST_NO_TARGET)
            status = smr_set_surface(job->state, i, job->target[job->result[i].target].surface);
    return status == SMR_OK
               ? 0
               : host_fail_of(error, "bench", "set up", "input and options within the library's limits (%s)",
                              smr_status_name(status));
}

/* Frees what the last registration left in the job. */
static void forget_result(host_job *job)
{
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        host_mesh_free(&job->result[i].mesh);
        host_result_moves(&job->result[i]);
    }
    for (uint32_t i = 0; i < job->n_targets; i++) {
        free(job->target[i].memory);
        job->target[i].memory = NULL;
        job->target[i].surface = NULL;
    }
    free(job->arena);
    job->arena = NULL;
    job->ticks = 0;
    job->ticks_s = 0.0;
    job->folds = (host_folds){0, 0, 0.0};
    memset(&job->last, 0, sizeof job->last);
}

int host_bench_register(host_bench *bench, host_error *error)
{
    forget_result(&bench->job);
    return host_job_run(&bench->job, error) != 0 || host_job_evaluate(&bench->job, error) != 0 ? -1 : 0;
}

uint64_t host_bench_processor_ns(void *ctx)
{
    struct timespec now;
    (void)ctx;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}
