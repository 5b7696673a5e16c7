/* tick.c: one registration iteration, as the paper lists it at the end of section 2.3. The table is the method; the rest
 * keeps the time. A step is a number of independent tasks and a serial end; the clock is read between groups of tasks, and
 * a tick that runs out of time resumes at the task where it stopped. Only the last step's end makes new positions current.
 * SPDX-License-Identifier: MIT */
#include "runtime/record/log.h"

const smr_step smr_steps[] = {
    /* compute external forces f^e: the target's pull, smoothing, the way to the target in the order in which vertices matter */
    {SMR_PHASE_FORCES, SMR_WORK_TASKS, smr_pull_tasks, smr_pull_search, NULL, 0, NULL, NULL},
    {SMR_PHASE_FORCES, SMR_WORK_TASKS, smr_smooth_tasks, smr_smooth_sum, NULL, 0, smr_smooth_pieces,
     smr_smooth_abreast},
    {SMR_PHASE_FORCES, SMR_WORK_ACTIVE, smr_force_tasks, smr_force_search, NULL, 0, NULL, NULL},
    /* who takes part is known now */
    {SMR_PHASE_FORCES, SMR_WORK_TASKS, smr_vertex_tasks, smr_force_take, smr_force_end, 0, NULL, NULL},
    /* what x^r and they imply, when either is new: cluster centres, masses and spreads */
    {SMR_PHASE_SUMS, SMR_WORK_TASKS, smr_even_fit_tasks, smr_even_fit, smr_even_fit_end, 1, NULL, NULL},
    {SMR_PHASE_SUMS, SMR_WORK_TASKS, smr_reference_tasks, smr_reference_reach, smr_reference_begin, 0, NULL, NULL},
    {SMR_PHASE_SUMS, SMR_WORK_ACTIVE, smr_reference_records, smr_reference_record, NULL, 0, NULL, NULL},
    {SMR_PHASE_SUMS, SMR_WORK_LISTS, smr_reference_blocks, smr_sums_forest, NULL, 0, smr_block_pieces,
     smr_block_abreast},
    {SMR_PHASE_SUMS, SMR_WORK_TASKS, smr_boundary_reference_tasks, smr_boundary_reference, NULL, 1, NULL, NULL},
    {SMR_PHASE_SUMS, SMR_WORK_TASKS, smr_reference_clusters, smr_reference_cluster, smr_reference_end, 0, NULL, NULL},
    /* compute shape matching forces: for each cluster, T_i = argmin Sum m |T x^r - x - f^e|^2 */
    {SMR_PHASE_SUMS, SMR_WORK_ACTIVE, smr_active_tasks, smr_sums_record, NULL, 0, NULL, NULL},
    {SMR_PHASE_SUMS, SMR_WORK_LISTS, smr_block_tasks, smr_sums_forest, NULL, 0, smr_block_pieces, smr_block_abreast},
    {SMR_PHASE_SUMS, SMR_WORK_TASKS, smr_boundary_tasks, smr_boundary_sums, NULL, 1, NULL, NULL},
    {SMR_PHASE_MATCH, SMR_WORK_ACTIVE, smr_match_tasks, smr_match, smr_match_end, 0, NULL, NULL},
    /* average goal positions x~_i = Sum_i(T) x^r_i / |zeta_i| */
    {SMR_PHASE_AVERAGE, SMR_WORK_ACTIVE, smr_active_tasks, smr_average_record, NULL, 0, NULL, NULL},
    {SMR_PHASE_AVERAGE, SMR_WORK_LISTS, smr_block_tasks, smr_sums_forest, NULL, 0, smr_block_pieces, smr_block_abreast},
    {SMR_PHASE_AVERAGE, SMR_WORK_TASKS, smr_boundary_tasks, smr_boundary_sums, NULL, 1, NULL, NULL},
    /* evolve positions, x = x~; even out along the surface; hold back what would fold; update reference positions (plasticity),
     * x^r = x */
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_even_tasks, smr_even_clear, NULL, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_even_facet_tasks, smr_even_rings, NULL, 1, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_vertex_tasks, smr_evolve, smr_evolve_end, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_facet_tasks, smr_facet_refit, smr_facets_end, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_guard_tasks, smr_guard_search, smr_guard_end, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_FOLDS, smr_mend_tasks, smr_mend_pass, smr_mend_end, 1, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_FOLDS, smr_brake_tasks, smr_brake_pass, smr_mend_end, 1, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_FOLDS, smr_unfold_tasks, smr_unfold_pass, smr_mend_end, 1, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_FOLDS, smr_mend_facet_tasks, smr_facet_refit, smr_facets_end, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_vertex_tasks, smr_settle, smr_settle_end, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_exact_tasks, smr_exact_clear, NULL, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_exact_facet_tasks, smr_exact_facets, NULL, 1, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_exact_tasks, smr_exact_unit, NULL, 0, NULL, NULL},
    {SMR_PHASE_EVOLVE, SMR_WORK_TASKS, smr_stand_tasks, smr_stand, NULL, 1, NULL, NULL},
};

#define SMR_STEPS ((uint32_t)(sizeof smr_steps / sizeof smr_steps[0]))
_Static_assert(sizeof smr_steps / sizeof smr_steps[0] <= SMR_STEPS_MAX, "the controller's table is too short");
const uint32_t smr_n_steps = SMR_STEPS;

/* The iteration under way still looks at targets: what follows the forces has its own copies of them. */
int smr_forces_pending(const smr *s)
{
    for (uint32_t i = s->step; i < SMR_STEPS; i++)
        if (smr_steps[i].run == smr_force_take)
            return 1;
    return 0;
}

static uint64_t now(const smr *s) { return s->port.now_ns == NULL ? 0u : s->port.now_ns(s->port.ctx); }

/* `count` tasks of one step from `first` on, as a loop over bundles that counts from 0. Where no clock is watched tasks are
 * bundled: handing out one takes its time, too. */
typedef struct part_of_step {
    smr *s;
    smr_task run;
    uint32_t first, count, bundle;
} part_of_step;

#define SMR_BUNDLES 64u /* of a step, about */

static void run_bundle(void *arg, uint32_t bundle, uint32_t worker)
{
    const part_of_step *p = arg;
    const uint32_t last = smr_min_u32((bundle + 1u) * p->bundle, p->count);
    for (uint32_t task = bundle * p->bundle; task < last; task++)
        p->run(p->s, p->first + task, worker);
}

static void run_part(smr *s, const smr_step *step, uint32_t count, int timed)
{
    const uint32_t bundle = timed ? 1u : smr_max_u32(count / SMR_BUNDLES, 1u);
    part_of_step part = {s, step->run, s->next_task, count, bundle};
    smr_fork(&s->port, run_bundle, &part, smr_ceil_div(count, bundle));
    s->next_task += count;
}

/* A tick's time. */
typedef struct watch {
    uint64_t deadline; /* of this tick; 0: none */
    uint64_t budget;   /* ns; 0: none */
    uint64_t last;     /* reading */
    int begun;         /* the first group runs whatever the clock says: a tick always gets on */
} watch;

/* Reads the clock; returns 1 when the time is over, or will be after so many ns more. A clock that runs backwards ends the
 * tick, too. */
static int over(smr *s, watch *w, uint64_t ahead)
{
    const uint64_t time = now(s);
    const int back = time < w->last;
    s->control.odd |= (uint32_t)back;
    if (!back)
        smr_control_spend(s, time - w->last, w->budget);
    w->last = time;
    return back || time >= w->deadline || ahead > w->deadline - time;
}

/* 1 when the vertices from the next task on must be ignored, so that the iteration ends in time. */
static int cut(smr *s, const smr_step *step, const watch *w, uint32_t group)
{
    const uint64_t left = w->deadline > w->last ? w->deadline - w->last : 0u;
    if (step->run != smr_force_search || w->deadline == 0u || !smr_control_reached(s, left, group))
        return 0;
    s->n_active = s->next_task * smr_force_chunk(s);
    s->reference_stale = s->control.cut = 1;
    return 1;
}

/* Runs the current step; returns 0 when the deadline passed before its last task. */
static int run_step(smr *s, const smr_step *step, watch *w)
{
    uint32_t n = step->n_tasks(s);
    const uint32_t group = step->serial ? 1u : (w->deadline == 0u ? n : smr_control_group(s, n));
    const uint64_t ahead = w->deadline == 0u ? 0u : smr_min_u64(smr_control_ahead(s, n, group), w->budget / 4u);
    for (; s->next_task < n; n = step->n_tasks(s)) { /* what folds asks for more as it goes */
        if (w->deadline != 0u && w->begun && over(s, w, ahead))
            return 0;
        w->begun = 1;
        if (cut(s, step, w, group))
            break;
        uint32_t count = smr_min_u32(group, n - s->next_task);
        if (step->abreast != NULL) /* the next pieces need the ones before */
            count = smr_min_u32(count, step->abreast(s) - s->next_task % step->abreast(s));
        run_part(s, step, count, w->deadline != 0u);
    }
    if (n > 0u && step->end != NULL)
        step->end(s);
    s->next_task = 0;
    return 1;
}

static void fill_report(smr *s, uint64_t *phase_ns)
{
    smr_tick_report *r = &s->report;
    r->iteration = s->iteration;
    r->phase = s->step == 0u ? 0u : smr_steps[s->step].phase;
    r->radius = s->radius;
    r->radius_iteration = s->radius_iteration;
    r->n_guarded = s->n_guarded;
    r->plastic_updates = s->plastic_updates;
    r->converged = s->converged;
    r->done = s->done;
    r->progress = smr_schedule_progress(s);
    memcpy(r->phase_ns, phase_ns, sizeof r->phase_ns);
}

/* Every target surface is still the one that was set. */
static int targets_stand(const smr *s)
{
    for (uint32_t g = 0; g < s->n_goals; g++)
        if (!smr_surface_valid(s->goal[g].surface) || s->goal[g].surface->n_vertices != s->goal[g].n_vertices)
            return 0;
    return 1;
}

static uint64_t later(uint64_t time, uint64_t ns) { return ns > UINT64_MAX - time ? UINT64_MAX : time + ns; }

/* What comes before an iteration, and the time of this tick. */
static watch begin(smr *s, uint64_t budget_ns)
{
    watch w = {0, 0, now(s), 0};
    const int timed = budget_ns != 0u && s->port.now_ns != NULL;
    if (s->step > 0u || s->next_task > 0u) {
        smr_control_resume(s);
    } else if (!s->done) {
        smr_schedule_active(s);
        s->report.n_taken = s->n_active;
        smr_schedule_distances(s);
        smr_control_plan(s, timed ? budget_ns : UINT64_MAX);
    }
    if (timed) {
        w.budget = budget_ns;
        w.deadline = later(w.last, budget_ns);
    }
    return w;
}

smr_status smr_tick(smr *s, uint64_t budget_ns, smr_tick_report *report)
{
    uint64_t phase_ns[SMR_PHASES] = {0};
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s) || !targets_stand(s))
        return SMR_E_STATE;
    smr_status status = SMR_OK;
    watch w = begin(s, budget_ns);
    for (; !s->done && s->step < SMR_STEPS; s->step++) {
        const smr_step *step = &smr_steps[s->step];
        if (s->next_task == 0u && step->pieces != NULL)
            step->pieces(s, w.deadline != 0u);
        const uint32_t n_tasks = step->n_tasks(s);
        const uint64_t before = w.last;
        if (!run_step(s, step, &w))
            status = SMR_PARTIAL;
        (void)over(s, &w, 0);
        phase_ns[step->phase] += w.last > before ? w.last - before : 0u;
        if (status == SMR_PARTIAL)
            break;
        smr_control_learn(s, n_tasks);
    }
    if (s->step == SMR_STEPS) {
        smr_control_done(s);
        s->step = 0;
    }
    fill_report(s, phase_ns);
    smr_log_tick(s, status);
    if (report != NULL)
        *report = s->report;
    return status;
}
