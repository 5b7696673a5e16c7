/* test_fuzz.c: the fuzz targets as a regression test: a corpus made here, and mutations of it that are the same every
 * time. SMR_FUZZ_CORPUS=dir writes the seeds there (model-N, mesh-N, log-N, save-N) for a real fuzzer to start from.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fuzz/fuzz_log.c"
#include "fuzz/fuzz_mesh.c"
#include "fuzz/fuzz_model_open.c"
#include "fuzz/fuzz_save.c"

#define SEEDS 6u

static void save(const char *kind, uint32_t number, const void *bytes, size_t size)
{
    const char *folder = getenv("SMR_FUZZ_CORPUS");
    char path[512];
    if (folder == NULL)
        return;
    (void)snprintf(path, sizeof path, "%s/%s-%u", folder, kind, (unsigned)number);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

/* Small models of every kind: orders, both distances, one and two structures, several shapes, points only. */
static unit_image seed_image(uint32_t number)
{
    oracle_random r = oracle_seed(200u + number);
    unit_mesh a = number == 5u ? unit_points(&r, 9, 0.0f, 9.0f) : unit_sphere(0, 4.0f, 1.0f);
    unit_mesh b = unit_grid(2, 1u + number % 2u, 3.0f);
    const smr_structure two[2] = {{"a", unit_view(&a)}, {"b", unit_view(&b)}};
    smr_prepare_config c = smr_prepare_config_default();
    c.order = number & 1u;
    c.distance = number >> 1 & 1u;
    c.n_radii = 1u + number % 3u;
    for (uint32_t i = 0; i < c.n_radii; i++)
        c.radius_mm[i] = 6.0f / (float)(i + 1u);
    float further[2][64][3];
    const smr_subjects subjects = {further[0][0], number == 4u ? 2u : 0u};
    for (uint32_t i = 0; i < 2u * 64u; i++)
        oracle_within_box(&r, -4.0f, 4.0f, further[i / 64u][i % 64u]);
    c.also = &subjects;
    unit_image image = unit_prepare(two, number > 3u ? 1u : 2u, &c);
    unit_mesh_free(&a);
    unit_mesh_free(&b);
    return image;
}

TEST(models)
{
    oracle_random r = oracle_seed(201);
    uint32_t opened = 0;
    assert_int_equal(fuzz_model_open(NULL, 0), 0);
    for (uint32_t number = 0; number < SEEDS; number++) {
        unit_image seed = seed_image(number);
        uint8_t *copy = rig_rough(seed.size);
        save("model", number, seed.bytes, seed.size);
        assert_int_equal(fuzz_model_open(seed.bytes, seed.size), 1);
        for (uint32_t i = 0; i < 1200u; i++) {
            memcpy(copy, seed.bytes, seed.size);
            size_t size = seed.size;
            for (uint32_t k = 1u + oracle_below(&r, 3u); k > 0u; k--) {
                const uint32_t at = oracle_below(&r, (uint32_t)size), from = oracle_below(&r, (uint32_t)size);
                switch (oracle_below(&r, 4u)) {
                case 0: copy[at] = (uint8_t)oracle_next(&r); break;
                case 1: copy[at] = (uint8_t)(copy[at] + 1u); break;
                case 2: copy[at / 4u * 4u] = copy[from / 4u * 4u]; break;
                default: size -= i % 16u == 0u && size > 64u ? 32u : 0u; break;
                }
            }
            const int result = fuzz_model_open(copy, size);
            assert_true(result >= 0);
            opened += (uint32_t)result;
        }
        rig_free(copy);
        unit_image_free(&seed);
    }
    assert_true(opened > 100u); /* changes are small enough to get through at times */
}

TEST(meshes)
{
    oracle_random r = oracle_seed(202);
    uint32_t accepted = 0;
    for (uint32_t number = 0; number < 1500u; number++) {
        uint8_t bytes[900];
        const uint32_t size = oracle_below(&r, sizeof bytes);
        for (uint32_t i = 0; i < size; i++)
            bytes[i] = (uint8_t)oracle_next(&r);
        for (uint32_t i = 16; i < size && number % 2u; i += 2u) /* half of them small and dense, with many copies */
            bytes[i + 1u < size ? i + 1u : i] = (uint8_t)(128u + oracle_below(&r, 2u));
        if (number < SEEDS)
            save("mesh", number, bytes, size);
        const int result = fuzz_mesh(bytes, size);
        if (result < 0)
            fail_msg("mesh %u", (unsigned)number);
        accepted += (uint32_t)result;
    }
    assert_true(accepted > 700u);
}

/* A seed for each kind of record: the log up to and with the first one of it. */
static void save_kinds(const unit_log *seed, uint32_t n)
{
    for (uint32_t i = 0, known = 0; i < n; i++) {
        size_t bytes;
        const size_t at = unit_log_record(seed->log, seed->bytes, i, &bytes);
        if ((known >> seed->log[at] & 1u) == 0u)
            save("log", 1u + seed->log[at], seed->log + SMR_LOG_HEADER, at + bytes - SMR_LOG_HEADER);
        known |= 1u << seed->log[at];
    }
}

/* Records of a real log: bytes changed, records copied over others, the end cut off. */
TEST(logs)
{
    static unit_log seed;
    static uint8_t copy[UNIT_LOG_BYTES];
    oracle_random r = oracle_seed(203);
    uint32_t repeated = 0;
    unit_log_make_kinds(&seed, 1);
    const uint32_t n = unit_log_records(seed.log, seed.bytes);
    const uint8_t *records = seed.log + SMR_LOG_HEADER;
    const uint32_t whole = (uint32_t)(seed.bytes - SMR_LOG_HEADER);
    save("log", 0, records, whole);
    save("log", 1, seed.log + SMR_LOG_FIXED, 4u * SMR_LOG_CONFIG_WORDS); /* a header's configuration */
    save_kinds(&seed, n);
    assert_true(fuzz_log(seed.log + SMR_LOG_FIXED, 4u * SMR_LOG_CONFIG_WORDS) == 0);
    assert_int_equal(fuzz_log(NULL, 0), 1);
    assert_int_equal(fuzz_log(records, whole), 1);
    for (uint32_t i = 0; i < 1500u; i++) {
        uint32_t size = whole;
        memcpy(copy, records, whole);
        for (uint32_t k = 1u + oracle_below(&r, 3u); k > 0u; k--) {
            size_t to_bytes, from_bytes;
            const size_t to = unit_log_record(seed.log, seed.bytes, oracle_below(&r, n), &to_bytes) - SMR_LOG_HEADER;
            const size_t from =
                unit_log_record(seed.log, seed.bytes, oracle_below(&r, n), &from_bytes) - SMR_LOG_HEADER;
            switch (oracle_below(&r, 4u)) {
            case 0: copy[oracle_below(&r, size)] = (uint8_t)oracle_next(&r); break;
            case 1: copy[to + 4u + oracle_below(&r, 8u)] ^= (uint8_t)(1u << oracle_below(&r, 8u)); break;
            case 2: memcpy(copy + to, records + from, to_bytes < from_bytes ? to_bytes : from_bytes); break;
            default: size = (uint32_t)to + 1u; break;
            }
        }
        const int result = fuzz_log(copy, size);
        if (result < 0)
            fail_msg("log %u", (unsigned)i);
        repeated += (uint32_t)result;
    }
    assert_true(repeated > 100u);
    for (uint32_t i = 0; i < 500u; i++) { /* settings of a header */
        memcpy(copy, seed.log + SMR_LOG_FIXED, 4u * SMR_LOG_CONFIG_WORDS);
        copy[oracle_below(&r, 4u * SMR_LOG_CONFIG_WORDS)] = (uint8_t)oracle_next(&r);
        assert_int_equal(fuzz_log(copy, 4u * (1u + oracle_below(&r, SMR_LOG_CONFIG_WORDS))), 0);
    }
    rig_free_all();
}

/* Kept values of real saves, behind a byte that says which: bytes and words changed, copied, cut off. */
TEST(saves)
{
    static uint8_t copy[1u + UNIT_SAVE_BYTES];
    oracle_random r = oracle_seed(204);
    uint32_t restored = 0;
    assert_int_equal(fuzz_save(NULL, 0), 1);
    for (uint32_t i = 0; i < 400u; i++) {
        const unit_save *u = fuzz_saved(i);
        size_t end = 0;
        const size_t first = unit_save_values(u->saved, &end), whole = end - first;
        uint8_t *values = copy + 1;
        copy[0] = (uint8_t)i;
        memcpy(values, u->saved + first, whole);
        if (i < 2u)
            save("save", i, copy, 1u + whole);
        for (uint32_t k = 1u + oracle_below(&r, 3u); k > 0u; k--) {
            const uint32_t from = oracle_below(&r, (uint32_t)whole / 4u), to = oracle_below(&r, (uint32_t)whole / 4u);
            const uint32_t last = (uint32_t)whole - 1u - oracle_below(&r, 300u);
            switch (oracle_below(&r, 3u)) {
            case 0: values[4u * to + oracle_below(&r, 4u)] = (uint8_t)oracle_next(&r); break;
            case 1: values[last] = (uint8_t)(values[last] + 1u); break;
            default: memmove(values + 4u * (size_t)to, values + 4u * (size_t)from, 4u); break;
            }
        }
        const int result = fuzz_save(copy, 2u + oracle_below(&r, (uint32_t)whole));
        if (result < 0)
            fail_msg("save %u", (unsigned)i);
        restored += (uint32_t)result;
    }
    assert_true(restored > 50u);
    rig_free_all();
}
