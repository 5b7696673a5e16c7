/* test_unseen_field.c: where vertices go that the target does not show: with a similarity of the seen ones exactly,
 * with a smooth displacement near them, with the pose far from them; along normals only where a part is all there is;
 * controls that determine little or nothing.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "oracle.h"
#include "runtime/forces/forces.h"

enum { N = 5000 }; /* so that controls are chosen in several tasks */

/* A registration of N vertices as far as the field looks at it. Lengths in mm. */
typedef struct world {
    smr_shared shared;
    smr_pace pace;
    smr_shape shape;
    smr_surface_goals goals;
    smr_target target;
    smr_overlay overlay;
    smr_landmark_goals landmarks;
    smr_unseen_field field;
    uint32_t memory[(8u + SMR_FIELD_MOTIONS) * SMR_FIELD_ROWS + SMR_FACTOR_WORDS(SMR_FIELD_ROWS)];
    float start[3 * N], x[3 * N], normal[3 * N];
    uint8_t seen[N];
    struct {
        smr_model head;
        uint16_t owner[N];
    } model; /* of which only the structure of each vertex is asked for */
} world;

static world w; /* each test fills it */

/* Random places in a box of 100 x 60 x 400 mm, at rest; all seen. */
static void begin(float radius)
{
    oracle_random r = oracle_seed(7);
    memset(&w, 0, sizeof w);
    w.shared.n = N;
    w.shared.n_structures = 1;
    w.model.head.at_owner =
        smr_le32((uint32_t)((const unsigned char *)w.model.owner - (const unsigned char *)&w.model));
    w.shared.model = &w.model.head;
    w.target.partial = 1;
    w.pace.lists.radius = radius;
    w.shape.start = w.start;
    w.shape.x = w.x;
    w.shape.normal = w.normal;
    w.shape.start_box = (smr_box){{0, 0, 0}, {100, 60, 400}};
    w.goals.shared = &w.shared;
    w.goals.target = &w.target;
    w.goals.seen = w.goals.seen_next = w.seen;
    w.goals.partial = 1;
    w.overlay.sum = w.memory;
    for (uint32_t i = 0; i < N; i++) {
        const float at[3] = {oracle_uniformf(&r, 0, 100), oracle_uniformf(&r, 0, 60), oracle_uniformf(&r, 0, 400)};
        memcpy(w.start + 3u * i, at, sizeof at);
        memcpy(w.x + 3u * i, at, sizeof at);
        w.normal[3u * i] = 1.0f;
        w.seen[i] = SMR_SEEN_ONE;
    }
    smr_unseen_field_wire(&w.field, &w.shared, &w.pace, &w.shape, &w.goals, &w.landmarks, &w.overlay);
}

static void solve(void)
{
    w.target.n_seen = 0;
    for (uint32_t i = 0; i < N; i++)
        w.target.n_seen += w.seen[i] > SMR_SEEN_ONE / 2u;
    for (uint32_t task = 0; task < smr_unseen_field_tasks(&w.field); task++)
        smr_unseen_field_solve(&w.field, task, 0);
}

/* Where the field carries a vertex. */
static smr_vec carried(uint32_t v)
{
    smr_vec way = smr_v(0, 0, 0);
    const uint8_t seen = w.seen[v];
    w.seen[v] = 0;
    smr_unseen_field_blend(&w.field, v, 1, &way);
    w.seen[v] = seen;
    way = smr_scale(way, w.field.by_normals ? 1.0f / smr_field_normals_step(&w.field) : 1.0f);
    return smr_add(way, smr_load(w.x + 3u * v));
}

static float off(uint32_t v, smr_vec from) { return smr_length(smr_sub(carried(v), from)); }

static smr_vec similar(const float start[3])
{
    float m[9];
    const smr_vec p = smr_load(start);
    static const float axis[3] = {0.6f, 0.0f, 0.8f};
    const float c = cosf(0.7f), s = sinf(0.7f);
    for (uint32_t i = 0; i < 3u; i++)
        for (uint32_t k = 0; k < 3u; k++)
            m[3u * i + k] = (1.0f - c) * axis[i] * axis[k] + (i == k ? c : 0.0f);
    m[1] -= s * axis[2], m[2] += s * axis[1], m[3] += s * axis[2], m[5] -= s * axis[0], m[6] -= s * axis[1],
        m[7] += s * axis[0];
    return smr_v(1.2f * (m[0] * p.x + m[1] * p.y + m[2] * p.z) + 30.0f,
                 1.2f * (m[3] * p.x + m[4] * p.y + m[5] * p.z) - 12.0f,
                 1.2f * (m[6] * p.x + m[7] * p.y + m[8] * p.z) + 5.0f);
}

/* However stiff: the pose explains it all. Only the lower end is seen. */
static void a_similarity_is_exact(void **state)
{
    static const float radius[] = {0.1f, 20.0f, 300.0f};
    (void)state;
    for (uint32_t k = 0; k < 3u; k++) {
        begin(radius[k]);
        for (uint32_t i = 0; i < N; i++) {
            const int low = w.start[3u * i + 2u] < 150.0f;
            w.seen[i] = low ? SMR_SEEN_ONE : 0u;
            if (low)
                smr_store(w.x + 3u * i, similar(w.start + 3u * i));
        }
        solve();
        assert_int_equal(w.field.n, SMR_CONTROLS);
        for (uint32_t i = 0; i < N; i++)
            assert_true(off(i, similar(w.start + 3u * i)) < 2.0e-3f);
    }
}

static smr_vec bent(const float p[3])
{
    return smr_v(p[0] + 6.0f * sinf(0.012f * p[2]), p[1] + 4.0f * cosf(0.01f * p[2] + 0.02f * p[0]), p[2]);
}

static float mean_off(void)
{
    float sum = 0.0f;
    uint32_t n = 0;
    for (uint32_t i = 0; i < N; i++)
        if (w.seen[i] == 0u) {
            sum += off(i, bent(w.start + 3u * i));
            n++;
        }
    return sum / (float)n;
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
            w.seen[i] = i % 2u == 0u ? SMR_SEEN_ONE : 0u;
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
            w.seen[i] = k == 0u && i % 8u == 0u ? 130u : SMR_SEEN_ONE;
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
            w.seen[i] = i < 100u ? SMR_SEEN_ONE : 0u;
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
            w.seen[i] = i < n_seen ? SMR_SEEN_ONE : 0u;
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
    assert_int_equal(smr_unseen_field_tasks(&w.field), 6u + SMR_FIELD_ROWS + 2u);
    w.goals.partial = 0;
    assert_int_equal(smr_unseen_field_tasks(&w.field), 0);
    w.shared.config.coverage = SMR_COVERAGE_WHOLE;
    assert_int_equal(smr_unseen_field_words(&w.shared), 0);
    w.shared.config.track = SMR_TRACK_REPORT;
    assert_int_equal(smr_unseen_field_words(&w.shared), 0);
    w.model.head.profile_samples = smr_le32(20); /* images may be followed */
    assert_int_equal(smr_unseen_field_words(&w.shared), sizeof w.memory / sizeof w.memory[0]);
    w.shared.config.track = SMR_TRACK_OFF;
    w.shared.config.coverage = SMR_COVERAGE_AUTO;
    assert_int_equal(smr_unseen_field_words(&w.shared), sizeof w.memory / sizeof w.memory[0]);
}

/* A seen vertex takes its goal along the normal and the field beside it, an unseen one the field alone. */
static void blends_by_what_is_seen(void **state)
{
    smr_vec way = smr_v(2, 0, 0);
    (void)state;
    begin(1.0f);
    for (uint32_t i = 0; i < N; i++) /* at rest but for vertex 5, which no control is near to */
        w.seen[i] = i != 5u ? SMR_SEEN_ONE : 0u;
    smr_store(w.x + 15, smr_add(smr_load(w.start + 15), smr_v(1, 1, 1)));
    solve();
    w.seen[5] = SMR_SEEN_ONE;
    smr_unseen_field_blend(&w.field, 5, 1, &way);
    assert_true(smr_length(smr_sub(way, smr_v(2, -1, -1))) < 1.0e-3f);
    way = smr_v(2, 0, 0);
    w.seen[5] = 0;
    smr_unseen_field_blend(&w.field, 5, 1, &way);
    assert_true(smr_length(smr_sub(way, smr_v(-1, -1, -1))) < 1.0e-3f);
}

/* While images are followed: controls are what has a goal, from the held shape on; a vertex with one goes along the
 * surface with the field, every other one with the field alone. */
static void follows_images(void **state)
{
    static uint8_t found[N];
    const uint32_t has_image = 1;
    smr_held held = {.box = {{0, 0, 0}, {100, 60, 400}}};
    (void)state;
    begin(1.0f);
    w.goals.partial = w.target.partial = 0;
    w.pace.tracking = 1;
    w.shape.held = &held;
    w.shape.held_x = w.start;
    w.shape.start = NULL;
    smr_unseen_field_watch(&w.field, found, &has_image);
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
        smr_unseen_field_steady(&w.field, i, goal, &way);
        assert_true(smr_length(smr_sub(way, goal ? smr_v(2, -1, -1) : left)) < 5.0e-3f);
    }
    w.pace.tracking = 0;
    assert_int_equal(smr_unseen_field_tasks(&w.field), 0);
}

/* Which vertices are controls of a part, in an iteration. */
static uint32_t mark_controls(uint32_t iteration, uint8_t *is_control)
{
    uint32_t n = 0;
    memset(is_control, 0, N);
    w.pace.iteration = iteration;
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
    w.shared.config.coverage = SMR_COVERAGE_PARTIAL;
    assert_int_equal(mark_controls(0, first), SMR_FIELD_ROWS);
    for (uint32_t v = 0; v < N; v += 13u) {
        uint32_t gone = 0;
        w.seen[v] = 0;
        assert_int_equal(mark_controls(0, other), SMR_FIELD_ROWS);
        for (uint32_t i = 0; i < N; i++)
            gone += first[i] && !other[i];
        w.seen[v] = SMR_SEEN_ONE;
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
    w.shared.config.coverage = coverage;
    for (uint32_t i = 0; i < N; i++) {
        const smr_vec at = bent(w.start + 3u * i), n = any_normal(i), by = smr_v(9, -6, 12);
        smr_store(w.normal + 3u * i, n);
        smr_store(w.x + 3u * i, smr_add(at, smr_sub(by, smr_scale(n, smr_dot(n, by)))));
        w.seen[i] = i % 2u == 0u ? SMR_SEEN_ONE : 0u;
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
    w.shared.config.coverage = SMR_COVERAGE_PARTIAL;
    w.shared.config.attraction = 0.5f;
    w.shared.config.n_workers = 1;
    w.target.surface = &surface;
    w.goals.n_goals = 1;
    w.goals.pull = pull;
    w.goals.warm = warm;
    w.goals.target_warm = target_warm;
    for (uint32_t i = 0; i < N; i++) {
        const smr_vec way = smr_sub(bent(w.start + 3u * i), smr_load(w.start + 3u * i));
        const float each[4] = {way.x, way.y, way.z, 1.0f};
        smr_store(w.normal + 3u * i, any_normal(i));
        w.seen[i] = i % 2u == 0u ? SMR_SEEN_ONE : 0u;
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
    w.shared.config.coverage = SMR_COVERAGE_PARTIAL;
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
        w.shared.config.coverage = SMR_COVERAGE_PARTIAL;
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
        cmocka_unit_test(a_similarity_is_exact),
        cmocka_unit_test(a_smooth_displacement_near_controls),
        cmocka_unit_test(what_is_seen_better_counts_more),
        cmocka_unit_test(degenerate_controls),
        cmocka_unit_test(contradicting_controls),
        cmocka_unit_test(nothing_to_follow),
        cmocka_unit_test(bounds),
        cmocka_unit_test(blends_by_what_is_seen),
        cmocka_unit_test(follows_images),
        cmocka_unit_test(controls_take_turns),
        cmocka_unit_test(goals_are_asked_not_places),
        cmocka_unit_test(what_slid_is_found_along_normals),
        cmocka_unit_test(a_similarity_along_normals),
        cmocka_unit_test(normals_that_tell_little),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
