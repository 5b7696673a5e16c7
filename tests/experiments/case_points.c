/* case_points.c: clouds of points on the visible part of a case, and registrations onto them by the library itself,
 * since the command line cannot give points while it registers.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdlib.h>
#include <string.h>
#include "base/system.h"

void case_check(smr_status status)
{
    if (status != SMR_OK)
        case_fail(smr_status_name(status));
}

void case_runner_open(case_runner *runner, const case_data *data, const smr_volume *reference, const smr_config *config)
{
    smr_structure part[CASE_BODIES];
    smr_prepare_config prepare = smr_prepare_config_default();
    size_t scratch = 0, bytes = 0, arena = 0;
    prepare.reference = reference;
    for (uint32_t k = 0; k < data->n; k++) {
        part[k].name = data->body[k].name;
        part[k].mesh = host_mesh_view(&data->body[k].model);
    }
    case_check(smr_prepare_bytes(part, data->n, &prepare, &scratch));
    runner->scratch = host_alloc(scratch);
    case_check(smr_prepare(part, data->n, &prepare, runner->scratch, scratch, NULL, 0, &bytes));
    runner->prepared = host_alloc(bytes);
    case_check(smr_prepare(part, data->n, &prepare, runner->scratch, scratch, runner->prepared, bytes, &bytes));
    case_check(smr_model_open(runner->prepared, bytes, &runner->model));
    case_check(smr_arena_bytes(runner->model, config, &arena));
    runner->arena = host_alloc(arena);
    case_check(smr_init(runner->model, config, NULL, runner->arena, arena, &runner->s));
}

void case_runner_free(case_runner *runner)
{
    free(runner->scratch);
    free(runner->prepared);
    free(runner->arena);
}

void case_sample(const host_mesh *mesh, uint32_t n, double noise_mm, uint32_t seed, float *xyz, float *normal)
{
    oracle_random r = oracle_seed(9000u + seed);
    double *const below = case_alloc(mesh->n_triangles + 1u, sizeof *below), area[3], corner[3][3];
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        case_normal(mesh, i, area);
        below[i + 1u] = below[i] + case_length(area);
    }
    for (uint32_t i = 0; i < n; i++) {
        const double at = oracle_uniform(&r, 0.0, below[mesh->n_triangles]), u = sqrt(oracle_uniform(&r, 0.0, 1.0));
        const double v = oracle_uniform(&r, 0.0, 1.0);
        uint32_t low = 0, high = mesh->n_triangles;
        while (high - low > 1u)
            if (below[(low + high) / 2u] <= at)
                low = (low + high) / 2u;
            else
                high = (low + high) / 2u;
        case_normal(mesh, low, area);
        for (uint32_t k = 0; k < 3u; k++)
            case_get(mesh, mesh->triangles[3u * (size_t)low + k], corner[k]);
        for (uint32_t c = 0; c < 3u; c++) {
            xyz[3u * (size_t)i + c] = (float)((1.0 - u) * corner[0][c] + u * (1.0 - v) * corner[1][c] +
                                              u * v * corner[2][c] + noise_mm * case_random_normal(&r));
            normal[3u * (size_t)i + c] = case_length(area) > 0.0 ? (float)(area[c] / case_length(area)) : 0.0f;
        }
    }
    free(below);
}

typedef struct place {
    double along;
    float xyz[3], normal[3];
} place;

static int by_place(const void *a, const void *b)
{
    const place *const x = a, *const y = b;
    return (x->along > y->along) - (x->along < y->along);
}

/* Sorts the points along the model's long axis, as a hand that moves would give them. */
static void sweep(const case_data *data, uint32_t n, float *xyz, float *normal)
{
    place *const list = case_alloc(n, sizeof *list);
    case_data *const one = case_alloc(1, sizeof *one);
    double axes[9];
    one->n = 1;
    one->body[0].truth = data->body[0].model; /* borrowed */
    case_axes(one, axes);
    free(one);
    for (uint32_t i = 0; i < n; i++) {
        memcpy(list[i].xyz, xyz + 3u * (size_t)i, sizeof list[i].xyz);
        memcpy(list[i].normal, normal + 3u * (size_t)i, sizeof list[i].normal);
        for (int c = 0; c < 3; c++)
            list[i].along += axes[c] * (double)list[i].xyz[c];
    }
    qsort(list, n, sizeof *list, by_place);
    for (uint32_t i = 0; i < n; i++) {
        memcpy(xyz + 3u * (size_t)i, list[i].xyz, sizeof list[i].xyz);
        memcpy(normal + 3u * (size_t)i, list[i].normal, sizeof list[i].normal);
    }
    free(list);
}

/* DIR OUT POINTS PER_TICK NORMALS SWEEP SEED: registers the case's body onto points of its target with noise of
 * 0.3 mm, with the defaults, and writes OUT/NAME.ply. */
void case_feed(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    smr_config config = smr_config_default();
    case_runner run = {0};
    smr_tick_report report = {0};
    smr_points *points = NULL;
    size_t bytes = 0;
    const uint32_t n = (uint32_t)atoi(word[2]), step = atoi(word[3]) > 0 ? (uint32_t)atoi(word[3]) : n;
    const int normals = atoi(word[4]);
    float *const xyz = case_alloc(3u * (size_t)n, sizeof *xyz), *const normal = case_alloc(3u * (size_t)n, sizeof *xyz);
    case_read(data, word[0]);
    case_sample(&data->body[0].target, n, 0.3, (uint32_t)atoi(word[6]), xyz, normal);
    if (atoi(word[5]))
        sweep(data, n, xyz, normal);
    config.basic.n_target_vertices = n;
    case_runner_open(&run, data, NULL, &config);
    case_check(smr_points_bytes(n, &bytes));
    void *const memory = host_alloc(bytes);
    case_check(smr_points_open(n, memory, bytes, &points));
    for (uint32_t at = 0; !report.done; at += step) {
        const uint32_t more = at >= n ? 0u : n - at < step ? n - at : step;
        if (more > 0u) {
            const float *const of = normals ? normal + 3u * (size_t)at : NULL;
            case_check(smr_points_add(points, xyz + 3u * (size_t)at, of, NULL, more));
            case_check(smr_set_points(run.s, SMR_ALL, points));
        }
        case_check(smr_tick(run.s, 0, &report));
    }
    case_check(smr_get_positions(run.s, 0, data->body[0].model.xyz));
    case_directory(word[1]);
    char *path = case_text("%s/%s.ply", word[1], data->body[0].name);
    case_save(&data->body[0].model, path);
}

void case_spoil(const host_mesh *mesh, double strays, double blob, uint32_t seed, float *xyz, uint32_t n)
{
    oracle_random r = oracle_seed(9500u + seed);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, p[3];
    float at[3], normal[3];
    for (uint32_t k = 0; k < 3u * mesh->n_vertices; k++) {
        low[k % 3u] = fmin(low[k % 3u], (double)mesh->xyz[k] - 20.0);
        high[k % 3u] = fmax(high[k % 3u], (double)mesh->xyz[k] + 20.0);
    }
    case_sample(mesh, 1, 0.0, seed + 1u, at, normal);
    const uint32_t first = (uint32_t)(blob * n), last = first + (uint32_t)(strays * n);
    for (uint32_t i = 0; i < last; i++) {
        case_direction(&r, p);
        const double radius = 8.0 * cbrt(oracle_uniform(&r, 0.0, 1.0));
        for (int c = 0; c < 3; c++)
            xyz[3u * (size_t)i + (uint32_t)c] =
                (float)(i < first ? (double)at[c] + 25.0 * (double)normal[c] + radius * p[c]
                                  : oracle_uniform(&r, low[c], high[c]));
    }
}

/* DIR OUT POINTS NOISE STRAYS BLOB SEED: a cloud on the first body's target, with these shares of outliers. */
void case_cloud(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    const uint32_t n = (uint32_t)atoi(word[2]), seed = (uint32_t)atoi(word[6]);
    host_mesh cloud = case_new_mesh(n, 0);
    float *const normal = case_alloc(3u * (size_t)n, sizeof *normal);
    case_read(data, word[0]);
    case_sample(&data->body[0].target, n, atof(word[3]), seed, cloud.xyz, normal);
    case_spoil(&data->body[0].target, atof(word[4]), atof(word[5]), seed, cloud.xyz, n);
    case_directory(word[1]);
    case_save(&cloud, case_text("%s/%s.ply", word[1], data->body[0].name));
    free(normal);
}
