/* test_unseen_field.c: where vertices go that the target does not show: with a similarity of the seen ones exactly;
 * controls that determine little or nothing.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "oracle.h"
#include "geometry/gaussian_process/gaussian_process.h"
#include "registration/goals/external_forces.h"

enum { N = 5000 }; /* so that controls are chosen in several tasks */

/* A registration of N vertices as far as the field looks at it. Lengths in mm. */
typedef struct world {
    smr_shared shared;
    smr_schedule schedule;
    smr_shape shape;
    smr_surface_goals goals;
    smr_target target;
    smr_overlay overlay;
    smr_landmark_goals landmarks;
    smr_occluded_field field;
    uint32_t memory[(9u + SMR_FIELD_MOTIONS) * SMR_FIELD_ROWS + SMR_FACTOR_WORDS(SMR_FIELD_ROWS)];
    float start[3 * N], x[3 * N], normal[3 * N];
    uint8_t seen[N];
    struct {
        smr_model head;
        uint16_t owner[N];
    } model; /* of which only the structure of each vertex is asked for */
} world;

static world w; /* each test fills it */

static const uint32_t none = 0; /* no image, no vertex that it does not show */

/* Random places in a box of 100 x 60 x 400 mm, at rest; all seen. */
static void begin(float radius)
{
    oracle_random r = oracle_seed(7);
    memset(&w, 0, sizeof w);
    w.shared.n = N;
    w.shared.n_structures = 1;
    w.model.head.at_owner =
        smr_le32((uint32_t)((const unsigned char *)w.model.owner - (const unsigned char *)&w.model));
    w.model.head.n_structures = smr_le32(1);
    w.shared.model = &w.model.head;
    w.target.partial = 1;
    w.schedule.lists.radius = radius;
    w.shape.start = w.start;
    w.shape.x = w.x;
    w.shape.normal = w.normal;
    w.shape.start_box = (smr_box){{0, 0, 0}, {100, 60, 400}};
    w.goals.shared = &w.shared;
    w.goals.target = &w.target;
    w.goals.visibility = w.goals.visibility_next = w.seen;
    w.goals.partial = 1;
    w.overlay.sum = w.memory;
    w.field.found = NULL;
    w.field.has_image = w.field.n_invisible = &none;
    for (uint32_t i = 0; i < N; i++) {
        float at[3];
        oracle_within_box(&r, 0, 100, at);
        at[1] *= 0.6f;
        at[2] *= 4.0f;
        memcpy(w.start + 3u * i, at, sizeof at);
        memcpy(w.x + 3u * i, at, sizeof at);
        w.normal[3u * i] = 1.0f;
        w.seen[i] = SMR_VISIBLE_ONE;
    }
    w.field.shared = &w.shared;
    w.field.schedule = &w.schedule;
    w.field.shape = &w.shape;
    w.field.goals = &w.goals;
    w.field.landmarks = &w.landmarks;
    smr_occluded_field_wire(&w.field, &w.overlay);
}

static void solve(void)
{
    w.target.n_visible = 0;
    for (uint32_t i = 0; i < N; i++)
        w.target.n_visible += w.seen[i] > SMR_VISIBLE_ONE / 2u;
    for (uint32_t task = 0; task < smr_occluded_field_tasks(&w.field); task++)
        smr_occluded_field_solve(&w.field, task, 0);
}

/* Where the field carries a vertex. */
static smr_vec carried(uint32_t v)
{
    smr_vec way = smr_v(0, 0, 0);
    const uint8_t seen = w.seen[v];
    w.seen[v] = 0;
    smr_occluded_field_blend(&w.field, v, 1, &way);
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

/* However stiff: the pose explains it all. Only the lower end is seen. */
TEST(a_similarity_is_exact)
{
    static const float radius[] = {0.1f, 20.0f, 300.0f};
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

/* Controls on a line, in a plane, at one point: nothing but what they say, and everywhere finite. */
TEST(degenerate_controls)
{
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

/* Three seen vertices carry nothing, four carry the rest along. */
TEST(fewest_controls)
{
    static const uint32_t seen[] = {0, 1, 3, 4, 5};
    for (uint32_t k = 0; k < 5u; k++) {
        const int enough = seen[k] >= 4u;
        begin(1.0f);
        for (uint32_t i = 0; i < N; i++) {
            w.seen[i] = i % 313u == 0u && i / 313u < seen[k] ? SMR_VISIBLE_ONE : 0u;
            if (w.seen[i] != 0u)
                smr_store(w.x + 3u * i, smr_add(smr_load(w.start + 3u * i), smr_v(3, -2, 1)));
        }
        solve();
        assert_int_equal(w.field.n, enough ? w.target.n_visible : 0u);
        for (uint32_t i = 1; i < N; i++)
            if (w.seen[i] == 0u)
                assert_true(off(i, smr_add(smr_load(w.x + 3u * i), enough ? smr_v(3, -2, 1) : smr_v(0, 0, 0))) <
                            2.0e-3f);
    }
}

/* As many controls as there is room for, along all of the seen ones; no tasks where nothing is unseen. */
TEST(bounds)
{
    begin(1.0f);
    for (uint32_t i = 0; i < N; i++)
        w.start[3u * i + 2u] = w.x[3u * i + 2u] = (float)i;
    solve();
    assert_int_equal(w.field.n, SMR_CONTROLS);
    for (uint32_t k = 0; k < SMR_CONTROLS; k++)
        assert_true(fabsf(w.field.start[3u * k + 2u] - (float)(k * N) / (float)SMR_CONTROLS) <= 1.0f);
    const uint32_t n_tasks = 20u + 4u * (SMR_FIELD_ROWS / 4u) + SMR_FIELD_TRIES * SMR_TRY_TASKS + SMR_FIELD_ROWS + 1u;
    assert_int_equal(smr_occluded_field_tasks(&w.field), n_tasks);
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
    for (uint32_t n = 1; n <= 2u; n++) { /* a row for each landmark beside fewer vertices */
        const uint32_t rows = SMR_CONTROLS + n;
        w.shared.config.partial.n_landmarks = n;
        smr_occluded_field_wire(&w.field, &w.overlay);
        assert_int_equal(rows, w.field.most);
        assert_int_equal((9u + SMR_FIELD_MOTIONS) * rows + SMR_FACTOR_WORDS(rows), smr_occluded_field_words(&w.shared));
    }
}

/* While images are followed: controls are what has a goal, from the held shape on; a vertex with one goes along the
 * surface with the field, every other one, and one that has strayed, with the field alone. */
TEST(follows_images)
{
    static uint8_t found[N];
    static const uint8_t long_edge[4] = {0, 0, 0xc0, 0x41}; /* 24 mm, little-endian */
    const uint32_t has_image = 1, n_invisible = 0;
    smr_track_rest held = {.box = {{0, 0, 0}, {100, 60, 400}}};
    begin(20.0f);
    w.goals.partial = w.target.partial = 0;
    w.schedule.tracking = 1;
    w.shape.track_rest = &held;
    w.shape.track_rest_x = w.start;
    w.shape.start = NULL;
    w.field.found = found;
    w.field.has_image = &has_image;
    w.field.n_invisible = &n_invisible;
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

TEST(what_slid_is_found_along_normals)
{
    const float by_normals = mean_off_slid(SMR_COVERAGE_PARTIAL), by_places = mean_off_slid(SMR_COVERAGE_AUTO);
    if (!(by_normals < 1.0f && by_places > 5.0f))
        fail_msg("%g mm off by normals, %g by places", (double)by_normals, (double)by_places);
}

/* The share of roughness that the field finds in waves of this length, mm, along normals. */
static float roughness_of(float wave, float mm)
{
    begin(1.0f);
    w.shared.config.partial.coverage = SMR_COVERAGE_PARTIAL;
    for (uint32_t i = 0; i < N; i++) {
        const smr_vec at = smr_load(w.start + 3u * i), n = any_normal(i);
        const float phase = 6.2831853f / wave;
        smr_store(w.normal + 3u * i, n);
        smr_store(w.x + 3u * i,
                  smr_add(at, smr_v(mm * sinf(phase * at.y), mm * sinf(phase * at.z), mm * sinf(phase * at.x))));
        w.seen[i] = i % 2u == 0u ? SMR_VISIBLE_ONE : 0u;
    }
    solve();
    return w.field.rough;
}

TEST(short_waves_are_rough)
{
    assert_true(roughness_of(2000, 6) == 0.0f && roughness_of(400, 6) == 0.0f);
    assert_true(roughness_of(60, 6) > 0.0f && roughness_of(20, 6) > 0.0f);
}
