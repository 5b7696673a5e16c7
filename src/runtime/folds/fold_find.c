/* fold_find.c: watches for triangles that turn over. Shape matching makes folds rare; forces that cross can still turn a triangle
 * over, and a plastic reference would then keep it so. Coarse radii move the model almost rigidly, and most of what bends
 * there straightens again. From the last radius but one on hinges are searched; fold_repair.c repairs what folds by then, fold_limit.c holds
 * back what would fold, and fold_open.c deals, at the last radius, with what turned back all the same.
 * Bounds: one pass over the hinges.
 * SPDX-License-Identifier: MIT */
#include "geometry/triangle.h"
#include "runtime/folds/folds.h"

static smr_vec normal_at(const smr *s, float *x, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    return smr_unit(
        smr_triangle_cross(smr_load(smr_at3(x, t[0])), smr_load(smr_at3(x, t[1])), smr_load(smr_at3(x, t[2]))));
}

float smr_hinge_cosine(const smr *s, float *x, const smr_stored_hinge *h)
{
    return smr_dot(normal_at(s, x, smr_le32(h->first)), normal_at(s, x, smr_hinge_second(h)));
}

uint32_t smr_guard_tasks(smr *s) { return smr_guarded(s) ? s->n_hinge_tasks : 0u; }

/* Counts a chunk's hinges that fold, or would be held back, by the facets' normals at x_next. */
void smr_guard_search(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_HINGE_CHUNK, s->n_hinges);
    uint32_t n = 0, n_open = 0;
    for (uint32_t i = task * SMR_HINGE_CHUNK; i < last; i++) {
        const smr_stored_hinge *h = smr_hinge_at(s, i);
        const smr_vec a = smr_load(s->facet_normal + 3u * (size_t)smr_le32(h->first));
        const smr_vec b = smr_load(s->facet_normal + 3u * (size_t)smr_hinge_second(h));
        const float next = smr_dot(a, b);
        if (!(next < SMR_BRAKE_BELOW))
            continue;
        n += s->repairing > 0u ? next < smr_hinge_limit(smr_le32(h->bend)) : smr_brake_share(s, h, next) > 0.0f;
        n_open += smr_hinge_open(h) && next < SMR_FOLD_COS;
    }
    s->tally[task].n_rejected = n;
    s->tally[task].n_active = n_open;
}

void smr_guard_end(smr *s)
{
    uint32_t n_bent = 0, n_open = 0;
    s->n_guarded = 0;
    s->n_folding = 0;
    for (uint32_t task = 0; task < s->n_hinge_tasks; task++) {
        n_bent += s->tally[task].n_rejected;
        n_open += s->tally[task].n_active;
    }
    if (n_bent + n_open == 0u)
        return;
    for (uint32_t i = 0; i < s->n_parts; i++)
        s->part[i].folding = 0;
    memset(s->guard, 0, s->n);
    if (n_bent > 0u && s->repairing > 0u)
        smr_mend_start(s);
    else if (n_bent > 0u)
        smr_brake_start(s);
    smr_unfold_start(s);
}
