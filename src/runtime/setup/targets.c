/* targets.c: which structure is drawn to which surface.
 * SPDX-License-Identifier: MIT */
#include "runtime/record/log.h"

/* Distinct surfaces, their tasks and slots. Returns the slots they need. */
static uint64_t list_goals(const smr *s, const smr_part *part, smr_goal *goal, uint32_t *n_goals, uint32_t *n_tasks)
{
    uint64_t slots = 0;
    *n_goals = *n_tasks = 0;
    for (uint32_t i = 0; i < s->n_parts; i++) {
        uint32_t known = 0;
        while (known < i && part[known].target != part[i].target)
            known++;
        if (part[i].target == NULL || known < i)
            continue;
        if (goal != NULL)
            goal[*n_goals] = (smr_goal){part[i].target, *n_tasks, part[i].target->n_vertices, (uint32_t)slots};
        ++*n_goals;
        *n_tasks += smr_ceil_div(part[i].target->n_vertices, SMR_FORCE_CHUNK);
        slots += part[i].target->n_vertices;
    }
    return slots;
}

/* Slots needed if `structure` had this surface. */
static uint64_t slots_with(smr *s, uint32_t structure, const smr_surface *surface)
{
    uint32_t n_goals, n_tasks;
    if (structure == SMR_ALL)
        return surface == NULL ? 0u : surface->n_vertices;
    const smr_surface *before = s->part[structure].target;
    s->part[structure].target = surface;
    const uint64_t slots = list_goals(s, s->part, NULL, &n_goals, &n_tasks);
    s->part[structure].target = before;
    return slots;
}

smr_status smr_set_surface(smr *s, uint32_t structure, const smr_surface *surface)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s) || (surface != NULL && !smr_surface_valid(surface)))
        return SMR_E_STATE;
    if (structure != SMR_ALL && structure >= s->n_parts)
        return SMR_E_INPUT;
    if (s->config.n_target_vertices > 0u && slots_with(s, structure, surface) > s->config.n_target_vertices)
        return SMR_E_ARENA;
    const uint32_t first = structure == SMR_ALL ? 0u : structure;
    const uint32_t last = structure == SMR_ALL ? s->n_parts : structure + 1u;
    for (uint32_t i = first; i < last; i++)
        s->part[i].target = surface;
    for (uint32_t v = 0; v < s->n; v++)
        if (structure == SMR_ALL || smr_model_owner(s->model, v) == structure)
            s->warm[v] = SMR_NONE;
    (void)list_goals(s, s->part, s->goal, &s->n_goals, &s->n_target_tasks);
    for (uint32_t j = 0; s->target_warm != NULL && j < s->config.n_target_vertices; j++)
        s->target_warm[j] = SMR_NONE;
    /* an iteration under way starts again with the new goals; one that has its forces ends with the old ones */
    if (s->pull != NULL)
        memset(s->pull, 0, s->config.n_workers * (size_t)s->n * 4u * sizeof *s->pull);
    if (smr_forces_pending(s))
        s->step = s->next_task = 0;
    s->force_limit = 0.0f;
    smr_log_surface(s, structure, surface);
    return SMR_OK;
}
