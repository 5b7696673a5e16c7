/* tick.c: runs the steps of an iteration and watches the time. A step has independent tasks and a serial end. The tick
 * reads the clock between groups of tasks; after the end of the budget the next tick resumes at the next task.
 * Bounds: those of the steps.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"

static uint64_t now(const smr *s) { return s->port.now_ns == NULL ? 0u : s->port.now_ns(s->port.ctx); }

/* A loop over `count` tasks of one step from `first` on, in bundles of tasks. Bundles save time between tasks. */
typedef struct part_of_step {
    void *stage;
    smr_task run;
    uint32_t first, count, bundle;
} part_of_step;

#define SMR_BUNDLES 64u /* about the number of bundles into which the tasks of a step are divided */

static void run_bundle(void *arg, uint32_t bundle, uint32_t worker)
{
    const part_of_step *p = arg;
    const uint32_t last = smr_min_u32((bundle + 1u) * p->bundle, p->count);
    for (uint32_t task = bundle * p->bundle; task < last; task++)
        p->run(p->stage, p->first + task, worker);
}

static void run_part(smr *s, const smr_step *step, uint32_t count, int timed)
{
    const uint32_t bundle = timed ? 1u : smr_max_u32(count / SMR_BUNDLES, 1u);
    part_of_step part = {smr_stage_of(s, step), step->run, s->next_task, count, bundle};
    s->refused |= !smr_fork(&s->port, run_bundle, &part, smr_ceil_div(count, bundle));
    s->next_task += count;
}

typedef struct watch {
    uint64_t deadline; /* reading of the clock, ns, at which this tick must end; 0: no budget */
    uint64_t budget;   /* the tick's budget, ns; 0: none */
    uint64_t last;     /* last reading of the clock, ns */
    int begun;         /* 0: no group of tasks has run yet. The first one always runs: each tick makes progress */
} watch;

/* Reads the clock. Returns 1 when the budget ends within `ahead` ns, or the clock has run backwards. */
static int over(smr *s, watch *w, uint64_t ahead)
{
    const uint64_t time = now(s);
    const int back = time < w->last;
    s->budget.odd |= (uint32_t)back;
    if (!back)
        smr_budget_spend(s, time - w->last, w->budget);
    w->last = time;
    return back || time >= w->deadline || ahead > w->deadline - time;
}

/* Returns 1 when more vertices would exceed the time: sets n_active to the number of vertices searched so far. */
static int cut(smr *s, const smr_step *step, const watch *w, uint32_t group)
{
    const uint64_t left = w->deadline > w->last ? w->deadline - w->last : 0u;
    if (!smr_seeks_forces(step) || w->deadline == 0u || !smr_budget_reached(s, left, group))
        return 0;
    s->schedule.n_active = s->next_task * smr_force_chunk(&s->forces);
    s->reference.stale = s->budget.cut = 1;
    return 1;
}

/* Runs the current step of n >= 1 tasks. SMR_PARTIAL: the budget ended. SMR_E_STATE: port or caller's force failed. */
static smr_status run_step(smr *s, const smr_step *step, uint32_t n, watch *w)
{
    const uint32_t group = step->order != SMR_ANY_ORDER ? 1u : (w->deadline == 0u ? n : smr_budget_group(s, n));
    const uint64_t ahead = w->deadline == 0u ? 0u : smr_min_u64(smr_budget_ahead(s, n, group), w->budget / 4u);
    for (; s->next_task < n; n = smr_step_tasks(s, step)) { /* fold steps get more tasks as they run */
        if (w->deadline != 0u && w->begun && over(s, w, ahead))
            return SMR_PARTIAL;
        w->begun = 1;
        if (cut(s, step, w, group))
            break;
        uint32_t count = smr_min_u32(group, n - s->next_task);
        if (step->abreast != NULL) { /* the next pieces need the results of the current ones */
            const uint32_t abreast = step->abreast(smr_stage_of(s, step));
            count = smr_min_u32(count, abreast - s->next_task % abreast);
        }
        run_part(s, step, count, w->deadline != 0u);
        if (s->refused || __atomic_load_n(&s->forces.caller.broken, __ATOMIC_RELAXED))
            return SMR_E_STATE;
    }
    if (step->end != NULL)
        step->end(s);
    s->next_task = 0;
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
    watch w = {0, 0, now(s), 0};
    const int timed = budget_ns != 0u && s->port.now_ns != NULL;
    if (s->step > 0u || s->next_task > 0u) {
        smr_budget_resume(s);
    } else if (!smr_idle(&s->schedule)) {
        smr_schedule_begin(s);
        smr_budget_plan(s, timed ? budget_ns : UINT64_MAX);
    }
    if (timed) {
        w.budget = budget_ns;
        w.deadline = budget_ns > UINT64_MAX - w.last ? UINT64_MAX : w.last + budget_ns;
    }
    return w;
}

/* Runs steps until the iteration is complete, the budget is used up or a task is refused. */
static smr_status run_iteration(smr *s, watch *w, uint64_t *phase_ns)
{
    smr_status status = SMR_OK;
    for (; !smr_idle(&s->schedule) && s->step < smr_n_steps; s->step++) {
        const smr_step *step = &smr_steps[s->step];
        if (!smr_step_on(s, step))
            continue;
        if (s->next_task == 0u && step->pieces != NULL)
            step->pieces(smr_stage_of(s, step), w->deadline != 0u);
        const uint32_t n_tasks = smr_step_tasks(s, step);
        const uint64_t before = w->last;
        if (n_tasks > 0u)
            status = run_step(s, step, n_tasks, w);
        (void)over(s, w, 0);
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

/* Logs the checksum of the output of the caller's force in the completed iteration. */
static void log_force_output(smr *s)
{
    smr_caller_goals *g = &s->forces.caller;
    g->reported_sum = g->summed ? g->sum : 0u;
    if (g->summed)
        smr_log_note(&s->log, SMR_LOG_FORCE, 2, &g->sum, 0);
    g->summed = 0;
}

smr_status smr_tick(smr *s, uint64_t budget_ns, smr_tick_report *report)
{
    uint64_t phase_ns[SMR_PHASES] = {0};
    SMR_TRY(smr_sound(s));
    if (!smr_ready(s) || s->refused || s->forces.caller.broken)
        return SMR_E_STATE;
    SMR_TRY(smr_inputs_valid(&s->forces));
    if (s->scrub.calls != NULL)
        SMR_TRY(s->scrub.calls->slice(s, budget_ns));
    const uint32_t before = s->schedule.iteration;
    s->ticking = 1;
    if (!smr_idle(&s->schedule))
        smr_scrub_again(s);
    watch w = begin(s, budget_ns);
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
