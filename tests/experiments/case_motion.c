/* case_motion.c: a bone that turns and bends, frame by frame, and a registration that follows it.
 * SPDX-License-Identifier: MIT */
#include "case_motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_motion_image.h"
#include "case_points.h"
#include "experiment.h"
#include "measure/surface_distances.h"

/* The scene at rest, and how it moves. */
typedef struct scene {
    const case_motion_options *options;
    case_data data;                                    /* truths, wholes and targets are those of the frame */
    host_mesh whole[CASE_BODIES], target[CASE_BODIES]; /* at rest */
    double centre[3], half;                            /* the middle, and half the length */
    double axes[9];                                    /* long, middle, short */
    double turn_axis[3], jump_axis[3], jump_way[3], view[3];
} scene;

case_motion_options case_motion_defaults(void)
{
    case_motion_options o;
    memset(&o, 0, sizeof o);
    o.seed = 1;
    o.turn_deg = 30.0;
    o.bend_mm = 5.0;
    o.turn_s = 2.0;
    o.side_deg = 180.0;
    o.shift_mm = 3.0;
    o.start_deg = 3.0;
    o.fps = 30.0;
    o.n_frames = 60;
    o.most_ticks = 10;
    o.every = 3;
    o.config = smr_config_default();
    o.config.track.mode = SMR_TRACK_RECOVER;
    return o;
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The middle of all vertices, and half the length of the long axis. */
static void measure_scene(scene *s, const host_mesh *const *model)
{
    double low = HUGE_VAL, high = -HUGE_VAL, count = 0.0;
    uint32_t i = 0, k = 0;
    int c = 0;
    case_axes(model, s->data.n, s->axes);
    for (k = 0; k < s->data.n; k++)
        count += model[k]->n_vertices;
    for (k = 0; k < s->data.n; k++)
        for (i = 0; i < 3u * model[k]->n_vertices; i++)
            s->centre[i % 3u] += (double)model[k]->xyz[i] / count;
    for (k = 0; k < s->data.n; k++)
        for (i = 0; i < model[k]->n_vertices; i++) {
            double d[3];
            for (c = 0; c < 3; c++)
                d[c] = (double)model[k]->xyz[3u * (size_t)i + (size_t)c] - s->centre[c];
            low = fmin(low, dot(d, s->axes));
            high = fmax(high, dot(d, s->axes));
        }
    s->half = 0.5 * (high - low);
}

static int make_scene(scene *s, const char *const *file, uint32_t n)
{
    oracle_random r = oracle_seed(7000u + s->options->seed);
    const host_mesh *model[CASE_BODIES];
    double angle = 0.0;
    uint32_t k = 0;
    int c = 0;
    for (k = 0; k < n; k++) {
        case_body *const body = &s->data.body[k];
        if (!case_add(&s->data, file[k], HOST_MIRROR_NONE))
            return 0;
        s->whole[k] = case_subdivide(&body->model);
        s->target[k] = case_resample(&body->model, 0, &r);
        body->truth = case_copy(&body->model);
        body->whole = case_copy(&s->whole[k]);
        body->target = case_copy(&s->target[k]);
        body->seen = case_alloc(body->model.n_vertices, 1);
        model[k] = &body->model;
    }
    measure_scene(s, model);
    case_direction(&r, s->turn_axis);
    case_direction(&r, s->jump_axis);
    case_direction(&r, s->jump_way);
    angle = oracle_uniform(&r, 0.0, 2.0 * acos(-1.0));
    for (c = 0; c < 3; c++)
        s->view[c] = cos(angle) * s->axes[3 + c] + sin(angle) * s->axes[6 + c];
    return 1;
}

static void free_scene(scene *s)
{
    uint32_t k = 0;
    for (k = 0; k < CASE_BODIES; k++) {
        host_mesh_free(&s->whole[k]);
        host_mesh_free(&s->target[k]);
    }
    case_free(&s->data);
}

static void turn_about(const double axis[3], double degrees, const double centre[3], double x[3])
{
    double m[9], d[3];
    int c = 0;
    oracle_turn(axis, degrees * acos(-1.0) / 180.0, m);
    for (c = 0; c < 3; c++)
        d[c] = x[c] - centre[c];
    for (c = 0; c < 3; c++)
        x[c] = centre[c] + m[3 * c] * d[0] + m[3 * c + 1] * d[1] + m[3 * c + 2] * d[2];
}

/* How far on its way the bone is, 0..1. */
static double way_of(const case_motion_options *o, uint32_t frame)
{
    const double turns = frame / o->fps / o->turn_s, part = turns - 2.0 * floor(0.5 * turns);
    return part < 1.0 ? part : 2.0 - part;
}

static void move_mesh(const scene *s, uint32_t frame, const host_mesh *rest, host_mesh *to)
{
    const case_motion_options *const o = s->options;
    const double way = way_of(o, frame);
    const int jumped = o->jump_frame > 0u && frame >= o->jump_frame;
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < rest->n_vertices; i++) {
        double x[3], d[3], u = 0.0;
        for (c = 0; c < 3; c++)
            d[c] = (double)rest->xyz[3u * (size_t)i + (size_t)c] - s->centre[c];
        u = dot(d, s->axes) / s->half;
        for (c = 0; c < 3; c++)
            x[c] = d[c] + s->centre[c] + way * o->bend_mm * (u * u - 1.0 / 3.0) * s->axes[3 + c];
        turn_about(s->turn_axis, way * o->turn_deg, s->centre, x);
        if (jumped)
            turn_about(s->jump_axis, o->jump_deg, s->centre, x);
        for (c = 0; c < 3; c++)
            to->xyz[3u * (size_t)i + (size_t)c] = (float)(x[c] + (jumped ? o->jump_mm * s->jump_way[c] : 0.0));
    }
}

/* The computed thigh's own flexion, degrees. */
static double flexion_of(const case_motion_options *o, uint32_t frame) { return way_of(o, frame) * o->flex_deg; }

static void flex_mesh(const scene *s, uint32_t frame, host_mesh *mesh)
{
    const fixture_pose pose = case_motion_pose(flexion_of(s->options, frame));
    float *const before = case_alloc(3u * (size_t)mesh->n_vertices, sizeof *before);
    memcpy(before, mesh->xyz, 3u * (size_t)mesh->n_vertices * sizeof *before);
    fixture_thigh_truth(&pose, before, mesh->n_vertices, mesh->xyz);
    free(before);
}

static void place_mesh(const scene *s, uint32_t frame, const host_mesh *rest, host_mesh *to)
{
    move_mesh(s, frame, rest, to);
    if (s->options->flex_deg > 0.0)
        flex_mesh(s, frame, to);
}

/* What is seen of a target. */
static host_mesh seen_of(const scene *s, const host_mesh *all)
{
    const double least = cos(s->options->side_deg * acos(-1.0) / 180.0);
    unsigned char *const keep = case_alloc(all->n_triangles, 1);
    host_mesh cut;
    uint32_t t = 0;
    for (t = 0; t < all->n_triangles; t++) {
        double n[3];
        case_triangle_normal(all, t, n);
        keep[t] = s->options->side_deg >= 180.0 || dot(n, s->view) > least * sqrt(dot(n, n));
    }
    cut = case_cut(all, keep);
    free(keep);
    return cut;
}

/* Truths, wholes and targets of a frame. Returns the share of the area that is seen. */
static double make_frame(scene *s, uint32_t frame)
{
    double all = 0.0, seen = 0.0;
    uint32_t k = 0;
    for (k = 0; k < s->data.n; k++) {
        case_body *const body = &s->data.body[k];
        host_mesh target = case_copy(&s->target[k]);
        place_mesh(s, frame, &body->model, &body->truth);
        place_mesh(s, frame, &s->whole[k], &body->whole);
        place_mesh(s, frame, &s->target[k], &target);
        host_mesh_free(&body->target);
        body->target = seen_of(s, &target);
        all += case_area(&target);
        seen += case_area(&body->target);
        host_mesh_free(&target);
    }
    return seen / all;
}

/* A registration and its memory. */
typedef struct follower {
    void *scratch, *model, *arena;
    const smr_model *opened;
    case_motion_image image; /* where images are followed */
    smr *s;
    float *xyz[CASE_BODIES];
} follower;

static void *aligned(size_t bytes) { return aligned_alloc(SMR_ALIGN, (bytes + SMR_ALIGN) / SMR_ALIGN * SMR_ALIGN); }

/* A volume that holds the model wherever it flexes. */
static void open_image(const scene *s, follower *f)
{
    const fixture_pose most = case_motion_pose(s->options->flex_deg);
    float low[3] = {0}, high[3] = {0};
    uint32_t k = 0;
    for (k = 0; k < s->data.n; k++) {
        const host_mesh *const mesh = &s->data.body[k].model;
        if (k == 0u) {
            memcpy(low, mesh->xyz, sizeof low);
            memcpy(high, mesh->xyz, sizeof high);
        }
        fixture_thigh_truth(&most, mesh->xyz, mesh->n_vertices, f->xyz[k]);
        fixture_bounds(mesh->xyz, mesh->n_vertices, low, high);
        fixture_bounds(f->xyz[k], mesh->n_vertices, low, high);
    }
    case_motion_image_open(&f->image, low, high);
}

static int make_follower(const scene *s, follower *f)
{
    smr_prepare_config prepare = smr_prepare_config_default();
    smr_volume reference;
    smr_structure part[CASE_BODIES];
    smr_config config = s->options->config;
    size_t scratch = 0, bytes = 0, needed = 0;
    uint32_t k = 0;
    int good = 0;
    for (k = 0; k < s->data.n; k++) {
        const host_mesh *const mesh = &s->data.body[k].model;
        part[k].name = s->data.body[k].name;
        part[k].mesh = host_mesh_view(mesh);
        f->xyz[k] = case_alloc(3u * (size_t)mesh->n_vertices, sizeof(float));
        config.basic.n_target_vertices += s->options->n_points > 0u ? s->options->n_points : s->target[k].n_vertices;
    }
    if (s->options->image_every > 0u) {
        open_image(s, f);
        reference = case_motion_image_make(&f->image, 0.0);
        prepare.reference = &reference;
    }
    good = smr_prepare_bytes(part, s->data.n, &prepare, &scratch) == SMR_OK;
    f->scratch = aligned(scratch);
    good = good && smr_prepare(part, s->data.n, &prepare, f->scratch, scratch, NULL, 0, &bytes) == SMR_OK;
    f->model = aligned(bytes);
    good = good && smr_prepare(part, s->data.n, &prepare, f->scratch, scratch, f->model, bytes, &bytes) == SMR_OK;
    good = good && smr_model_open(f->model, bytes, &f->opened) == SMR_OK;
    good = good && smr_arena_bytes(f->opened, &config, &needed) == SMR_OK;
    f->arena = aligned(needed);
    return good && smr_init(f->opened, &config, NULL, f->arena, needed, &f->s) == SMR_OK;
}

static void free_follower(follower *f)
{
    uint32_t k = 0;
    for (k = 0; k < CASE_BODIES; k++)
        free(f->xyz[k]);
    case_motion_image_free(&f->image);
    free(f->scratch);
    free(f->model);
    free(f->arena);
}

/* The start: turned about the centre and shifted. */
static int pose_follower(const scene *s, follower *f)
{
    smr_pose pose;
    double m[9];
    int r = 0, c = 0;
    oracle_turn(s->jump_axis, s->options->start_deg * acos(-1.0) / 180.0, m);
    for (r = 0; r < 3; r++) {
        double shift = s->centre[r] + s->options->shift_mm * s->jump_way[r];
        for (c = 0; c < 3; c++) {
            pose.m[r][c] = (float)m[3 * r + c];
            shift -= m[3 * r + c] * s->centre[c];
        }
        pose.m[r][3] = (float)shift;
    }
    return smr_set_pose(f->s, &pose) == SMR_OK;
}

/* 1: this structure's target is a surface. */
static int has_surface(const scene *s, uint32_t k)
{
    static const char *const bones[] = {"femur", "hip_bone", "patella"};
    uint32_t i = 0;
    for (i = 0; s->options->image_every > 0u && i < sizeof bones / sizeof bones[0]; i++)
        if (strcmp(s->data.body[k].name, bones[i]) == 0)
            return 1;
    return s->options->image_every == 0u;
}

/* A cloud of the frame's own points, as a camera gives them. */
static int set_cloud(const scene *s, follower *f, uint32_t frame, uint32_t k, void **memory)
{
    const uint32_t n = s->options->n_points;
    case_cloud cloud = case_sample(&s->data.body[k].target, n, s->options->noise_mm, 1000u * k + frame);
    smr_points *points = NULL;
    *memory = aligned(SMR_POINTS_BYTES(n));
    const int good = smr_points_open(n, *memory, SMR_POINTS_BYTES(n), &points) == SMR_OK &&
                     smr_points_add(points, cloud.xyz, NULL, NULL, n) == SMR_OK &&
                     smr_set_points(f->s, k, points) == SMR_OK;
    case_cloud_free(&cloud);
    return good;
}

static int set_surface(const scene *s, follower *f, uint32_t k, void **memory)
{
    const smr_mesh view = host_mesh_view(&s->data.body[k].target);
    const smr_surface *const surface = host_surface_make(&view, memory);
    return surface != NULL && smr_set_surface(f->s, k, surface) == SMR_OK;
}

static int set_targets(const scene *s, follower *f, uint32_t frame, void **memory)
{
    uint32_t k = 0;
    int good = 1;
    if (s->options->image_every > 0u && frame % s->options->image_every == 0u) {
        const smr_volume image = case_motion_image_make(&f->image, flexion_of(s->options, frame));
        good = smr_set_volume(f->s, &image) == SMR_OK;
    }
    for (k = 0; good && k < s->data.n; k++)
        if (has_surface(s, k))
            good = s->options->n_points > 0u ? set_cloud(s, f, frame, k, &memory[k]) : set_surface(s, f, k, &memory[k]);
    return good;
}

/* Ticks on the frame's targets. */
static int follow(const scene *s, follower *f, uint32_t number, uint32_t most, case_motion_frame *frame)
{
    void *memory[CASE_BODIES] = {NULL};
    smr_tick_report report;
    uint32_t n = 0, k = 0;
    int good = 0;
    good = set_targets(s, f, number, memory);
    memset(&report, 0, sizeof report);
    while (good && n < most && !report.details.settled && !report.done) {
        good = smr_tick(f->s, 0, &report) == SMR_OK;
        n++;
    }
    for (k = 0; good && k < s->data.n; k++)
        good = smr_get_positions(f->s, k, f->xyz[k]) == SMR_OK;
    good = good && smr_set_surface(f->s, SMR_ALL, NULL) == SMR_OK; /* their memory goes */
    frame->ticks = n;
    frame->settled = report.details.settled;
    frame->jumped = report.details.jumped;
    frame->residual = (double)report.residual_mean_mm;
    for (k = 0; k < s->data.n; k++)
        free(memory[k]);
    return good;
}

int case_motion_run(const char *const *file, uint32_t n, const case_motion_options *options, case_motion_frame *frame)
{
    scene *const s = case_alloc(1, sizeof *s);
    follower f;
    uint32_t i = 0;
    int good = 0;
    memset(&f, 0, sizeof f);
    s->options = options;
    good = make_scene(s, file, n) && make_follower(s, &f) && pose_follower(s, &f);
    for (i = 0; good && i < options->n_frames; i++) {
        const float *const *const xyz = (const float *const *)f.xyz;
        if (i > 0u)
            frame[i] = frame[i - 1u];
        else
            memset(frame, 0, sizeof *frame);
        frame[i].seen = make_frame(s, i);
        good = follow(s, &f, i, i == 0u ? 1000u : options->most_ticks, &frame[i]);
        if (good && options->every > 0u && i % options->every == 0u) {
            const case_figures figures = case_measure(&s->data, xyz);
            frame[i].surface = figures.surface;
            frame[i].vertex = figures.vertex;
        }
    }
    free_follower(&f);
    free_scene(s);
    free(s);
    return good;
}

case_motion_frame case_motion_mean(const case_motion_frame *frame, uint32_t first, uint32_t last)
{
    case_motion_frame mean;
    const double n = last - first;
    uint32_t i = 0;
    memset(&mean, 0, sizeof mean);
    for (i = first; i < last; i++) {
        mean.surface += frame[i].surface / n;
        mean.vertex += frame[i].vertex / n;
        mean.ticks += frame[i].ticks / n;
        mean.residual += frame[i].residual / n;
        mean.seen += frame[i].seen / n;
        mean.settled += frame[i].settled;
        mean.jumped += frame[i].jumped;
    }
    return mean;
}
