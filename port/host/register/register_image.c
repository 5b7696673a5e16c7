/* register_image.c: an image as the target: its volumes, landmarks, and the truth as surfaces or as a label map.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "labels/label_surfaces.h"
#include "labels/surface_set.h"
#include "register/register_job.h"

#define FEW_LANDMARKS 6u /* fewer landmarks do not tell whether they carry a spline */
/* Errors of left-out landmarks by a freer fit over those by a stiffer one, below which the freer one is used. */
#define SPLINE_LESS 0.75    /* a spline, by a pose */
#define SIMILARITY_LESS 0.9 /* a similarity, by a rigid pose */

/* Names the structures that nothing is measured of, in one line. */
static void tell_missing(const host_job *job)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        if (job->result[i].target == HOST_NO_TARGET && job->model.part[i].mesh.n_triangles > 0)
            (void)fprintf(stderr, "%s%s", n++ == 0 ? "smr: --truth: no label is named like " : ", ",
                          job->model.part[i].name);
    if (n > 0)
        (void)fprintf(stderr, "\n");
}

/* The surfaces become the targets of the structures with their names, each of one. */
static int take_surfaces(host_job *job, host_label_surface *surface, host_error *error)
{
    job->target = calloc(job->model.n_parts, sizeof *job->target);
    if (job->target == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const host_label *const label = host_label_find_like(job->truth_map, job->model.part[i].name);
        host_target *const target = &job->target[job->n_targets];
        if (label == NULL || job->model.part[i].mesh.n_triangles == 0 ||
            surface[label - job->truth_map->label].mesh.n_triangles == 0)
            continue;
        target->path = job->options->truth;
        target->mesh = surface[label - job->truth_map->label].mesh;
        memset(&surface[label - job->truth_map->label].mesh, 0, sizeof target->mesh);
        memcpy(target->name, label->name, sizeof target->name);
        target->users = 1;
        target->user = i;
        job->result[i].target = job->n_targets++;
    }
    if (job->n_targets == 0)
        return host_fail(error, "names", "a label with the name of one of the model's structures");
    tell_missing(job);
    return 0;
}

static int load_truth_map(host_job *job, host_error *error)
{
    host_label_surface *to = NULL;
    uint32_t n = 0;
    int result = -1;
    error->file = job->options->truth;
    job->truth_map = calloc(1, sizeof *job->truth_map);
    if (job->truth_map == NULL)
        return host_fail(error, "start", "free memory");
    job->truth_first = host_file_count();
    if (host_label_map_read(job->options->truth, NULL, job->truth_map, error) == 0) {
        if (job->options->mirror_target != HOST_MIRROR_NONE)
            host_volume_mirror(&job->truth_map->grid, job->options->mirror_target);
        n = job->truth_map->n_labels;
        to = calloc(n, sizeof *to);
        if (to == NULL)
            (void)host_fail(error, "start", "free memory");
        else if (host_label_surfaces_make(&job->port.port, job->truth_map, HOST_SMOOTHING_PASSES, 0, to, error) == 0)
            result = take_surfaces(job, to, error);
    }
    job->truth_end = host_file_count();
    host_label_surfaces_free(to, n);
    return result;
}

/* Voxels of a box that have a label. */
static uint64_t count_both(const host_label_map *map, uint32_t label, const host_filled *filled)
{
    const uint16_t *const index = map->index + map->label[label].layer * host_label_voxels(map);
    const size_t n = (size_t)filled->size[0] * filled->size[1] * filled->size[2];
    uint64_t both = 0;
    for (size_t i = 0; i < n; i++)
        both += filled->inside[i] && index[host_filled_voxel(filled, i, &map->grid)] == label + 1u;
    return both;
}

/* Tasks of one parallel loop: the overlap of a structure. An open surface has none. */
static void measure_overlap(void *arg, uint32_t task, uint32_t worker)
{
    host_job *const job = arg;
    const host_label_map *const map = job->truth_map;
    const double mm3 = fabs(host_label_mm3(&map->grid));
    const host_label *const label = host_label_find_like(map, job->model.part[task].name);
    host_result *const result = &job->result[task];
    host_filled filled = {0};
    host_error error = {0};
    (void)worker;
    result->dice = -1.0;
    if (result->target == HOST_NO_TARGET || host_open_edges(&result->mesh) != 0)
        return;
    if (host_surface_fill(&result->mesh, &map->grid, &filled, &error) == 0) {
        const uint64_t both = count_both(map, (uint32_t)(label - map->label), &filled);
        result->dice = 2.0 * (double)both / (double)(filled.voxels + label->voxels);
        result->label_mm3[0] = (double)filled.voxels * mm3;
        result->label_mm3[1] = (double)label->voxels * mm3;
    }
    host_filled_free(&filled);
}

void host_job_measure_labels(host_job *job)
{
    if (job->truth_map != NULL)
        host_parallel(&job->port.port, measure_overlap, job, job->model.n_parts);
}

/* Reads the reference or the target image: two tasks. */
typedef struct volumes {
    host_job *job;
    host_error error[2];
    int failed[2];
} volumes;

static void read_volume(void *arg, uint32_t task, uint32_t worker)
{
    volumes *const v = arg;
    const host_options *const options = v->job->options;
    (void)worker;
    if (task == 1)
        v->failed[1] = host_image_read(options->target.path[0], options->mirror_target, &v->job->image, &v->error[1]);
    else if (options->reference != NULL)
        v->failed[0] = host_image_read(options->reference, options->mirror_model, &v->job->reference, &v->error[0]);
}

int host_job_load_images(host_job *job, host_error *error)
{
    volumes v = {0};
    if (job->model_is_prepared && job->model.info.profile_samples == 0)
        return host_fail_of(error, job->options->model.path[0], "profiles",
                            "a model built with --reference, for the target is a volume");
    v.job = job;
    host_parallel(&job->port.port, read_volume, &v, 2);
    if (!v.failed[0] && !v.failed[1])
        return 0;
    *error = v.failed[0] ? v.error[0] : v.error[1];
    return -1;
}

/* Makes the path "DIR/NAME.ply" of every structure; the job owns the texts. */
static int name_truth(host_job *job, host_error *error)
{
    const char *const directory = job->options->truth;
    const size_t bytes = strlen(directory) + SMR_NAME_BYTES + 8u;
    job->target = calloc(job->model.n_parts, sizeof *job->target);
    job->truth_paths = malloc(bytes * job->model.n_parts);
    if (job->target == NULL || job->truth_paths == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        char *const path = job->truth_paths + bytes * i;
        (void)snprintf(path, bytes, "%s/%s.ply", directory, job->model.part[i].name);
        job->target[i].path = path;
    }
    return 0;
}

/* The error is printed after the job and its paths are freed: it names the directory, and the file in its place. */
static void blame_truth(const host_job *job, host_error *error)
{
    const char *const slash = error->file != NULL ? strrchr(error->file, '/') : NULL;
    char place[sizeof error->place];
    (void)snprintf(place, sizeof place, "%.40s: %.50s", slash != NULL ? slash + 1 : "--truth", error->place);
    memcpy(error->place, place, sizeof place);
    error->file = job->options->truth;
}

/* A file for each structure, in a directory. */
static int load_truths(host_job *job, host_error *error)
{
    const uint32_t n = job->model.n_parts;
    host_load *loads = calloc(n, sizeof *loads);
    if (loads == NULL)
        return host_fail(error, "start", "free memory");
    job->truth_first = host_file_count();
    int result = name_truth(job, error);
    for (uint32_t i = 0; result == 0 && i < n; i++) {
        loads[i] =
            (host_load){.path = job->target[i].path,
                        .need = job->model.part[i].mesh.n_triangles > 0 ? HOST_MESH_SURFACE : HOST_MESH_POINTS_TOO,
                        .mirror = job->options->mirror_target};
    }
    if (result == 0)
        result = host_load_all(&job->port.port, loads, n, error);
    job->truth_end = host_file_count();
    for (uint32_t i = 0; result == 0 && i < n; i++) {
        host_target *const target = &job->target[i];
        target->mesh = loads[i].mesh;
        memcpy(target->name, job->model.part[i].name, sizeof target->name);
        target->users = job->model.part[i].mesh.n_triangles > 0; /* of points only places are compared */
        target->user = i;
        job->result[i].target = i;
        job->n_targets = i + 1u;
    }
    if (result != 0)
        blame_truth(job, error);
    free(loads);
    return result;
}

int host_job_load_truth(host_job *job, host_error *error)
{
    const double start = host_seconds();
    int result = 0;
    error->file = "--truth";
    if (job->options->truth == NULL)
        return 0;
    result = host_is_volume_path(job->options->truth) ? load_truth_map(job, error) : load_truths(job, error);
    job->measure_s += host_seconds() - start;
    return result;
}

/* Says what is wrong with pairs of these labels, and how much a spline through them scales the model. */
static void doubt_pairs(host_job *job, const host_landmarks *set, const float *from, const float *to)
{
    const host_landmark_doubt doubt = host_landmarks_agree(from, to, job->n_landmarks);
    char *const out = job->landmark_doubt;
    const size_t bytes = sizeof job->landmark_doubt;
    if (doubt.kind == HOST_LANDMARKS_SWAPPED)
        (void)snprintf(out, bytes, "landmarks \"%s\" and \"%s\" fit far better exchanged: look at their labels",
                       set->label[doubt.first], set->label[doubt.second]);
    else if (doubt.kind == HOST_LANDMARK_OFF)
        (void)snprintf(out, bytes, "landmark \"%s\" is %.0f mm from where the others put it: look at its place",
                       set->label[doubt.first], doubt.off_mm);
    else if (doubt.kind == HOST_LANDMARKS_APART)
        (void)snprintf(out, bytes, "the landmarks do not fit by %.0f mm: look whether both sets are of the same places",
                       doubt.off_mm);
    if (job->options->align != HOST_ALIGN_RIGID)
        job->start_scale = doubt.scale;
}

static smr_status start_of(const host_job *job, uint32_t part, float *xyz, uint32_t n)
{
    const smr_pose *const p = job->part != NULL ? &job->part[part].pose : NULL;
    if (p == NULL)
        return smr_warp_apply(job->warp, xyz, n);
    for (float *at = xyz; at < xyz + 3u * (size_t)n; at += 3) {
        const float x = at[0], y = at[1], z = at[2];
        for (uint32_t r = 0; r < 3; r++)
            at[r] = p->m[r][0] * x + p->m[r][1] * y + p->m[r][2] * z + p->m[r][3];
    }
    return SMR_OK;
}

/* Applies the warp, or the poses of parts, to all rest positions. They are read from the prepared model, which rounds
 * them, so that a .smr and the surfaces it was built from give the same bits. */
int host_job_warp(host_job *job, host_error *error)
{
    float *xyz = NULL;
    if (job->warp == NULL && job->part == NULL)
        return host_job_bend(job, error);
    error->file = job->options->landmarks.n > 0 ? job->options->landmarks.path[0]
                  : job->part != NULL           ? "--align"
                                                : "landmarks";
    job->start_xyz = xyz = malloc(3u * sizeof *xyz * job->model.info.n_vertices);
    if (xyz == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const uint32_t n = job->model.part[i].mesh.n_vertices;
        const size_t count = 3u * (size_t)n;
        if (smr_model_mesh(job->model.model, i, xyz, NULL) != SMR_OK || start_of(job, i, xyz, n) != SMR_OK)
            return host_fail_at(error, "structure", i, "a model that the landmarks' warp can carry");
        for (size_t k = 0; k < count; k++)
            if (!(xyz[k] >= -SMR_COORD_MAX && xyz[k] <= SMR_COORD_MAX)) /* written so that NaN fails */
                return host_fail_at(error, "structure", i, "landmarks that keep the model within +-%.0f mm",
                                    (double)SMR_COORD_MAX);
        xyz += count;
    }
    return 0;
}

/* Fits a pose by least squares, when --align asks for one instead of the spline. */
static int pose_by_pairs(host_job *job, const float *from, const float *to, host_error *error)
{
    const int similarity = job->options->align == HOST_ALIGN_SIMILARITY;
    const smr_status code =
        smr_align_landmarks(from, to, job->n_landmarks, (uint32_t)similarity, &job->pose, &job->align_rms_mm);
    job->warp_kind = similarity ? SMR_WARP_SCALED : SMR_WARP_RIGID;
    job->posed = code == SMR_OK;
    return code == SMR_OK ? 0 : host_fail(error, "landmarks", "a set that can be fitted (%s)", smr_status_name(code));
}

static int warp_by_pairs(host_job *job, const float *from, const float *to, host_error *error)
{
    size_t bytes = 0;
    smr_status code = smr_warp_bytes(job->n_landmarks, &bytes);
    if (code == SMR_OK && (job->warp_memory = host_alloc(bytes)) == NULL)
        return host_fail(error, "landmarks", "free memory");
    if (code == SMR_OK)
        code = smr_warp_fit(from, to, job->n_landmarks, job->options->smoothing, job->warp_memory, bytes, &job->warp,
                            &job->warp_kind);
    if (code == SMR_OK && !job->posed && (job->warp_kind == SMR_WARP_SCALED || job->warp_kind == SMR_WARP_RIGID))
        job->posed = smr_align_landmarks(from, to, job->n_landmarks, job->warp_kind == SMR_WARP_SCALED, &job->pose,
                                         &job->align_rms_mm) == SMR_OK;
    return code == SMR_OK ? 0 : host_fail(error, "landmarks", "a set that can be fitted (%s)", smr_status_name(code));
}

int host_job_place_pairs(host_job *job, const float *from, const float *to, host_error *error)
{
    return job->options->align != HOST_ALIGN_NONE ? pose_by_pairs(job, from, to, error)
                                                  : warp_by_pairs(job, from, to, error);
}

/* Moves a landmark by a pose. */
static void move(const smr_pose *pose, const float *p, float *moved)
{
    for (uint32_t k = 0; k < 3u; k++)
        moved[k] = pose->m[k][0] * p[0] + pose->m[k][1] * p[1] + pose->m[k][2] * p[2] + pose->m[k][3];
}

/* Adds the squared distances of landmark `out` from where a fit of each kind, SMR_WARP_..., to the others puts it. */
static int add_left_out(const host_job *job, const float *from, const float *to, uint32_t out, void *memory,
                        size_t bytes, double sum[3])
{
    float others[2][HOST_LANDMARKS_MAX][3], moved[3][3];
    uint32_t n = 0, spline = 0;
    smr_warp *warp = NULL;
    smr_pose pose[2];
    for (uint32_t i = 0; i < job->n_landmarks; i++)
        if (i != out) {
            memcpy(others[0][n], from + 3u * i, sizeof others[0][n]);
            memcpy(others[1][n++], to + 3u * i, sizeof others[1][n]);
        }
    memcpy(moved[SMR_WARP_SPLINE], from + 3u * out, sizeof moved[0]);
    if (smr_warp_fit(others[0][0], others[1][0], n, job->options->smoothing, memory, bytes, &warp, &spline) != SMR_OK ||
        smr_warp_apply(warp, moved[SMR_WARP_SPLINE], 1) != SMR_OK ||
        smr_align_landmarks(others[0][0], others[1][0], n, 1, &pose[0], NULL) != SMR_OK ||
        smr_align_landmarks(others[0][0], others[1][0], n, 0, &pose[1], NULL) != SMR_OK)
        return -1;
    move(&pose[0], from + 3u * out, moved[SMR_WARP_SCALED]);
    move(&pose[1], from + 3u * out, moved[SMR_WARP_RIGID]);
    for (uint32_t kind = 0; kind < 3u; kind++)
        for (uint32_t k = 0; k < 3u; k++)
            sum[kind] += pow((double)moved[kind][k] - (double)to[3u * out + k], 2.0);
    return 0;
}

/* Returns the kind of start that landmarks carry: a similarity instead of a rigid pose, or a spline instead of either,
 * only where it foretells landmarks that are left out clearly better (leave-one-out cross-validation). Otherwise it
 * would follow the landmarks' errors. */
static uint32_t carried_kind(const host_job *job, const float *from, const float *to)
{
    const uint32_t step = 1u + job->n_landmarks / 64u;
    size_t bytes = 0;
    double sum[3] = {0};
    if (job->n_landmarks < FEW_LANDMARKS || smr_warp_bytes(job->n_landmarks, &bytes) != SMR_OK)
        return SMR_WARP_SPLINE;
    void *const memory = host_alloc(bytes);
    int result = memory == NULL ? -1 : 0;
    for (uint32_t i = 0; result == 0 && i < job->n_landmarks; i += step)
        result = add_left_out(job, from, to, i, memory, bytes, sum);
    free(memory);
    const uint32_t pose =
        sqrt(sum[SMR_WARP_SCALED]) < SIMILARITY_LESS * sqrt(sum[SMR_WARP_RIGID]) ? SMR_WARP_SCALED : SMR_WARP_RIGID;
    return result != 0 || sqrt(sum[SMR_WARP_SPLINE]) < SPLINE_LESS * sqrt(sum[pose]) ? SMR_WARP_SPLINE : pose;
}

/* Gives the landmarks the goals of their best pose, so that the spline through them is that pose. */
static void pose_goals(host_job *job, uint32_t kind, const float *from, float *to)
{
    job->posed = smr_align_landmarks(from, to, job->n_landmarks, kind == SMR_WARP_SCALED, &job->pose,
                                     &job->align_rms_mm) == SMR_OK;
    for (uint32_t i = 0; job->posed && i < job->n_landmarks; i++)
        move(&job->pose, from + 3u * i, to + 3u * i);
}

int host_job_place(host_job *job, host_error *error)
{
    const host_options *const options = job->options;
    float from[HOST_LANDMARKS_MAX][3], to[HOST_LANDMARKS_MAX][3];
    host_landmarks *const set = calloc(1, sizeof *set);
    error->file = "--landmarks";
    if (set == NULL)
        return host_fail(error, "start", "free memory");
    int result = host_landmark_pairs_read(options, &options->landmarks, set, from, to, &job->n_landmarks, error);
    if (result == 0)
        doubt_pairs(job, set, from[0], to[0]);
    free(set);
    if (result != 0)
        return -1;
    error->file = options->landmarks.path[0];
    const int choose = options->spline_if_better && options->align == HOST_ALIGN_NONE;
    const uint32_t kind = choose ? carried_kind(job, from[0], to[0]) : SMR_WARP_SPLINE;
    if (kind != SMR_WARP_SPLINE)
        pose_goals(job, kind, from[0], to[0]);
    result = host_job_place_pairs(job, from[0], to[0], error);
    if (kind > job->warp_kind)
        job->warp_kind = kind;
    return result;
}

int host_job_place_by_goals(host_job *job, host_error *error)
{
    job->n_landmarks = job->goals->set.n;
    doubt_pairs(job, &job->goals->set, job->goals->from[0], job->goals->to[0]);
    error->file = job->options->landmark_goals.path[0];
    return host_job_place_pairs(job, job->goals->from[0], job->goals->to[0], error);
}
