/* register_outputs.c: the content of a registration's files: surfaces, carry.bin, log, save, trace; and what its page
 * tells of each iteration.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "carry/carry_result.h"
#include "files/log_file.h"
#include "register/register_job.h"

/* Expected errors across and along of a structure's vertices, beside each other. Unknown where the start was kept, or
 * an iteration is under way. */
static int fill_errors(const host_job *job, uint32_t part, uint32_t n, float *error)
{
    float *const across = malloc((2u * (size_t)n + 1u) * sizeof *across);
    if (across != NULL && !job->kept_start && smr_get_expected_parts(job->state, part, across, across + n) == SMR_OK)
        for (uint32_t i = 0; i < n; i++) {
            error[2u * (size_t)i] = across[i];
            error[2u * (size_t)i + 1u] = across[n + i];
        }
    const int result = across != NULL ? 0 : -1;
    free(across);
    return result;
}

/* Rest and present positions and expected errors, structures in a row. */
static int fill(const host_job *job, host_carry_shape *shape)
{
    size_t at = 0;
    shape->n_vertices = job->model.info.n_vertices;
    shape->n_structures = job->model.n_parts;
    shape->mirror = job->options->mirror_model;
    if (host_carry_allocate(shape) != 0)
        return -1;
    for (uint32_t i = 0; i < job->model.n_parts; at += 3u * (size_t)shape->count[i], i++) {
        (void)snprintf(shape->name[i], SMR_NAME_BYTES, "%s", job->model.part[i].name);
        shape->count[i] = job->model.part[i].mesh.n_vertices;
        if (smr_model_mesh(job->model.model, i, shape->rest + at, NULL) != SMR_OK ||
            smr_get_positions(job->state, i, shape->now + at) != SMR_OK ||
            fill_errors(job, i, shape->count[i], shape->error + at / 3u * 2u) != 0)
            return -1;
        if (job->kept_start) /* what is written is not what was found */
            memcpy(shape->now + at, job->result[i].mesh.xyz, 3u * sizeof(float) * shape->count[i]);
    }
    return 0;
}

void host_job_carry(const host_job *job, host_buffer *out)
{
    host_carry_shape shape = {0};
    if (fill(job, &shape) != 0)
        out->failed = 1;
    else
        host_carry_write(&shape, out);
    host_carry_free(&shape);
}

int host_job_record(host_job *job, host_error *error)
{
    const uint32_t ticks = job->options->ticks;
    const size_t n = ticks > 0 && ticks < HOST_LOG_TICKS_MAX ? ticks : HOST_LOG_TICKS_MAX;
    const size_t bytes = SMR_LOG_BYTES(n, 2u * (size_t)job->model.n_parts + 2u + HOST_LANDMARKS_MAX + SMR_FIXED_MAX);
    error->file = job->options->log;
    job->log_memory = malloc(bytes); /* pages that are never written cost nothing */
    if (job->log_memory == NULL || smr_set_log(job->state, job->log_memory, bytes) != SMR_OK)
        return host_fail(error, "log", "free memory");
    return 0;
}

/* Lists the input files, each once, sorted by name, since threads open them in any order. */
static int list_inputs(const host_job *job, host_log *log, host_error *error)
{
    host_input *list = NULL;
    const int n = host_file_list(job->truth_first, job->truth_end, &list);
    int result = 0;
    log->input = calloc((size_t)(n < 0 ? 0 : n) + 1u, sizeof *log->input);
    if (n < 0 || log->input == NULL)
        result = host_fail(error, "log", "free memory");
    for (int i = 0; result == 0 && i < n; i++)
        result = host_log_measure(list[i].path, &log->input[log->n_inputs++], error);
    free(list);
    return result;
}

int host_job_log(const host_job *job, host_buffer *out, host_error *error)
{
    smr_log_state state;
    host_log log = {0};
    int result = 0;
    error->file = job->options->log;
    if (smr_get_log(job->state, &state) != SMR_OK)
        return host_fail(error, "log", "a registration that was recorded");
    log.log = job->log_memory;
    log.log_bytes = state.bytes;
    log.argument = calloc((size_t)job->options->n_arguments + 1u, sizeof *log.argument);
    if (log.argument == NULL)
        return host_fail(error, "log", "free memory");
    for (int i = 0; i < job->options->n_arguments; i++)
        log.argument[log.n_arguments++] = job->options->arguments[i];
    if (log.n_arguments > HOST_LOG_ARGUMENTS_MAX)
        result = host_fail(error, "log", "at most %u arguments", HOST_LOG_ARGUMENTS_MAX);
    if (result == 0)
        result = list_inputs(job, &log, error);
    if (result == 0)
        host_log_write(&log, out);
    free(log.argument);
    free(log.input);
    return result;
}

static int is_save(const host_head *head, host_error *error)
{
    return head->n >= 4u && memcmp(head->data, "SMRS", 4) == 0
               ? 0
               : host_fail(error, "header", "a file that register --save wrote");
}

static int refuse(host_error *error, smr_status status)
{
    switch (status) {
    case SMR_E_SAVE: return host_fail(error, "content", "an undamaged save of this version");
    case SMR_E_MODEL: return host_fail(error, "model", "--model as it was when this was saved");
    case SMR_E_CONFIG: return host_fail(error, "options", "options and targets as they were when this was saved");
    default: return host_fail(error, "memory", "free memory (%s)", smr_status_name(status));
    }
}

int host_job_resume(host_job *job, const smr_config *config, host_error *error)
{
    host_bytes bytes = {NULL, 0};
    error->file = job->options->resume;
    if (host_file_read(job->options->resume, is_save, &bytes, error) != 0)
        return -1;
    const smr_status status = smr_restore(job->model.model, config, &job->port.port, bytes.data, bytes.size, job->arena,
                                          job->arena_bytes, &job->state);
    host_file_free(&bytes);
    return status == SMR_OK ? 0 : refuse(error, status);
}

int host_job_resumed(host_job *job, smr_status status, host_error *error)
{
    uint32_t n = 0;
    error->file = job->options->resume;
    if (status == SMR_OK)
        status = smr_get_awaited(job->state, &n);
    return status == SMR_OK && n == 0 ? 0 : host_fail(error, "targets", "--target as it was when this was saved");
}

int host_job_save(const host_job *job, host_buffer *out, host_error *error)
{
    size_t bytes = 0;
    error->file = job->options->save;
    if (smr_save_bytes(job->state, &bytes) != SMR_OK || host_buffer_reserve(out, bytes) != 0 ||
        smr_save(job->state, out->data + out->size, bytes) != SMR_OK)
        return host_fail(error, "save", "free memory, and a registration between two iterations");
    out->size += bytes;
    return 0;
}

int host_job_check_format(const host_job *job, host_error *error)
{
    for (uint32_t i = 0; i < job->model.n_parts && job->options->format == HOST_FORMAT_STL; i++)
        if (job->model.part[i].mesh.n_triangles == 0)
            return host_fail_of(error, "--format", "stl", "triangles in each structure, %.100s has points only",
                                job->model.part[i].name);
    return 0;
}

/* How far each vertex is from where it was in the model. */
static int fill_displacement(const host_job *job, uint32_t part, float *displacement)
{
    const host_mesh *const mesh = &job->result[part].mesh;
    if (smr_model_mesh(job->model.model, part, displacement, NULL) != SMR_OK)
        return -1;
    for (size_t i = 0; i < 3u * (size_t)mesh->n_vertices; i++)
        displacement[i] = mesh->xyz[i] - displacement[i];
    return 0;
}

/* What is known of the vertices: error[3]: expected error, across, along. Where the start was kept that is of what was
 * rejected: nothing of these. */
static int fill_known(const host_job *job, uint32_t k, unsigned char *seen, float *const error[3], float *volume)
{
    if (smr_get_visible(job->state, k, seen) != SMR_OK || smr_get_expected_error(job->state, k, error[0]) != SMR_OK ||
        smr_get_expected_parts(job->state, k, error[1], error[2]) != SMR_OK ||
        smr_get_local_volume(job->state, k, 0, volume) != SMR_OK)
        return -1;
    for (uint32_t i = 0; job->kept_start && i < job->result[k].mesh.n_vertices; i++) {
        seen[i] = 0;
        error[0][i] = error[1][i] = error[2][i] = -1.0f;
        volume[i] = 1.0f;
    }
    return 0;
}

static void write_judged(const host_job *job, uint32_t part, host_buffer *buffer)
{
    const host_mesh *const mesh = &job->result[part].mesh;
    const size_t n = mesh->n_vertices + 1u;
    float *const all = malloc(7u * n * sizeof *all);
    unsigned char *const seen = malloc(n);
    if (all != NULL && seen != NULL) {
        float *const error[3] = {all, all + n, all + 2u * n}, *const volume = all + 3u * n, *const moved = all + 4u * n;
        const host_vertex_values values = {seen, error[0], error[1], error[2], moved, volume};
        if (fill_known(job, part, seen, error, volume) != 0 || fill_displacement(job, part, moved) != 0)
            buffer->failed = 1;
        else
            host_mesh_write_judged(mesh, (int)job->options->format, &values, buffer);
    } else {
        buffer->failed = 1;
    }
    free(all);
    free(seen);
}

void host_job_surface(const host_job *job, uint32_t part, host_buffer *buffer)
{
    if (job->options->vertex_errors)
        write_judged(job, part, buffer);
    else
        host_mesh_write(&job->result[part].mesh, (int)job->options->format, buffer);
}

#define FIRST_STEPS 256u

int host_job_course_begin(host_job *job, host_error *error)
{
    return job->options->html ? host_job_positions(job, &job->course.before_xyz, error) : 0;
}

int host_job_course_step(host_job *job, host_error *error)
{
    host_course *const course = &job->course;
    const smr_tick_report *const last = &job->last;
    if (!job->options->html)
        return 0;
    if (course->n == course->capacity) {
        const size_t capacity = course->capacity == 0 ? FIRST_STEPS : 2u * course->capacity;
        host_step *const grown = realloc(course->step, capacity * sizeof *grown);
        error->file = "register";
        if (grown == NULL)
            return host_fail(error, "memory", "room for what the iterations did");
        course->step = grown;
        course->capacity = capacity;
    }
    course->step[course->n++] = (host_step){last->iteration, (double)job->model.info.radius_mm[last->details.radius],
                                            last->residual_mean_mm, last->displacement_max_mm};
    return 0;
}

void host_course_free(host_course *course)
{
    free(course->before_xyz);
    free(course->step);
}

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
    size_t n = 0;
    *mean = *max = 0.0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const host_mesh *const mesh = &job->result[i].mesh;
        for (size_t k = 0; k < mesh->n_vertices; k++) {
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
    const host_stats *const whole = &job->area.to_target, *const from = &job->area.to_result;
    const host_stats *const to = job->options->image_target ? whole : &job->overlap;
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
    put(out, whole->n + from->n > 0, fmax(whole->max, from->max));
    put(out, job->by_vertex.n > 0, job->by_vertex.mean);
    put(out, verdict.image_similarity > -1.0f, (double)verdict.image_similarity);
    put(out, 1, (double)verdict.strain);
    put(out, moves, mean);
    put(out, moves, max);
    put(out, moves, last->details.n_taken);
    put(out, moves, last->n_forces);
    put(out, moves && last->residual_mean_mm >= 0.0f, (double)last->residual_mean_mm);
    put(out, 1, last->details.plastic_updates);
    put(out, 1, (double)job->folds.n);
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
    job->trace_xyz = calloc(3u * (size_t)job->model.info.n_vertices + 1u, sizeof *job->trace_xyz);
    if (job->trace_xyz == NULL)
        return host_fail(error, "trace", "free memory");
    host_buffer_print(&job->trace,
                      "iteration,radius_mm,time_ms,mean_to_mm,mean_from_mm,hausdorff_mm,vertex_mm,likeness,strain_"
                      "share,moved_mean_mm,moved_max_mm,active,forces,residual_mm,reference_updates,folds\n");
    return host_job_trace_row(job, error);
}
