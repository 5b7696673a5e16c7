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
 * Bounds: a step ends with eight passes over the vertices; a start sums over the clusters.
 * SPDX-License-Identifier: MIT */
#include "runtime/tick/time_steps.h"

#include "geometry/jacobi.h"
#include "runtime/tick/schedule.h"
#include "runtime/tick/tracking.h"

#define SMR_WEIGHT_UNIT 32.0f     /* of weights around 1: rounding takes 1.6 % of a mass at most */
#define SMR_WEIGHTS_SUM 262144.0f /* units of a cluster's members; more would make its centre coarse */
#define SMR_WEIGHT_MOST 1024.0f   /* of a vertex, times the mean */
#define SMR_PINNED_MOST 3.4e7f    /* of a pinned one */
#define SMR_PINNED_TIMES 8.0f     /* weight of as many pinned vertices as a cluster can have, in clusters' masses */

#define SMR_LESS 0.999999f /* of what energy may be: sums are rounded */
#define SMR_TIES 8u        /* rounds in which structures are tied */
#define SMR_LINE 1.0e-4f   /* pinned vertices thinner than this share of their length are a line: it may turn */

/* How many members each vertex' cluster has, fractions at the boundary included. Structures are tied where members are
 * of others, which have another number: the sum of (number - own)^2 is not 0. */
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

static uint32_t vertex_of(const smr *s, uint32_t structure, uint32_t i)
{
    return smr_model_position(s->shared.model, s->shape.structure[structure].first_vertex + i);
}

static uint32_t pinned_of(const smr *s, uint32_t structure)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->shape.structure[structure].n_vertices; i++)
        count += !(s->shape.dynamics->mass[vertex_of(s, structure, i)] > 0.0f);
    return count;
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
    for (uint32_t k = 0; k < c->n_structures; k++)
        d->tied[k] = d->mixed[k] | (pinned_of(s, k) > 0u);
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

/* How far a vertex is from the reference shape, which is still that of x. */
static smr_vec off_of(const smr *s, uint32_t v)
{
    return smr_sub(smr_load(smr_at3(s->shape.x, v)), smr_load(smr_at3(s->shape.x_ref, v)));
}

/* A small rigid motion: way + turn x (x - centre). */
typedef struct small_motion {
    smr_vec centre, way, turn;
} small_motion;

/* That of a structure's pinned vertices from the reference shape: forces that hold them do no work against it. */
static small_motion pinned_motion(const smr *s, uint32_t structure)
{
    const uint32_t n = s->shape.structure[structure].n_vertices, count = pinned_of(s, structure);
    const float *const mass = s->shape.dynamics->mass;
    small_motion m = {smr_v(0, 0, 0), smr_v(0, 0, 0), smr_v(0, 0, 0)};
    smr_vec moment = smr_v(0, 0, 0);
    float inertia[6] = {0}, inverse[6];
    if (count == 0u)
        return m;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t v = vertex_of(s, structure, i);
        if (mass[v] > 0.0f)
            continue;
        m.centre = smr_add(m.centre, smr_load(smr_at3(s->shape.x, v)));
        m.way = smr_add(m.way, off_of(s, v));
    }
    m.centre = smr_scale(m.centre, 1.0f / (float)count);
    m.way = smr_scale(m.way, 1.0f / (float)count);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t v = vertex_of(s, structure, i);
        if (mass[v] > 0.0f)
            continue;
        const smr_vec r = smr_sub(smr_load(smr_at3(s->shape.x, v)), m.centre);
        const float r2 = smr_dot(r, r);
        const float part[6] = {r2 - r.x * r.x, -r.x * r.y, -r.x * r.z, r2 - r.y * r.y, -r.y * r.z, r2 - r.z * r.z};
        for (uint32_t k = 0; k < 6u; k++)
            inertia[k] += part[k];
        moment = smr_add(moment, smr_cross(r, off_of(s, v)));
    }
    smr_pseudo_inverse(inertia, SMR_LINE, inverse);
    const float full[9] = {inverse[0], inverse[1], inverse[2], inverse[1], inverse[3],
                           inverse[4], inverse[2], inverse[4], inverse[5]};
    m.turn = smr_mul(full, moment);
    return m;
}

/* Sums over vertices. Energies of springs at the end of the time step: LOOSE and BENT, the elastic ones of structures
 * that are not tied and that are. The latter share no sum with loose ones that may fly fast: kinetic energies at the
 * step's start and at its end before damping, work of gravity and goals. PUSHED: pinned vertices that move. */
enum { LOOSE, GOALS, BENT, BEFORE, AFTER, WORK, PUSHED, ENERGIES };

static void add_kinetic(const smr *s, uint32_t v, float sum[ENERGIES])
{
    const smr_dynamics *d = s->shape.dynamics;
    const smr_vec speed = smr_load(smr_at3(d->velocity, v));
    const smr_vec way = smr_sub(smr_load(smr_at3(s->shape.x, v)), smr_load(smr_at3(d->begin, v)));
    const float mass = smr_counted_mass(d, v), h2 = d->step_s * d->step_s;
    sum[BEFORE] += 0.5f * mass * smr_dot(speed, speed);
    sum[AFTER] += 0.5f * mass / h2 * smr_dot(way, way);
    sum[WORK] += mass * smr_dot(smr_load(s->shared.config.gravity), way);
    sum[PUSHED] += mass > 0.0f || !(smr_dot(speed, speed) > 0.0f) ? 0.0f : 1.0f;
}

/* Half the product of force and deviation (Clapeyron): the force is what the step has shown of it, M (x - y) / h^2. */
static void add_springs(const smr *s, uint32_t v, const small_motion *held, int tied, float sum[ENERGIES])
{
    const smr_dynamics *d = s->shape.dynamics;
    const smr_vec x = smr_load(smr_at3(s->shape.x, v));
    const smr_vec rigid = smr_add(held->way, smr_cross(held->turn, smr_sub(x, held->centre)));
    const float mass = smr_counted_mass(d, v), h2 = d->step_s * d->step_s;
    smr_vec force = smr_scale(smr_sub(x, smr_dynamics_free(d, v)), mass / h2);
    if (!(mass > 0.0f))
        return;
    if (s->forces.found_last[v] == SMR_FOUND_GOAL) {
        const float share = s->shared.config.stiffness, k = s->shared.config.elastic;
        const smr_vec moved = smr_sub(x, smr_load(smr_at3(s->shape.x_next, v))); /* since the goal was sought */
        const smr_vec pull = smr_sub(smr_load(smr_at3(s->forces.force, v)), smr_scale(moved, share));
        sum[GOALS] += 0.5f * mass * k / share * smr_dot(pull, pull);
        sum[WORK] += !tied ? 0.0f : mass * k * smr_dot(pull, smr_sub(x, smr_load(smr_at3(d->begin, v))));
        force = smr_sub(force, smr_scale(pull, mass * k));
    }
    sum[tied ? BENT : LOOSE] -= 0.5f * smr_dot(force, smr_sub(off_of(s, v), rigid));
}

/* Summed by chunks, so that rounding stays small. Energies in uJ. */
static void energies_of(const smr *s, float all[ENERGIES])
{
    memset(all, 0, ENERGIES * sizeof *all);
    for (uint32_t k = 0; k < s->shared.n_structures; k++) {
        const small_motion held = pinned_motion(s, k);
        const uint32_t n = s->shape.structure[k].n_vertices;
        const int tied = s->shape.dynamics->tied[k] != 0u;
        for (uint32_t from = 0; from < n; from += SMR_CHUNK) {
            float one[ENERGIES] = {0};
            for (uint32_t i = from; i < smr_min_u32(from + SMR_CHUNK, n); i++) {
                if (tied)
                    add_kinetic(s, vertex_of(s, k, i), one);
                add_springs(s, vertex_of(s, k, i), &held, tied, one);
            }
            for (uint32_t i = 0; i < ENERGIES; i++)
                all[i] += 0.001f * one[i];
        }
    }
    all[LOOSE] = smr_clamp(all[LOOSE], 0.0f, SMR_STORED_MOST);
    all[GOALS] = smr_clamp(all[GOALS], 0.0f, SMR_STORED_MOST);
    all[BENT] = smr_clamp(all[BENT], 0.0f, SMR_STORED_MOST);
}

/* What velocities of tied structures are scaled by. Around pins clusters turn and stretch so far that
 * the fits are approximate, and time steps could add energy without end. So energy is counted in each step (passivity
 * observer and controller; Hannaford and Ryu 2002), in two ways, and velocities obey both:
 * - kinetic and elastic energy come to no more than at the start and what gravity and goals have done since, less what
 *   damping took. `spare` is the elastic energy, and what steps have taken: so much a step may add.
 * - kinetic energy comes to no more than that of the step before, what gravity and goals did, and `bent`: as much of
 *   the elastic energy as is reported. That wavers, for it is approximate: what it grows by beyond all this is not
 *   reported, so that the sum of both never grows.
 * What new masses or moving pins add is not known: such a step may do as it does. */
static float passive_share(smr_dynamics *d, const float now[ENERGIES])
{
    const float all = now[BEFORE] + d->stored.spare + now[WORK] - now[BENT];
    const float told = SMR_LESS * (now[BEFORE] + d->stored.bent + now[WORK]);
    const int known = !d->weighed && !(now[PUSHED] > 0.0f);
    const float most = known ? smr_max(smr_min(all, told), 0.0f) : now[AFTER], left = smr_min(now[AFTER], most);
    d->stored.spare = smr_min(now[BENT] + (known ? smr_max(all - left, 0.0f) : 0.0f), SMR_STORED_MOST);
    d->stored.bent = known ? smr_min(now[BENT], smr_max(told - left, 0.0f)) : now[BENT];
    d->stored.elastic = smr_min(now[LOOSE] + d->stored.bent, SMR_STORED_MOST);
    d->stored.goals = now[GOALS];
    d->weighed = 0;
    return left < now[AFTER] ? SMR_SQRT(left / now[AFTER]) : 1.0f;
}

/* Scales the velocities of tied structures. */
static void slow_down(smr *s, float share)
{
    smr_dynamics *d = s->shape.dynamics;
    for (uint32_t k = 0; k < s->shared.n_structures && share < 1.0f; k++) {
        if (!s->shape.dynamics->tied[k])
            continue;
        for (uint32_t i = 0; i < s->shape.structure[k].n_vertices; i++) {
            float *const speed = smr_at3(d->velocity, vertex_of(s, k, i));
            smr_store(speed, smr_scale(smr_load(speed), share));
        }
    }
}

static float speed_of(float way, float per_s) { return smr_clamp(way * per_s, -SMR_SPEED_MOST, SMR_SPEED_MOST); }

void smr_time_steps_next(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    const float per_s = d->keeps / d->step_s;
    float now[ENERGIES];
    if (!d->ends) {
        smr_held_stand(&s->shape);
        return;
    }
    energies_of(s, now); /* x^r is still that of x */
    smr_held_stand(&s->shape);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const smr_vec x = smr_load(smr_at3(s->shape.x, v)), way = smr_sub(x, smr_load(smr_at3(d->begin, v)));
        if (d->mass[v] > 0.0f)
            smr_store(smr_at3(d->velocity, v),
                      smr_v(speed_of(way.x, per_s), speed_of(way.y, per_s), speed_of(way.z, per_s)));
        smr_store(smr_at3(d->begin, v), x);
    }
    slow_down(s, passive_share(d, now));
}
