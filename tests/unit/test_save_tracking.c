/* test_save_tracking.c: a registration that follows refitted targets is saved between any two of its calls, restored
 * in another arena with other threads, and goes on with the same bits and reports: in the schedule, settled, called
 * and while it recovers from a jump. Forged saves are refused or run on.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "registration/registration.h"
#include "unit/unit_save.h"

enum { FRAMES = 5, JUMP = 3, TICKS = 32, CALLS = FRAMES * (TICKS + 1), ROOM = 20000 };

static struct scene {
    smr_mesh source, frame[FRAMES];
    const smr_model *model;
    smr_config config;
    smr_surface *surface[2]; /* of the run, and of the restored one */
    unsigned char saved[ROOM];
    size_t bytes;
} e;

static struct met {
    uint32_t schedule, settled, called, jumped, recovering, after;
} met;

BEFORE_EACH_TEST()
{
    const float none[3] = {0, 0, 0}, flat[9] = {1, 0, 0, 0, 0.7f, 0, 0, 0, 1.3f};
    const smr_prepare_config radii = rig_radii(2, 40, 15, 0);
    const smr_mesh ball = rig_ball(25, 8, 12, none);
    smr_mesh goal = rig_ball(27, 9, 14, none);
    goal.n_triangles = goal.n_triangles * 4u / 5u; /* some vertices have no goal */
    memset(&e, 0, sizeof e);
    e.source = rig_moved(&ball, flat, none);
    for (uint32_t i = 0; i < FRAMES; i++) {
        const float by = 0.8f * (float)i + (i >= JUMP ? 12.0f : 0.0f), shift[3] = {by, -0.5f * by, 0.3f * by};
        e.frame[i] = rig_moved(&goal, flat, shift);
    }
    e.model = rig_model(&e.source, 1, &radii);
    e.config = smr_config_default();
    e.config.basic.n_workers = 4;
    e.config.basic.n_target_vertices = goal.n_vertices;
    e.config.track.mode = SMR_TRACK_RECOVER;
    e.config.track.radius_mm = 15.0f;
    e.config.track.ahead = 0.6f;
    e.config.track.iterations = 6;
    e.config.basic.iterations = 3;
    e.config.basic.iterations_last = 5;
    for (uint32_t i = 0; i < 2u; i++)
        e.surface[i] = rig_surface(&e.frame[0]);
}

static void refit(uint32_t frame)
{
    for (uint32_t i = 0; i < 2u; i++) {
        assert_int_equal(SMR_OK, smr_surface_refit(e.surface[i], e.frame[frame].xyz));
        assert_int_equal(SMR_OK, smr_surface_step(e.surface[i], 0, NULL, 0));
    }
}

/* Call number c: of each frame first its target, then ticks. */
static smr_tick_report make(smr *s, uint32_t c, uint32_t copy)
{
    smr_tick_report r = {0};
    if (c % (TICKS + 1u) == 0u)
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.surface[copy]));
    else
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    return r;
}

/* The run up to call number c. */
static smr *run_to(uint32_t c)
{
    smr *s = rig_init(e.model, &e.config, NULL);
    for (uint32_t i = 0; i < c; i++) {
        if (i % (TICKS + 1u) == 0u)
            refit(i / (TICKS + 1u));
        (void)make(s, i, 0);
    }
    return s;
}

static void note(const smr *s)
{
    met.schedule += !s->schedule.tracking;
    met.settled += s->schedule.settled && !s->schedule.changed;
    met.called += s->schedule.changed;
    met.jumped += s->schedule.jumped;
    met.recovering += s->schedule.recovering == 1u;
    met.after += s->schedule.recovering == 2u;
}

static void save(const smr *s)
{
    assert_int_equal(SMR_OK, smr_save_bytes(s, &e.bytes));
    assert_true(e.bytes <= sizeof e.saved);
    assert_int_equal(SMR_OK, smr_save(s, e.saved, e.bytes));
}

static smr *restore(uint32_t workers, const smr_port *port)
{
    smr_config config = e.config;
    smr *s = NULL;
    size_t bytes = 0;
    config.basic.n_workers = workers;
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &config, &bytes));
    void *arena = rig_alloc(bytes);
    memset(arena, 0xb5, bytes);
    assert_int_equal(SMR_OK, smr_restore(e.model, &config, port, e.saved, e.bytes, arena, bytes, &s));
    return s;
}

TEST(test_goes_on)
{
    static const uint32_t at[] = {0, 1, 2, 4, 7, 15, 26, 29};
    enum { CUTS = sizeof at / sizeof at[0] };
    for (uint32_t i = 0; i < FRAMES * CUTS; i++) {
        const uint32_t cut = i / CUTS * (TICKS + 1u) + at[i % CUTS];
        const smr_port port = rig_port(cut % RIG_SCHEDULERS, 1u + cut % 4u);
        smr *s = run_to(cut);
        uint32_t n = 0;
        note(s);
        save(s);
        smr *twin = restore(port.n_workers, &port);
        assert_true(smr_state_hash(s) == smr_state_hash(twin));
        assert_int_equal(SMR_OK, smr_get_awaited(twin, &n));
        assert_int_equal(cut > 0u, n);
        if (n > 0u) {
            assert_int_equal(SMR_E_STATE, smr_tick(twin, 0, NULL));
            assert_int_equal(SMR_OK, smr_set_surface(twin, SMR_ALL, e.surface[1]));
        }
        for (uint32_t c = cut; c < CALLS; c++) {
            if (c % (TICKS + 1u) == 0u)
                refit(c / (TICKS + 1u));
            const smr_tick_report a = make(s, c, 0), b = make(twin, c, 1);
            if (memcmp(&a, &b, sizeof a) != 0)
                fail_msg("saved at call %u: another report at call %u", (unsigned)cut, (unsigned)c);
        }
        assert_true(smr_state_hash(s) == smr_state_hash(twin));
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u in the schedule, %u settled, %u called, %u jumped, %u recovering, %u after that\n",
                      met.schedule, met.settled, met.called, met.jumped, met.recovering, met.after);
    assert_true(met.schedule > 3u && met.settled > 3u && met.called > 1u && met.jumped > 3u && met.recovering > 3u &&
                met.after > 2u);
}

/* A surface that was built of the present positions, or refitted to others, is not the one from before. */
TEST(test_other_surfaces)
{
    save(run_to(2u * (TICKS + 1u)));
    smr *twin = restore(1, NULL);
    refit(4);
    assert_int_equal(SMR_E_INPUT, smr_set_surface(twin, SMR_ALL, e.surface[1]));
    refit(1);
    assert_int_equal(SMR_OK, smr_set_surface(twin, SMR_ALL, e.surface[1]));
    assert_int_equal(SMR_OK, smr_tick(twin, 0, NULL));
}

/* Every field behind the arrays, where the schedule and tracking are, as words that mean something or nothing. */
TEST(test_forged)
{
    static const uint32_t value[] = {0, 1, 2, 3, 7, 0xffu, 0x7fffffffu, 0x7fc00000u, 0x3f800000u, 0xffffffffu};
    const uint32_t cut[] = {2, TICKS + 3u, JUMP * (TICKS + 1u) + 3u, JUMP * (TICKS + 1u) + 9u};
    uint32_t ran = 0, refused = 0;
    size_t bytes = 0;
    e.config.basic.n_workers = 1;
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &e.config, &bytes));
    unsigned char *arena = rig_alloc(bytes), good[4];
    for (uint32_t i = 0; i < sizeof cut / sizeof cut[0]; i++) {
        save(run_to(cut[i]));
        for (uint32_t k = 0; k < 30u * (uint32_t)(sizeof value / sizeof value[0]); k += rig_times(20) < 20u ? 7u : 1u) {
            unsigned char *at = e.saved + e.bytes - 4u - 4u * (1u + k % 30u);
            smr *s = NULL;
            memcpy(good, at, 4);
            smr_log_put32(at, value[k / 30u]);
            unit_save_seal(e.saved, e.bytes);
            const smr_status status = smr_restore(e.model, NULL, NULL, e.saved, e.bytes, arena, bytes, &s);
            assert_true(status == SMR_OK || status == SMR_E_SAVE);
            memcpy(at, good, 4);
            refused += status != SMR_OK;
            ran += status == SMR_OK;
            if (s == NULL || smr_set_surface(s, SMR_ALL, e.surface[0]) != SMR_OK)
                continue;
            for (uint32_t c = 0; c < 6u; c++)
                (void)make(s, c == 3u ? 0u : 1u, 0);
            assert_true(rig_finite(rig_positions(s, e.model), e.source.n_vertices));
        }
    }
    assert_true(ran > rig_times(100) && refused > rig_times(200));
}

/* Words from the end of a save while a target is followed, at the finer radius, and there is nothing to do. */
TEST(test_refused)
{
    static const struct {
        uint32_t from_end, value;
    } forged[] = {
        {8, 0},                             /* tracking: but it is settled */
        {7, 1},                             /* recovering: but it is at tracking's own radius */
        {7, 3},           {3, 0x40a00000u}, /* gain: 5 */
        {2, 0xbf800000u},                   /* found: -1 */
        {1, 0xbf800000u},                   /* noise: -1 mm */
        {15, 1},                            /* done: but it tracks */
        {13, 1},                            /* repaired: but it tracks */
        {21, 1000},                         /* iterations at this radius */
        {22, 0},                            /* radius: coarser, but it does not recover */
    };
    unsigned char good[4];
    size_t bytes = 0;
    e.config.basic.n_workers = 1;
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &e.config, &bytes));
    void *arena = rig_alloc(bytes);
    save(run_to(2u * (TICKS + 1u)));
    for (uint32_t i = 0; i < sizeof forged / sizeof forged[0]; i++) {
        unsigned char *at = e.saved + e.bytes - 4u - 4u * forged[i].from_end;
        smr *s = NULL;
        memcpy(good, at, 4);
        assert_true(smr_log_get32(at) != forged[i].value);
        smr_log_put32(at, forged[i].value);
        unit_save_seal(e.saved, e.bytes);
        if (smr_restore(e.model, NULL, NULL, e.saved, e.bytes, arena, bytes, &s) != SMR_E_SAVE)
            fail_msg("forgery %u is taken", (unsigned)i);
        memcpy(at, good, 4);
    }
}
