/* curve_numbering.c: puts the model into stored order: vertices along a Hilbert curve through the whole model, triangles in the
 * order of their structure's box tree; mesh neighbours and edge lengths.
 * SPDX-License-Identifier: MIT */
#include "geometry/hilbert_curve.h"
#include "geometry/mesh.h"
#include "prepare/plan.h"

static const float *callers_vertex(const smr_plan *p, uint32_t structure, uint32_t i)
{
    return p->structures[structure].mesh.xyz + 3u * (size_t)i;
}

static smr_box whole_box(const smr_plan *p)
{
    smr_box box = smr_box_of(p->structures[0].mesh.xyz, p->structures[0].mesh.n_vertices);
    for (uint32_t s = 1; s < p->n_structures; s++) {
        smr_box b = smr_box_of(p->structures[s].mesh.xyz, p->structures[s].mesh.n_vertices);
        box.lo = smr_v(smr_min(box.lo.x, b.lo.x), smr_min(box.lo.y, b.lo.y), smr_min(box.lo.z, b.lo.z));
        box.hi = smr_v(smr_max(box.hi.x, b.hi.x), smr_max(box.hi.y, b.hi.y), smr_max(box.hi.z, b.hi.z));
    }
    return box;
}

static void order_vertices(smr_plan *p)
{
    const smr_box box = whole_box(p);
    smr_store(p->centre, smr_whole(smr_scale(smr_add(box.lo, box.hi), 0.5f)));
    uint32_t k = 0;
    for (uint32_t s = 0; s < p->n_structures; s++) {
        for (uint32_t i = 0; i < p->structures[s].mesh.n_vertices; i++, k++) {
            p->key[k] = smr_curve_key(box, smr_load(callers_vertex(p, s, i)));
            p->original[k] = k;
        }
    }
    smr_curve_sort(p->key, p->original, p->tmp, p->n);
    for (uint32_t v = 0; v < p->n; v++)
        p->position[p->original[v]] = v;
    k = 0;
    for (uint32_t s = 0; s < p->n_structures; s++) {
        for (uint32_t i = 0; i < p->structures[s].mesh.n_vertices; i++, k++) {
            const uint32_t v = p->position[k];
            const float *from = callers_vertex(p, s, i);
            for (uint32_t c3 = 0; c3 < 3u; c3++)
                p->xyz[3u * (size_t)v + c3] = from[c3] - p->centre[c3];
            p->owner[v] = (uint16_t)s;
        }
    }
}

static void order_triangles(smr_plan *p)
{
    uint32_t first_vertex = 0, first = 0;
    for (uint32_t s = 0; s < p->n_structures; s++) {
        const smr_mesh *mesh = &p->structures[s].mesh;
        smr_mesh_order(mesh, p->facet + first, p->middle, p->key, p->tmp);
        for (uint32_t k = 0; k < mesh->n_triangles; k++)
            for (uint32_t c = 0; c < 3u; c++)
                p->triangle[3u * (size_t)(first + k) + c] =
                    p->position[first_vertex + mesh->triangles[3u * (size_t)p->facet[first + k] + c]];
        first_vertex += mesh->n_vertices;
        first += mesh->n_triangles;
    }
}

/* Distinct mesh neighbours of each vertex, ascending: each triangle offers two per corner; sorted, then thinned. */
static void find_rings(smr_plan *p)
{
    uint32_t *start = p->ring_start;
    memset(start, 0, ((size_t)p->n + 1u) * sizeof *start);
    for (size_t i = 0; i < 3u * (size_t)p->nt; i++)
        start[p->triangle[i]] += 2u;
    for (uint32_t v = 0, sum = 0; v <= p->n; v++) {
        sum += start[v];
        start[v] = sum;
    }
    for (size_t i = 3u * (size_t)p->nt; i-- > 0u;) {
        const uint32_t *t = p->triangle + i / 3u * 3u;
        const uint32_t v = p->triangle[i], corner = (uint32_t)(i % 3u);
        p->ring[--start[v]] = t[(corner + 1u) % 3u];
        p->ring[--start[v]] = t[(corner + 2u) % 3u];
    }
    uint32_t out = 0;
    for (uint32_t v = 0, from = 0; v < p->n; v++) {
        const uint32_t last = start[v + 1u], n = last - from, begin = out;
        for (uint32_t i = 0; i < n; i++)
            p->key[i] = p->item[i] = p->ring[from + i];
        if (n > 24u) {
            smr_curve_sort(p->key, p->item, p->tmp, n);
        } else {
            for (uint32_t i = 1; i < n; i++)
                for (uint32_t j = i; j > 0u && p->key[j - 1u] > p->key[j]; j--) {
                    const uint32_t swap = p->key[j];
                    p->key[j] = p->key[j - 1u];
                    p->key[j - 1u] = swap;
                }
        }
        for (uint32_t i = 0; i < n; i++)
            if (p->key[i] != v && (i == 0u || p->key[i] != p->key[i - 1u]))
                p->ring[out++] = p->key[i];
        from = last;
        start[v] = begin;
    }
    start[p->n] = out;
}

static void measure_edges(smr_plan *p)
{
    float sum = 0.0f;
    p->edge_max = 0.0f;
    for (uint32_t v = 0; v < p->n; v++) {
        for (uint32_t i = p->ring_start[v]; i < p->ring_start[v + 1u]; i++) {
            const float *a = p->xyz + 3u * (size_t)v, *b = p->xyz + 3u * (size_t)p->ring[i];
            const float length = smr_length(smr_sub(smr_load(a), smr_load(b)));
            sum += length;
            p->edge_max = smr_max(p->edge_max, length);
        }
    }
    p->edge_mm = p->ring_start[p->n] > 0u ? sum / (float)p->ring_start[p->n] : 0.0f;
}

/* A box tree whose items are the vertices themselves. */
static void plant_tree(smr_plan *p)
{
    for (uint32_t leaf = 0; leaf < smr_tree_leaves(&p->points); leaf++) {
        smr_node *node = &p->points.node[leaf];
        for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
            const uint32_t v = leaf * SMR_TREE_WIDTH + k;
            for (uint32_t axis = 0; axis < 3u; axis++)
                node->lo[axis][k] = node->hi[axis][k] = v < p->n ? p->xyz[3u * (size_t)v + axis] : SMR_FAR;
        }
    }
    smr_tree_refit_upper(&p->points);
}

void smr_plan_order(smr_plan *p)
{
    order_vertices(p);
    order_triangles(p);
    find_rings(p);
    measure_edges(p);
    plant_tree(p);
    for (uint32_t v = 0; p->geo_distance != NULL && v < p->n; v++)
        p->geo_distance[v] = UINT32_MAX;
}

void smr_plan_mass(smr_plan *p)
{
    float total = 0.0f;
    for (uint32_t v = 0; v < p->n; v++)
        p->mass[v] = 1.0f;
    if (p->config->mass != SMR_MASS_AREA || p->nt == 0u)
        return;
    for (uint32_t v = 0; v < p->n; v++)
        p->mass[v] = 0.0f;
    for (uint32_t k = 0; k < p->nt; k++) {
        const uint32_t *t = p->triangle + 3u * (size_t)k;
        const smr_vec a = smr_load(p->xyz + 3u * (size_t)t[0]);
        const smr_vec ab = smr_sub(smr_load(p->xyz + 3u * (size_t)t[1]), a);
        const smr_vec ac = smr_sub(smr_load(p->xyz + 3u * (size_t)t[2]), a);
        const float third = smr_length(smr_cross(ab, ac)) * (1.0f / 6.0f);
        for (uint32_t c = 0; c < 3u; c++)
            p->mass[t[c]] += third;
        total += 3.0f * third;
    }
    const float unit = total > 0.0f ? SMR_MASS_UNITS * (float)p->n / total : 0.0f;
    for (uint32_t v = 0; v < p->n; v++) {
        const float units = smr_clamp(p->mass[v] * unit + 0.5f, 1.0f, SMR_MASS_MAX * SMR_MASS_UNITS);
        p->mass[v] = (float)(uint32_t)units / SMR_MASS_UNITS;
    }
}
