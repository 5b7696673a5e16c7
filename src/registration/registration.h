/* registration.h: a registration: its stages in the order of an iteration, and its state. It lies at the start of
 * the caller's arena; the stages' arrays follow. Stages get only their own struct, with const views of what they
 * read.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_REGISTRATION_H
#define SMR_REGISTRATION_H

#include "base/parallel.h"
#include "registration/evolve/evolve_positions.h"
#include "options/contact/contact.h"
#include "registration/folds/folds.h"
#include "registration/goals/external_forces.h"
#include "registration/match/match_rotation.h"
#include "log/record/log_format.h"
#include "registration/time_budget.h"

#define SMR_STATE_MAGIC 0x736d7254u

struct smr {
    uint32_t magic;
    uint32_t step, next_task; /* position of the tick: current step of the iteration, tasks of it already done */
    uint32_t ticking;         /* 1: a tick is running, perhaps in this thread: inputs are refused */
    uint32_t refused;         /* 1: the port used a worker number that does not exist; until positions are set anew */
    uint32_t n_awaited;       /* inputs that must be set again: a restored one lacks them */
    /* takes such an input, as smr_log_note() has it: restore_awaited_inputs.c. Set by smr_restore() */
    smr_status (*await)(smr *s, uint32_t kind, uint32_t number, const void *what);
    const struct smr *placed; /* address given by smr_init(): a copy would share the original's arrays */
    smr_port port;
    smr_shared shared;
    smr_schedule schedule;
    smr_overlay overlay;
    smr_shape shape;
    smr_forces forces;
    smr_sums sums;
    smr_reference reference;
    smr_match match;
    smr_evolve evolve;
    smr_volumes volumes;
    smr_folds folds;
    smr_time_budget budget;
    smr_log log;
    smr_tick_report report;
};

/* Returns 1 for a registration at the address that smr_init() gave it. */
static inline int smr_valid(const smr *s) { return s != NULL && s->magic == SMR_STATE_MAGIC && s->placed == s; }

/* Returns 1 when the registration may be changed: not from within a tick or its tasks. */
static inline int smr_changeable(const smr *s) { return smr_valid(s) && !s->ticking; }

/* Returns 1 when the registration may run: no input is missing. */
static inline int smr_ready(const smr *s) { return smr_changeable(s) && s->n_awaited == 0u; }

/* Checks of a function that reads a structure into `out`. Errors: E_NULL, E_STATE, E_INPUT. */
static inline smr_status smr_readable(const smr *s, uint32_t structure, const void *out)
{
    if (s == NULL || out == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s))
        return SMR_E_STATE;
    return structure < s->shared.n_structures ? SMR_OK : SMR_E_INPUT;
}

/* get_results.c: copies an array [n][3] of stored vertices, moved by `shift`, into the caller's order. Errors: as
 * smr_readable(). */
smr_status smr_copy_out(const smr *s, uint32_t structure, float *array, smr_vec shift, float *xyz);

#endif
