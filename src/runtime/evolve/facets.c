/* facets.c: the model's triangles as they move: normals, and box trees for target-to-model search.
 * SPDX-License-Identifier: MIT */
#include "runtime/forces/attract.h"

#define SMR_LEAVES 32u /* tree leaves of a task */

uint32_t smr_facet_tasks(smr *s)
{
    const smr_part *last = &s->part[s->n_parts - 1u];
    return smr_ceil_div(last->first_leaf + smr_tree_leaves(&last->facets), SMR_LEAVES);
}

void smr_facet_refit(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const uint32_t from = task * SMR_LEAVES, to = from + SMR_LEAVES;
    for (uint32_t i = 0; i < s->n_parts; i++) {
        const smr_part *part = &s->part[i];
        const uint32_t first = part->first_leaf, last = first + smr_tree_leaves(&part->facets);
        if (last > from && first < to)
            smr_tree_refit_leaves(&part->facets, smr_max_u32(first, from) - first, smr_min_u32(last, to) - first);
    }
}

void smr_facets_end(smr *s)
{
    for (uint32_t i = 0; i < s->n_parts; i++)
        if (s->part[i].facets.node != NULL) /* without a target, too: it may get one before the next iteration */
            smr_tree_refit_upper(&s->part[i].facets);
}

void smr_facets_now(smr *s)
{
    for (uint32_t i = 0; i < s->n_parts; i++) {
        s->part[i].facets.xyz = s->x;
        smr_tree_refit_leaves(&s->part[i].facets, 0, smr_tree_leaves(&s->part[i].facets));
        if (s->part[i].facets.node != NULL)
            smr_tree_refit_upper(&s->part[i].facets);
    }
}
