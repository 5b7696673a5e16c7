/* test_experiment_start.c: displaced starts: each landmark of the target is moved by up to 20 mm along every axis.
 * Twenty seeds on the patient, ten on the other person; the short form runs one on the patient.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>

#include "experiment.h"
#include "unit/oracle.h"

#define SPOIL_MM 20.0

static char model[1024];

/* The landmarks as they are (seed 0), or spoiled. */
static const char *write_spoiled(const char *path, uint32_t seed)
{
    const char *const to = experiment_scratch("spoiled.csv");
    oracle_random r = oracle_seed(1000u + seed);
    host_landmarks *const set = test_malloc(sizeof *set);
    host_error error;
    uint32_t i = 0;
    int c = 0;
    EXPERIMENT_NEED(host_landmarks_read(path, set, &error) == 0);
    for (i = 0; seed > 0 && i < set->n; i++)
        for (c = 0; c < 3; c++)
            set->xyz[i][c] += (float)oracle_uniform(&r, -SPOIL_MM, SPOIL_MM);
    EXPERIMENT_NEED(experiment_write_landmarks(to, set));
    test_free(set);
    return to;
}

static experiment_result run(const char *who, uint32_t seed)
{
    const char *const image = experiment_data("thigh_%s/mri_%s.mha", who, who);
    const char *const from = experiment_data("thigh_patient/landmarks_reference.mrk.json");
    const char *const to = experiment_data("thigh_%s/landmarks_%s.mrk.json", who, who);
    const char *const truth = experiment_data("thigh_%s/truth", who);
    const char *words[] = {"--model", model, "--target", image, "--truth", truth, "--landmarks", from, NULL};
    experiment_command c = {{NULL}, 0};
    size_t i = 0;
    if (image == NULL || from == NULL || to == NULL || truth == NULL)
        skip();
    words[8] = write_spoiled(to, seed);
    for (i = 0; i < sizeof words / sizeof words[0]; i++)
        experiment_add(&c, "%s", words[i]);
    return experiment_register(&c, experiment_scratch("spoiled"));
}

static int build(void **state)
{
    const char *const surfaces = experiment_data("hip_thigh_vhm");
    const char *const reference = experiment_data("thigh_patient/mri_reference.mha");
    (void)state;
    if (surfaces == NULL || reference == NULL)
        return 0;
    (void)snprintf(model, sizeof model, "%s", experiment_scratch("thigh.smr"));
    return experiment_build(surfaces, reference, model) ? 0 : -1;
}

typedef struct spread {
    double unspoiled, mean, worst, farthest; /* mm; farthest from the unspoiled */
} spread;

static spread spoil(const char *who, uint32_t seeds)
{
    spread s = {0.0, 0.0, 0.0, 0.0};
    uint32_t seed = 0;
    if (model[0] == '\0')
        skip();
    (void)printf("thigh_%s, landmarks moved by up to %g mm along each axis\n", who, SPOIL_MM);
    for (seed = 0; seed <= seeds; seed++) {
        const experiment_result r = run(who, seed);
        const double mean = experiment_mean(&r);
        char name[32];
        if (seed == 0)
            experiment_print_head();
        (void)snprintf(name, sizeof name, seed == 0 ? "unspoiled" : "seed %u", seed);
        experiment_print(name, &r);
        if (seed == 0) {
            s.unspoiled = mean;
            continue;
        }
        s.mean += mean / seeds;
        s.worst = fmax(s.worst, isnan(mean) ? HUGE_VAL : mean);
        s.farthest = fmax(s.farthest, isnan(mean) ? HUGE_VAL : fabs(mean - s.unspoiled));
    }
    return s;
}

static void patient_from_spoiled_starts(void **state)
{
    const spread s = spoil("patient", experiment_full() ? 20 : 1);
    (void)state;
    experiment_bound("mean over the seeds against the unspoiled", fabs(s.mean - s.unspoiled), 0.1);
    experiment_bound("worst seed", s.worst, 0.5);
    EXPERIMENT_END();
}

static void person_from_spoiled_starts(void **state)
{
    const spread s = spoil("person", 10);
    (void)state;
    experiment_bound("mean over the seeds against the unspoiled", fabs(s.mean - s.unspoiled), 0.5);
    experiment_bound("the farthest seed against the unspoiled", s.farthest, 0.5);
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest quick[] = {
        cmocka_unit_test(patient_from_spoiled_starts),
    };
    const struct CMUnitTest full[] = {
        cmocka_unit_test(patient_from_spoiled_starts),
        cmocka_unit_test(person_from_spoiled_starts),
    };
    return experiment_full() ? cmocka_run_group_tests(full, build, NULL) : cmocka_run_group_tests(quick, build, NULL);
}
