/* report_html.c: the page of a registration: surfaces before and after, distances and expected errors of their
 * vertices, the image around them, every iteration.
 * SPDX-License-Identifier: MIT */

#include <math.h>
#include <stdlib.h>
#include "html/page_data.h"

#define MODEL_BYTES 18u       /* of a vertex: two places, three values */
#define TARGET_BYTES 6u       /* of a target's */
#define SURFACES_MAX 4500000u /* bytes of all surfaces */
#define MARGIN_MM 25.0f       /* of the image around the surfaces */
#define VOXELS_MAX 5600000u   /* of the image */

typedef struct scene {
    const host_job *job;
    host_page_part *part; /* [model.n_parts + n_targets]; owned */
    float *distance[2];   /* [all vertices] mm, before and after; NaN: not known; owned */
    uint32_t *first;      /* [model.n_parts] first vertex of a structure; owned */
    float cell_mm;
} scene;

static const host_target *shown_target(const host_job *job, uint32_t target)
{
    return job->target[target].users > 0 ? &job->target[target] : NULL;
}

/* A task: the distances of one structure. */
static void measure(void *arg, uint32_t task, uint32_t worker)
{
    const scene *const s = arg;
    const host_mesh *const mesh = &s->job->result[task].mesh;
    const uint32_t first = s->first[task], target = s->job->result[task].target;
    const smr_surface *const surface = target == HOST_NO_TARGET ? NULL : s->job->target[target].surface;
    (void)worker;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        s->distance[0][first + i] =
            surface == NULL ? NAN : host_distance(surface, s->job->course.before_xyz + 3u * ((size_t)first + i));
        s->distance[1][first + i] = surface == NULL ? NAN : host_distance(surface, mesh->xyz + 3u * (size_t)i);
    }
}

static int make_scene(scene *s)
{
    const host_job *const job = s->job;
    const uint32_t n_parts = job->model.n_parts, n = n_parts + job->n_targets, all = job->model.info.n_vertices;
    uint32_t first = 0, shown = n_parts;
    s->part = calloc((size_t)n + 1u, sizeof *s->part);
    s->distance[0] = malloc(((size_t)all + 1u) * sizeof(float));
    s->distance[1] = malloc(((size_t)all + 1u) * sizeof(float));
    s->first = calloc((size_t)n_parts + 1u, sizeof *s->first);
    if (s->part == NULL || s->distance[0] == NULL || s->distance[1] == NULL || s->first == NULL)
        return -1;
    for (uint32_t i = 0; i < n_parts; first += job->result[i++].mesh.n_vertices) {
        s->part[i] = (host_page_part){&job->result[i].mesh, MODEL_BYTES, {0}};
        s->first[i] = first;
    }
    for (uint32_t i = 0; i < job->n_targets; i++)
        if (shown_target(job, i) != NULL)
            s->part[shown++] = (host_page_part){&job->target[i].mesh, TARGET_BYTES, {0}};
    host_parallel(&job->port.port, measure, s, n_parts);
    return host_page_thin_all(s->part, shown, SIZE_MAX, SURFACES_MAX, &s->cell_mm);
}

static void free_scene(scene *s)
{
    host_page_parts_free(s->part, s->part == NULL ? 0 : s->job->model.n_parts + s->job->n_targets);
    free(s->distance[0]);
    free(s->distance[1]);
    free(s->first);
}

/* Before and after, as two frames. */
static void put_frames(const scene *s, host_json *json)
{
    const host_job *const job = s->job;
    host_json_open(json, "frames", '[');
    for (int after = 0; after < 2; after++) {
        host_json_open(json, NULL, '{');
        host_json_open(json, "places", '[');
        for (uint32_t i = 0; i < job->model.n_parts; i++)
            host_page_points(json, NULL,
                             after ? job->result[i].mesh.xyz : job->course.before_xyz + 3u * (size_t)s->first[i],
                             s->part[i].thin.keep, s->part[i].thin.n_vertices);
        host_json_close(json, ']');
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
}

/* Expected errors are not known where the start was kept: they are of what was rejected. */
static void put_structure(const scene *s, uint32_t i, host_json *json)
{
    const host_job *const job = s->job;
    const host_page_mesh *const thin = &s->part[i].thin;
    const uint32_t n = job->result[i].mesh.n_vertices;
    float *const expected = malloc(((size_t)n + 1u) * sizeof *expected);
    json->out->failed |= expected == NULL;
    host_json_open(json, NULL, '{');
    host_json_text(json, "name", job->model.part[i].name);
    host_page_triangles(json, thin);
    host_page_values(json, "distance_before", s->distance[0] + s->first[i], thin->keep, thin->n_vertices);
    host_page_values(json, "distance_after", s->distance[1] + s->first[i], thin->keep, thin->n_vertices);
    if (expected != NULL) {
        if (job->kept_start || smr_get_expected_error(job->state, i, expected) != SMR_OK)
            for (uint32_t k = 0; k < n; k++)
                expected[k] = -1.0f;
        host_page_values(json, "expected", expected, thin->keep, thin->n_vertices);
    }
    host_json_close(json, '}');
    free(expected);
}

static void put_scene(const scene *s, host_json *json)
{
    const host_job *const job = s->job;
    uint64_t shown = 0, whole = 0;
    uint32_t k = job->model.n_parts;
    host_json_open(json, "structures", '[');
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        put_structure(s, i, json);
    host_json_close(json, ']');
    host_json_open(json, "targets", '[');
    for (uint32_t i = 0; i < job->n_targets; i++) {
        if (shown_target(job, i) == NULL)
            continue;
        host_json_open(json, NULL, '{');
        host_json_text(json, "name", job->target[i].name);
        host_json_text(json, "path", job->target[i].path);
        host_page_triangles(json, &s->part[k].thin);
        host_page_points(json, "place", job->target[i].mesh.xyz, s->part[k].thin.keep, s->part[k].thin.n_vertices);
        host_json_close(json, '}');
        k++;
    }
    host_json_close(json, ']');
    put_frames(s, json);
    for (uint32_t i = 0; i < k; i++) {
        shown += s->part[i].thin.n_triangles;
        whole += s->part[i].mesh->n_triangles;
    }
    host_json_count(json, "triangles_shown", shown);
    host_json_count(json, "triangles_whole", whole);
    host_json_number(json, "cell_mm", (double)s->cell_mm);
}

static void put_size(host_json *json, const char *key, const uint32_t size[3])
{
    const float count[3] = {(float)size[0], (float)size[1], (float)size[2]};
    host_json_list(json, key, count, 3);
}

/* "image": the target image around the surfaces. */
static void put_image(const scene *s, host_json *json)
{
    const host_job *const job = s->job;
    const host_volume *const v = &job->image.volume;
    host_page_image image = {0};
    host_box box = {0};
    host_box_add(&box, job->course.before_xyz, job->model.info.n_vertices);
    for (uint32_t i = 0; s->part[i].mesh != NULL; i++)
        host_box_add(&box, s->part[i].mesh->xyz, s->part[i].mesh->n_vertices);
    if (!job->options->image_target || host_page_image_make(v, &box, MARGIN_MM, VOXELS_MAX, &image) != 0 ||
        image.at == NULL) {
        json->out->failed |= image.size[0] > 0; /* out of memory */
        free(image.at);
        host_json_null(json, "image");
        return;
    }
    host_json_open(json, "image", '{');
    host_json_text(json, "path", job->options->target.path[0]);
    put_size(json, "size", image.size);
    host_json_list(json, "spacing", image.spacing, 3);
    host_json_list(json, "first", image.first, 3);
    host_json_list(json, "direction", v->direction, 9);
    put_size(json, "whole_size", v->size);
    host_json_list(json, "whole_spacing", v->spacing, 3);
    host_json_number(json, "low", image.low);
    host_json_number(json, "high", image.high);
    host_page_bytes(json, "voxels", image.at, (size_t)image.size[0] * image.size[1] * image.size[2]);
    host_json_close(json, '}');
    free(image.at);
}

static double measured(float figure) { return figure < 0.0f ? (double)NAN : (double)figure; }

static void put_course(const host_course *course, host_json *json)
{
    host_json_open(json, "course", '[');
    for (size_t i = 0; i < course->n; i++) {
        const host_step *const s = &course->step[i];
        host_json_open(json, NULL, '{');
        host_json_count(json, "iteration", s->iteration);
        host_json_number(json, "radius_mm", s->radius_mm);
        host_json_number(json, "residual_mm", measured(s->residual_mm));
        host_json_number(json, "moved_max_mm", measured(s->moved_max_mm));
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
}

void host_report_html(const host_job *job, const host_buffer *report, host_buffer *out)
{
    host_buffer text = {0};
    host_json json = {&text, 0, 1, 1};
    scene s = {0};
    s.job = job;
    if (make_scene(&s) != 0) {
        out->failed = 1;
    } else {
        host_json_open(&json, NULL, '{');
        host_json_text(&json, "kind", "register");
        host_json_raw(&json, "report", report);
        host_json_flag(&json, "image_target", job->options->image_target);
        host_json_flag(&json, "resumed", job->options->resume != NULL);
        host_json_flag(&json, "prepared", job->model_is_prepared);
        put_scene(&s, &json);
        put_image(&s, &json);
        put_course(&job->course, &json);
        host_page_settings(job->options, &job->course.config, job->model_is_prepared, &json);
        host_json_close(&json, '}');
        host_page_write(&text, out);
    }
    free_scene(&s);
    host_buffer_free(&text);
}
