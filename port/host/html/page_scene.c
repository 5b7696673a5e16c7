/* page_scene.c: surfaces as 16 bits an axis and indices; distances, expected errors as 16 bits a vertex.
 * SPDX-License-Identifier: MIT */
#include "html/page_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "html/page_parts.h"
#include "html/page_thin.h"

#define MODEL_BYTES 18u    /* of a vertex: two places, three values */
#define TARGET_BYTES 6u    /* of a target's */
#define BYTES_MAX 4500000u /* of all surfaces */
#define FAR_MM (4.0f * SMR_COORD_MAX)

/* What is known of the vertices of a structure; each array has n_vertices. */
typedef struct known {
    const float *before;                    /* [n_vertices][3], borrowed */
    float *distance[2], *expected, *memory; /* distance: before, after; NaN: not known; memory is owned */
    unsigned char *seen;                    /* owned */
} known;

typedef struct scene {
    const host_job *job;
    host_json *json;
    host_buffer *bytes;
    host_page_box box;
    known *known; /* [n_parts] */
    float cell_mm;
    uint64_t shown, whole; /* triangles */
    int failed;
} scene;

static const smr_surface *target_of(const host_job *job, uint32_t part)
{
    const uint32_t t = job->result[part].target;
    return t == HOST_NO_TARGET ? NULL : job->target[t].surface;
}

static float distance_to(const smr_surface *surface, const float *point)
{
    smr_closest hit;
    memset(&hit, 0, sizeof hit);
    hit.triangle = SMR_NONE;
    if (surface == NULL || smr_surface_closest(surface, point, NULL, -1.0f, FAR_MM, &hit) != SMR_OK ||
        hit.triangle == SMR_NONE)
        return NAN;
    return hit.distance;
}

/* A task: the distances of one structure. */
static void measure(void *arg, uint32_t task, uint32_t worker)
{
    const scene *const s = arg;
    const known *const k = &s->known[task];
    const host_mesh *const mesh = &s->job->result[task].mesh;
    const smr_surface *const surface = target_of(s->job, task);
    uint32_t i = 0;
    (void)worker;
    for (i = 0; i < mesh->n_vertices; i++) {
        k->distance[0][i] = distance_to(surface, k->before + 3u * (size_t)i);
        k->distance[1][i] = distance_to(surface, mesh->xyz + 3u * (size_t)i);
    }
}

/* Where a registration says nothing of a vertex it is -1, which is written as not known: so are all where the start was
 * kept, for what it says is of what was rejected. */
static int find_known(scene *s)
{
    const host_job *const job = s->job;
    const float *before = job->course.before_xyz;
    uint32_t i = 0, k = 0;
    for (i = 0; i < job->model.n_parts; i++) {
        known *const of = &s->known[i];
        const size_t n = job->result[i].mesh.n_vertices;
        of->before = before;
        before += 3u * n;
        of->memory = malloc((3u * n + 1u) * sizeof *of->memory);
        of->seen = calloc(n + 1u, 1);
        if (of->memory == NULL || of->seen == NULL)
            return -1;
        of->distance[0] = of->memory;
        of->distance[1] = of->memory + n;
        of->expected = of->memory + 2u * n;
        if (job->kept_start || smr_get_expected_error(job->state, i, of->expected) != SMR_OK)
            for (k = 0; k < n; k++)
                of->expected[k] = -1.0f;
        if (!job->kept_start)
            (void)smr_get_visible(job->state, i, of->seen);
    }
    host_parallel(&job->port.port, measure, s, job->model.n_parts);
    return 0;
}

static int is_shown(const host_target *target) { return target->users > 0; }

/* Bytes of all surfaces with this cube, or of all when it is 0. */
static size_t bytes_with(scene *s, float cell_mm)
{
    const host_job *const job = s->job;
    const uint32_t n = job->model.n_parts + job->n_targets;
    size_t bytes = 0;
    uint32_t i = 0;
    for (i = 0; i < n; i++) {
        const int model = i < job->model.n_parts;
        const host_mesh *const mesh = model ? &job->result[i].mesh : &job->target[i - job->model.n_parts].mesh;
        host_page_mesh thin;
        if (!model && !is_shown(&job->target[i - job->model.n_parts]))
            continue;
        if (host_page_thin(mesh, cell_mm, &thin) != 0)
            s->failed = 1;
        bytes += host_page_mesh_bytes(thin.n_vertices, thin.n_triangles, model ? MODEL_BYTES : TARGET_BYTES);
        host_page_mesh_free(&thin);
    }
    return bytes;
}

/* The smallest cube, about, with which all surfaces fit. */
static void choose_cell(scene *s)
{
    const host_job *const job = s->job;
    size_t bytes = bytes_with(s, 0.0f);
    uint32_t i = 0;
    float edge = host_page_box_side(&s->box) / 2000.0f;
    if (bytes <= BYTES_MAX)
        return;
    for (i = 0; i < job->model.n_parts; i++)
        edge = fmaxf(edge, host_page_edge(&job->result[i].mesh));
    s->cell_mm = 0.5f * edge * sqrtf((float)bytes / (float)BYTES_MAX);
    while (!s->failed && bytes_with(s, s->cell_mm) > BYTES_MAX)
        s->cell_mm *= 1.25f;
}

static void put_triangles(scene *s, const host_page_mesh *thin)
{
    host_page_put_triangles(s->json, s->bytes, thin->triangles, thin->n_triangles, thin->n_vertices);
    s->shown += thin->n_triangles;
}

/* The values of the vertices that are kept: {at, unit}. */
static void put_values(scene *s, const char *key, const host_page_mesh *thin, const float *value, float *room)
{
    uint32_t i = 0;
    for (i = 0; i < thin->n_vertices; i++)
        room[i] = value[thin->keep[i]];
    host_json_open(s->json, key, '{');
    host_page_put_place(s->json, "at", s->bytes);
    host_json_number(s->json, "unit", host_page_values(s->bytes, room, thin->n_vertices));
    host_json_close(s->json, '}');
}

static void put_points(scene *s, const char *key, const host_page_mesh *thin, const float *xyz)
{
    host_page_put_place(s->json, key, s->bytes);
    host_page_points(s->bytes, &s->box, xyz, thin->keep, thin->n_vertices);
}

static void put_structure(scene *s, uint32_t part)
{
    const host_result *const result = &s->job->result[part];
    const known *const k = &s->known[part];
    host_page_mesh thin;
    float *const room = malloc(((size_t)result->mesh.n_vertices + 1u) * sizeof *room);
    const int failed = host_page_thin(&result->mesh, s->cell_mm, &thin) != 0 || room == NULL;
    uint64_t seen = 0;
    uint32_t i = 0;
    s->failed |= failed;
    host_json_open(s->json, NULL, '{');
    host_json_text(s->json, "name", s->job->model.part[part].name);
    if (!failed) {
        for (i = 0; i < result->mesh.n_vertices; i++)
            seen += k->seen[i] != 0;
        host_json_count(s->json, "seen", seen);
        put_triangles(s, &thin);
        put_points(s, "before", &thin, k->before);
        put_points(s, "after", &thin, result->mesh.xyz);
        put_values(s, "distance_before", &thin, k->distance[0], room);
        put_values(s, "distance_after", &thin, k->distance[1], room);
        put_values(s, "expected", &thin, k->expected, room);
    }
    host_json_close(s->json, '}');
    s->whole += result->mesh.n_triangles;
    host_page_mesh_free(&thin);
    free(room);
}

static void put_target(scene *s, const host_target *target)
{
    host_page_mesh thin;
    const int failed = host_page_thin(&target->mesh, s->cell_mm, &thin) != 0;
    s->failed |= failed;
    host_json_open(s->json, NULL, '{');
    host_json_text(s->json, "name", target->name);
    host_json_text(s->json, "path", target->path);
    if (!failed) {
        put_triangles(s, &thin);
        put_points(s, "at", &thin, target->mesh.xyz);
    }
    host_json_close(s->json, '}');
    s->whole += target->mesh.n_triangles;
    host_page_mesh_free(&thin);
}

static void put_all(scene *s)
{
    const host_job *const job = s->job;
    uint32_t i = 0;
    host_json_open(s->json, "scene", '{');
    host_page_put_box(&s->box, s->json);
    host_json_open(s->json, "structures", '[');
    for (i = 0; i < job->model.n_parts; i++)
        put_structure(s, i);
    host_json_close(s->json, ']');
    host_json_open(s->json, "targets", '[');
    for (i = 0; i < job->n_targets; i++)
        if (is_shown(&job->target[i]))
            put_target(s, &job->target[i]);
    host_json_close(s->json, ']');
    host_json_count(s->json, "triangles_shown", s->shown);
    host_json_count(s->json, "triangles_whole", s->whole);
    host_json_number(s->json, "cell_mm", (double)s->cell_mm);
    host_json_close(s->json, '}');
}

void host_page_scene(const host_job *job, host_json *json, host_buffer *bytes, host_page_box *box)
{
    scene s;
    uint32_t i = 0;
    memset(&s, 0, sizeof s);
    s.job = job;
    s.json = json;
    s.bytes = bytes;
    s.box = host_page_box_empty();
    s.known = calloc((size_t)job->model.n_parts + 1u, sizeof *s.known);
    if (s.known == NULL || find_known(&s) != 0) {
        s.failed = 1;
    } else {
        for (i = 0; i < job->model.n_parts; i++) {
            host_page_box_add(&s.box, s.known[i].before, job->result[i].mesh.n_vertices);
            host_page_box_add(&s.box, job->result[i].mesh.xyz, job->result[i].mesh.n_vertices);
        }
        for (i = 0; i < job->n_targets; i++)
            if (is_shown(&job->target[i]))
                host_page_box_add(&s.box, job->target[i].mesh.xyz, job->target[i].mesh.n_vertices);
        choose_cell(&s);
        put_all(&s);
    }
    for (i = 0; s.known != NULL && i < job->model.n_parts; i++) {
        free(s.known[i].memory);
        free(s.known[i].seen);
    }
    free(s.known);
    bytes->failed |= s.failed;
    *box = s.box;
}
