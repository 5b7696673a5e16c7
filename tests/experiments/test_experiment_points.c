/* test_experiment_points.c: clouds of points on one side of a bone, many and few, at once and arriving, with and
 * without normals; with the defaults, from starts that are 8 mm and 8 degrees off.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include "case_points.h"

static void need_data(void)
{
    if (experiment_data("femurs") == NULL || experiment_data("hip_thigh_vhm") == NULL)
        skip();
}

static void finds_the_whole_from_points(void **state)
{
    (void)state;
    need_data();
    assert_int_equal(case_table_points("points bare,points few", "hip_bone", 1, 1), 0);
}

static void all_points(void **state)
{
    (void)state;
    need_data();
    assert_int_equal(case_table_points("", experiment_all() ? "" : "hip,vhm", 1, experiment_all() ? 3 : 1), 0);
}

int main(void)
{
    const struct CMUnitTest quick[] = {cmocka_unit_test(finds_the_whole_from_points)};
    const struct CMUnitTest full[] = {cmocka_unit_test(all_points)};
    return experiment_full() ? cmocka_run_group_tests(full, NULL, NULL) : cmocka_run_group_tests(quick, NULL, NULL);
}
