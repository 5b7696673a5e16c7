/* test_field_roughness.c: how rough the field of a part takes a deformation to be: a smooth one is smooth, one with
 * short waves is not, and then the smooth part of it is carried less far beyond what is seen.
 * SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit_field.h"

enum { TASKS_BEFORE_TRIES = 7 }; /* vertices are counted and chosen in three tasks each; then the pose */

/* The upper 40 % of the places seen, bent, with waves of 80 mm and this height. Returns how far
 * the lowest tenth is carried from where it belongs, mm. tries: 0: the deformation is taken for smooth. */
static float lowest_off(float height, int tries)
{
    float sum = 0.0f, count = 0.0f;
    oracle_random r = oracle_seed(11);
    begin(0.1f);
    w.shared.config.partial.coverage = SMR_COVERAGE_PARTIAL;
    for (uint32_t i = 0; i < N; i++) {
        double d[3] = {oracle_uniform(&r, -1, 1), oracle_uniform(&r, -1, 1), oracle_uniform(&r, -1, 1)};
        const smr_vec n = smr_v((float)d[0], (float)d[1], (float)d[2]), p = smr_load(w.start + 3u * i);
        const smr_vec unit = smr_scale(n, 1.0f / smr_length(n));
        const smr_vec wave = smr_v(sinf(0.07f * p.y + 0.05f * p.z), cosf(0.07f * p.z), sinf(0.08f * p.x - 0.04f * p.z));
        smr_store(w.normal + 3u * i, unit);
        smr_store(w.x + 3u * i, smr_add(bent(w.start + 3u * i), smr_scale(wave, height)));
        w.seen[i] = p.z > 240.0f ? SMR_VISIBLE_ONE : 0u;
    }
    w.target.n_visible = N;
    for (uint32_t task = 0; task < smr_occluded_field_tasks(&w.field); task++)
        if (tries || task <= TASKS_BEFORE_TRIES || task >= TASKS_BEFORE_TRIES + SMR_FIELD_TRIES * SMR_TRY_TASKS)
            smr_occluded_field_solve(&w.field, task, 0);
    for (uint32_t i = 0; i < N; i++)
        if (w.start[3u * i + 2u] < 40.0f) {
            sum += off(i, bent(w.start + 3u * i));
            count += 1.0f;
        }
    return sum / count;
}

static void a_smooth_bend_is_smooth(void **state)
{
    (void)state;
    (void)lowest_off(0.0f, 1);
    assert_true(w.field.rough == 0.0f && w.field.rough_noise == 0.0f);
    assert_true(w.field.motion_variance == SMR_MOTION_VARIANCE);
}

static void short_waves_are_rough(void **state)
{
    (void)state;
    (void)lowest_off(4.0f, 1);
    assert_true(w.field.rough > 0.0f && w.field.rough_noise > 0.0f);
    assert_true(w.field.motion_variance > SMR_MOTION_VARIANCE);
}

/* Taken for smooth they would turn and stretch the whole. */
static void what_is_rough_is_not_carried_far(void **state)
{
    (void)state;
    const float smooth = lowest_off(4.0f, 0);
    assert_true(w.field.rough == 0.0f);
    const float rough = lowest_off(4.0f, 1);
    if (!(rough < 0.9f * smooth))
        print_error("%g mm off, %g when taken for smooth\n", (double)rough, (double)smooth);
    assert_true(rough < 0.9f * smooth);
}

/* Too few say nothing of it. */
static void with_few_controls_all_is_smooth(void **state)
{
    (void)state;
    begin(0.1f);
    w.shared.config.partial.coverage = SMR_COVERAGE_PARTIAL;
    for (uint32_t i = 0; i < N; i++) {
        smr_store(w.normal + 3u * i, smr_v(i % 3u == 0u, i % 3u == 1u, i % 3u == 2u));
        w.x[3u * i] += i % 2u == 0u ? 3.0f : -3.0f;
        w.seen[i] = i < 30u ? SMR_VISIBLE_ONE : 0u;
    }
    solve();
    assert_true(w.field.n == 30u && w.field.rough == 0.0f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_smooth_bend_is_smooth),
        cmocka_unit_test(short_waves_are_rough),
        cmocka_unit_test(what_is_rough_is_not_carried_far),
        cmocka_unit_test(with_few_controls_all_is_smooth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
