/* registration.h: a registration: the structs of its stages in the order of an iteration, and its state. The struct
 * lies at the start of the caller's arena; the stages' arrays follow. A stage gets its own struct, which holds const
 * pointers to what the stage reads.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_REGISTRATION_H
#define SMR_REGISTRATION_H

#include "registration/evolve/evolve_positions.h"
#include "options/contact/contact.h"
#include "registration/folds/folds.h"
#include "registration/goals/external_forces.h"
#include "log/record/log_format.h"

#define SMR_STATE_MAGIC 0x736d7254u
#define SMR_TICKING 0x5a3c6996u  /* values far from 0 in bits: a flipped bit does not turn the guard off */
#define SMR_STARTING 0xa596c369u /* ticking: a job is setting the start positions, and only that job goes on */
#define SMR_GUARD_CLOSED 0xc3a59669u
#define SMR_STEPS_MAX 51u /* largest number of steps of an iteration */

/* Measured costs of steps, and decisions of the time budget (time_budget.c). */
typedef struct smr_time_budget {
    float rate[SMR_STEPS_MAX]; /* cost of each step, ns a unit of work; negative: unknown */
    uint64_t spent;            /* time spent in the current step, ns */
    uint32_t work;             /* work done since the last reading of the clock, instructions at most */
    float pace;                /* ns an instruction of work; negative: unknown */
    float sum;                 /* time spent in the current iteration, ns */
    float whole;               /* mean time of an iteration, ns */
    uint32_t count;            /* number of active vertices when the costs of the cluster sums were learnt */
    uint32_t uncut;            /* 1: the current iteration spans several ticks and leaves no vertex out */
    uint32_t late;             /* 1: the iteration was planned for one tick and needed another */
    uint32_t cut;              /* 1: n_active was reduced for lack of time */
    uint32_t repairing;        /* 1: the last iteration repaired folds */
    float margin;              /* factor on the predicted time of the iteration's later steps, kept in reserve */
    uint32_t look;             /* number of searched vertices at which the time in reserve is checked next */
    uint32_t odd;              /* 1: the clock ran backwards in the current step */
} smr_time_budget;

/* Checksums of what a fault must not change unnoticed, since it holds pointers and counts: the parts of the struct, the
 * model's tables, and small arrays with pointers. Set whenever a call that changes the registration ends. */
enum {
    SMR_GUARD_HEAD = 0,
    SMR_GUARD_MODEL,
    SMR_GUARD_TABLES,
    SMR_GUARD_REST,
    SMR_GUARD_ARRAYS,
    SMR_GUARD_GROUPS,
    SMR_GUARD_PARTS
};
typedef struct smr_guard {
    uint32_t sum[SMR_GUARD_PARTS]; /* HEAD, MODEL (header), TABLES: all that reading positions needs */
    uint32_t closed;               /* SMR_GUARD_CLOSED: the sums are those of the present state; 0: call not over */
} smr_guard;

struct smr_scrub_calls;

/* Check of borrowed inputs in slices, and of the whole arena between calls; off unless smr_set_scrub() was called. */
typedef struct smr_scrubbing {
    const struct smr_scrub_calls *calls; /* NULL: off */
    uint32_t what;                       /* sum of SMR_SCRUB_... */
    uint32_t damaged;                    /* 0: nothing was found; 1: positions can be read; 2: not even they */
    uint32_t checked;                    /* 1: a whole round over the inputs has ended since the last iteration */
    uint32_t input, left;                /* number of the input under check; number of inputs left in this round */
    size_t at;                           /* bytes of this input checked so far */
    uint32_t sum;                        /* checksum of these bytes */
    uint32_t model, voxels, mask;        /* checksums of the model and of the image */
    uint32_t seal;                       /* checksum of the arena when the last call ended */
} smr_scrubbing;

/* Functions of the scrub, which a program without smr_set_scrub() does not link. */
typedef struct smr_scrub_calls {
    smr_status (*slice)(smr *s, uint64_t budget_ns);       /* a tick's part. Errors: E_DAMAGED */
    void (*learn)(smr *s, uint32_t kind, uint32_t number); /* takes an input's checksum, SMR_LOG_..., when it is set */
    uint32_t (*seal)(const smr *s);                        /* returns the checksum of the arena */
} smr_scrub_calls;

#define SMR_SCRUB_ALL UINT32_MAX /* smr_scrubbing.left before a round */

struct smr {
    uint32_t magic;           /* SMR_STATE_MAGIC marks a registration */
    uint32_t step, next_task; /* position of the tick: current step of the iteration; number of its complete tasks */
    uint32_t n_dealt, block;  /* number of the step's tasks that workers have got; number in a block */
    uint32_t n_shares;  /* number of workers among which the step's tasks are divided; 0: the step has not begun */
    uint32_t ticking;   /* SMR_TICKING: a tick is running, perhaps in this thread: inputs are refused; else 0 */
    uint32_t refused;   /* 1: the port left out a task or used an illegal worker. Setting positions clears it */
    uint32_t n_awaited; /* number of inputs that must be set again after a restore */
    /* sets an awaited input of this kind (SMR_LOG_...) and number; the pointer is set by smr_restore() */
    smr_status (*await)(smr *s, uint32_t kind, uint32_t number, const void *what);
    struct smr *placed; /* address given by smr_init(): a copy would share the original's arrays */
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
    uint32_t n_measured; /* number of measures begun, which use the memory of records and sums */
    /* structure, or SMR_ALL, whose expected errors that memory holds while log.changes is judged_at and n_measured is
     * judged_turn, above 0 */
    uint32_t judged, judged_at, judged_turn;
    smr_tick_report report;
    smr_scrubbing scrub;
    size_t arena_bytes; /* bytes of the arena in use */
    smr_guard guard;    /* last: covers all members before it */
};

/* Returns 1 for a registration at the address that smr_init() gave it. */
static inline int smr_valid(const smr *s) { return s != NULL && s->magic == SMR_STATE_MAGIC && s->placed == s; }

/* Returns 1 when the registration may be changed: no tick is running. */
static inline int smr_changeable(const smr *s) { return smr_valid(s) && !s->ticking; }

/* Returns 1 when the registration may run: no tick is running, and no input is awaited. */
static inline int smr_ready(const smr *s) { return smr_changeable(s) && s->n_awaited == 0u; }

/* Begins a new round over the inputs: the registration changes, or an input. */
static inline void smr_scrub_again(smr *s)
{
    s->scrub.left = SMR_SCRUB_ALL;
    s->scrub.checked = 0;
}

/* guard.c: checks what the guard covers, and what the scrub has found. Errors: E_NULL, E_STATE (no registration),
 * E_DAMAGED. */
smr_status smr_sound(const smr *s);
void smr_guard_close(smr *s); /* takes all sums, at the end of a call that changes s */

/* Checks the arguments of a function that reads a structure into `out`. Errors: E_NULL, E_STATE, E_DAMAGED, E_INPUT. */
smr_status smr_readable(const smr *s, uint32_t structure, const void *out);
/* The same for a function that reads no more than positions or normals: OK also after faults that leave these alone. */
smr_status smr_positions_readable(const smr *s, uint32_t structure, const void *out);

/* Ends a call that has changed the registration: logs it (log_format.h), and closes the guard. */
void smr_changed(smr *s, uint32_t kind, uint32_t number, const void *what, uint32_t n);

/* Copies an array [n][3] of stored vertices plus `shift` to xyz in the caller's order. Errors: as
 * smr_positions_readable(). */
smr_status smr_copy_out(const smr *s, uint32_t structure, float *array, smr_vec shift, float *xyz);

#endif
