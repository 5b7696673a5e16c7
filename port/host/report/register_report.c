/* register_report.c: writes report.json.
 * SPDX-License-Identifier: MIT */
#include "report/register_report.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *host_warp_name(uint32_t kind)
{
    static const char *const names[] = {"spline", "similarity", "rigid", "translation"}; /* [SMR_WARP_...] */
    return names[kind];
}

/* A figure of the library, in which -1 says that it was not measured: NaN then, which is written as null. */
static double measured(float figure) { return figure < 0.0f ? (double)NAN : (double)figure; }

/* Writes the kind of start. */
static void put_kind(const host_job *job, host_json *json)
{
    static const char *const poses[] = {"none", "surfaces rigid", "surfaces similarity", "surfaces parts"};
    char text[40];
    if (job->n_landmarks > 0)
        (void)snprintf(text, sizeof text, "landmarks %s", host_warp_name(job->warp_kind));
    else
        (void)snprintf(text, sizeof text, "%s", poses[job->options->align]);
    host_json_text(json, "start_kind", text);
}

static void put_model(const host_job *job, host_json *json)
{
    const smr_model_info *const info = &job->model.info;
    double stored = 0.0, direct = 0.0;
    for (uint32_t i = 0; i < info->n_radii; i++) {
        stored += (double)info->indexes_per_cluster[i] / info->n_radii;
        direct += (double)info->direct_per_cluster[i] / info->n_radii;
    }
    char text[16];
    (void)snprintf(text, sizeof text, "%08" PRIx32, info->checksum);
    host_json_text(json, "model_checksum", text);
    host_json_count(json, "structures", info->n_structures);
    host_json_count(json, "vertices", info->n_vertices);
    host_json_count(json, "triangles", info->n_triangles);
    host_json_count(json, "clusters", info->n_vertices); /* one per vertex, at every radius */
    host_json_number(json, "indexes_per_cluster", stored);
    host_json_number(json, "indexes_per_cluster_direct", direct);
    host_json_list(json, "radius_mm", info->radius_mm, info->n_radii);
    host_json_open(json, "radii", '[');
    for (uint32_t i = 0; i < info->n_radii; i++) {
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

/* Writes the distances in both directions, null when they were not measured. shown: those of what of the model the
 * target shows; NULL: all of it, for the target is a truth. */
static void put_distances(host_json *json, const char *key, int compared, const host_two_way *distances,
                          const host_stats *shown)
{
    if (!host_json_object(json, key, compared))
        return;
    host_json_stats(json, "model_to_target", shown != NULL ? shown : &distances->to_target);
    host_json_stats(json, "whole_model_to_target", &distances->to_target);
    host_json_stats(json, "target_to_model", &distances->to_result);
    host_json_close(json, '}');
}

/* Writes the distances of what of the model the target shows, and the share of its area that is left out. */
static void put_overlap(host_json *json, int compared, const host_stats *all, const host_stats *overlap)
{
    if (!host_json_object(json, "overlap_distance_mm", compared && all->n > 0))
        return;
    host_json_stats(json, "model_to_target", overlap);
    host_json_number(json, "surplus", all->weight > 0.0 ? fmax(0.0, 1.0 - overlap->weight / all->weight) : 0.0);
    host_json_close(json, '}');
}

static void put_by_vertex(host_json *json, const host_stats *stats)
{
    if (!host_json_object(json, "vertex_to_vertex_mm", stats->n > 0))
        return;
    host_json_number(json, "mean", stats->mean);
    host_json_number(json, "max", stats->max);
    host_json_close(json, '}');
}

/* Writes values of the last iteration's goals, and the displacement from the start positions. */
static void put_moved(host_json *json, float residual_mean, float residual_max, double moved_mean, double moved_max)
{
    host_json_number(json, "residual_mean_mm", measured(residual_mean));
    host_json_number(json, "residual_max_mm", measured(residual_max));
    host_json_number(json, "moved_mean_mm", moved_mean);
    host_json_number(json, "moved_max_mm", moved_max);
}

static void put_folds(const host_folds *folds, host_json *json)
{
    host_json_count(json, "folds", folds->n);
    host_json_count(json, "folds_absolute", folds->all);
    host_json_number(json, "folds_deepest_mm", folds->deepest_mm);
}

/* Writes the result against the targets, or against the truth when the target is an image. */
static void put_result(const host_job *job, host_json *json)
{
    const int compared = job->n_targets > 0;
    const double a = job->area.to_target.max, b = job->area.to_result.max;
    double mean = 0.0, max = 0.0, n = 0.0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const double count = (double)job->result[i].mesh.n_vertices, most = (double)job->result[i].report.moved_max_mm;
        mean += (double)job->result[i].report.moved_mean_mm * count;
        n += count;
        max = most > max ? most : max;
    }
    put_distances(json, "distance_mm", compared, &job->area, job->options->image_target ? NULL : &job->overlap);
    put_overlap(json, compared && !job->options->image_target, &job->area.to_target, &job->overlap);
    put_distances(json, "vertex_distance_mm", compared, &job->vertices,
                  job->options->image_target ? NULL : &job->overlap_vertices);
    if (compared && job->area.to_target.n > 0) /* nothing is measured from the model to points */
        host_json_number(json, "hausdorff_mm", a > b ? a : b);
    else
        host_json_null(json, "hausdorff_mm");
    if (compared && job->options->image_target) {
        host_json_open(json, "truth", '{');
        host_json_text(json, "directory", job->options->truth);
        host_json_count(json, "vertices_compared", job->by_vertex.n);
        put_by_vertex(json, &job->by_vertex);
        host_json_close(json, '}');
    }
    host_json_number(json, "matched_share", measured(job->last.details.matched_share));
    put_moved(json, job->last.residual_mean_mm, job->last.details.residual_max_mm, mean / n, max);
    put_folds(&job->folds, json);
}

static void put_verdict(const host_verdict *verdict, host_json *json)
{
    host_json_text(json, "verdict", host_verdict_name(verdict->level));
    host_json_open(json, "reasons", '[');
    for (uint32_t i = 0; i < verdict->n_reasons; i++)
        host_json_text(json, NULL, verdict->reason[i]);
    host_json_close(json, ']');
    host_json_number(json, "probability", verdict->probability);
    host_json_number(json, "expected_error_mm", verdict->expected_error_mm);
}

/* What the verdict rests on; nothing where an iteration is under way. */
static void put_measures(const smr_verdict *v, host_json *json)
{
    const struct {
        const char *name;
        float value;
    } measures[] = {{"expected_error_mm", v->expected_error_mm},
                    {"expected_across_mm", v->expected_across_mm},
                    {"expected_along_mm", v->expected_along_mm},
                    {"expected_seen_mm", v->expected_visible_mm},
                    {"seen_share", v->visible_share},
                    {"target_covered", v->target_covered},
                    {"other_share", v->other_share},
                    {"residual_mm", v->residual_mm},
                    {"normals_agree", v->normals_agree},
                    {"likeness", v->image_similarity},
                    {"goals_share", v->goals_share},
                    {"strain", v->strain},
                    {"stretch", v->stretch},
                    {"volume_ratio", v->volume_ratio},
                    {"rotation_deg", v->rotation_deg},
                    {"turned_deg", v->turned_deg},
                    {"bend_mm", v->bend_mm},
                    {"scale", v->scale},
                    {"scale_rest", v->scale_rest},
                    {"subjects_ratio", v->subjects_ratio},
                    {"moved_last_mm", v->moved_last_mm}};
    host_json_open(json, "verdict_measures", '{');
    for (size_t i = 0; i < sizeof measures / sizeof measures[0]; i++)
        host_json_number(json, measures[i].name, (double)measures[i].value);
    host_json_close(json, '}');
}

static void put_structure(const host_job *job, uint32_t i, host_json *json)
{
    const host_result *const result = &job->result[i];
    const int image = job->options->image_target, carried = host_job_carries(job, i);
    const int compared = result->target != HOST_NO_TARGET || !image;
    host_json_open(json, NULL, '{');
    host_json_text(json, "name", job->model.part[i].name);
    host_json_count(json, "vertices", result->mesh.n_vertices);
    host_json_count(json, "triangles", result->mesh.n_triangles);
    host_json_flag(json, "has_target", !carried);
    host_json_flag(json, "carried", carried);
    put_verdict(&result->verdict, json);
    if (carried || (!image && result->target == HOST_NO_TARGET))
        host_json_null(json, "target");
    else
        host_json_text(json, "target", image ? job->options->target.path[0] : job->target[result->target].path);
    put_distances(json, "distance_mm", compared, &result->area, image ? NULL : &result->overlap);
    put_overlap(json, !image && !carried, &result->area.to_target, &result->overlap);
    put_distances(json, "vertex_distance_mm", compared, &result->vertices, image ? NULL : &result->overlap_vertices);
    if (result->target != HOST_NO_TARGET && image) {
        host_json_open(json, "truth", '{');
        host_json_text(json, "file", job->target[result->target].path);
        put_by_vertex(json, &result->by_vertex);
        host_report_labels(job, i, json);
        host_json_close(json, '}');
    }
    host_json_number(json, "matched_share", measured(result->report.matched_share));
    put_moved(json, result->report.residual_mean_mm, result->report.residual_max_mm,
              (double)result->report.moved_mean_mm, (double)result->report.moved_max_mm);
    put_folds(&result->folds, json);
    host_report_volume(job, i, json);
    host_json_number(json, "local_volume_least", (double)result->local_volume[0]);
    host_json_number(json, "local_volume_most", (double)result->local_volume[1]);
    host_json_close(json, '}');
}

/* What aligning the surfaces said: "start". */
static void put_align(const smr_align_report *said, host_json *json)
{
    if (!host_json_object(json, "start", said->n_alike > 0))
        return;
    host_json_flag(json, "given", said->given != 0);
    host_json_number(json, "rms_mm", (double)said->rms_mm);
    host_json_number(json, "model_share", (double)said->model_share);
    host_json_number(json, "target_share", (double)said->target_share);
    host_json_number(json, "scale", (double)said->scale);
    host_json_count(json, "alike", said->n_alike);
    host_json_number(json, "second_rms_mm", (double)said->second_rms_mm);
    host_json_number(json, "mirrored_rms_mm", (double)said->mirrored_rms_mm);
    host_json_flag(json, "model_inside_out", said->model_inside_out != 0);
    host_json_flag(json, "target_inside_out", said->target_inside_out != 0);
    host_json_close(json, '}');
}

/* How far points ended from their places. */
static void put_landmark_goals(const host_job *job, host_json *json)
{
    const host_landmark_goals *const g = job->goals;
    if (!host_json_object(json, "landmark_goals", g != NULL))
        return;
    host_json_count(json, "count", g->set.n);
    host_json_flag(json, "hard", !(job->options->goal_weight > 0.0f));
    host_json_number(json, "weight", (double)job->options->goal_weight);
    host_json_number(json, "residual_mean_mm", g->mean);
    host_json_number(json, "residual_max_mm", g->max);
    host_json_open(json, "points", '[');
    for (uint32_t i = 0; i < g->set.n; i++) {
        host_json_open(json, NULL, '{');
        host_json_text(json, "label", g->set.label[i]);
        host_json_number(json, "residual_mm", g->residual[i]);
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
    host_json_close(json, '}');
}

static void put_start(const host_job *job, host_json *json)
{
    static const char *const names[] = {"none", "rigid", "similarity", "parts"};
    put_kind(job, json);
    put_align(&job->align_report, json);
    host_json_text(json, "align", names[job->options->align]);
    if (job->n_landmarks > 0) {
        host_json_open(json, "landmarks", '{');
        host_json_count(json, "count", job->n_landmarks);
        host_json_text(json, "fit", host_warp_name(job->warp_kind));
        host_json_close(json, '}');
    } else {
        host_json_null(json, "landmarks");
    }
    host_json_number(json, "start_rms_mm", job->posed ? (double)job->align_rms_mm : (double)NAN);
    if (job->posed)
        host_json_list(json, "start_pose", job->pose.m[0], 12);
    else
        host_json_null(json, "start_pose");
}

static const char *similarity_name(uint32_t similarity)
{
    switch (similarity) {
    case SMR_SIMILARITY_NCC: return "ncc";
    case SMR_SIMILARITY_SSD: return "ssd";
    default: return "concordance";
    }
}

void host_job_report(const host_job *job, int exit_status, const host_output *output, host_buffer *out)
{
    host_json json = {out, 0, 1, 0};
    char text[40];
    float weights[SMR_REFERENCES_MAX];
    uint32_t n_references = 0;
    host_json_open(&json, NULL, '{');
    (void)snprintf(text, sizeof text, "%d.%d.%d", SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH);
    host_json_text(&json, "version", text);
    put_verdict(&job->verdict, &json);
    host_json_count(&json, "exit_status", (uint64_t)exit_status);
    put_measures(&job->measures, &json);
    host_report_command(job->options, &json);
    host_report_inputs(&json);
    host_report_results(output, &json);
    put_model(job, &json);
    host_json_count(&json, "ticks", job->ticks);
    host_json_count(&json, "iterations", job->last.iteration);
    /* converged: the schedule has ended and some vertex had a goal, as in the exit status.
     * settled: in addition, the last iteration moved no vertex by more than the plastic threshold. */
    host_json_flag(&json, "converged", host_job_converged(job));
    host_json_flag(&json, "target_seen", job->target_seen);
    host_json_flag(&json, "settled", job->last.converged != 0 && job->target_seen);
    host_json_flag(&json, "start_kept", job->kept_start); /* the surfaces are where they began */
    host_json_number(&json, "displacement_max_mm", (double)job->last.displacement_max_mm);
    host_json_count(&json, "threads", job->port.port.n_workers);
    host_json_text(&json, "method", job->options->config.basic.method == SMR_METHOD_POLAR ? "polar" : "rigid");
    if (job->options->image_target)
        host_json_text(&json, "similarity", similarity_name(job->options->config.image.similarity));
    else
        host_json_null(&json, "similarity");
    put_start(job, &json);
    put_landmark_goals(job, &json);
    if (smr_get_reference_weights(job->state, weights, &n_references) == SMR_OK && n_references > 1)
        host_json_list(&json, "reference_weights", weights, n_references);
    put_times(job, &json);
    put_result(job, &json);
    (void)snprintf(text, sizeof text, "%016" PRIx64, smr_state_hash(job->state));
    host_json_text(&json, "state_hash", text);
    host_json_open(&json, "per_structure", '[');
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        put_structure(job, i, &json);
    host_json_close(&json, ']');
    host_json_open(&json, "targets_unused", '[');
    for (uint32_t i = 0; i < job->n_targets; i++)
        if (job->target[i].users == 0)
            host_json_text(&json, NULL, job->target[i].path);
    host_json_close(&json, ']');
    host_report_contact(job, &json);
    host_json_close(&json, '}');
}
