/* case_spoil.c: noise and outliers of a target.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measure/surface_distances.h"

double case_normal_random(oracle_random *r)
{
    const double u = oracle_uniform(r, 1e-12, 1.0), v = oracle_uniform(r, 0.0, 2.0 * acos(-1.0));
    return sqrt(-2.0 * log(u)) * cos(v);
}

void case_direction(oracle_random *r, double out[3])
{
    double length = 0.0;
    int c = 0;
    for (c = 0; c < 3; c++) {
        out[c] = case_normal_random(r);
        length += out[c] * out[c];
    }
    for (c = 0; c < 3; c++)
        out[c] /= sqrt(length);
}

static void add_noise(host_mesh *mesh, const case_options *options, oracle_random *r)
{
    double *const normal = case_vertex_normals(mesh);
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < mesh->n_vertices; i++) {
        const double along = case_normal_random(r);
        for (c = 0; c < 3; c++)
            mesh->xyz[3u * (size_t)i + (size_t)c] +=
                (float)(options->noise_mm * (options->noise_isotropic ? case_normal_random(r)
                                                                      : along * normal[3u * (size_t)i + (size_t)c]));
    }
    free(normal);
}

typedef struct around {
    smr_surface *surface;
    void *memory;
    double low[3], high[3], far;
} around;

static around begin_around(const host_mesh *whole, double far)
{
    const smr_mesh view = host_mesh_view(whole);
    around a;
    uint32_t i = 0;
    int c = 0;
    a.far = far;
    a.surface = host_surface_make(&view, &a.memory);
    for (c = 0; c < 3; c++) {
        a.low[c] = HUGE_VAL;
        a.high[c] = -HUGE_VAL;
        for (i = 0; i < whole->n_vertices; i++) {
            a.low[c] = fmin(a.low[c], (double)whole->xyz[3u * (size_t)i + (size_t)c] - far);
            a.high[c] = fmax(a.high[c], (double)whole->xyz[3u * (size_t)i + (size_t)c] + far);
        }
    }
    return a;
}

/* A place within the distance of the surface, any as likely as any other. */
static void find_place(const around *a, oracle_random *r, double out[3])
{
    smr_closest hit;
    float p[3];
    int c = 0, tries = 0;
    for (tries = 0; tries < 1000; tries++) {
        for (c = 0; c < 3; c++)
            p[c] = (float)(out[c] = oracle_uniform(r, a->low[c], a->high[c]));
        if (a->surface != NULL && smr_surface_closest(a->surface, p, NULL, -2.0f, (float)a->far, &hit) == SMR_OK &&
            hit.triangle != SMR_NONE)
            return;
    }
}

/* Small triangles of about the mesh's size, turned any way. */
static void add_strays(host_mesh *mesh, const around *a, const case_options *options, oracle_random *r)
{
    const uint32_t n = (uint32_t)(options->outliers / (1.0 - options->outliers) * mesh->n_vertices / 3.0 + 0.5);
    const double size = sqrt(case_area(mesh) / fmax(1.0, mesh->n_triangles));
    const uint32_t v = mesh->n_vertices, t = mesh->n_triangles;
    uint32_t i = 0;
    int k = 0, c = 0;
    mesh->xyz = realloc(mesh->xyz, 3u * ((size_t)v + 3u * (size_t)n) * sizeof *mesh->xyz);
    mesh->triangles = realloc(mesh->triangles, 3u * ((size_t)t + n) * sizeof *mesh->triangles);
    if (mesh->xyz == NULL || mesh->triangles == NULL)
        exit(1);
    for (i = 0; i < n; i++) {
        double p[3], d[3];
        find_place(a, r, p);
        for (k = 0; k < 3; k++) {
            case_direction(r, d);
            for (c = 0; c < 3; c++)
                mesh->xyz[3u * ((size_t)v + 3u * (size_t)i + (size_t)k) + (size_t)c] = (float)(p[c] + size * d[c]);
            mesh->triangles[3u * ((size_t)t + i) + (size_t)k] = v + 3u * i + (uint32_t)k;
        }
    }
    mesh->n_vertices += 3u * n;
    mesh->n_triangles += n;
}

static void displace_some(host_mesh *mesh, const around *a, const case_options *options, oracle_random *r)
{
    const uint32_t n = (uint32_t)(options->outliers * mesh->n_vertices + 0.5);
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < n; i++) {
        double p[3];
        const uint32_t v = oracle_below(r, mesh->n_vertices);
        find_place(a, r, p);
        for (c = 0; c < 3; c++)
            mesh->xyz[3u * (size_t)v + (size_t)c] = (float)p[c];
    }
}

void case_spoil(host_mesh *mesh, const host_mesh *whole, const case_options *options, oracle_random *r)
{
    if (options->noise_mm > 0.0)
        add_noise(mesh, options, r);
    if (options->outliers > 0.0) {
        const around a = begin_around(whole, options->outlier_mm);
        if (options->spikes)
            displace_some(mesh, &a, options, r);
        else
            add_strays(mesh, &a, options, r);
        free(a.memory);
    }
}
