/* guard.c: finds faults in memory that holds pointers and counts, before a call follows them: in the registration's
 * struct, the model's tables, small arrays with pointers or indexes, and headers of target surfaces. Indexes in large
 * arrays are bounded where they are used (smr_index, smr_triangle_at).
 * Bounds: one pass over some kilobytes, and about 500 bytes more for each structure, target and landmark.
 * SPDX-License-Identifier: MIT */
#include "options/references/references.h"
#include "registration/measure_job.h"
#include "registration/tick/iteration_steps.h"

#define SMR_HEAD offsetof(smr, forces) /* bytes of the struct's part HEAD */

/* Returns a checksum of the model's tables, and of the structures, which count by them. */
static uint32_t tables_of(const smr *s)
{
    const smr_model *m = s->shared.model;
    uint32_t sum = smr_byte_sum(0, smr_model_record(m, 0), s->shared.n_structures * sizeof(smr_stored_structure));
    sum = smr_byte_sum(sum, smr_model_radius(m, 0), s->shared.n_radii * sizeof(smr_stored_radius));
    return smr_byte_sum(sum, s->shape.structure, s->shared.n_structures * sizeof *s->shape.structure);
}

/* Small arrays that hold pointers or indexes: offsets of the pointer and of the number of elements; 0: one element. */
static const struct {
    uint16_t at, count, size;
} arrays[] = {
    {offsetof(smr, forces.surface.target), offsetof(smr, shared.n_structures), sizeof(smr_target)},
    {offsetof(smr, forces.surface.goal), offsetof(smr, shared.n_structures), sizeof(smr_goal)},
    {offsetof(smr, forces.landmarks.landmark), offsetof(smr, shared.config.partial.n_landmarks),
     sizeof(smr_bound_landmark)},
    {offsetof(smr, forces.contact.fixed), offsetof(smr, shared.config.contact.n_fixed), sizeof(smr_fixed_surface)},
    {offsetof(smr, forces.caller.goals), offsetof(smr, shared.n_structures), sizeof(smr_goals)},
    {offsetof(smr, shape.track_rest), 0, sizeof(smr_track_rest)},
    {offsetof(smr, shape.dynamics), 0, sizeof(smr_dynamics)},
    {offsetof(smr, shape.references), 0, sizeof(smr_references)},
    {offsetof(smr, shared.worker), offsetof(smr, shared.config.basic.n_workers), sizeof(smr_worker)},
};

static uint32_t arrays_of(const smr *s)
{
    uint32_t sum = 0, count;
    for (uint32_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) {
        const void *array;
        memcpy(&array, (const char *)s + arrays[i].at, sizeof array);
        memcpy(&count, (const char *)s + arrays[i].count, sizeof count);
        count = arrays[i].count == 0u ? 1u : count;
        sum = array != NULL ? smr_byte_sum(sum, array, (size_t)count * arrays[i].size) : sum;
    }
    return sum;
}

/* Returns the checksum of a part of what the guard covers, SMR_GUARD_...; the parts before it must be sound. */
SMR_SELDOM static uint32_t part_of(const smr *s, uint32_t part)
{
    switch (part) {
    case SMR_GUARD_HEAD: return smr_byte_sum(0, s, SMR_HEAD);
    case SMR_GUARD_MODEL: return smr_byte_sum(0, s->shared.model, sizeof *s->shared.model);
    case SMR_GUARD_TABLES: return tables_of(s);
    case SMR_GUARD_REST: return smr_byte_sum(0, &s->forces, offsetof(smr, guard) - SMR_HEAD);
    case SMR_GUARD_ARRAYS: return arrays_of(s);
    default:
        return smr_moves(s) ? smr_byte_sum(0, s->shape.dynamics->group,
                                           s->shared.n_structures * sizeof *s->shape.dynamics->group)
                            : 0u;
    }
}

void smr_guard_close(smr *s)
{
    if (s->scrub.calls != NULL)
        s->scrub.seal = s->scrub.calls->seal(s);
    for (uint32_t i = 0; i < SMR_GUARD_PARTS; i++)
        s->guard.sum[i] = part_of(s, i);
    s->guard.closed = SMR_GUARD_CLOSED;
}

/* How much of a registration is as the last call left it; ALL also while a call is changing it. */
enum { NOTHING = 0, POSITIONS, ALL };

/* A fault in the last two parts leaves positions alone; one that no part shows may be anywhere. */
SMR_SELDOM static int intact(const smr *s)
{
    for (uint32_t i = 0; i < SMR_GUARD_PARTS; i++)
        if (part_of(s, i) != s->guard.sum[i])
            return i >= SMR_GUARD_REST ? POSITIONS : NOTHING;
    if (s->scrub.calls != NULL && s->scrub.calls->seal(s) != s->scrub.seal)
        return NOTHING;
    return s->scrub.damaged == 0u ? ALL : s->scrub.damaged == 1u ? POSITIONS : NOTHING;
}

static smr_status check(const smr *s, int least)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s))
        return SMR_E_STATE;
    return s->ticking == SMR_TICKING || s->guard.closed == 0u || intact(s) >= least ? SMR_OK : SMR_E_DAMAGED;
}

smr_status smr_sound(const smr *s) { return check(s, ALL); }

static smr_status readable(const smr *s, uint32_t structure, const void *out, int least)
{
    const smr_status status = check(out == NULL ? NULL : s, least);
    if (status == SMR_OK && s->ticking == SMR_STARTING)
        return SMR_E_STATE; /* positions are half those before */
    return status == SMR_OK && structure >= s->shared.n_structures ? SMR_E_INPUT : status;
}

smr_status smr_readable(const smr *s, uint32_t structure, const void *out) { return readable(s, structure, out, ALL); }

smr_status smr_positions_readable(const smr *s, uint32_t structure, const void *out)
{
    return readable(s, structure, out, POSITIONS);
}

void smr_changed(smr *s, uint32_t kind, uint32_t number, const void *what, uint32_t n)
{
    smr_log_note(&s->log, kind, number, what, n);
    if (s->scrub.calls != NULL)
        s->scrub.calls->learn(s, kind, number);
    smr_guard_close(s);
}

smr_measuring smr_measure_begin(smr *s, const smr_stage *stages, uint32_t n_stages)
{
    s->n_measured++;
    smr_guard_close(s);
    return (smr_measuring){smr_job_begin(stages, n_stages, &s->port), s, s->log.changes, s->n_measured};
}

int smr_hold_guard(smr_measuring *m, int enter, int legal)
{
    smr *const s = m->s;
    const smr_status sound = enter ? smr_sound(s) : SMR_OK;
    if (sound != SMR_OK) {
        m->head.status = sound; /* closing the guard would hide the fault */
        return 0;
    }
    if (enter && (!legal || s->log.changes != m->changes || s->n_measured != m->turn))
        return 0;
    s->ticking = enter ? SMR_TICKING : 0u; /* back to 0 after a step, so the guard's sums still hold */
    return 1;
}
