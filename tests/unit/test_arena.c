/* test_arena.c: slots in the caller's memory: exact size, one byte less, alignment, sizes that overflow size_t.
 * Under the address sanitiser a poisoned red zone follows each slot; the zones themselves are tested here.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "base/arena.h"
#include "unit_mesh.h"

#if defined(__SANITIZE_ADDRESS__)
#define UNIT_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNIT_ASAN 1
#endif
#endif
#ifdef UNIT_ASAN
int __asan_address_is_poisoned(void const volatile *address);
enum { RED_ZONE = 8 };
#else
enum { RED_ZONE = 0 };
#endif

enum { N_SIZES = 9 };
static const size_t sizes[N_SIZES] = {1, 63, 64, 65, 0, 4, 1000, 12, 128};

static size_t take_all(smr_arena *a, unsigned char *slot[N_SIZES])
{
    for (int i = 0; i < N_SIZES; i++)
        slot[i] = smr_arena_take(a, sizes[i], 1);
    return a->used;
}

TEST(measures_what_it_places)
{
    unsigned char *slot[N_SIZES];
    smr_arena measure = smr_arena_measure(), a;
    const size_t bytes = take_all(&measure, slot);
    size_t want = 0;
    for (int i = 0; i < N_SIZES; i++) {
        assert_null(slot[i]);
        want += (sizes[i] + RED_ZONE + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    }
    assert_int_equal(bytes, want);
    unsigned char *memory = rig_rough(bytes);
    assert_int_equal(smr_arena_start(&a, memory, bytes), SMR_OK);
    assert_int_equal(take_all(&a, slot), bytes);
    assert_true(a.used <= a.capacity);
    for (int i = 0; i < N_SIZES; i++) {
        assert_non_null(slot[i]);
        assert_int_equal((uintptr_t)slot[i] % SMR_ALIGN, 0);
        assert_true(slot[i] >= memory && slot[i] + sizes[i] <= memory + bytes);
        memset(slot[i], i, sizes[i]);
    }
    for (int i = 0; i < N_SIZES; i++) /* nobody wrote into somebody else's slot */
        for (size_t k = 0; k < sizes[i]; k++)
            assert_int_equal(slot[i][k], i);
    smr_arena_release(memory, bytes);
}

TEST(one_byte_less_is_refused)
{
    unsigned char *slot[N_SIZES];
    smr_arena measure = smr_arena_measure(), a;
    const size_t bytes = take_all(&measure, slot);
    void *memory = rig_rough(bytes);
    assert_int_equal(smr_arena_start(&a, memory, bytes - 1u), SMR_OK);
    assert_int_equal(take_all(&a, slot), bytes); /* counts on, so that the need is known */
    assert_null(slot[N_SIZES - 1]);
    assert_true(a.used > a.capacity);
    smr_arena_release(memory, bytes);
}

TEST(refuses_null_and_misaligned)
{
    smr_arena a = {NULL, 7, 7, NULL};
    unsigned char *memory = rig_rough(4096);
    assert_int_equal(smr_arena_start(&a, NULL, 4096), SMR_E_NULL);
    for (size_t off = 1; off < SMR_ALIGN; off++)
        assert_int_equal(smr_arena_start(&a, memory + off, 1024), SMR_E_ALIGN);
    assert_true(a.base == NULL && a.capacity == 7 && a.used == 7);
    a = smr_arena_measure();
    (void)smr_arena_take(&a, SIZE_MAX, 0); /* elements of no bytes fit in any number */
    assert_int_equal(a.used, RED_ZONE > 0 ? SMR_ALIGN : 0);
}

/* Whatever was taken before, a size that does not fit size_t is never forgotten. */
TEST(sizes_beyond_size_t_stick)
{
    static const size_t before[] = {0, 1, 64, SIZE_MAX / 2u, SIZE_MAX - 1024u, SIZE_MAX - 512u, SIZE_MAX - 256u};
    static const size_t then[][2] = {{SIZE_MAX, 2}, {2, SIZE_MAX}, {SIZE_MAX, 1}, {SIZE_MAX / 2u + 2u, 1}, {513, 1}};
    for (size_t i = 0; i < sizeof before / sizeof before[0]; i++) {
        for (size_t k = 0; k < sizeof then / sizeof then[0]; k++) {
            smr_arena a = smr_arena_measure();
            (void)smr_arena_take(&a, before[i], 1);
            const size_t was = a.used;
            (void)smr_arena_take(&a, then[k][0], then[k][1]);
            const int fits = then[k][0] <= (SIZE_MAX - was) / then[k][1]; /* leaving room for rounding aside */
            assert_true(a.used == SIZE_MAX || (fits && a.used > was));
            for (int more = 0; more < 8; more++) {
                const size_t last = a.used;
                (void)smr_arena_take(&a, 100, 1);
                assert_true(a.used == SIZE_MAX || a.used > last);
            }
        }
    }
}

TEST(red_zones_follow_slots)
{
#ifdef UNIT_ASAN
    unsigned char *slot[N_SIZES];
    smr_arena measure = smr_arena_measure(), a;
    const size_t bytes = take_all(&measure, slot);
    unsigned char *memory = rig_rough(bytes);
    assert_int_equal(smr_arena_start(&a, memory, bytes), SMR_OK);
    take_all(&a, slot);
    for (int i = 0; i < N_SIZES; i++) {
        for (size_t k = 0; k < sizes[i]; k++)
            assert_false(__asan_address_is_poisoned(slot[i] + k));
        for (size_t k = 0; k < (size_t)RED_ZONE; k++)
            assert_true(__asan_address_is_poisoned(slot[i] + sizes[i] + k));
    }
    smr_arena_release(memory, bytes);
    for (size_t k = 0; k < bytes; k++)
        assert_false(__asan_address_is_poisoned(memory + k));
#else
    skip(); /* only with the address sanitiser */
#endif
}
