/* register_run.c: prepares the model, starts and runs the registration; frees a job.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "register/register_job.h"

static uint32_t part_of(const host_job *job, const char *word, size_t n)
{
    uint32_t i = 0;
    while (i < job->model.n_parts &&
           (strlen(job->model.part[i].name) != n || strncmp(job->model.part[i].name, word, n) != 0))
        i++;
    return i;
}

/* Asks the registration for them. 0, or -1 with the error filled: no such structure, or one that encloses no volume. */
static int host_volume_ratios_set(const host_job *job, host_error *error)
{
    const host_files *const w = &job->options->volume_ratio;
    for (uint32_t i = 0; i < w->n; i++) {
        size_t name = 0;
        double ratio = 0.0;
        error->file = "--volume-ratio";
        if (!host_volume_ratio_split(w->path[i], &name, &ratio) || part_of(job, w->path[i], name) == job->model.n_parts)
            return host_fail(error, w->path[i], "the name of a structure of the model");
        if (smr_set_volume_ratio(job->state, part_of(job, w->path[i], name), (float)ratio) != SMR_OK)
            return host_fail(error, w->path[i], "a structure that is closed: each edge has two triangles");
    }
    error->file = NULL;
    return 0;
}

#define PROGRESS_EVERY_S 0.1
#define TICKS_MAX 10000000u /* with a budget, an iteration may take many ticks */

static int refuse(host_error *error, const char *place, smr_status status)
{
    return host_fail_of(error, "register", place, "%s (%s)",
                        status == SMR_E_ARENA ? "free memory" : "input and options within the library's limits",
                        smr_status_name(status));
}

smr_status host_job_put_start(const host_job *job) { return smr_set_positions(job->state, SMR_ALL, job->start_xyz); }

static smr_status set_target(smr *s, uint32_t part, const host_target *target)
{
    return target->points != NULL ? smr_set_points(s, part, target->points) : smr_set_surface(s, part, target->surface);
}

static int set_targets(host_job *job, host_error *error)
{
    smr_status status = SMR_OK;
    if (job->options->image_target)
        status = smr_set_volume(job->state, &job->image.view);
    else if (job->n_targets == 1)
        status = set_target(job->state, SMR_ALL, &job->target[0]);
    for (uint32_t i = 0;
         !job->options->image_target && status == SMR_OK && job->n_targets > 1 && i < job->model.n_parts; i++)
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
    config.basic.n_workers = job->port.port.n_workers;
    config.partial.n_landmarks = job->goals != NULL ? job->goals->set.n : 0;
    config.contact.n_fixed = job->contacts.n_fixed;
    config.contact.share = job->options->contact || config.contact.n_fixed > 0 ? 1.0f : 0.0f;
    for (uint32_t i = 0; !job->options->image_target && i < job->n_targets; i++) /* beside those that come later */
        config.basic.n_target_vertices += job->target[i].users > 0 ? job->target[i].mesh.n_vertices : 0;
    job->course.config = config;
    smr_status status = smr_arena_bytes(job->model.model, &config, &job->arena_bytes);
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
        status = host_job_put_start(job);
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
    if (set_up(job, error) != 0 || (back && host_job_positions(job, &job->begun_xyz, error) != 0) ||
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

/* Two independent tasks: preparing the model, and placing the model on the targets. */
typedef struct both {
    host_job *job;
    host_error error[2];
    int failed[2];
} both;

static int prepare(host_job *job, host_error *error)
{
    smr_prepare_config config = job->options->prepare;
    if (job->options->reference != NULL)
        config.reference = &job->reference.view;
    config.port = &job->port.port;
    int result = host_model_prepare(&job->model, &config, error);
    host_image_free(&job->reference);
    return result;
}

static void run_half(void *arg, uint32_t task, uint32_t worker)
{
    both *const b = arg;
    (void)worker;
    if (task == 1)
        b->failed[1] = host_job_start(b->job, &b->error[1]);
    else if (!b->job->model_is_prepared)
        b->failed[0] = prepare(b->job, &b->error[0]);
}

int host_job_prepare(host_job *job, host_error *error)
{
    both b = {0};
    b.job = job;
    if (job->options->align != HOST_ALIGN_NONE) {
        host_parallel(&job->port.port, run_half, &b, 2);
    } else { /* nearly all time is preparation: all workers share it */
        b.failed[0] = job->model_is_prepared ? 0 : prepare(job, &b.error[0]);
        b.failed[1] = b.failed[0] ? 0 : host_job_start(job, &b.error[1]);
    }
    if (b.failed[0] || b.failed[1]) {
        *error = b.failed[0] ? b.error[0] : b.error[1];
        return -1;
    }
    return host_job_warp(job, error);
}

void host_job_free(host_job *job)
{
    for (uint32_t i = 0; job->result != NULL && i < job->model.n_parts; i++) {
        host_mesh_free(&job->result[i].mesh);
        host_result_moves(&job->result[i]);
    }
    for (uint32_t i = 0; i < job->n_targets; i++) {
        host_mesh_free(&job->target[i].mesh);
        free(job->target[i].memory);
    }
    free(job->result);
    free(job->target);
    free(job->tick_ms);
    free(job->trace_xyz);
    free(job->begun_xyz);
    host_course_free(&job->course);
    host_contacts_free(&job->contacts);
    host_buffer_free(&job->trace);
    free(job->arena);
    free(job->log_memory);
    free(job->start_xyz);
    free(job->part);
    free(job->warp_memory);
    free(job->goals);
    free(job->truth_paths);
    if (job->truth_map != NULL)
        host_label_map_free(job->truth_map);
    free(job->truth_map);
    host_image_free(&job->reference);
    host_image_free(&job->image);
    host_model_free(&job->model);
    host_port_close(&job->port);
}
