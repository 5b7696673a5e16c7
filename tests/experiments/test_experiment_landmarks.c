/* test_experiment_landmarks.c: tracked points alone, beside a surface and in an image with one half wiped out: how far
 * vertices end from their true places.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case.h"
#include "experiment.h"
#include "property/rig.h"

enum { POINTS = 40, SEEDS_MAX = 5 };

/* One model with a known deformation, its landmarks, and what came of it. */
typedef struct tracked {
    case_data *data;
    const smr_model *model;
    smr_landmark mark[SMR_LANDMARKS_MAX];
    uint32_t n;
    double vertex, surface, farthest; /* mm: from true places in the mean, the surface's larger mean, a hard point's */
    double expected;                  /* mm: what was said about `vertex` */
    smr_verdict verdict;
} tracked;

static double apart(const float *a, const float *b)
{
    double sum = 0.0;
    for (int c = 0; c < 3; c++)
        sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return sqrt(sum);
}

/* Triangles whose middles are spread over the surface: each is the one farthest from those before. */
static void spread(const host_mesh *mesh, uint32_t n, uint32_t *triangle)
{
    double *const least = case_alloc(mesh->n_triangles, sizeof *least);
    uint32_t t = 0, k = 0;
    for (t = 0; t < mesh->n_triangles; t++)
        least[t] = HUGE_VAL;
    triangle[0] = 0;
    for (k = 1; k < n; k++) {
        double from[3];
        uint32_t best = 0;
        case_centre(mesh, triangle[k - 1u], from);
        for (t = 0; t < mesh->n_triangles; t++) {
            double to[3], d = 0.0;
            int c = 0;
            case_centre(mesh, t, to);
            for (c = 0; c < 3; c++)
                d += (to[c] - from[c]) * (to[c] - from[c]);
            least[t] = fmin(least[t], d);
            best = least[t] > least[best] ? t : best;
        }
        triangle[k] = best;
    }
    free(least);
}

/* Points in the middle of triangles, or in every second one's corner, with noise. */
static void mark(tracked *t, uint32_t n, double noise_mm, uint32_t hard, uint32_t seed)
{
    const case_body *const body = &t->data->body[0];
    oracle_random r = oracle_seed(100u + seed);
    uint32_t triangle[SMR_LANDMARKS_MAX], k = 0;
    int c = 0;
    spread(&body->model, n, triangle);
    for (k = 0; k < n; k++) {
        smr_landmark *const l = &t->mark[k];
        double from[3], to[3];
        case_centre(&body->model, triangle[k], from);
        case_centre(&body->truth, triangle[k], to);
        memset(l, 0, sizeof *l);
        l->vertex = k % 2u != 0 ? SMR_NONE : body->model.triangles[3u * (size_t)triangle[k]];
        l->weight = 1.0f;
        l->hard = hard;
        for (c = 0; c < 3; c++) {
            const size_t at = 3u * (size_t)l->vertex + (size_t)c;
            l->rest[c] = (float)from[c];
            l->place[c] =
                (k % 2u != 0 ? (float)to[c] : body->truth.xyz[at]) + (float)(noise_mm * case_normal_random(&r));
        }
    }
    t->n = n;
}

static void run(tracked *t, const smr_surface *surface)
{
    const host_mesh *const mesh = &t->data->body[0].model;
    smr_config config = smr_config_default();
    float *const mm = case_alloc(mesh->n_vertices, sizeof *mm), at[SMR_LANDMARKS_MAX][3];
    const float *xyz[1];
    case_figures f;
    uint32_t i = 0;
    config.n_landmarks = SMR_LANDMARKS_MAX;
    config.n_target_vertices = surface != NULL ? t->data->body[0].target.n_vertices : 0u;
    smr *const s = rig_init(t->model, &config, NULL);
    EXPERIMENT_NEED(smr_set_surface(s, SMR_ALL, surface) == SMR_OK);
    EXPERIMENT_NEED(smr_set_landmarks(s, t->mark, t->n) == SMR_OK);
    EXPERIMENT_NEED(rig_run(s, 1000).done);
    EXPERIMENT_NEED(smr_get_landmarks(s, at[0]) == SMR_OK && smr_get_verdict(s, SMR_ALL, &t->verdict) == SMR_OK &&
                    smr_get_expected_error(s, 0, mm) == SMR_OK);
    xyz[0] = rig_positions(s, t->model);
    f = case_measure(t->data, xyz);
    t->vertex = f.vertex;
    t->surface = f.surface;
    t->farthest = t->expected = 0.0;
    for (i = 0; i < t->n; i++)
        t->farthest = fmax(t->farthest, apart(at[i], t->mark[i].place));
    for (i = 0; i < mesh->n_vertices; i++)
        t->expected += (double)mm[i] / mesh->n_vertices;
    free(mm);
}

/* A femur, deformed, turned and shifted away from the truth. */
static tracked make(const char *name, uint32_t seed, int part)
{
    case_options o = case_defaults();
    const smr_prepare_config prepare = smr_prepare_config_default();
    tracked t;
    memset(&t, 0, sizeof t);
    o.seed = seed;
    o.part = part;
    t.data = case_alloc(1, sizeof *t.data);
    EXPERIMENT_NEED(case_add(t.data, experiment_data("%s", name), HOST_MIRROR_NONE));
    case_make(t.data, &o);
    const smr_mesh view = host_mesh_view(&t.data->body[0].model);
    t.model = rig_model(&view, 1, &prepare);
    return t;
}

static void drop(tracked *t)
{
    case_free(t->data);
    free(t->data);
    rig_free_all();
}

static void trial(void **state)
{
    const char *const names[] = {"femurs/femur_vhm_left.ply", "femurs/femur_2008_0019_left.ply",
                                 "hip_thigh_vhm/femur.ply"};
    (void)state;
    for (uint32_t seed = 1; seed <= 2; seed++)
        for (int k = 0; k < 3; k++) {
            if (experiment_data("%s", names[k]) == NULL) {
                (void)printf("no %s\n", names[k]);
                continue;
            }
            tracked t = make(names[k], seed, CASE_WHOLE);
            static const struct {
                uint32_t n;
                double noise;
                uint32_t hard, surface;
            } set[] = {{40, 0, 0, 0}, {40, 0.5, 0, 0}, {40, 0, 1, 0}, {40, 0.5, 1, 0}, {12, 0, 0, 0},
                       {0, 0, 0, 1},  {12, 0, 0, 1},   {12, 0, 1, 1}, {12, 0.5, 1, 1}, {3, 0, 0, 0}};
            for (size_t i = 0; i < sizeof set / sizeof set[0]; i++) {
                const smr_mesh goal = host_mesh_view(&t.data->body[0].target);
                mark(&t, set[i].n, set[i].noise, set[i].hard, seed);
                run(&t, set[i].surface ? rig_surface(&goal) : NULL);
                (void)printf("%s seed %u n %u noise %.1f hard %u surface %u: vertex %.3f surface %.3f farthest %.3f "
                             "expected %.3f verdict %u reasons %u\n",
                             names[k], seed, set[i].n, set[i].noise, set[i].hard, set[i].surface, t.vertex, t.surface,
                             t.farthest, t.expected, t.verdict.level, t.verdict.reasons);
            }
            drop(&t);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(trial)};
    return cmocka_run_group_tests_name("experiment: landmarks", tests, NULL, NULL);
}
