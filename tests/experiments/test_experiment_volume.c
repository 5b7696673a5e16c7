/* test_experiment_volume.c: volumes that are kept, on real surfaces: each structure's volume is what was asked for, and
 * how much farther from the target that takes the surface. The area times the mean distance is at least what the
 * volumes differ by, so volumes of the rest shape have a distance that no method falls below. Smoothing: onto surfaces
 * with noise, measured to those without. The short form takes two structures.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "case.h"
#include "experiment.h"

#define N_MOST 24

static const char *const all_names[N_MOST] = {"femur",
                                              "sartorius",
                                              "vastus_lateralis",
                                              "gluteus_medius",
                                              "adductor_brevis",
                                              "adductor_longus",
                                              "adductor_magnus",
                                              "patella",
                                              "biceps_femoris_short",
                                              "biceps_femoris_long",
                                              "gluteus_maximus",
                                              "gluteus_minimus",
                                              "gracilis",
                                              "hip_bone",
                                              "iliacus",
                                              "pectineus",
                                              "obturator_internus",
                                              "psoas_major",
                                              "rectus_femoris",
                                              "semimembranosus",
                                              "semitendinosus",
                                              "vastus_medialis",
                                              "tensor_fasciae_latae",
                                              "vastus_intermedius"};
static uint32_t n_names;
static double rest[N_MOST], truth[N_MOST], truth_area[N_MOST];

static void read_mesh(host_mesh *mesh, const char *path)
{
    host_error error = {0};
    EXPERIMENT_NEED(path != NULL && host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, mesh, &error) == 0);
}

static double volume_of(const char *path, double *area)
{
    host_mesh mesh;
    double sum = 0.0;
    uint32_t k = 0, c = 0, a = 0;
    read_mesh(&mesh, path);
    for (k = 0; k < mesh.n_triangles; k++) {
        double p[3][3];
        for (c = 0; c < 3; c++)
            for (a = 0; a < 3; a++)
                p[c][a] = (double)mesh.xyz[3u * mesh.triangles[3u * k + c] + a] - (double)mesh.xyz[a];
        sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
               p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    if (area != NULL)
        *area = case_area(&mesh);
    host_mesh_free(&mesh);
    return sum / 6.0;
}

/* Volumes of model and truth; skips without the data. */
static void need_data(void)
{
    uint32_t i = 0;
    n_names = experiment_full() ? N_MOST : 2;
    if (experiment_data("hip_thigh_vhm") == NULL || experiment_data("thigh_patient/truth") == NULL)
        skip();
    for (i = 0; i < n_names; i++) {
        rest[i] = volume_of(experiment_data("hip_thigh_vhm/%s.ply", all_names[i]), NULL);
        truth[i] = volume_of(experiment_data("thigh_patient/truth/%s.ply", all_names[i]), &truth_area[i]);
    }
}

/* Registers onto the patient's surfaces, or those in `noisy`, with volumes of ratio[i] over the rest shape's; NULL: not
 * kept. */
static experiment_result run(const char *out, const double *ratio, const char *noisy, double smooth)
{
    experiment_command c = {{NULL}, 0};
    char to[512];
    uint32_t i = 0;
    (void)snprintf(to, sizeof to, "%s", out); /* texts of scratch paths do not stay long */
    experiment_add(&c, "--model");
    for (i = 0; i < n_names; i++)
        experiment_add(&c, "%s", experiment_data("hip_thigh_vhm/%s.ply", all_names[i]));
    experiment_add(&c, "--target");
    for (i = 0; i < n_names; i++)
        if (noisy != NULL)
            experiment_add(&c, "%s/%s.ply", noisy, all_names[i]);
        else
            experiment_add(&c, "%s", experiment_data("thigh_patient/truth/%s.ply", all_names[i]));
    experiment_add(&c, "--align");
    experiment_add(&c, "rigid");
    experiment_add(&c, "--smooth");
    experiment_add(&c, "%g", smooth);
    if (ratio != NULL)
        experiment_add(&c, "--volume-ratio");
    for (i = 0; ratio != NULL && i < n_names; i++)
        experiment_add(&c, "%s=%.9g", all_names[i], ratio[i]);
    const experiment_result r = experiment_register(&c, to);
    experiment_print(strrchr(to, '/') + 1, &r);
    return r;
}

/* The largest deviation from what was asked for, as a share of it. */
static double worst_of(const char *out, const double *ratio)
{
    double worst = 0.0;
    char path[640];
    uint32_t i = 0;
    for (i = 0; i < n_names; i++) {
        (void)snprintf(path, sizeof path, "%s/%s.ply", out, all_names[i]);
        const double off = fabs(volume_of(path, NULL) / (ratio[i] * rest[i]) - 1.0);
        worst = off > worst ? off : worst;
    }
    (void)printf("  largest deviation from the volume asked for: %.4f %%\n", 100.0 * worst);
    return worst;
}

static void keeps_volumes(void **state)
{
    double ratio[N_MOST], differ = 0.0, area = 0.0;
    char out[512];
    uint32_t i = 0;
    (void)state;
    need_data();
    experiment_print_head();
    const experiment_result off = run(experiment_scratch("off"), NULL, NULL, 0.0);
    for (i = 0; i < n_names; i++)
        ratio[i] = truth[i] / rest[i];
    (void)snprintf(out, sizeof out, "%s", experiment_scratch("the_targets"));
    const experiment_result same = run(out, ratio, NULL, 0.0);
    experiment_bound("the target's volumes", worst_of(out, ratio), 0.01);
    experiment_bound("the target's volumes: distance", experiment_mean(&same), experiment_mean(&off) + 0.05);
    experiment_bound("the target's volumes: folds", same.folds, off.folds);
    for (i = 0; i < n_names; i++) {
        ratio[i] = 1.0;
        differ += fabs(truth[i] - rest[i]);
        area += truth_area[i];
    }
    (void)snprintf(out, sizeof out, "%s", experiment_scratch("at_rest"));
    const experiment_result kept = run(out, ratio, NULL, 0.0);
    experiment_bound("volumes at rest", worst_of(out, ratio), 0.01);
    (void)printf("  volumes differ by %.3f mm of the area in the mean: no distance can be much less\n", differ / area);
    experiment_bound("volumes at rest: distance", experiment_mean(&kept), differ / area + 0.1);
    experiment_bound("volumes at rest: folds", kept.folds, off.folds);
    for (i = 0; i < n_names; i++)
        ratio[i] = 0.8 + 0.45 * (double)i / (double)(n_names - 1u);
    (void)snprintf(out, sizeof out, "%s", experiment_scratch("0.8_to_1.25"));
    const experiment_result asked = run(out, ratio, NULL, 0.0);
    experiment_bound("ratios of 0.8 to 1.25", worst_of(out, ratio), 0.01);
    experiment_bound("ratios of 0.8 to 1.25: folds", asked.folds, off.folds);
    EXPERIMENT_END();
}

/* The patient's surfaces with noise of this deviation along each axis, written to the directory. */
static void write_noisy(const char *directory, double deviation)
{
    oracle_random random = oracle_seed(7);
    char path[640];
    uint32_t i = 0, k = 0;
    EXPERIMENT_NEED(experiment_directory(directory));
    for (i = 0; i < n_names; i++) {
        host_mesh mesh;
        host_buffer buffer = {0};
        read_mesh(&mesh, experiment_data("thigh_patient/truth/%s.ply", all_names[i]));
        for (k = 0; k < 3u * mesh.n_vertices; k++)
            mesh.xyz[k] += (float)(deviation * case_normal_random(&random));
        host_mesh_write(&mesh, HOST_FORMAT_PLY, &buffer);
        (void)snprintf(path, sizeof path, "%s/%s.ply", directory, all_names[i]);
        FILE *const file = fopen(path, "wb");
        EXPERIMENT_NEED(file != NULL && fwrite(buffer.data, 1, buffer.size, file) == buffer.size);
        EXPERIMENT_NEED(fclose(file) == 0);
        host_buffer_free(&buffer);
        host_mesh_free(&mesh);
    }
}

/* Mean distance from the result to the surfaces without noise. */
static double to_clean(const char *out)
{
    double sum = 0.0, mean = 0.0, most = 0.0;
    char path[640];
    uint32_t i = 0;
    for (i = 0; i < n_names; i++) {
        host_mesh result, clean;
        (void)snprintf(path, sizeof path, "%s/%s.ply", out, all_names[i]);
        read_mesh(&result, path);
        read_mesh(&clean, experiment_data("thigh_patient/truth/%s.ply", all_names[i]));
        EXPERIMENT_NEED(experiment_distance(&result, NULL, &clean, &mean, &most));
        sum += mean / (double)n_names;
        host_mesh_free(&result);
        host_mesh_free(&clean);
    }
    return sum;
}

static void smooths_noise(void **state)
{
    static const double share[] = {0.0, 0.5, 0.2, 0.7};
    const uint32_t n = experiment_full() ? 4 : 2;
    double plain = 0.0, clean = 0.0;
    char out[512], noisy[512];
    uint32_t i = 0;
    (void)state;
    need_data();
    n_names = experiment_full() ? 5 : 1;
    (void)snprintf(noisy, sizeof noisy, "%s", experiment_scratch("noisy"));
    write_noisy(noisy, 1.0);
    experiment_print_head();
    for (i = 0; i < n; i++) {
        (void)snprintf(out, sizeof out, "%s", experiment_scratch("smooth_%g", share[i]));
        (void)run(out, NULL, noisy, share[i]);
        clean = to_clean(out);
        (void)printf("  noise of 1 mm, smooth %.1f: %.3f mm from the surfaces without it\n", share[i], clean);
        if (i == 0)
            plain = clean;
        else if (i == 1)
            experiment_bound("half is smoothed: over none", clean / plain, 0.75);
    }
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(keeps_volumes), cmocka_unit_test(smooths_noise)};
    return cmocka_run_group_tests_name("volume", tests, NULL, NULL);
}
