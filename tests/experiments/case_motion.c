/* case_motion.c: a bone that turns and bends, frame by frame, and a registration that follows it.
 * SPDX-License-Identifier: MIT */
#include "case_motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "experiment.h"
#include "measure/surface_distances.h"

/* The scene at rest, and how it moves. */
typedef struct scene {
    const case_motion_options *options;
    case_data data;          /* one body: its truth, whole and target are those of the frame */
    host_mesh whole, target; /* at rest */
    double centre[3], half;  /* the middle, and half the length */
    double axes[9];          /* long, middle, short */
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
    o.config.track = SMR_TRACK_RECOVER;
    return o;
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static int make_scene(scene *s, const char *bone)
{
    oracle_random r = oracle_seed(7000u + s->options->seed);
    const host_mesh *model = &s->data.body[0].model;
    double low = HUGE_VAL, high = -HUGE_VAL, angle = 0.0;
    uint32_t i = 0;
    int c = 0;
    if (!case_add(&s->data, bone, HOST_MIRROR_NONE))
        return 0;
    case_axes(&model, 1, s->axes);
    for (i = 0; i < model->n_vertices; i++)
        for (c = 0; c < 3; c++)
            s->centre[c] += (double)model->xyz[3u * (size_t)i + (size_t)c] / model->n_vertices;
    for (i = 0; i < model->n_vertices; i++) {
        double d[3], at = 0.0;
        for (c = 0; c < 3; c++)
            d[c] = (double)model->xyz[3u * (size_t)i + (size_t)c] - s->centre[c];
        at = dot(d, s->axes);
        low = fmin(low, at);
        high = fmax(high, at);
    }
    s->half = 0.5 * (high - low);
    s->whole = case_subdivide(model);
    s->target = case_resample(model, 0, &r);
    case_direction(&r, s->turn_axis);
    case_direction(&r, s->jump_axis);
    case_direction(&r, s->jump_way);
    angle = oracle_uniform(&r, 0.0, 2.0 * acos(-1.0));
    for (c = 0; c < 3; c++)
        s->view[c] = cos(angle) * s->axes[3 + c] + sin(angle) * s->axes[6 + c];
    s->data.body[0].truth = case_copy(model);
    s->data.body[0].whole = case_copy(&s->whole);
    s->data.body[0].target = case_copy(&s->target);
    s->data.body[0].seen = case_alloc(model->n_vertices, 1);
    return 1;
}

static void free_scene(scene *s)
{
    host_mesh_free(&s->whole);
    host_mesh_free(&s->target);
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

/* Truth, whole and target of a frame. Returns the share of the area that is seen. */
static double make_frame(scene *s, uint32_t frame)
{
    case_body *const body = &s->data.body[0];
    const double least = cos(s->options->side_deg * acos(-1.0) / 180.0);
    host_mesh all = case_copy(&s->target), cut;
    unsigned char *keep = NULL;
    double share = 1.0;
    uint32_t t = 0;
    move_mesh(s, frame, &body->model, &body->truth);
    move_mesh(s, frame, &s->whole, &body->whole);
    move_mesh(s, frame, &s->target, &all);
    host_mesh_free(&body->target);
    if (s->options->side_deg >= 180.0) {
        body->target = all;
        return share;
    }
    keep = case_alloc(all.n_triangles, 1);
    for (t = 0; t < all.n_triangles; t++) {
        double n[3];
        case_triangle_normal(&all, t, n);
        keep[t] = dot(n, s->view) > least * sqrt(dot(n, n));
    }
    cut = case_cut(&all, keep);
    share = case_area(&cut) / case_area(&all);
    host_mesh_free(&all);
    free(keep);
    body->target = cut;
    return share;
}

/* A registration and its memory. */
typedef struct follower {
    void *scratch, *model, *arena;
    const smr_model *opened;
    smr *s;
    float *xyz;
} follower;

static int make_follower(const scene *s, follower *f)
{
    const smr_mesh mesh = host_mesh_view(&s->data.body[0].model);
    const smr_structure one = {"bone", {mesh.xyz, mesh.triangles, mesh.n_vertices, mesh.n_triangles}};
    const smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = s->options->config;
    size_t scratch = 0, bytes = 0, needed = 0;
    config.n_target_vertices = s->target.n_vertices;
    int good = smr_prepare_bytes(&one, 1, &prepare, &scratch) == SMR_OK;
    f->scratch = aligned_alloc(SMR_ALIGN, (scratch + SMR_ALIGN) / SMR_ALIGN * SMR_ALIGN);
    good = good && smr_prepare(&one, 1, &prepare, f->scratch, scratch, NULL, 0, &bytes) == SMR_OK;
    f->model = aligned_alloc(SMR_ALIGN, (bytes + SMR_ALIGN) / SMR_ALIGN * SMR_ALIGN);
    good = good && smr_prepare(&one, 1, &prepare, f->scratch, scratch, f->model, bytes, &bytes) == SMR_OK;
    good = good && smr_model_open(f->model, bytes, &f->opened) == SMR_OK;
    good = good && smr_arena_bytes(f->opened, &config, &needed) == SMR_OK;
    f->arena = aligned_alloc(SMR_ALIGN, (needed + SMR_ALIGN) / SMR_ALIGN * SMR_ALIGN);
    f->xyz = case_alloc(3u * (size_t)mesh.n_vertices, sizeof *f->xyz);
    return good && smr_init(f->opened, &config, NULL, f->arena, needed, &f->s) == SMR_OK;
}

static void free_follower(follower *f)
{
    free(f->scratch);
    free(f->model);
    free(f->arena);
    free(f->xyz);
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

/* Ticks on the frame's target. */
static int follow(const scene *s, follower *f, uint32_t most, case_motion_frame *frame)
{
    const smr_mesh view = host_mesh_view(&s->data.body[0].target);
    void *memory = NULL;
    const smr_surface *const surface = host_surface_make(&view, &memory);
    smr_tick_report report;
    uint32_t n = 0;
    int good = surface != NULL && smr_set_surface(f->s, SMR_ALL, surface) == SMR_OK;
    memset(&report, 0, sizeof report);
    while (good && n < most && !report.settled && !report.done) {
        good = smr_tick(f->s, 0, &report) == SMR_OK;
        if(getenv("DBG")&&n==0) printf("first %u forces %u res %.3f rms %.3f max %.3f disp %.3f\n",report.n_active,report.n_forces,report.residual_mean_mm,report.residual_rms_mm,report.residual_max_mm,report.displacement_max_mm);
        n++;
    }
    good = good && smr_get_positions(f->s, 0, f->xyz) == SMR_OK;
    frame->ticks = n;
    frame->settled = report.settled;
    frame->jumped = report.jumped;
    frame->residual = (double)report.residual_mean_mm;
    free(memory);
    return good;
}

int case_motion_run(const char *bone, const case_motion_options *options, case_motion_frame *frame)
{
    scene *const s = case_alloc(1, sizeof *s);
    follower f = {NULL, NULL, NULL, NULL, NULL, NULL};
    uint32_t i = 0;
    s->options = options;
    int good = make_scene(s, bone) && make_follower(s, &f) && pose_follower(s, &f);
    for (i = 0; good && i < options->n_frames; i++) {
        const float *xyz[1] = {f.xyz};
        if (i > 0u)
            frame[i] = frame[i - 1u];
        else
            memset(frame, 0, sizeof *frame);
        frame[i].seen = make_frame(s, i);
        good = follow(s, &f, i == 0u ? 1000u : options->most_ticks, &frame[i]);
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
