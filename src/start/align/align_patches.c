/* align_patches.c: patches of a model that follow a target together, each by a rigid motion, as in embedded deformation
 * (Sumner, Schmid and Pauly 2007): the place of a point is a mean over the motions of the patches around it.
 * Bounds: a search of SMR_BENT_NODES nodes from a patch; a fit takes at most SMR_BENT_MEMBERS pairs.
 * SPDX-License-Identifier: MIT */
#include "start/align/align_patches.h"

#define SMR_BENT_REACH 3.0f      /* search range / radius of a cell */
#define SMR_BENT_NODES 400u      /* largest number of nodes that a search opens */
#define SMR_BENT_LIMIT 0.12f     /* distance at which a place costs 1 / spread of the model */
#define SMR_BENT_LEARN 0.01f     /* largest motion after which a patch learns how near other triangles are / radius */
#define SMR_BENT_REST 0.02f      /* motion in a round up to which a patch rests while others join / radius of a cell */
#define SMR_BENT_RESTLESS 8u     /* of so many steps one is without rest */
#define SMR_BENT_ROUNDED 2.5e-7f /* rounding of places as a share of the coordinates */
#define SMR_BENT_COS 0.8f        /* smallest cosine between the normals of a patch and of its closest point */
#define SMR_BENT_COVER_COS 0.3f  /* the same of a cell of the target and of the patch that covers it */
#define SMR_BENT_BESIDE 1.5f     /* distance beside the middle of a patch up to which it covers / radius of a cell */
#define SMR_BENT_KEEP 0.05f      /* weight of the present place of a patch relative to that of a near goal */
#define SMR_BENT_BLEND 3.0f      /* distance beyond which patches hardly count for a place / radius of a cell */
#define SMR_BENT_PART 6.0f       /* the same for a patch of a part, once all have joined */

/* Adds i to a list without i that is not full. */
static void add_once(uint32_t *list, uint32_t *n, uint32_t most, uint32_t i)
{
    for (uint32_t k = 0; k < *n; k++)
        if (list[k] == i)
            return;
    if (*n < most)
        list[(*n)++] = i;
}

void smr_patches_areas(const smr_cells *c, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++)
        if (c->of[v] != SMR_NONE)
            c->cell[c->of[v]].area += c->surface->area[v];
}

void smr_patches_link(const smr_bent *w, uint32_t first, uint32_t last)
{
    const smr_cells *m = &w->side[SMR_MODEL];
    for (uint32_t k = 3u * first; k < 3u * last; k++) {
        const uint32_t *t = m->surface->triangle, a = m->of[t[k]], b = m->of[t[k % 3u < 2u ? k + 1u : k - 2u]];
        if (a == b || a == SMR_NONE || b == SMR_NONE)
            continue;
        add_once(w->patch[a].link, &w->patch[a].n_links, SMR_BENT_LINKS, b);
        add_once(w->patch[b].link, &w->patch[b].n_links, SMR_BENT_LINKS, a);
    }
}

/* Adds the neighbours of members first .. last, also of those that join thereby, to the members. */
static void add_neighbours(const smr_bent *w, smr_patch *p, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < p->n && k <= last && p->n < SMR_BENT_MEMBERS; k++) {
        const smr_patch *q = &w->patch[p->member[k]];
        for (uint32_t l = 0; l < q->n_links; l++)
            add_once(p->member, &p->n, SMR_BENT_MEMBERS, q->link[l]);
    }
}

void smr_patch_set(const smr_bent *w, uint32_t i)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_cells *m = &w->side[SMR_MODEL];
    smr_patch *const p = &w->patch[i];
    p->rest = smr_pose_apply(&w->start, smr_get3(m->surface->xyz, m->cell[i].middle));
    p->normal = smr_unit(smr_pose_turn(&w->start, smr_get3(m->surface->normal, m->cell[i].middle)));
    p->motion = identity;
    p->joined = 1;
    p->triangle = p->body = SMR_NONE;
    add_once(p->member, &p->n, SMR_BENT_MEMBERS, i);
    add_neighbours(w, p, 0, p->n_links); /* neighbours follow the patch itself */
    p->n_near = p->n;
}

/* Returns the weight of a patch at a place of the start pose; reach: radii of cells. */
static float share_at(const smr_bent *w, const smr_patch *p, smr_vec rest, float reach)
{
    const smr_vec d = smr_scale(smr_sub(rest, p->rest), 1.0f / (reach * w->radius));
    const float near = smr_positive(1.0f - smr_dot(d, d));
    return near * near + 0.01f;
}

smr_vec smr_patch_place(const smr_bent *w, const smr_patch *p, smr_vec rest)
{
    smr_vec sum = smr_v(0, 0, 0);
    float all = 0.0f;
    for (uint32_t k = 0; k < p->n_near; k++) {
        const smr_patch *q = &w->patch[p->member[k]];
        const float share = q->joined > 0u ? share_at(w, q, rest, SMR_BENT_BLEND) : 0.0f;
        sum = smr_add(sum, smr_scale(smr_pose_apply(&q->motion, rest), share));
        all += share;
    }
    return all > 0.0f ? smr_scale(sum, 1.0f / all) : rest;
}

/* Returns 1 when the patch may follow a point on its cell of the target: a neighbour is there, and no other part. */
static int may_follow(const smr_bent *w, const smr_patch *p)
{
    if (w->step == 0u)
        return 1;
    int near = p->found != 0u, owned = w->owner[p->on] == SMR_NONE;
    for (uint32_t k = 0; k < p->n_links && !near; k++)
        near = w->patch[p->link[k]].found != 0u;
    for (uint32_t k = 0; k < p->n_near && !owned; k++)
        owned = p->member[k] == w->owner[p->on];
    return near && owned;
}

/* Returns 1 when all near members that have joined have the motion of the round before. */
static int stays(const smr_bent *w, const smr_patch *p)
{
    uint32_t k = 0;
    while (k < p->n_near && (w->patch[p->member[k]].joined == 0u || w->patch[p->member[k]].rests))
        k++;
    return k == p->n_near;
}

static float weight_of(const smr_bent *w, const smr_patch *p, float range2)
{
    const float half = 1.0f / (1.0f + p->d2 / range2);
    return p->on != SMR_NONE && may_follow(w, p) ? half * half : 0.0f;
}

int smr_patch_find(const smr_bent *w, smr_patch *p, smr_pause *pause)
{
    const smr_surface *s = w->side[SMR_TARGET].surface;
    const float range2 = SMR_BENT_REACH * SMR_BENT_REACH * w->radius * w->radius;
    if (p->joined > 0u && stays(w, p)) {
        p->moved = 0.0f;
        p->weight = weight_of(w, p, range2);
        return 1;
    }
    p->weight = 0.0f;
    p->d2 = FLT_MAX;
    p->on = SMR_NONE;
    if (p->joined == 0u)
        return 1;
    p->at = smr_patch_place(w, p, p->rest);
    const smr_query q = {p->at, smr_pose_turn(&p->motion, p->normal), SMR_BENT_COS, SMR_BENT_NODES, p->triangle};
    smr_hit hit = {range2, SMR_NONE, {0, 0, 0}};
    const float moved = smr_length(smr_sub(p->at, p->searched));
    p->moved = moved;
    const float size = smr_abs(p->at.x) + smr_abs(p->at.y) + smr_abs(p->at.z) + moved;
    const float other = p->other_mm - moved - SMR_BENT_ROUNDED * size;
    smr_certainty known = {moved < SMR_BENT_LEARN * w->radius ? moved : -1.0f, other, 0, pause};
    if (!smr_surface_search_known(s, NULL, &q, &hit, &known))
        return 0;
    p->triangle = hit.triangle;
    p->other_mm = known.other_mm;
    p->searched = p->at;
    if (hit.triangle == SMR_NONE || (s->open && smr_surface_on_border(s, hit.triangle, hit.weight)))
        return 1;
    p->d2 = hit.d2;
    p->on = w->side[SMR_TARGET].of[s->triangle[3u * (size_t)hit.triangle]];
    p->goal = smr_triangle_point(&s->tree, hit.triangle, hit.weight);
    p->weight = weight_of(w, p, range2);
    return 1;
}

void smr_patches_own(const smr_bent *w)
{
    for (uint32_t i = 0; i < w->side[SMR_TARGET].n; i++)
        w->owner[i] = SMR_NONE;
    for (uint32_t i = 0; i < w->side[SMR_MODEL].n; i++) {
        const smr_patch *p = &w->patch[i];
        if (p->on != SMR_NONE && (w->owner[p->on] == SMR_NONE || p->d2 < w->patch[w->owner[p->on]].d2))
            w->owner[p->on] = i;
    }
}

void smr_patch_extend(const smr_bent *w, smr_patch *p)
{
    if (p->joined > 0u)
        add_neighbours(w, p, p->n_links + 1u, SMR_BENT_MEMBERS);
}

/* Returns 1 when a patch may rest: while others join, when no near member that has joined has moved in this round. In
 * some steps none rests, so that small motions add up. */
static uint32_t may_rest(const smr_bent *w, const smr_patch *p)
{
    if (w->agree2 > 0.0f || w->round == 0u || w->step % SMR_BENT_RESTLESS == 0u)
        return 0;
    for (uint32_t k = 0; k < p->n_near; k++) {
        const smr_patch *q = &w->patch[p->member[k]];
        if (q->joined > 0u && q->moved > SMR_BENT_REST * w->radius)
            return 0;
    }
    return 1;
}

void smr_patch_fit(const smr_bent *w, smr_patch *p)
{
    smr_fit fit;
    if (p->joined == 0u)
        return;
    p->found = p->weight > 0.0f;
    const int joining = w->agree2 == 0.0f;
    if (joining && p->joined == 1u && p != &w->patch[w->seed])
        return;
    p->rests = may_rest(w, p);
    if (p->rests)
        return;
    smr_fit_start(&fit, p->rest, p->at);
    for (uint32_t k = 0; k < (joining ? p->n_near : p->n); k++) {
        const smr_patch *q = &w->patch[p->member[k]];
        const smr_vec at = q->joined > 0u ? q->at : smr_pose_apply(&p->motion, q->rest);
        const float all = q->weight + SMR_BENT_KEEP;
        const smr_vec to = smr_add(smr_scale(at, SMR_BENT_KEEP / all), smr_scale(q->goal, q->weight / all));
        const smr_vec off = smr_sub(smr_pose_apply(&p->motion, q->rest), to);
        const float agrees = joining ? 1.0f : w->agree2 / (w->agree2 + smr_dot(off, off));
        const float reach = joining ? SMR_BENT_BLEND : SMR_BENT_PART;
        smr_fit_add(&fit, q->rest, to, share_at(w, q, p->rest, reach) * all * agrees * agrees);
    }
    p->motion = smr_fit_solve(&fit, 0);
}

void smr_patches_compare(smr_bent *w, uint32_t first, uint32_t last)
{
    for (uint32_t i = first; i < last; i++) {
        const smr_patch *p = &w->patch[i];
        const float area = w->side[SMR_MODEL].cell[i].area;
        w->area += area;
        if (p->joined == 0u || p->joined + 1u >= w->step || !(p->weight > 0.0f))
            continue;
        w->found_area += area;
        w->found_cost += area * smr_min(p->d2, w->limit2) / w->limit2;
    }
}

float smr_patches_distance2(const smr_bent *w, smr_vec at, smr_vec normal)
{
    float least = FLT_MAX, up = 0.0f;
    for (uint32_t i = 0; i < w->side[SMR_MODEL].n; i++) {
        const smr_patch *p = &w->patch[i];
        const smr_vec d = smr_sub(at, p->at);
        if (p->joined == 0u || smr_dot(d, d) >= least)
            continue;
        const smr_vec facing = smr_pose_turn(&p->motion, p->normal);
        if (smr_dot(facing, normal) < SMR_BENT_COVER_COS)
            continue;
        least = smr_dot(d, d);
        up = smr_dot(facing, d);
    }
    const float beside = SMR_SQRT(smr_positive(least - up * up)) - SMR_BENT_BESIDE * w->radius;
    return up * up + smr_positive(beside) * smr_positive(beside);
}

void smr_patches_set_limit(smr_bent *w)
{
    const smr_cells *m = &w->side[SMR_MODEL];
    smr_vec sum = smr_v(0, 0, 0);
    float squares = 0.0f, all = 0.0f;
    for (uint32_t i = 0; i < m->n; i++) {
        const smr_vec d = smr_sub(w->patch[i].rest, w->patch[0].rest);
        sum = smr_add(sum, smr_scale(d, m->cell[i].area));
        squares += smr_dot(d, d) * m->cell[i].area;
        all += m->cell[i].area;
    }
    const smr_vec mean = smr_scale(sum, 1.0f / all);
    w->limit2 = SMR_BENT_LIMIT * SMR_BENT_LIMIT * smr_positive(squares / all - smr_dot(mean, mean)) + FLT_MIN;
}

float smr_patches_cost(const smr_bent *w, uint32_t side, uint32_t i)
{
    return smr_min(w->d2[side][i], w->limit2) / w->limit2;
}

/* 1 without area. Not inlined: unused lanes of two quotients trap on 0 / 0. */
__attribute__((noinline)) float smr_patches_mean_cost(const smr_bent *w, uint32_t side)
{
    float sum = 0.0f, all = 0.0f;
    for (uint32_t i = 0; i < w->side[side].n; i++) {
        sum += smr_patches_cost(w, side, i) * w->side[side].cell[i].area;
        all += w->side[side].cell[i].area;
    }
    return all > 0.0f ? sum / all : 1.0f;
}
