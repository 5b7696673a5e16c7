/* test_hostile_save.c: a save is forged word by word and by many words at once, with a right checksum: it is refused,
 * or the registration runs on and every position stays finite.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "base/arena.h"
#include "base/bytes.h"
#include "fuzz/fuzz_save.c"

static const uint32_t hostile[] = {
    0xffffffffu, 0x7fc00000u, 0x7f800000u, 0xff800000u, 0x7f7fffffu,
    0x00000001u, 0x80000000u, 0x49f42400u, 0xc9f42400u, /* +-2e6, the farthest */
    0x3f800000u, 0x000000ffu, 0x0000ffffu, 0x00989680u,
};

static unit_save whole;

#define HOSTILE (sizeof hostile / sizeof hostile[0])

static void put(unsigned char *to, uint32_t word)
{
    word = smr_le32(word);
    memcpy(to, &word, sizeof word);
}

/* Of the arrays every STRIDE-th word, of the fields behind them each one; fewer values where rig_times() is a tenth. */
#define STRIDE (rig_times(20) < 20u ? 305u : 61u)
#define VALUES(all) (rig_times(20) < 20u ? 3u : all)

TEST(test_words)
{
    static unsigned char values[UNIT_SAVE_BYTES];
    size_t end = 0;
    uint32_t ran = 0, refused = 0;
    const unit_save *u = &whole;
    const size_t first = unit_save_values(u->saved, &end), n = end - first, fields = n - 400u;
    for (size_t at = 0; at + 4u <= n; at += at < fields ? 4u * STRIDE : 4u) {
        for (uint32_t k = at < fields ? (uint32_t)(at / 4u % 3u) : 0u; k < HOSTILE;
             k += VALUES(at < fields ? 3u : 1u)) {
            memcpy(values, u->saved + first, n);
            put(values + at, hostile[k]);
            const int result = fuzz_save_of(u, values, n);
            if (result < 0)
                fail_msg("word %zu as %08x", at / 4u, (unsigned)hostile[k]);
            ran += (uint32_t)result;
            refused += !result;
        }
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u forged saves ran, %u were refused\n", ran, refused);
    assert_true(ran > rig_times(100) && refused > rig_times(300));
}

/* Whole runs of words at once, at the ends of their ranges. */
TEST(test_runs_of_words)
{
    static unsigned char values[UNIT_SAVE_BYTES];
    static const uint32_t legal[] = {0x49f42400u, 0xc9f42400u, 0, 0x49742400u, 1, 0xffffffffu};
    size_t end = 0;
    uint32_t seed = 5, ran = 0;
    const unit_save *u = &whole;
    const size_t first = unit_save_values(u->saved, &end), n = end - first;
    for (uint32_t i = 0; i < rig_times(300); i++) {
        memcpy(values, u->saved + first, n);
        for (uint32_t k = 0; k < 1u + i % 4u; k++) {
            const uint32_t from = rig_random(&seed, (uint32_t)n / 4u - 200u), mix = rig_random(&seed, 2);
            uint32_t word = legal[rig_random(&seed, 6)];
            for (uint32_t j = 0; j < 200u; j++) {
                word = mix ? legal[rig_random(&seed, 6)] : word;
                put(values + 4u * (size_t)(from + j), word);
            }
        }
        const int result = fuzz_save_of(u, values, n);
        assert_true(result >= 0);
        ran += (uint32_t)result;
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u forged saves ran\n", ran);
    assert_true(ran > 12u || rig_times(300) < 300u);
}

/* A ball in motion, and its save: within a time step, and once with a pinned vertex. */
static struct moving {
    const smr_model *model;
    const smr_surface *surface;
    smr_config config;
    uint32_t n;
    unsigned char saved[UNIT_SAVE_BYTES + SMR_SAVE_DYNAMICS_BYTES(200, 1)];
    size_t bytes;
} moving;

static void make_moving(void)
{
    static float mass[200], velocity[3 * 200];
    const float at[3] = {0, 0, 0}, off[3] = {3, -2, 1};
    const smr_prepare_config prepare = rig_radii(2, 40.0f, 15.0f, 0.0f);
    const smr_mesh ball = rig_ball(20.0f, 7, 10, at), goal = rig_ball(22.0f, 8, 11, off);
    moving.n = ball.n_vertices;
    moving.model = rig_model(&ball, 1, &prepare);
    moving.surface = rig_surface(&goal);
    moving.config = smr_config_default();
    moving.config.basic.n_target_vertices = 200;
    moving.config.dynamics.mode = SMR_DYNAMICS_ON;
    moving.config.dynamics.gravity[2] = -9810.0f;
    for (uint32_t i = 0; i < moving.n; i++)
        mass[i] = i == 3u ? INFINITY : 2.0f;
    smr *s = rig_init(moving.model, &moving.config, NULL);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, mass, velocity));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, moving.surface));
    for (uint32_t i = 0; i < 3u * SMR_SWEEPS + 3u; i++)
        (void)smr_tick(s, 0, NULL);
    assert_int_equal(SMR_OK, smr_save_bytes(s, &moving.bytes));
    assert_int_equal(SMR_OK, smr_save(s, moving.saved, sizeof moving.saved));
}

/* 1: the forged save ran, 0: it was refused. */
static int run_moving(const unsigned char *saved)
{
    static _Alignas(SMR_ALIGN) unsigned char arena[1u << 18];
    smr_energy energy;
    smr *s = NULL;
    const smr_status status = smr_restore(moving.model, NULL, NULL, saved, moving.bytes, arena, sizeof arena, &s);
    assert_true(status == SMR_OK || status == SMR_E_SAVE);
    if (s == NULL)
        return 0;
    (void)smr_set_surface(s, SMR_ALL, moving.surface);
    for (uint32_t i = 0; i < 2u * SMR_SWEEPS; i++) {
        (void)smr_tick(s, 0, NULL);
        assert_true(rig_finite(rig_positions(s, moving.model), moving.n));
    }
    (void)smr_get_energy(s, &energy);
    smr_arena_release(arena, sizeof arena); /* red zones */
    return 1;
}

/* Words of the arrays, every field behind them, as test_words() has them. */
TEST(test_moving)
{
    static unsigned char saved[sizeof moving.saved];
    uint32_t ran = 0, refused = 0;
    size_t end = 0;
    const size_t first = unit_save_values(moving.saved, &end), fields = end - 400u;
    for (size_t at = first; at + 4u <= end; at += at < fields ? 4u * STRIDE : 4u)
        for (uint32_t k = at < fields ? (uint32_t)(at / 4u % 2u) : 0u; k < HOSTILE;
             k += VALUES(at < fields ? 2u : 1u)) {
            memcpy(saved, moving.saved, moving.bytes);
            put(saved + at, hostile[k]);
            unit_save_seal(saved, moving.bytes);
            const int result = run_moving(saved);
            ran += (uint32_t)result;
            refused += !result;
        }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u forged saves in motion ran, %u were refused\n", ran, refused);
    assert_true(ran > rig_times(50) && refused > rig_times(150));
}

/* Kept for all tests. */
BEFORE_ALL_TESTS()
{
    unit_save_make(&whole, UNIT_SAVE_ALL);
    make_moving();
}
