/* test_unseen_field.c: where vertices go that the target does not show: with a similarity of the seen ones exactly,
 * with a smooth displacement near them, with the pose far from them; controls that determine little or nothing.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include "unit/unit_field.h"

/* However stiff: the pose explains it all. Only the lower end is seen. */
static void a_similarity_is_exact(void **state)
{
    static const float radius[] = {0.1f, 20.0f, 300.0f};
    (void)state;
    for (uint32_t k = 0; k < 3u; k++) {
        begin(radius[k]);
        for (uint32_t i = 0; i < N; i++) {
            const int low = w.start[3u * i + 2u] < 150.0f;
            w.seen[i] = low ? SMR_VISIBLE_ONE : 0u;
            if (low)
                smr_store(w.x + 3u * i, similar(w.start + 3u * i));
        }
        solve();
        assert_int_equal(w.field.n, SMR_CONTROLS);
        for (uint32_t i = 0; i < N; i++)
            assert_true(off(i, similar(w.start + 3u * i)) < 2.0e-3f);
    }
}

/* Every other vertex is seen. A field that is held stiff does less than a loose one, and a pose alone leaves more. */
static void a_smooth_displacement_near_controls(void **state)
{
    float at[3];
    static const float radius[3] = {1.0f, 60.0f, 1.0e4f};
    (void)state;
    for (uint32_t k = 0; k < 3u; k++) {
        begin(radius[k]);
        for (uint32_t i = 0; i < N; i++) {
            smr_store(w.x + 3u * i, bent(w.start + 3u * i));
            w.seen[i] = i % 2u == 0u ? SMR_VISIBLE_ONE : 0u;
        }
        solve();
        at[k] = mean_off();
    }
    if (!(at[0] < 0.25f && at[1] > 1.5f * at[0] && at[2] > 2.0f))
        print_error("%g %g %g mm off\n", (double)at[0], (double)at[1], (double)at[2]);
    assert_true(at[0] < 0.25f); /* of some 4.5 mm */
    assert_true(at[1] > 1.5f * at[0]);
    assert_true(at[2] > 2.0f);
}

/* Half-seen controls hold less than those that are seen in full. */
static void what_is_seen_better_counts_more(void **state)
{
    float moved[2];
    (void)state;
    for (uint32_t k = 0; k < 2u; k++) {
        begin(1.0f);
        for (uint32_t i = 0; i < N; i++) {
            w.seen[i] = k == 0u && i % 8u == 0u ? 130u : SMR_VISIBLE_ONE;
            w.x[3u * i] += i % 8u == 0u ? 8.0f : 0.0f;
        }
        solve();
        moved[k] = 0.0f;
        for (uint32_t i = 0; i < N; i++)
            moved[k] += (carried(i).x - w.start[3u * i]) / N;
    }
    assert_true(moved[0] > 0.0f && moved[0] < 0.999f * moved[1]);
}

/* Controls on a line, in a plane, at one point: nothing but what they say, and everywhere finite. */
static void degenerate_controls(void **state)
{
    (void)state;
    for (uint32_t free_axes = 0; free_axes < 3u; free_axes++) {
        begin(0.0f);
        for (uint32_t i = 0; i < N; i++) {
            w.seen[i] = i < 100u ? SMR_VISIBLE_ONE : 0u;
            for (uint32_t a = free_axes; i < 100u && a < 3u; a++)
                w.start[3u * i + a] = 30.0f;
            smr_store(w.x + 3u * i, smr_add(smr_load(w.start + 3u * i), smr_v(3, -2, 1)));
        }
        solve();
        assert_int_equal(w.field.n, SMR_CONTROLS);
        for (uint32_t i = 0; i < N; i++)
            assert_true(off(i, smr_load(w.x + 3u * i)) < 2.0e-3f); /* not so for NaN */
    }
}

/* The same controls moved against each other: nothing explodes. */
static void contradicting_controls(void **state)
{
    (void)state;
    begin(0.0f);
    for (uint32_t i = 0; i < N; i++) {
        memmove(w.start + 3u * i, w.start, 3u * sizeof *w.start);
        memcpy(w.x + 3u * i, w.start, 3u * sizeof *w.x);
        w.x[3u * i] = w.start[0] + (i % 2u == 0u ? 10.0f : -10.0f);
    }
    solve();
    for (uint32_t i = 0; i < N; i++)
        assert_true(off(i, smr_load(w.start)) < 10.5f);
}

/* With fewer than four controls, or none, what is unseen stays. */
static void nothing_to_follow(void **state)
{
    (void)state;
    for (uint32_t n_seen = 0; n_seen < 6u; n_seen++) {
        begin(1.0f);
        for (uint32_t i = 0; i < N; i++) {
            w.seen[i] = i < n_seen ? SMR_VISIBLE_ONE : 0u;
            w.x[3u * i + 1u] += i < n_seen ? 9.0f : 0.0f;
        }
        solve();
        assert_int_equal(w.field.n, n_seen < 4u ? 0 : n_seen);
        assert_true((off(N - 1u, smr_load(w.x + 3u * (N - 1u))) < 1.0e-6f) == (n_seen < 4u));
    }
}

/* As many controls as there is room for, along all of the seen ones; no tasks where nothing is unseen. */
static void bounds(void **state)
{
    (void)state;
    begin(1.0f);
    for (uint32_t i = 0; i < N; i++)
        w.start[3u * i + 2u] = w.x[3u * i + 2u] = (float)i;
    solve();
    assert_int_equal(w.field.n, SMR_CONTROLS);
    for (uint32_t k = 0; k < SMR_CONTROLS; k++)
        assert_true(fabsf(w.field.start[3u * k + 2u] - (float)(k * N) / (float)SMR_CONTROLS) <= 1.0f);
    assert_int_equal(smr_occluded_field_tasks(&w.field), 6u + SMR_FIELD_TRIES * SMR_TRY_TASKS + SMR_FIELD_ROWS + 2u);
    w.goals.partial = 0;
    assert_int_equal(smr_occluded_field_tasks(&w.field), 0);
    w.shared.config.partial.coverage = SMR_COVERAGE_WHOLE;
    assert_int_equal(smr_occluded_field_words(&w.shared), 0);
    w.shared.config.track.mode = SMR_TRACK_REPORT;
    assert_int_equal(smr_occluded_field_words(&w.shared), 0);
    w.model.head.profile_samples = smr_le32(20); /* images may be followed */
    assert_int_equal(smr_occluded_field_words(&w.shared), sizeof w.memory / sizeof w.memory[0]);
    w.shared.config.track.mode = SMR_TRACK_OFF;
    w.shared.config.partial.coverage = SMR_COVERAGE_AUTO;
    assert_int_equal(smr_occluded_field_words(&w.shared), sizeof w.memory / sizeof w.memory[0]);
}

/* A seen vertex takes its goal along the normal and the field beside it, an unseen one the field alone. */
static void blends_by_what_is_seen(void **state)
{
    smr_vec way = smr_v(2, 0, 0);
    (void)state;
    begin(1.0f);
    for (uint32_t i = 0; i < N; i++) /* at rest but for vertex 5, which no control is near to */
        w.seen[i] = i != 5u ? SMR_VISIBLE_ONE : 0u;
    smr_store(w.x + 15, smr_add(smr_load(w.start + 15), smr_v(1, 1, 1)));
    solve();
    w.seen[5] = SMR_VISIBLE_ONE;
    smr_occluded_field_blend(&w.field, 5, 1, &way);
    assert_true(smr_length(smr_sub(way, smr_v(2, -1, -1))) < 1.0e-3f);
    way = smr_v(2, 0, 0);
    w.seen[5] = 0;
    smr_occluded_field_blend(&w.field, 5, 1, &way);
    assert_true(smr_length(smr_sub(way, smr_v(-1, -1, -1))) < 1.0e-3f);
}

/* While images are followed: controls are what has a goal, from the held shape on; a vertex with one goes along the
 * surface with the field, every other one, and one that has strayed, with the field alone. */
static void follows_images(void **state)
{
    static uint8_t found[N];
    static const uint8_t long_edge[4] = {0, 0, 0xc0, 0x41}; /* 24 mm, little-endian */
    const uint32_t has_image = 1;
    smr_track_rest held = {.box = {{0, 0, 0}, {100, 60, 400}}};
    (void)state;
    begin(20.0f);
    w.goals.partial = w.target.partial = 0;
    w.schedule.tracking = 1;
    w.shape.track_rest = &held;
    w.shape.track_rest_x = w.start;
    w.shape.start = NULL;
    smr_occluded_field_wire_image(&w.field, found, &has_image);
    for (uint32_t i = 0; i < N; i++) {
        found[i] = w.start[3u * i + 2u] < 150.0f ? SMR_FOUND_GOAL : SMR_FOUND_NONE;
        w.seen[i] = 0;
        if (found[i] == SMR_FOUND_GOAL)
            smr_store(w.x + 3u * i, similar(w.start + 3u * i));
    }
    solve();
    assert_int_equal(w.field.n, SMR_CONTROLS);
    for (uint32_t i = 0; i < N; i++) {
        const int goal = found[i] == SMR_FOUND_GOAL;
        const smr_vec place = similar(w.start + 3u * i);
        smr_vec way = smr_v(2, 0, 0);
        if (goal)
            smr_store(w.x + 3u * i, smr_add(place, smr_v(1, 1, 1))); /* slid, and off along the normal */
        const smr_vec left = smr_sub(place, smr_load(w.x + 3u * i));
        assert_int_equal(smr_occluded_field_blend_image(&w.field, i, goal ? SMR_GOAL : SMR_UNDECIDED, &way),
                         goal ? SMR_GOAL : SMR_UNDECIDED);
        assert_true(smr_length(smr_sub(way, goal ? smr_v(2, -1, -1) : left)) < 5.0e-3f);
        smr_store(w.x + 3u * i, smr_add(place, smr_v(15, 15, 0))); /* strayed farther than clusters reach */
        assert_int_equal(smr_occluded_field_blend_image(&w.field, i, SMR_GOAL, &way), SMR_NO_GOAL);
        assert_true(smr_length(smr_add(way, smr_v(15, 15, 0))) < 5.0e-3f);
        w.schedule.lists.radius = 0.0f; /* clusters of one vertex: less than an edge off is no stray */
        memcpy(&w.model.head.edge_mm, long_edge, sizeof w.model.head.edge_mm);
        assert_int_equal(smr_occluded_field_blend_image(&w.field, i, SMR_GOAL, &way), SMR_GOAL);
        w.schedule.lists.radius = 20.0f;
        w.model.head.edge_mm = 0;
    }
    w.schedule.tracking = 0;
    assert_int_equal(smr_occluded_field_tasks(&w.field), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_similarity_is_exact),
        cmocka_unit_test(a_smooth_displacement_near_controls),
        cmocka_unit_test(what_is_seen_better_counts_more),
        cmocka_unit_test(degenerate_controls),
        cmocka_unit_test(contradicting_controls),
        cmocka_unit_test(nothing_to_follow),
        cmocka_unit_test(bounds),
        cmocka_unit_test(blends_by_what_is_seen),
        cmocka_unit_test(follows_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
