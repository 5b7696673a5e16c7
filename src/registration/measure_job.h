/* measure_job.h: jobs that measure a registration between iterations, in the memory of records and sums.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MEASURE_JOB_H
#define SMR_MEASURE_JOB_H

#include "base/job.h"
#include "registration/registration.h"

/* The first member of such a job. */
typedef struct smr_measuring {
    smr_job_head head;
    smr *s;
    uint32_t changes, turn; /* smr_log.changes and smr.n_measured at the begin */
} smr_measuring;

/* Returns 1 when the registration can be measured: no iteration is under way. */
static inline int smr_measurable(const smr *s) { return smr_ready(s) && s->step == 0u && s->next_task == 0u; }

smr_measuring smr_measure_begin(smr *s, const smr_stage *stages, uint32_t n_stages);

/* A guard: keeps ticks and setters out while a step runs. Returns 0 before a step when `legal` is 0, or a tick, a
 * setter or another measure has come since the begin. */
int smr_hold_guard(smr_measuring *m, int enter, int legal);

/* The same for a measure between iterations. */
static inline int smr_measure_guard(smr_measuring *m, int enter)
{
    return smr_hold_guard(m, enter, smr_measurable(m->s));
}

#endif
