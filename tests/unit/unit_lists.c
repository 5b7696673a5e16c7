/* unit_lists.c: cluster lists read from a model.
 * SPDX-License-Identifier: MIT */
#include "unit_lists.h"
#include <math.h>
#include <string.h>

typedef struct walk {
    smr_lists l;
    uint32_t block, entry, last, at; /* at: in the index list */
} walk;

typedef struct step {
    uint32_t vertex, parent_vertex, root, n_plus, n_minus, at, first;
} step;

uint32_t unit_list_index(const smr_lists *l, size_t i)
{
    return l->index_bytes == 2u ? smr_le16(((const uint16_t *)l->index)[i]) : smr_le32(((const uint32_t *)l->index)[i]);
}

smr_entry32 unit_list_entry(const smr_lists *l, uint32_t i)
{
    if (l->index_bytes == 4u) {
        const smr_entry32 *e = (const smr_entry32 *)l->entry + i;
        return (smr_entry32){smr_le32(e->vertex), smr_le32(e->parent), smr_le32(e->n_plus), smr_le32(e->n_minus)};
    }
    const smr_entry16 *e = (const smr_entry16 *)l->entry + i;
    return (smr_entry32){smr_le16(e->vertex), smr_le16(e->parent), smr_le16(e->n_plus), smr_le16(e->n_minus)};
}

static walk walk_start(const smr_model *m, uint32_t radius)
{
    walk w = {smr_model_lists(m, radius), UINT32_MAX, 0, 0, 0};
    return w;
}

static int walk_next(walk *w, step *s)
{
    while (w->entry == w->last) {
        if (++w->block == w->l.n_blocks)
            return 0;
        w->entry = smr_le32(w->l.block[w->block].first);
        w->last = smr_le32(w->l.block[w->block + 1u].first);
        w->at = smr_le32(w->l.block[w->block].first_index);
    }
    const uint32_t first = smr_le32(w->l.block[w->block].first);
    const smr_entry32 e = unit_list_entry(&w->l, w->entry);
    s->first = first;
    s->vertex = e.vertex;
    s->root = first + e.parent == w->entry;
    s->parent_vertex = unit_list_entry(&w->l, first + e.parent).vertex;
    s->n_plus = e.n_plus;
    s->n_minus = e.n_minus;
    s->at = w->at;
    w->at += e.n_plus + e.n_minus;
    w->entry++;
    return 1;
}

uint32_t *unit_records(oracle_random *r, uint32_t n)
{
    uint32_t *record = rig_rough(4u * (size_t)n);
    for (uint32_t i = 0; i < n; i++)
        record[i] = oracle_next(r);
    return record;
}

void unit_chain_sums(const smr_model *m, uint32_t radius, const uint32_t *record, uint32_t *sum)
{
    walk w = walk_start(m, radius);
    step s;
    while (walk_next(&w, &s)) {
        uint32_t acc = s.root ? 0u : sum[s.parent_vertex];
        for (uint32_t i = 0; i < s.n_plus; i++)
            acc += record[unit_list_index(&w.l, s.at + i)];
        for (uint32_t i = 0; i < s.n_minus; i++)
            acc -= record[unit_list_index(&w.l, s.at + s.n_plus + i)];
        sum[s.vertex] = acc;
    }
}

int unit_chain_sets(const smr_model *m, uint32_t radius, unsigned char *member)
{
    const uint32_t n = smr_le32(m->n_vertices);
    walk w = walk_start(m, radius);
    step s;
    unsigned char *done = rig_rough(n);
    int good = 1;
    memset(done, 0, n);
    memset(member, 0, (size_t)n * n);
    while (walk_next(&w, &s)) {
        unsigned char *own = member + (size_t)s.vertex * n;
        good &= !done[s.vertex] && (s.root || done[s.parent_vertex]);
        if (!s.root)
            memcpy(own, member + (size_t)s.parent_vertex * n, n);
        for (uint32_t i = 0; i < s.n_plus + s.n_minus; i++) {
            const uint32_t k = unit_list_index(&w.l, s.at + i);
            good &= i == 0u || i == s.n_plus || unit_list_index(&w.l, s.at + i - 1u) < k;
            good &= own[k] == (i >= s.n_plus);
            own[k] = i < s.n_plus;
        }
        done[s.vertex] = 1;
        uint32_t count = 0;
        for (uint32_t k = 0; k < n; k++)
            count += own[k];
        good &= count == smr_list_count(&w.l, s.vertex);
    }
    for (uint32_t v = 0; v < n; v++)
        good &= done[v];
    rig_free(done);
    return good;
}

/* The vertices in stored order, relative to the centre. */
static float *stored(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices);
    const uint32_t *rest = smr_at(m, m->at_rest);
    float *xyz = rig_rough(12u * (size_t)n);
    for (uint32_t i = 0; i < 3u * n; i++)
        xyz[i] = smr_le_float(rest[i]);
    return xyz;
}

static float distance2(const float *a, const float *b)
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/* Shortest paths in whole micrometres over the edges, by repeated relaxation (Bellman, Ford). */
static void geodesic_sets(const smr_model *m, const float *xyz, float radius, unsigned char *member)
{
    const uint32_t n = smr_le32(m->n_vertices), nt = smr_le32(m->n_triangles);
    const uint32_t *t = smr_at(m, m->at_triangles);
    uint64_t *far = rig_rough(8u * (size_t)n);
    const uint64_t limit = (uint64_t)(radius * 1000.0f);
    for (uint32_t v = 0; v < n; v++) {
        for (uint32_t i = 0; i < n; i++)
            far[i] = i == v ? 0u : UINT64_MAX / 2u;
        for (int again = 1; again;) {
            again = 0;
            for (uint32_t i = 0; i < 3u * nt; i++) {
                const uint32_t a = smr_le32(t[i]), b = smr_le32(t[i / 3u * 3u + (i % 3u + 1u) % 3u]);
                const float mm = sqrtf(distance2(xyz + 3u * (size_t)a, xyz + 3u * (size_t)b));
                const uint64_t length = (uint64_t)(mm * 1000.0f + 0.5f);
                if (far[a] + length < far[b])
                    far[b] = far[a] + length, again = 1;
                if (far[b] + length < far[a])
                    far[a] = far[b] + length, again = 1;
            }
        }
        for (uint32_t i = 0; i < n; i++)
            member[(size_t)v * n + i] = far[i] <= limit;
    }
    rig_free(far);
}

/* 1 when separate clusters never join two stored vertices: they are of different structures, both with triangles. */
static int kept_apart(const smr_model *m, uint32_t a, uint32_t b)
{
    const uint32_t i = smr_model_owner(m, a), k = smr_model_owner(m, b);
    return i != k && smr_le32(smr_model_record(m, i)->n_triangles) > 0u &&
           smr_le32(smr_model_record(m, k)->n_triangles) > 0u;
}

void unit_brute_sets(const smr_model *m, const unit_rule *rule, unsigned char *member)
{
    const uint32_t n = smr_le32(m->n_vertices), nt = smr_le32(m->n_triangles);
    const uint32_t *t = smr_at(m, m->at_triangles);
    float *xyz = stored(m);
    if (rule->geodesic) {
        geodesic_sets(m, xyz, rule->radius, member);
    } else {
        for (uint32_t a = 0; a < n; a++)
            for (uint32_t b = 0; b < n; b++)
                member[(size_t)a * n + b] =
                    distance2(xyz + 3u * (size_t)a, xyz + 3u * (size_t)b) <= rule->radius * rule->radius;
    }
    for (uint32_t a = 0; rule->separate && a < n; a++)
        for (uint32_t b = 0; b < n; b++)
            if (kept_apart(m, a, b))
                member[(size_t)a * n + b] = 0;
    for (uint32_t i = 0; rule->ring && i < 3u * nt; i++) {
        const uint32_t a = smr_le32(t[i]), b = smr_le32(t[i / 3u * 3u + (i % 3u + 1u) % 3u]);
        member[(size_t)a * n + b] = member[(size_t)b * n + a] = 1;
    }
    rig_free(xyz);
}
