/* surface_build.c: builds a target surface in the caller's memory (a copy in tree order, normals, areas, border edges,
 * box tree), and refits a surface to new positions. Both are lists of stages. A stage is a loop over vertices,
 * triangles or nodes that can stop after any item without a change of the result.
 * Bounds: SMR_SURFACE_ITEMS items between two readings of the clock; for each edge the triangles at a vertex.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "base/bytes.h"
#include "geometry/surface/surface.h"

#define SMR_SURFACE_ITEMS 256u /* cost of a unit of work, in items of cost 1 */
#define SMR_SURFACE_EDGES 4u   /* cost, in items, of counting the triangles of a triangle's edges */
#define SMR_SURFACE_RING 8u    /* cost, in items, of visiting the triangles around a vertex */
#define SMR_SURFACE_LEAF 16u   /* cost, in items, of a leaf of the tree */
#define SMR_SURFACE_NODE 32u   /* cost, in items, of a node above the leaves */

static smr_surface *layout(smr_arena *a, uint32_t nv, uint32_t nt, smr_surface *s)
{
    smr_surface *self = smr_arena_take(a, 1, sizeof *self);
    const size_t corners = 3u * (size_t)nt;
    s->xyz = smr_arena_take(a, nv, 3u * sizeof(float));
    s->normal = smr_arena_take(a, nv, 3u * sizeof(float));
    s->area = smr_arena_take(a, nv, sizeof(float));
    s->triangle = smr_arena_take(a, nt, 3u * sizeof(uint32_t));
    s->original = smr_arena_take(a, nt, sizeof(uint32_t));
    s->border = smr_arena_take(a, nt, 1);
    s->tree.normal = smr_arena_take(a, nt, 3u * sizeof(float));
    s->tree.node = smr_arena_take(a, smr_tree_nodes(nt), sizeof(smr_node));
    s->work.middle = smr_arena_take(a, corners > 5u * (size_t)nv ? corners : 5u * (size_t)nv, sizeof(float));
    s->work.key = smr_arena_take(a, nt, sizeof(uint32_t));
    s->work.tmp = smr_arena_take(a, nt, 2u * sizeof(uint32_t));
    s->work.start = smr_arena_take(a, (size_t)nv + 1u, sizeof(uint32_t));
    s->work.around = smr_arena_take(a, nt, 3u * sizeof(uint32_t)); /* triangles at vertices; before: counts */
    s->work.body = (unsigned char *)s->work.around;
    return self;
}

_Static_assert(3u * SMR_SORT_SMALL >= SMR_SORT_BYTES, "a sort's counts lie over triangles around vertices");

smr_status smr_surface_bytes(uint32_t n_vertices, uint32_t n_triangles, size_t *bytes)
{
    if (bytes == NULL)
        return SMR_E_NULL;
    if (n_vertices == 0u || n_vertices > SMR_VERTICES_MAX || n_triangles == 0u || n_triangles > SMR_TRIANGLES_MAX)
        return SMR_E_INPUT;
    smr_arena a = smr_arena_measure();
    smr_surface s;
    (void)layout(&a, n_vertices, n_triangles, &s);
    *bytes = a.used;
    return a.used == SIZE_MAX ? SMR_E_INPUT : SMR_OK;
}

/* Returns the number of triangles with the edge v-w, at most 2, searched at the vertex with fewer triangles. */
static uint32_t edge_count(const smr_surface *s, uint32_t v, uint32_t w)
{
    const uint32_t *const start = s->work.start;
    const int fewer = start[w + 1u] - start[w] < start[v + 1u] - start[v];
    const uint32_t one = fewer ? w : v, other = fewer ? v : w;
    uint32_t count = 0;
    for (uint32_t i = start[one]; i < start[one + 1u] && count < 2u; i++) {
        const uint32_t *t = s->triangle + 3u * (size_t)s->work.around[i];
        count += t[0] == other || t[1] == other || t[2] == other;
    }
    return count;
}

/* ---- The stages ---- */

static void check_vertices(smr_surface *s, uint32_t first, uint32_t last)
{
    smr_box *const box = &s->work.box;
    for (uint32_t i = first; i < last; i++) {
        const smr_vec p = smr_get3(s->work.mesh.xyz, i);
        s->work.refused |= !smr_within3(p, SMR_COORD_MAX);
        if (i == 0u)
            box->lo = box->hi = p;
        smr_box_grow(box, p);
    }
}

static void check_triangles(smr_surface *s, uint32_t first, uint32_t last)
{
    for (size_t i = 3u * (size_t)first; i < 3u * (size_t)last; i++)
        s->work.refused |= s->work.mesh.triangles[i] >= s->n_vertices;
}

/* Copies positions relative to the origin; clears normals and areas, and the relief, which only a build measures. */
static void copy_vertices(smr_surface *s, uint32_t first, uint32_t last)
{
    s->changes += first == 0u ? s->work.refit : 0u;
    s->relief = NULL;
    s->origin = smr_whole(smr_scale(smr_add(s->work.box.lo, s->work.box.hi), 0.5f));
    for (uint32_t i = first; i < last; i++) {
        smr_put3(s->xyz, i, smr_sub(smr_get3(s->work.mesh.xyz, i), s->origin));
        smr_put3(s->normal, i, smr_v(0, 0, 0));
        s->area[i] = 0.0f;
    }
}

static void find_centres(smr_surface *s, uint32_t first, uint32_t last)
{
    smr_surface_work *const w = &s->work;
    smr_mesh_centres(&w->mesh, w->middle, s->original, first, last);
    if (last == s->tree.n_triangles)
        smr_order_start(&w->order, last, w->middle, s->original, w->key, w->tmp, w->around);
}

/* Continues the sort of the triangles into tree order. The stage's one item stays open until the sort is complete. */
static void find_order(smr_surface *s, uint32_t first, uint32_t last)
{
    s->work.at = smr_order_step(&s->work.order, SMR_SURFACE_ITEMS) ? last : first;
}

static void copy_triangles(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++)
        memcpy(s->triangle + 3u * (size_t)k, s->work.mesh.triangles + 3u * (size_t)s->original[k],
               3u * sizeof *s->triangle);
}

static void add_normals(smr_surface *s, uint32_t first, uint32_t last)
{
    smr_mesh_add_normals(s->xyz, s->triangle, s->n_vertices, first, last, s->normal, s->area);
}

/* Scales the vertex normals to unit length, and adds the vertices' areas to work.area. */
static void unit_normals(smr_surface *s, uint32_t first, uint32_t last)
{
    if (first == 0u)
        s->work.area = 0.0f;
    for (uint32_t i = first; i < last; i++) {
        smr_put3(s->normal, i, smr_unit(smr_get3(s->normal, i)));
        s->work.area += s->area[i];
    }
}

/* Clears work.start. First of four stages that list the triangles around each vertex: clear, count, sum, list. */
static void clear_counts(smr_surface *s, uint32_t first, uint32_t last)
{
    memset(s->work.start + first, 0, (last + 1u - first) * sizeof *s->work.start);
}

static void count_corners(smr_surface *s, uint32_t first, uint32_t last)
{
    for (size_t i = 3u * (size_t)first; i < 3u * (size_t)last; i++)
        s->work.start[s->triangle[i]]++;
}

static void sum_counts(smr_surface *s, uint32_t first, uint32_t last)
{
    uint32_t *const start = s->work.start;
    for (uint32_t v = first; v < last; v++) {
        s->n_used += start[v] > 0u;
        start[v] += v > 0u ? start[v - 1u] : 0u;
    }
    start[last] += last == s->n_vertices ? start[last - 1u] : 0u;
}

static void list_triangles(smr_surface *s, uint32_t first, uint32_t last)
{
    const uint32_t nt = s->tree.n_triangles;
    for (size_t i = 3u * (size_t)(nt - first); i-- > 3u * (size_t)(nt - last);)
        s->work.around[--s->work.start[s->triangle[i]]] = (uint32_t)(i / 3u);
}

/* Sets bits 0 .. 2 of border[]: edges that one triangle has. Two later stages set the bits of corners on such edges. */
static void find_borders(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        const uint32_t *t = s->triangle + 3u * (size_t)k;
        s->border[k] = 0;
        for (uint32_t e = 0; e < 3u; e++)
            if (edge_count(s, t[e], t[(e + 1u) % 3u]) == 1u)
                s->border[k] |= (unsigned char)(1u << e);
    }
}

static void mark_borders(smr_surface *s, uint32_t first, uint32_t last)
{
    uint32_t *const flag = s->work.start;
    for (uint32_t k = first; k < last; k++)
        for (uint32_t e = 0; e < 3u; e++)
            if ((uint32_t)s->border[k] >> e & 1u)
                flag[s->triangle[3u * (size_t)k + e]] = flag[s->triangle[3u * (size_t)k + (e + 1u) % 3u]] = 1u;
}

static void find_corners(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++)
        for (uint32_t c = 0; c < 3u; c++)
            if (s->work.start[s->triangle[3u * (size_t)k + c]])
                s->border[k] |= (unsigned char)(8u << c);
}

/* Makes point i of a cloud's copy the three corners of triangle i, which has no area. */
static void index_points(smr_surface *s, uint32_t first, uint32_t last)
{
    for (size_t i = 3u * (size_t)first; i < 3u * (size_t)last; i++)
        s->work.index[i] = (uint32_t)(i / 3u);
}

/* Copies the cloud's normals and weights. Refuses a cloud that has changed since the build began. */
static void copy_cloud(smr_surface *s, uint32_t first, uint32_t last)
{
    const smr_surface *cloud = s->work.cloud;
    const size_t at = first, n = last - first;
    s->work.refused = cloud->changes != s->work.changes;
    if (s->work.refused)
        return;
    memcpy(s->normal + 3u * at, cloud->normal + 3u * at, 3u * n * sizeof(float));
    memcpy(s->area + at, cloud->area + at, n * sizeof(float));
    memset(s->border + at, 0, n);
    for (size_t k = at; k < last; k++)
        memcpy(s->tree.normal + 3u * k, cloud->normal + 3u * (size_t)s->original[k], 3u * sizeof(float));
}

static void fit_leaves(smr_surface *s, uint32_t first, uint32_t last) { smr_tree_refit_leaves(&s->tree, first, last); }

static void fit_nodes(smr_surface *s, uint32_t first, uint32_t last)
{
    const uint32_t leaves = smr_tree_leaves(&s->tree);
    smr_tree_refit_nodes(&s->tree, leaves + first, leaves + last);
}

/* ---- The list of stages ---- */

enum { OF_VERTICES = 0, OF_TRIANGLES, OF_LEAVES, OF_NODES, OF_ONE };

static const struct {
    smr_surface_stage *run;
    uint16_t of;   /* OF_...: the items of the stage */
    uint16_t when; /* which work has the stage: 0: builds; 1: builds and refits; 2: copies of clouds */
    uint32_t cost; /* cost of an item of the stage; a unit of work costs SMR_SURFACE_ITEMS */
} stages[] = {
    {index_points, OF_TRIANGLES, 2, 1},
    {check_vertices, OF_VERTICES, 1, 1},
    {check_triangles, OF_TRIANGLES, 0, 1},
    {copy_vertices, OF_VERTICES, 1, 1},
    {find_centres, OF_TRIANGLES, 0, 1},
    {find_order, OF_ONE, 0, SMR_SURFACE_ITEMS},
    {copy_triangles, OF_TRIANGLES, 0, 1},
    {add_normals, OF_TRIANGLES, 1, 2},
    {unit_normals, OF_VERTICES, 1, 1},
    {clear_counts, OF_VERTICES, 0, 1},
    {count_corners, OF_TRIANGLES, 0, 1},
    {sum_counts, OF_VERTICES, 0, 1},
    {list_triangles, OF_TRIANGLES, 0, 1},
    {smr_offsets_find, OF_VERTICES, 0, SMR_SURFACE_RING},
    {smr_offsets_compare, OF_VERTICES, 0, SMR_SURFACE_RING},
    {smr_bulges_smooth, OF_VERTICES, 0, SMR_SURFACE_RING}, /* comes back for each pass */
    {smr_bulges_slope, OF_VERTICES, 0, SMR_SURFACE_RING},
    {find_borders, OF_TRIANGLES, 0, SMR_SURFACE_EDGES},
    {clear_counts, OF_VERTICES, 0, 1},
    {mark_borders, OF_TRIANGLES, 0, 1},
    {find_corners, OF_TRIANGLES, 0, 1},
    {smr_fragments_forget, OF_VERTICES, 0, 1},
    {smr_fragments_join, OF_TRIANGLES, 0, 2},
    {smr_fragments_sum, OF_TRIANGLES, 0, 1},
    {smr_bodies_number, OF_TRIANGLES, 0, 1},
    {smr_fragments_mark, OF_TRIANGLES, 0, 1},
    {smr_fragments_release, OF_VERTICES, 1, 1},
    {smr_bulges_mean, OF_VERTICES, 0, 1},
    {smr_bulges_size, OF_VERTICES, 0, 1},
    {smr_relief_set, OF_VERTICES, 0, 1},
    {fit_leaves, OF_LEAVES, 1, SMR_SURFACE_LEAF},
    {fit_nodes, OF_NODES, 1, SMR_SURFACE_NODE},
    {copy_cloud, OF_TRIANGLES, 2, 1},
};

#define SMR_SURFACE_STAGES ((uint32_t)(sizeof stages / sizeof stages[0]))

static uint32_t items_of(const smr_surface *s, uint32_t stage)
{
    switch (stages[stage].of) {
    case OF_VERTICES: return s->n_vertices;
    case OF_TRIANGLES: return s->tree.n_triangles;
    case OF_LEAVES: return smr_tree_leaves(&s->tree);
    case OF_NODES: return smr_tree_nodes(s->tree.n_triangles) - smr_tree_leaves(&s->tree);
    default: return 1;
    }
}

/* Advances to the next stage that this build or refit needs. */
static void skip_stages(smr_surface_work *w)
{
    for (; w->stage < SMR_SURFACE_STAGES; w->stage++)
        if (stages[w->stage].when == 2u ? w->index != NULL : (!w->refit || stages[w->stage].when == 1u))
            return;
}

/* Does one unit of work. Returns SMR_PARTIAL while work is left. */
static smr_status run_unit(smr_surface *s)
{
    smr_surface_work *const w = &s->work;
    const uint32_t n = items_of(s, w->stage), first = w->at;
    w->at = smr_min_u32(n, first + SMR_SURFACE_ITEMS / stages[w->stage].cost);
    if (first < n)
        stages[w->stage].run(s, first, w->at);
    if (w->refused)
        return SMR_E_INPUT;
    if (w->at < n)
        return SMR_PARTIAL;
    w->at = 0;
    w->stage++;
    skip_stages(w);
    if (w->stage < SMR_SURFACE_STAGES)
        return SMR_PARTIAL;
    s->area_mean = w->index == NULL ? w->area / (float)s->n_used : 1.0f;
    s->capacity = w->index == NULL ? 0u : s->n_vertices;
    s->open |= w->index != NULL;
    s->magic = SMR_SURFACE_MAGIC;
    return SMR_OK;
}

smr_status smr_surface_step(smr_surface *surface, uint32_t units, const smr_port *port, uint64_t budget_ns)
{
    if (surface == NULL)
        return SMR_E_NULL;
    if (surface->magic != SMR_SURFACE_BUSY && surface->magic != SMR_SURFACE_MAGIC)
        return SMR_E_STATE;
    if (surface->work.stage >= SMR_SURFACE_STAGES)
        return SMR_OK;
    skip_stages(&surface->work);
    const int timed = budget_ns > 0u && port != NULL && port->now_ns != NULL;
    const uint64_t begin = timed ? port->now_ns(port->ctx) : 0u;
    for (uint32_t done = 1;; done++) {
        const smr_status status = run_unit(surface);
        if (status < 0) { /* a refused build leaves nothing, a refused refit leaves the old surface */
            surface->work.stage = SMR_SURFACE_STAGES;
            surface->magic = surface->work.refit ? SMR_SURFACE_MAGIC : 0u;
        }
        if (status != SMR_PARTIAL)
            return status;
        if ((units > 0u && done >= units) || (timed && port->now_ns(port->ctx) - begin >= budget_ns))
            return SMR_PARTIAL;
    }
}

smr_status smr_surface_begin(const smr_mesh *mesh, void *memory, size_t bytes, smr_surface **surface)
{
    smr_arena a;
    smr_surface s = {.magic = SMR_SURFACE_BUSY};
    size_t needed;
    if (surface == NULL || mesh == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_arena_start(&a, memory, bytes));
    const uint32_t nv = mesh->n_vertices, nt = mesh->n_triangles;
    if (mesh->xyz == NULL || (mesh->triangles == NULL && nt > 0u))
        return SMR_E_NULL;
    if (smr_surface_bytes(nv, nt, &needed) != SMR_OK)
        return SMR_E_INPUT;
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(memory, bytes);
    smr_surface *const self = layout(&a, nv, nt, &s);
    s.n_vertices = nv;
    s.work.mesh = *mesh;
    smr_tree_shape(&s.tree, nt);
    s.tree.xyz = s.xyz;
    s.tree.triangle = s.triangle;
    s.tree.n_vertices = nv;
    s.tree.rank = s.original;
    *self = s;
    *surface = self;
    return SMR_OK;
}

uint32_t smr_surface_guard(const smr_surface *s)
{
    const void *const scratch[2] = {s->work.start, s->work.body};
    return smr_byte_sum(smr_byte_sum(0, s, offsetof(smr_surface, work)), scratch, sizeof scratch);
}

smr_status smr_surface_refit(smr_surface *surface, const float *xyz)
{
    if (surface == NULL || xyz == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(surface) || smr_is_cloud(surface))
        return SMR_E_STATE;
    surface->magic = SMR_SURFACE_BUSY;
    surface->work.stage = surface->work.at = surface->work.refused = 0;
    surface->work.refit = 1;
    surface->work.mesh.xyz = xyz;
    return SMR_OK;
}

smr_status smr_surface_build(const smr_mesh *mesh, void *memory, size_t bytes, smr_surface **surface)
{
    smr_arena a;
    smr_surface *s;
    if (surface == NULL || mesh == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_arena_start(&a, memory, bytes));
    SMR_TRY(smr_mesh_check(mesh)); /* a refused mesh leaves the memory unchanged */
    SMR_TRY(smr_surface_begin(mesh, memory, bytes, &s));
    SMR_TRY(smr_surface_step(s, 0, NULL, 0));
    *surface = s;
    return SMR_OK;
}
