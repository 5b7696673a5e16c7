/* test_experiment_verdict.c: whether the verdict can be trusted: 1,000 runs with a known truth, fair, poor and
 * hopeless; what was tuned on even seeds is judged on odd ones. The short form runs one of some kinds.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_expected.h"
#include "case_kinds.h"
#include "case_verdicts.h"

enum { RUNS = 1000 };

static void need_data(void)
{
    if (experiment_data("femurs") == NULL || experiment_data("hip_thigh_vhm") == NULL)
        skip();
}

/* Against tables of the binomial distribution, and ranks counted by hand. */
static void statistics_are_right(void **state)
{
    static const double a[] = {1, 2, 3, 4, 5}, b[] = {1, 4, 9, 16, 25}, c[] = {5, 4, 3, 2, 1}, tied[] = {1, 1, 2, 2, 3};
    (void)state;
    experiment_bound("none of 58, share", fabs(case_upper_bound(0, 58) - 0.05034), 1e-4);
    experiment_bound("2 of 100, share", fabs(case_upper_bound(2, 100) - 0.06162), 1e-4);
    experiment_bound("all of 10, share", fabs(case_upper_bound(10, 10) - 1.0), 0.0);
    experiment_bound("ranks alike", fabs(case_spearman(a, b, 5) - 1.0), 1e-12);
    experiment_bound("ranks reversed", fabs(case_spearman(a, c, 5) + 1.0), 1e-12);
    experiment_bound("ranks with ties", fabs(case_spearman(a, tied, 5) - 0.94868), 1e-4);
    EXPERIMENT_END();
}

/* A result whose vertices are off by more and more, with twice that as the expected error behind another property. */
static void write_result(const case_body *body, const char *path)
{
    FILE *const file = fopen(path, "wb");
    uint32_t i = 0;
    EXPERIMENT_NEED(file != NULL);
    (void)fprintf(file,
                  "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
                  "property float z\nproperty uchar seen\nproperty float expected_error\nend_header\n",
                  body->truth.n_vertices);
    for (i = 0; i < body->truth.n_vertices; i++) {
        const float off = 0.001f * (float)i, told = 2.0f * off;
        const unsigned char seen = 1;
        float p[3];
        memcpy(p, body->truth.xyz + 3u * (size_t)i, sizeof p);
        p[0] += off;
        (void)fwrite(p, sizeof p, 1, file);
        (void)fwrite(&seen, 1, 1, file);
        (void)fwrite(&told, sizeof told, 1, file);
    }
    EXPERIMENT_NEED(fclose(file) == 0);
}

static void expected_errors_are_read(void **state)
{
    const case_options o = case_defaults();
    char directory[CASE_TEXT];
    case_told told;
    (void)state;
    need_data(); /* before memory is taken: it may leave the test */
    case_data *const data = case_alloc(1, sizeof *data);
    (void)snprintf(directory, sizeof directory, "%.900s", experiment_scratch("told"));
    EXPERIMENT_NEED(experiment_directory(directory));
    EXPERIMENT_NEED(case_add(data, experiment_data("hip_thigh_vhm/hip_bone.ply"), HOST_MIRROR_NONE));
    case_make(data, &o);
    write_result(&data->body[0], experiment_scratch("told/hip_bone.ply"));
    told = case_tell(data, directory);
    experiment_bound("ranks of places", 1.0 - told.spearman[0], 1e-3);
    experiment_bound("expected over true", fabs(told.ratio[0] - 2.0), 1e-3);
    experiment_bound("to the surface less is true", 2.1 - told.ratio[1], 0.0);
    case_free(data);
    free(data);
    EXPERIMENT_END();
}

/* One run of a kind: 1 when it was called good. */
static int is_good(const char *kind, uint32_t seed)
{
    case_job *const job = case_alloc(1, sizeof *job);
    case_run *const run = case_alloc(1, sizeof *run);
    char directory[CASE_TEXT], out[CASE_TEXT];
    (void)snprintf(directory, sizeof directory, "%.900s", experiment_scratch("verdict"));
    (void)snprintf(out, sizeof out, "%.900s/out", directory);
    EXPERIMENT_NEED(experiment_directory(directory));
    EXPERIMENT_NEED(case_job_make(job, seed, kind, directory));
    case_register(&job->words, out, run);
    (void)printf("  %-20s %-12s %s %s\n", kind, job->bone, case_text(run, "verdict"), case_text(run, "reasons"));
    case_job_free(job);
    free(job);
    if (run->status == 0)
        assert_string_equal(case_text(run, "verdict"), "good");
    else
        assert_string_not_equal(case_text(run, "verdict"), "good");
    const int good = run->status == 0;
    free(run);
    return good;
}

static void some_kinds(void **state)
{
    static const char *const good[] = {"whole near", "whole exact"};
    static const char *const hopeless[] = {"other bone there", "upside down", "metres", "sphere", "image noise only"};
    size_t i = 0;
    (void)state;
    need_data();
    for (i = 0; i < sizeof good / sizeof good[0]; i++)
        assert_true(is_good(good[i], 1));
    for (i = 0; i < sizeof hopeless / sizeof hopeless[0]; i++)
        assert_false(is_good(hopeless[i], 1));
}

static void is_to_be_trusted(void **state)
{
    char csv[CASE_TEXT];
    case_counts odd;
    (void)state;
    need_data();
    (void)snprintf(csv, sizeof csv, "%.900s", experiment_scratch("verdicts.csv"));
    EXPERIMENT_NEED(case_verdicts(0, RUNS - 1, NULL, experiment_scratch("verdicts"), csv) == 0);
    EXPERIMENT_NEED(case_judge(csv) == 0);
    odd = case_count(csv, 1, 1);
    experiment_bound("called good, of errors above 3 mm, %", 100.0 * odd.far_good / odd.far, 2.0);
    experiment_bound("not called good, of errors below 1 mm, %", 100.0 * odd.near_not / odd.near, 5.0);
    experiment_bound("median Spearman of expected errors falls short by", 0.55 - odd.spearman, 0.0);
    experiment_bound("expected over true mean beyond 0.7..1.5, %", 100.0 - 100.0 * odd.ratios_in / odd.n_ratios, 10.0);
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest quick[] = {
        cmocka_unit_test(statistics_are_right),
        cmocka_unit_test(expected_errors_are_read),
        cmocka_unit_test(some_kinds),
    };
    const struct CMUnitTest full[] = {
        cmocka_unit_test(statistics_are_right),
        cmocka_unit_test(expected_errors_are_read),
        cmocka_unit_test(is_to_be_trusted),
    };
    return experiment_all() ? cmocka_run_group_tests(full, NULL, NULL) : cmocka_run_group_tests(quick, NULL, NULL);
}
