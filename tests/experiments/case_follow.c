/* case_follow.c: targets that move, with a known truth: a bone turns and bends to and fro, or the computed thigh
 * flexes, seen in whole or from one side; and a registration that follows them by the library itself, since the
 * command line gives no frame both surfaces and an image.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "fixture_thigh.h"
#include "measure/surface_distances.h"

#define FPS 30.0
#define TURN_S 2.0 /* one way takes so long, and so does the way back */

/* How it moves and how it is followed, in the order of their names below. */
typedef struct options {
    double seed;          /* of the axis, the view and the resampling */
    double turn, bend;    /* degrees and mm at the end of a turn */
    double flex;          /* degrees, of the computed thigh */
    double jump;          /* the first frame after a jump of 25 mm and 10 degrees; 0: never */
    double side;          /* degrees: triangles whose normals lie within it of the view are seen; 180: all */
    double frames, ticks; /* ticks: most of a frame */
    double every;         /* frames between two measurements */
    double points;        /* targets are clouds of so many points with noise of 0.3 mm; 0: surfaces */
    double images;        /* computed thigh: frames between two images; bones have surfaces. 0: no image */
    double strays;        /* share of the points that lie anywhere about it */
    double ahead;         /* share of their last displacement by which structures go on */
} options;
static const char *const names[] = {"seed",  "turn",  "bend",   "flex",   "jump",   "side", "frames",
                                    "ticks", "every", "points", "images", "strays", "ahead"};
enum { OPTIONS = sizeof names / sizeof names[0], MOST = 300 };

/* The scene at rest, and how it moves. */
typedef struct scene {
    options o;
    case_data data;                                    /* truths, wholes and targets are those of the frame */
    host_mesh whole[CASE_BODIES], target[CASE_BODIES]; /* at rest */
    double centre[3], half;                            /* the middle, and half the length */
    double axes[9];                                    /* long, middle, short */
    double turn_axis[3], jump_axis[3], jump_way[3], view[3];
    fixture_thigh thigh;
    fixture_box box; /* of all images */
    uint8_t *voxels[2];
    float *slices;
    case_runner run;
    float *xyz[CASE_BODIES];
} scene;

/* A frame, or means over several. */
typedef struct frame {
    double surface, vertex, expected, ticks, residual, seen, jumped;
} frame;

static void make_scene(scene *s, char **file)
{
    oracle_random r = oracle_seed(7000u + (uint32_t)s->o.seed), other = oracle_seed(8000u + (uint32_t)s->o.seed);
    double low = HUGE_VAL, high = -HUGE_VAL, count = 0.0, d[3];
    for (uint32_t k = 0; file[k] != NULL; k++) {
        case_body *const body = case_add(&s->data, file[k], HOST_MIRROR_NONE);
        s->whole[k] = case_subdivide(&body->model, NULL);
        s->target[k] = case_subdivide(&body->model, &other);
        body->truth = case_copy(&body->model);
        body->whole = case_copy(&s->whole[k]);
        count += body->model.n_vertices;
        for (uint32_t i = 0; i < 3u * body->model.n_triangles; i++)
            (void)oracle_next(&r); /* motions are those that were recorded before */
        s->xyz[k] = case_alloc(3u * (size_t)body->model.n_vertices, sizeof(float));
    }
    case_axes(&s->data, s->axes);
    for (uint32_t k = 0; k < s->data.n; k++)
        for (uint32_t i = 0; i < 3u * s->data.body[k].model.n_vertices; i++)
            s->centre[i % 3u] += (double)s->data.body[k].model.xyz[i] / count;
    for (uint32_t k = 0; k < s->data.n; k++)
        for (uint32_t i = 0; i < s->data.body[k].model.n_vertices; i++) {
            case_get(&s->data.body[k].model, i, d);
            for (int c = 0; c < 3; c++)
                d[c] -= s->centre[c];
            low = fmin(low, case_dot(d, s->axes));
            high = fmax(high, case_dot(d, s->axes));
        }
    s->half = 0.5 * (high - low);
    case_direction(&r, s->turn_axis);
    case_direction(&r, s->jump_axis);
    case_direction(&r, s->jump_way);
    const double angle = oracle_uniform(&r, 0.0, 2.0 * acos(-1.0));
    for (int c = 0; c < 3; c++)
        s->view[c] = cos(angle) * s->axes[3 + c] + sin(angle) * s->axes[6 + c];
}

/* ---- where everything is in a frame */

static void turn_about(const double axis[3], double degrees, const double centre[3], double x[3])
{
    double m[9], d[3];
    oracle_turn(axis, case_radians(degrees), m);
    for (int c = 0; c < 3; c++)
        d[c] = x[c] - centre[c];
    for (int c = 0; c < 3; c++)
        x[c] = centre[c] + m[3 * c] * d[0] + m[3 * c + 1] * d[1] + m[3 * c + 2] * d[2];
}

/* How far through its motion the target is, 0..1. */
static double share_of(uint32_t number)
{
    const double turns = number / FPS / TURN_S, part = turns - 2.0 * floor(0.5 * turns);
    return part < 1.0 ? part : 2.0 - part;
}

static fixture_pose flexed(double degrees)
{
    fixture_pose pose;
    memset(&pose, 0, sizeof pose);
    pose.seed = 1;
    pose.scale[0] = pose.scale[1] = pose.scale[2] = 1.0f;
    pose.flexion = (float)tan(0.5 * case_radians(degrees));
    return pose;
}

static void place_mesh(const scene *s, uint32_t number, const host_mesh *rest, host_mesh *to)
{
    const double share = share_of(number);
    const int jumped = s->o.jump > 0.0 && number >= s->o.jump;
    for (uint32_t i = 0; i < rest->n_vertices; i++) {
        double x[3], d[3];
        case_get(rest, i, x);
        for (int c = 0; c < 3; c++)
            d[c] = x[c] - s->centre[c];
        const double u = case_dot(d, s->axes) / s->half;
        for (int c = 0; c < 3; c++)
            x[c] += share * s->o.bend * (u * u - 1.0 / 3.0) * s->axes[3 + c];
        turn_about(s->turn_axis, share * s->o.turn, s->centre, x);
        if (jumped)
            turn_about(s->jump_axis, 10.0, s->centre, x);
        for (int c = 0; c < 3; c++)
            x[c] += jumped ? 25.0 * s->jump_way[c] : 0.0;
        case_put(to, i, x);
    }
    if (s->o.flex > 0.0) {
        const fixture_pose pose = flexed(share * s->o.flex);
        fixture_thigh_truth(&pose, to->xyz, to->n_vertices, to->xyz);
    }
}

/* Truths, wholes and targets of a frame. Returns the share of the area that is seen. */
static double make_frame(scene *s, uint32_t number)
{
    double all = 0.0, seen = 0.0;
    for (uint32_t k = 0; k < s->data.n; k++) {
        case_body *const body = &s->data.body[k];
        host_mesh_free(&body->target);
        body->target = case_copy(&s->target[k]);
        place_mesh(s, number, &body->model, &body->truth);
        place_mesh(s, number, &s->whole[k], &body->whole);
        place_mesh(s, number, &s->target[k], &body->target);
        all += case_area(&body->target);
        case_keep_facing(&body->target, s->view, s->o.side);
        seen += case_area(&body->target);
    }
    return seen / all;
}

/* ---- images of 3 x 3 x 6 mm: each stays borrowed until the next one is set */

static void open_image(scene *s)
{
    const float spacing[3] = {3.0f, 3.0f, 6.0f};
    const fixture_pose most = flexed(s->o.flex);
    const uint32_t *const n = s->box.n;
    float low[3], high[3];
    memcpy(low, s->data.body[0].model.xyz, sizeof low);
    memcpy(high, low, sizeof high);
    for (uint32_t k = 0; k < s->data.n; k++) { /* it holds the model wherever that flexes */
        const host_mesh *const mesh = &s->data.body[k].model;
        fixture_thigh_truth(&most, mesh->xyz, mesh->n_vertices, s->xyz[k]);
        fixture_bounds(mesh->xyz, mesh->n_vertices, low, high);
        fixture_bounds(s->xyz[k], mesh->n_vertices, low, high);
    }
    fixture_thigh_init(&s->thigh);
    fixture_thigh_box(low, high, spacing, &s->box);
    for (int i = 0; i < 2; i++)
        s->voxels[i] = case_alloc((size_t)n[0] * n[1] * n[2], 1);
    s->slices = case_alloc(FIXTURE_IMAGE_SCRATCH(n[0], n[1]), sizeof(float));
}

static smr_volume make_image(scene *s, double degrees)
{
    uint8_t *const voxels = s->voxels[1];
    smr_volume view;
    fixture_pose pose = flexed(degrees);
    s->voxels[1] = s->voxels[0];
    s->voxels[0] = voxels;
    if (!(degrees > 0.0))
        fixture_thigh_pose(0, &pose);
    fixture_thigh_slices(&s->thigh, &pose, &s->box, voxels, s->slices);
    memset(&view, 0, sizeof view);
    view.voxels = voxels;
    view.type = SMR_VOXEL_UINT8;
    memcpy(view.size, s->box.n, sizeof view.size);
    memcpy(view.origin, s->box.low, sizeof view.origin);
    memcpy(view.spacing, s->box.spacing, sizeof view.spacing);
    for (int i = 0; i < 3; i++)
        view.direction[4 * i] = 1.0f;
    return view;
}

/* ---- the registration */

/* The start: turned by 3 degrees about the centre and shifted by 3 mm. */
static void begin(scene *s)
{
    smr_config config = s->o.images > 0.0 ? smr_config_default_image() : smr_config_default();
    smr_volume reference;
    smr_pose pose;
    double m[9];
    config.track.mode = SMR_TRACK_RECOVER;
    config.track.ahead = (float)s->o.ahead;
    for (uint32_t k = 0; k < s->data.n; k++)
        config.basic.n_target_vertices += s->o.points > 0.0 ? (uint32_t)s->o.points : s->target[k].n_vertices;
    if (s->o.images > 0.0) {
        open_image(s);
        reference = make_image(s, 0.0);
    }
    case_runner_open(&s->run, &s->data, s->o.images > 0.0 ? &reference : NULL, &config);
    oracle_turn(s->jump_axis, case_radians(3.0), m);
    for (int r = 0; r < 3; r++) {
        double shift = s->centre[r] + 3.0 * s->jump_way[r];
        for (int c = 0; c < 3; c++) {
            pose.m[r][c] = (float)m[3 * r + c];
            shift -= m[3 * r + c] * s->centre[c];
        }
        pose.m[r][3] = (float)shift;
    }
    case_check(smr_set_pose(s->run.s, &pose));
}

static int is_bone(const char *name)
{
    return strcmp(name, "femur") == 0 || strcmp(name, "hip_bone") == 0 || strcmp(name, "patella") == 0;
}

/* A cloud of the frame's own points, as a camera gives them, or the surface. Returns its memory. */
static void *set_target(scene *s, uint32_t number, uint32_t k)
{
    const host_mesh *const target = &s->data.body[k].target;
    const smr_mesh view = host_mesh_view(target);
    const uint32_t n = (uint32_t)s->o.points;
    smr_points *points = NULL;
    void *memory = NULL;
    if (n == 0u) {
        const smr_surface *const surface = host_surface_make(&view, &memory);
        case_check(surface != NULL ? smr_set_surface(s->run.s, k, surface) : SMR_E_ARENA);
        return memory;
    }
    float *const xyz = case_alloc(6u * (size_t)n, sizeof *xyz);
    memory = host_alloc(SMR_POINTS_BYTES(n));
    case_sample(target, n, 0.3, 1000u * k + number, xyz, xyz + 3u * (size_t)n);
    case_spoil(target, s->o.strays, 0.0, 1000u * k + number, xyz, n);
    case_check(smr_points_open(n, memory, SMR_POINTS_BYTES(n), &points));
    case_check(smr_points_add(points, xyz, NULL, NULL, n));
    case_check(smr_set_points(s->run.s, k, points));
    free(xyz);
    return memory;
}

/* Ticks on the frame's targets. */
static void follow(scene *s, uint32_t number, frame *f)
{
    void *memory[CASE_BODIES] = {NULL};
    smr_tick_report report = {0};
    smr_verdict verdict;
    if (s->o.images > 0.0 && number % (uint32_t)s->o.images == 0u) {
        const smr_volume image = make_image(s, share_of(number) * s->o.flex);
        case_check(smr_set_volume(s->run.s, &image));
    }
    for (uint32_t k = 0; k < s->data.n; k++)
        if (!(s->o.images > 0.0) || is_bone(s->data.body[k].name))
            memory[k] = set_target(s, number, k);
    for (f->ticks = 0.0; f->ticks < (number == 0u ? 1000.0 : s->o.ticks) && !report.details.settled && !report.done;
         f->ticks++)
        case_check(smr_tick(s->run.s, 0, &report));
    for (uint32_t k = 0; k < s->data.n; k++)
        case_check(smr_get_positions(s->run.s, k, s->xyz[k]));
    case_check(smr_get_verdict(s->run.s, SMR_ALL, &verdict));
    f->expected = (double)verdict.expected_error_mm;
    case_check(smr_set_surface(s->run.s, SMR_ALL, NULL)); /* their memory goes */
    for (uint32_t k = 0; k < s->data.n; k++)
        free(memory[k]);
    f->jumped = report.details.jumped;
    f->residual = (double)report.residual_mean_mm;
}

static void tell(const char *name, const frame *f, uint32_t first, uint32_t last)
{
    frame mean = {0};
    const double n = last - first;
    for (uint32_t i = first; i < last; i++) {
        mean.surface += f[i].surface / n;
        mean.vertex += f[i].vertex / n;
        mean.expected += f[i].expected / n;
        mean.ticks += f[i].ticks / n;
        mean.residual += f[i].residual / n;
        mean.seen += f[i].seen / n;
        mean.jumped += f[i].jumped;
    }
    (void)printf("%ssurface %.4f\n%svertex %.4f\n", name, mean.surface, name, mean.vertex);
    if (name[0] == '\0')
        (void)printf("expected %.4f\nticks %.1f\nresidual %.4f\nvisible %.3f\njumped %.0f\n", mean.expected, mean.ticks,
                     mean.residual, mean.seen, mean.jumped);
}

/* NAME=VALUE... FILE...: means over the last half of the frames; of the second tenth and the last one, too. */
void case_follow(char **word)
{
    static frame f[MOST];
    scene *const s = case_alloc(1, sizeof *s);
    double value[OPTIONS] = {1.0, 30.0, 5.0, 0.0, 0.0, 180.0, 60.0, 10.0, 6.0, 0.0, 0.0, 0.0, 0.0};
    for (; *word != NULL && strchr(word[0], '=') != NULL; word++)
        for (int k = 0; k < OPTIONS; k++)
            if (strncmp(word[0], names[k], strlen(names[k])) == 0 && word[0][strlen(names[k])] == '=')
                value[k] = atof(strchr(word[0], '=') + 1);
    memcpy(&s->o, value, sizeof value);
    const uint32_t n = (uint32_t)s->o.frames;
    if (n > MOST)
        case_fail("too many frames");
    make_scene(s, word);
    begin(s);
    for (uint32_t i = 0; i < n; i++) {
        f[i] = i > 0u ? f[i - 1u] : f[0];
        f[i].seen = make_frame(s, i);
        follow(s, i, &f[i]);
        if (i % (uint32_t)s->o.every == 0u) {
            const float *const *const xyz = (const float *const *)s->xyz;
            const case_figures figures = case_measure(&s->data, xyz);
            f[i].surface = figures.surface;
            f[i].vertex = figures.vertex;
        }
    }
    tell("", f, n / 2u, n);
    if (n >= 10u) {
        tell("early_", f, n / 10u, n / 5u);
        tell("late_", f, n - n / 10u, n);
    }
}
