/* test_experiment_track.c: targets that move, with a known truth: a femur turns by 30 degrees in 2 s and bends by 5 mm,
 * thirty times a second, seen in whole or to two fifths, by surfaces or points; ten seconds of it; jumps; a computed
 * thigh flexes. Defaults, from a start that is 3 mm and 3 degrees off. The targets have none of the model's vertices.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_motion.h"
#include "experiment.h"

enum { MOST = 300 };

static case_motion_frame frames[MOST];

static const char *const bones[] = {"femurs/femur_2007_5028_left_3k.ply", "femurs/femur_m_right.ply",
                                    "femurs/femur_2008_0019_left_3k.ply", "femurs/femur_vhm_left.ply"};
static const char *const views[] = {"whole", "two fifths"};
static const double sides[] = {180.0, 78.0};

static void need_data(void)
{
    if (experiment_data("femurs") == NULL)
        skip();
}

static void run(const char *bone, const case_motion_options *o)
{
    const char *const file = experiment_data("%s", bone);
    assert_true(o->n_frames <= MOST);
    EXPERIMENT_NEED(case_motion_run(&file, 1, o, frames));
}

/* The last half of the frames. */
static void bound_half(const char *name, const char *view, uint32_t n)
{
    const case_motion_frame mean = case_motion_mean(frames, n / 2u, n);
    char what[120];
    (void)printf("%s, %s (%.0f %%): %.1f ticks a frame, residual %.3f\n", name, view, 100.0 * mean.seen, mean.ticks,
                 mean.residual);
    (void)snprintf(what, sizeof what, "%.30s, %s: surface, mm", name, view);
    experiment_bound(what, mean.surface, 0.6);
    (void)snprintf(what, sizeof what, "%.30s, %s: vertices, mm", name, view);
    experiment_bound(what, mean.vertex, 2.0);
    (void)snprintf(what, sizeof what, "%.30s, %s: frames taken for jumps", name, view);
    experiment_bound(what, mean.jumped, 0.0);
}

static void follow_bone(uint32_t bone, int view, uint32_t n_frames, uint32_t ticks, uint32_t n_points)
{
    case_motion_options o = case_motion_defaults();
    o.n_points = n_points;
    o.noise_mm = 0.3;
    o.side_deg = sides[view];
    o.n_frames = n_frames;
    o.most_ticks = ticks;
    o.every = n_frames / 6u;
    run(bones[bone], &o);
    bound_half(bones[bone] + 7, views[view], n_frames);
}

/* One jump, of a surface or of n_points without normals; 1 when it was found and the model is there after 30 ticks. */
static int jump_bone(uint32_t bone, int view, uint32_t seed, uint32_t n_points)
{
    case_motion_options o = case_motion_defaults();
    int there = 0;
    o.n_points = n_points;
    o.noise_mm = 0.3;
    o.seed = seed;
    o.side_deg = sides[view];
    o.n_frames = 2;
    o.jump_frame = 1;
    o.jump_mm = 25.0;
    o.jump_deg = 10.0;
    o.most_ticks = 30;
    o.every = 1;
    run(bones[bone], &o);
    there = frames[1].jumped && frames[1].surface <= 0.6;
    (void)printf("  %-30s %-10s %4u points, seed %u: jumped %u, surface %.3f, vertices %.3f %s\n", bones[bone] + 7,
                 views[view], n_points, seed, frames[1].jumped, frames[1].surface, frames[1].vertex,
                 there ? "" : "SHORT");
    return there;
}

static void follows_a_side(void **state)
{
    (void)state;
    need_data();
    follow_bone(0, 1, 12, 5, 0);
    EXPERIMENT_END();
}

/* Two ticks a frame: mean distance of vertices from their truth, of which 0.25 mm is no lag. */
static double lag_of(uint32_t bone, int view, float ahead)
{
    case_motion_options o = case_motion_defaults();
    o.side_deg = sides[view];
    o.n_frames = 16;
    o.most_ticks = 2;
    o.every = 1;
    o.config.track.ahead = ahead;
    run(bones[bone], &o);
    return case_motion_mean(frames, 8, 16).vertex;
}

static void goes_ahead(void **state)
{
    const uint32_t n = experiment_all() ? 8 : (experiment_full() ? 2 : 1);
    uint32_t i = 0;
    (void)state;
    need_data();
    for (i = 0; i < n; i++) {
        const int view = (int)(i % 2u);
        const double behind = lag_of(i / 2u, view, 0.0f), ahead = lag_of(i / 2u, view, 1.0f);
        (void)printf("%s, %s: vertices %.3f mm, going ahead %.3f\n", bones[i / 2u] + 7, views[view], behind, ahead);
        experiment_bound("error of vertices, going ahead, share", ahead / behind, view == 0 ? 0.5 : 0.8);
    }
    EXPERIMENT_END();
}

static void recovers_from_a_jump(void **state)
{
    (void)state;
    need_data();
    assert_true(jump_bone(0, 0, 1, 0));
}

static void follows_femurs(void **state)
{
    const uint32_t n = experiment_all() ? 4 : 1;
    uint32_t i = 0;
    int view = 0;
    (void)state;
    need_data();
    for (i = 0; i < n; i++)
        for (view = 0; view < 2; view++) {
            follow_bone(i, view, 60, experiment_all() ? 10 : 5, 0);
            follow_bone(i, view, 60, experiment_all() ? 10 : 5, 500);
        }
    EXPERIMENT_END();
}

static void recovers_from_jumps(void **state)
{
    static const uint32_t points[] = {0, 500};
    const uint32_t n = experiment_all() ? 4 : 1, seeds = experiment_all() ? 3 : 2;
    uint32_t i = 0, seed = 0, k = 0;
    (void)state;
    need_data();
    for (k = 0; k < 4u; k++) {
        const int view = (int)(k % 2u);
        uint32_t there = 0;
        for (i = 0; i < n; i++)
            for (seed = 1; seed <= seeds; seed++)
                there += (uint32_t)jump_bone(i, view, seed, points[k / 2u]);
        (void)printf("%s, %u points: %u of %u are there after 30 ticks\n", views[view], points[k / 2u], there,
                     n * seeds);
        experiment_bound("share of jumps not recovered", 1.0 - there / (double)(n * seeds), 0.0);
    }
    EXPERIMENT_END();
}

/* Ten seconds to and fro: seconds 2 and 10 are of the same motion. */
static void does_not_drift(void **state)
{
    int view = 0;
    (void)state;
    need_data();
    if (!experiment_all())
        skip();
    for (view = 0; view < 2; view++) {
        case_motion_options o = case_motion_defaults();
        case_motion_frame early, late;
        o.side_deg = sides[view];
        o.n_frames = 300;
        o.every = 10;
        run(bones[0], &o);
        early = case_motion_mean(frames, 30, 60);
        late = case_motion_mean(frames, 270, 300);
        (void)printf("%s: second 2 %.3f, %.3f; second 10 %.3f, %.3f\n", views[view], early.surface, early.vertex,
                     late.surface, late.vertex);
        experiment_bound("drift of the surface, mm", late.surface - early.surface, 0.1);
        experiment_bound("drift of the vertices, mm", late.vertex - early.vertex, 0.1);
    }
    EXPERIMENT_END();
}

/* The computed thigh's files. */
static void make_thigh(experiment_command *files)
{
    const char *const folder = experiment_scratch("thigh");
    experiment_command words = {{NULL}, 0};
    experiment_add(&words, "phantom");
    experiment_add(&words, "--small");
    experiment_add(&words, "-o");
    experiment_add(&words, "%s", folder);
    EXPERIMENT_NEED(experiment_run(&words) == 0);
    experiment_add_surfaces(files, experiment_scratch("thigh/model"));
}

/* 24 structures of the computed thigh, flexed by 20 degrees. */
static void follows_a_thigh(void **state)
{
    experiment_command files = {{NULL}, 0};
    case_motion_options o = case_motion_defaults();
    (void)state;
    if (!experiment_all())
        skip();
    make_thigh(&files);
    o.turn_deg = o.bend_mm = 0.0;
    o.flex_deg = 20.0;
    o.every = 10;
    EXPERIMENT_NEED(case_motion_run((const char *const *)files.word, (uint32_t)files.n, &o, frames));
    bound_half("thigh", "whole", o.n_frames);
    experiment_free(&files);
    EXPERIMENT_END();
}

/* The same, its bones by surfaces, or clouds of n_points, in each frame and its muscles by images of 3 x 3 x 6 mm, of
 * every so many frames. */
static void follow_images(const experiment_command *files, uint32_t seed, uint32_t every, int view, uint32_t n_points)
{
    case_motion_options o = case_motion_defaults();
    const uint32_t track = o.config.track.mode;
    case_motion_frame mean;
    char what[120];
    o.seed = seed;
    o.n_points = n_points;
    o.noise_mm = 0.3;
    o.side_deg = sides[view];
    o.turn_deg = o.bend_mm = 0.0;
    o.flex_deg = 20.0;
    o.image_every = every;
    o.every = 6;
    o.config = smr_config_default_image();
    o.config.track.mode = track;
    EXPERIMENT_NEED(case_motion_run((const char *const *)files->word, (uint32_t)files->n, &o, frames));
    mean = case_motion_mean(frames, o.n_frames / 2u, o.n_frames);
    (void)snprintf(what, sizeof what, "thigh by images, seed %u, every %u, %s, %u points: surface, mm", seed, every,
                   views[view], n_points);
    experiment_bound(what, mean.surface, 0.6);
    (void)snprintf(what, sizeof what, "thigh by images, seed %u, every %u, %s, %u points: vertices, mm", seed, every,
                   views[view], n_points);
    experiment_bound(what, mean.vertex, 2.0);
    experiment_bound("thigh by images: frames taken for jumps", mean.jumped, 0.0);
}

static void follows_images(void **state)
{
    /* seed, every, view, points */
    static const uint32_t run[][4] = {{1, 6, 0, 0},    {2, 6, 0, 0},    {1, 3, 0, 0},    {2, 12, 0, 0},
                                      {1, 6, 1, 0},    {1, 6, 0, 1000}, {1, 6, 1, 1000}, {2, 6, 0, 1000},
                                      {2, 6, 1, 1000}, {3, 6, 0, 1000}, {3, 6, 1, 1000}};
    experiment_command files = {{NULL}, 0};
    uint32_t i = 0;
    (void)state;
    if (!experiment_all())
        skip();
    make_thigh(&files);
    for (i = 0; i < sizeof run / sizeof run[0]; i++)
        follow_images(&files, run[i][0], run[i][1], (int)run[i][2], run[i][3]);
    experiment_free(&files);
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest quick[] = {cmocka_unit_test(follows_a_side), cmocka_unit_test(goes_ahead),
                                       cmocka_unit_test(recovers_from_a_jump)};
    const struct CMUnitTest full[] = {cmocka_unit_test(follows_femurs),      cmocka_unit_test(goes_ahead),
                                      cmocka_unit_test(recovers_from_jumps), cmocka_unit_test(does_not_drift),
                                      cmocka_unit_test(follows_a_thigh),     cmocka_unit_test(follows_images)};
    return experiment_full() ? cmocka_run_group_tests(full, NULL, NULL) : cmocka_run_group_tests(quick, NULL, NULL);
}
