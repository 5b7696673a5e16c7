/* test_landmarks.c: landmarks bind to the model, draw it, and are refused where they are wrong.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/rig_ball_image.h"
#include "registration/registration.h"

enum { N = 6, LOG = 65536 };

static smr_mesh ball[2];
static const smr_model *model;

static smr_config config_of(uint32_t n_landmarks)
{
    smr_config c = smr_config_default();
    c.partial.n_landmarks = n_landmarks;
    c.basic.iterations_last = 30;
    return c;
}

/* Two balls beside each other. */
static smr *start(uint32_t n_landmarks, const smr_port *port)
{
    const smr_prepare_config radii = rig_radii(2, 30, 0.1f, 0);
    const float at[2][3] = {{0, 0, 0}, {60, 0, 0}};
    smr_config config = config_of(n_landmarks);
    config.basic.n_workers = port != NULL ? port->n_workers : 1u;
    for (uint32_t i = 0; i < 2u; i++)
        ball[i] = rig_ball(20, 8, 12, at[i]);
    model = rig_model(ball, 2, &radii);
    return rig_init(model, &config, port);
}

/* Vertices of the first ball, spread, and where they go: turned a little and pulled out. */
static void marks(smr_landmark mark[N], uint32_t hard)
{
    float m[9];
    rig_rotation(1, 2, 3, 6, m);
    for (uint32_t i = 0; i < N; i++) {
        const uint32_t v = i * (ball[0].n_vertices - 1u) / (N - 1u);
        const float *p = ball[0].xyz + 3u * (size_t)v;
        mark[i] = (smr_landmark){0, v, {0, 0, 0}, {0, 0, 0}, 1.0f, hard};
        for (uint32_t c = 0; c < 3u; c++)
            mark[i].place[c] =
                m[3u * c] * p[0] + m[3u * c + 1u] * p[1] + m[3u * c + 2u] * p[2] + 0.005f * p[2] * p[2] * (float)c;
    }
}

static float farthest(const smr *s, const smr_landmark *mark, uint32_t n)
{
    float xyz[SMR_LANDMARKS_MAX][3], most = 0.0f;
    assert_int_equal(SMR_OK, smr_get_landmarks(s, xyz[0]));
    for (uint32_t i = 0; i < n; i++)
        most = fmaxf(most, rig_far(xyz[i], mark[i].place, 1));
    return most;
}

/* Points that replace each other in one slot are where the newest is, on a model with triangles and without. */
TEST(test_replaced)
{
    static const float turn[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
    static const struct {
        uint32_t structure, vertex;
        float rest[3];
    } all[] = {{0, 5, {0, 0, 0}},
               {0, 6, {0, 0, 0}},
               {1, 6, {0, 0, 0}},
               {1, SMR_NONE, {60, 0, 21}},
               {1, SMR_NONE, {60, 0, -18}},
               {0, SMR_NONE, {0, 0, -18}},
               {SMR_ALL, SMR_NONE, {0, 0, -18}},
               {SMR_ALL, SMR_NONE, {62, 3, 15}},
               {0, 5, {62, 3, 15}}};
    for (uint32_t faces = 0; faces < 2u; faces++) {
        const smr_prepare_config radii = rig_radii(2, 30, 0.1f, 0);
        const smr_config config = config_of(1);
        const smr_pose pose = {
            {{turn[0], turn[1], turn[2], 0}, {turn[3], turn[4], turn[5], 100}, {turn[6], turn[7], turn[8], 7}}};
        (void)start(0, NULL); /* the balls */
        smr_mesh parts[2] = {ball[0], ball[1]};
        for (uint32_t i = 0; i < 2u; i++)
            if (!faces)
                parts[i] = (smr_mesh){ball[i].xyz, NULL, ball[i].n_vertices, 0};
        smr *s = rig_init(rig_model(parts, 2, &radii), &config, NULL);
        for (uint32_t i = 0; i < sizeof all / sizeof all[0]; i++)
            for (uint32_t again = 0; again < 2u; again++) { /* the same point at a new place */
                smr_landmark mark = {all[i].structure, all[i].vertex, {0, 0, 0}, {(float)again, 0, 0}, 1.0f, 0};
                const float *p =
                    all[i].vertex == SMR_NONE ? all[i].rest : ball[all[i].structure % 2u].xyz + 3u * all[i].vertex;
                const float to[3] = {-p[1], p[0] + 100.0f, p[2] + 7.0f};
                float xyz[3];
                memcpy(mark.rest, all[i].rest, sizeof mark.rest);
                assert_int_equal(SMR_OK, smr_set_landmarks(s, &mark, 1));
                assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
                assert_int_equal(SMR_OK, smr_get_landmarks(s, xyz));
                assert_true(rig_far(xyz, to, 1) < 1.0e-3f);
            }
    }
}

/* On a model without triangles a point belongs to the vertex nearest to it at rest, and goes where that vertex goes. */
TEST(test_goes_with_the_nearest_vertex)
{
    enum { NEAREST = 30 };
    const smr_config config = config_of(1);
    (void)start(0, NULL); /* the balls */
    const smr_mesh points = {ball[0].xyz, NULL, ball[0].n_vertices, 0};
    smr *s = rig_init(rig_model(&points, 1, NULL), &config, NULL);
    smr_landmark mark = {0, SMR_NONE, {0, 0, 0}, {0, 0, 0}, 1.0f, 0};
    float xyz[3], *const x = (float *)(uintptr_t)points.xyz;
    memcpy(mark.rest, x + 3u * NEAREST, sizeof mark.rest);
    assert_int_equal(SMR_OK, smr_set_landmarks(s, &mark, 1));
    x[3u * NEAREST] += 5.0f;
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, x));
    assert_int_equal(SMR_OK, smr_get_landmarks(s, xyz));
    assert_true(rig_far(xyz, x + 3u * NEAREST, 1) < 1.0e-4f);
}

/* Nothing is left of the landmark that another one replaces. */
TEST(test_replaced_is_forgotten)
{
    static unsigned char save[2][1 << 20];
    size_t bytes[2];
    for (uint32_t i = 0; i < 2u; i++) {
        const smr_landmark first = {1, i ? SMR_NONE : 7u, {60, 0, 19}, {60, 0, 30}, 1.0f, 0};
        const smr_landmark second = {0, 5, {0, 0, 0}, {0, 3, 25}, 1.0f, 1};
        smr *s = start(1, NULL);
        assert_int_equal(SMR_OK, smr_set_landmarks(s, &first, 1));
        assert_int_equal(SMR_OK, smr_set_landmarks(s, &second, 1));
        assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes[i]));
        assert_int_equal(SMR_OK, smr_save(s, save[i], sizeof save[i]));
    }
    assert_int_equal(bytes[0], bytes[1]);
    assert_memory_equal(save[0], save[1], bytes[0]);
}

TEST(test_refused)
{
    smr *s = start(N, NULL);
    const uint64_t before = smr_state_hash(s);
    smr_landmark mark[N + 1], bad;
    float xyz[N][3];
    marks(mark, 0);
    mark[N] = mark[0];
    assert_int_equal(SMR_E_NULL, smr_set_landmarks(NULL, mark, 1));
    assert_int_equal(SMR_E_NULL, smr_set_landmarks(s, NULL, 1));
    assert_int_equal(SMR_E_NULL, smr_get_landmarks(s, NULL));
    assert_int_equal(SMR_E_ARENA, smr_set_landmarks(s, mark, N + 1));
    assert_int_equal(SMR_E_ARENA, smr_set_landmarks(start(0, NULL), mark, 1));
    const struct {
        uint32_t structure, vertex, hard;
        float rest, place, weight;
    } wrong[] = {{2, 0, 0, 0, 0, 1},          {0, 100000, 0, 0, 0, 1},   {SMR_ALL, 0, 0, 0, 0, 1},
                 {0, 0, 2, 0, 0, 1},          {0, 0, 0, 0, 0, 0},        {0, 0, 0, 0, 0, NAN},
                 {0, 0, 0, 0, 0, 1001},       {0, 0, 0, 0, INFINITY, 1}, {SMR_ALL, SMR_NONE, 0, NAN, 0, 1},
                 {0, SMR_NONE, 1, 2e5f, 0, 1}};
    assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, 1));
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        bad = (smr_landmark){wrong[i].structure,     wrong[i].vertex, {0, wrong[i].rest, 0},
                             {0, 0, wrong[i].place}, wrong[i].weight, wrong[i].hard};
        assert_int_equal(SMR_E_INPUT, smr_set_landmarks(s, &bad, 1));
    }
    assert_int_equal(1, s->forces.landmarks.n); /* the one before stays */
    assert_int_equal(SMR_OK, smr_get_landmarks(s, xyz[0]));
    assert_true(rig_far(xyz[0], ball[0].xyz, 1) < 1e-5f && smr_state_hash(s) == before);
    assert_int_equal(SMR_OK, smr_set_landmarks(s, NULL, 0));
    assert_int_equal(0, s->forces.landmarks.n);
}

/* A point on a triangle, one off it, and one of whichever structure is nearest, are where they were given at rest, and
 * go with the model. */
TEST(test_bound)
{
    static const float point[3][3] = {{0, 19.5f, 1}, {0, 26, 0}, {60, 1, 27}};
    const smr_pose pose = {{{0, -1, 0, 5}, {1, 0, 0, 6}, {0, 0, 1, 7}}};
    smr *s = start(3, NULL);
    smr_landmark mark[3];
    float xyz[3][3];
    for (uint32_t i = 0; i < 3u; i++) {
        mark[i] = (smr_landmark){i == 2u ? SMR_ALL : 0, SMR_NONE, {0, 0, 0}, {0, 0, 0}, 1.0f, 0};
        memcpy(mark[i].rest, point[i], sizeof mark[i].rest);
    }
    assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, 3));
    assert_int_equal(SMR_OK, smr_get_landmarks(s, xyz[0]));
    assert_true(rig_far(xyz[0], point[0], 3) < 1e-4f);
    assert_int_equal(1, smr_model_owner(model, s->forces.landmarks.landmark[2].corner[0]));
    assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
    assert_int_equal(SMR_OK, smr_get_landmarks(s, xyz[0]));
    for (uint32_t i = 0; i < 3u; i++) {
        const float to[3] = {5 - point[i][1], 6 + point[i][0], 7 + point[i][2]};
        assert_true(rig_far(xyz[i], to, 1) < 1e-3f);
    }
}

TEST(test_draw)
{
    for (uint32_t hard = 0; hard < 2u; hard++) {
        smr *s = start(N, NULL);
        smr_landmark mark[N];
        smr_structure_report own, other;
        unsigned char *seen = rig_alloc(ball[0].n_vertices);
        float *mm = rig_alloc(ball[0].n_vertices * sizeof(float));
        uint32_t n_seen = 0;
        smr_verdict verdict;
        marks(mark, hard);
        assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, N));
        const smr_tick_report report = rig_run(s, 1000);
        assert_true(report.done && report.n_forces == N && report.details.matched_share > 0.0f);
        assert_true(farthest(s, mark, N) < (hard ? 0.01f : 0.2f));
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &own));
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 1, &other));
        assert_true(own.has_target == 1u && own.n_forces == N && other.has_target == 0u && other.moved_mean_mm > 0.5f);
        assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &verdict));
        assert_true(verdict.expected_error_mm > 0.0f && verdict.residual_mm < 0.2f);
        assert_int_equal(SMR_OK, smr_get_visible(s, 0, seen));
        for (uint32_t i = 0; i < ball[0].n_vertices; i++)
            n_seen += seen[i];
        assert_int_equal(N, n_seen);
        assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, mm));
        for (uint32_t i = 0; i < N; i++) /* less is left open where the landmarks are */
            assert_true(mm[mark[i].vertex] < verdict.expected_error_mm);
    }
}

/* Landmarks far off the surface, as the centre of a joint is, reach their places, too. */
TEST(test_far_off_the_surface)
{
    for (uint32_t k = 0; k < 6u; k++) {
        smr *s = start(N, NULL);
        smr_landmark mark[N];
        float turn[9];
        rig_rotation(1, 2, 3, 6, turn);
        marks(mark, k % 2u);
        for (uint32_t i = 0; i < N; i++) {
            mark[i].vertex = SMR_NONE;
            memcpy(mark[i].rest, ball[0].xyz + 3u * (size_t)(i * (ball[0].n_vertices - 1u) / (N - 1u)),
                   sizeof mark[i].rest);
            for (uint32_t c = 0; c < 3u; c++)
                mark[i].rest[c] *= (float)(2u + k / 2u);
            for (uint32_t c = 0; c < 3u; c++)
                mark[i].place[c] = turn[3u * c] * mark[i].rest[0] + turn[3u * c + 1u] * mark[i].rest[1] +
                                   turn[3u * c + 2u] * mark[i].rest[2] + 2.0f;
        }
        assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, N));
        (void)rig_run(s, 1000);
        assert_true(farthest(s, mark, N) < 0.05f);
    }
}

/* One landmark shifts, and too few for a field say so. */
TEST(test_few)
{
    smr *s = start(N, NULL);
    const smr_landmark mark = {0, 0, {0, 0, 0}, {3, 4, 25}, 1.0f, 1};
    smr_verdict verdict;
    assert_int_equal(SMR_OK, smr_set_landmarks(s, &mark, 1));
    assert_true(rig_run(s, 1000).done);
    assert_true(farthest(s, &mark, 1) < 0.01f);
    const float *xyz = rig_positions(s, model);
    for (uint32_t i = 0; i < ball[0].n_vertices; i++) {
        const float to[3] = {ball[0].xyz[3u * i] + 3.0f - ball[0].xyz[0],
                             ball[0].xyz[3u * i + 1u] + 4.0f - ball[0].xyz[1],
                             ball[0].xyz[3u * i + 2u] + 25.0f - ball[0].xyz[2]};
        assert_true(rig_far(xyz + 3u * (size_t)i, to, 1) < 0.05f);
    }
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &verdict));
    assert_true(verdict.expected_error_mm < 0.0f && verdict.level == SMR_VERDICT_LOOK);
    assert_true((verdict.reasons & SMR_REASON_LITTLE_VISIBLE) != 0u);
}

/* Where the search in the image has ended, vertices that it showed stay: only a hard landmark moves them. */
TEST(test_image_no_longer_searched)
{
    const smr_volume image = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    model = rig_ball_model(&image);
    for (uint32_t hard = 0; hard < 2u; hard++) {
        const smr_landmark mark = {0, SMR_NONE, {0, 0, 20}, {0, 0, 40}, 1.0f, hard};
        smr_config c = smr_config_default_image();
        uint32_t shown = 0, forced = 0;
        c.image.gradient_mm = c.image.profile_mm = 4.0f;
        c.image.gradient_end_mm = c.image.profile_end_mm = 0.0f;
        c.motion.settle_um = 0.0f;
        c.partial.n_landmarks = 1;
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_volume(s, &image));
        assert_int_equal(SMR_OK, smr_set_landmarks(s, &mark, 1));
        do
            assert_false(rig_run(s, 1).done);
        while (smr_image_seeks(&s->forces.image, 0));
        for (uint32_t v = 0; v < s->shared.n; v++) {
            const float *f = s->forces.force + 3u * (size_t)v;
            shown += s->forces.landmarks.visibility[v] > 0u;
            forced += s->forces.landmarks.visibility[v] > 0u && (f[0] != 0.0f || f[1] != 0.0f || f[2] != 0.0f);
        }
        assert_true(shown > 200u && (hard ? forced > 0u && forced < shown / 4u : forced == 0u));
    }
}

/* Returns the mean expected error of the first ball, bent, of which a surface shows half, and n landmarks the rest. */
static float expected_with(uint32_t n)
{
    smr *s = start(N, NULL);
    smr_mesh half = rig_ball(20, 8, 12, (const float[3]){0, 0, 0});
    float *const xyz = (float *)(uintptr_t)half.xyz, mm[400], sum = 0.0f;
    smr_landmark mark[N];
    for (uint32_t v = 0; v < half.n_vertices; v++)
        xyz[3u * v] += 0.01f * xyz[3u * v + 2u] * xyz[3u * v + 2u];
    for (uint32_t i = 0; i < n; i++) { /* the last vertices are in the last triangles */
        const uint32_t v = half.n_vertices - 1u - 7u * i;
        mark[i] = (smr_landmark){0, v, {0, 0, 0}, {0, 0, 0}, 1.0f, 0};
        memcpy(mark[i].place, xyz + 3u * (size_t)v, sizeof mark[i].place);
    }
    half.n_triangles /= 2u;
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&half)));
    assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, n));
    (void)rig_run(s, 400);
    assert_true(half.n_vertices <= 400u);
    assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, mm));
    for (uint32_t v = 0; v < half.n_vertices; v++)
        sum += mm[v] / (float)half.n_vertices;
    return sum;
}

/* Expected errors know landmarks where a surface does not show the model. */
TEST(test_expected_beside_a_surface)
{
    const float without = expected_with(0), with = expected_with(N);
    assert_true(without > 0.0f && with > 0.0f && with < 0.8f * without);
}

/* A landmark draws a model of a single vertex, and is saved and restored. */
TEST(test_single_vertex)
{
    const float at[3] = {3, 4, 5};
    const smr_mesh point = {at, NULL, 1, 0};
    const smr_landmark mark = {0, 0, {0, 0, 0}, {5, 4, 5}, 1.0f, 0};
    const smr_config c = config_of(1);
    model = rig_model(&point, 1, NULL);
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_landmarks(s, &mark, 1));
    (void)rig_run(s, 3);
    smr *again = rig_restored(s, model, &c);
    assert_non_null(again);
    (void)rig_run(s, 30);
    (void)rig_run(again, 30);
    assert_true(smr_state_hash(s) == smr_state_hash(again));
    assert_true(rig_far(rig_positions(s, model), mark.place, 1) < 0.01f);
}

/* Expected errors beside a surface know as many landmarks as half of the observations have room for, whether the
 * surface shows much or little; those beyond change nothing. */
TEST(test_expected_with_many)
{
    enum { MANY = 14, KNOWN = 10 };
    static const uint32_t n[3] = {KNOWN - 1, KNOWN, MANY};
    for (uint32_t share = 2; share <= 8u; share += 6u) {
        smr *s = start(MANY, NULL);
        smr_mesh shown = ball[0];
        smr_landmark mark[MANY];
        float mm[3][400];
        shown.n_triangles /= share;
        for (uint32_t i = 0; i < MANY; i++) {
            mark[i] = (smr_landmark){0, 7u * i, {0, 0, 0}, {0, 0, 0}, 1.0f, 0};
            memcpy(mark[i].place, ball[0].xyz + 21u * (size_t)i, sizeof mark[i].place);
            mark[i].place[0] += 1.0f;
        }
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&shown)));
        (void)rig_run(s, 20);
        for (uint32_t k = 0; k < 3u; k++) {
            assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, n[k]));
            assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, mm[k]));
        }
        assert_memory_equal(mm[1], mm[2], ball[0].n_vertices * sizeof(float));
        assert_memory_not_equal(mm[0], mm[1], ball[0].n_vertices * sizeof(float));
    }
}

/* A new start forgets by how far a hard landmark was missed: the run is as the first. */
TEST(test_new_start_forgets_misses)
{
    const smr_prepare_config radii = rig_radii(1, 30, 0, 0);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_config config = config_of(N);
    uint64_t hash[2];
    smr_landmark mark[N];
    (void)start(0, NULL); /* the balls */
    smr *s = rig_init(rig_model(ball, 1, &radii), &config, NULL);
    marks(mark, 1);
    assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, N));
    for (uint32_t i = 0; i < 2u; i++) {
        assert_int_equal(SMR_OK, smr_set_pose(s, &same));
        (void)rig_run(s, 10);
        hash[i] = smr_state_hash(s);
    }
    assert_true(hash[0] == hash[1]);
}
