/* case_resample.c: the same surface by other vertices: random points on its edges and in its triangles.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AROUND = 64 }; /* most triangles around a vertex; more are left out */

/* Triangles around each vertex: list[first[v]..first[v + 1]). */
typedef struct fans {
    uint32_t *first, *list;
} fans;

static fans find_fans(const host_mesh *mesh)
{
    fans f;
    uint32_t i = 0;
    f.first = case_alloc((size_t)mesh->n_vertices + 2u, sizeof *f.first);
    f.list = case_alloc(3u * (size_t)mesh->n_triangles, sizeof *f.list);
    for (i = 0; i < 3u * mesh->n_triangles; i++)
        f.first[mesh->triangles[i] + 2u]++;
    for (i = 2; i < mesh->n_vertices + 2u; i++)
        f.first[i] += f.first[i - 1u];
    for (i = 0; i < 3u * mesh->n_triangles; i++)
        f.list[f.first[mesh->triangles[i] + 1u]++] = i / 3u;
    return f;
}

/* The vertices of the triangle behind v, in order. */
static void others(const host_mesh *mesh, uint32_t triangle, uint32_t v, uint32_t out[2])
{
    const uint32_t *const t = mesh->triangles + 3u * (size_t)triangle;
    const uint32_t k = t[0] == v ? 0u : t[1] == v ? 1u : 2u;
    out[0] = t[(k + 1u) % 3u];
    out[1] = t[(k + 2u) % 3u];
}

/* The triangles around v, counter-clockwise. Returns their number, 0 when they do not close. */
static uint32_t go_around(const host_mesh *mesh, const fans *f, uint32_t v, uint32_t ring[AROUND])
{
    const uint32_t *const list = f->list + f->first[v], n = f->first[v + 1u] - f->first[v];
    uint32_t i = 0, k = 0, at[2], next[2];
    if (n < 3u || n > AROUND)
        return 0;
    ring[0] = list[0];
    others(mesh, ring[0], v, at);
    for (k = 1; k <= n; k++) {
        for (i = 0; i < n; i++) {
            others(mesh, list[i], v, next);
            if (next[0] == at[1])
                break;
        }
        if (i == n)
            return 0;
        if (list[i] == ring[0])
            return k == n ? n : 0u;
        if (k < n)
            ring[k] = list[i];
        at[1] = next[1];
    }
    return 0;
}

static double cross(const double *a, const double *b, const double *c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double length2(const double *a, const double *b)
{
    return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

/* How good the ear at corner k of the polygon is: twice its area over its edges' squares; below 0: no ear. */
static double ear(double (*const p)[2], const uint32_t *left, uint32_t n, uint32_t k)
{
    const double *const a = p[left[(k + n - 1u) % n]], *const b = p[left[k]], *const c = p[left[(k + 1u) % n]];
    const double quality = cross(a, b, c) / (length2(a, b) + length2(b, c) + length2(c, a));
    uint32_t i = 0;
    for (i = 2; quality > 0.0 && i + 1u < n; i++) {
        const double *const q = p[left[(k + i) % n]];
        if (cross(a, b, q) >= 0.0 && cross(b, c, q) >= 0.0 && cross(c, a, q) >= 0.0)
            return -2.0;
    }
    return quality;
}

/* Cuts the polygon's best ear off until nothing is left. */
static void fill_polygon(double (*const p)[2], const uint32_t *ring, uint32_t n, host_mesh *out)
{
    uint32_t left[AROUND], k = 0, best = 0;
    for (k = 0; k < n; k++)
        left[k] = k;
    for (; n >= 3u; n--) {
        uint32_t *const t = out->triangles + 3u * (size_t)out->n_triangles++;
        double most = -HUGE_VAL;
        for (k = 0; k < n; k++) {
            const double quality = ear(p, left, n, k);
            if (quality > most) {
                most = quality;
                best = k;
            }
        }
        t[0] = ring[left[(best + n - 1u) % n]];
        t[1] = ring[left[best]];
        t[2] = ring[left[(best + 1u) % n]];
        memmove(left + best, left + best + 1u, (n - 1u - best) * sizeof *left);
    }
}

/* The ring's new points as seen along the normal. */
static void flatten(const host_mesh *out, const uint32_t *ring, uint32_t n, const double normal[3], double (*p)[2])
{
    const int axis = fabs(normal[0]) < 0.6 ? 0 : 1;
    double u[3] = {0.0, 0.0, 0.0}, v[3], length = 0.0;
    uint32_t i = 0;
    int c = 0;
    u[axis] = 1.0;
    for (c = 0; c < 3; c++)
        u[c] -= normal[axis] * normal[c];
    length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (c = 0; c < 3; c++)
        u[c] /= length;
    for (c = 0; c < 3; c++)
        v[c] = normal[(c + 1) % 3] * u[(c + 2) % 3] - normal[(c + 2) % 3] * u[(c + 1) % 3];
    for (i = 0; i < n; i++) {
        const float *const q = out->xyz + 3u * (size_t)ring[i];
        p[i][0] = u[0] * (double)q[0] + u[1] * (double)q[1] + u[2] * (double)q[2];
        p[i][1] = v[0] * (double)q[0] + v[1] * (double)q[1] + v[2] * (double)q[2];
    }
}

/* The mean of n points of `out` by random weights. */
static void put_mean(host_mesh *out, const uint32_t *of, uint32_t n, oracle_random *r, float to[3])
{
    double sum = 0.0, mean[3] = {0.0, 0.0, 0.0};
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < n; i++) {
        const double weight = oracle_uniform(r, 0.1, 1.0);
        for (c = 0; c < 3; c++)
            mean[c] += weight * (double)out->xyz[3u * (size_t)of[i] + (size_t)c];
        sum += weight;
    }
    for (c = 0; c < 3; c++)
        to[c] = (float)(mean[c] / sum);
}

/* The point on the edge from corner i of the mesh's list of triangles that is nearer to one of its vertices. */
static uint32_t edge_point(const host_mesh *mesh, const uint32_t *edge, uint32_t density, uint32_t i, int near_end)
{
    const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
    return edge[i] * density + (density > 1u && (near_end ? b > a : a > b) ? 1u : 0u);
}

/* Points on edges: from the lower vertex to the higher. */
static void put_edges(const host_mesh *mesh, const uint32_t *edge, uint32_t density, oracle_random *r, host_mesh *out)
{
    uint32_t i = 0, k = 0;
    int c = 0;
    for (i = 0; i < 3u * mesh->n_triangles; i++) {
        const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
        for (k = 0; a < b && k < density; k++) {
            const double at = density == 1u ? oracle_uniform(r, 0.25, 0.75) : oracle_uniform(r, 0.1, 0.4) + 0.5 * k;
            for (c = 0; c < 3; c++)
                out->xyz[3u * (size_t)(edge[i] * density + k) + (size_t)c] =
                    (float)((1.0 - at) * (double)mesh->xyz[3u * (size_t)a + (size_t)c] +
                            at * (double)mesh->xyz[3u * (size_t)b + (size_t)c]);
        }
    }
}

/* A point in each triangle; with points on edges, triangles from it to them. */
static void put_triangles(const host_mesh *mesh, const uint32_t *edge, uint32_t density, oracle_random *r,
                          host_mesh *out)
{
    uint32_t t = 0, k = 0, ring[6];
    for (t = 0; t < mesh->n_triangles; t++) {
        const uint32_t at = out->n_vertices - mesh->n_triangles + t, n = 3u * density;
        float *const middle = out->xyz + 3u * (size_t)at;
        host_mesh corners = *mesh;
        if (density == 0) {
            put_mean(&corners, mesh->triangles + 3u * (size_t)t, 3, r, middle);
            continue;
        }
        for (k = 0; k < n; k++)
            ring[k] = edge_point(mesh, edge, density, 3u * t + k / density, (int)(k % density));
        put_mean(out, ring, n, r, middle);
        for (k = 0; k < n; k++) {
            const uint32_t one[3] = {at, ring[k], ring[(k + 1u) % n]};
            memcpy(out->triangles + 3u * (size_t)out->n_triangles++, one, sizeof one);
        }
    }
}

/* The polygon of new points around a vertex: in the triangles or on the edges. */
static uint32_t find_ring(const host_mesh *mesh, const fans *f, const uint32_t *edge, uint32_t density, uint32_t v,
                          uint32_t ring[AROUND])
{
    const uint32_t n = go_around(mesh, f, v, ring);
    uint32_t i = 0;
    for (i = 0; density > 0 && i < n; i++) {
        const uint32_t *const t = mesh->triangles + 3u * (size_t)ring[i];
        ring[i] = edge_point(mesh, edge, density, 3u * ring[i] + (t[0] == v ? 0u : t[1] == v ? 1u : 2u), 0);
    }
    return n;
}

host_mesh case_resample(const host_mesh *mesh, int density, oracle_random *r)
{
    uint32_t *const edge = case_alloc(3u * (size_t)mesh->n_triangles, sizeof *edge);
    const uint32_t n_edges = case_number_edges(mesh, edge), many = (uint32_t)density;
    double *const normal = case_vertex_normals(mesh);
    fans f = find_fans(mesh);
    host_mesh out = case_new_mesh(n_edges * many + mesh->n_triangles, (3u + 3u * many) * mesh->n_triangles);
    uint32_t v = 0;
    out.n_triangles = 0;
    put_edges(mesh, edge, many, r, &out);
    put_triangles(mesh, edge, many, r, &out);
    for (v = 0; v < mesh->n_vertices; v++) {
        uint32_t ring[AROUND];
        double p[AROUND][2];
        const uint32_t n = find_ring(mesh, &f, edge, many, v, ring);
        flatten(&out, ring, n, normal + 3u * (size_t)v, p);
        fill_polygon(p, ring, n, &out);
    }
    free(edge);
    free(normal);
    free(f.first);
    free(f.list);
    return out;
}
