/* test_experiment_fusing.c: real femurs, and in the full form a thigh onto its patient's surfaces, fused by matrices
 * and by logarithms, with an elastic and a plastic reference: as close, and nothing folds more.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>

#include "experiment.h"

typedef struct onto {
    const char *name, *model, *target; /* surfaces or directories of them */
    int directories;
} onto;

static experiment_result run(const onto *o, const char *every, const char *method, const char *fusing)
{
    const char *const model = experiment_data("%s", o->model), *const target = experiment_data("%s", o->target);
    experiment_command c = {{NULL}, 0};
    if (model == NULL || target == NULL)
        skip();
    experiment_add(&c, "--model");
    if (o->directories)
        experiment_add_surfaces(&c, model);
    else
        experiment_add(&c, "%s", model);
    experiment_add(&c, "--target");
    if (o->directories)
        experiment_add_surfaces(&c, target);
    else
        experiment_add(&c, "%s", target);
    if (o->directories) {
        experiment_add(&c, "--landmarks");
        experiment_add(&c, "%s", experiment_data("thigh_patient/landmarks_reference.mrk.json"));
        experiment_add(&c, "%s", experiment_data("thigh_patient/landmarks_patient.mrk.json"));
    } else {
        experiment_add(&c, "--align");
        experiment_add(&c, "similarity");
    }
    const char *const words[] = {"--plastic-every", every, "--method", method, "--fusing", fusing};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        experiment_add(&c, "%s", words[i]);
    return experiment_register(&c, experiment_scratch("fused"));
}

static void compare(const onto *o, const char *every, const char *method, double apart)
{
    char name[80];
    const experiment_result linear = run(o, every, method, "linear"), lie = run(o, every, method, "lie");
    (void)snprintf(name, sizeof name, "%s, plastic-every %s, %s", o->name, every, method);
    experiment_print(name, &linear);
    experiment_print("the same by logarithms", &lie);
    assert_true(experiment_written(linear.status) && experiment_written(lie.status));
    experiment_bound("means differ by", fabs(experiment_mean(&lie) - experiment_mean(&linear)), apart);
    experiment_bound("more folds", lie.folds - linear.folds, 0);
}

static const onto femurs = {"femur", "femurs/femur_2007_5028_left_3k.ply", "femurs/femur_2008_0019_left_3k.ply", 0};

static void femurs_are_as_close(void **state)
{
    (void)state;
    experiment_print_head();
    compare(&femurs, "0", "rigid", 0.005);
    EXPERIMENT_END();
}

static void all_are_as_close(void **state)
{
    static const onto thigh = {"thigh", "hip_thigh_vhm", "thigh_patient/truth", 1};
    (void)state;
    experiment_print_head();
    compare(&femurs, "1", "rigid", 0.002);
    compare(&femurs, "0", "polar", 0.02);
    compare(&thigh, "1", "rigid", 0.005);
    compare(&thigh, "0", "rigid", 0.005);
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest quick[] = {cmocka_unit_test(femurs_are_as_close)};
    const struct CMUnitTest all[] = {cmocka_unit_test(femurs_are_as_close), cmocka_unit_test(all_are_as_close)};
    return experiment_all() ? cmocka_run_group_tests(all, NULL, NULL) : cmocka_run_group_tests(quick, NULL, NULL);
}
