/* test_save.c: what smr_save() and smr_restore() refuse and leave as it was; how large a save is.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "base/save_fields.h"
#include "log/record/log_format.h"
#include "registration/api/setup.h"
#include "unit/unit_save.h"

static unit_save u;

BEFORE_ALL_TESTS() { unit_save_make(&u, UNIT_SAVE_ALL); }

static smr *restored(int all)
{
    smr_status status;
    smr *s = unit_save_restored(&u, u.saved, u.bytes, all, &status);
    assert_int_equal(SMR_OK, status);
    return s;
}

TEST(test_arguments)
{
    static _Alignas(SMR_ALIGN) unsigned char zero[4096];
    smr *s = unit_save_begin(&u, 1), *out = s, *const none = (smr *)(void *)zero;
    smr_saved_info info;
    uint32_t n;
    size_t bytes;
    assert_int_equal(SMR_E_NULL, smr_save_bytes(NULL, &bytes));
    assert_int_equal(SMR_E_NULL, smr_save_bytes(s, NULL));
    assert_int_equal(SMR_E_STATE, smr_save_bytes(none, &bytes));
    assert_int_equal(SMR_E_NULL, smr_save(NULL, zero, sizeof zero));
    assert_int_equal(SMR_E_NULL, smr_save(s, NULL, 1u << 20));
    assert_int_equal(SMR_E_STATE, smr_save(none, zero, sizeof zero));
    assert_int_equal(SMR_E_NULL, smr_save_info(NULL, u.bytes, &info));
    assert_int_equal(SMR_E_NULL, smr_save_info(u.saved, u.bytes, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_awaited(NULL, &n));
    assert_int_equal(SMR_E_NULL, smr_get_awaited(s, NULL));
    assert_int_equal(SMR_E_STATE, smr_get_awaited(none, &n));
    assert_int_equal(SMR_E_NULL, smr_restore(NULL, NULL, NULL, u.saved, u.bytes, zero, sizeof zero, &out));
    assert_int_equal(SMR_E_NULL, smr_restore(u.model, NULL, NULL, NULL, u.bytes, zero, sizeof zero, &out));
    assert_int_equal(SMR_E_NULL, smr_restore(u.model, NULL, NULL, u.saved, u.bytes, NULL, 1u << 20, &out));
    assert_int_equal(SMR_E_NULL, smr_restore(u.model, NULL, NULL, u.saved, u.bytes, zero, sizeof zero, NULL));
    assert_ptr_equal(s, out);
    assert_int_equal(SMR_OK, smr_get_awaited(s, &n));
    assert_int_equal(0, n);
}

/* Exact size, any alignment, nothing written beyond or when refused; the same bytes each time. */
TEST(test_bytes)
{
    static unsigned char memory[UNIT_SAVE_BYTES + 80u], before[sizeof memory];
    smr *s = unit_save_begin(&u, 7);
    size_t bytes = 0;
    assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes));
    assert_true(bytes == u.bytes && bytes <= sizeof u.saved);
    memset(memory, 0xa5, sizeof memory);
    memcpy(before, memory, sizeof memory);
    assert_int_equal(SMR_E_ARENA, smr_save(s, memory, bytes - 1u));
    assert_int_equal(SMR_E_ARENA, smr_save(s, memory, 0));
    assert_memory_equal(before, memory, sizeof memory);
    for (uint32_t off = 0; off < 9u; off++) {
        memset(memory, 0xa5, sizeof memory);
        assert_int_equal(SMR_OK, smr_save(s, memory + off, bytes));
        assert_memory_equal(before, memory, off);
        assert_memory_equal(u.saved, memory + off, bytes);
        assert_memory_equal(before, memory + off + bytes, sizeof memory - off - bytes);
    }
}

/* Saves with a right checksum whose facts do not fit the model, the values or each other. */
TEST(test_forged_heads)
{
    static unsigned char saved[UNIT_SAVE_BYTES + 8u];
    const uint32_t all = (uint32_t)u.bytes;
    const struct {
        uint32_t word, value, bytes; /* the save's length, at whose end the checksum stands */
        smr_status says;
    } head[] = {
        {SMR_SAVED_AT_BYTES, 8, all, SMR_E_SAVE},
        {SMR_SAVED_AT_BYTES, all - 40u, all - 40u, SMR_E_SAVE},
        {SMR_SAVED_AT_BYTES, all + 4u, all + 4u, SMR_E_SAVE},
        {SMR_SAVED_AT_VERTICES, 7, all, SMR_E_MODEL},
        {SMR_SAVED_AT_PLAN, 7, all, SMR_E_SAVE},
    };
    for (uint32_t i = 0; i < sizeof head / sizeof head[0]; i++) {
        smr_status status;
        memcpy(saved, u.saved, u.bytes);
        assert_non_null(unit_save_restored(&u, saved, u.bytes, 0, &status));
        smr_log_put32(saved + 4u * head[i].word, head[i].value);
        unit_save_seal(saved, head[i].bytes);
        assert_null(unit_save_restored(&u, saved, u.bytes + 4u, 0, &status));
        assert_int_equal(head[i].says, status);
    }
}

/* Values beyond the end of a save are not read, and those before it are. */
TEST(test_ends_within_values)
{
    const unsigned char from[12] = {1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0};
    for (uint32_t n = 1; n <= 3u; n++) {
        uint32_t value[3] = {7, 7, 7};
        smr_keeper k = {.calls = &smr_keep_all, .mode = SMR_KEEP_RESTORE, .from = from, .bytes = 8};
        smr_arena a = {.keeper = &k};
        smr_keep_words(&a, value, n, 3);
        assert_int_equal(n == 3u, k.wrong);
        assert_true(k.at == (n == 3u ? 0u : 4u * n) && value[0] == (n == 3u ? 7u : 1u) && value[2] == 7u);
    }
}

/* A repair of folds is under way, or over, not both: words from the end of a save without tracking. */
TEST(test_forged_repair)
{
    static unsigned char saved[UNIT_SAVE_BYTES];
    for (uint32_t both = 0; both < 4u; both++) {
        smr_status status;
        memcpy(saved, u.saved, u.bytes);
        smr_log_put32(saved + u.bytes - 4u - 4u * 6u, both & 1u);  /* repairing */
        smr_log_put32(saved + u.bytes - 4u - 4u * 5u, both >> 1u); /* repaired */
        unit_save_seal(saved, u.bytes);
        smr *const s = unit_save_restored(&u, saved, u.bytes, 0, &status);
        assert_int_equal(both < 3u ? SMR_OK : SMR_E_SAVE, status);
        assert_true(s == NULL || (s->schedule.repairing == (both & 1u) && s->schedule.repaired == both >> 1u));
    }
}

/* A configuration that says in another way that nothing attracts is the one that was saved. */
TEST(test_no_attraction_in_two_ways)
{
    smr_config config = u.config;
    size_t saved, bytes;
    smr *s;
    config.basic.attract = 0;
    config.basic.n_target_vertices = 500;
    const smr *const first = rig_init(u.model, &config, NULL);
    assert_int_equal(SMR_OK, smr_save_bytes(first, &saved));
    void *const memory = rig_alloc(saved);
    assert_int_equal(SMR_OK, smr_save(first, memory, saved));
    assert_int_equal(SMR_OK, smr_arena_bytes(u.model, &config, &bytes));
    assert_int_equal(SMR_OK, smr_restore(u.model, &config, NULL, memory, saved, rig_alloc(bytes), bytes, &s));
    config.basic.attract = 1;
    assert_int_equal(SMR_E_CONFIG, smr_restore(u.model, &config, NULL, memory, saved, rig_alloc(bytes), bytes, &s));
}

/* The macro is a bound, and not far off. */
TEST(test_macro)
{
    for (uint32_t method = 0; method < 2u; method++) {
        for (uint32_t targets = 0; targets <= 4000u; targets += 4000u) {
            smr_config config = smr_config_default();
            smr_model_info info;
            size_t bytes = 0;
            config.basic.method = config.basic.budget_exact = method;
            config.basic.n_target_vertices = targets;
            config.partial.n_landmarks = targets / 400u;
            assert_int_equal(SMR_OK, smr_model_get_info(u.model, &info));
            assert_int_equal(SMR_OK, smr_save_bytes(rig_init(u.model, &config, NULL), &bytes));
            const size_t most =
                SMR_SAVE_BYTES(info.n_vertices, info.n_structures, targets, config.partial.n_landmarks, method) +
                SMR_SAVE_IMAGE_BYTES(info.n_vertices);
            if (!(bytes <= most && most - bytes < 500u))
                fail_msg("%zu bytes, the macro says %zu", bytes, most);
        }
    }
}

/* ---- when nothing is saved */

static struct within {
    smr *s;
    smr_status status;
} within;

static void save_within(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    static unsigned char memory[UNIT_SAVE_BYTES];
    (void)ctx;
    for (uint32_t i = 0; i < n_tasks; i++)
        run(arg, i, 0);
    within.status = smr_save(within.s, memory, sizeof memory);
}

static void wrong_worker(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    (void)ctx;
    for (uint32_t i = 0; i < n_tasks; i++)
        run(arg, i, 5);
}

TEST(test_states_refused)
{
    static unsigned char memory[UNIT_SAVE_BYTES];
    rig_clock clock;
    const smr_port timed = rig_clock_port(&clock, RIG_CLOCK_STEADY, 700), inside = {NULL, 1, save_within, NULL},
                   wrong = {NULL, 1, wrong_worker, NULL};
    const smr_pose here = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr *s = rig_init(u.model, &u.config, &timed);
    assert_int_equal(SMR_PARTIAL, smr_tick(s, 1, NULL));
    assert_int_equal(SMR_E_STATE, smr_save(s, memory, sizeof memory));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_save(s, memory, sizeof memory));
    within.s = s = rig_init(u.model, &u.config, &inside);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_STATE, within.status);
    s = rig_init(u.model, &u.config, &wrong);
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_STATE, smr_save(s, memory, sizeof memory));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, NULL)); /* which starts the iteration over */
    assert_int_equal(SMR_E_STATE, smr_save(s, memory, sizeof memory));
    assert_int_equal(SMR_OK, smr_set_pose(s, &here));
    assert_int_equal(SMR_OK, smr_save(s, memory, sizeof memory));
    s = restored(0);
    assert_int_equal(SMR_E_STATE, smr_save(s, memory, sizeof memory)); /* inputs are awaited */
    s = rig_init(u.model, &u.config, NULL);
    smr_surface *gone = rig_surface(&u.ball[0]);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, gone));
    memset((void *)gone, 0, 64);
    assert_int_equal(SMR_E_STATE, smr_save(s, memory, sizeof memory));
}

/* ---- when nothing is restored */

static void refused(smr_status expected, const smr_model *model, const smr_config *config, const smr_port *port,
                    const unsigned char *saved, size_t bytes)
{
    static _Alignas(SMR_ALIGN) unsigned char arena[1u << 17];
    smr *const mark = (smr *)(void *)arena, *out = mark;
    memset(arena, 0x5a, sizeof arena);
    assert_int_equal(expected, smr_restore(model, config, port, saved, bytes, arena, sizeof arena, &out));
    assert_ptr_equal(mark, out);
    for (size_t i = 0; i < sizeof arena; i++)
        if (arena[i] != 0x5au)
            fail_msg("byte %zu of the arena was written", i);
}

TEST(test_every_byte)
{
    static unsigned char saved[UNIT_SAVE_BYTES];
    static const unsigned char flip[3] = {1, 0x80, 0xff};
    smr_saved_info info;
    memcpy(saved, u.saved, u.bytes);
    for (size_t i = 0; i < u.bytes; i++) {
        saved[i] = (unsigned char)(saved[i] ^ flip[i % 3u]);
        assert_int_equal(SMR_E_SAVE, smr_save_info(saved, u.bytes, &info));
        if (i % 251u == 0u)
            refused(SMR_E_SAVE, u.model, NULL, NULL, saved, u.bytes);
        saved[i] = u.saved[i];
    }
    for (size_t bytes = 0; bytes < u.bytes; bytes += bytes < 400u || bytes + 9u > u.bytes ? 1u : 7u)
        assert_int_equal(SMR_E_SAVE, smr_save_info(saved, bytes, &info));
    refused(SMR_E_SAVE, u.model, NULL, NULL, saved, u.bytes - 1u);
    refused(SMR_E_SAVE, u.model, NULL, NULL, saved, 0);
    assert_int_equal(SMR_OK, smr_save_info(saved, sizeof saved, &info)); /* what lies behind it does not matter */
    assert_true(info.bytes == u.bytes);
}

/* A save with a setting out of range is refused as such a configuration is, whichever setting it is. */
TEST(test_every_setting)
{
    static unsigned char saved[UNIT_SAVE_BYTES];
    const size_t end = SMR_SAVED_FIXED + 4u * (size_t)smr_log_get32(u.saved + 4u * SMR_SAVED_AT_CONFIG_WORDS);
    uint32_t n = 0;
    for (size_t at = SMR_SAVED_FIXED; at < end; at += 4u + 4u * (size_t)(smr_log_get32(u.saved + at) >> 16)) {
        smr_saved_info info;
        size_t bytes;
        memcpy(saved, u.saved, u.bytes);
        smr_log_put32(saved + at + 4u, UINT32_MAX); /* no number, or too many */
        unit_save_seal(saved, u.bytes);
        assert_int_equal(SMR_OK, smr_save_info(saved, u.bytes, &info));
        if (smr_arena_bytes(u.model, &info.config, &bytes) == SMR_OK)
            continue;
        refused(SMR_E_CONFIG, u.model, NULL, NULL, saved, u.bytes);
        n++;
    }
    assert_true(n > 60u);
}

TEST(test_others_refused)
{
    const smr_prepare_config radii = rig_radii(2, 40.0f, 15.0f, 0.0f);
    const smr_model *other = rig_model(u.ball, 2, &radii);
    const smr_port many = {NULL, 2, NULL, NULL};
    smr_config config = u.config;
    refused(SMR_E_MODEL, other, NULL, NULL, u.saved, u.bytes);
    refused(SMR_E_CONFIG, u.model, NULL, &many, u.saved, u.bytes); /* saved with one worker */
    config.motion.momentum += 0.01f;
    refused(SMR_E_CONFIG, u.model, &config, NULL, u.saved, u.bytes);
    config = u.config;
    config.cookie++;
    refused(SMR_E_CONFIG, u.model, &config, NULL, u.saved, u.bytes);
    config = u.config;
    config.basic.n_workers = SMR_WORKERS_MAX + 1u;
    refused(SMR_E_CONFIG, u.model, &config, NULL, u.saved, u.bytes);
}

TEST(test_arena)
{
    smr_config config = u.config;
    size_t bytes = 0;
    smr *out = NULL;
    config.basic.n_workers = 3;
    assert_int_equal(SMR_OK, smr_arena_bytes(u.model, &config, &bytes));
    unsigned char *arena = rig_alloc(bytes + 64u);
    assert_int_equal(SMR_E_ARENA, smr_restore(u.model, &config, NULL, u.saved, u.bytes, arena, bytes - 1u, &out));
    assert_int_equal(SMR_E_ALIGN, smr_restore(u.model, &config, NULL, u.saved, u.bytes, arena + 1, bytes, &out));
    assert_null(out);
    assert_int_equal(SMR_OK, smr_restore(u.model, &config, NULL, u.saved, u.bytes, arena, bytes, &out));
}
