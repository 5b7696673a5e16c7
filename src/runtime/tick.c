/* tick.c: one registration iteration, as the paper lists it at the end of section 2.3. The table is the method; the rest
 * keeps the time. A step is a number of independent tasks and a serial end; the clock is read between groups of tasks, and
 * a tick that runs out of time resumes at the task where it stopped. Only the last step's end makes new positions current.
 * SPDX-License-Identifier: MIT */
#include "runtime/state.h"

static const smr_step steps[] = {
    /* what x^r implies, when it is new: cluster centres, masses and spreads */
    {SMR_PHASE_SUMS, smr_reference_records, smr_reference_record, NULL},
    {SMR_PHASE_SUMS, smr_reference_blocks, smr_sums_forest, NULL},
    {SMR_PHASE_SUMS, smr_reference_tasks, smr_reference_cluster, smr_reference_end},
    /* compute external forces f^e: the target's pull, smoothing, and the way to the target */
    {SMR_PHASE_FORCES, smr_pull_tasks, smr_pull_search, NULL},
    {SMR_PHASE_FORCES, smr_smooth_tasks, smr_smooth_sum, NULL},
    {SMR_PHASE_FORCES, smr_vertex_tasks, smr_force_search, smr_force_end},
    /* compute shape matching forces: for each cluster, T_i = argmin Sum m |T x^r - x - f^e|^2 */
    {SMR_PHASE_SUMS, smr_active_tasks, smr_sums_record, NULL},
    {SMR_PHASE_SUMS, smr_block_tasks, smr_sums_forest, NULL},
    {SMR_PHASE_MATCH, smr_active_tasks, smr_match, smr_match_end},
    /* average goal positions x~_i = Sum_i(T) x^r_i / |zeta_i| */
    {SMR_PHASE_AVERAGE, smr_active_tasks, smr_average_record, NULL},
    {SMR_PHASE_AVERAGE, smr_block_tasks, smr_sums_forest, smr_even_rings},
    /* evolve positions, x = x~; even out along the surface; hold back what would fold; update reference positions (plasticity),
     * x^r = x */
    {SMR_PHASE_EVOLVE, smr_vertex_tasks, smr_evolve, smr_evolve_end},
    {SMR_PHASE_EVOLVE, smr_facet_tasks, smr_facet_refit, smr_facets_end},
    {SMR_PHASE_EVOLVE, smr_guard_tasks, smr_guard_search, smr_guard_end},
    {SMR_PHASE_EVOLVE, smr_vertex_tasks, smr_settle, smr_settle_end},
};

#define SMR_STEPS ((uint32_t)(sizeof steps / sizeof steps[0]))

/* The iteration under way still looks at targets: what follows the forces has its own copies of them. */
int smr_forces_pending(const smr *s)
{
    for (uint32_t i = s->step; i < SMR_STEPS; i++)
        if (steps[i].run == smr_force_search)
            return 1;
    return 0;
}

static uint64_t now(const smr *s) { return s->port.now_ns == NULL ? 0u : s->port.now_ns(s->port.ctx); }

/* Tasks of one step from `first` on, as a loop that counts from 0. */
typedef struct part_of_step {
    smr *s;
    smr_task run;
    uint32_t first;
} part_of_step;

static void run_task(void *arg, uint32_t task, uint32_t worker)
{
    const part_of_step *p = arg;
    p->run(p->s, p->first + task, worker);
}

/* Runs the current step; returns 0 when the deadline passed before its last task. deadline 0: none. The tick's first group
 * (*begun 0) runs whatever the clock says: a tick always gets on, however short its budget or coarse its clock. */
static int run_step(smr *s, const smr_step *step, uint64_t deadline, int *begun)
{
    const uint32_t n = step->n_tasks(s);
    const uint32_t group = deadline == 0u ? n : (s->port.n_workers > 1u ? s->port.n_workers : 1u);
    while (s->next_task < n) {
        if (deadline != 0u && *begun && now(s) >= deadline)
            return 0;
        *begun = 1;
        part_of_step part = {s, step->run, s->next_task};
        const uint32_t count = smr_min_u32(group, n - s->next_task);
        smr_fork(&s->port, run_task, &part, count);
        s->next_task += count;
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
    r->phase = s->step == 0u ? 0u : steps[s->step].phase;
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

smr_status smr_tick(smr *s, uint64_t budget_ns, smr_tick_report *report)
{
    uint64_t phase_ns[SMR_PHASES] = {0};
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s) || !targets_stand(s))
        return SMR_E_STATE;
    uint64_t time = now(s);
    const int timed = budget_ns != 0u && s->port.now_ns != NULL;
    const uint64_t deadline = !timed ? 0u : (budget_ns > UINT64_MAX - time ? UINT64_MAX : time + budget_ns);
    int begun = 0;
    smr_status status = SMR_OK;
    if (s->step == 0u && s->next_task == 0u && !s->done)
        smr_schedule_active(s);
    if (s->reference_stale && s->step == 0u && s->next_task == 0u)
        smr_reference_begin(s);
    if (s->step == 0u && s->next_task == 0u)
        smr_schedule_distances(s);
    for (; !s->done && s->step < SMR_STEPS; s->step++) {
        const smr_step *step = &steps[s->step];
        if (!run_step(s, step, deadline, &begun))
            status = SMR_PARTIAL;
        const uint64_t after = now(s);
        phase_ns[step->phase] += after > time ? after - time : 0u;
        time = after;
        if (status == SMR_PARTIAL)
            break;
    }
    if (s->step == SMR_STEPS)
        s->step = 0;
    fill_report(s, phase_ns);
    if (report != NULL)
        *report = s->report;
    return status;
}
