/* cluster_radii.c: chooses the cluster sizes s (radii) when the configuration names none, from coarse to fine (paper
 * 3, geometric registration).
 * Surface targets: from a quarter of the model's length down to little more than an edge, each radius about two thirds
 * of the one before, and a last radius far below an edge, where clusters are single vertices.
 * Images: fixed radii of human size. A single structure, which no neighbouring structure guides from the error of the
 * start pose, also gets clusters over its whole length and over a third.
 * Dense structures: radii are those of a structure of fewer vertices; clusters of coarse radii hold only the most
 * important vertices, because larger clusters make iterations slow and not better.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

#define SMR_COARSEST 0.25f    /* coarsest radius, as a share of the model's length */
#define SMR_FINE_EDGES 1.7f   /* second finest radius, in mean edge lengths */
#define SMR_FREE_EDGES 0.01f  /* finest radius, in mean edge lengths */
#define SMR_RATIO 0.66f       /* each radius as a share of the next coarser one */
#define SMR_MEMBERS_MAX 1500u /* largest mean number of vertices in a cluster: more only makes iterations slow */
#define SMR_DENSE 8000u       /* largest number of vertices in a structure that is not dense */
#define SMR_FEW 5000u         /* number of vertices of a dense structure that suffice at coarse radii, at least ... */
#define SMR_FEW_SHARE 25u     /* ... the number of the structure's vertices / SMR_FEW_SHARE */
#define SMR_MEMBERS_ALL 300u  /* largest mean number of vertices in a dense model's cluster that holds all vertices */
#define SMR_PROBES 64u        /* largest number of clusters that are built to estimate the mean size */

/* Returns the mean number of vertices in clusters of this radius, mm, estimated from at most SMR_PROBES clusters. */
static uint32_t mean_members(smr_plan *p, float radius)
{
    uint64_t sum = 0;
    const uint32_t probes = smr_min_u32(SMR_PROBES, p->n);
    for (uint32_t i = 0; i < probes; i++) {
        (void)smr_ball_row(p, p->position[(uint64_t)i * p->n / probes], radius, smr_plan_row(p, 0));
        sum += smr_row_count(smr_plan_row(p, 0), p->words);
    }
    return (uint32_t)(sum / probes);
}

uint32_t smr_plan_thinned(const smr_plan *p)
{
    const smr_prepare_config *c = p->config;
    uint32_t n = 0;
    if (!c->priority || c->n_radii > 0u || c->reference != NULL || c->order != SMR_ORDER_FOREST ||
        c->distance != SMR_DISTANCE_EUCLIDEAN)
        return p->n;
    for (uint32_t s = 0; s < p->n_structures; s++) {
        const uint32_t all = p->structures[s].mesh.n_vertices;
        const int dense = all > SMR_DENSE && p->structures[s].mesh.n_triangles > 0u;
        n += dense ? smr_max_u32(SMR_FEW, all / SMR_FEW_SHARE) : all;
    }
    return n;
}

void smr_plan_coarse(smr_plan *p, const float *radius, uint32_t n_radii)
{
    const uint32_t thinned = smr_plan_thinned(p);
    uint32_t members = p->n, r = 0;
    /* active_min vertices lie evenly; they are the fewer the coarser the radius */
    for (uint32_t k = n_radii; k-- > 0u && (members == p->n || p->active_min[k] >= thinned / 2u);)
        members = smr_min_u32(members, p->active_min[k]);
    while (thinned < p->n && members < p->n && r + 1u < n_radii && p->active_min[r] <= members &&
           mean_members(p, radius[r]) > SMR_MEMBERS_ALL)
        r++;
    p->coarse_radii = r;
    p->coarse_vertices = r > 0u ? members : 0u;
}

void smr_plan_members(smr_plan *p, uint32_t radius)
{
    const uint32_t before = p->members;
    p->members = radius < p->coarse_radii ? p->coarse_vertices : 0u;
    if (p->members == before)
        return;
    p->words = smr_ceil_div(p->members > 0u ? p->members : p->n, 64u);
    smr_plan_clear_rows(p);
    if (p->members == 0u)
        return;
    for (uint32_t v = 0, n = 0; v < p->n; v++)
        if (p->stored[v] < p->members) {
            p->of_bit[n] = v;
            p->bit[v] = n++;
        }
    smr_plan_tree(p, &p->few, p->members, p->of_bit);
}

/* Returns the model's length, mm: that of a thin rod whose points have the same variance. The pose does not matter. */
static float rod_length(const smr_plan *p)
{
    smr_vec mean = smr_v(0, 0, 0);
    const float share = 1.0f / (float)p->n;
    for (uint32_t v = 0; v < p->n; v++)
        mean = smr_add(mean, smr_scale(smr_get3(p->xyz, v), share));
    float spread = 0.0f;
    for (uint32_t v = 0; v < p->n; v++)
        spread += share * smr_distance2(smr_get3(p->xyz, v), mean);
    return SMR_SQRT(12.0f * spread);
}

/* Returns the radius rounded to eight binary digits, so that rounding of a measured length does not change clusters. */
static float rounded(float radius) { return smr_float_of((smr_float_bits(radius) + 0x8000u) & 0xffff0000u); }

static uint32_t image_radii(const smr_plan *p, float radius[SMR_RADII_MAX])
{
    static const float local[] = {60.0f, 40.0f, 25.0f, 15.0f}; /* radii after those of the whole structure, mm */
    const float size = rounded(rod_length(p));
    uint32_t n = 0;
    for (uint32_t k = 0; p->n_structures == 1u && k < 2u; k++) {
        const float whole = smr_min(k == 0u ? size : size * (1.0f / 3.0f), SMR_COORD_MAX);
        if (whole > 1.25f * local[0])
            radius[n++] = rounded(whole);
    }
    for (uint32_t k = 0; k < sizeof local / sizeof local[0]; k++)
        radius[n++] = local[k];
    return n;
}

uint32_t smr_choose_radii(smr_plan *p, float radius[SMR_RADII_MAX])
{
    if (p->config->reference != NULL)
        return image_radii(p, radius);
    const float size = rod_length(p);
    float coarse = smr_min(size * SMR_COARSEST, SMR_COORD_MAX);
    if (!(coarse > 1.0e-3f)) { /* the model is a single point */
        radius[0] = 1.0f;
        return 1u;
    }
    const uint32_t most = (uint32_t)((uint64_t)SMR_MEMBERS_MAX * p->n / smr_plan_thinned(p));
    for (uint32_t i = 0; i < 40u && mean_members(p, coarse) > most; i++)
        coarse *= 0.9f;
    const float fine = smr_max(p->edge_mm > 0.0f ? p->edge_mm * SMR_FINE_EDGES : coarse * 0.1f, size * 1.0e-3f);
    uint32_t n = 0;
    for (float r = coarse; n < SMR_RADII_MAX - 2u && r > fine * 1.2f; r *= SMR_RATIO)
        radius[n++] = r;
    radius[n++] = smr_min(fine, coarse);
    if (p->edge_mm > 0.0f)
        radius[n++] = smr_min(fine, coarse) * (SMR_FREE_EDGES / SMR_FINE_EDGES);
    for (uint32_t i = 0; i < n; i++)
        radius[i] = rounded(radius[i]);
    return n;
}
