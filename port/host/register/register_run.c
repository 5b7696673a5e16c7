/* register_run.c: runs the registration: allocates the arena, sets the targets, ticks until the schedule ends.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "register/register_volume.h"

#define PROGRESS_EVERY_S 0.1
#define TICKS_MAX 10000000u /* with a budget, an iteration may take many ticks */

static int refuse(host_error *error, const char *place, smr_status status)
{
    error->file = "register";
    return host_fail(error, place, "input and options within the library's limits (%s)", smr_status_name(status));
}

/* Sets every structure's start positions from the landmarks. */
static smr_status put_start(const host_job *job)
{
    const float *xyz = job->start_xyz;
    smr_status status = SMR_OK;
    uint32_t i = 0;
    for (i = 0; status == SMR_OK && i < job->model.n_parts; i++) {
        status = smr_set_positions(job->state, i, xyz);
        xyz += 3u * (size_t)job->model.part[i].mesh.n_vertices;
    }
    return status;
}

static smr_status set_target(smr *s, uint32_t part, const host_target *target)
{
    return target->points != NULL ? smr_set_points(s, part, target->points) : smr_set_surface(s, part, target->surface);
}

static int set_targets(host_job *job, host_error *error)
{
    smr_status status = SMR_OK;
    uint32_t i = 0;
    if (job->options->image_target)
        status = smr_set_volume(job->state, &job->image.view);
    else if (job->n_targets == 1)
        status = set_target(job->state, SMR_ALL, &job->target[0]);
    for (i = 0; !job->options->image_target && status == SMR_OK && job->n_targets > 1 && i < job->model.n_parts; i++)
        if (job->result[i].target != HOST_NO_TARGET)
            status = set_target(job->state, i, &job->target[job->result[i].target]);
    if (status == SMR_OK)
        status = host_job_set_fixed(job);
    if (job->options->resume != NULL) /* landmark goals are in the save */
        return host_job_resumed(job, status, error);
    if (status == SMR_OK && job->goals != NULL)
        status = host_landmark_goals_set(job->goals, job->options->goal_weight, job->state);
    if (status == SMR_OK && host_volume_ratios_set(job, error) != 0)
        return -1;
    return status == SMR_OK ? 0 : refuse(error, "set up", status);
}

int host_job_begin(host_job *job, host_error *error)
{
    smr_config config = job->options->config;
    smr_status status = SMR_OK;
    uint32_t i = 0;
    config.basic.n_workers = job->port.port.n_workers;
    config.partial.n_landmarks = job->goals != NULL ? job->goals->set.n : 0;
    config.contact.n_fixed = job->contacts.n_fixed;
    config.contact.share = job->options->contact || config.contact.n_fixed > 0 ? 1.0f : 0.0f;
    for (i = 0; !job->options->image_target && i < job->n_targets; i++) /* beside those that come later */
        config.basic.n_target_vertices += job->target[i].users > 0 ? job->target[i].mesh.n_vertices : 0;
    job->course.config = config;
    status = smr_arena_bytes(job->model.model, &config, &job->arena_bytes);
    if (status != SMR_OK)
        return refuse(error, "memory", status);
    job->arena = host_alloc(job->arena_bytes);
    if (job->arena == NULL)
        return refuse(error, "memory", SMR_E_ARENA);
    if (job->options->resume != NULL)
        return host_job_resume(job, &config, error);
    status = smr_init(job->model.model, &config, &job->port.port, job->arena, job->arena_bytes, &job->state);
    return status == SMR_OK ? 0 : refuse(error, "set up", status);
}

static int set_up(host_job *job, host_error *error)
{
    smr_status status = SMR_OK;
    if (host_job_begin(job, error) != 0 || (job->options->log != NULL && host_job_record(job, error) != 0))
        return -1;
    if (job->options->resume != NULL)
        return set_targets(job, error);
    if (job->options->align != HOST_ALIGN_NONE)
        status = smr_set_pose(job->state, &job->pose);
    if (status == SMR_OK && job->start_xyz != NULL)
        status = put_start(job);
    return status == SMR_OK ? set_targets(job, error) : refuse(error, "set up", status);
}

static int record(host_job *job, double seconds, host_error *error)
{
    if (job->ticks == job->tick_capacity) {
        const size_t capacity = job->tick_capacity == 0 ? 512u : 2u * job->tick_capacity;
        float *const grown = realloc(job->tick_ms, capacity * sizeof *grown);
        if (grown == NULL)
            return refuse(error, "memory", SMR_E_ARENA);
        job->tick_ms = grown;
        job->tick_capacity = capacity;
    }
    job->tick_ms[job->ticks++] = (float)(seconds * 1e3);
    job->ticks_s += seconds;
    if (job->options->budget_ms > 0.0 && seconds * 1e3 > job->options->budget_ms)
        job->overruns++;
    return 0;
}

/* Shows the progress on a terminal, in one line that is overwritten. */
static void show(const host_job *job, double elapsed)
{
    const double progress = (double)job->last.progress;
    const double left = progress > 0.0 ? elapsed * (1.0 - progress) / progress : 0.0;
    (void)fprintf(stderr, "\riteration %u  ", job->last.iteration);
    if (job->last.residual_mean_mm >= 0.0f)
        (void)fprintf(stderr, "residual %.3f mm  ", (double)job->last.residual_mean_mm);
    (void)fprintf(stderr, "%.1f s left \033[K", left);
    (void)fflush(stderr);
}

int host_job_run(host_job *job, host_error *error)
{
    /* 0 would mean that no clock is used */
    const uint64_t whole_ns = (uint64_t)(job->options->budget_ms * 1e6);
    const uint64_t budget_ns = job->options->budget_ms > 0.0 && whole_ns == 0u ? 1u : whole_ns;
    const uint32_t limit = job->options->ticks > 0 ? job->options->ticks : TICKS_MAX;
    const int talk = !job->options->quiet && isatty(2);
    const int traced = job->options->trace != NULL;
    const double start = host_seconds();
    double now = start, shown = start;
    smr_status status = SMR_OK;
    const int back = job->options->image_target && job->goals == NULL && job->options->resume == NULL;
    if (set_up(job, error) != 0 || (back && host_job_remember_start(job, error) != 0) ||
        (traced && host_job_trace_begin(job, error) != 0) || host_job_course_begin(job, error) != 0)
        return -1;
    now = host_seconds();
    /* what is saved ends with a complete iteration, be it one tick more */
    while (!job->last.done && !job->last.details.settled &&
           (job->ticks < limit || (job->options->save != NULL && status == SMR_PARTIAL))) {
        const double before = now;
        const uint32_t iteration = job->last.iteration;
        status = smr_tick(job->state, job->ticks < limit ? budget_ns : 0u, &job->last);
        now = host_seconds();
        if (status < 0)
            return refuse(error, "tick", status);
        job->target_seen |= job->last.n_forces > 0 || job->last.details.matched_share > 0.0f;
        if (record(job, now - before, error) != 0)
            return -1;
        if (job->last.iteration != iteration &&
            ((traced && host_job_trace_row(job, error) != 0) || host_job_course_step(job, error) != 0))
            return -1;
        if (talk && now - shown > PROGRESS_EVERY_S) {
            show(job, now - start);
            shown = now;
        }
        now = traced ? host_seconds() : now;
    }
    if (talk && shown > start)
        (void)fputs("\r\033[K", stderr);
    job->register_s = host_seconds() - start - job->trace_s;
    return 0;
}
