/* edge_collapse.c: quadrics, the place that keeps the volume, and what a collapse must not do.
 * SPDX-License-Identifier: MIT */
#include "labels/edge_collapse.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STAY 1e-3   /* share of a triangle's weight that holds its vertices where they are: flat parts stay even */
#define TURN 0.3    /* cosine: a triangle's normal turns by less than 72 degrees */
#define FOLD 0.05   /* cosine between triangles at an edge, at least */
#define NEEDLE 0.08 /* 1: all sides alike; triangles below that get no thinner */

static void sub(const double a[3], const double b[3], double to[3])
{
    for (int c = 0; c < 3; c++)
        to[c] = a[c] - b[c];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double to[3])
{
    for (int c = 0; c < 3; c++)
        to[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static const double *place_of(const host_thinned *t, uint32_t v) { return t->xyz + 3u * (size_t)v; }

/* Normal of a triangle, twice its area long. */
static void normal_of(const double a[3], const double b[3], const double c[3], double n[3])
{
    double u[3], v[3];
    sub(b, a, u);
    sub(c, a, v);
    cross(u, v, n);
}

/* Adds weight times the squared distance along n from the point. */
static void add_plane(host_quadric *to, const double n[3], const double at[3], double weight)
{
    const double d = -dot(n, at);
    const double row[4] = {n[0], n[1], n[2], d};
    static const unsigned char i[10] = {0, 0, 0, 1, 1, 2, 0, 1, 2, 3}, k[10] = {0, 1, 2, 1, 2, 2, 3, 3, 3, 3};
    for (int e = 0; e < 10; e++)
        to->q[e] += weight * row[i[e]] * row[k[e]];
}

/* The quadric of a triangle goes to its corners: its plane, and a little of where the corner is. */
static void add_triangle(host_thinned *t, const uint32_t *corner)
{
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double n[3], area = 0.0;
    normal_of(place_of(t, corner[0]), place_of(t, corner[1]), place_of(t, corner[2]), n);
    area = sqrt(dot(n, n));
    if (!(area > 0.0))
        return;
    for (int c = 0; c < 3; c++)
        n[c] /= area;
    for (int c = 0; c < 3; c++) {
        const double *const at = place_of(t, corner[c]);
        add_plane(&t->quadric[corner[c]], n, at, area);
        for (int k = 0; k < 3; k++)
            add_plane(&t->quadric[corner[c]], axes[k], at, STAY * area);
    }
}

static int allocate(host_thinned *t)
{
    const size_t v = (size_t)t->n_vertices + 1u, c = 3u * (size_t)t->n_triangles + 3u;
    t->xyz = malloc(3u * v * sizeof *t->xyz);
    t->quadric = calloc(v, sizeof *t->quadric);
    t->first = malloc(v * sizeof *t->first);
    t->triangles = malloc(c * sizeof *t->triangles);
    t->next = malloc(c * sizeof *t->next);
    return t->xyz != NULL && t->quadric != NULL && t->first != NULL && t->triangles != NULL && t->next != NULL ? 0 : -1;
}

int host_thinned_make(const host_mesh *mesh, host_thinned *t)
{
    const size_t corners = 3u * (size_t)mesh->n_triangles;
    memset(t, 0, sizeof *t);
    t->n_vertices = mesh->n_vertices;
    t->n_triangles = t->left = mesh->n_triangles;
    if (allocate(t) != 0)
        return -1;
    for (size_t i = 0; i < 3u * (size_t)mesh->n_vertices; i++)
        t->centre[i % 3u] += (double)mesh->xyz[i] / mesh->n_vertices;
    for (size_t i = 0; i < mesh->n_vertices; i++) {
        t->first[i] = SMR_NONE;
        for (int c = 0; c < 3; c++)
            t->xyz[3u * i + (size_t)c] = (double)mesh->xyz[3u * i + (size_t)c] - t->centre[c];
    }
    memcpy(t->triangles, mesh->triangles, corners * sizeof *t->triangles);
    for (size_t i = corners; i-- > 0;) {
        t->next[i] = t->first[t->triangles[i]];
        t->first[t->triangles[i]] = (uint32_t)i;
    }
    for (size_t i = 0; i < corners; i += 3)
        add_triangle(t, t->triangles + i);
    return 0;
}

void host_thinned_free(host_thinned *t)
{
    free(t->xyz);
    free(t->quadric);
    free(t->first);
    free(t->triangles);
    free(t->next);
    memset(t, 0, sizeof *t);
}

/* The vertex that stands so many places behind a corner in its triangle. */
static uint32_t behind(const host_thinned *t, uint32_t corner, uint32_t places)
{
    return t->triangles[corner - corner % 3u + (corner + places) % 3u];
}

uint32_t host_thinned_ring(const host_thinned *t, uint32_t v, uint32_t ring[HOST_RING_MOST])
{
    uint32_t n = 0;
    for (uint32_t c = t->first[v]; c != SMR_NONE; c = t->next[c]) {
        if (n == HOST_RING_MOST)
            return 0;
        ring[n++] = behind(t, c, 1); /* each vertex about it follows it in one triangle of a closed surface */
    }
    return n;
}

/* What the volume says of the place x: gain . x = gain . at for all x that keep it; both in mm^3 with x from origin. */
static double volume_rule(const host_thinned *t, uint32_t a, uint32_t b, const double origin[3], double gain[3])
{
    const uint32_t ends[2] = {a, b};
    double volume = 0.0, u[3], v[3], w[3], n[3];
    memset(gain, 0, 3u * sizeof *gain);
    for (uint32_t e = 0; e < 2u; e++)
        for (uint32_t c = t->first[ends[e]]; c != SMR_NONE; c = t->next[c]) {
            const uint32_t p = behind(t, c, 1), q = behind(t, c, 2);
            const int both = p == ends[1u - e] || q == ends[1u - e];
            if (both && e == 1u)
                continue; /* counted already */
            sub(place_of(t, ends[e]), origin, u);
            sub(place_of(t, p), origin, v);
            sub(place_of(t, q), origin, w);
            cross(v, w, n);
            volume += dot(u, n);
            for (int k = 0; k < 3 && !both; k++)
                gain[k] += n[k];
        }
    return volume;
}

/* Solves the symmetric positive definite system by Cholesky's method. 0, or -1 when it is none. */
static int solve(const double m[6], const double right[3], double x[3])
{
    const double l00 = sqrt(m[0]), l10 = m[1] / l00, l20 = m[2] / l00, d1 = m[3] - l10 * l10;
    const double l11 = sqrt(d1), l21 = (m[4] - l20 * l10) / l11, d2 = m[5] - l20 * l20 - l21 * l21;
    const double l22 = sqrt(d2), y0 = right[0] / l00, y1 = (right[1] - l10 * y0) / l11;
    const double y2 = (right[2] - l20 * y0 - l21 * y1) / l22;
    if (!(m[0] > 0.0 && d1 > 0.0 && d2 > 0.0))
        return -1;
    x[2] = y2 / l22;
    x[1] = (y1 - l21 * x[2]) / l11;
    x[0] = (y0 - l10 * x[1] - l20 * x[2]) / l00;
    return 0;
}

static double cost_at(const host_quadric *q, const double x[3])
{
    const double *const m = q->q;
    return m[0] * x[0] * x[0] + m[3] * x[1] * x[1] + m[5] * x[2] * x[2] +
           2.0 * (m[1] * x[0] * x[1] + m[2] * x[0] * x[2] + m[4] * x[1] * x[2] + m[6] * x[0] + m[7] * x[1] +
                  m[8] * x[2]) +
           m[9];
}

double host_collapse_place(const host_thinned *t, uint32_t a, uint32_t b, double at[3])
{
    host_quadric sum;
    double middle[3], gain[3], right[3], step[3], volume = 0.0, share = 0.0;
    for (int k = 0; k < 10; k++)
        sum.q[k] = t->quadric[a].q[k] + t->quadric[b].q[k];
    for (int k = 0; k < 3; k++) {
        middle[k] = at[k] = 0.5 * (place_of(t, a)[k] + place_of(t, b)[k]);
        right[k] = -sum.q[6 + k];
    }
    if (solve(sum.q, right, at) != 0)
        memcpy(at, middle, sizeof middle);
    volume = volume_rule(t, a, b, middle, gain);
    if (solve(sum.q, gain, step) == 0) {
        share = dot(gain, step);
        volume -= dot(gain, at) - dot(gain, middle);
        for (int k = 0; k < 3 && share > 0.0; k++)
            at[k] += step[k] * volume / share;
    }
    return cost_at(&sum, at);
}

/* 1: sides alike; 0: all on a line. n: the normal, twice the area long. */
static double quality(const double a[3], const double b[3], const double c[3], const double n[3])
{
    double u[3], v[3], w[3], sides = 0.0;
    sub(a, b, u);
    sub(b, c, v);
    sub(c, a, w);
    sides = dot(u, u) + dot(v, v) + dot(w, w);
    return sides > 0.0 ? 3.4641016 * sqrt(dot(n, n)) / sides : 0.0;
}

static int is_flat_enough(const double m[3], const double n[3], double least)
{
    return dot(m, n) > least * sqrt(dot(m, m) * dot(n, n));
}

/* The vertices about both ends of an edge are the two opposite to it. */
static int is_simple(const host_thinned *t, uint32_t a, uint32_t b)
{
    uint32_t about_a[HOST_RING_MOST], about_b[HOST_RING_MOST];
    const uint32_t n = host_thinned_ring(t, a, about_a), m = host_thinned_ring(t, b, about_b);
    uint32_t both = 0, edges = 0;
    if (n < 3u || m < 3u || (n == 3u && m == 3u) || n + m > HOST_RING_MOST)
        return 0;
    for (uint32_t i = 0; i < n; i++) {
        edges += about_a[i] == b;
        for (uint32_t k = 0; k < m; k++)
            both += about_a[i] == about_b[k];
    }
    for (uint32_t k = 0; k < m; k++)
        edges += about_b[k] == a;
    return both == 2u && edges == 2u;
}

/* The corner opposite to the side from p to q, where that runs from q to p: in the triangle beside; SMR_NONE: none. */
static uint32_t beside(const host_thinned *t, uint32_t p, uint32_t q)
{
    for (uint32_t c = t->first[p]; c != SMR_NONE; c = t->next[c])
        if (behind(t, c, 2) == q)
            return behind(t, c, 1);
    return SMR_NONE;
}

/* A triangle after a collapse, against what it was and against its neighbours. */
static int triangle_may(const host_thinned *t, uint32_t corner, const uint32_t ends[2], const double at[3])
{
    const uint32_t v = t->triangles[corner], p = behind(t, corner, 1), q = behind(t, corner, 2);
    const double *const x = place_of(t, p), *const y = place_of(t, q);
    const uint32_t other = beside(t, p, q), left = beside(t, v, p);
    double now[3], then[3], n[3], was = 0.0, is = 0.0;
    normal_of(place_of(t, v), x, y, now);
    normal_of(at, x, y, then);
    was = quality(place_of(t, v), x, y, now);
    is = quality(at, x, y, then);
    if (other == SMR_NONE || left == SMR_NONE || !is_flat_enough(now, then, TURN) ||
        !(is >= (was < NEEDLE ? was : NEEDLE)))
        return 0;
    normal_of(y, x, place_of(t, other), n); /* beyond the far side */
    if (!is_flat_enough(then, n, FOLD))
        return 0;
    if (left == ends[0] || left == ends[1]) { /* that one goes: its neighbour comes there */
        const uint32_t end = v == ends[0] ? ends[1] : ends[0];
        const uint32_t far = beside(t, end, p);
        if (far == SMR_NONE)
            return 0;
        normal_of(at, place_of(t, far), x, n);
    } else {
        normal_of(at, place_of(t, left), x, n);
    }
    return is_flat_enough(then, n, FOLD);
}

int host_collapse_may(const host_thinned *t, uint32_t a, uint32_t b, const double at[3])
{
    const uint32_t ends[2] = {a, b};
    if (!is_simple(t, a, b))
        return 0;
    for (uint32_t e = 0; e < 2u; e++)
        for (uint32_t c = t->first[ends[e]]; c != SMR_NONE; c = t->next[c]) {
            const int goes = behind(t, c, 1) == ends[1u - e] || behind(t, c, 2) == ends[1u - e];
            if (!goes && !triangle_may(t, c, ends, at))
                return 0;
        }
    return 1;
}

/* Takes a corner out of its vertex's list. */
static void unlink_corner(host_thinned *t, uint32_t corner)
{
    uint32_t *at = &t->first[t->triangles[corner]];
    while (*at != corner)
        at = &t->next[*at];
    *at = t->next[corner];
}

void host_collapse_do(host_thinned *t, uint32_t a, uint32_t b, const double at[3])
{
    uint32_t after = 0, *end = NULL;
    for (uint32_t c = t->first[b]; c != SMR_NONE; c = after) {
        const uint32_t triangle = c / 3u;
        after = t->next[c];
        if (behind(t, c, 1) != a && behind(t, c, 2) != a)
            continue;
        for (uint32_t k = 0; k < 3u; k++)
            unlink_corner(t, 3u * triangle + k);
        for (uint32_t k = 0; k < 3u; k++)
            t->triangles[3u * (size_t)triangle + k] = SMR_NONE;
        t->left--;
    }
    for (uint32_t c = t->first[b]; c != SMR_NONE; c = t->next[c])
        t->triangles[c] = a;
    for (end = &t->first[a]; *end != SMR_NONE;)
        end = &t->next[*end];
    *end = t->first[b];
    t->first[b] = SMR_NONE;
    memcpy(t->xyz + 3u * (size_t)a, at, 3u * sizeof *at);
    for (uint32_t k = 0; k < 10u; k++)
        t->quadric[a].q[k] += t->quadric[b].q[k];
}
