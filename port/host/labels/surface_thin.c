/* surface_thin.c: a heap of edges, the cheapest first. What was pushed before its vertices changed is stale: skipped.
 * SPDX-License-Identifier: MIT */
#include "labels/label_surfaces.h"
#include <stdlib.h>
#include "labels/edge_collapse.h"

typedef struct candidate {
    double cost;
    uint32_t a, b; /* vertices, a < b */
    uint32_t made; /* sum of what the vertices had been moved by then */
} candidate;

typedef struct thinning {
    host_thinned t;
    candidate *heap; /* [n]; owned */
    uint32_t *moved; /* [n_vertices] how often a vertex was moved; owned */
    size_t n, room;
} thinning;

/* Ties by numbers of vertices: one order on every machine. */
static int comes_before(const candidate *x, const candidate *y)
{
    if (x->cost < y->cost || x->cost > y->cost)
        return x->cost < y->cost;
    if (x->a != y->a)
        return x->a < y->a;
    return x->b < y->b;
}

static void sink(candidate *heap, size_t n, size_t at)
{
    const candidate moved = heap[at];
    for (size_t child = 2u * at + 1u; child < n; child = 2u * at + 1u) {
        if (child + 1u < n && comes_before(&heap[child + 1u], &heap[child]))
            child++;
        if (!comes_before(&heap[child], &moved))
            break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = moved;
}

static void rise(candidate *heap, size_t at)
{
    const candidate moved = heap[at];
    for (; at > 0 && comes_before(&moved, &heap[(at - 1u) / 2u]); at = (at - 1u) / 2u)
        heap[at] = heap[(at - 1u) / 2u];
    heap[at] = moved;
}

static int is_stale(const thinning *s, const candidate *c)
{
    return s->t.first[c->a] == SMR_NONE || s->t.first[c->b] == SMR_NONE || c->made != s->moved[c->a] + s->moved[c->b];
}

static void drop_stale(thinning *s)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        if (!is_stale(s, &s->heap[i]))
            s->heap[n++] = s->heap[i];
    s->n = n;
    for (size_t i = n / 2u; i-- > 0;)
        sink(s->heap, n, i);
}

/* There is room for twice the edges that the surface began with, and each edge is there once when none is stale. */
static void push(thinning *s, uint32_t u, uint32_t v)
{
    candidate c;
    double at[3];
    c.a = u < v ? u : v;
    c.b = u < v ? v : u;
    c.made = s->moved[u] + s->moved[v];
    c.cost = host_collapse_place(&s->t, c.a, c.b, at);
    if (s->n == s->room)
        drop_stale(s);
    s->heap[s->n] = c;
    rise(s->heap, s->n++);
}

static void push_all(thinning *s)
{
    const size_t corners = 3u * (size_t)s->t.n_triangles;
    s->n = 0;
    for (size_t i = 0; i < corners; i++) {
        const uint32_t u = s->t.triangles[i], v = s->t.triangles[i - i % 3u + (i + 1u) % 3u];
        if (u != SMR_NONE && u < v) /* the triangle beside has it the other way */
            push(s, u, v);
    }
}

/* Collapses what the heap has. Returns how many edges did. */
static uint32_t empty_heap(thinning *s, uint32_t most)
{
    uint32_t ring[HOST_RING_MOST], done = 0, n = 0, i = 0;
    double at[3];
    while (s->n > 0 && s->t.left > most) {
        const candidate c = s->heap[0];
        s->heap[0] = s->heap[--s->n];
        sink(s->heap, s->n, 0);
        if (is_stale(s, &c))
            continue;
        (void)host_collapse_place(&s->t, c.a, c.b, at);
        if (!host_collapse_may(&s->t, c.a, c.b, at))
            continue;
        host_collapse_do(&s->t, c.a, c.b, at);
        s->moved[c.a]++;
        done++;
        n = host_thinned_ring(&s->t, c.a, ring);
        for (i = 0; i < n; i++)
            push(s, c.a, ring[i]);
    }
    return done;
}

/* What is left, in the order of before. */
static void take_left(const thinning *s, host_mesh *mesh)
{
    uint32_t *const number = s->moved; /* not needed any more */
    uint32_t n = 0;
    size_t at = 0;
    for (uint32_t v = 0; v < s->t.n_vertices; v++)
        if (s->t.first[v] != SMR_NONE) {
            for (int c = 0; c < 3; c++)
                mesh->xyz[3u * (size_t)n + (size_t)c] = (float)(s->t.xyz[3u * (size_t)v + (size_t)c] + s->t.centre[c]);
            number[v] = n++;
        }
    for (size_t i = 0; i < 3u * (size_t)s->t.n_triangles; i++)
        if (s->t.triangles[i] != SMR_NONE)
            mesh->triangles[at++] = number[s->t.triangles[i]];
    mesh->n_vertices = n;
    mesh->n_triangles = (uint32_t)(at / 3u);
}

int host_surface_thin(host_mesh *mesh, uint32_t most)
{
    thinning s = {0};
    int result = 0;
    if (mesh->n_triangles <= most)
        return 0;
    s.room = 3u * (size_t)mesh->n_triangles + HOST_RING_MOST;
    s.heap = malloc(s.room * sizeof *s.heap);
    s.moved = calloc((size_t)mesh->n_vertices + 1u, sizeof *s.moved);
    if (host_thinned_make(mesh, &s.t) != 0 || s.heap == NULL || s.moved == NULL)
        result = -1;
    /* What was refused may go once its surroundings have changed. */
    while (result == 0 && s.t.left > most) {
        push_all(&s);
        if (empty_heap(&s, most) == 0)
            break;
    }
    if (result == 0)
        take_left(&s, mesh);
    host_thinned_free(&s.t);
    free(s.heap);
    free(s.moved);
    return result;
}
