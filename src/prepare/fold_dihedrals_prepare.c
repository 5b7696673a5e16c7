/* fold_dihedrals_prepare.c: dihedral edges, the edges of exactly two triangles, with the angle at which each counts as
 * folded. Method: edges sorted by their two vertices, so that the triangles of an edge are neighbours in the list.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/box_tree/triangle.h"
#include "prepare/prepare_plan.h"

/* Limits are cosines of the angle between the normals of an edge's triangles. SMR_RIGHT_BACK > SMR_DIHEDRAL_OPEN. */
#define SMR_RIGHT 0.02f         /* fold limit of edges bent < 90 degrees at rest: 89 degrees, or half the rest cosine */
#define SMR_RIGHT_BACK (-0.25f) /* fold limit of edges bent by 90 degrees at rest (caps, corners): 104 degrees */
#define SMR_ROUNDING 1.0e-4f    /* edges with a rest cosine of 0 down to minus this count as bent by 90 degrees */
#define SMR_BACK (-0.48f)       /* fold limit of edges bent above 90 degrees at rest: 119 degrees or more */
#define SMR_TURNED_BACK (-0.75f) /* edges with a lower rest cosine are folded already and are left out */

/* Writes the two vertices of edge i % 3 of triangle i / 3, the smaller number first. */
static void edge_of(const smr_plan *p, uint32_t i, uint32_t *low, uint32_t *high)
{
    const uint32_t *t = p->triangle + i / 3u * 3u;
    const uint32_t a = t[i % 3u], b = t[(i % 3u + 1u) % 3u];
    *low = smr_min_u32(a, b);
    *high = smr_max_u32(a, b);
}

static smr_vec unit_normal(const smr_plan *p, uint32_t triangle)
{
    return smr_unit(smr_corners_cross(p->xyz, p->triangle + 3u * (size_t)triangle));
}

_Static_assert(SMR_TRIANGLES_MAX <= SMR_DIHEDRAL_MASK, "a dihedral edge holds its second triangle in 24 bits");

static void add_dihedral(smr_plan *p, uint32_t a, uint32_t b)
{
    const float rest = smr_dot(unit_normal(p, a), unit_normal(p, b));
    if (rest < SMR_TURNED_BACK)
        return;
    float limit = rest > 0.0f ? smr_min(SMR_RIGHT, 0.5f * rest) : SMR_RIGHT_BACK;
    if (rest < -SMR_ROUNDING)
        limit = smr_min(SMR_BACK, rest - 0.2f);
    p->dihedral[p->n_dihedrals++] = (smr_stored_dihedral){a, b | (uint32_t)((limit + 1.0f) * SMR_DIHEDRAL_UNIT) << 24};
}

void smr_plan_dihedrals(smr_plan *p)
{
    const uint32_t n = 3u * p->nt;
    uint32_t low, high;
    for (uint32_t i = 0; i < n; i++)
        p->item[i] = i;
    for (uint32_t pass = 0; pass < 2u; pass++) { /* the sort is stable: the result is by low, then by high */
        for (uint32_t i = 0; i < n; i++) {
            edge_of(p, p->item[i], &low, &high);
            p->key[i] = pass == 0u ? high : low;
        }
        smr_curve_sort(p->key, p->item, p->tmp, n);
    }
    memset(p->key, 255, n * sizeof *p->key); /* key: the other triangle's corner behind the edge, at the first one's */
    for (uint32_t i = 0, next; i < n; i = next) {
        uint32_t low2 = 0, high2 = 0;
        edge_of(p, p->item[i], &low, &high);
        for (next = i + 1u; next < n; next++) {
            edge_of(p, p->item[next], &low2, &high2);
            if (low2 != low || high2 != high)
                break;
        }
        if (next - i == 2u && low != high && p->item[i] / 3u != p->item[i + 1u] / 3u)
            p->key[p->item[i]] = p->item[i + 1u];
    }
    p->n_dihedrals = 0;
    for (uint32_t i = 0; i < n; i++)
        if (p->key[i] != UINT32_MAX)
            add_dihedral(p, i / 3u, p->key[i] / 3u);
}
