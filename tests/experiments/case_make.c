/* case_make.c: a case from its options: deformation, resampling, visible part, noise and outliers, start.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdlib.h>
#include <string.h>

#define OUTLIER_MM 40.0 /* stray triangles lie within this distance of the surface */

enum { BUMPS = 24 };

/* A sum of Gaussians. */
typedef struct bend {
    double centre[BUMPS][3], push[BUMPS][3], sigma;
} bend;

case_options case_defaults(void)
{
    return (case_options){.seed = 1,
                          .share = 0.38,
                          .patches = 3,
                          .side_deg = 78.0,
                          .deform_mm = 5.0,
                          .sigma_mm = 70.0,
                          .shift_mm = 8.0,
                          .turn_deg = 8.0,
                          .noise_mm = 0.5};
}

double case_random_normal(oracle_random *r)
{
    const double u = oracle_uniform(r, 1e-12, 1.0), v = oracle_uniform(r, 0.0, 2.0 * acos(-1.0));
    return sqrt(-2.0 * log(u)) * cos(v);
}

void case_direction(oracle_random *r, double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = case_random_normal(r);
    const double length = case_length(out);
    for (int c = 0; c < 3; c++)
        out[c] /= length;
}

/* ---- deformation */

static void bend_at(const bend *b, const double p[3], double out[3])
{
    out[0] = out[1] = out[2] = 0.0;
    for (int k = 0; k < BUMPS; k++) {
        const double v[3] = {p[0] - b->centre[k][0], p[1] - b->centre[k][1], p[2] - b->centre[k][2]};
        const double w = exp(-0.5 * case_dot(v, v) / (b->sigma * b->sigma));
        for (int c = 0; c < 3; c++)
            out[c] += w * b->push[k][c];
    }
}

/* Length of the displacement: mean over the area of all models, or largest of a vertex. */
static double measure_bend(const case_data *data, const bend *b, int largest)
{
    double sum = 0.0, area = 0.0, most = 0.0, n[3], p[3], d[3];
    for (uint32_t i = 0; i < data->n; i++) {
        const host_mesh *const mesh = &data->body[i].model;
        for (uint32_t t = 0; !largest && t < mesh->n_triangles; t++) {
            case_normal(mesh, t, n);
            case_centre(mesh, t, p);
            bend_at(b, p, d);
            sum += case_length(n) * case_length(d);
            area += case_length(n);
        }
        for (uint32_t k = 0; largest && k < mesh->n_vertices; k++) {
            case_get(mesh, k, p);
            bend_at(b, p, d);
            most = fmax(most, case_length(d));
        }
    }
    return largest ? most : sum / area;
}

static bend make_bend(const case_data *data, const case_options *options, int largest)
{
    oracle_random r = oracle_seed(5000u + options->seed);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    bend b = {.sigma = options->sigma_mm};
    for (uint32_t i = 0; i < data->n; i++)
        for (uint32_t k = 0; k < 3u * data->body[i].model.n_vertices; k++) {
            low[k % 3u] = fmin(low[k % 3u], (double)data->body[i].model.xyz[k]);
            high[k % 3u] = fmax(high[k % 3u], (double)data->body[i].model.xyz[k]);
        }
    for (int k = 0; k < BUMPS; k++)
        for (int c = 0; c < 3; c++) {
            b.centre[k][c] = oracle_uniform(&r, low[c] - 0.5 * b.sigma, high[c] + 0.5 * b.sigma);
            b.push[k][c] = case_random_normal(&r);
        }
    const double scale = options->deform_mm / measure_bend(data, &b, largest);
    for (int k = 0; k < BUMPS; k++)
        for (int c = 0; c < 3; c++)
            b.push[k][c] *= scale;
    return b;
}

static void bend_mesh(host_mesh *mesh, const bend *b)
{
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        double p[3], d[3];
        case_get(mesh, i, p);
        bend_at(b, p, d);
        for (int c = 0; c < 3; c++)
            p[c] += d[c];
        case_put(mesh, i, p);
    }
}

/* ---- what is visible */

/* Keeps the triangles of the smallest values whose areas make the share; frees the values. */
static void keep_share(host_mesh *mesh, double *value, double share)
{
    case_ranked *const list = case_alloc(mesh->n_triangles, sizeof *list);
    unsigned char *const keep = case_alloc(mesh->n_triangles, 1);
    double left = share * case_area(mesh), n[3];
    for (uint32_t t = 0; t < mesh->n_triangles; t++)
        list[t] = (case_ranked){value[t], t};
    qsort(list, mesh->n_triangles, sizeof *list, case_by_value);
    for (uint32_t t = 0; t < mesh->n_triangles && left > 0.0; t++) {
        keep[list[t].at] = 1;
        case_normal(mesh, (uint32_t)list[t].at, n);
        left -= 0.5 * case_length(n);
    }
    free(list);
    free(value);
    case_cut(mesh, keep);
}

void case_keep_facing(host_mesh *mesh, const double direction[3], double degrees)
{
    const double least = cos(case_radians(degrees));
    unsigned char *const keep = case_alloc(mesh->n_triangles, 1);
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        double n[3];
        case_normal(mesh, t, n);
        keep[t] = degrees >= 180.0 || case_dot(n, direction) > least * case_length(n);
    }
    case_cut(mesh, keep);
}

/* Lengths of paths along edges from the vertices where `from` is 0: passes over all triangles until none shortens. */
static void spread_distance(const host_mesh *mesh, double *from)
{
    const uint32_t n = 3u * mesh->n_triangles;
    for (int changed = 1; changed;) {
        changed = 0;
        for (uint32_t i = 0; i < 2u * n; i++) { /* forwards, then backwards */
            const uint32_t at = i < n ? i : 2u * n - 1u - i;
            const uint32_t a = mesh->triangles[at], b = mesh->triangles[at % 3u == 2u ? at - 2u : at + 1u];
            double p[3], q[3];
            case_get(mesh, a, p);
            case_get(mesh, b, q);
            const double length = case_apart(p, q);
            if (from[a] + length < from[b]) {
                from[b] = from[a] + length;
                changed = 1;
            } else if (from[b] + length < from[a]) {
                from[a] = from[b] + length;
                changed = 1;
            }
        }
    }
}

/* Each further place is the farthest of a few random vertices from those chosen before. */
static void keep_patches(host_mesh *mesh, const case_options *options, oracle_random *r)
{
    double *const from = case_alloc(mesh->n_vertices, sizeof *from);
    double *const value = case_alloc(mesh->n_triangles, sizeof *value);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        from[i] = 1e9;
    for (int k = 0; k < options->patches; k++) {
        uint32_t best = oracle_below(r, mesh->n_vertices);
        for (int tries = 0; tries < 4; tries++) {
            const uint32_t v = oracle_below(r, mesh->n_vertices);
            best = from[v] > from[best] ? v : best;
        }
        from[best] = 0.0;
        spread_distance(mesh, from);
    }
    for (uint32_t i = 0; i < 3u * mesh->n_triangles; i++)
        value[i / 3u] += from[mesh->triangles[i]];
    free(from);
    keep_share(mesh, value, options->share);
}

static void keep_end(host_mesh *mesh, const case_options *options, const double axes[9])
{
    double *const value = case_alloc(mesh->n_triangles, sizeof *value), p[3];
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        case_centre(mesh, t, p);
        value[t] = (options->seed % 2u == 1u ? -1.0 : 1.0) * case_dot(p, axes);
    }
    keep_share(mesh, value, options->share);
}

static void keep_visible(host_mesh *mesh, const case_options *options, const double axes[9])
{
    static const double front[3] = {0.0, -1.0, 0.0};
    oracle_random r = oracle_seed(7000u + options->seed);
    if (options->part == CASE_SIDE) { /* across the long axis: somebody stands beside the bone */
        const double angle = oracle_uniform(&r, 0.0, 2.0 * acos(-1.0));
        double side[3];
        for (int c = 0; c < 3; c++)
            side[c] = cos(angle) * axes[3 + c] + sin(angle) * axes[6 + c];
        case_keep_facing(mesh, side, options->side_deg);
    } else if (options->part == CASE_PATCHES) {
        keep_patches(mesh, options, &r);
    } else if (options->part == CASE_END) {
        keep_end(mesh, options, axes);
    } else {
        case_keep_facing(mesh, front, options->part == CASE_FRONT ? 90.0 : 180.0);
    }
}

/* ---- noise and outliers */

static void add_noise(host_mesh *mesh, double noise_mm, oracle_random *r)
{
    double *const normal = case_vertex_normals(mesh);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        const double along = case_random_normal(r);
        for (uint32_t c = 0; c < 3u; c++)
            mesh->xyz[3u * (size_t)i + c] += (float)(noise_mm * (along * normal[3u * (size_t)i + c]));
    }
    free(normal);
}

/* Small triangles of about the mesh's size, turned any way. */
static void add_strays(host_mesh *mesh, const host_mesh *whole, double outliers, oracle_random *r)
{
    const uint32_t n = (uint32_t)(outliers / (1.0 - outliers) * mesh->n_vertices / 3.0 + 0.5);
    const double size = sqrt(case_area(mesh) / fmax(1.0, mesh->n_triangles));
    host_mesh more = case_new_mesh(3u * n, n);
    double p[3] = {0.0, 0.0, 0.0}, d[3];
    for (uint32_t i = 0; i < 3u * n; i++) {
        if (i % 3u == 0) {
            case_get(whole, oracle_below(r, whole->n_vertices), p);
            case_direction(r, d);
            const double off = oracle_uniform(r, 0.0, OUTLIER_MM);
            for (int c = 0; c < 3; c++)
                p[c] += off * d[c];
        }
        case_direction(r, d);
        for (int c = 0; c < 3; c++)
            d[c] = p[c] + size * d[c];
        case_put(&more, i, d);
        more.triangles[i] = i;
    }
    if (host_mesh_append(mesh, &more) != 0)
        case_fail("out of memory");
    host_mesh_free(&more);
}

/* ---- all of it */

static void make_surfaces(case_body *body, const bend *b, oracle_random *r, int dense)
{
    body->whole = case_subdivide(&body->model, NULL);
    bend_mesh(&body->whole, b);
    body->target = case_subdivide(&body->model, r);
    bend_mesh(&body->target, b);
    for (int i = 0; i < dense; i++) {
        const host_mesh finer = case_subdivide(&body->model, NULL);
        host_mesh_free(&body->model);
        body->model = finer;
    }
    body->truth = case_copy(&body->model);
    bend_mesh(&body->truth, b);
}

/* Flexes the hip: turns a body's truth and target about the axis to the left through the head of the VHM's femur. */
static void flex(case_body *body, double degrees)
{
    static const double left[3] = {1.0, 0.0, 0.0}, head[3] = {-91.5, 3.2, -1.8};
    host_mesh *const mesh[] = {&body->truth, &body->whole, &body->target};
    double turn[9];
    oracle_turn(left, case_radians(-degrees), turn);
    for (int i = 0; i < 3; i++)
        case_apply(mesh[i], turn, head, head);
}

static void join_targets(case_data *data)
{
    for (uint32_t i = 1; i < data->n; i++) {
        if (host_mesh_append(&data->body[0].target, &data->body[i].target) != 0)
            case_fail("out of memory");
        host_mesh_free(&data->body[i].target);
    }
}

/* Turns all models about their common middle and shifts them. */
static void move_to_start(case_data *data, const case_options *options)
{
    oracle_random r = oracle_seed(6000u + options->seed);
    double axis[3], shift[3], turn[9], middle[3] = {0.0, 0.0, 0.0}, to[3], count = 0.0;
    case_direction(&r, axis);
    case_direction(&r, shift);
    oracle_turn(axis, case_radians(options->turn_deg), turn);
    for (uint32_t i = 0; i < data->n; i++) {
        for (uint32_t k = 0; k < 3u * data->body[i].model.n_vertices; k++)
            middle[k % 3u] += (double)data->body[i].model.xyz[k];
        count += data->body[i].model.n_vertices;
    }
    for (int c = 0; c < 3; c++) {
        middle[c] /= count;
        to[c] = middle[c] + options->shift_mm * shift[c];
    }
    for (uint32_t i = 0; i < data->n; i++)
        case_apply(&data->body[i].model, turn, middle, to);
}

void case_make(case_data *data, const case_options *options)
{
    const bend b = make_bend(data, options, 0);
    oracle_random r = oracle_seed(8000u + options->seed);
    double axes[9], visible = 0.0, area = 0.0;
    for (uint32_t i = 0; i < data->n; i++) {
        make_surfaces(&data->body[i], &b, &r, options->dense);
        if (i > 0u)
            flex(&data->body[i], options->flex_deg);
    }
    case_axes(data, axes);
    for (uint32_t i = 0; i < data->n; i++) {
        case_body *const body = &data->body[i];
        area += case_area(&body->target);
        keep_visible(&body->target, options, axes);
        visible += case_area(&body->target);
        if (options->noise_mm > 0.0)
            add_noise(&body->target, options->noise_mm, &r);
        if (options->outliers > 0.0)
            add_strays(&body->target, &body->whole, options->outliers, &r);
    }
    data->overlap = visible / area;
    if (data->beside.n_vertices > 0u) {
        bend_mesh(&data->beside, &b);
        if (host_mesh_append(&data->body[0].target, &data->beside) != 0)
            case_fail("out of memory");
    }
    if (options->joined)
        join_targets(data);
    move_to_start(data, options);
}

void case_displace(case_data *data, const case_options *options)
{
    const bend b = make_bend(data, options, 1);
    for (uint32_t i = 0; i < data->n; i++)
        bend_mesh(&data->body[i].model, &b);
    move_to_start(data, options);
}
