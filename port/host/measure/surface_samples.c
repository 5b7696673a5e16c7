/* surface_samples.c: places the points of a quadrature over triangles, those on edges and corners shared.
 * Source: A. H. Stroud, "Approximate Calculation of Multiple Integrals", 1971: 7 points, degree 3.
 * SPDX-License-Identifier: MIT */
#include "measure/surface_samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measure/half_edges.h"

#define CENTROID_SHARE (27.0 / 60.0)
#define MIDDLE_SHARE (8.0 / 60.0)
#define CORNER_SHARE (3.0 / 60.0)

/* Numbers the edges from *n on, and puts their midpoints there. */
static int place_middles(const smr_mesh *mesh, host_samples *samples)
{
    host_half_edges edges;
    size_t v = 0, i = 0, end = 0, k = 0;
    int c = 0;
    if (host_half_edges_make(mesh, &edges) != 0)
        return -1;
    for (v = 0; v < mesh->n_vertices; v++)
        for (i = edges.first[v]; i < edges.first[v + 1u]; i = end) {
            const float *const a = mesh->xyz + 3u * v, *const b = mesh->xyz + 3u * (size_t)edges.edge[i].other;
            end = host_half_edges_end(&edges, v, i);
            for (k = i; k < end; k++)
                samples->middle[edges.edge[k].side] = (uint32_t)samples->n;
            for (c = 0; c < 3; c++)
                samples->xyz[3u * samples->n + (size_t)c] = 0.5f * (a[c] + b[c]);
            samples->n++;
        }
    host_half_edges_free(&edges);
    return 0;
}

static void place_centroids(const smr_mesh *mesh, host_samples *samples)
{
    size_t t = 0, c = 0;
    for (t = 0; t < mesh->n_triangles; t++, samples->n++) {
        const uint32_t *const corner = mesh->triangles + 3u * t;
        for (c = 0; c < 3; c++) {
            const double sum = (double)mesh->xyz[3u * (size_t)corner[0] + c] +
                               (double)mesh->xyz[3u * (size_t)corner[1] + c] +
                               (double)mesh->xyz[3u * (size_t)corner[2] + c];
            samples->xyz[3u * samples->n + c] = (float)(sum / 3.0);
        }
    }
}

int host_samples_make(const smr_mesh *mesh, host_samples *samples)
{
    const size_t sides = 3u * (size_t)mesh->n_triangles;
    memset(samples, 0, sizeof *samples);
    samples->xyz = malloc(((size_t)mesh->n_vertices + sides + mesh->n_triangles) * 3u * sizeof(float));
    samples->middle = malloc(sides * sizeof(uint32_t) + 1u);
    if (samples->xyz != NULL && samples->middle != NULL) {
        memcpy(samples->xyz, mesh->xyz, 3u * (size_t)mesh->n_vertices * sizeof(float));
        memset(samples->middle, 0xff, sides * sizeof(uint32_t));
        samples->n = samples->n_vertices = mesh->n_vertices;
        if (place_middles(mesh, samples) == 0) {
            place_centroids(mesh, samples);
            return 0;
        }
    }
    host_samples_free(samples);
    return -1;
}

void host_samples_free(host_samples *samples)
{
    free(samples->xyz);
    free(samples->middle);
    memset(samples, 0, sizeof *samples);
}

static double area_of(const float *xyz, const uint32_t *corner)
{
    double e[2][3], n[3];
    size_t c = 0, k = 0;
    for (k = 0; k < 2; k++)
        for (c = 0; c < 3; c++)
            e[k][c] = (double)xyz[3u * (size_t)corner[k + 1u] + c] - (double)xyz[3u * (size_t)corner[0] + c];
    for (c = 0; c < 3; c++)
        n[c] = e[0][(c + 1u) % 3u] * e[1][(c + 2u) % 3u] - e[0][(c + 2u) % 3u] * e[1][(c + 1u) % 3u];
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static void add(float *weight, size_t i, double area)
{
    weight[i] = (weight[i] > 0.0f ? weight[i] : 0.0f) + (float)area;
}

/* Returns the area of the triangles that count. */
static double weigh_triangles(const host_samples *samples, const smr_mesh *mesh, const unsigned char *seen,
                              float *weight)
{
    const size_t first_centroid = samples->n - mesh->n_triangles;
    double all = 0.0;
    size_t t = 0, c = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *const corner = mesh->triangles + 3u * t, *const middle = samples->middle + 3u * t;
        const double area = area_of(mesh->xyz, corner);
        if (seen != NULL && (!seen[corner[0]] || !seen[corner[1]] || !seen[corner[2]]))
            continue;
        add(weight, first_centroid + t, CENTROID_SHARE * area);
        for (c = 0; c < 3; c++) {
            add(weight, corner[c], CORNER_SHARE * area);
            if (middle[c] != SMR_NONE)
                add(weight, middle[c], MIDDLE_SHARE * area);
        }
        all += area;
    }
    return all;
}

void host_samples_weigh(const host_samples *samples, const smr_mesh *mesh, const unsigned char *seen, float *weight)
{
    double area = 0.0;
    size_t i = 0;
    for (i = 0; i < samples->n; i++)
        weight[i] = mesh->n_triangles == 0 && (seen == NULL || seen[i]) ? 1.0f : HOST_NOT_COUNTED;
    if (mesh->n_triangles > 0)
        area = weigh_triangles(samples, mesh, seen, weight);
    for (i = 0; mesh->n_triangles > 0 && !(area > 0.0) && i < samples->n; i++)
        weight[i] = weight[i] < 0.0f ? weight[i] : 1.0f;
}
