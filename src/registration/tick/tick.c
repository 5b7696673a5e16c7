/* tick.c: runs the steps of an iteration and watches the time. A step has independent tasks and a serial end. The tick
 * reads the clock between groups of tasks; after the end of the budget the next tick resumes at the next task.
 * Bounds: those of the steps.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"

static uint64_t now(const smr *s) { return s->port.now_ns == NULL ? 0u : s->port.now_ns(s->port.ctx); }

/* A loop over tasks of one step. */
typedef struct part_of_step {
    smr *s;
    const smr_step *step;
    uint32_t n_tasks; /* number of the step's tasks */
    uint32_t bundle;  /* number of tasks in a bundle, which saves time between tasks */
    uint32_t work;    /* work of each worker until it stops */
} part_of_step;

#define SMR_BUNDLES 64u      /* about the number of bundles into which the tasks of a step are divided */
#define SMR_BLOCK_TASKS 8u   /* number of tasks of goals in a block */
#define SMR_FORK_WORK 60000u /* work of a step from which on a parallel loop pays */

static void run_bundle(void *arg, uint32_t bundle, uint32_t worker)
{
    const part_of_step *p = arg;
    const uint32_t last = smr_min_u32((bundle + 1u) * p->bundle, p->n_tasks);
    for (uint32_t task = bundle * p->bundle; task < last; task++)
        p->step->run(smr_stage_of(p->s, p->step), task, worker);
}

/* Runs tasks of worker k's share until the worker's work is done. The first task always runs. */
static void run_share(void *arg, uint32_t k, SMR_UNUSED uint32_t worker)
{
    const part_of_step *p = arg;
    smr_worker *w = &p->s->shared.worker[k];
    const uint32_t cost = p->step->cost, least = smr_max_u32(cost, 1u);
    w->pause.left = p->work;
    while (w->next < w->end && (w->pause.left >= least || w->pause.left == p->work)) {
        w->pause.kept = 0;
        p->step->run(smr_stage_of(p->s, p->step), w->next, k);
        if (w->pause.kept)
            break;
        w->next++;
        w->at = w->index = w->within = 0;
        smr_work(&w->pause, cost);
        if (p->step->order == SMR_SERIAL)
            w->end = smr_step_tasks(p->s, p->step); /* some of these steps get more tasks as they run */
    }
    w->done = p->work - w->pause.left;
    w->pause.left = SMR_ENDLESS;
}

/* Returns 1 when a parallel loop over this number of the step's tasks pays. */
static int pays(const smr_step *step, uint32_t n_tasks)
{
    return step->cost == 0u || (uint64_t)step->cost * n_tasks > SMR_FORK_WORK;
}

/* Divides a step's tasks among workers, or gives all to one where a parallel loop would not pay. Each worker has a part
 * of its own, which stays in its processor's caches. Goals, of which the last ones are left out when the time ends, are
 * dealt out in small blocks. */
static void begin_shares(smr *s, const smr_step *step, uint32_t n_tasks)
{
    const int alone = step->order != SMR_ANY_ORDER || !pays(step, n_tasks);
    s->n_shares = alone ? 1u : smr_min_u32(smr_max_u32(s->port.n_workers, 1u), n_tasks);
    s->n_dealt = 0;
    s->block = smr_ceil_div(n_tasks, s->n_shares);
    if (smr_seeks_forces(step) && s->n_shares > 1u && !s->budget.uncut)
        s->block = smr_min_u32(s->block, SMR_BLOCK_TASKS);
    for (uint32_t k = 0; k < s->n_shares; k++)
        smr_worker_start(&s->shared.worker[k]);
}

/* Gives worker w, which has no task left, the next block of tasks, or half of what another worker has left. */
static void deal(smr *s, smr_worker *w, uint32_t n_tasks)
{
    smr_worker *most = w;
    if (s->n_dealt < n_tasks) {
        w->next = s->n_dealt;
        s->n_dealt = w->end = smr_min_u32(w->next + s->block, n_tasks);
        return;
    }
    for (uint32_t k = 0; k < s->n_shares; k++)
        if (s->shared.worker[k].end - s->shared.worker[k].next > most->end - most->next)
            most = &s->shared.worker[k];
    w->end = most->end;
    w->next = most->end - (most->end - most->next) / 2u;
    most->end = w->next;
}

/* Runs shares of the step for this work. Sets s->next_task to the number of complete tasks. */
static void run_shares(smr *s, const smr_step *step, uint32_t n_tasks, uint32_t work)
{
    part_of_step part = {s, step, n_tasks, 1, work};
    uint32_t most = 0, rest = 0;
    for (uint32_t k = 0; k < s->n_shares; k++)
        if (s->shared.worker[k].next == s->shared.worker[k].end)
            deal(s, &s->shared.worker[k], n_tasks);
    s->refused |= !smr_fork(&s->port, run_share, &part, s->n_shares);
    for (uint32_t k = 0; k < s->n_shares; k++) {
        most = smr_max_u32(most, s->shared.worker[k].done);
        rest += s->shared.worker[k].end - s->shared.worker[k].next;
    }
    s->n_dealt = step->order == SMR_SERIAL ? s->shared.worker[0].end : s->n_dealt;
    s->next_task = s->n_dealt - rest;
    s->budget.work += work == SMR_ENDLESS ? 0u : most;
}

/* Runs all tasks of a step of which none has begun. */
static void run_whole(smr *s, const smr_step *step, uint32_t n_tasks)
{
    const uint32_t bundle = pays(step, n_tasks) ? smr_max_u32(n_tasks / SMR_BUNDLES, 1u) : n_tasks;
    part_of_step part = {s, step, n_tasks, bundle, SMR_ENDLESS};
    s->refused |= !smr_fork(&s->port, run_bundle, &part, smr_ceil_div(n_tasks, bundle));
    s->next_task = n_tasks;
}

typedef struct watch {
    uint64_t deadline;   /* reading of the clock, ns, at which this tick must end; 0: no budget */
    uint64_t budget;     /* the tick's budget, ns; 0: none */
    uint64_t last;       /* last reading of the clock, ns */
    int begun;           /* 0: nothing has run yet. The first tasks always run: each tick makes progress */
    int current;         /* 1: nothing has run since the last reading */
    int back;            /* 1: at the last reading the clock had run backwards */
    smr_run_task *until; /* the tick ends before the step that runs this; NULL: none */
} watch;

static void read_clock(smr *s, watch *w)
{
    if (w->current)
        return;
    const uint64_t time = now(s);
    w->back = time < w->last;
    s->budget.odd |= (uint32_t)w->back;
    if (!w->back)
        smr_budget_spend(s, time - w->last, w->budget);
    w->last = time;
    w->current = 1;
}

/* Returns the number of tasks of the current step that a worker has begun or will run, and of all before them. */
static uint32_t tasks_begun(const smr *s)
{
    const smr_worker *w = s->shared.worker;
    return s->n_shares > 1u ? s->n_dealt : w->next + (w->pause.kept != 0u);
}

/* Leaves out the vertices whose search has not begun when more of them would exceed the time. */
static void cut(smr *s, const smr_step *step, const watch *w)
{
    const uint64_t left = w->deadline > w->last ? w->deadline - w->last : 0u;
    if (!smr_seeks_forces(step) || w->deadline == 0u)
        return;
    const uint32_t reached = tasks_begun(s) * smr_force_chunk(&s->forces);
    if (reached >= s->schedule.n_active || !smr_budget_reached(s, left, reached))
        return;
    s->schedule.n_active = reached;
    if (s->n_shares == 1u)
        s->n_dealt = s->shared.worker[0].end = tasks_begun(s);
    s->reference.stale = s->budget.cut = 1;
}

/* Returns the work of each worker until the next reading of the clock; 0: the tick ends. */
static uint32_t next_stretch(smr *s, watch *w, uint32_t n_tasks)
{
    if (w->deadline == 0u)
        return SMR_ENDLESS;
    read_clock(s, w);
    const uint64_t left = w->deadline > w->last ? w->deadline - w->last : 0u;
    const uint32_t work = smr_budget_stretch(s, left);
    const uint64_t ahead = smr_min_u64(smr_budget_ahead(s, n_tasks, work), w->budget / 4u);
    return w->begun && (w->back || left == 0u || ahead > left) ? 0u : work;
}

/* Runs the current step of n >= 1 tasks. SMR_PARTIAL: the budget ended. SMR_E_STATE: port or caller's force failed. */
static smr_status run_step(smr *s, const smr_step *step, uint32_t n, watch *w)
{
    const int whole = w->deadline == 0u && s->n_shares == 0u && step->order == SMR_ANY_ORDER;
    if (s->n_shares == 0u && !whole)
        begin_shares(s, step, n);
    while (s->next_task < n) {
        const uint32_t work = next_stretch(s, w, n);
        if (work == 0u)
            return SMR_PARTIAL;
        w->begun = 1;
        cut(s, step, w);
        w->current = 0;
        if (whole)
            run_whole(s, step, n);
        else
            run_shares(s, step, smr_step_tasks(s, step), work);
        if (s->refused || __atomic_load_n(&s->forces.caller.broken, __ATOMIC_RELAXED))
            return SMR_E_STATE;
        n = smr_step_tasks(s, step); /* fold steps get more tasks as they run, cut vertices take tasks away */
    }
    if (step->end != NULL) {
        if (next_stretch(s, w, n) == 0u) /* an end that passes over arrays adds to no stretch of tasks */
            return SMR_PARTIAL;
        w->begun = 1;
        w->current = 0;
        step->end(s);
    }
    s->next_task = s->n_shares = 0;
    return SMR_OK;
}

/* Fills s->report; smr_commit() has set the radius of a completed iteration. before: iterations before the tick. */
static void fill_report(smr *s, uint32_t before, uint64_t *phase_ns)
{
    smr_tick_report *r = &s->report;
    if (s->schedule.iteration == before) {
        r->details.radius = s->schedule.radius;
        r->details.radius_iteration = s->schedule.radius_iteration;
    }
    r->iteration = s->schedule.iteration;
    r->details.phase = s->step == 0u ? 0u : smr_steps[s->step].phase;
    r->details.n_guarded = s->folds.n_guarded;
    r->details.plastic_updates = s->schedule.plastic_updates;
    r->converged = s->schedule.converged;
    r->done = s->schedule.done;
    r->details.tracking = s->schedule.tracking;
    r->details.settled = s->schedule.settled && !s->schedule.changed;
    r->details.jumped = s->schedule.jumped;
    r->details.recovering = s->schedule.recovering == 1u;
    r->details.target_serial = s->schedule.serial;
    r->progress = smr_radius_progress(s);
    memcpy(r->details.phase_ns, phase_ns, sizeof r->details.phase_ns);
}

/* Returns the report for the caller: without measures of forces on former targets, which the log records. */
static smr_tick_report report_of(const smr *s)
{
    smr_tick_report r = s->report;
    if (!s->forces.unmeasured)
        return r;
    r.details.n_active = r.n_forces = r.details.n_rejected = r.converged = 0;
    r.details.attraction_used = 0.0f;
    r.details.matched_share = r.residual_mean_mm = r.details.residual_rms_mm = r.details.residual_max_mm = -1.0f;
    return r;
}

static watch begin(smr *s, uint64_t budget_ns)
{
    watch w = {0, 0, now(s), 0, 1, 0, NULL};
    const int timed = budget_ns != 0u && s->port.now_ns != NULL;
    if (s->step > 0u || s->next_task > 0u) {
        smr_budget_resume(s);
    } else if (!smr_idle(&s->schedule)) {
        smr_place_reset(s); /* a local volume that was left keeps its place in a worker */
        smr_schedule_begin(s);
        smr_budget_plan(s, timed ? budget_ns : UINT64_MAX);
    }
    if (timed) {
        w.budget = budget_ns;
        w.deadline = budget_ns > UINT64_MAX - w.last ? UINT64_MAX : w.last + budget_ns;
    }
    return w;
}

/* Runs steps until the iteration is complete, the budget is used up, w->until is next or a task is refused. */
static smr_status run_iteration(smr *s, watch *w, uint64_t *phase_ns)
{
    smr_status status = SMR_OK;
    for (; !smr_idle(&s->schedule) && s->step < smr_n_steps; s->step++) {
        const smr_step *step = &smr_steps[s->step];
        if (!smr_step_on(s, step))
            continue;
        if (step->run == w->until)
            return SMR_PARTIAL;
        const uint32_t n_tasks = smr_step_tasks(s, step);
        const uint64_t before = w->last;
        if (n_tasks > 0u)
            status = run_step(s, step, n_tasks, w);
        read_clock(s, w);
        phase_ns[step->phase] += w->last > before ? w->last - before : 0u;
        if (status != SMR_OK)
            return status;
        smr_budget_learn(s, n_tasks);
    }
    if (s->step == smr_n_steps) {
        smr_budget_done(s);
        s->step = 0;
    }
    return SMR_OK;
}

static void log_force_output(smr *s)
{
    smr_caller_goals *g = &s->forces.caller;
    g->reported_sum = g->summed ? g->sum : 0u;
    if (g->summed)
        smr_log_note(&s->log, SMR_LOG_FORCE, 2, &g->sum, 0);
    g->summed = 0;
}

static smr_status run_tick(smr *s, uint64_t budget_ns, smr_run_task *until, smr_tick_report *report)
{
    uint64_t phase_ns[SMR_PHASES] = {0};
    SMR_TRY(smr_sound(s));
    if (!smr_ready(s) || s->refused || s->forces.caller.broken)
        return SMR_E_STATE;
    SMR_TRY(smr_inputs_valid(&s->forces));
    if (s->scrub.calls != NULL)
        SMR_TRY(s->scrub.calls->slice(s, budget_ns));
    const uint32_t before = s->schedule.iteration;
    s->ticking = SMR_TICKING;
    if (!smr_idle(&s->schedule))
        smr_scrub_again(s);
    watch w = begin(s, budget_ns);
    w.until = until;
    const smr_status status = run_iteration(s, &w, phase_ns);
    s->ticking = 0;
    if (status < 0) {
        smr_guard_close(s);
        return status;
    }
    fill_report(s, before, phase_ns);
    if (status == SMR_OK)
        log_force_output(s);
    const smr_log_of_tick tick = {&s->report, status == SMR_OK,
                                  status == SMR_OK ? s->report.details.n_taken : smr_forces_evaluated(s)};
    smr_log_note(&s->log, SMR_LOG_TICK, 0, &tick, 0);
    smr_guard_close(s);
    if (report != NULL)
        *report = report_of(s);
    return status;
}

SMR_SELDOM smr_status smr_tick(smr *s, uint64_t budget_ns, smr_tick_report *report)
{
    return run_tick(s, budget_ns, NULL, report);
}

SMR_SELDOM smr_status smr_tick_until(smr *s, smr_run_task *run) { return run_tick(s, 0, run, NULL); }
