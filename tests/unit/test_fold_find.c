/* test_fold_find.c: surfaces do not fold while fold handling is on, and fold while it is off.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"

#define SIDE 12u

/* A flat sheet of SIDE x SIDE vertices, 5 mm apart. */
static smr_mesh sheet(void)
{
    float *xyz = rig_alloc(SIDE * SIDE * 3u * sizeof *xyz);
    uint32_t *t = rig_alloc((SIDE - 1u) * (SIDE - 1u) * 6u * sizeof *t), k = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        smr_store(xyz + 3u * i, smr_v(5.0f * (float)(i % SIDE), 5.0f * (float)(i / SIDE), 0));
    for (uint32_t y = 0; y + 1u < SIDE; y++) {
        for (uint32_t x = 0; x + 1u < SIDE; x++) {
            const uint32_t a = y * SIDE + x;
            const uint32_t quad[6] = {a, a + 1u, a + SIDE, a + 1u, a + SIDE + 1u, a + SIDE};
            memcpy(t + k, quad, sizeof quad);
            k += 6u;
        }
    }
    return (smr_mesh){xyz, t, SIDE * SIDE, k / 3u};
}

static smr *start(const smr_mesh *mesh, uint32_t guard)
{
    const smr_prepare_config radii = rig_radii(1, 6, 0, 0);
    smr_config c = smr_config_default();
    c.motion.fold_guard = guard;
    c.motion.settle_um = 0.0f;
    return rig_init(rig_model(mesh, 1, &radii), &c, NULL);
}

static void refit(smr *s)
{
    smr_triangles_follow(&s->shape, s->shape.x_next);
    for (uint32_t task = 0; task < smr_triangles_tasks(&s->shape); task++)
        smr_triangles_refit(&s->shape, task, 0);
}

static void clear_touched(smr_folds *f) { memset(f->touched, 0, (f->shared->n_triangles + 63u) / 64u * 8u); }

/* The sheet with its farther part bent down about the line y = CREASE, as far as the cosine says. */
#define CREASE 25.0f

static void bend(float *xyz, float cosine)
{
    const float sine = sqrtf(1.0f - cosine * cosine);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        const float beyond = xyz[3u * i + 1u] - CREASE;
        if (beyond > 0.0f) {
            xyz[3u * i + 1u] = CREASE + beyond * cosine;
            xyz[3u * i + 2u] = -beyond * sine;
        }
    }
}

static smr_mesh bent_sheet(float cosine)
{
    const smr_mesh flat = sheet();
    float *xyz = rig_alloc(3u * SIDE * SIDE * sizeof *xyz);
    memcpy(xyz, flat.xyz, 3u * SIDE * SIDE * sizeof *xyz);
    bend(xyz, cosine);
    return (smr_mesh){xyz, flat.triangles, flat.n_vertices, flat.n_triangles};
}

/* Pairs of neighbouring triangles that look away from each other. */
static uint32_t n_below(const smr_mesh *mesh, const float *x, float limit)
{
    uint32_t n = 0;
    smr_vec normal[2u * SIDE * SIDE];
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        const uint32_t *t = mesh->triangles + 3u * k;
        const smr_vec a = smr_load(x + 3u * t[0]);
        normal[k] = smr_cross(smr_sub(smr_load(x + 3u * t[1]), a), smr_sub(smr_load(x + 3u * t[2]), a));
    }
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        for (uint32_t j = 0; j < k; j++) {
            uint32_t shared = 0;
            for (uint32_t c = 0; c < 9u; c++)
                shared += mesh->triangles[3u * k + c / 3u] == mesh->triangles[3u * j + c % 3u];
            n += shared == 2u && smr_dot(smr_unit(normal[k]), smr_unit(normal[j])) < limit;
        }
    }
    return n;
}

static uint32_t n_folds(const smr_mesh *mesh, const float *x) { return n_below(mesh, x, -0.2f); }

/* Runs the steps behind evolve from x_next as it stands. */
static void settle(smr *s)
{
    smr_triangles_follow(&s->shape, s->shape.x_next);
    for (uint32_t i = 0, behind = 0; i < smr_n_steps; behind |= smr_steps[i++].run == smr_evolve_step) {
        for (s->next_task = 0; behind && s->next_task < smr_step_tasks(s, &smr_steps[i]); s->next_task++)
            smr_steps[i].run(smr_stage_of(s, &smr_steps[i]), s->next_task, 0);
        if (s->next_task > 0u && smr_steps[i].end != NULL)
            smr_steps[i].end(s);
        s->next_task = 0;
    }
    smr_guard_close(s);
}

/* Carries single vertices far over their neighbours. */
static void step_over(smr *s, float mm, uint32_t seed)
{
    memcpy(s->shape.x_next, s->shape.x, 3u * s->shared.n * sizeof(float));
    for (uint32_t i = 0; i < 8u; i++) {
        float *p = smr_at3(s->shape.x_next, rig_random(&seed, s->shared.n));
        p[0] += rig_between(&seed, -mm, mm);
        p[1] += rig_between(&seed, -mm, mm);
    }
}

TEST(test_prevents)
{
    const smr_mesh mesh = sheet();
    uint32_t unguarded = 0, marked = 0;
    for (uint32_t seed = 1; seed < 30u; seed++) {
        smr *s[2] = {start(&mesh, 0), start(&mesh, 1)};
        for (uint32_t i = 0; i < 2u; i++) {
            s[i]->schedule.repairing = 0;
            step_over(s[i], 14, seed);
            settle(s[i]);
            float x[3 * SIDE * SIDE];
            assert_int_equal(SMR_OK, smr_get_positions(s[i], 0, x));
            if (i == 0u) {
                unguarded += n_folds(&mesh, x);
            } else {
                assert_int_equal(0, n_folds(&mesh, x));
                marked += s[i]->folds.n_guarded;
            }
            assert_true(rig_finite(x, mesh.n_vertices));
        }
    }
    assert_true(unguarded > 100u); /* there was something to prevent */
    assert_true(marked > 100u);
}

static float most_momentum(const smr *s)
{
    float most = 0.0f;
    for (uint32_t v = 0; v < s->shared.n; v++)
        most = smr_max(most, smr_length(smr_momentum(&s->forces, v)));
    return most;
}

/* A start shape that is sound, torn by a coarse step: the first iteration brings it back. */
TEST(test_repairs)
{
    const smr_mesh mesh = sheet();
    float x[3 * SIDE * SIDE];
    uint32_t before = 0, after = 0;
    for (uint32_t seed = 1; seed < 10u; seed++) {
        smr *s = start(&mesh, 1);
        assert_true(s->schedule.repairing > 0u);
        step_over(s, 12, seed);
        memcpy(s->shape.x, s->shape.x_next, 3u * s->shared.n * sizeof(float)); /* folded already */
        memcpy(s->shape.x_ref, s->shape.x, 3u * s->shared.n * sizeof(float));
        assert_int_equal(SMR_OK, smr_get_positions(s, 0, x));
        before += n_folds(&mesh, x);
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(0, s->schedule.repairing); /* it ends, and leaves no momentum and no folds in x^r */
        assert_int_equal(SMR_REPAIRED, s->schedule.repaired);
        s->schedule.momentum = s->schedule.fade = 1.0f;
        assert_true(most_momentum(s) == 0.0f);
        s->schedule.repaired--;
        assert_true(most_momentum(s) > 0.0f);
        smr_guard_close(s);
        assert_true(smr_plastic_follows(s));
        assert_int_equal(SMR_OK, smr_get_positions(s, 0, x));
        after += n_folds(&mesh, x);
    }
    assert_true(before > 30u);
    assert_int_equal(0, after);
}

/* A model with a crease, whose next positions have it sharper; how many hinges there turn back before and after. */
static void sharpen(float rest, float next, uint32_t radius, uint32_t *before, uint32_t *after, float *moved)
{
    const smr_mesh mesh = bent_sheet(rest), sharp = bent_sheet(next);
    const smr_prepare_config radii = rig_radii(2, 6, 5, 0);
    smr_config c = smr_config_default();
    float x[3 * SIDE * SIDE];
    smr *s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, sharp.xyz));
    s->schedule.repairing = 0;
    s->schedule.radius = radius;
    memcpy(s->shape.x_next, s->shape.x, 3u * s->shared.n * sizeof(float));
    *before = n_below(&mesh, sharp.xyz, 0.0f);
    settle(s);
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, x));
    *after = n_below(&mesh, x, 0.0f);
    *moved = 0.0f;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        const float far = rig_far(x + 3u * i, sharp.xyz + 3u * i, 1);
        *moved = smr_max(*moved, far);
        if (far > 1.0e-3f) /* what opens a fold is not smoothed at all */
            assert_int_equal(UINT8_MAX, s->evolve.tangent_smooth.limited[smr_model_position(s->shared.model, i)]);
    }
}

/* Edges that are right angles at rest, or sharper ones that still were open, do not stay turned back. */
TEST(test_unfolds)
{
    uint32_t before, after;
    float moved;
    for (uint32_t i = 0; i < 3u; i++) {
        static const float rest[] = {0.0f, 0.004f, 0.3f};
        sharpen(rest[i], -0.05f, 1, &before, &after, &moved);
        assert_int_equal(SIDE - 1u, before);
        assert_int_equal(0, after);
        assert_true(moved > 0.0f && moved < 0.5f); /* of edges of 5 mm */
    }
    sharpen(0.0f, -0.05f, 0, &before, &after, &moved); /* not before the last radius */
    assert_int_equal(before, after);
    sharpen(-0.05f, -0.1f, 1, &before, &after, &moved); /* they looked away from each other at rest */
    assert_true(before == after && before == SIDE - 1u && moved < 1.0e-5f);
}

/* Sharp folds, which a single pass would only open a little, are opened within an iteration. */
TEST(test_unfolds_in_passes)
{
    static const float next[] = {-0.2f, -0.4f, -0.6f};
    for (uint32_t i = 0; i < 3u; i++) {
        uint32_t before, after;
        float moved;
        sharpen(0.0f, next[i], 1, &before, &after, &moved);
        assert_int_equal(SIDE - 1u, before);
        assert_true(after == 0u && moved > 0.0f);
    }
}

/* A fold that a step of folds has made is opened: the update of the triangles before does not show it. The step has
 * touched its triangles, or folds were found there before. */
TEST(test_opens_what_moved)
{
    const smr_mesh mesh = sheet();
    for (uint32_t found = 0; found < 2u; found++) {
        smr *s = start(&mesh, 1);
        smr_folds *f = &s->folds;
        const uint32_t v = smr_model_position(s->shared.model, SIDE + SIDE / 2u);
        s->schedule.repairing = 0;
        memcpy(s->shape.x_next, s->shape.x, 3u * s->shared.n * sizeof(float));
        refit(s);
        f->tally[0].folds.open = found == 1u ? ~0u : 0u;
        clear_touched(f);
        f->folding[0] = found == 0u;
        memset(f->marked, 0, s->shared.n);
        s->shape.x_next[3u * v] += 14.0f;
        s->shape.x_next[3u * v + 2u] += 1.0f;
        f->marked[v] = 1;
        for (uint32_t k = 0; found == 0u && k < s->shared.n_triangles; k++)
            if (smr_any_marked(f, k))
                smr_triangle_touch(f, k);
        smr_fold_open_start(f);
        for (uint32_t task = 0; task < smr_fold_open_tasks(f); task++)
            smr_fold_open_pass(f, task, 0);
        assert_true(f->open.n_passes > 0u);
    }
}

/* Edges that are open at rest and folded, where none is to be limited: what was touched before is forgotten first. */
TEST(test_opens_without_limit)
{
    const smr_mesh mesh = sheet();
    smr *s = start(&mesh, 1);
    smr_folds *f = &s->folds;
    s->schedule.repairing = 0;
    f->touched[0] = ~(uint64_t)0;
    memset(&f->tally[0].folds, 0, sizeof f->tally[0].folds);
    f->tally[0].folds.open = 1;
    smr_fold_find_end(f);
    assert_int_equal(0, f->limit.pass.stage);
    assert_true(f->open.pass.stage != 0u && f->touched[0] == 0u);
}

/* Finds folds at x_next and limits them. all 1: no task skips its edges. Returns how often edges were skipped. */
static uint32_t limit(smr *s, int all)
{
    smr_folds *f = &s->folds;
    uint32_t n_quiet = 0;
    refit(s);
    for (uint32_t task = 0; task < smr_fold_find_tasks(f); task++)
        smr_fold_find(f, task, 0);
    smr_fold_find_end(f);
    for (uint32_t task = 0; task < smr_fold_limit_tasks(f); task++) {
        f->tally[0].folds.quiet = all ? 0u : f->tally[0].folds.quiet;
        n_quiet += f->tally[0].folds.quiet != 0u;
        smr_fold_limit_pass(f, task, 0);
    }
    return n_quiet;
}

/* A registration whose sheet is pleated along x, all pleats almost as sharp as edges may be, and pressed at the end
 * where x is largest or smallest. */
static smr *pleated(const smr_mesh *mesh, int large, float mm)
{
    smr *s = start(mesh, 1);
    float x[3 * SIDE * SIDE];
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        smr_store(x + 3u * i, smr_v(3.71f * (float)(i % SIDE), 5.0f * (float)(i / SIDE), i % 2u ? 3.35f : 0.0f));
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, x));
    s->schedule.repairing = 0;
    memcpy(s->shape.x_next, s->shape.x, 3u * s->shared.n * sizeof(float));
    for (uint32_t i = 0; i < 4u * SIDE; i++) {
        const uint32_t column = large ? SIDE - 1u - i % 4u : i % 4u, at = i / 4u * SIDE + column;
        const float pressed = mm * (float)(4u - i % 4u);
        s->shape.x_next[3u * smr_model_position(s->shared.model, at)] += large ? -pressed : pressed;
    }
    return s;
}

/* Rounds that skip edges without marked corners move what rounds over all edges move. */
TEST(test_limit_skips)
{
    const smr_mesh mesh = sheet();
    uint32_t n_quiet = 0, n_moved = 0;
    for (uint32_t seed = 1; seed < 60u; seed++) {
        const float mm = 0.05f * (float)seed;
        smr *s[2] = {pleated(&mesh, seed % 2u, mm), pleated(&mesh, seed % 2u, mm)};
        for (uint32_t i = 0; i < 2u; i++)
            n_quiet += limit(s[i], i == 1u);
        for (uint32_t v = 0; v < s[0]->shared.n; v++)
            n_moved += s[0]->folds.marked[v];
        assert_memory_equal(s[0]->folds.marked, s[1]->folds.marked, s[0]->shared.n);
        assert_memory_equal(s[0]->shape.x_next, s[1]->shape.x_next, 3u * SIDE * SIDE * sizeof(float));
    }
    assert_true(n_quiet > 100u && n_moved > 100u);
}

/* Right angles at rest, as of a box, may bend a little further than edges bent by less, and edges bent by more the
 * more so. */
TEST(test_limits_of_bent_edges)
{
    static const float rest[] = {0.5f, 0.025f, 0.0f, -0.5125f}, want[] = {0.02f, 0.0125f, -0.25f, -0.7125f};
    for (uint32_t k = 0; k < 4u; k++) {
        const smr_mesh mesh = bent_sheet(rest[k]);
        const smr *s = start(&mesh, 1);
        uint32_t n_bent = 0;
        for (uint32_t i = 0; i < s->shared.n_dihedrals; i++) {
            const float limit = smr_edge_limit(smr_edge_at(&s->folds, i));
            n_bent += k > 0u && fabsf(limit - want[k]) < 0.004f;
            assert_true(fabsf(limit - want[k]) < 0.006f || fabsf(limit - 0.02f) < 0.006f);
        }
        assert_int_equal(k > 0u ? SIDE - 1u : 0u, n_bent);
    }
}
