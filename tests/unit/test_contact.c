/* test_contact.c: sides of surfaces; how surfaces overlap, against computed bodies; structures parted from each other
 * and from fixed surfaces; the same bits for any port, off and on, from a log and from a save.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "geometry/surface/surface.h"
#include "registration/registration.h"

enum { LOG = 65536 };

static const float none[3] = {0, 0, 0};

/* A box of eight vertices. */
static smr_mesh box(float x, float y, float z, float size)
{
    static const uint32_t face[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                         {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    float *xyz = rig_alloc(24u * sizeof *xyz);
    for (uint32_t i = 0; i < 8u; i++) {
        xyz[3u * i] = x + ((i & 1u) != 0u ? size : 0.0f);
        xyz[3u * i + 1u] = y + ((i & 2u) != 0u ? size : 0.0f);
        xyz[3u * i + 2u] = z + ((i & 4u) != 0u ? size : 0.0f);
    }
    return (smr_mesh){xyz, face[0], 8, 12};
}

static float side_of(const smr_surface *s, const float *p)
{
    const smr_query q = {smr_sub(smr_load(p), s->origin), smr_v(0, 0, 0), -2.0f, 1000, SMR_NONE};
    smr_side side;
    assert_int_equal(1, smr_signed_distance(&s->tree, s->normal, &q, 1000.0f, NULL, &side));
    return side.mm;
}

/* A needle: at its tip normals point nearly all ways, and most of them away from a point beside it. */
TEST(test_sides)
{
    static const float tip[4][3] = {{0, 0, 60}, {3, 0, 0}, {-1, 2, 0}, {-1, -2, 0}};
    static const uint32_t face[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    const smr_mesh ball = rig_ball(20, 12, 24, none), needle = {tip[0], face[0], 4, 4};
    const smr_surface *round = rig_surface(&ball), *sharp = rig_surface(&needle);
    uint32_t seed = 5, wrong = 0;
    for (uint32_t i = 0; i < 20000u; i++) {
        float p[3];
        rig_within(&seed, -30, 30, p);
        p[2] = 30.0f + 2.0f * p[2];
        const float from = smr_length(smr_load(p)) - 20.0f;
        if (i % 4u == 0u && from < 5.0f)
            assert_true(fabsf(side_of(round, p) - from) < 0.9f);
        int in = 1;
        for (uint32_t k = 0; k < 4u; k++) {
            const smr_vec a = smr_load(tip[face[k][0]]), b = smr_load(tip[face[k][1]]), c = smr_load(tip[face[k][2]]);
            in &= smr_dot(smr_cross(smr_sub(b, a), smr_sub(c, a)), smr_sub(smr_load(p), a)) < 0.0f;
        }
        const float side = side_of(sharp, p);
        wrong += (side < 0.0f) != in && fabsf(side) > 1.0e-3f;
    }
    assert_int_equal(0, wrong);
}

/* Lines between two others cross a surface within their extent; a line found as far as `most` has all crossings up to
 * there, in order, and leaves the ball as often as it enters. */
TEST(test_lines)
{
    static const float away[3] = {31.25f, -7.5f, 3.0f};
    const smr_mesh ball = rig_ball(20, 24, 40, away);
    const smr_surface *s = rig_surface(&ball);
    const smr_vec shift = smr_v(0.7f, -0.3f, 5.1f);
    uint32_t seed = 3, crossed = 0;
    for (uint32_t i = 0; i < 3000u; i++) {
        float p[3], most[3];
        rig_within(&seed, -22, 22, p);
        rig_within(&seed, -22, 22, most);
        const smr_ray low = {(i + 1u) % 3u, (i + 2u) % 3u, i % 3u, p[0], p[1]};
        const smr_ray high = {low.u, low.v, low.w, p[0] + 0.1f * (float)(i % 40u), p[1] + 0.05f * (float)(i % 7u)};
        const smr_extent extent = smr_lines_extent(s, &low, &high, shift);
        smr_line all = {.ray = low}, part;
        all.ray.pu += 0.6f * (high.pu - low.pu);
        all.ray.pv += 0.3f * (high.pv - low.pv);
        part = all;
        smr_line_cross(s, &all, shift, SMR_FAR, 1);
        smr_line_cross(s, &part, shift, most[2], 1);
        int in = 0;
        crossed += all.n;
        for (uint32_t k = 0; k < all.n; k++) {
            assert_true(all.list[k].at >= extent.lo && all.list[k].at <= extent.hi);
            in += all.list[k].turn;
            assert_true(in == 0 || in == 1);
            assert_true(all.list[k].at > most[2] || (part.n > k && part.list[k].at == all.list[k].at));
        }
        assert_int_equal(0, in);
        const float from = smr_length(smr_sub(smr_add(smr_load(p), s->origin), smr_load(away)));
        if (from < 19.0f || from > 20.01f)
            assert_int_equal(from < 19.0f, smr_surface_inside(s, smr_load(p)));
    }
    assert_true(crossed > 2000u && crossed < 5000u);
}

static void measures(const smr_mesh *a, const smr_mesh *b, float deepest, float volume, float area)
{
    smr_contact_report one, other;
    assert_int_equal(SMR_OK, smr_surface_contact(rig_surface(a), rig_surface(b), 0.1f, &one));
    assert_int_equal(SMR_OK, smr_surface_contact(rig_surface(b), rig_surface(a), 0.1f, &other));
    assert_true(area < 0.0f ? one.deepest_mm <= deepest : fabsf(one.deepest_mm - deepest) <= 0.1f * deepest);
    assert_true(fabsf(one.volume_mm3 - volume) <= (area < 0.0f ? 0.01f : 0.08f) * volume);
    assert_true(area < 0.0f || fabsf(one.area_mm2 - area) <= 0.25f * area); /* of many triangles only */
    assert_true(one.deepest_mm == other.deepest_mm && fabsf(one.volume_mm3 - other.volume_mm3) <= 0.01f * volume);
}

TEST(test_measured)
{
    static const float aside[3] = {37, 3, -1}, far[3] = {60, 0, 0};
    const smr_mesh a = box(100, 200, -300, 10), b = box(108, 201, -300.5f, 10), in = box(103, 203, -297, 4),
                   edge = box(109.25f, 208.75f, -298, 10);
    const smr_mesh ball = rig_ball(20, 40, 64, none), next = rig_ball(20, 40, 64, aside),
                   off = rig_ball(20, 24, 40, far), large = rig_ball(150, 40, 64, none);
    const smr_surface *surface = rig_surface(&a);
    smr_contact_report r = {-1, -1, -1, -1};
    const smr_mesh open = {a.xyz, a.triangles, a.n_vertices, 11};
    measures(&a, &b, 2.0f, 2.0f * 9.0f * 9.5f, -1);
    measures(&a, &in, 3.0f, 64.0f, -1);
    measures(&a, &edge, 0.75f, 0.75f * 1.25f * 8.0f, -1);
    const float h = 20.0f - 0.5f * sqrtf(37.0f * 37.0f + 10.0f);
    measures(&ball, &next, 2.0f * h, 2.09439510f * h * h * (60.0f - h), 6.2831853f * 20.0f * h * 1.05f);
    measures(&ball, &off, 0, 0, 0);
    measures(&large, &ball, 100.0f, 33510.0f, 2513.0f); /* deeper than what counts */
    assert_int_equal(SMR_OK, smr_surface_contact(rig_surface(&open), surface, 0.1f, &r));
    assert_true(r.deepest_mm == 0.0f && r.volume_mm3 == 0.0f && r.area_mm2 == 0.0f);
    assert_int_equal(SMR_OK, smr_surface_contact(surface, rig_surface(&open), 0.1f, &r));
    assert_true(r.deepest_mm == 0.0f && r.volume_mm3 == 0.0f && r.area_mm2 == 0.0f);
    for (uint32_t axis = 0; axis < 3u; axis++) { /* near each other: contact, and nothing in common */
        float at[3] = {100, 200, -300};
        at[axis] += 10.05f;
        const smr_mesh beside = box(at[0], at[1], at[2], 10);
        assert_int_equal(SMR_OK, smr_surface_contact(surface, rig_surface(&beside), 0.1f, &r));
        assert_true(r.deepest_mm == 0.0f && r.volume_mm3 == 0.0f && r.area_mm2 > 1.0f);
    }
    assert_int_equal(SMR_E_INPUT, smr_surface_contact(surface, surface, NAN, &r));
    assert_int_equal(SMR_E_INPUT, smr_surface_contact(surface, surface, -1.0f, &r));
}

/* Two balls that overlap by 6 mm, or a ball alone. */
static smr_mesh pair[2];
static const smr_model *model;

static smr *start(uint32_t n, float contact, uint32_t n_fixed, const smr_port *port)
{
    static const float at[2][3] = {{-17, 1, 2}, {17, 0, 0}};
    const smr_prepare_config radii = rig_radii(2, 25, 0.1f, 0);
    smr_config config = smr_config_default();
    config.basic.iterations = 5;
    config.basic.iterations_last = 20;
    config.contact.share = contact;
    config.contact.n_fixed = n_fixed;
    config.basic.n_workers = port != NULL ? port->n_workers : 1u;
    for (uint32_t i = 0; i < 2u; i++)
        pair[i] = rig_ball(20, 12, 20, at[i]);
    model = rig_model(pair, n, &radii);
    return rig_init(model, &config, port);
}

static smr_mesh result_of(const smr *s, uint32_t i)
{
    smr_mesh mesh = pair[i];
    float *xyz = rig_alloc(12u * (size_t)mesh.n_vertices);
    assert_int_equal(SMR_OK, smr_get_positions(s, i, xyz));
    mesh.xyz = xyz;
    return mesh;
}

static float middle(const smr_mesh *m)
{
    float sum = 0.0f;
    for (uint32_t i = 0; i < m->n_vertices; i++)
        sum += m->xyz[3u * i] / (float)m->n_vertices;
    return sum;
}

static smr_contact_report between(const smr_mesh *a, const smr_mesh *b)
{
    smr_contact_report r;
    assert_int_equal(SMR_OK, smr_surface_contact(rig_surface(a), rig_surface(b), 0.1f, &r));
    return r;
}

TEST(test_parted)
{
    smr_contact_report r[2];
    for (uint32_t on = 0; on < 2u; on++) {
        smr *s = start(2, (float)on, 0, NULL);
        (void)rig_run(s, 100);
        const smr_mesh a = result_of(s, 0), b = result_of(s, 1);
        r[on] = between(&a, &b);
        assert_true(fabsf(middle(&a) + middle(&b)) < 0.1f); /* both go half of the way */
    }
    assert_true(r[0].deepest_mm > 4.0f && r[1].deepest_mm < 0.4f);
    assert_true(r[1].volume_mm3 < 0.05f * r[0].volume_mm3);
}

/* A small share parts bodies bit by bit. */
TEST(test_share)
{
    smr *s = start(2, 0.25f, 0, NULL);
    (void)rig_run(s, 3);
    for (uint32_t i = 0; i < 2u; i++) {
        const smr_mesh a = result_of(s, 0), b = result_of(s, 1);
        const float deep = between(&a, &b).deepest_mm;
        assert_true(i == 0u ? deep > 0.8f && deep < 4.0f : deep < 0.2f);
        (void)rig_run(s, 8);
    }
}

/* Two flat bodies pressed onto each other: the upper one is drawn 20 mm along and 2 mm into the lower one. */
TEST(test_slides)
{
    static const float flat[9] = {3, 0, 0, 0, 1.5f, 0, 0, 0, 0.4f}, at[2][3] = {{-10, 0, 8.0f}, {0, 0, -8.0f}};
    const smr_mesh ball = rig_ball(20, 14, 24, none);
    const smr_prepare_config radii = rig_radii(2, 30, 0.1f, 0);
    smr_config config = smr_config_default();
    float *goal[2];
    config.caller.goals = 1;
    config.contact.share = 1.0f;
    for (uint32_t i = 0; i < 2u; i++) {
        pair[i] = rig_moved(&ball, flat, at[i]);
        goal[i] = rig_alloc(12u * (size_t)pair[i].n_vertices);
        memcpy(goal[i], pair[i].xyz, 12u * (size_t)pair[i].n_vertices);
    }
    for (uint32_t i = 0; i < pair[0].n_vertices; i++) {
        goal[0][3u * i] += 20.0f;
        goal[0][3u * i + 2u] -= 2.0f;
    }
    model = rig_model(pair, 2, &radii);
    smr *s = rig_init(model, &config, NULL);
    for (uint32_t i = 0; i < 2u; i++)
        assert_int_equal(SMR_OK, smr_set_goals(s, i, goal[i], NULL));
    (void)rig_run(s, 200);
    const smr_mesh a = result_of(s, 0), b = result_of(s, 1);
    const float slid = middle(&a) - middle(&pair[0]), carried = middle(&b) - middle(&pair[1]);
    assert_true(slid > 19.0f && fabsf(carried) < 1.0f);
    const smr_mesh wanted = {goal[0], pair[0].triangles, pair[0].n_vertices, pair[0].n_triangles};
    assert_true(between(&a, &b).volume_mm3 < 0.1f * between(&wanted, &pair[1]).volume_mm3);
}

/* Largest distance of points from a surface. */
static float off_surface(const smr_mesh *mesh, const float *xyz)
{
    const smr_surface *surface = rig_surface(mesh);
    smr_closest hit;
    float most = 0.0f;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        assert_int_equal(SMR_OK, smr_surface_closest(surface, xyz + 3u * (size_t)i, NULL, 0, 100.0f, &hit));
        most = hit.distance > most ? hit.distance : most;
    }
    return most;
}

/* Moved together, all give nearly the moved surface: where goals and contact pull, last bits decide 0.01 mm. */
TEST(test_moved)
{
    static const float at[3][3] = {{-19.3f, 1, 2}, {19.3f, 0, 0}, {0, 34.2f, 5}}, shift[3] = {30, -200, 55};
    const smr_prepare_config radii = rig_radii(2, 25, 0.1f, 0);
    smr_config config = smr_config_default();
    float turn[9], *xyz[2];
    rig_rotation(1, 2, -0.5f, 40, turn);
    config.basic.iterations = 5;
    config.contact.share = 1.0f;
    config.contact.n_fixed = 1;
    config.basic.n_target_vertices = 2000;
    config.forces.curvature = 0.0f;
    for (uint32_t k = 0; k < 2u; k++) {
        smr_mesh ball[3];
        for (uint32_t i = 0; i < 3u; i++) {
            ball[i] = rig_ball(20, 12, 20, at[i]);
            ball[i] = k == 0u ? ball[i] : rig_moved(&ball[i], turn, shift);
        }
        model = rig_model(ball, 2, &radii);
        smr *s = rig_init(model, &config, NULL);
        assert_int_equal(SMR_OK, smr_set_fixed(s, 0, rig_surface(&ball[2])));
        for (uint32_t i = 0; i < 2u; i++)
            assert_int_equal(SMR_OK, smr_set_surface(s, i, rig_surface(&ball[i])));
        (void)rig_run(s, 200);
        xyz[k] = rig_positions(s, model);
        if (k == 1u) {
            const smr_mesh first = {xyz[0], ball[0].triangles, ball[0].n_vertices, ball[0].n_triangles};
            assert_true(off_surface(&first, xyz[1]) < 0.12f);
            continue;
        }
        const smr_mesh whole = {xyz[0], ball[0].triangles, 2u * ball[0].n_vertices, ball[0].n_triangles};
        const smr_mesh moved = rig_moved(&whole, turn, shift);
        assert_true(rig_far(xyz[0], ball[0].xyz, ball[0].n_vertices) > 0.3f); /* it was parted */
        xyz[0] = rig_alloc(24u * (size_t)ball[0].n_vertices);
        memcpy(xyz[0], moved.xyz, 24u * (size_t)ball[0].n_vertices);
    }
}

TEST(test_fixed)
{
    smr *s = start(1, 1.0f, 2, NULL);
    const smr_surface *other = rig_surface(&pair[1]);
    smr_points *points = NULL;
    static _Alignas(SMR_ALIGN) unsigned char cloud[2048];
    assert_int_equal(SMR_E_STATE, smr_set_fixed(s, 0, (const smr_surface *)(const void *)cloud)); /* zeros */
    assert_int_equal(SMR_OK, smr_points_open(10, cloud, sizeof cloud, &points));
    assert_int_equal(SMR_E_NULL, smr_set_fixed(NULL, 0, other));
    assert_int_equal(SMR_E_STATE, smr_set_fixed(s, 0, &points->surface));
    assert_int_equal(SMR_E_INPUT, smr_set_fixed(s, 2, other));
    assert_int_equal(SMR_OK, smr_set_fixed(s, 1, other));
    (void)rig_run(s, 100);
    const smr_mesh a = result_of(s, 0);
    assert_true(between(&a, &pair[1]).deepest_mm < 0.5f && between(&pair[0], &pair[1]).deepest_mm > 4.0f);
    assert_int_equal(SMR_OK, smr_set_fixed(s, 1, NULL));
    const smr_mesh fewer = rig_ball(20, 10, 20, (const float[3]){17, 0, 0}), *const anew[] = {&pair[1], &fewer};
    smr_surface *changed = rig_surface(&pair[1]);
    size_t bytes;
    assert_int_equal(SMR_OK, smr_surface_bytes(pair[1].n_vertices, pair[1].n_triangles, &bytes));
    for (uint32_t i = 0; i < 4u; i++) { /* refitted, built anew, then with fewer vertices, left half built */
        s = start(1, 1.0f, 1, NULL);
        assert_int_equal(SMR_OK, smr_set_fixed(s, 0, changed));
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        if (i == 0u)
            assert_int_equal(SMR_OK, smr_surface_refit(changed, pair[1].xyz) + smr_surface_step(changed, 0, NULL, 0));
        else if (i < 3u)
            assert_int_equal(SMR_OK, smr_surface_build(anew[i - 1u], changed, bytes, &changed));
        else
            assert_int_equal(SMR_OK, smr_surface_begin(&fewer, changed, bytes, &changed));
        assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    }
    s = start(1, 1.0f, 0, NULL);
    assert_int_equal(SMR_E_ARENA, smr_set_fixed(s, 0, other));
}

/* Off, memory for fixed surfaces changes no bit; on, threads do not. */
TEST(test_bits)
{
    smr *plain = start(2, 0.0f, 0, NULL), *unused = start(2, 0.0f, 1, NULL);
    size_t off = 0, on = 0;
    uint64_t hash = 0;
    assert_int_equal(SMR_OK, smr_set_fixed(unused, 0, rig_surface(&pair[1])));
    (void)rig_run(plain, 100);
    (void)rig_run(unused, 100);
    assert_true(smr_state_hash(plain) == smr_state_hash(unused));
    for (uint32_t i = 0; i < RIG_SCHEDULERS; i++) {
        const smr_port port = rig_port(i, 1u + 3u * i);
        smr *s = start(2, 1.0f, 1, &port);
        assert_int_equal(SMR_OK, smr_set_fixed(s, 0, rig_surface(&pair[1])));
        (void)rig_run(s, 100);
        hash = i == 0u ? smr_state_hash(s) : hash;
        assert_true(hash == smr_state_hash(s));
    }
    smr_config config = smr_config_default();
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &config, &off));
    config.contact.share = 1.0f;
    config.contact.n_fixed = 1;
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &config, &on));
    assert_true(on - off <= SMR_ARENA_CONTACT_BYTES(2u * pair[0].n_vertices, 2u * pair[0].n_triangles, 2));
}

static const void *input(void *ctx, const smr_log_record *record)
{
    return record->kind == SMR_LOG_FIXED_SURFACE ? ctx : NULL;
}

TEST(test_replay)
{
    static unsigned char log[LOG];
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 50000);
    smr *s = start(2, 1.0f, 1, &port);
    smr_surface *other = rig_surface(&pair[1]), *wrong = rig_surface(&pair[0]);
    smr_log_state wrote;
    smr_replay replay;
    smr_replay_report report = {0};
    uint32_t seed = 3, partial = 0;
    assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
    for (uint32_t tick = 0; tick < 80u; tick++) {
        if (tick % 5u == 3u)
            assert_int_equal(SMR_OK, smr_set_fixed(s, 0, tick % 2u != 0u ? other : NULL));
        partial += smr_tick(s, 500000u + rig_random(&seed, 3000000u), NULL) == SMR_PARTIAL;
    }
    assert_true(partial > 20u);
    assert_int_equal(SMR_OK, smr_get_log(s, &wrote));
    for (uint32_t round = 0; round < 2u; round++) {
        smr_status status = SMR_OK;
        memset(&report, 0, sizeof report);
        smr *again = start(2, 1.0f, 1, NULL);
        assert_int_equal(SMR_OK,
                         smr_replay_start(again, log, wrote.bytes, input, round == 0u ? other : wrong, &replay));
        while (status == SMR_OK && !report.ended) {
            status = smr_replay_tick(&replay, &report);
            assert_int_equal(0, report.differs);
        }
        assert_int_equal(round == 0u ? SMR_OK : SMR_E_INPUT, status); /* another surface is refused */
        assert_true(round == 1u || smr_state_hash(again) == smr_state_hash(s));
    }
}

TEST(test_saved)
{
    smr *s = start(2, 1.0f, 2, NULL), *again = NULL; /* the second fixed surface is never set */
    smr_surface *other = rig_surface(&pair[1]);
    size_t bytes = 0, arena = 0;
    uint32_t n = 0;
    assert_int_equal(SMR_OK, smr_set_fixed(s, 0, other));
    (void)rig_run(s, 8);
    assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes));
    unsigned char *saved = rig_alloc(bytes);
    assert_int_equal(SMR_OK, smr_save(s, saved, bytes));
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &s->shared.config, &arena));
    assert_int_equal(SMR_OK, smr_restore(model, NULL, NULL, saved, bytes, rig_alloc(arena), arena, &again));
    assert_int_equal(SMR_OK, smr_get_awaited(again, &n));
    assert_int_equal(1, n);
    assert_int_equal(SMR_E_STATE, smr_tick(again, 0, NULL));
    assert_int_equal(SMR_E_STATE, smr_set_fixed(again, 0, NULL));
    assert_int_equal(SMR_E_INPUT, smr_set_fixed(again, 0, rig_surface(&pair[0])));
    assert_int_equal(SMR_OK, smr_set_fixed(again, 0, other));
    assert_true(rig_run(s, 100).state_hash == rig_run(again, 100).state_hash);
    saved[bytes / 2u] ^= 1u;
    assert_int_equal(SMR_E_SAVE, smr_restore(model, NULL, NULL, saved, bytes, rig_alloc(arena), arena, &again));
}
