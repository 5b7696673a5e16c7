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
#include "options/dynamics/dynamics.h"
#include "registration/convergence.h"
#include "registration/radius.h"

#define SMR_WEIGHT_UNIT 32.0f     /* of weights around 1: rounding takes 1.6 % of a mass at most */
#define SMR_WEIGHTS_SUM 262144.0f /* units of a cluster's members; more would make its centre coarse */
#define SMR_WEIGHT_MOST 1024.0f   /* of a vertex, times the mean */
#define SMR_PINNED_MOST 3.4e7f    /* of a pinned one */
#define SMR_PINNED_TIMES 8.0f     /* weight of as many pinned vertices as a cluster can have, in clusters' masses */

/* Sums of records over clusters. */
static void sum_records(smr *s, uint32_t words)
{
    smr_sums *sums = &s->sums;
    sums->words = words;
    smr_block_pieces(sums, 0);
    for (uint32_t t = 0; t < smr_block_tasks(sums); t++)
        smr_sums_forest(sums, t, 0);
    for (uint32_t t = 0; t < smr_boundary_tasks(sums); t++)
        smr_boundary_sums(sums, t, 0);
}

/* Marks the vertices of structures from `first` on, as many as a record has words: each has its own. */
static void mark_owners(smr *s, uint32_t first)
{
    uint32_t *const record = s->sums.record;
    memset(record, 0, SMR_WORDS * (size_t)s->shared.n * sizeof *record);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const uint32_t at = smr_model_owner(s->shared.model, v) - first;
        if (at < SMR_WORDS)
            record[SMR_WORDS * (size_t)v + at] = SMR_BOUNDARY_UNITS;
    }
}

static void join(uint32_t *group, uint32_t n, uint32_t a, uint32_t b)
{
    const uint32_t first = smr_min_u32(group[a], group[b]), other = group[a] + group[b] - first;
    for (uint32_t k = 0; other != first && k < n; k++)
        group[k] = group[k] == other ? first : group[k];
}

/* How many members each vertex' cluster has, fractions at the boundary included. Structures that share clusters, with
 * each other or by way of others, are one group; the number of the first is the group's. */
static void count_members(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    const uint32_t n_structures = s->shared.n_structures;
    memset(d->members, 0, s->shared.n * sizeof *d->members);
    for (uint32_t k = 0; k < n_structures; k++)
        d->group[k] = k;
    for (uint32_t first = 0; first < n_structures; first += SMR_WORDS) {
        const uint32_t words = smr_min_u32(SMR_WORDS, n_structures - first);
        mark_owners(s, first);
        sum_records(s, SMR_WORDS);
        for (uint32_t v = 0; v < s->shared.n; v++) {
            const uint32_t *const sum = s->sums.sum + SMR_WORDS * (size_t)v;
            for (uint32_t i = 0; i < words; i++) {
                d->members[v] += smr_unfix(sum[i], 1.0f / (float)SMR_BOUNDARY_UNITS);
                if (smr_signed(sum[i]) > 0)
                    join(d->group, n_structures, smr_model_owner(s->shared.model, v), first + i);
            }
        }
    }
    for (uint32_t v = 0; v < s->shared.n; v++)
        d->members[v] = smr_max(d->members[v], 1.0f);
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
}

void smr_time_steps_start(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    const size_t bytes = 3u * (size_t)s->shared.n * sizeof(float);
    smr_radius_go(s, smr_radius_after(s));
    s->shape.rest_pose_due = 0;
    smr_plastic_positions(&s->shape);
    smr_held_start(&s->shape);
    s->shape.held->to = smr_dynamics_ahead;
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
    s->shape.from = s->shape.x_next;
    s->shape.dynamics->ends = (s->pace.iteration + 1u) % SMR_SWEEPS == 0u;
    s->reference.stale = 1;
}

uint32_t smr_sweep_tasks(const void *arg) { return ((const smr *)arg)->shared.n_tasks; }

void smr_sweep_begin(void *arg, uint32_t task, uint32_t worker)
{
    const smr *s = arg;
    (void)worker;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(&s->shared, task); v++)
        smr_store(smr_at3(s->shape.from, v),
                  smr_dynamics_from(s->shape.dynamics, &s->pace, v, smr_load(smr_at3(s->shape.x, v))));
}

/* Where the springs to the clusters' average and to its goal take a vertex; evolve has left the average in x_next. */
void smr_sweep_end(void *arg, uint32_t task, uint32_t worker)
{
    const smr *s = arg;
    (void)worker;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(&s->shared, task); v++) {
        float *const x_next = smr_at3(s->shape.x_next, v);
        const int drawn = s->forces.found_last[v] == SMR_FOUND_GOAL;
        const float share = drawn ? s->shared.config.forces.stiffness : 0.0f;
        const smr_vec x = smr_load(smr_at3(s->shape.x, v));
        const smr_vec pull = smr_add(smr_scale(x, share), smr_load(smr_at3(s->forces.force, v)));
        smr_store(x_next,
                  smr_dynamics_next(s->shape.dynamics, v, smr_load(x_next), share, drawn ? pull : smr_v(0, 0, 0)));
    }
}

void smr_time_steps_next(smr *s)
{
    if (s->shape.dynamics->ends)
        smr_step_velocities(s);
    smr_held_stand(&s->shape);
}
