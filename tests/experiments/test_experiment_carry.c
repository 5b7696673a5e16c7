/* test_experiment_carry.c: what a registration into the computed patient's image carries along: points 4 and 15 mm under
 * the surfaces, whose true places are known, and the reference image. SMR_EXPERIMENTS=full: the small thigh; all: the
 * whole one.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "carry/carry_volume.h"
#include "experiment.h"
#include "fixture_thigh.h"

#define EVERY 5u /* vertices from point to point */

typedef struct carried_thigh {
    host_carried map;
    fixture_pose pose;
    float *normal; /* [n_vertices][3] sums of triangles' area vectors at rest */
    char dir[200];
} carried_thigh;

static void register_thigh(carried_thigh *t)
{
    experiment_command c = {{NULL}, 0};
    (void)snprintf(t->dir, sizeof t->dir, "%s", experiment_scratch("thigh"));
    experiment_add(&c, "phantom");
    experiment_add(&c, "-o");
    experiment_add(&c, "%s", t->dir);
    if (!experiment_all())
        experiment_add(&c, "--small");
    EXPERIMENT_NEED(experiment_run(&c) == 0);
    experiment_add(&c, "--model");
    experiment_add_surfaces(&c, experiment_scratch("thigh/model"));
    experiment_add(&c, "--reference");
    experiment_add(&c, "%s/mri_reference.mha", t->dir);
    experiment_add(&c, "--target");
    experiment_add(&c, "%s/mri_patient.mha", t->dir);
    experiment_add(&c, "--landmarks");
    experiment_add(&c, "%s/landmarks_reference.mrk.json", t->dir);
    experiment_add(&c, "%s/landmarks_patient.mrk.json", t->dir);
    EXPERIMENT_NEED(experiment_written(experiment_register(&c, experiment_scratch("thigh/result")).status));
}

/* The normals of the structures' own files. */
static void add_normals(carried_thigh *t)
{
    const host_carry_shape *s = &t->map.shape;
    uint32_t first = 0;
    t->normal = test_calloc(3u * (size_t)s->n_vertices, sizeof *t->normal);
    for (uint32_t part = 0; part < s->n_structures; first += s->count[part++]) {
        host_mesh m;
        host_error error;
        const char *path = experiment_scratch("thigh/model/%s.ply", s->name[part]);
        EXPERIMENT_NEED(host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &m, &error) == 0);
        for (uint32_t i = 0; i < m.n_triangles; i++) {
            const uint32_t *v = m.triangles + 3u * (size_t)i;
            float a[3], b[3];
            for (uint32_t k = 0; k < 3u; k++) {
                a[k] = m.xyz[3u * (size_t)v[1] + k] - m.xyz[3u * (size_t)v[0] + k];
                b[k] = m.xyz[3u * (size_t)v[2] + k] - m.xyz[3u * (size_t)v[0] + k];
            }
            for (uint32_t k = 0; k < 9u; k++)
                t->normal[3u * (size_t)(first + v[k / 3u]) + k % 3u] +=
                    a[(k + 1u) % 3u] * b[(k + 2u) % 3u] - a[(k + 2u) % 3u] * b[(k + 1u) % 3u];
        }
        host_mesh_free(&m);
    }
}

static double mean_distance(const float *a, const float *b, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++)
        sum += sqrt(pow((double)a[3u * i] - (double)b[3u * i], 2) +
                    pow((double)a[3u * i + 1u] - (double)b[3u * i + 1u], 2) +
                    pow((double)a[3u * i + 2u] - (double)b[3u * i + 2u], 2));
    return sum / (double)n;
}

/* Mean error of points this far under the surface, less that of the vertices above them. */
static double error_beyond(carried_thigh *t, float depth, const char *name)
{
    const host_carry_shape *s = &t->map.shape;
    const size_t floats = 3u * ((size_t)s->n_vertices / EVERY + 1u);
    float *at = test_calloc(4u * floats, sizeof *at), *truth = at + floats, *above = truth + floats,
          *now = above + floats;
    double own, error;
    host_error failed;
    uint32_t n = 0;
    for (uint32_t v = 0; v < s->n_vertices; v += EVERY) {
        const float *d = t->normal + 3u * (size_t)v;
        const float length = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (uint32_t k = 0; k < 3u && length > 0.0f; k++) {
            at[3u * n + k] = s->rest[3u * (size_t)v + k] - depth * d[k] / length;
            above[3u * n + k] = s->rest[3u * (size_t)v + k];
            now[3u * n + k] = s->now[3u * (size_t)v + k];
        }
        n += length > 0.0f;
    }
    fixture_thigh_truth(&t->pose, above, n, truth);
    own = mean_distance(now, truth, n);
    fixture_thigh_truth(&t->pose, at, n, truth);
    EXPERIMENT_NEED(host_carried_points(&t->map, 0, at, n, NULL, &failed) == 0);
    error = mean_distance(at, truth, n);
    (void)printf("  %s: %.3f mm, vertices %.3f mm, %u points\n", name, error, own, n);
    test_free(at);
    return error - own;
}

static void points_under_the_surface(void **state)
{
    carried_thigh *t = *state;
    if (t == NULL)
        skip();
    experiment_bound("4 mm under the surface, beyond the vertices' error, mm", error_beyond(t, 4.0f, "4 mm under"),
                     0.4);
    experiment_bound("15 mm under the surface, likewise", error_beyond(t, 15.0f, "15 mm under"), 1.0);
    EXPERIMENT_END();
}

/* Correlation of two images over the voxels that are used. */
static double correlation(const uint8_t *a, const uint8_t *b, const uint8_t *use, size_t n)
{
    double s[6] = {0};
    for (size_t i = 0; i < n; i++) {
        const double x = (double)a[i], y = (double)b[i];
        const double term[6] = {1.0, x, y, x * x, y * y, x * y};
        for (uint32_t k = 0; k < 6u && use[i]; k++)
            s[k] += term[k];
    }
    return (s[5] - s[1] * s[2] / s[0]) / sqrt((s[3] - s[1] * s[1] / s[0]) * (s[4] - s[2] * s[2] / s[0]));
}

/* The reference by the true field, nearest voxel, as the patient's was computed; and where that is within the model. */
static void true_image(const carried_thigh *t, const host_volume *reference, const host_volume *grid, uint8_t *to,
                       uint8_t *use)
{
    float low[3], high[3];
    size_t i = 0;
    host_carried_box(&t->map, 0, low, high);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++, i++) {
                const float p[3] = {grid->origin[0] + (float)x * grid->spacing[0],
                                    grid->origin[1] + (float)y * grid->spacing[1],
                                    grid->origin[2] + (float)z * grid->spacing[2]};
                double value = 0.0, share[3];
                uint32_t at[3];
                float q[3];
                fixture_thigh_back(&t->pose, p, q);
                use[i] = 1;
                for (uint32_t k = 0; k < 3u; k++) {
                    const double index = ((double)q[k] - (double)reference->origin[k]) / (double)reference->spacing[k];
                    use[i] &=
                        q[k] >= low[k] && q[k] <= high[k] && index >= 0.0 && index < (double)(reference->size[k] - 1u);
                    at[k] = use[i] ? (uint32_t)index : 0;
                    share[k] = index - (double)at[k];
                }
                for (uint32_t c = 0; c < 8u && use[i]; c++) {
                    const size_t v =
                        (((size_t)at[2] + (c >> 2)) * reference->size[1] + at[1] + (c >> 1 & 1u)) * reference->size[0] +
                        at[0] + (c & 1u);
                    value += ((c & 1u) ? share[0] : 1.0 - share[0]) * ((c & 2u) ? share[1] : 1.0 - share[1]) *
                             ((c & 4u) ? share[2] : 1.0 - share[2]) * (double)((const uint8_t *)reference->voxels)[v];
                }
                to[i] = (uint8_t)(value + 0.5);
            }
}

static void warped_image(void **state)
{
    carried_thigh *t = *state;
    host_volume reference, patient, warped;
    host_error error;
    if (t == NULL)
        skip();
    EXPERIMENT_NEED(host_volume_read(experiment_scratch("thigh/mri_reference.mha"), &reference, &error) == 0);
    EXPERIMENT_NEED(host_volume_read(experiment_scratch("thigh/mri_patient.mha"), &patient, &error) == 0);
    const size_t n = (size_t)patient.size[0] * patient.size[1] * patient.size[2];
    uint8_t *truth = test_malloc(2u * n), *use = truth + n;
    warped = patient;
    warped.voxels = NULL;
    EXPERIMENT_NEED(host_carried_volume(&t->map, &reference, &warped, &error) >= 0);
    true_image(t, &reference, &patient, truth, use);
    const double best = correlation(truth, patient.voxels, use, n),
                 found = correlation(warped.voxels, patient.voxels, use, n);
    (void)printf("  correlation with the patient's image: %.4f, by the true field %.4f\n", found, best);
    experiment_bound("correlation lost against the true field", best - found, 0.02);
    test_free(truth);
    host_volume_free(&reference);
    host_volume_free(&patient);
    host_volume_free(&warped);
    EXPERIMENT_END();
}

static int start(void **state)
{
    carried_thigh *t = NULL;
    host_error error;
    if (!experiment_full())
        return 0; /* the tests skip */
    t = test_calloc(1, sizeof *t);
    fixture_thigh_pose(1, &t->pose);
    register_thigh(t);
    EXPERIMENT_NEED(host_carried_open(&t->map, experiment_scratch("thigh/result"), 2, &error) == 0);
    add_normals(t);
    *state = t;
    return 0;
}

static int end(void **state)
{
    carried_thigh *t = *state;
    if (t != NULL) {
        host_carried_close(&t->map);
        test_free(t->normal);
        test_free(t);
    }
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(points_under_the_surface), cmocka_unit_test(warped_image)};
    return cmocka_run_group_tests(tests, start, end);
}
