/* test_field_normals.c: where vertices go that the target does not show, where a part is all that there is: along
 * normals only, through goals, and through all seen vertices in turn.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include "unit/unit_field.h"

/* Which vertices are controls of a part, in an iteration. */
static uint32_t mark_controls(uint32_t iteration, uint8_t *is_control)
{
    uint32_t n = 0;
    memset(is_control, 0, N);
    w.schedule.iteration = iteration;
    solve();
    for (uint32_t v = 0; v < N; v++)
        for (uint32_t k = 0; k < w.field.n; k++)
            is_control[v] |= memcmp(w.field.start + 3u * k, w.start + 3u * v, 12) == 0;
    for (uint32_t v = 0; v < N; v++)
        n += is_control[v];
    return n;
}

/* What a part shows is told by all its vertices in turn. One that is seen no longer makes way for one other. */
static void controls_take_turns(void **state)
{
    static uint8_t first[N], other[N], ever[N];
    uint32_t n = 0;
    (void)state;
    begin(1.0f);
    w.shared.config.partial.coverage = SMR_COVERAGE_PARTIAL;
    assert_int_equal(mark_controls(0, first), SMR_FIELD_ROWS);
    for (uint32_t v = 0; v < N; v += 13u) {
        uint32_t gone = 0;
        w.seen[v] = 0;
        assert_int_equal(mark_controls(0, other), SMR_FIELD_ROWS);
        for (uint32_t i = 0; i < N; i++)
            gone += first[i] && !other[i];
        w.seen[v] = SMR_VISIBLE_ONE;
        assert_int_equal(gone, first[v]);
    }
    for (uint32_t iteration = 0; iteration < 60u; iteration++) {
        assert_int_equal(mark_controls(iteration, other), SMR_FIELD_ROWS);
        for (uint32_t i = 0; i < N; i++)
            ever[i] |= other[i];
    }
    for (uint32_t i = 0; i < N; i++)
        n += ever[i];
    assert_true(n > N * 3u / 4u);
}

/* Of a part that is all there is, positions along the surface are only what the start left there. */
static smr_vec any_normal(uint32_t i)
{
    const float turn = (float)i * 2.4f, z = 1.0f - 2.0f * (float)i / (float)N, r = sqrtf(1.0f - z * z);
    return smr_v(r * cosf(turn), r * sinf(turn), z);
}

static float mean_off_slid(uint32_t coverage)
{
    begin(1.0f);
    w.shared.config.partial.coverage = coverage;
    for (uint32_t i = 0; i < N; i++) {
        const smr_vec at = bent(w.start + 3u * i), n = any_normal(i), by = smr_v(9, -6, 12);
        smr_store(w.normal + 3u * i, n);
        smr_store(w.x + 3u * i, smr_add(at, smr_sub(by, smr_scale(n, smr_dot(n, by)))));
        w.seen[i] = i % 2u == 0u ? SMR_VISIBLE_ONE : 0u;
    }
    solve();
    assert_int_equal(w.field.n, coverage == SMR_COVERAGE_PARTIAL ? SMR_FIELD_ROWS : SMR_CONTROLS);
    return mean_off();
}

/* All is at rest and the target only pulls: the field is where that leads to, not where the seen vertices are. */
static void goals_are_asked_not_places(void **state)
{
    static int64_t pull[4 * N];
    static uint32_t warm[N], target_warm[1];
    static const smr_surface surface; /* has no triangle that is the closest */
    (void)state;
    begin(1.0f);
    w.shared.config.partial.coverage = SMR_COVERAGE_PARTIAL;
    w.shared.config.basic.attraction = 0.5f;
    w.shared.config.basic.n_workers = 1;
    w.target.surface = &surface;
    w.goals.n_goals = 1;
    w.goals.pull = pull;
    w.goals.warm = warm;
    w.goals.target_warm = target_warm;
    for (uint32_t i = 0; i < N; i++) {
        const smr_vec way = smr_sub(bent(w.start + 3u * i), smr_load(w.start + 3u * i));
        const float each[4] = {way.x, way.y, way.z, 1.0f};
        smr_store(w.normal + 3u * i, any_normal(i));
        w.seen[i] = i % 2u == 0u ? SMR_VISIBLE_ONE : 0u;
        for (uint32_t k = 0; w.seen[i] && k < 4u; k++)
            pull[4u * i + k] = (int64_t)(each[k] * SMR_PULL_SCALE);
    }
    solve();
    const float left = mean_off();
    if (!(left < 1.0f))
        print_error("%g mm off by goals\n", (double)left);
    assert_true(left < 1.0f);
    assert_true(pull[3] == (int64_t)SMR_PULL_SCALE); /* they are left to the search */
}

static void what_slid_is_found_along_normals(void **state)
{
    (void)state;
    const float by_normals = mean_off_slid(SMR_COVERAGE_PARTIAL), by_places = mean_off_slid(SMR_COVERAGE_AUTO);
    if (!(by_normals < 1.0f && by_places > 5.0f))
        print_error("%g mm off by normals, %g by places\n", (double)by_normals, (double)by_places);
    assert_true(by_normals < 1.0f);
    assert_true(by_places > 5.0f);
}

/* Places of a similarity with normals all around, or around the z axis only. */
static void begin_similar(int all_around)
{
    begin(0.1f);
    w.shared.config.partial.coverage = SMR_COVERAGE_PARTIAL;
    for (uint32_t i = 0; i < N; i++) {
        const float turn = (float)i * 2.4f, z = all_around ? 1.0f - 2.0f * (float)i / (float)N : 0.0f;
        const float r = sqrtf(1.0f - z * z);
        smr_store(w.normal + 3u * i, smr_v(r * cosf(turn), r * sinf(turn), z));
        smr_store(w.x + 3u * i, similar(w.start + 3u * i));
    }
    solve();
}

static float way_of(uint32_t i) { return smr_length(smr_sub(similar(w.start + 3u * i), smr_load(w.start + 3u * i))); }

/* A similarity that is known along normals, where x has it: nothing is added to the pose, but for what a start that is
 * far off weighs, a hundredth of the way. What the normals of a pipe do not tell, the way along its axis, is that of
 * the start. */
static void a_similarity_along_normals(void **state)
{
    float along = 0.0f, moved = 0.0f;
    (void)state;
    begin_similar(1);
    for (uint32_t i = 0; i < N; i++)
        assert_true(off(i, similar(w.start + 3u * i)) < 0.01f * way_of(i));
    begin_similar(0);
    for (uint32_t i = 0; i < N; i++) {
        const smr_vec at = carried(i), place = similar(w.start + 3u * i), d = smr_sub(at, place);
        assert_true(smr_length(smr_v(d.x, d.y, 0)) < 0.01f * way_of(i));
        along += at.z - w.start[3u * i + 2u];
        moved += place.z - w.start[3u * i + 2u];
    }
    assert_true(fabsf(along) < 0.2f * fabsf(moved));
}

/* One normal for all, or none: finite, and what that direction does not tell stays as the pose has it. */
static void normals_that_tell_little(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 2u; k++) {
        begin(0.0f);
        w.shared.config.partial.coverage = SMR_COVERAGE_PARTIAL;
        for (uint32_t i = 0; i < N; i++) {
            w.normal[3u * i] = k == 0u ? 1.0f : 0.0f;
            w.x[3u * i] += i % 2u == 0u ? 3.0f : -3.0f;
        }
        solve();
        for (uint32_t i = 0; i < N; i++)
            assert_true(off(i, smr_load(w.start + 3u * i)) < 6.0f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(controls_take_turns),
        cmocka_unit_test(goals_are_asked_not_places),
        cmocka_unit_test(what_slid_is_found_along_normals),
        cmocka_unit_test(a_similarity_along_normals),
        cmocka_unit_test(normals_that_tell_little),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
