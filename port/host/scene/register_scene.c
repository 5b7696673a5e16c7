/* register_scene.c: a registration's results as a scene of 3D Slicer.
 * SPDX-License-Identifier: MIT */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "scene/mrml_scene.h"

#define FIELD_NAME "field.nrrd"
#define MISSED_SHARE 0.01  /* of the field, mostly in its margin: less is not told */
#define SHOWN_ERROR_MM 3.0 /* where the colours of expected errors end */
#define TARGET_OPACITY 0.35f
#define NAME_ROOM (SMR_NAME_BYTES + 16u)

typedef struct making {
    const host_job *job;
    host_output *output;
    host_carried carried;
    host_scene scene;
    host_buffer text;
} making;

static const float places_color[3] = {0.1f, 0.8f, 0.2f}, carried_color[3] = {1.0f, 0.3f, 0.1f},
                   target_color[3] = {0.85f, 0.85f, 0.85f}, fixed_color[3] = {0.45f, 0.5f, 0.6f};

static void tell_left_out(const host_job *job, const char *file, const char *why)
{
    if (!job->options->quiet)
        (void)fprintf(stderr, "smr: %s: left out of the scene: %s\n", file, why);
}

/* Packed files are read by nobody but us; NIfTI's are an exception. */
static int slicer_reads(const char *path, const char *const *extensions, size_t n)
{
    size_t i = 0;
    if (host_is_packed_name(path) && !host_has_extension(path, ".nii"))
        return 0;
    while (i < n && !host_has_extension(path, extensions[i]))
        i++;
    return i < n;
}

static int add_field(making *m, host_error *error)
{
    host_buffer file = {0};
    char *const path = host_path_in(m->job->options->out, FIELD_NAME);
    double share = 0.0;
    int result = path == NULL ? host_fail(error, "output", "free memory") : 0;
    error->file = FIELD_NAME;
    if (result == 0 && host_scene_field_write(&m->carried, &file, &share, error) < 0)
        result = -1;
    if (result == 0)
        result = host_output_add(m->output, FIELD_NAME, &file, error);
    if (result == 0)
        host_scene_field(&m->scene, "model to patient", path);
    if (result == 0 && share > MISSED_SHARE && !m->job->options->quiet)
        (void)fprintf(stderr, "smr: in %.0f %% of %s the way back was not found\n", 100.0 * share, path);
    host_buffer_free(&file);
    free(path);
    return result;
}

static void add_volume(making *m, const char *file, int moved)
{
    static const char *const extensions[] = {".nrrd", ".nhdr", ".mha", ".mhd", ".nii"};
    char base[256], name[300];
    if (!slicer_reads(file, extensions, sizeof extensions / sizeof extensions[0])) {
        tell_left_out(m->job, file, "Slicer does not read it");
        return;
    }
    (void)host_base_name(file, base, sizeof base);
    (void)snprintf(name, sizeof name, "%s%s", base, moved ? " (deformed)" : "");
    host_scene_volume(&m->scene, name, file, moved);
}

/* The patient's volume first: it is the one that is shown. */
static void add_volumes(making *m)
{
    const host_options *const options = m->job->options;
    if (options->image_target && options->mirror_target != HOST_MIRROR_NONE)
        tell_left_out(m->job, options->target.path[0], "the results are mirrored");
    else if (options->image_target)
        add_volume(m, options->target.path[0], 0);
    if (options->reference != NULL)
        add_volume(m, options->reference, 1);
}

/* Twelve colours, then the same paler, then darker: 36 that differ. Dark lines are hard to see in slices. */
static void color_of(uint32_t i, float color[3])
{
    static const float colors[][3] = {{0.90f, 0.80f, 0.60f}, {0.85f, 0.35f, 0.30f}, {0.40f, 0.65f, 0.85f},
                                      {0.55f, 0.75f, 0.40f}, {0.80f, 0.55f, 0.80f}, {0.95f, 0.65f, 0.30f},
                                      {0.35f, 0.75f, 0.70f}, {0.75f, 0.45f, 0.45f}, {0.60f, 0.60f, 0.90f},
                                      {0.85f, 0.80f, 0.35f}, {0.95f, 0.60f, 0.70f}, {0.55f, 0.50f, 0.40f}};
    const uint32_t n = sizeof colors / sizeof colors[0], round = i / n % 3u;
    for (uint32_t k = 0; k < 3u; k++) {
        const float c = colors[i % n][k];
        color[k] = round == 0 ? c : round == 1u ? 0.5f + 0.5f * c : 0.6f * c;
    }
}

static int add_results(making *m, host_error *error)
{
    const host_options *const options = m->job->options;
    for (uint32_t i = 0; i < m->job->model.n_parts; i++) {
        const char *const name = m->job->model.part[i].name;
        char file[NAME_ROOM];
        host_scene_model model = {name, NULL, {0}, 1.0f, NULL, SHOWN_ERROR_MM};
        (void)snprintf(file, sizeof file, "%s%s", name, host_format_extension((int)options->format));
        char *path = host_path_in(m->job->options->out, file);
        if (path == NULL)
            return host_fail(error, "output", "free memory");
        model.file = path;
        color_of(i, model.color);
        if (options->vertex_errors && options->format == HOST_FORMAT_VTK)
            model.scalars = "expected_error";
        host_scene_model_add(&m->scene, &model);
        free(path);
    }
    return 0;
}

/* A surface that was read, to be seen through. what: "target", or what else it is. */
static void add_seen_through(making *m, const host_target *surface, const char *what, const float color[3])
{
    static const char *const known[] = {".ply", ".stl", ".obj", ".vtk"};
    char name[NAME_ROOM];
    host_scene_model model = {name, surface->path, {0}, TARGET_OPACITY, NULL, 0.0};
    (void)snprintf(name, sizeof name, "%s (%s)", surface->name, what);
    memcpy(model.color, color, sizeof model.color);
    if (m->job->options->mirror_target != HOST_MIRROR_NONE)
        tell_left_out(m->job, surface->path, "the results are mirrored");
    else if (surface->surface == NULL || !slicer_reads(surface->path, known, sizeof known / sizeof known[0]))
        tell_left_out(m->job, surface->path, "Slicer does not read it as a surface");
    else
        host_scene_model_add(&m->scene, &model);
}

/* The surfaces that the results were registered to, and those that they were kept out of. */
static void add_targets(making *m)
{
    const host_job *const job = m->job;
    for (uint32_t i = 0; i < job->n_targets && !job->options->image_target; i++)
        add_seen_through(m, &job->target[i], "target", target_color);
    for (uint32_t i = 0; i < job->contacts.n_fixed; i++)
        add_seen_through(m, &job->contacts.fixed[i], "fixed", fixed_color);
}

/* A set of landmarks as a file of its own. */
static int add_points(making *m, const host_landmarks *set, float xyz[HOST_LANDMARKS_MAX][3], const char *name,
                      const float color[3], host_error *error)
{
    host_points points = {0};
    host_buffer buffer = {0};
    char file[NAME_ROOM];
    int result = 0;
    (void)snprintf(file, sizeof file, "%s.mrk.json", name);
    char *path = host_path_in(m->job->options->out, file);
    for (uint32_t i = 0; i < set->n && result == 0; i++)
        result = host_points_add(&points, set->label[i], strlen(set->label[i]), xyz[i]);
    if (result != 0 || path == NULL)
        buffer.failed = 1;
    else
        host_points_write(&points, file, &buffer);
    result = host_output_take(m->output, file, &buffer, 0, error);
    if (result == 0)
        host_scene_points(&m->scene, name, path, color);
    host_points_free(&points);
    free(path);
    return result;
}

/* Where the landmarks should be, and where the registration took those of the model. */
static int add_landmarks(making *m, host_error *error)
{
    const host_options *const options = m->job->options;
    const host_files *const files = options->landmarks.n > 0 ? &options->landmarks : &options->landmark_goals;
    const int axis = options->mirror_model;
    float from[HOST_LANDMARKS_MAX][3], to[HOST_LANDMARKS_MAX][3];
    host_landmarks *const set = calloc(1, sizeof *set);
    uint32_t n = 0;
    int result = set != NULL ? 0 : host_fail(error, "output", "free memory");
    if (result == 0 && files->n == 2)
        result = host_landmark_pairs_read(options, files, set, from, to, &n, error);
    if (result == 0 && files->n == 2) {
        for (uint32_t i = 0; i < n && axis != HOST_MIRROR_NONE; i++) /* carried from where the model's file has them */
            from[i][axis] = 0.0f - from[i][axis];
        result = add_points(m, set, to, "landmarks", places_color, error);
        if (result == 0 && host_carried_points(&m->carried, 0, from[0], n, NULL, error) < 0)
            result = -1;
        if (result == 0)
            result = add_points(m, set, from, "landmarks_of_the_model", carried_color, error);
    }
    free(set);
    return result;
}

/* From carry.bin as it is written. */
static int open_map(making *m, host_error *error)
{
    host_buffer bytes = {0};
    host_job_carry(m->job, &bytes);
    int result = bytes.failed ? host_fail(error, "output", "free memory")
                              : host_carried_take(&m->carried, bytes.data, bytes.size, m->job->options->threads, error);
    host_buffer_free(&bytes);
    return result;
}

static int fill(making *m, host_error *error)
{
    error->file = m->job->options->slicer;
    host_scene_begin(&m->scene);
    if (open_map(m, error) != 0 || add_field(m, error) != 0)
        return -1;
    add_volumes(m);
    if (add_results(m, error) != 0)
        return -1;
    add_targets(m);
    if (add_landmarks(m, error) != 0)
        return -1;
    host_scene_end(&m->scene);
    return 0;
}

int host_scene_add(const host_job *job, host_output *output, host_error *error)
{
    making m = {0};
    m.job = job;
    m.output = output;
    m.scene.out = &m.text;
    m.scene.path = job->options->slicer;
    int result = fill(&m, error);
    if (result == 0)
        result = host_output_add_path(output, job->options->slicer, &m.text, error);
    host_carried_close(&m.carried);
    host_buffer_free(&m.text);
    return result;
}
