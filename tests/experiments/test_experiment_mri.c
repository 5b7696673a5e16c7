/* test_experiment_mri.c: registration into a real MRI. The femur, with the image it was made from as the reference,
 * is displaced (15 mm, 8 degrees, a smooth deformation of at most 5 mm) and registered back onto that image.
 * Distances to the true surface are measured where the image shows it. Ten seeds; the short form runs one.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "experiment.h"
#include "volumes/voxel_volume.h"
#include "unit/oracle.h"

#define SHIFT_MM 15.0
#define TURN_DEG 8.0
#define BEND_MM 5.0  /* largest displacement of the deformation */
#define BUMP_MM 60.0 /* standard deviation of its bumps */
enum { BUMPS = 12, LANDMARKS = 64, SEEDS = 10 };

static host_mesh truth;          /* the femur at its place */
static unsigned char *shown;     /* [truth.n_vertices] inside the image */
static uint32_t mark[LANDMARKS]; /* vertices that serve as landmarks */
static char model[1024];

/* Vertices far from each other: each the farthest from those before it; ties by index. */
static void spread_landmarks(void)
{
    float *const d2 = test_malloc(truth.n_vertices * sizeof *d2);
    uint32_t i = 0, k = 0;
    for (i = 0; i < truth.n_vertices; i++)
        d2[i] = HUGE_VALF;
    for (k = 0; k < LANDMARKS; k++) {
        const float *const p = truth.xyz + 3u * (size_t)mark[k];
        uint32_t next = 0;
        for (i = 0; i < truth.n_vertices; i++) {
            const float *const q = truth.xyz + 3u * (size_t)i;
            const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2], d = x * x + y * y + z * z;
            d2[i] = d < d2[i] ? d : d2[i];
            next = d2[i] > d2[next] ? i : next;
        }
        if (k + 1u < LANDMARKS)
            mark[k + 1u] = next;
    }
    test_free(d2);
}

/* Vertices within the box of voxel centres; the image's axes are the patient's. */
static void find_shown(const host_volume *volume)
{
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < truth.n_vertices; i++) {
        shown[i] = 1;
        for (c = 0; c < 3; c++) {
            const float at = (truth.xyz[3u * (size_t)i + (size_t)c] - volume->origin[c]) / volume->spacing[c];
            shown[i] = (unsigned char)(shown[i] && at >= 0.0f && at <= (float)(volume->size[c] - 1u));
        }
    }
}

static int set_up(void **state)
{
    const char *const surface = experiment_data("femurs/femur_m_right.ply");
    const char *const image = experiment_data("volumes/mri_hip_thigh_m.mha");
    host_volume volume;
    host_error error;
    (void)state;
    if (surface == NULL || image == NULL)
        return 0;
    EXPERIMENT_NEED(host_mesh_read(surface, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &truth, &error) == 0);
    EXPERIMENT_NEED(host_volume_read(image, &volume, &error) == 0);
    shown = test_malloc(truth.n_vertices);
    find_shown(&volume);
    host_volume_free(&volume);
    spread_landmarks();
    (void)snprintf(model, sizeof model, "%s", experiment_scratch("femur.smr"));
    return experiment_build(surface, image, model) ? 0 : -1;
}

static int clean_up(void **state)
{
    (void)state;
    host_mesh_free(&truth);
    test_free(shown);
    return 0;
}

static void unit_vector(oracle_random *r, double v[3])
{
    double l = 0.0;
    int c = 0;
    while (!(l > 0.01 && l <= 1.0)) /* even over the sphere */
        for (c = 0, l = 0.0; c < 3; c++) {
            v[c] = oracle_uniform(r, -1.0, 1.0);
            l += v[c] * v[c];
        }
    for (c = 0; c < 3; c++)
        v[c] /= sqrt(l);
}

typedef struct spoil {
    double middle[3], turn[9], shift[3];
    double at[BUMPS][3], push[BUMPS][3];
} spoil;

static void bend(const spoil *s, const double p[3], double by[3])
{
    int b = 0, c = 0;
    by[0] = by[1] = by[2] = 0.0;
    for (b = 0; b < BUMPS; b++) {
        double d2 = 0.0;
        for (c = 0; c < 3; c++)
            d2 += (p[c] - s->at[b][c]) * (p[c] - s->at[b][c]);
        for (c = 0; c < 3; c++)
            by[c] += s->push[b][c] * exp(-d2 / (2.0 * BUMP_MM * BUMP_MM));
    }
}

static void load(uint32_t vertex, double p[3])
{
    int c = 0;
    for (c = 0; c < 3; c++)
        p[c] = (double)truth.xyz[3u * (size_t)vertex + (size_t)c];
}

static spoil make_spoil(uint32_t seed)
{
    oracle_random r = oracle_seed(2000u + seed);
    spoil s;
    double axis[3], p[3], by[3], most = 0.0;
    uint32_t i = 0;
    int b = 0, c = 0;
    memset(&s, 0, sizeof s);
    for (i = 0; i < truth.n_vertices; i++) {
        load(i, p);
        for (c = 0; c < 3; c++)
            s.middle[c] += p[c] / truth.n_vertices;
    }
    unit_vector(&r, axis);
    oracle_turn(axis, TURN_DEG * 3.14159265358979323846 / 180.0, s.turn);
    unit_vector(&r, s.shift);
    for (b = 0; b < BUMPS; b++) {
        load(oracle_below(&r, truth.n_vertices), s.at[b]);
        unit_vector(&r, s.push[b]);
    }
    for (i = 0; i < truth.n_vertices; i++) {
        load(i, p);
        bend(&s, p, by);
        most = fmax(most, sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]));
    }
    for (b = 0; b < BUMPS; b++)
        for (c = 0; c < 3; c++)
            s.push[b][c] *= BEND_MM / most;
    for (c = 0; c < 3; c++)
        s.shift[c] *= SHIFT_MM;
    return s;
}

static void spoil_point(const spoil *s, const double p[3], float out[3])
{
    double by[3], d[3];
    int c = 0;
    bend(s, p, by);
    for (c = 0; c < 3; c++)
        d[c] = p[c] + by[c] - s->middle[c];
    for (c = 0; c < 3; c++)
        out[c] = (float)(s->turn[3 * c] * d[0] + s->turn[3 * c + 1] * d[1] + s->turn[3 * c + 2] * d[2] + s->middle[c] +
                         s->shift[c]);
}

/* The femur's landmarks where they are, and where the spoiled pose has them. */
static void write_pairs(const spoil *s, const char *from, const char *to)
{
    host_landmarks *const set = test_calloc(2, sizeof *set);
    uint32_t k = 0;
    for (k = 0; k < LANDMARKS; k++) {
        double p[3];
        load(mark[k], p);
        memcpy(set[0].xyz[k], truth.xyz + 3u * (size_t)mark[k], sizeof set[0].xyz[k]);
        spoil_point(s, p, set[1].xyz[k]);
        (void)snprintf(set[0].label[k], sizeof set[0].label[k], "v%u", mark[k]);
        memcpy(set[1].label[k], set[0].label[k], sizeof set[1].label[k]);
    }
    set[0].n = set[1].n = LANDMARKS;
    EXPERIMENT_NEED(experiment_write_landmarks(from, &set[0]));
    EXPERIMENT_NEED(experiment_write_landmarks(to, &set[1]));
    test_free(set);
}

typedef struct way {
    double to[2], from[2], below; /* mm: mean and largest to the truth and from it, where shown; mean to it elsewhere */
} way;

static way measure(const char *out)
{
    host_mesh result;
    host_error error;
    way w;
    double none = 0.0;
    char path[1200];
    uint32_t i = 0;
    unsigned char *const hidden = test_malloc(truth.n_vertices);
    (void)snprintf(path, sizeof path, "%s/femur_m_right.ply", out);
    EXPERIMENT_NEED(host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &result, &error) == 0);
    EXPERIMENT_NEED(result.n_vertices == truth.n_vertices);
    for (i = 0; i < truth.n_vertices; i++)
        hidden[i] = !shown[i];
    EXPERIMENT_NEED(experiment_distance(&result, shown, &truth, &w.to[0], &w.to[1]));
    EXPERIMENT_NEED(experiment_distance(&truth, shown, &result, &w.from[0], &w.from[1]));
    EXPERIMENT_NEED(experiment_distance(&result, hidden, &truth, &w.below, &none));
    host_mesh_free(&result);
    test_free(hidden);
    return w;
}

/* Registers from the spoiled start; with still, no force acts and the start itself comes out. */
static way run(uint32_t seed, int still, experiment_result *r)
{
    static const char *const no_force[] = {"--search",     "0,0", "--gradient",        "0,0",
                                           "--iterations", "1",   "--iterations-last", "1"};
    const char *const image = experiment_data("volumes/mri_hip_thigh_m.mha");
    char from[1024], to[1024], out[1024];
    /* the image ends above the femur's end, which the verdict says */
    const char *words[] = {"--model", model, "--target", image, "--landmarks", from, to, "--accept", "look"};
    experiment_command c = {{NULL}, 0};
    const spoil s = make_spoil(seed);
    size_t i = 0;
    (void)snprintf(from, sizeof from, "%s", experiment_scratch("from.csv"));
    (void)snprintf(to, sizeof to, "%s", experiment_scratch("to.csv"));
    (void)snprintf(out, sizeof out, "%s", experiment_scratch("femur"));
    write_pairs(&s, from, to);
    for (i = 0; i < sizeof words / sizeof words[0]; i++)
        experiment_add(&c, "%s", words[i]);
    for (i = 0; still && i < sizeof no_force / sizeof no_force[0]; i++)
        experiment_add(&c, "%s", no_force[i]);
    *r = experiment_register(&c, out);
    return measure(out);
}

static void finds_back_in_the_mri(void **state)
{
    const uint32_t seeds = experiment_full() ? SEEDS : 1u;
    double worst = 0.0, worst_from = 0.0;
    uint32_t seed = 0;
    (void)state;
    if (model[0] == '\0')
        skip();
    (void)printf("femur in its own MRI, from %g mm, %g degrees and a deformation of %g mm\n", SHIFT_MM, TURN_DEG,
                 BEND_MM);
    (void)printf("  %-10s %10s %10s %10s %10s %10s %10s %7s %6s\n", "mm", "start mean", "to truth", "largest",
                 "from truth", "largest", "not shown", "goals", "folds");
    for (seed = 1; seed <= seeds; seed++) {
        experiment_result r;
        const way start = run(seed, 1, &r), w = run(seed, 0, &r);
        (void)printf("  seed %-5u %10.3f %10.3f %10.3f %10.3f %10.3f %10.3f %6.1f%% %6.0f%s\n", seed, start.to[0],
                     w.to[0], w.to[1], w.from[0], w.from[1], w.below, 100.0 * r.matched, r.folds,
                     experiment_written(r.status) ? "" : "  (NOT DONE)");
        worst = fmax(worst, experiment_written(r.status) ? w.to[0] : HUGE_VAL);
        worst_from = fmax(worst_from, w.from[0]);
        assert_true(start.to[0] > 2.0); /* it was spoiled */
    }
    experiment_bound("worst seed, mean to the true surface", worst, 1.0);
    experiment_bound("worst seed, mean from the true surface", worst_from, 1.0);
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_back_in_the_mri),
    };
    return cmocka_run_group_tests(tests, set_up, clean_up);
}
