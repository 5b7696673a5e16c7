/* register_start.c: starts a registration: reads all files, pairs targets and structures, finds the start pose.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "register/register_job.h"

static uint32_t n_surfaces(const host_options *options) { return options->image_target ? 0 : options->target.n; }

static int take_targets(host_job *job, host_load *loads, host_error *error)
{
    const uint32_t n = n_surfaces(job->options);
    job->target = calloc(n + 1u, sizeof *job->target);
    if (job->target == NULL)
        return host_fail(error, "start", "free memory");
    job->n_targets = n;
    for (uint32_t i = 0; i < n; i++) {
        host_target *const target = &job->target[i];
        target->path = loads[i].path;
        target->mesh = loads[i].mesh;
        memset(&loads[i].mesh, 0, sizeof loads[i].mesh);
        host_warn_inside_out(target->path, &target->mesh);
        error->file = target->path;
        /* several targets are found by their names */
        if (host_base_name(target->path, target->name, sizeof target->name) >= sizeof target->name && n > 1)
            return host_fail(error, "name", "a file name of at most %u bytes before its extension",
                             SMR_NAME_BYTES - 1u);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(job->target[k].name, target->name) == 0)
                return host_fail(error, "name", "targets with names that differ, '%s' is there twice", target->name);
    }
    return 0;
}

/* Reads model and target files in one parallel loop, so that all threads are used. */
static int load_surfaces(host_job *job, const host_files *models, host_error *error)
{
    const host_options *const options = job->options;
    const uint32_t n = models->n + n_surfaces(options);
    host_load *const loads = calloc(n + 1u, sizeof *loads);
    if (loads == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < n; i++) {
        const int of_model = i < models->n;
        loads[i] = (host_load){.path = of_model ? models->path[i] : options->target.path[i - models->n],
                               .need = of_model ? HOST_MESH_POINTS_TOO : HOST_MESH_CLOUD,
                               .mirror = of_model ? options->mirror_model
                                                  : options->mirror_target}; /* the model's points are carried */
    }
    int result = host_load_all(&job->port.port, loads, n, error);
    if (result == 0 && models->n > 0)
        result = host_model_take(loads, models->n, &job->model, error);
    if (result == 0 && !options->image_target)
        result = take_targets(job, loads + models->n, error);
    for (uint32_t i = 0; i < n; i++) /* meshes that were not taken over */
        host_mesh_free(&loads[i].mesh);
    free(loads);
    return result;
}

int host_job_load(host_job *job, host_error *error)
{
    const host_options *const options = job->options;
    const host_files none = {NULL, 0};
    const double start = host_seconds();
    int result = 0;
    for (uint32_t i = 0; i < options->model.n; i++)
        job->model_is_prepared |= host_model_is_prepared(options->model.path[i]);
    if (!job->model_is_prepared && options->image_target && options->reference == NULL) {
        error->file = "--reference";
        result = host_fail(error, "option", "the image that fits the model's surfaces, for the target is a volume");
    } else if (!job->model_is_prepared) {
        result = load_surfaces(job, &options->model, error);
    } else if (options->model.n > 1) {
        error->file = "--model";
        result = host_fail(error, "files", "surfaces, or one .smr alone");
    } else {
        result = host_model_open_prepared(options->model.path[0], options, &job->model, error);
        if (result == 0)
            result = load_surfaces(job, &none, error);
    }
    if (result == 0 && options->image_target)
        result = host_job_load_images(job, error);
    if (result == 0)
        result = host_job_load_fixed(job, error);
    job->load_s = host_seconds() - start;
    return result;
}

/* Prints a line on stderr where the option says what the library does not do. */
static void warn_of_cloud(const host_job *job)
{
    host_error error = {.file = "--attraction"};
    uint32_t clouds = 0;
    for (uint32_t i = 0; i < job->n_targets; i++)
        clouds += job->target[i].mesh.n_triangles == 0;
    if (job->options->config.basic.attraction > 0.0f || clouds == 0 || job->options->image_target)
        return;
    (void)host_fail(&error, "option", "a target surface, for a cloud of points always attracts");
    host_error_print(&error);
}

static int check_sizes(host_job *job, host_error *error)
{
    const host_options *const options = job->options;
    /* these scale the model */
    const int scaled = options->landmarks.n > 0 || options->align == HOST_ALIGN_SIMILARITY;
    host_box box = {0};
    if (options->image_target && options->reference != NULL) {
        error->file = options->reference;
        if (host_check_image_size(&job->model, &job->reference.view, error) != 0)
            return -1;
        job->covered = host_share_covered(&job->model, &job->reference.view);
    }
    error->file = options->target.path[0];
    if (scaled || options->target.n == 0)
        return 0;
    if (options->image_target)
        return host_check_image_size(&job->model, &job->image.view, error);
    for (uint32_t i = 0; i < job->n_targets; i++)
        host_box_add(&box, job->target[i].mesh.xyz, job->target[i].mesh.n_vertices);
    job->size_ratio = host_size_ratio(&job->model, &box);
    return host_check_target_size(&job->model, &box, error);
}

int host_job_check(host_job *job, host_error *error)
{
    if (check_sizes(job, error) != 0)
        return -1;
    host_warn_small(job->options->model.path[0], &job->model);
    warn_of_cloud(job);
    return 0;
}

int host_job_match(host_job *job, host_error *error)
{
    uint32_t matched = 0;
    error->file = "--target";
    job->result = calloc(job->model.n_parts, sizeof *job->result);
    if (job->result == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        job->result[i].target = HOST_NO_TARGET;
    if (job->options->target.n == 0) /* landmark goals alone */
        return 0;
    if (job->options->image_target) /* the truth, if any, has one surface for each structure */
        return host_job_load_truth(job, error);
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        if (job->model.part[i].mesh.n_triangles == 0)
            continue;
        for (uint32_t k = 0; k < job->n_targets && job->result[i].target == HOST_NO_TARGET; k++)
            if (job->n_targets == 1 || strcmp(job->target[k].name, job->model.part[i].name) == 0) {
                job->result[i].target = k;
                job->target[k].users++;
                job->target[k].user = i;
            }
        matched += job->result[i].target != HOST_NO_TARGET;
    }
    return matched > 0 ? 0 : host_fail(error, "names", "several targets to be named like the model's structures");
}

static void build_target(void *arg, uint32_t task, uint32_t worker)
{
    host_target *const target = (host_target *)arg + task;
    const smr_mesh view = host_mesh_view(&target->mesh);
    (void)worker;
    if (target->memory != NULL)
        return; /* it stands already */
    if (target->users > 0 && target->mesh.n_triangles == 0)
        target->points = host_points_make(&target->mesh, &target->memory);
    else if (target->users > 0)
        target->surface = host_surface_make(&view, &target->memory);
}

/* Joins the meshes of all targets in use, or of all structures that have a target. */
static int join(const host_job *job, int targets, host_mesh *whole)
{
    int result = 0;
    memset(whole, 0, sizeof *whole);
    for (uint32_t i = 0; targets && result == 0 && i < job->n_targets; i++)
        if (job->target[i].users > 0)
            result = host_mesh_append(whole, &job->target[i].mesh);
    for (uint32_t i = 0; !targets && result == 0 && i < job->model.n_parts; i++)
        if (job->result[i].target != HOST_NO_TARGET)
            result = host_mesh_append(whole, &job->model.part[i].mesh);
    return result;
}

static const smr_surface *surface_of(const host_mesh *mesh, void **memory)
{
    const smr_mesh view = host_mesh_view(mesh);
    return mesh->n_triangles == 0 ? host_points_surface(mesh, memory) : host_surface_make(&view, memory);
}

/* Surfaces that are aligned: model and target as wholes; with --align parts also those of structures and targets. */
typedef struct aligned {
    const smr_surface *whole[2];
    smr_align_part *part; /* [n_parts] of structures with triangles */
    uint32_t *index;      /* [n_parts] their structures */
    void **memory;        /* [n_memory], owned */
    uint32_t n_parts, n_memory;
} aligned;

static void free_aligned(aligned *a)
{
    for (uint32_t i = 0; i < a->n_memory; i++)
        free(a->memory[i]);
    free(a->memory);
    free(a->part);
    free(a->index);
}

/* Makes the surfaces of structures, whose targets stand already, or are clouds. 0, or -1 without memory. */
static int make_parts(const host_job *job, aligned *a)
{
    const uint32_t n = job->model.n_parts;
    const smr_surface **const cloud = calloc(job->n_targets + 1u, sizeof *cloud);
    int result = cloud == NULL ? -1 : 0;
    for (uint32_t k = 0; result == 0 && k < job->n_targets; k++)
        if (job->target[k].points != NULL &&
            (cloud[k] = surface_of(&job->target[k].mesh, &a->memory[a->n_memory++])) == NULL)
            result = -1;
    for (uint32_t i = 0; result == 0 && i < n; i++) {
        const uint32_t k = job->result[i].target;
        smr_align_part *const part = &a->part[a->n_parts];
        if (job->model.part[i].mesh.n_triangles == 0)
            continue;
        part->target = k == HOST_NO_TARGET ? NULL : job->target[k].points != NULL ? cloud[k] : job->target[k].surface;
        part->model = surface_of(&job->model.part[i].mesh, &a->memory[a->n_memory++]);
        a->index[a->n_parts++] = i;
        result = part->model == NULL ? -1 : 0;
    }
    free((void *)cloud);
    return result;
}

/* Keeps the poses of all structures; those without triangles have the whole's. */
static int keep_parts(host_job *job, const aligned *a)
{
    job->part = calloc(job->model.n_parts, sizeof *job->part);
    if (job->part == NULL)
        return -1;
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        job->part[i].pose = job->pose;
    for (uint32_t i = 0; i < a->n_parts; i++) {
        smr_align_part *const part = &job->part[a->index[i]];
        *part = a->part[i];
        part->model = part->target = NULL;
        if (part->order == 1u) /* the whole's report is of a model that is not rigid */
            job->align_report = part->report;
    }
    return 0;
}

static smr_status align_surfaces(host_job *job, const aligned *a)
{
    smr_align_config config = smr_align_config_default();
    size_t bytes = 0;
    config.scaled = job->options->align == HOST_ALIGN_SIMILARITY;
    config.port = &job->port.port;
    config.n_parts = a->n_parts;
    config.part = a->n_parts > 0 ? a->part : NULL;
    smr_status status = smr_align_bytes(&config, &bytes);
    void *scratch = host_alloc(bytes);
    if (scratch == NULL)
        return SMR_E_ARENA;
    if (status == SMR_OK)
        status = smr_align(a->whole[0], a->whole[1], &config, scratch, bytes, &job->pose, &job->align_report);
    if (status == SMR_OK && a->n_parts > 0 && keep_parts(job, a) != 0)
        status = SMR_E_ARENA;
    job->align_rms_mm = job->align_report.rms_mm;
    job->posed = status == SMR_OK;
    free(scratch);
    return status;
}

typedef struct wholes {
    const host_job *job;
    aligned *a;
} wholes;

/* Makes the surface of the model or of all targets. A single target has one. */
static void make_whole(void *arg, uint32_t task, uint32_t worker)
{
    const wholes *const w = arg;
    host_mesh mesh;
    (void)worker;
    if (task == 1 && w->job->n_targets == 1 && w->job->target[0].surface != NULL) {
        w->a->whole[1] = w->job->target[0].surface;
        return;
    }
    if (join(w->job, (int)task, &mesh) == 0)
        w->a->whole[task] = surface_of(&mesh, &w->a->memory[task]);
    host_mesh_free(&mesh);
}

static int align(host_job *job, host_error *error)
{
    const uint32_t n = job->model.n_parts;
    aligned a = {.part = calloc(n, sizeof *a.part),
                 .index = calloc(n, sizeof *a.index),
                 .memory = calloc(n + job->n_targets + 2u, sizeof *a.memory)};
    smr_status status = SMR_E_ARENA;
    if (a.memory != NULL) {
        host_parallel(&job->port.port, make_whole, &(wholes){job, &a}, 2);
        a.n_memory = 2;
    }
    if (a.whole[0] != NULL && a.whole[1] != NULL && a.part != NULL && a.index != NULL &&
        (job->options->align != HOST_ALIGN_PARTS || make_parts(job, &a) == 0))
        status = align_surfaces(job, &a);
    free_aligned(&a);
    error->file = "--align";
    if (status == SMR_OK)
        return 0;
    return host_fail(error, "start pose", "%s (%s)",
                     status == SMR_E_ARENA ? "free memory" : "surfaces that can be aligned", smr_status_name(status));
}

int host_job_make_surfaces(host_job *job, host_error *error)
{
    host_parallel(&job->port.port, build_target, job->target, job->n_targets);
    for (uint32_t i = 0; i < job->n_targets; i++)
        if (job->target[i].users > 0 && job->target[i].surface == NULL && job->target[i].points == NULL)
            return host_fail_of(error, job->target[i].path, "surface",
                                "a surface within the library's limits and free memory for it");
    return 0;
}

static double squared(float x) { return (double)x * (double)x; }

int host_job_start(host_job *job, host_error *error)
{
    const double start = host_seconds();
    int result = job->options->image_target ? 0 : host_job_make_surfaces(job, error);
    if (result == 0 && job->options->landmark_goals.n > 0)
        result = (job->goals = host_landmark_goals_read(job->options, error)) == NULL ? -1 : 0;
    if (result == 0 && job->options->landmarks.n > 0)
        result = host_job_place(job, error);
    else if (result == 0 && job->options->start_by_goals && job->options->align != HOST_ALIGN_NONE)
        result = host_job_place_by_goals(job, error);
    else if (result == 0 && job->options->align != HOST_ALIGN_NONE)
        result = align(job, error);
    if (result == 0 && job->options->align == HOST_ALIGN_SIMILARITY)
        job->start_scale = sqrt(squared(job->pose.m[0][0]) + squared(job->pose.m[1][0]) + squared(job->pose.m[2][0]));
    job->start_s = host_seconds() - start;
    return result;
}
