/* dynamics_energy.c: velocities and energies at the end of a time step. Near pinned vertices, and where structures
 * share clusters, fits are approximate, and steps could add energy without limit. Therefore energy is counted, of
 * structures that share clusters together, and velocities are scaled down when there is too much (passivity observer
 * and controller; Hannaford and Ryu 2002). Without pinned vertices, linear and angular momentum are conserved.
 * Bounds: three passes over the vertices, cut into tasks; one in a piece.
 * SPDX-License-Identifier: MIT */
#include "options/dynamics/dynamics.h"
#include "geometry/linear_solve/eigen_jacobi.h"

#define SMR_LESS 0.999999f /* factor on the permitted kinetic energy: a margin for rounding of sums */
#define SMR_LINE 1.0e-4f   /* moment of inertia / largest one below which pinned vertices may turn about their line */

/* The passes of the summation over vertices, in order. Each pass uses the results of the passes before. */
enum { MEANS, TURNS, ENERGY, PASSES };

/* Returns the position of a vertex at the end of the time step, mm, while the step's last iteration runs. */
static smr_vec next_of(const smr *s, uint32_t v) { return smr_get3(s->shape.x_next, v); }

/* Returns the displacement of a vertex in the time step, mm. */
static smr_vec displacement_of(const smr *s, uint32_t v)
{
    return smr_sub(next_of(s, v), smr_get3(s->shape.dynamics->begin, v));
}

/* Returns the vector from a vertex of the reference shape to the position at the end of the step, mm. */
static smr_vec off_of(const smr *s, uint32_t v) { return smr_sub(next_of(s, v), smr_get3(s->shape.x_ref, v)); }

/* Adds a vertex to the sums for its group's mean motion, or a pinned one to those for its structure's pinned centre. */
static void add_means(const smr *s, uint32_t v, smr_step_sums *own, smr_step_sums *lead)
{
    const smr_dynamics *d = s->shape.dynamics;
    const float mass = smr_counted_mass(d, v);
    if (mass > 0.0f) {
        lead->mass += mass;
        lead->speed = smr_add(lead->speed, smr_scale(smr_dynamics_speed(d, v), mass));
        lead->displacement = smr_add(lead->displacement, smr_scale(displacement_of(s, v), mass));
        lead->middle = smr_add(lead->middle, smr_scale(next_of(s, v), mass));
        return;
    }
    own->n_pinned += 1.0f;
    own->centre = smr_add(own->centre, next_of(s, v));
    own->off = smr_add(own->off, off_of(s, v));
}

static void end_means(smr_dynamics *d, uint32_t n_structures)
{
    for (uint32_t k = 0; k < n_structures; k++) {
        smr_step_sums *const own = d->sums + k;
        const float inverse = own->n_pinned > 0.0f ? 1.0f / own->n_pinned : 0.0f;
        own->centre = smr_scale(own->centre, inverse);
        own->off = smr_scale(own->off, inverse);
        d->sums[d->group[k]].fixed |= own->n_pinned > 0.0f;
    }
    for (uint32_t k = 0; k < n_structures; k++) {
        smr_step_sums *const lead = d->sums + k;
        const float inverse = lead->mass > 0.0f && !lead->fixed ? 1.0f / lead->mass : 0.0f;
        lead->speed = smr_scale(lead->speed, inverse);
        lead->displacement = smr_scale(lead->displacement, inverse);
        lead->middle = smr_scale(lead->middle, inverse);
    }
}

static void add_turn(smr_step_sums *to, float mass, smr_vec r, smr_vec displacement, smr_vec *turn)
{
    const float r2 = smr_dot(r, r);
    const float part[6] = {r2 - r.x * r.x, -r.x * r.y, -r.x * r.z, r2 - r.y * r.y, -r.y * r.z, r2 - r.z * r.z};
    for (uint32_t k = 0; k < 6u; k++)
        to->inertia[k] += mass * part[k];
    *turn = smr_add(*turn, smr_scale(smr_cross(r, displacement), mass));
}

/* Adds a vertex to the rotation sums of its group; a pinned one, to those of its structure's pinned vertices. */
static void add_turns(const smr *s, uint32_t v, const smr_step_sums *own, const smr_step_sums *lead,
                      smr_step_sums *to_own, smr_step_sums *to_lead)
{
    const smr_dynamics *d = s->shape.dynamics;
    const smr_vec x = next_of(s, v);
    if (!(d->mass[v] > 0.0f))
        add_turn(to_own, 1.0f, smr_sub(x, own->centre), off_of(s, v), &to_own->turn);
    else if (!lead->fixed)
        add_turn(to_lead, smr_counted_mass(d, v), smr_sub(x, lead->middle),
                 smr_sub(displacement_of(s, v), lead->displacement), &to_lead->spin);
}

static void end_turns(smr_dynamics *d, uint32_t n_structures)
{
    for (uint32_t k = 0; k < n_structures; k++) {
        smr_step_sums *const own = d->sums + k;
        float i[6];
        smr_pseudo_inverse(own->inertia, SMR_LINE, i);
        own->turn = smr_mul_symmetric(i, own->turn);
        own->spin = smr_mul_symmetric(i, own->spin);
    }
}

/* Returns the displacement of the point x by the rotation of the group g in the time step, mm. */
static smr_vec turned(const smr_step_sums *g, smr_vec x) { return smr_cross(g->spin, smr_sub(x, g->middle)); }

/* Adds v's kinetic energies and work. A damped step equals an undamped one of mass m / keeps from damped velocities. */
static void add_kinetic(const smr *s, uint32_t v, const smr_step_sums *group, float sum[SMR_STEP_ENERGIES])
{
    const smr_dynamics *d = s->shape.dynamics;
    const smr_vec all = smr_dynamics_speed(d, v), speed = smr_sub(all, group->speed);
    const smr_vec displacement = smr_sub(displacement_of(s, v), group->displacement);
    const float mass = smr_counted_mass(d, v), inert = mass / d->keeps, h2 = d->step_s * d->step_s;
    sum[SMR_BEFORE] += 0.5f * inert * smr_dot(speed, speed);
    sum[SMR_AFTER] += 0.5f * inert / h2 * smr_dot(displacement, displacement);
    const smr_vec spin = turned(group, next_of(s, v));
    sum[SMR_SPIN] += 0.5f * inert / h2 * smr_dot(spin, spin);
    sum[SMR_WORK] += mass * smr_dot(smr_load(s->shared.config.dynamics.gravity), displacement);
    sum[SMR_PUSHED] += mass > 0.0f || !(smr_dot(all, all) > 0.0f) ? 0.0f : 1.0f;
}

/* Adds v's spring energies: half of force times deviation (Clapeyron). The force is M (x - y) / (keeps h^2). The
 * rigid motion of pinned vertices off the reference shape does no work. */
static void add_springs(const smr *s, uint32_t v, const smr_step_sums *group, const smr_step_sums *own,
                        float sum[SMR_STEP_ENERGIES])
{
    const smr_dynamics *d = s->shape.dynamics;
    const smr_vec x = next_of(s, v), rigid = smr_add(own->off, smr_cross(own->turn, smr_sub(x, own->centre)));
    const float mass = smr_counted_mass(d, v), h2 = d->step_s * d->step_s;
    smr_vec force = smr_scale(smr_sub(x, smr_dynamics_free(d, v)), mass / (d->keeps * h2));
    if (!(mass > 0.0f))
        return;
    if (s->forces.found_last[v] == SMR_FOUND_GOAL) {
        const float share = s->shared.config.forces.stiffness, k = s->shared.config.dynamics.elastic;
        const smr_vec moved = smr_sub(x, smr_get3(s->shape.x, v)); /* displacement since the goal was found, mm */
        const smr_vec pull = smr_sub(smr_get3(s->forces.force, v), smr_scale(moved, share));
        sum[SMR_GOALS] += 0.5f * mass * k / share * smr_dot(pull, pull);
        sum[SMR_WORK] += mass * k * smr_dot(pull, smr_sub(displacement_of(s, v), group->displacement));
        force = smr_sub(force, smr_scale(pull, mass * k));
    }
    sum[SMR_ELASTIC] -= 0.5f * smr_dot(force, smr_sub(off_of(s, v), rigid));
}

uint32_t smr_step_energy_tasks(const void *arg)
{
    const smr *s = arg;
    return s->shape.dynamics->ends ? PASSES * s->shape.track_rest->n_tasks : 0u;
}

/* Adds the sums `part` of a chunk of vertices to those of a structure or group. Chunks keep rounding small. */
static void add_sums(smr_step_sums *to, const smr_step_sums *part)
{
    to->mass += part->mass;
    to->speed = smr_add(to->speed, part->speed);
    to->displacement = smr_add(to->displacement, part->displacement);
    to->middle = smr_add(to->middle, part->middle);
    to->spin = smr_add(to->spin, part->spin);
    to->n_pinned += part->n_pinned;
    to->centre = smr_add(to->centre, part->centre);
    to->off = smr_add(to->off, part->off);
    to->turn = smr_add(to->turn, part->turn);
    for (uint32_t i = 0; i < 6u; i++)
        to->inertia[i] += part->inertia[i];
    for (uint32_t i = 0; i < SMR_STEP_ENERGIES; i++)
        to->energy[i] += 0.001f * part->energy[i]; /* converts nJ to uJ */
}

void smr_step_energy(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr *s = arg;
    smr_dynamics *d = s->shape.dynamics;
    const uint32_t pass = task / s->shape.track_rest->n_tasks;
    if (task % s->shape.track_rest->n_tasks == 0u) {
        d->structure = d->vertex = 0;
        if (pass == MEANS)
            memset(d->sums, 0, s->shared.n_structures * sizeof *d->sums);
        else
            (pass == TURNS ? end_means : end_turns)(d, s->shared.n_structures);
    }
    smr_step_sums *const own = d->sums + d->structure, *const lead = d->sums + d->group[d->structure];
    const uint32_t n = s->shape.structure[d->structure].n_vertices, last = smr_min_u32(d->vertex + SMR_MATCH_CHUNK, n);
    smr_step_sums of_own = {.fixed = 0}, of_lead = of_own;
    for (uint32_t i = d->vertex; i < last; i++) {
        const uint32_t v = smr_model_position(s->shared.model, s->shape.structure[d->structure].first_vertex + i);
        if (pass == MEANS) {
            add_means(s, v, &of_own, &of_lead);
        } else if (pass == TURNS) {
            add_turns(s, v, own, lead, &of_own, &of_lead);
        } else {
            add_kinetic(s, v, lead, of_lead.energy);
            add_springs(s, v, lead, own, of_lead.energy);
        }
    }
    add_sums(own, &of_own);
    add_sums(lead, &of_lead);
    d->vertex = last < n ? last : 0u;
    d->structure += last == n;
}

/* Computes the factors on the velocities of a group from two limits on its energy.
 * - `spare`: kinetic plus elastic energy must not exceed the energy at the start plus the work of gravity and goals
 *   since, minus damping. `spare` holds the elastic energy, and the energy that steps took besides damping.
 * - `bent`: kinetic energy must not exceed that of the step before plus the work plus `bent`, the reported elastic
 *   energy. It is approximate: growth beyond this limit is not reported, so that the reported sum never grows. Below 0
 *   it is work that was done without energy.
 * Excess is taken from motion besides rotation, then from rotation. New masses or moving pins lift the limits. */
static void find_shares(smr_dynamics *d, uint32_t lead)
{
    smr_step_sums *const group = d->sums + lead;
    const float *const now = group->energy;
    const float elastic = smr_clamp(now[SMR_ELASTIC], 0.0f, SMR_STORED_MOST);
    const float goals = smr_clamp(now[SMR_GOALS], 0.0f, SMR_STORED_MOST);
    const float all = now[SMR_BEFORE] + d->spare[lead] + now[SMR_WORK] - elastic;
    const float reported = SMR_LESS * (now[SMR_BEFORE] + d->bent[lead] + now[SMR_WORK]);
    const int known = !d->weighed && !(now[SMR_PUSHED] > 0.0f);
    const float most = known ? smr_max(smr_min(all, reported), 0.0f) : now[SMR_AFTER];
    const float left = smr_min(now[SMR_AFTER], most), beside = smr_max(now[SMR_AFTER] - now[SMR_SPIN], 0.0f);
    d->spare[lead] = smr_min(elastic + (known ? smr_max(all - left, 0.0f) : 0.0f), SMR_STORED_MOST);
    d->bent[lead] = known ? smr_clamp(reported - left, -SMR_STORED_MOST, elastic) : elastic;
    d->stored.elastic = smr_min(d->stored.elastic + smr_max(d->bent[lead], 0.0f), SMR_STORED_MOST);
    d->stored.goals = smr_min(d->stored.goals + goals, SMR_STORED_MOST);
    group->share = group->spin_share = 1.0f;
    if (!(left < now[SMR_AFTER]))
        return;
    group->share = left > now[SMR_SPIN] ? SMR_SQRT((left - now[SMR_SPIN]) / beside) : 0.0f;
    group->spin_share = left < now[SMR_SPIN] ? SMR_SQRT(left / now[SMR_SPIN]) : 1.0f;
}

void smr_step_velocities(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    const float per_s = 1.0f / d->step_s;
    d->stored.elastic = d->stored.goals = 0.0f;
    for (uint32_t k = 0; k < s->shared.n_structures; k++)
        if (d->group[k] == k)
            find_shares(d, k);
    d->weighed = 0;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const smr_step_sums *const group = d->sums + d->group[smr_model_owner(s->shared.model, v)];
        const smr_vec x = smr_get3(s->shape.x, v);
        smr_vec displacement = smr_sub(x, smr_get3(d->begin, v));
        if (group->share < 1.0f) {
            const smr_vec spin = turned(group, x);
            const smr_vec beside = smr_sub(smr_sub(displacement, group->displacement), spin);
            displacement = smr_add(group->displacement, smr_scale(spin, group->spin_share));
            displacement = smr_add(displacement, smr_scale(beside, group->share));
        }
        if (d->mass[v] > 0.0f)
            smr_put3(d->velocity, v, smr_clamped(smr_scale(displacement, per_s), SMR_SPEED_MOST));
        smr_put3(d->begin, v, x);
    }
}

smr_vec smr_dynamics_free(const smr_dynamics *d, uint32_t v)
{
    const smr_vec displacement = smr_scale(smr_dynamics_speed(d, v), d->step_s), x = smr_get3(d->begin, v);
    return smr_clamped(smr_add(smr_add(x, displacement), d->mass[v] > 0.0f ? d->fall : smr_v(0, 0, 0)), SMR_FARTHEST);
}
