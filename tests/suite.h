/* suite.h: what a test program is made of: tests that register themselves, and one end of each. A program defines
 * TEST(name) { ... } as often as it likes, and BEFORE_EACH_TEST() { ... } or BEFORE_ALL_TESTS() { ... } at most once.
 * After each test, or after all, all memory of the rig is given back. suite_main.c has main().
 * SPDX-License-Identifier: MIT */
#ifndef SUITE_H
#define SUITE_H

#include <stdlib.h>
#include "property/rig.h"
#include "unit/cmocka_first.h"

enum { SUITE_MOST = 48 };
static struct CMUnitTest suite_test[SUITE_MOST];
static size_t suite_count;

/* setup: what runs before the test, or NULL. */
static inline void suite_add(const char *name, CMUnitTestFunction function, CMFixtureFunction setup)
{
    if (suite_count == SUITE_MOST)
        abort();
    suite_test[suite_count++] = (struct CMUnitTest){name, function, setup, NULL, NULL};
}

#define TEST(name)                                                                                                     \
    static void name(void **state);                                                                                    \
    __attribute__((constructor)) static void suite_add_##name(void) { suite_add(#name, name, NULL); }                  \
    static void name(__attribute__((unused)) void **state)

static void (*suite_before)(void);
static inline int suite_set_up(void **state)
{
    (void)state;
    suite_before();
    return 0;
}

#define BEFORE_EACH_TEST()                                                                                             \
    static void suite_begin(void);                                                                                     \
    __attribute__((constructor)) static void suite_set_before(void) { suite_before = suite_begin; }                    \
    static void suite_begin(void)

#define BEFORE_ALL_TESTS()                                                                                             \
    int main(void) { return suite_run(suite_set_up, suite_free); }                                                     \
    BEFORE_EACH_TEST()

static inline int suite_free(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

/* set_up, tear_down: once for the whole program, or NULL; memory of the rig then lives until tear_down. Returns how
 * many tests failed. */
int suite_run(CMFixtureFunction set_up, CMFixtureFunction tear_down);
int suite_run(CMFixtureFunction set_up, CMFixtureFunction tear_down)
{
    for (size_t i = 0; i < suite_count && set_up == NULL; i++) {
        suite_test[i].teardown_func = suite_free;
        if (suite_before != NULL)
            suite_test[i].setup_func = suite_set_up;
    }
    return _cmocka_run_group_tests("tests", suite_test, suite_count, set_up, tear_down);
}

#endif
