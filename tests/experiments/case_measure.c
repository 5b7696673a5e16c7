/* case_measure.c: how far a result is from a case's truth.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "measure/surface_distances.h"

/* The seven places of the quadrature: weights of the corners in units of a sixth, and 60 times the place's weight. */
static const unsigned char places[7][4] = {{2, 2, 2, 27}, {3, 3, 0, 8}, {0, 3, 3, 8}, {3, 0, 3, 8},
                                           {6, 0, 0, 3},  {0, 6, 0, 3}, {0, 0, 6, 3}};

static double distance_to(const smr_surface *surface, const float p[3])
{
    smr_closest hit;
    if (smr_surface_closest(surface, p, NULL, -2.0f, 4.0f * SMR_COORD_MAX, &hit) != SMR_OK || hit.triangle == SMR_NONE)
        return HUGE_VAL;
    return (double)hit.distance;
}

/* The distances' sum by weight of one triangle; corners' distances are known. */
static double over_triangle(const smr_surface *surface, const host_mesh *mesh, uint32_t t, const float *at_vertex,
                            double *max)
{
    const uint32_t *const v = mesh->triangles + 3u * (size_t)t;
    double sum = 0.0;
    int k = 0, c = 0;
    for (k = 0; k < 4; k++) {
        float p[3];
        double d = 0.0;
        for (c = 0; c < 3; c++)
            p[c] = ((float)places[k][0] * mesh->xyz[3u * (size_t)v[0] + (size_t)c] +
                    (float)places[k][1] * mesh->xyz[3u * (size_t)v[1] + (size_t)c] +
                    (float)places[k][2] * mesh->xyz[3u * (size_t)v[2] + (size_t)c]) /
                   6.0f;
        d = distance_to(surface, p);
        sum += places[k][3] / 60.0 * d;
        *max = fmax(*max, d);
    }
    for (k = 0; k < 3; k++)
        sum += 3.0 / 60.0 * (double)at_vertex[v[k]];
    return sum;
}

double case_surface_mean(const host_mesh *from, const host_mesh *to, double *max, double *area)
{
    const smr_mesh view = host_mesh_view(to);
    float *const at_vertex = case_alloc(from->n_vertices, sizeof *at_vertex);
    void *memory = NULL;
    const smr_surface *const surface = host_surface_make(&view, &memory);
    double sum = 0.0, all = 0.0, most = 0.0;
    uint32_t i = 0;
    for (i = 0; surface != NULL && i < from->n_vertices; i++) {
        at_vertex[i] = (float)distance_to(surface, from->xyz + 3u * (size_t)i);
        most = fmax(most, (double)at_vertex[i]);
    }
    for (i = 0; surface != NULL && i < from->n_triangles; i++) {
        double n[3], a = 0.0;
        case_triangle_normal(from, i, n);
        a = 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        sum += a * over_triangle(surface, from, i, at_vertex, &most);
        all += a;
    }
    free(at_vertex);
    free(memory);
    if (max != NULL)
        *max = fmax(*max, most);
    if (area != NULL)
        *area = all;
    return surface != NULL && all > 0.0 ? sum / all : HUGE_VAL;
}

/* Sums of distances to the true places: [0] of all vertices, [1] of those not seen. */
static void add_vertices(const case_body *body, const float *xyz, double sum[2], double count[2])
{
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < body->model.n_vertices; i++) {
        double d = 0.0;
        for (c = 0; c < 3; c++) {
            const double x =
                (double)xyz[3u * (size_t)i + (size_t)c] - (double)body->truth.xyz[3u * (size_t)i + (size_t)c];
            d += x * x;
        }
        sum[0] += sqrt(d);
        count[0] += 1.0;
        sum[1] += body->seen[i] ? 0.0 : sqrt(d);
        count[1] += body->seen[i] ? 0.0 : 1.0;
    }
}

case_figures case_measure(const case_data *data, const float *const *xyz)
{
    case_figures f;
    double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, area[2] = {0.0, 0.0};
    uint32_t i = 0;
    memset(&f, 0, sizeof f);
    for (i = 0; i < data->n; i++) {
        const case_body *const body = &data->body[i];
        double a = 0.0, to = 0.0, from = 0.0;
        host_mesh result = case_copy(&body->model);
        memcpy(result.xyz, xyz[i], 3u * (size_t)result.n_vertices * sizeof *result.xyz);
        to = case_surface_mean(&result, &body->whole, &f.farthest, &a);
        f.to += a * to;
        area[0] += a;
        from = case_surface_mean(&body->whole, &result, &f.farthest, &a);
        f.from += a * from;
        area[1] += a;
        f.worst = fmax(f.worst, fmax(to, from));
        if (body->truth.n_vertices > 0)
            add_vertices(body, xyz[i], sum, count);
        host_mesh_free(&result);
    }
    f.to /= area[0];
    f.from /= area[1];
    f.surface = fmax(f.to, f.from);
    f.vertex = count[0] > 0.0 ? sum[0] / count[0] : -1.0;
    f.unseen = count[1] > 0.0 ? sum[1] / count[1] : -1.0;
    f.seen = count[0] > count[1] ? (sum[0] - sum[1]) / (count[0] - count[1]) : -1.0;
    f.share = count[0] > 0.0 ? 1.0 - count[1] / count[0] : -1.0;
    return f;
}

case_figures case_measure_start(const case_data *data)
{
    const float *xyz[CASE_BODIES];
    uint32_t i = 0;
    for (i = 0; i < data->n; i++)
        xyz[i] = data->body[i].model.xyz;
    return case_measure(data, xyz);
}

int case_measure_files(const case_data *data, const char *result, case_figures *figures)
{
    host_mesh mesh[CASE_BODIES];
    const float *xyz[CASE_BODIES];
    struct stat found;
    uint32_t i = 0;
    int good = stat(result, &found) == 0;
    memset(mesh, 0, sizeof mesh);
    for (i = 0; good && i < data->n; i++) {
        host_error error;
        char path[CASE_TEXT];
        memset(&error, 0, sizeof error);
        if (S_ISDIR(found.st_mode))
            (void)snprintf(path, sizeof path, "%.900s/%.64s.ply", result, data->body[i].name);
        else
            (void)snprintf(path, sizeof path, "%.1000s", result);
        good = host_mesh_read(path, HOST_MESH_POINTS_TOO, HOST_MIRROR_NONE, &mesh[i], &error) == 0;
        if (!good)
            host_error_print(&error);
        good = good && mesh[i].n_vertices == data->body[i].model.n_vertices;
        xyz[i] = mesh[i].xyz;
    }
    if (good)
        *figures = case_measure(data, xyz);
    for (i = 0; i < data->n; i++)
        host_mesh_free(&mesh[i]);
    return good;
}
