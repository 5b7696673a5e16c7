/* time_steps.c: dynamics by implicit Euler (paper 2.3, "when a dynamic aspect is desired"). A time step looks for the
 * positions with the least of
 *   Sum_j M_j / 2 h^2 |x_j - y_j|^2 + k / 2 Sum_i Sum_(j in zeta_i) m_j |x_j - T_i x^r_j|^2,  y = x + h v + h^2 g,
 * over x and the clusters' rigid transforms T_i (incremental potential; Martin et al. 2011), by turns: for fixed x the
 * T_i are the match, for fixed T_i each vertex goes to (y + h^2 k x~) / (1 + h^2 k), with x~ the average goal of the
 * iteration (local and global steps; Liu et al. 2013, Bouaziz et al. 2014; shape matching, Mueller et al. 2005). A turn
 * is a sweep, which is an iteration; so many make a step: then v = (x - x before) / h, less by damping.
 * The fits' weights are m_j = M_j / |zeta_j|. Then a sweep is a polynomial of one operator that is self-adjoint in the
 * masses M and lies between 0 and 1: it keeps linear and angular momentum, and however few the sweeps and however
 * stiff the springs, the step is that of implicit Euler with other springs, whose energy does not grow. What sweeps
 * have not reached is softer.
 * Bounds: a step ends with passes over the vertices that step_energy.c has in tasks; a start sums over the clusters.
 * SPDX-License-Identifier: MIT */
#include "runtime/tick/time_steps.h"

#include "runtime/tick/schedule.h"
#include "runtime/tick/step_energy.h"
#include "runtime/tick/tracking.h"

#define SMR_WEIGHT_UNIT 32.0f     /* of weights around 1: rounding takes 1.6 % of a mass at most */
#define SMR_WEIGHTS_SUM 262144.0f /* units of a cluster's members; more would make its centre coarse */
#define SMR_WEIGHT_MOST 1024.0f   /* of a vertex, times the mean */
#define SMR_PINNED_MOST 3.4e7f    /* of a pinned one */
#define SMR_PINNED_TIMES 8.0f     /* weight of as many pinned vertices as a cluster can have, in clusters' masses */

/* How many members each vertex' cluster has, fractions at the boundary included. Structures are mixed where
 * members are of others, which have another number: the sum of (number - own)^2 is not 0. */
static void count_members(smr *s)
{
    smr_sums *sums = &s->sums;
    smr_dynamics *d = s->shape.dynamics;
    memset(sums->record, 0, SMR_WORDS * (size_t)s->shared.n * sizeof *sums->record);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const uint32_t owner = smr_model_owner(s->shared.model, v);
        uint32_t *const record = sums->record + SMR_WORDS * (size_t)v;
        record[0] = SMR_BOUNDARY_UNITS;
        record[1] = SMR_BOUNDARY_UNITS * owner;
        record[2] = SMR_BOUNDARY_UNITS * owner * owner;
    }
    sums->words = 4;
    smr_block_pieces(sums, 0);
    for (uint32_t t = 0; t < smr_block_tasks(sums); t++)
        smr_sums_forest(sums, t, 0);
    for (uint32_t t = 0; t < smr_boundary_tasks(sums); t++)
        smr_boundary_sums(sums, t, 0);
    memset(d->mixed, 0, s->shared.n_structures * sizeof *d->mixed);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const uint32_t owner = smr_model_owner(s->shared.model, v), *const sum = sums->sum + SMR_WORDS * (size_t)v;
        d->members[v] = smr_max(smr_unfix(sum[0], 1.0f / (float)SMR_BOUNDARY_UNITS), 1.0f);
        d->mixed[owner] |= sum[2] - 2u * owner * sum[1] + owner * owner * sum[0] != 0u;
    }
}

static float rounded(float weight, float most, float unit)
{
    return smr_whole_number(smr_clamp(weight, 1.0f / unit, most) * unit) / unit;
}

/* Mean of mass over members, g, of the vertices that are not pinned. */
static float mean_of(const smr_dynamics *d, uint32_t n, uint32_t *n_pinned)
{
    float sum = 0.0f;
    *n_pinned = 0;
    for (uint32_t v = 0; v < n; v++) {
        *n_pinned += !(d->mass[v] > 0.0f);
        sum += d->mass[v] / d->members[v];
    }
    return *n_pinned < n ? sum / (float)(n - *n_pinned) : 1.0f;
}

/* Structures that share clusters or have pinned vertices are one group; the number of the first is the group's. */
static void group_structures(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    uint32_t first = s->shared.n_structures;
    for (uint32_t k = 0; k < s->shared.n_structures; k++) {
        const int joins = d->mixed[k] || smr_pinned_of(s, k) > 0u;
        first = joins ? smr_min_u32(first, k) : first;
        d->group[k] = joins ? first : k;
    }
}

/* A pinned vertex does not move for its clusters, and clusters turn about it: it weighs more than their others. */
void smr_time_steps_weigh(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    smr_shared *c = &s->shared;
    uint32_t n_pinned;
    float unit = SMR_WEIGHT_UNIT;
    const float mean = mean_of(d, c->n, &n_pinned), largest = (float)s->pace.lists.largest;
    while (unit > 1.0f && unit * largest > SMR_WEIGHTS_SUM)
        unit *= 0.5f;
    const uint32_t together = smr_min_u32(n_pinned, s->pace.lists.largest); /* no cluster has more pinned ones */
    const float pinned = SMR_PINNED_TIMES * largest / (float)smr_max_u32(together, 1u);
    d->gram = mean;
    c->mass_max = c->mass_sum = 0.0f;
    for (uint32_t v = 0; v < c->n; v++) {
        d->weight[v] = d->mass[v] > 0.0f ? rounded(d->mass[v] / d->members[v] / mean, SMR_WEIGHT_MOST, unit)
                                         : rounded(smr_max(pinned, 1.0f), SMR_PINNED_MOST, unit);
        c->mass_max = smr_max(c->mass_max, d->weight[v]);
        c->mass_sum += d->weight[v];
    }
    c->mass_unit = unit;
    c->mass = d->weight;
    s->reference.stale = 1;
    group_structures(s);
}

void smr_time_steps_start(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    const size_t bytes = 3u * (size_t)s->shared.n * sizeof(float);
    smr_schedule_radius(s, smr_tracking_radius(s));
    s->shape.rest_pose_due = 0;
    smr_plastic_positions(&s->shape);
    smr_held_start(&s->shape);
    memcpy(d->begin, s->shape.x, bytes);
    memset(d->velocity, 0, bytes);
    memset(&d->stored, 0, sizeof d->stored);
    memset(d->bent, 0, s->shared.n_structures * sizeof *d->bent);
    memset(d->spare, 0, s->shared.n_structures * sizeof *d->spare);
    d->weighed = 0;
    count_members(s);
    smr_time_steps_weigh(s);
}

void smr_time_steps_begin(smr *s)
{
    s->shape.held->due = 1;
    s->shape.dynamics->ends = (s->pace.iteration + 1u) % SMR_SWEEPS == 0u;
    s->reference.stale = 1;
}

void smr_time_steps_next(smr *s)
{
    if (s->shape.dynamics->ends)
        smr_step_velocities(s);
    smr_held_stand(&s->shape);
}
