/* step_energy.c: what a time step has left of velocities, and the energies at its end. Around pins, and where parts of
 * several structures share clusters, clusters turn and stretch so far that their fits are approximate, and time steps
 * could add energy without end. So energy is counted, and velocities are scaled down where there is too much of it
 * (passivity observer and controller; Hannaford and Ryu 2002).
 * Counted together are structures that share clusters, for energy goes from one to the other, and those with pinned
 * vertices; any other by itself, about the mean of its motion, which nothing within it can change.
 * Bounds: two passes over the vertices, some more over structures with pinned ones; the structures squared.
 * SPDX-License-Identifier: MIT */
#include "runtime/tick/step_energy.h"

#include "geometry/jacobi.h"

#define SMR_LESS 0.999999f /* of what energy may be: sums are rounded */
#define SMR_LINE 1.0e-4f   /* pinned vertices thinner than this share of their length are a line: it may turn */

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
    const uint32_t n = s->shape.structure[structure].n_vertices, count = smr_pinned_of(s, structure);
    const float *const mass = s->shape.dynamics->mass;
    small_motion m = {smr_v(0, 0, 0), smr_v(0, 0, 0), smr_v(0, 0, 0)};
    smr_vec moment = smr_v(0, 0, 0);
    float inertia[6] = {0}, inverse[6];
    if (count == 0u)
        return m;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t v = smr_vertex_of(s, structure, i);
        if (mass[v] > 0.0f)
            continue;
        m.centre = smr_add(m.centre, smr_load(smr_at3(s->shape.x, v)));
        m.way = smr_add(m.way, off_of(s, v));
    }
    m.centre = smr_scale(m.centre, 1.0f / (float)count);
    m.way = smr_scale(m.way, 1.0f / (float)count);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t v = smr_vertex_of(s, structure, i);
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

/* Structures that are counted together, and how they move as a whole where none of their vertices is pinned. */
typedef struct group {
    uint32_t lead;
    smr_vec speed, way; /* mm/s when the step began; mm in it */
} group;

static smr_vec way_of(const smr *s, uint32_t v)
{
    return smr_sub(smr_load(smr_at3(s->shape.x, v)), smr_load(smr_at3(s->shape.dynamics->begin, v)));
}

/* Means by mass. Summed by chunks, so that rounding stays small. */
static group group_of(const smr *s, uint32_t lead)
{
    const smr_dynamics *d = s->shape.dynamics;
    const smr_vec zero = smr_v(0, 0, 0);
    group all = {lead, zero, zero};
    float mass = 0.0f;
    for (uint32_t k = 0; k < s->shared.n_structures; k++) {
        const uint32_t n = d->group[k] == lead ? s->shape.structure[k].n_vertices : 0u;
        for (uint32_t from = 0; from < n; from += SMR_CHUNK) {
            smr_vec speed = zero, way = zero;
            float part = 0.0f;
            for (uint32_t i = from; i < smr_min_u32(from + SMR_CHUNK, n); i++) {
                const uint32_t v = smr_vertex_of(s, k, i);
                const float m = smr_counted_mass(d, v);
                if (!(m > 0.0f))
                    return (group){lead, zero, zero};
                part += m;
                speed = smr_add(speed, smr_scale(smr_load(smr_at3(d->velocity, v)), m));
                way = smr_add(way, smr_scale(way_of(s, v), m));
            }
            mass += part;
            all.speed = smr_add(all.speed, speed);
            all.way = smr_add(all.way, way);
        }
    }
    const float inverse = mass > 0.0f ? 1.0f / mass : 0.0f;
    all.speed = smr_scale(all.speed, inverse);
    all.way = smr_scale(all.way, inverse);
    return all;
}

/* Sums over a group's vertices: energies of springs at the end of the time step; kinetic ones at its start, and at its
 * end before damping; work of gravity and goals. PUSHED: pinned vertices that move. */
enum { ELASTIC, GOALS, BEFORE, AFTER, WORK, PUSHED, ENERGIES };

static void add_kinetic(const smr *s, uint32_t v, const group *g, float sum[ENERGIES])
{
    const smr_dynamics *d = s->shape.dynamics;
    const smr_vec all = smr_load(smr_at3(d->velocity, v)), speed = smr_sub(all, g->speed);
    const smr_vec way = smr_sub(way_of(s, v), g->way);
    const float mass = smr_counted_mass(d, v), h2 = d->step_s * d->step_s;
    sum[BEFORE] += 0.5f * mass * smr_dot(speed, speed);
    sum[AFTER] += 0.5f * mass / h2 * smr_dot(way, way);
    sum[WORK] += mass * smr_dot(smr_load(s->shared.config.gravity), way);
    sum[PUSHED] += mass > 0.0f || !(smr_dot(all, all) > 0.0f) ? 0.0f : 1.0f;
}

/* Half the product of force and deviation (Clapeyron): the force is what the step has shown of it, M (x - y) / h^2. */
static void add_springs(const smr *s, uint32_t v, const group *g, const small_motion *held, float sum[ENERGIES])
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
        sum[WORK] += mass * k * smr_dot(pull, smr_sub(way_of(s, v), g->way));
        force = smr_sub(force, smr_scale(pull, mass * k));
    }
    sum[ELASTIC] -= 0.5f * smr_dot(force, smr_sub(off_of(s, v), rigid));
}

/* Energies in uJ. */
static void energies_of(const smr *s, const group *g, float all[ENERGIES])
{
    memset(all, 0, ENERGIES * sizeof *all);
    for (uint32_t k = 0; k < s->shared.n_structures; k++) {
        if (s->shape.dynamics->group[k] != g->lead)
            continue;
        const small_motion held = pinned_motion(s, k);
        const uint32_t n = s->shape.structure[k].n_vertices;
        for (uint32_t from = 0; from < n; from += SMR_CHUNK) {
            float one[ENERGIES] = {0};
            for (uint32_t i = from; i < smr_min_u32(from + SMR_CHUNK, n); i++) {
                add_kinetic(s, smr_vertex_of(s, k, i), g, one);
                add_springs(s, smr_vertex_of(s, k, i), g, &held, one);
            }
            for (uint32_t i = 0; i < ENERGIES; i++)
                all[i] += 0.001f * one[i];
        }
    }
    all[ELASTIC] = smr_clamp(all[ELASTIC], 0.0f, SMR_STORED_MOST);
    all[GOALS] = smr_clamp(all[GOALS], 0.0f, SMR_STORED_MOST);
}

/* What velocities of a group are scaled by. They obey two limits:
 * - kinetic and elastic energy come to no more than at the start and what gravity and goals have done since, less what
 *   damping took. `spare` is the elastic energy, and what steps have taken: so much a step may add.
 * - kinetic energy comes to no more than that of the step before, what gravity and goals did, and `bent`: as much of
 *   the elastic energy as is reported. That wavers, for it is approximate: what it grows by beyond all this is not
 *   reported, so that the sum of both never grows.
 * What new masses or moving pins add is not known: such a step may do as it does. */
static float passive_share(smr_dynamics *d, uint32_t lead, const float now[ENERGIES])
{
    const float all = now[BEFORE] + d->spare[lead] + now[WORK] - now[ELASTIC];
    const float told = SMR_LESS * (now[BEFORE] + d->bent[lead] + now[WORK]);
    const int known = !d->weighed && !(now[PUSHED] > 0.0f);
    const float most = known ? smr_max(smr_min(all, told), 0.0f) : now[AFTER], left = smr_min(now[AFTER], most);
    d->spare[lead] = smr_min(now[ELASTIC] + (known ? smr_max(all - left, 0.0f) : 0.0f), SMR_STORED_MOST);
    d->bent[lead] = known ? smr_min(now[ELASTIC], smr_max(told - left, 0.0f)) : now[ELASTIC];
    d->stored.elastic = smr_min(d->stored.elastic + d->bent[lead], SMR_STORED_MOST);
    d->stored.goals = smr_min(d->stored.goals + now[GOALS], SMR_STORED_MOST);
    return left < now[AFTER] ? SMR_SQRT(left / now[AFTER]) : 1.0f;
}

static float speed_of(float way, float per_s) { return smr_clamp(way * per_s, -SMR_SPEED_MOST, SMR_SPEED_MOST); }

static void move_on(smr *s, const group *g, float share)
{
    smr_dynamics *d = s->shape.dynamics;
    const float per_s = d->keeps / d->step_s;
    for (uint32_t k = 0; k < s->shared.n_structures; k++) {
        const uint32_t n = d->group[k] == g->lead ? s->shape.structure[k].n_vertices : 0u;
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t v = smr_vertex_of(s, k, i);
            smr_vec way = way_of(s, v);
            if (!(d->mass[v] > 0.0f))
                continue;
            if (share < 1.0f)
                way = smr_add(g->way, smr_scale(smr_sub(way, g->way), share));
            smr_store(smr_at3(d->velocity, v),
                      smr_v(speed_of(way.x, per_s), speed_of(way.y, per_s), speed_of(way.z, per_s)));
        }
    }
}

void smr_step_velocities(smr *s)
{
    smr_dynamics *d = s->shape.dynamics;
    float now[ENERGIES];
    d->stored.elastic = d->stored.goals = 0.0f;
    for (uint32_t k = 0; k < s->shared.n_structures; k++) {
        if (d->group[k] != k)
            continue;
        const group g = group_of(s, k);
        energies_of(s, &g, now);
        move_on(s, &g, passive_share(d, k, now));
    }
    d->weighed = 0;
}
