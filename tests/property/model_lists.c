/* model_lists.c: decodes a radius of a model, and finds its clusters a second time by brute force.
 * SPDX-License-Identifier: MIT */
#include "property/model_lists.h"
#include <stdlib.h>
#include <string.h>
#include "unit/unit_lists.h"

static void decode_chain(const smr_lists *l, rig_lists *out)
{
    const uint32_t n = out->n;
    size_t n_plus = 0, n_minus = 0, total = smr_le32(l->block[l->n_blocks].first_index);
    out->vertex = rig_alloc(n * sizeof(uint32_t));
    out->parent = rig_alloc(n * sizeof(uint32_t));
    out->plus_start = rig_alloc((n + 1u) * sizeof(uint32_t));
    out->minus_start = rig_alloc((n + 1u) * sizeof(uint32_t));
    out->plus = rig_alloc(total * sizeof(uint32_t));
    out->minus = rig_alloc(total * sizeof(uint32_t));
    for (uint32_t b = 0; b < l->n_blocks; b++) {
        const uint32_t first = smr_le32(l->block[b].first), last = smr_le32(l->block[b + 1u].first);
        size_t at = smr_le32(l->block[b].first_index);
        for (uint32_t i = first; i < last; i++) {
            const smr_entry32 e = unit_list_entry(l, i);
            out->vertex[i] = e.vertex;
            out->parent[i] = unit_list_entry(l, first + e.parent).vertex;
            for (uint32_t k = 0; k < e.n_plus; k++)
                out->plus[n_plus++] = unit_list_index(l, at++);
            for (uint32_t k = 0; k < e.n_minus; k++)
                out->minus[n_minus++] = unit_list_index(l, at++);
            out->plus_start[i + 1u] = (uint32_t)n_plus;
            out->minus_start[i + 1u] = (uint32_t)n_minus;
        }
    }
}

/* Whole clusters by following the chain. */
static void zeta_from_chain(rig_lists *out)
{
    const uint32_t n = out->n;
    const size_t words = (n + 63u) / 64u;
    uint64_t *row = calloc(n * words, sizeof *row);
    size_t total = 0;
    for (uint32_t i = 0; row != NULL && i < n; i++) {
        uint64_t *own = row + out->vertex[i] * words;
        if (out->parent[i] != out->vertex[i])
            memcpy(own, row + out->parent[i] * words, words * sizeof *own);
        for (uint32_t k = out->plus_start[i]; k < out->plus_start[i + 1u]; k++)
            own[out->plus[k] / 64u] |= (uint64_t)1 << (out->plus[k] % 64u);
        for (uint32_t k = out->minus_start[i]; k < out->minus_start[i + 1u]; k++)
            own[out->minus[k] / 64u] &= ~((uint64_t)1 << (out->minus[k] % 64u));
    }
    for (uint32_t pass = 0; row != NULL && pass < 2u; pass++) {
        total = 0;
        for (uint32_t v = 0; v < n; v++) {
            for (size_t w = 0; w < words; w++) {
                for (uint64_t rest = row[v * words + w]; rest != 0u; rest &= rest - 1u, total++)
                    if (pass == 1u)
                        out->zeta[total] = (uint32_t)(w * 64u) + (uint32_t)__builtin_ctzll(rest);
            }
            out->zeta_start[v + 1u] = (uint32_t)total;
        }
        if (pass == 0u)
            out->zeta = rig_alloc(total * sizeof *out->zeta);
    }
    free(row);
}

/* near[v]: 1 where v is a mesh neighbour of `of`. */
static void mark_ring(const smr_model *m, uint32_t of, const uint32_t *start, const uint32_t *around, uint8_t *near,
                      uint8_t mark)
{
    const uint32_t *t = smr_at(m, m->at_triangles);
    for (uint32_t k = start[of]; k < start[of + 1u]; k++)
        for (uint32_t c = 0; c < 3u; c++)
            near[smr_le32(t[3u * (size_t)around[k] + c])] = mark;
}

static void zeta_by_pairs(const smr_model *m, const smr_lists *l, int separate, int ring, rig_lists *out)
{
    const uint32_t n = out->n, nt = smr_le32(m->n_triangles);
    const uint32_t *t = smr_at(m, m->at_triangles), *rest = smr_at(m, m->at_rest);
    uint32_t *start = rig_alloc((n + 2u) * sizeof *start), *around = rig_alloc(3u * (size_t)nt * sizeof *around);
    uint8_t *near = rig_alloc(n);
    float *x = rig_alloc(n * 3u * sizeof *x);
    for (size_t i = 0; i < 3u * (size_t)nt; i++)
        start[smr_le32(t[i]) + 2u]++;
    for (uint32_t v = 2; v <= n + 1u; v++)
        start[v] += start[v - 1u];
    for (size_t i = 0; i < 3u * (size_t)nt; i++)
        around[start[smr_le32(t[i]) + 1u]++] = (uint32_t)(i / 3u);
    for (size_t i = 0; i < 3u * (size_t)n; i++)
        x[i] = smr_le_float(rest[i]);
    const float r2 = l->radius * l->radius;
    size_t total = 0, room = 0;
    for (uint32_t v = 0; v < n; v++)
        room += smr_list_count(l, v);
    out->zeta = rig_alloc((room + n) * sizeof *out->zeta);
    for (uint32_t v = 0; v < n; v++) {
        if (ring)
            mark_ring(m, v, start, around, near, 1);
        for (uint32_t k = 0; k < n; k++) {
            const float dx = x[3u * k] - x[3u * v], dy = x[3u * k + 1u] - x[3u * v + 1u],
                        dz = x[3u * k + 2u] - x[3u * v + 2u];
            const int inside = dx * dx + dy * dy + dz * dz <= r2 && (!separate || out->owner[k] == out->owner[v]);
            if ((inside || near[k]) && total < room + n)
                out->zeta[total++] = k;
        }
        if (ring)
            mark_ring(m, v, start, around, near, 0);
        out->zeta_start[v + 1u] = (uint32_t)total;
    }
}

rig_lists rig_decode(const smr_model *model, uint32_t radius, int ring, int pairs)
{
    const smr_lists l = smr_model_lists(model, radius);
    const smr_stored_radius *r = (const smr_stored_radius *)smr_at(model, model->at_radii) + radius;
    rig_lists out;
    memset(&out, 0, sizeof out);
    out.n = smr_le32(model->n_vertices);
    out.xyz = rig_alloc(out.n * 3u * sizeof(float));
    out.owner = rig_alloc(out.n * sizeof(uint32_t));
    out.zeta_start = rig_alloc((out.n + 1u) * sizeof(uint32_t));
    const uint32_t *rest = smr_at(model, model->at_rest);
    for (size_t i = 0; i < 3u * (size_t)out.n; i++)
        out.xyz[i] = smr_le_float(rest[i]) + smr_le_float(model->centre[i % 3u]);
    for (uint32_t v = 0; v < out.n; v++)
        out.owner[v] = smr_model_owner(model, v);
    decode_chain(&l, &out);
    if (pairs)
        zeta_by_pairs(model, &l, smr_le32(r->separate) != 0u, ring, &out);
    else
        zeta_from_chain(&out);
    return out;
}
