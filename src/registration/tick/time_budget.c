/* time_budget.c: fits an iteration into a time budget. The port's clock gives each step's cost, in ns a unit of work.
 * The search for goals runs in the order of priority and keeps in reserve the predicted cost of the later steps. When
 * the remaining time falls to the reserve, the remaining vertices are left out of this iteration (paper 2.2, complexity
 * tuning). Later steps depend only on the number of active vertices, so smr_set_active() with this number gives the
 * same bits. If even the minimum set exceeds the budget, while costs are unknown, at the end of the schedule, and with
 * budget_exact, the iteration spans several ticks and skips nothing.
 * Bounds: SMR_STEPS_MAX, for each group of forces.
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_steps.h"

#define SMR_UNKNOWN (-1.0f)  /* rate of a step whose cost is not known yet */
#define SMR_FOREVER 1.0e18f  /* ns: stands for an unknown cost */
#define SMR_RISE 0.5f        /* weight of a measured cost above the rate in the new rate, a running mean */
#define SMR_FALL 0.125f      /* weight of a measured cost below the rate: the rate stays near the upper usual costs */
#define SMR_OUTLIER 0.0625f  /* largest excess of a measured time that counts, as a share of an iteration's time */
#define SMR_MARGIN_MIN 1.03f /* smallest factor on the predicted time kept in reserve */
#define SMR_MARGIN_MAX 1.5f  /* largest factor on the predicted time kept in reserve */
#define SMR_LATE 0.0625f     /* added to the factor on the reserve when an iteration did not end in its tick */
#define SMR_IN_TIME 0.001f   /* subtracted from the factor on the reserve per iteration in time: one in sixty is late */
#define SMR_STRETCH_NS 100000000u /* ns: a longer time between two readings, beyond the budget, is a jump */
#define SMR_READ_NS 15000.0f      /* ns of cluster sums between two readings of the clock by a fast processor */
#define SMR_FORK_NS 30000.0f      /* the same with several workers, where each parallel loop costs time */
#define SMR_PACE_MOST 4.0f        /* largest ratio of a measured time of an instruction to the mean that counts */
#define SMR_PART 0.3f             /* time of cluster sums / time of searches with as much work */
#define SMR_PACE_FAST 0.05f  /* ns an instruction of work below which a processor works longer than SMR_WORK_MOST */
#define SMR_WORK_LONG 4.0e6f /* most work between two readings of the clock, instructions */
#define SMR_COPY_COST 5000u  /* instructions of a task below which a step of unknown cost counts as free: a copy */
#define SMR_LOOK 16u         /* fewest vertices between two checks of the reserve */
#define SMR_CLOSING 3u       /* vertices may be left out only in the first 1 / SMR_CLOSING of the last radius */

void smr_budget_start(smr *s) /* all else is 0 */
{
    s->budget.margin = SMR_MARGIN_MIN;
    s->budget.pace = SMR_UNKNOWN;
    for (uint32_t i = 0; i < SMR_STEPS_MAX; i++)
        s->budget.rate[i] = SMR_UNKNOWN;
}

static float units_of(smr *s, const smr_step *step, uint32_t n_tasks)
{
    if (step->work == SMR_WORK_ACTIVE)
        return (float)s->schedule.n_active;
    if (step->work == SMR_WORK_FOLDS)
        return smr_fold_find_tasks(&s->folds) > 0u ? 1.0f : 0.0f;
    if (step->work != SMR_WORK_LISTS)
        return (float)n_tasks;
    const smr_lists *l = &s->schedule.lists; /* the whole order L counts: the active vertices' part is not known */
    return (float)s->shared.n + (float)smr_le32(l->block[l->n_blocks].first_index);
}

/* Returns the running mean `rate`, ns a unit of work, after one more sample. The sample is cut to twice the rate or the
 * rate plus SMR_OUTLIER of an iteration, whichever is more: other processes may have run. */
static float blend(const smr_time_budget *c, float rate, float sample, float units)
{
    if (rate < 0.0f)
        return sample;
    sample = smr_min(sample, rate + smr_max(rate, SMR_OUTLIER * c->whole / units));
    return rate + (sample > rate ? SMR_RISE : SMR_FALL) * (sample - rate);
}

/* Learns the time of an instruction of work from cluster sums, whose work is counted closely, but as if all vertices
 * were active: most, members / active vertices, is how much less there may have been. The counted work of other steps
 * is far too large for some tasks, which would make the next stretches too long. */
static void learn_pace(smr_time_budget *c, float ns, float most)
{
    const float sample = most * ns / (float)c->work;
    if (c->pace < 0.0f)
        c->pace = sample;
    else
        c->pace += (sample > c->pace ? SMR_RISE : SMR_FALL) * (smr_min(sample, SMR_PACE_MOST * c->pace) - c->pace);
}

void smr_budget_spend(smr *s, uint64_t ns, uint64_t budget_ns)
{
    smr_time_budget *c = &s->budget;
    const uint64_t most = budget_ns > SMR_STRETCH_NS ? budget_ns : SMR_STRETCH_NS;
    const float active = (float)smr_max_u32(s->schedule.n_active, 1u), members = (float)s->schedule.lists.members;
    if (c->work >= SMR_WORK_MOST / 4u && smr_steps[s->step].work == SMR_WORK_LISTS)
        learn_pace(c, (float)ns, smr_max(members / active, 1.0f));
    c->work = 0;
    c->spent += smr_min_u64(ns, smr_min_u64(most, UINT64_MAX - c->spent));
}

void smr_budget_learn(smr *s, uint32_t n_tasks)
{
    smr_time_budget *c = &s->budget;
    const smr_step *step = &smr_steps[s->step];
    const float spent = smr_min((float)c->spent, SMR_FOREVER), units = units_of(s, step, n_tasks);
    const int odd = c->odd != 0u || s->port.now_ns == NULL, none = n_tasks == 0u && step->work != SMR_WORK_FOLDS;
    c->sum += spent;
    c->spent = 0;
    c->odd = 0;
    if (odd || none || !(units > 0.0f))
        return;
    c->rate[s->step] = blend(c, c->rate[s->step], spent / units, units);
    if (step->work == SMR_WORK_LISTS)
        c->count = s->schedule.n_active;
}

/* Returns the cost, ns, assumed for a task of a step without a known cost: that of the most expensive known task. */
static float dearest(const smr_time_budget *c)
{
    float rate = SMR_UNKNOWN;
    for (uint32_t i = 0; i < smr_n_steps; i++)
        if (smr_steps[i].work != SMR_WORK_LISTS && smr_steps[i].phase != SMR_PHASE_FORCES)
            rate = smr_max(rate, c->rate[i] * (smr_steps[i].work == SMR_WORK_ACTIVE ? (float)SMR_CHUNK : 1.0f));
    return rate;
}

/* Returns the predicted cost, ns, of the steps from `first` on with `count` active vertices; SMR_FOREVER: unknown. */
static float cost_of(smr *s, uint32_t first, uint32_t count)
{
    const smr_time_budget *c = &s->budget;
    const uint32_t active = s->schedule.n_active, stale = s->reference.stale;
    const float unknown = dearest(c);
    const float more = c->count > 0u && count > c->count ? (float)count / (float)c->count : 1.0f;
    float sum = 0.0f;
    s->schedule.n_active = count;
    s->reference.stale = stale || count != active;
    for (uint32_t i = first; i < smr_n_steps; i++) {
        const smr_step *step = &smr_steps[i];
        const uint32_t n_tasks = smr_step_tasks(s, step);
        const float units = units_of(s, step, n_tasks);
        float rate = c->rate[i];
        if ((n_tasks == 0u && step->work != SMR_WORK_FOLDS) || !(units > 0.0f))
            continue;
        if (step->work == SMR_WORK_FOLDS || (step->cost > 0u && step->cost <= SMR_COPY_COST))
            rate = smr_max(rate, 0.0f);
        if (rate < 0.0f && step->work != SMR_WORK_LISTS)
            rate = step->work == SMR_WORK_ACTIVE ? unknown / (float)SMR_CHUNK : unknown;
        if (rate < 0.0f)
            sum = SMR_FOREVER;
        sum += rate * units * (step->work == SMR_WORK_LISTS ? more : 1.0f);
    }
    s->schedule.n_active = active;
    s->reference.stale = stale;
    return smr_min(smr_max(sum, 0.0f) * c->margin, SMR_FOREVER);
}

/* Returns the smallest number of active vertices that this radius, or the caller, allows. The schedule takes as many as
 * an image needs: with half of them, corresponding vertices are a fifth farther off. */
static uint32_t fewest(const smr *s)
{
    const int all = smr_image_on(&s->forces.image) && !smr_tracks(&s->schedule);
    return s->schedule.n_active_chosen > 0u || all
               ? s->schedule.n_active
               : smr_min_u32(smr_max_u32(s->schedule.lists.active_min, 1u), s->schedule.n_active);
}

void smr_budget_plan(smr *s, uint64_t budget_ns)
{
    const float cost = cost_of(s, 0, fewest(s));
    s->budget.spent = 0;
    s->budget.sum = 0.0f;
    s->budget.odd = s->budget.late = s->budget.look = 0;
    const int closing = smr_at_last_radius(&s->shared, &s->schedule) &&
                        SMR_CLOSING * s->schedule.radius_iteration >= s->shared.config.basic.iterations_last;
    s->budget.uncut = s->shared.config.basic.budget_exact || closing || cost > (float)budget_ns;
}

/* Returns the time of cluster sums between two readings of the clock, ns. */
static float between_readings(const smr *s) { return s->port.n_workers > 1u ? SMR_FORK_NS : SMR_READ_NS; }

uint32_t smr_budget_stretch(const smr *s, uint64_t left_ns)
{
    const float ns = smr_min(between_readings(s), (float)left_ns), pace = s->budget.pace;
    const int fast = pace > 0.0f && pace < SMR_PACE_FAST;
    return fast ? (uint32_t)smr_clamp(ns / pace, (float)SMR_WORK_MOST, SMR_WORK_LONG) : SMR_WORK_MOST;
}

uint64_t smr_budget_ahead(smr *s, uint32_t n_tasks, uint32_t work)
{
    const smr_step *step = &smr_steps[s->step];
    const float rate = s->budget.rate[s->step], pace = s->budget.pace;
    if (rate < 0.0f || n_tasks == 0u || pace < 0.0f || step->work == SMR_WORK_FOLDS)
        return 0;
    const float rest = rate * units_of(s, step, n_tasks) * (float)(n_tasks - s->next_task) / (float)n_tasks;
    return (uint64_t)smr_min(smr_min(rest, pace * (float)work / SMR_PART), SMR_FOREVER);
}

void smr_budget_resume(smr *s) { s->budget.late = !s->budget.uncut; }

void smr_budget_done(smr *s)
{
    smr_time_budget *c = &s->budget;
    const float whole = c->whole > 0.0f ? smr_min(c->sum, 2.0f * c->whole) : c->sum;
    c->whole += (c->whole > 0.0f ? SMR_FALL : 1.0f) * (whole - c->whole);
    for (uint32_t i = 0; i < smr_n_steps && c->repairing && s->schedule.repairing == 0u; i++)
        if (smr_steps[i].work == SMR_WORK_FOLDS)
            c->rate[i] = SMR_UNKNOWN; /* forgets the rate: repairs cost more than later iterations */
    c->repairing = s->schedule.repairing > 0u;
    c->margin = smr_clamp(c->margin + (c->late ? SMR_LATE : -SMR_IN_TIME), SMR_MARGIN_MIN, SMR_MARGIN_MAX);
}

int smr_budget_reached(smr *s, uint64_t left_ns, uint32_t reached)
{
    const float rate = smr_max(s->budget.rate[s->step], 0.0f);
    const float soon = between_readings(s) * (float)smr_max_u32(s->port.n_workers, 1u) / smr_max(rate, 1.0f);
    const uint32_t more = smr_max_u32((uint32_t)soon, SMR_LOOK);
    if (s->schedule.n_active_chosen > 0u || reached < fewest(s))
        return 0;
    if (s->schedule.repairing > 0u && !s->shared.config.basic.budget_exact)
        return 1; /* ends the searches of a repair, whose forces do not act; later iterations use the results */
    if (s->budget.uncut || reached < s->budget.look)
        return 0;
    s->budget.look = reached + more;
    const uint32_t next = smr_min_u32(reached + more, s->schedule.n_active);
    return rate * (float)(next - reached) + cost_of(s, s->step + 1u, next) > (float)left_ns;
}
