/* surface.c: builds a target surface in the caller's memory (a copy in tree order, normals, areas, border edges, box
 * tree) and finds closest points on it.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface.h"

#include "base/arena.h"
#include "geometry/hilbert_curve.h"
#include "geometry/mesh.h"

/* The surface's slots that smr_surface itself does not point to, and scratch. */
typedef struct build {
    smr_surface *s;
    float *facet_normal; /* [n_triangles][3] */
    smr_node *node;      /* [smr_tree_nodes(n_triangles)] */
    /* used while building only */
    float *middle;    /* [n_triangles][3] centres of triangles */
    uint32_t *key;    /* [n_triangles] sort keys */
    uint32_t *tmp;    /* [2 n_triangles] */
    uint32_t *start;  /* [n_vertices + 1] triangles around vertices, smr_mesh_around() */
    uint32_t *around; /* [3 n_triangles] */
} build;

/* Takes all slots from the arena, or measures them. */
static void layout(smr_arena *a, uint32_t nv, uint32_t nt, build *b, smr_surface *s)
{
    b->s = smr_arena_take(a, 1, sizeof *b->s);
    s->xyz = smr_arena_take(a, nv, 3 * sizeof(float));
    s->normal = smr_arena_take(a, nv, 3 * sizeof(float));
    s->area = smr_arena_take(a, nv, sizeof(float));
    s->triangle = smr_arena_take(a, nt, 3 * sizeof(uint32_t));
    s->original = smr_arena_take(a, nt, sizeof(uint32_t));
    s->border = smr_arena_take(a, nt, 1);
    b->facet_normal = smr_arena_take(a, nt, 3 * sizeof(float));
    b->node = smr_arena_take(a, smr_tree_nodes(nt), sizeof(smr_node));
    b->middle = smr_arena_take(a, nt, 3 * sizeof(float));
    b->key = smr_arena_take(a, nt, sizeof(uint32_t));
    b->tmp = smr_arena_take(a, nt, 2 * sizeof(uint32_t));
    b->start = smr_arena_take(a, (size_t)nv + 1u, sizeof(uint32_t));
    b->around = smr_arena_take(a, nt, 3 * sizeof(uint32_t));
}

smr_status smr_surface_bytes(uint32_t n_vertices, uint32_t n_triangles, size_t *bytes)
{
    if (bytes == NULL)
        return SMR_E_NULL;
    if (n_vertices == 0u || n_vertices > SMR_VERTICES_MAX || n_triangles == 0u || n_triangles > SMR_TRIANGLES_MAX)
        return SMR_E_INPUT;
    smr_arena a = smr_arena_measure();
    build b;
    smr_surface s;
    layout(&a, n_vertices, n_triangles, &b, &s);
    if (a.used == SIZE_MAX)
        return SMR_E_INPUT;
    *bytes = a.used;
    return SMR_OK;
}

/* Number of triangles with the edge v-w, at most 2. Searches the triangles around the vertex that has fewer. */
static uint32_t edge_count(const smr_surface *s, const build *b, uint32_t v, uint32_t w)
{
    uint32_t count = 0;
    if (b->start[w + 1u] - b->start[w] < b->start[v + 1u] - b->start[v]) {
        uint32_t swap = v;
        v = w;
        w = swap;
    }
    for (uint32_t i = b->start[v]; i < b->start[v + 1u] && count < 2u; i++) {
        const uint32_t *t = s->triangle + 3u * (size_t)b->around[i];
        count += t[0] == w || t[1] == w || t[2] == w;
    }
    return count;
}

/* Sets s->border and s->open: first border edges, then the corners on them. Overwrites b->start with a flag a
 * vertex. */
static void find_borders(smr_surface *s, const build *b, uint32_t nt)
{
    s->open = 0;
    for (uint32_t k = 0; k < nt; k++) {
        const uint32_t *t = s->triangle + 3u * (size_t)k;
        s->border[k] = 0;
        for (uint32_t e = 0; e < 3u; e++)
            if (edge_count(s, b, t[e], t[(e + 1u) % 3u]) == 1u)
                s->border[k] |= (unsigned char)(1u << e);
        s->open |= s->border[k] != 0;
    }
    for (uint32_t v = 0; v < s->n_vertices; v++)
        b->start[v] = 0;
    for (uint32_t k = 0; k < nt; k++)
        for (uint32_t e = 0; e < 3u; e++)
            if ((uint32_t)s->border[k] >> e & 1u)
                b->start[s->triangle[3u * (size_t)k + e]] = b->start[s->triangle[3u * (size_t)k + (e + 1u) % 3u]] = 1u;
    for (uint32_t k = 0; k < nt; k++)
        for (uint32_t c = 0; c < 3u; c++)
            if (b->start[s->triangle[3u * (size_t)k + c]])
                s->border[k] |= (unsigned char)(8u << c);
}

/* Copies the mesh: vertices relative to the origin, triangles in tree order. */
static void copy_mesh(smr_surface *s, const build *b, const smr_mesh *mesh)
{
    const smr_box box = smr_box_of(mesh->xyz, mesh->n_vertices);
    s->origin = smr_whole(smr_scale(smr_add(box.lo, box.hi), 0.5f));
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        smr_store(s->xyz + 3u * (size_t)i, smr_sub(smr_load(mesh->xyz + 3u * (size_t)i), s->origin));
    smr_mesh_order(mesh, s->original, b->middle, b->key, b->tmp);
    for (uint32_t k = 0; k < mesh->n_triangles; k++)
        memcpy(s->triangle + 3u * (size_t)k, mesh->triangles + 3u * (size_t)s->original[k], 3u * sizeof(uint32_t));
}

/* Builds the box tree over the copied triangles. */
static void build_tree(smr_surface *s, const build *b, uint32_t n_triangles)
{
    smr_tree_shape(&s->facets, n_triangles);
    s->facets.xyz = s->xyz;
    s->facets.triangle = s->triangle;
    s->facets.rank = s->original;
    s->facets.normal = b->facet_normal;
    s->facets.node = b->node;
    smr_tree_refit_leaves(&s->facets, 0, smr_tree_leaves(&s->facets));
    smr_tree_refit_upper(&s->facets);
}

/* The mean area around a vertex; those without triangles attract nothing and do not count. */
static float mean_area(const smr_surface *s, const build *b)
{
    float total = 0.0f;
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        total += s->area[i];
        n += b->start[i + 1u] > b->start[i];
    }
    return total / (float)n;
}

smr_status smr_surface_build(const smr_mesh *mesh, void *memory, size_t bytes, smr_surface **surface)
{
    smr_arena a;
    smr_surface s = {0};
    build b;
    size_t needed;
    if (surface == NULL || mesh == NULL)
        return SMR_E_NULL;
    smr_status status = smr_arena_start(&a, memory, bytes);
    if (status != SMR_OK)
        return status;
    status = smr_mesh_check(mesh);
    if (status != SMR_OK)
        return status;
    const uint32_t nv = mesh->n_vertices, nt = mesh->n_triangles;
    if (nt == 0u || smr_surface_bytes(nv, nt, &needed) != SMR_OK)
        return SMR_E_INPUT;
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(memory, bytes);
    layout(&a, nv, nt, &b, &s);
    s.magic = SMR_SURFACE_MAGIC;
    s.n_vertices = nv;
    copy_mesh(&s, &b, mesh);
    const smr_mesh own = {s.xyz, s.triangle, nv, nt};
    smr_mesh_normals(&own, s.normal, s.area);
    smr_mesh_around(&own, b.start, b.around);
    s.area_mean = mean_area(&s, &b);
    find_borders(&s, &b, nt);
    build_tree(&s, &b, nt);
    *b.s = s;
    *surface = b.s;
    return SMR_OK;
}

uint32_t smr_surface_on_border(const smr_surface *s, uint32_t triangle, const float weight[3])
{
    const uint32_t bits = s->border[triangle];
    for (uint32_t c = 0; c < 3u; c++) {
        uint32_t next = (c + 1u) % 3u, opposite = (c + 2u) % 3u;
        if (weight[next] == 0.0f && weight[opposite] == 0.0f && (bits >> (3u + c) & 1u))
            return 1u;
        if (weight[opposite] == 0.0f && (bits >> c & 1u))
            return 1u;
    }
    return 0u;
}

smr_status smr_surface_closest(const smr_surface *surface, const float *point, const float *normal, float min_cos,
                               float max_mm, smr_closest *hit)
{
    if (surface == NULL || point == NULL || hit == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(surface))
        return SMR_E_STATE;
    for (uint32_t i = 0; i < 3u; i++)
        if (!smr_within(point[i], SMR_COORD_MAX) || (normal != NULL && !smr_within(normal[i], 2.0f)))
            return SMR_E_INPUT;
    if (!(max_mm >= 0.0f) || (normal != NULL && !smr_within(min_cos, 2.0f)))
        return SMR_E_INPUT;
    max_mm = smr_min(max_mm, 8.0f * SMR_COORD_MAX);
    smr_query q = {smr_sub(smr_load(point), surface->origin), smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
    if (normal != NULL) {
        q.normal = smr_load(normal);
        q.min_cos = min_cos;
    }
    smr_hit h = {max_mm * max_mm, SMR_NONE, {0, 0, 0}};
    smr_tree_closest(&surface->facets, &q, &h);
    memset(hit, 0, sizeof *hit);
    hit->triangle = SMR_NONE;
    if (h.triangle == SMR_NONE)
        return SMR_OK;
    smr_store(hit->point, smr_add(smr_facet_point(&surface->facets, h.triangle, h.weight), surface->origin));
    memcpy(hit->normal, surface->facets.normal + 3u * (size_t)h.triangle, sizeof hit->normal);
    memcpy(hit->weight, h.weight, sizeof hit->weight);
    hit->distance = SMR_SQRT(h.d2);
    hit->triangle = surface->original[h.triangle];
    hit->on_border = smr_surface_on_border(surface, h.triangle, h.weight);
    return SMR_OK;
}
