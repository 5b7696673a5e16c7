/* case_make.c: a case from its options: deformation, resampling, visible part, spoiling, start.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/surface_distances.h"

#define SEEN_MM 1.0f /* a true place this near to the visible part is seen */

enum { BUMPS = 24 };

/* A sum of Gaussians. */
typedef struct bend {
    double centre[BUMPS][3], push[BUMPS][3], sigma;
} bend;

case_options case_defaults(void)
{
    case_options o;
    memset(&o, 0, sizeof o);
    o.seed = 1;
    o.share = 0.38;
    o.patches = 3;
    o.side_deg = 78.0;
    o.deform_mm = 5.0;
    o.sigma_mm = 70.0;
    o.shift_mm = 8.0;
    o.turn_deg = 8.0;
    o.noise_mm = 0.5;
    o.outlier_mm = 40.0;
    o.density = -1;
    return o;
}

int case_add(case_data *data, const char *path, int mirror)
{
    case_body *const body = &data->body[data->n];
    const char *const slash = strrchr(path, '/'), *const base = slash != NULL ? slash + 1 : path;
    const char *const dot = strrchr(base, '.');
    host_error error;
    if (data->n >= CASE_BODIES)
        return 0;
    memset(body, 0, sizeof *body);
    memset(&error, 0, sizeof error);
    if (host_mesh_read(path, HOST_MESH_SURFACE, mirror, &body->model, &error) != 0) {
        host_error_print(&error);
        return 0;
    }
    (void)snprintf(body->name, sizeof body->name, "%.*s", (int)(dot != NULL ? dot - base : 60), base);
    data->n++;
    return 1;
}

static void bend_at(const bend *b, const double p[3], double out[3])
{
    int k = 0, c = 0;
    out[0] = out[1] = out[2] = 0.0;
    for (k = 0; k < BUMPS; k++) {
        const double x = p[0] - b->centre[k][0], y = p[1] - b->centre[k][1], z = p[2] - b->centre[k][2];
        const double w = exp(-0.5 * (x * x + y * y + z * z) / (b->sigma * b->sigma));
        for (c = 0; c < 3; c++)
            out[c] += w * b->push[k][c];
    }
}

/* Mean length of the displacement over the area of all models. */
static double mean_bend(const case_data *data, const bend *b)
{
    double sum = 0.0, area = 0.0;
    uint32_t i = 0, t = 0;
    for (i = 0; i < data->n; i++)
        for (t = 0; t < data->body[i].model.n_triangles; t++) {
            double n[3], p[3], d[3], a = 0.0;
            case_triangle_normal(&data->body[i].model, t, n);
            case_centre(&data->body[i].model, t, p);
            bend_at(b, p, d);
            a = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            sum += a * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            area += a;
        }
    return sum / area;
}

static bend make_bend(const case_data *data, const case_options *options)
{
    oracle_random r = oracle_seed(5000u + options->seed);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, scale = 0.0;
    bend b;
    uint32_t i = 0, k = 0;
    int c = 0;
    for (i = 0; i < data->n; i++)
        for (k = 0; k < 3u * data->body[i].model.n_vertices; k++) {
            low[k % 3u] = fmin(low[k % 3u], (double)data->body[i].model.xyz[k]);
            high[k % 3u] = fmax(high[k % 3u], (double)data->body[i].model.xyz[k]);
        }
    b.sigma = options->sigma_mm;
    for (k = 0; k < BUMPS; k++)
        for (c = 0; c < 3; c++) {
            b.centre[k][c] = oracle_uniform(&r, low[c] - 0.5 * b.sigma, high[c] + 0.5 * b.sigma);
            b.push[k][c] = case_normal_random(&r);
        }
    scale = options->deform_mm / mean_bend(data, &b);
    for (k = 0; k < BUMPS; k++)
        for (c = 0; c < 3; c++)
            b.push[k][c] *= scale;
    return b;
}

static void bend_mesh(host_mesh *mesh, const bend *b)
{
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < mesh->n_vertices; i++) {
        float *const x = mesh->xyz + 3u * (size_t)i;
        const double p[3] = {(double)x[0], (double)x[1], (double)x[2]};
        double d[3];
        bend_at(b, p, d);
        for (c = 0; c < 3; c++)
            x[c] = (float)(p[c] + d[c]);
    }
}

/* The resampled target, which is whole as yet: as few vertices as keep the surface, or as asked. */
static void make_target(case_body *body, const case_options *options, const bend *b, oracle_random *r)
{
    int density = options->density >= 0 ? options->density : 0;
    for (;; density++) {
        double from = 0.0;
        body->target = case_resample(&body->model, density, r);
        bend_mesh(&body->target, b);
        from = case_surface_mean(&body->whole, &body->target, NULL, NULL);
        body->resampling = fmax(from, case_surface_mean(&body->target, &body->whole, NULL, NULL));
        if (options->density >= 0 || density == 2 || body->resampling < CASE_RESAMPLED_MM)
            return;
        host_mesh_free(&body->target);
    }
}

static void make_surfaces(case_body *body, const case_options *options, const bend *b, oracle_random *r)
{
    body->truth = case_copy(&body->model);
    bend_mesh(&body->truth, b);
    body->whole = case_subdivide(&body->model);
    bend_mesh(&body->whole, b);
    make_target(body, options, b, r);
}

static void find_seen(case_body *body)
{
    const smr_mesh view = host_mesh_view(&body->target);
    void *memory = NULL;
    const smr_surface *const surface = host_surface_make(&view, &memory);
    uint32_t i = 0;
    body->seen = case_alloc(body->model.n_vertices, 1);
    for (i = 0; surface != NULL && i < body->model.n_vertices; i++) {
        smr_closest hit;
        body->seen[i] =
            smr_surface_closest(surface, body->truth.xyz + 3u * (size_t)i, NULL, -2.0f, SEEN_MM, &hit) == SMR_OK &&
            hit.triangle != SMR_NONE;
    }
    free(memory);
}

/* Turns all models about their common middle and shifts them. */
static void move_to_start(case_data *data, const case_options *options)
{
    oracle_random r = oracle_seed(6000u + options->seed);
    double axis[3], shift[3], turn[9], middle[3] = {0.0, 0.0, 0.0}, count = 0.0;
    uint32_t i = 0, k = 0;
    int c = 0;
    case_direction(&r, axis);
    case_direction(&r, shift);
    oracle_turn(axis, options->turn_deg * acos(-1.0) / 180.0, turn);
    for (i = 0; i < data->n; i++)
        for (k = 0; k < data->body[i].model.n_vertices; k++, count += 1.0)
            for (c = 0; c < 3; c++)
                middle[c] += (double)data->body[i].model.xyz[3u * (size_t)k + (size_t)c];
    for (i = 0; i < data->n; i++)
        for (k = 0; k < data->body[i].model.n_vertices; k++) {
            float *const x = data->body[i].model.xyz + 3u * (size_t)k;
            double d[3];
            for (c = 0; c < 3; c++)
                d[c] = (double)x[c] - middle[c] / count;
            for (c = 0; c < 3; c++)
                x[c] = (float)(turn[3 * c] * d[0] + turn[3 * c + 1] * d[1] + turn[3 * c + 2] * d[2] +
                               middle[c] / count + options->shift_mm * shift[c]);
        }
}

void case_make(case_data *data, const case_options *options)
{
    const bend b = make_bend(data, options);
    const host_mesh *all[CASE_BODIES];
    oracle_random r = oracle_seed(8000u + options->seed);
    double axes[9], visible = 0.0, area = 0.0;
    uint32_t i = 0;
    for (i = 0; i < data->n; i++) {
        make_surfaces(&data->body[i], options, &b, &r);
        all[i] = &data->body[i].truth;
    }
    case_axes(all, data->n, axes);
    for (i = 0; i < data->n; i++) {
        case_body *const body = &data->body[i];
        unsigned char *const keep = case_visible(&body->target, options, axes);
        host_mesh cut = case_cut(&body->target, keep);
        area += case_area(&body->target);
        visible += case_area(&cut);
        host_mesh_free(&body->target);
        body->target = cut;
        find_seen(body);
        case_spoil(&body->target, &body->whole, options, &r);
        free(keep);
    }
    data->overlap = visible / area;
    move_to_start(data, options);
}
