/* register_report.c: writes report.json and the summary for people.
 * SPDX-License-Identifier: MIT */
#include "report/register_report.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report/json_write.h"

/* [SMR_WARP_...] */
static const char *const warp_names[] = {"spline", "similarity", "rigid", "translation"};

/* Share of vertices with a goal among those that searched one. NaN when none searched. */
static double share_of(uint32_t found, uint32_t rejected)
{
    const double all = (double)found + (double)rejected;
    return all > 0.0 ? (double)found / all : (double)NAN;
}

/* The same for the last iteration, over all structures. */
static double matched_share(const host_job *job) { return share_of(job->last.n_forces, job->last.n_rejected); }

/* Writes the kind of start. */
static void put_kind(const host_job *job, host_json *json)
{
    static const char *const poses[] = {"none", "surfaces rigid", "surfaces similarity"};
    char text[40];
    if (job->n_landmarks > 0)
        (void)snprintf(text, sizeof text, "landmarks %s", warp_names[job->warp_kind]);
    else
        (void)snprintf(text, sizeof text, "%s", poses[job->options->align]);
    host_json_text(json, "start_kind", text);
}

static void put_model(const host_job *job, host_json *json)
{
    const smr_model_info *const info = &job->model.info;
    double stored = 0.0, direct = 0.0;
    uint32_t i = 0;
    for (i = 0; i < info->n_radii; i++) {
        stored += (double)info->indexes_per_cluster[i] / info->n_radii;
        direct += (double)info->direct_per_cluster[i] / info->n_radii;
    }
    host_json_count(json, "structures", info->n_structures);
    host_json_count(json, "vertices", info->n_vertices);
    host_json_count(json, "triangles", info->n_triangles);
    host_json_count(json, "clusters", info->n_vertices); /* one per vertex, at every radius */
    host_json_number(json, "indexes_per_cluster", stored);
    host_json_number(json, "indexes_per_cluster_direct", direct);
    host_json_open(json, "radius_mm", '[');
    for (i = 0; i < info->n_radii; i++)
        host_json_number(json, NULL, (double)info->radius_mm[i]);
    host_json_close(json, ']');
    host_json_open(json, "radii", '[');
    for (i = 0; i < info->n_radii; i++) {
        host_json_open(json, NULL, '{');
        host_json_number(json, "radius_mm", (double)info->radius_mm[i]);
        host_json_number(json, "indexes_per_cluster", (double)info->indexes_per_cluster[i]);
        host_json_number(json, "indexes_per_cluster_direct", (double)info->direct_per_cluster[i]);
        host_json_flag(json, "separate", info->separate[i] != 0);
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
}

static int by_value(const void *a, const void *b)
{
    const float *const x = a, *const y = b;
    return (*x > *y) - (*x < *y);
}

static void put_times(const host_job *job, host_json *json)
{
    const size_t n = job->ticks;
    float *const ms = malloc((n + 1u) * sizeof *ms);
    host_json_open(json, "time_s", '{');
    host_json_number(json, "load", job->load_s);
    host_json_number(json, "prepare", job->model_is_prepared ? 0.0 : job->model.prepare_s);
    host_json_number(json, "start", job->start_s);
    host_json_number(json, "register", job->register_s);
    host_json_number(json, "measure", job->measure_s);
    host_json_number(json, "total", host_seconds() - job->begin_s);
    host_json_close(json, '}');
    if (ms == NULL || n == 0) {
        host_json_null(json, "tick_ms");
    } else {
        memcpy(ms, job->tick_ms, n * sizeof *ms);
        qsort(ms, n, sizeof *ms, by_value);
        host_json_open(json, "tick_ms", '{');
        host_json_number(json, "min", (double)ms[0]);
        host_json_number(json, "median", (double)ms[n / 2u]);
        host_json_number(json, "p99", (double)ms[(n * 99u + 99u) / 100u - 1u]);
        host_json_number(json, "max", (double)ms[n - 1u]);
        host_json_close(json, '}');
    }
    free(ms);
    host_json_number(json, "budget_ms", job->options->budget_ms);
    host_json_count(json, "overruns", job->overruns);
    host_json_open(json, "memory_bytes", '{');
    host_json_count(json, "model", job->model.prepared_bytes);
    host_json_count(json, "arena", job->arena_bytes);
    host_json_count(json, "volume", job->image.bytes);
    host_json_close(json, '}');
}

/* Writes the distances in both directions, null when they were not measured. */
static void put_distances(host_json *json, int measured, const host_stats *to_target, const host_stats *to_model)
{
    if (!measured) {
        host_json_null(json, "distance_mm");
        return;
    }
    host_json_open(json, "distance_mm", '{');
    host_json_stats(json, "model_to_target", to_target);
    host_json_stats(json, "target_to_model", to_model);
    host_json_close(json, '}');
}

static void put_by_vertex(host_json *json, const host_stats *stats)
{
    if (stats->n == 0) {
        host_json_null(json, "vertex_to_vertex_mm");
        return;
    }
    host_json_open(json, "vertex_to_vertex_mm", '{');
    host_json_number(json, "mean", stats->mean);
    host_json_number(json, "max", stats->max);
    host_json_close(json, '}');
}

/* Writes values of the last iteration's goals, and the displacement from the start positions. */
static void put_moved(host_json *json, double residual_mean, double residual_max, double moved_mean, double moved_max)
{
    host_json_number(json, "residual_mean_mm", residual_mean);
    host_json_number(json, "residual_max_mm", residual_max);
    host_json_number(json, "moved_mean_mm", moved_mean);
    host_json_number(json, "moved_max_mm", moved_max);
}

/* Writes the result against the targets, or against the truth when the target is an image. */
static void put_result(const host_job *job, host_json *json)
{
    const int measured = job->n_targets > 0;
    const double a = job->to_target.max, b = job->to_result.max;
    double mean = 0.0, max = 0.0, n = 0.0;
    uint32_t i = 0;
    for (i = 0; i < job->model.n_parts; i++) {
        const double vertices = (double)job->result[i].mesh.n_vertices,
                     most = (double)job->result[i].report.moved_max_mm;
        mean += (double)job->result[i].report.moved_mean_mm * vertices;
        n += vertices;
        max = most > max ? most : max;
    }
    put_distances(json, measured, &job->to_target, &job->to_result);
    if (measured)
        host_json_number(json, "hausdorff_mm", a > b ? a : b);
    else
        host_json_null(json, "hausdorff_mm");
    if (measured && job->options->image_target) {
        host_json_open(json, "truth", '{');
        host_json_text(json, "directory", job->options->truth);
        host_json_count(json, "vertices_compared", job->by_vertex.n);
        put_by_vertex(json, &job->by_vertex);
        host_json_close(json, '}');
    }
    host_json_number(json, "matched_share", matched_share(job));
    put_moved(json, (double)job->last.residual_mean_mm, (double)job->last.residual_max_mm, mean / n, max);
    host_json_count(json, "folds", job->folds);
    host_json_count(json, "folds_absolute", job->folds_absolute);
}

static void put_structure(const host_job *job, uint32_t i, host_json *json)
{
    const host_result *const result = &job->result[i];
    const int image = job->options->image_target, carried = !image && result->target == HOST_NO_TARGET;
    host_json_open(json, NULL, '{');
    host_json_text(json, "name", job->model.part[i].name);
    host_json_count(json, "vertices", result->mesh.n_vertices);
    host_json_count(json, "triangles", result->mesh.n_triangles);
    host_json_flag(json, "has_target", !carried);
    host_json_flag(json, "carried", carried);
    if (carried)
        host_json_null(json, "target");
    else
        host_json_text(json, "target", image ? job->options->target.path[0] : job->target[result->target].path);
    put_distances(json, result->target != HOST_NO_TARGET || !image, &result->to_target, &result->to_result);
    if (result->target != HOST_NO_TARGET && image) {
        host_json_open(json, "truth", '{');
        host_json_text(json, "file", job->target[result->target].path);
        put_by_vertex(json, &result->by_vertex);
        host_json_close(json, '}');
    }
    host_json_number(json, "matched_share", share_of(result->report.n_forces, result->report.n_rejected));
    put_moved(json, (double)result->report.residual_mean_mm, (double)result->report.residual_max_mm,
              (double)result->report.moved_mean_mm, (double)result->report.moved_max_mm);
    host_json_count(json, "folds", result->folds);
    host_json_count(json, "folds_absolute", result->folds_absolute);
    host_json_close(json, '}');
}

static void put_start(const host_job *job, host_json *json)
{
    static const char *const names[] = {"none", "rigid", "similarity"};
    int r = 0, c = 0;
    put_kind(job, json);
    host_json_text(json, "align", names[job->options->align]);
    if (job->n_landmarks > 0) {
        host_json_open(json, "landmarks", '{');
        host_json_count(json, "count", job->n_landmarks);
        host_json_text(json, "fit", warp_names[job->warp_kind]);
        host_json_close(json, '}');
    } else {
        host_json_null(json, "landmarks");
    }
    if (job->options->align == HOST_ALIGN_NONE) {
        host_json_null(json, "start_pose");
        return;
    }
    host_json_number(json, "start_rms_mm", (double)job->align_rms_mm);
    host_json_open(json, "start_pose", '[');
    for (r = 0; r < 3; r++)
        for (c = 0; c < 4; c++)
            host_json_number(json, NULL, (double)job->pose.m[r][c]);
    host_json_close(json, ']');
}

static const char *similarity_name(uint32_t similarity)
{
    switch (similarity) {
    case SMR_SIMILARITY_NCC: return "ncc";
    case SMR_SIMILARITY_SSD: return "ssd";
    default: return "concordance";
    }
}

void host_job_report(const host_job *job, host_buffer *out)
{
    host_json json = {out, 0, 1};
    char text[40];
    uint32_t i = 0;
    host_json_open(&json, NULL, '{');
    (void)snprintf(text, sizeof text, "%d.%d.%d", SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH);
    host_json_text(&json, "version", text);
    put_model(job, &json);
    host_json_count(&json, "ticks", job->ticks);
    host_json_count(&json, "iterations", job->last.iteration);
    /* converged: the schedule has ended and some vertex had a goal, as in the exit status.
     * settled: in addition, the last iteration moved no vertex by more than the plastic threshold. */
    host_json_flag(&json, "converged", host_job_converged(job));
    host_json_flag(&json, "target_seen", job->target_seen);
    host_json_flag(&json, "settled", job->last.converged != 0 && job->target_seen);
    host_json_number(&json, "displacement_max_mm", (double)job->last.displacement_max_mm);
    host_json_count(&json, "threads", job->port.port.n_workers);
    host_json_text(&json, "method", job->options->config.method == SMR_METHOD_POLAR ? "polar" : "rigid");
    if (job->options->image_target)
        host_json_text(&json, "similarity", similarity_name(job->options->config.similarity));
    else
        host_json_null(&json, "similarity");
    put_start(job, &json);
    put_times(job, &json);
    put_result(job, &json);
    (void)snprintf(text, sizeof text, "%016" PRIx64, smr_state_hash(job->state));
    host_json_text(&json, "state_hash", text);
    host_json_open(&json, "per_structure", '[');
    for (i = 0; i < job->model.n_parts; i++)
        put_structure(job, i, &json);
    host_json_close(&json, ']');
    host_json_open(&json, "targets_unused", '[');
    for (i = 0; i < job->n_targets; i++)
        if (job->target[i].users == 0)
            host_json_text(&json, NULL, job->target[i].path);
    host_json_close(&json, ']');
    host_json_close(&json, '}');
}

/* Says when nothing was seen, or only part could be, and why. */
static void summarise_unseen(const host_job *job)
{
    const int with_reference = job->options->image_target && job->options->reference != NULL;
    const int unseen = job->last.iteration > 0 && !job->target_seen;
    if (unseen && with_reference && !(job->covered > 0.0))
        (void)printf("nothing of the target was seen: none of the model's vertices lies in the reference image %s\n",
                     job->options->reference);
    else if (unseen)
        (void)printf("nothing of the target was seen: no vertex had a goal in any iteration; look at the start and at "
                     "--search\n");
    if (with_reference && job->covered > 0.0 && job->covered < 1.0)
        (void)printf("vertices of the model in the reference image: %.1f %%\n", 100.0 * job->covered);
}

void host_job_summary(const host_job *job)
{
    const host_stats *const a = &job->to_target, *const b = &job->to_result;
    const char *const name = job->options->image_target ? "truth" : "target";
    smr_log_state log;
    uint32_t i = 0, carried = 0;
    (void)printf("%s after %u iterations, %.3f s (load %.3f, prepare %.3f, start %.3f, register %.3f), %u threads\n",
                 host_job_converged(job) ? "converged" : "not converged", job->last.iteration,
                 host_seconds() - job->begin_s, job->load_s, job->model_is_prepared ? 0.0 : job->model.prepare_s,
                 job->start_s, job->register_s, job->port.port.n_workers);
    summarise_unseen(job);
    if (job->n_landmarks > 0 && job->warp_kind != SMR_WARP_SPLINE && job->options->align == HOST_ALIGN_NONE)
        (void)printf("start: %u landmarks as they lie carry no spline, a %s fit instead\n", job->n_landmarks,
                     warp_names[job->warp_kind]);
    if (job->n_targets > 0) {
        (void)printf("model to %s: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n", name, a->mean, a->rms, a->p95,
                     a->max);
        (void)printf("%s to model: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n", name, b->mean, b->rms, b->p95,
                     b->max);
    }
    if (job->by_vertex.n > 0)
        (void)printf("vertex to vertex: mean %.3f  max %.3f mm\n", job->by_vertex.mean, job->by_vertex.max);
    if (job->options->image_target)
        (void)printf("vertices with a goal in the image: %.1f %%\n",
                     job->last.n_active > 0 ? 100.0 * matched_share(job) : 0.0);
    (void)printf("folds: %" PRIu64 "  state hash: %016" PRIx64 "\n", job->folds, smr_state_hash(job->state));
    for (i = 0; i < job->model.n_parts; i++)
        if (!job->options->image_target && job->result[i].target == HOST_NO_TARGET)
            (void)printf("%s%s", carried++ == 0 ? "carried along without a target: " : ", ", job->model.part[i].name);
    if (carried > 0)
        (void)putchar('\n');
    for (i = 0; i < job->n_targets; i++)
        if (job->target[i].users == 0)
            (void)printf("not used, no structure has its name: %s\n", job->target[i].path);
    if (job->options->log != NULL && smr_get_log(job->state, &log) == SMR_OK)
        (void)printf("log: %s, %u ticks%s\n", job->options->log, log.n_ticks, log.full ? ", then it was full" : "");
    (void)printf("results: %s\n", job->options->out);
}
