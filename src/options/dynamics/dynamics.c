/* dynamics.c: dynamics by implicit Euler (paper 2.3, "when a dynamic aspect is desired"). A time step minimises
 *   Sum_j M_j / 2 h^2 |x_j - y_j|^2 + k / 2 Sum_i Sum_(j in zeta_i) m_j |x_j - T_i x^r_j|^2,  y = x + h v + h^2 g,
 * over x and the clusters' rigid transforms T_i in turn (incremental potential; Martin et al. 2011): for fixed x the
 * T_i are the match, for fixed T_i each vertex moves to (y + h^2 k x~) / (1 + h^2 k), with x~ the average goal (local
 * and global steps; Liu et al. 2013, Bouaziz et al. 2014; shape matching, Mueller et al. 2005). Both are a sweep, which
 * is an iteration. SMR_SWEEPS sweeps are a time step, after which v = (x - x before) / h. Damping by the force -c M v
 * divides h v, h^2 g and h^2 k by 1 + h c, as implicit Euler does.
 * The fits' weights are m_j = M_j / |zeta_j|. A sweep then is a polynomial of one operator, self-adjoint in the masses
 * M and between 0 and 1. It conserves linear and angular momentum, and for any number of sweeps and any stiffness the
 * step is one of implicit Euler with softer springs, whose energy does not grow.
 * Bounds: a step ends with passes over the vertices in tasks; members and weights are found by smr_init(), in pieces.
 * SPDX-License-Identifier: MIT */
#include "options/dynamics/dynamics.h"
#include "registration/schedule_radius.h"

#define SMR_WEIGHT_UNIT 32.0f     /* units in a weight of 1: rounding to 1 / 32 changes the weight by at most 1.6 % */
#define SMR_WEIGHTS_SUM 262144.0f /* largest sum of a cluster's weights, in units: larger sums make centres inexact */
#define SMR_WEIGHT_MOST 1024.0f   /* largest weight in fits of a vertex that is not pinned; the mean weight is 1 */
#define SMR_PINNED_MOST 3.4e7f    /* largest weight in fits of a pinned vertex */
#define SMR_PINNED_TIMES 8.0f     /* weight of all pinned vertices in a cluster / weight of the largest cluster */

void smr_dynamics_layout(smr_arena *a, smr_dynamics **dynamics, const smr_shared *shared)
{
    const size_t n = shared->n;
    smr_dynamics none = {0}, *d = &none;
    if (!shared->config.dynamics.mode)
        return;
    *dynamics = smr_slot_scratch(a, *dynamics, 1, sizeof **dynamics);
    if (*dynamics != NULL)
        d = *dynamics;
    d->begin = smr_slot_floats(a, d->begin, 3u * n, SMR_KEPT_MM);
    d->velocity = smr_slot_floats(a, d->velocity, 3u * n, SMR_SPEED_MOST);
    d->mass = smr_slot_floats(a, d->mass, n, SMR_MASS_MOST);
    d->members = smr_slot_scratch(a, d->members, n, sizeof(float));
    d->group = smr_slot_scratch(a, d->group, shared->n_structures, sizeof *d->group);
    d->sums = smr_slot_scratch(a, d->sums, shared->n_structures, sizeof *d->sums);
    d->bent = smr_slot_floats(a, d->bent, shared->n_structures, SMR_STORED_MOST);
    d->spare = smr_slot_floats(a, d->spare, shared->n_structures, SMR_STORED_MOST);
    d->weight = smr_slot_scratch(a, d->weight, n, sizeof(float));
    smr_keep_floats(a, &d->stored.elastic, 1, 0.0f, SMR_STORED_MOST);
    smr_keep_floats(a, &d->stored.goals, 1, 0.0f, SMR_STORED_MOST);
    smr_keep_words(a, &d->weighed, 1, 1);
}

void smr_dynamics_wire(smr_dynamics *d, const smr_shared *shared)
{
    const smr_config *c = &shared->config;
    d->step_s = 0.001f * c->dynamics.step_ms;
    d->keeps = 1.0f / (1.0f + c->dynamics.damping * d->step_s);
    d->springs = c->dynamics.elastic * d->step_s * d->step_s * d->keeps;
    d->fall = smr_scale(smr_load(c->dynamics.gravity), d->step_s * d->step_s * d->keeps);
}

void smr_members_begin(smr *s)
{
    s->sums.words = SMR_WORDS;
    for (uint32_t k = 0; k < s->shared.n_structures; k++)
        s->shape.dynamics->group[k] = k;
}

void smr_members_mark(smr *s, uint32_t structure, smr_piece p)
{
    uint32_t *const record = s->sums.record + SMR_WORDS * (size_t)p.first;
    memset(record, 0, SMR_WORDS * (size_t)(p.last - p.first) * sizeof *record);
    for (uint32_t v = p.first; v < p.last; v++) {
        const uint32_t at = smr_model_owner(s->shared.model, v) - structure;
        if (at < SMR_WORDS)
            s->sums.record[SMR_WORDS * (size_t)v + at] = SMR_BOUNDARY_UNITS;
    }
}

/* Merges the groups of structures a and b into one. */
static void join(uint32_t *group, uint32_t n, uint32_t a, uint32_t b)
{
    const uint32_t first = smr_min_u32(group[a], group[b]), other = group[a] + group[b] - first;
    for (uint32_t k = 0; other != first && k < n; k++)
        group[k] = group[k] == other ? first : group[k];
}

void smr_members_add(smr *s, uint32_t structure, smr_piece p)
{
    smr_dynamics *d = s->shape.dynamics;
    const uint32_t n = s->shared.n_structures, words = smr_min_u32(SMR_WORDS, n - structure);
    for (uint32_t v = p.first; v < p.last; v++) {
        const uint32_t *const sum = s->sums.sum + SMR_WORDS * (size_t)v;
        for (uint32_t i = 0; i < words; i++) {
            d->members[v] += smr_unfix(sum[i], 1.0f / (float)SMR_BOUNDARY_UNITS);
            if (smr_signed(sum[i]) > 0)
                join(d->group, n, smr_model_owner(s->shared.model, v), structure + i);
        }
        if (structure + words == n)
            d->members[v] = smr_max(d->members[v], 1.0f);
    }
}

/* Returns the weight, limited to 1 / unit .. most and rounded to a multiple of 1 / unit. */
static float rounded(float weight, float most, float unit)
{
    return smr_whole_number(smr_clamp(weight, 1.0f / unit, most) * unit) / unit;
}

void smr_weights_add(smr *s, smr_piece p)
{
    smr_dynamics *d = s->shape.dynamics;
    if (p.first == 0u) {
        d->gram = 0.0f;
        d->n_pinned = 0;
    }
    for (uint32_t v = p.first; v < p.last; v++) {
        d->n_pinned += !(d->mass[v] > 0.0f);
        d->gram += d->mass[v] / d->members[v];
    }
    if (p.last == s->shared.n)
        d->gram = d->n_pinned < s->shared.n ? d->gram / (float)(s->shared.n - d->n_pinned) : 1.0f;
}

SMR_SELDOM void smr_weights_set(smr *s, smr_piece p)
{
    smr_dynamics *d = s->shape.dynamics;
    smr_shared *c = &s->shared;
    float unit = SMR_WEIGHT_UNIT;
    const float largest = (float)s->schedule.lists.largest;
    while (unit > 1.0f && unit * largest > SMR_WEIGHTS_SUM)
        unit *= 0.5f;
    const uint32_t together = smr_min_u32(d->n_pinned, s->schedule.lists.largest); /* pinned vertices in a cluster */
    const float pinned = SMR_PINNED_TIMES * largest / (float)smr_max_u32(together, 1u);
    if (p.first == 0u)
        c->mass_max = c->mass_sum = 0.0f;
    for (uint32_t v = p.first; v < p.last; v++) {
        d->weight[v] = d->mass[v] > 0.0f ? rounded(d->mass[v] / d->members[v] / d->gram, SMR_WEIGHT_MOST, unit)
                                         : rounded(smr_max(pinned, 1.0f), SMR_PINNED_MOST, unit);
        c->mass_max = smr_max(c->mass_max, d->weight[v]);
        c->mass_sum += d->weight[v];
    }
    c->mass_unit = unit;
    c->mass = d->weight;
    s->reference.stale = 1;
}

void smr_time_steps_copy(smr *s, smr_piece p)
{
    const size_t first = 3u * (size_t)p.first, bytes = 3u * (size_t)(p.last - p.first) * sizeof(float);
    const float *const x = s->shape.x + first;
    memcpy(s->shape.x_ref + first, x, bytes);
    memcpy(s->shape.track_rest_x + first, x, bytes);
    memcpy(s->shape.dynamics->begin + first, x, bytes);
    memset(s->shape.dynamics->velocity + first, 0, bytes);
}

void smr_time_steps_start(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    smr_radius_go(s, smr_radius_after(s));
    s->shape.rest_pose_due = 0;
    smr_track_rest_poses(&s->shape);
    s->shape.track_rest->to = smr_dynamics_ahead;
    memset(&d->stored, 0, sizeof d->stored);
    memset(d->bent, 0, s->shared.n_structures * sizeof *d->bent);
    memset(d->spare, 0, s->shared.n_structures * sizeof *d->spare);
    d->weighed = 0;
}

void smr_time_steps_begin(smr *s)
{
    s->shape.track_rest->due = 1;
    s->shape.from = s->shape.x_next;
    s->shape.dynamics->ends = (s->schedule.iteration + 1u) % SMR_SWEEPS == 0u;
    s->reference.stale = 1;
}

uint32_t smr_sweep_tasks(const void *arg) { return ((const smr *)arg)->shared.n_tasks; }

/* Sets positions at which a sweep starts: predicted ones in a time step's first sweep, present ones in later sweeps. */
void smr_sweep_begin(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr *s = arg;
    const int first = s->schedule.iteration % SMR_SWEEPS == 0u;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(&s->shared, task); v++)
        smr_put3(s->shape.from, v, first ? smr_dynamics_free(s->shape.dynamics, v) : smr_get3(s->shape.x, v));
}

/* Moves vertices by springs to their average goals, which x_next holds before, and to their targets' goals. */
void smr_sweep_end(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr *s = arg;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(&s->shared, task); v++) {
        float *const next = smr_at3(s->shape.x_next, v);
        const int drawn = s->forces.found_last[v] == SMR_FOUND_GOAL;
        const float share = drawn ? s->shared.config.forces.stiffness : 0.0f;
        const smr_vec pull = smr_add(smr_scale(smr_get3(s->shape.x, v), share), smr_get3(s->forces.force, v));
        smr_store(next, smr_dynamics_next(s->shape.dynamics, v, smr_load(next), share, drawn ? pull : smr_v(0, 0, 0)));
    }
}

void smr_time_steps_next(smr *s)
{
    if (s->shape.dynamics->ends)
        smr_step_velocities(s);
    for (uint32_t v = 0; v < s->shared.n; v++)
        smr_put3(s->shape.x_ref, v, smr_track_rest_posed(&s->shape, v));
    smr_track_rest_commit(&s->shape);
}
