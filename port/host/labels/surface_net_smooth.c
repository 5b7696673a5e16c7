/* surface_net_smooth.c: smooths a surface net within its cells: a low-pass filter that does not shrink, then the
 * volume, then the folds.
 * Source: G. Taubin, "A signal processing approach to fair surface design", 1995.
 * SPDX-License-Identifier: MIT */
#include "labels/surface_net.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define INWARDS 0.6f       /* share of the way to the mean of the neighbours, first half of a pass */
#define OUTWARDS (-0.612f) /* second half: waves longer than some 10 edges stay */
#define VOLUME_STEPS 12
#define VOLUME_NEAR 0.0005 /* share of the volume */
#define UNFOLDING 24       /* rounds */
#define SEARCHES 16        /* rounds, for the folds that are left */
#define RIGHT_ANGLE 0.01   /* cosine: a little less, for rounding */
#define WELL 0.1           /* cosine: edges bent less are not searched for better */

typedef struct vector {
    double x, y, z;
} vector;

static vector point(const host_net *net, uint32_t v)
{
    const float *const p = net->xyz + 3u * (size_t)v;
    return (vector){(double)p[0], (double)p[1], (double)p[2]};
}

static vector minus(vector a, vector b) { return (vector){a.x - b.x, a.y - b.y, a.z - b.z}; }
static double dot(vector a, vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vector cross(vector a, vector b)
{
    return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Puts a vertex, but no further than it may go. */
static void put(host_net *net, size_t v, unsigned k, float to)
{
    const size_t i = 3u * v + k;
    net->xyz[i] = to < net->low[i] ? net->low[i] : (to > net->high[i] ? net->high[i] : to);
}

/* Moves all vertices by a share of the way to the mean of their neighbours. before: room, [n_vertices][3]. */
static void move_to_mean(host_net *net, float share, float *before)
{
    memcpy(before, net->xyz, 3u * (size_t)net->n_vertices * sizeof *before);
    for (size_t v = 0; v < net->n_vertices; v++) {
        const size_t first = net->side_first[v], end = net->side_first[v + 1u];
        float sum[3] = {0};
        for (size_t i = first; i < end; i++)
            for (unsigned k = 0; k < 3u; k++)
                sum[k] += before[3u * (size_t)net->side[i].to + k];
        for (unsigned k = 0; k < 3u; k++)
            put(net, v, k, before[3u * v + k] + share * (sum[k] / (float)(end - first) - before[3u * v + k]));
    }
}

void host_net_corners(const host_net *net, uint32_t quad, unsigned char corner[2][3])
{
    static const unsigned char both[2][2][3] = {{{0, 1, 2}, {0, 2, 3}}, {{0, 1, 3}, {1, 2, 3}}};
    memcpy(corner, both[net->split[quad]], 6);
}

/* The normal of one of a quadrangle's triangles, twice its area long. */
static vector normal_of(const host_net *net, uint32_t quad, unsigned triangle)
{
    const uint32_t *const q = net->quad + 4u * (size_t)quad;
    unsigned char corner[2][3];
    host_net_corners(net, quad, corner);
    vector a = point(net, q[corner[triangle][0]]);
    return cross(minus(point(net, q[corner[triangle][1]]), a), minus(point(net, q[corner[triangle][2]]), a));
}

double host_net_volume(const host_net *net, double *area)
{
    double six = 0.0, twice = 0.0;
    for (uint32_t q = 0; q < net->n_quads; q++)
        for (unsigned t = 0; t < 2u; t++) { /* corner t lies in triangle t, whichever way it is split */
            const vector n = normal_of(net, q, t);
            unsigned char corner[2][3];
            host_net_corners(net, q, corner);
            six += dot(n, point(net, net->quad[4u * (size_t)q + corner[t][0]]));
            twice += sqrt(dot(n, n));
        }
    *area = 0.5 * twice;
    return six / 6.0;
}

/* Adds up the normals around each vertex. */
static void add_normals(const host_net *net, float *normal)
{
    memset(normal, 0, 3u * (size_t)net->n_vertices * sizeof *normal);
    for (uint32_t q = 0; q < net->n_quads; q++)
        for (unsigned t = 0; t < 2u; t++) {
            const vector n = normal_of(net, q, t);
            unsigned char corner[2][3];
            host_net_corners(net, q, corner);
            for (unsigned c = 0; c < 3u; c++) {
                float *const to = normal + 3u * (size_t)net->quad[4u * (size_t)q + corner[t][c]];
                to[0] += (float)n.x;
                to[1] += (float)n.y;
                to[2] += (float)n.z;
            }
        }
}

/* Moves all vertices along their normals until the volume is right, as far as the cells allow. */
static void set_volume(host_net *net, double volume, float *normal)
{
    for (int step = 0; step < VOLUME_STEPS; step++) {
        double area = 0.0;
        const double missing = volume - host_net_volume(net, &area);
        if (fabs(missing) <= VOLUME_NEAR * volume || !(area > 0.0))
            return;
        add_normals(net, normal);
        for (size_t v = 0; v < net->n_vertices; v++) {
            const float *const n = normal + 3u * v;
            const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            for (unsigned k = 0; k < 3u && length > 0.0f; k++)
                put(net, v, k, net->xyz[3u * v + k] + (float)(missing / area) * n[k] / length);
        }
    }
}

static double cosine(vector a, vector b)
{
    const double length = sqrt(dot(a, a) * dot(b, b));
    return length > 0.0 ? dot(a, b) / length : -1.0;
}

/* Splits each quadrangle along the diagonal that bends it less. */
static void choose_splits(host_net *net)
{
    for (uint32_t q = 0; q < net->n_quads; q++) {
        double straight[2];
        for (unsigned s = 0; s < 2u; s++) {
            net->split[q] = (unsigned char)s;
            straight[s] = cosine(normal_of(net, q, 0), normal_of(net, q, 1));
        }
        net->split[q] = straight[1] > straight[0];
    }
}

/* The triangle of a quadrangle at its side k. */
static unsigned triangle_at(const host_net *net, uint32_t quad, unsigned k)
{
    return net->split[quad] == 0 ? k / 2u : (unsigned)(k == 1u || k == 2u);
}

/* The side that runs the other way. */
static const host_net_side *twin(const host_net *net, uint32_t v, const host_net_side *side)
{
    for (size_t i = net->side_first[side->to]; i < net->side_first[side->to + 1u]; i++)
        if (net->side[i].to == v)
            return &net->side[i];
    return side;
}

static void mark(const host_net *net, uint32_t quad, unsigned char *marked)
{
    for (unsigned k = 0; k < 4u; k++)
        marked[net->quad[4u * (size_t)quad + k]] = 1;
}

/* Marks the vertices at edges that are turned back. Returns how many edges there are. */
static uint32_t find_folds(const host_net *net, double least, unsigned char *marked)
{
    uint32_t n = 0;
    memset(marked, 0, net->n_vertices);
    for (uint32_t q = 0; q < net->n_quads; q++)
        if (cosine(normal_of(net, q, 0), normal_of(net, q, 1)) < least) {
            mark(net, q, marked);
            n++;
        }
    for (uint32_t v = 0; v < net->n_vertices; v++)
        for (size_t i = net->side_first[v]; i < net->side_first[v + 1u]; i++) {
            const host_net_side *const a = &net->side[i], *b = NULL;
            if (a->to < v)
                continue;
            b = twin(net, v, a);
            if (cosine(normal_of(net, a->quad, triangle_at(net, a->quad, a->k)),
                       normal_of(net, b->quad, triangle_at(net, b->quad, b->k))) < least) {
                mark(net, a->quad, marked);
                mark(net, b->quad, marked);
                n++;
            }
        }
    return n;
}

/* Takes marked vertices half the way back to where they started: the net has no folds there. */
static void unfold(host_net *net, const unsigned char *marked)
{
    for (size_t v = 0; v < net->n_vertices; v++)
        for (unsigned k = 0; k < 3u && marked[v]; k++)
            put(net, v, k, 0.5f * (net->xyz[3u * v + k] + net->start[3u * v + k]));
}

/* How far an edge is bent beyond what is well, squared. */
static double strain(vector a, vector b)
{
    const double beyond = WELL - cosine(a, b);
    return beyond > 0.0 ? beyond * beyond : 0.0;
}

/* The strain of a quadrangle: within and along its sides. */
static double quad_strain(const host_net *net, uint32_t quad)
{
    double sum = strain(normal_of(net, quad, 0), normal_of(net, quad, 1));
    for (unsigned k = 0; k < 4u; k++) {
        const host_net_side side = {net->quad[4u * (size_t)quad + (k + 1u) % 4u], quad, k};
        const host_net_side *const other = twin(net, net->quad[4u * (size_t)quad + k], &side);
        sum += strain(normal_of(net, quad, triangle_at(net, quad, k)),
                      normal_of(net, other->quad, triangle_at(net, other->quad, other->k)));
    }
    return sum;
}

static double strain_around(const host_net *net, uint32_t v)
{
    double sum = 0.0;
    for (size_t i = net->side_first[v]; i < net->side_first[v + 1u]; i++)
        sum += quad_strain(net, net->side[i].quad);
    return sum;
}

/* Splits a vertex' quadrangles the other way where that takes strain off. */
static double try_splits(const host_net *net, uint32_t v, double best)
{
    for (size_t i = net->side_first[v]; i < net->side_first[v + 1u]; i++) {
        unsigned char *const split = &net->split[net->side[i].quad];
        *split ^= 1u;
        double now = strain_around(net, v);
        if (now < best)
            best = now;
        else
            *split ^= 1u;
    }
    return best;
}

/* Moves a vertex by shares of its cell, along one axis at a time, while that takes strain off. */
static void try_places(host_net *net, uint32_t v)
{
    static const float shares[] = {0.3f, -0.3f, 0.1f, -0.1f, 0.03f, -0.03f};
    double best = strain_around(net, v);
    for (unsigned s = 0; s < 6u && best > 0.0; s++)
        for (unsigned k = 0; k < 3u; k++) {
            const size_t i = 3u * (size_t)v + k;
            const float before = net->xyz[i];
            put(net, v, k, before + shares[s] * (net->high[i] - net->low[i]));
            double now = strain_around(net, v);
            if (now < best)
                best = now;
            else
                net->xyz[i] = before;
        }
    if (best > 0.0)
        (void)try_splits(net, v, best);
}

/* Searches for places without folds around those that are left. */
static void search_unfolded(host_net *net, unsigned char *marked)
{
    for (uint32_t round = 0; round < SEARCHES && find_folds(net, RIGHT_ANGLE, marked) > 0; round++)
        for (uint32_t v = 0; v < net->n_vertices; v++)
            if (marked[v])
                try_places(net, v);
}

uint32_t host_net_smooth(host_net *net, uint32_t passes, double volume)
{
    float *const room = malloc(3u * (size_t)net->n_vertices * sizeof *room + 1u);
    unsigned char *const marked = malloc((size_t)net->n_vertices + 1u);
    uint32_t folds = UINT32_MAX;
    for (uint32_t i = 0; room != NULL && marked != NULL && i < passes; i++) {
        move_to_mean(net, INWARDS, room);
        move_to_mean(net, OUTWARDS, room);
    }
    for (uint32_t i = 0; room != NULL && marked != NULL && i < UNFOLDING; i++) {
        set_volume(net, volume, room);
        choose_splits(net);
        if (find_folds(net, RIGHT_ANGLE, marked) == 0)
            break;
        if (i + 1u < UNFOLDING)
            unfold(net, marked);
    }
    if (room != NULL && marked != NULL)
        search_unfolded(net, marked);
    if (room != NULL && marked != NULL)
        folds = find_folds(net, 0.0, marked);
    free(room);
    free(marked);
    return folds;
}
