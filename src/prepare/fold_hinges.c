/* fold_hinges.c: edges that two triangles share and nobody else, for the runtime's fold guard.
 * Edges are sorted by their two vertices; equal neighbours in the sorted list belong together.
 * SPDX-License-Identifier: MIT */
#include "geometry/hilbert_curve.h"
#include "geometry/triangle.h"
#include "prepare/plan.h"

#define SMR_RIGHT 0.02f          /* cosine: flat hinges fold when their triangles' normals come to 89 degrees */
#define SMR_BACK (-0.48f)        /* sharper ones at about 119 degrees */
#define SMR_ROUNDING 1.0e-4f     /* of a cosine: right angles, which caps and corners have, */
#define SMR_RIGHT_BACK (-0.25f)  /* have some room on the way, too, but count as open at last (SMR_HINGE_OPEN) */
#define SMR_TURNED_BACK (-0.75f) /* at rest: nothing left to guard */

static void edge_of(const smr_plan *p, uint32_t i, uint32_t *low, uint32_t *high)
{
    const uint32_t *t = p->triangle + i / 3u * 3u;
    const uint32_t a = t[i % 3u], b = t[(i % 3u + 1u) % 3u];
    *low = smr_min_u32(a, b);
    *high = smr_max_u32(a, b);
}

static smr_vec unit_normal(const smr_plan *p, uint32_t triangle)
{
    const uint32_t *t = p->triangle + 3u * (size_t)triangle;
    return smr_unit(smr_triangle_cross(smr_load(p->xyz + 3u * (size_t)t[0]), smr_load(p->xyz + 3u * (size_t)t[1]),
                                       smr_load(p->xyz + 3u * (size_t)t[2])));
}

static void add_hinge(smr_plan *p, uint32_t a, uint32_t b)
{
    const float rest = smr_dot(unit_normal(p, a), unit_normal(p, b));
    if (rest < SMR_TURNED_BACK || a > SMR_HINGE_MASK || b > SMR_HINGE_MASK)
        return;
    /* edges sharper than a right angle at rest have room until they are clearly turned back */
    float limit = rest > 0.0f ? smr_min(SMR_RIGHT, 0.5f * rest) : SMR_RIGHT_BACK;
    if (rest < -SMR_ROUNDING)
        limit = smr_min(SMR_BACK, rest - 0.2f);
    p->hinge[p->n_hinges++] = (smr_stored_hinge){a, b | (uint32_t)((limit + 1.0f) * SMR_HINGE_UNIT) << 24};
}

void smr_plan_hinges(smr_plan *p)
{
    const uint32_t n = 3u * p->nt;
    uint32_t low, high;
    for (uint32_t i = 0; i < n; i++) {
        edge_of(p, i, &low, &high);
        p->key[i] = high;
        p->item[i] = i;
    }
    smr_curve_sort(p->key, p->item, p->tmp, n);
    for (uint32_t i = 0; i < n; i++) {
        edge_of(p, p->item[i], &low, &high);
        p->key[i] = low;
    }
    smr_curve_sort(p->key, p->item, p->tmp, n); /* stable: now by low, then high */
    p->n_hinges = 0;
    for (uint32_t i = 0, next; i < n; i = next) {
        uint32_t low2 = 0, high2 = 0;
        edge_of(p, p->item[i], &low, &high);
        for (next = i + 1u; next < n; next++) {
            edge_of(p, p->item[next], &low2, &high2);
            if (low2 != low || high2 != high)
                break;
        }
        if (next - i == 2u && low != high && p->item[i] / 3u != p->item[i + 1u] / 3u)
            add_hinge(p, p->item[i] / 3u, p->item[i + 1u] / 3u);
    }
}
