/* set_motion.c: sets and reads masses and velocities; computes energies.
 * Bounds: one pass over the vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_steps.h"

static smr_status check(const smr *s, const void *what)
{
    if (s == NULL || what == NULL)
        return SMR_E_NULL;
    if (!SMR_HAS_DYNAMICS)
        return SMR_E_CONFIG;
    SMR_TRY(smr_readable(s, 0, what));
    return s->shape.dynamics == NULL ? SMR_E_ARENA : SMR_OK;
}

static int legal(const float *mass, const float *velocity, uint32_t n)
{
    int good = velocity == NULL || smr_all_within(velocity, 3u * (size_t)n, SMR_SPEED_MOST);
    for (uint32_t i = 0; mass != NULL && i < n; i++)
        good &= mass[i] >= SMR_MASS_LEAST && (mass[i] <= SMR_MASS_MOST || mass[i] > FLT_MAX);
    return good;
}

smr_status smr_set_motion(smr *s, uint32_t structure, const float *mass, const float *velocity)
{
    const smr_motion motion = {mass, velocity};
    SMR_TRY(check(s, mass != NULL ? mass : velocity));
    if (!smr_ready(s))
        return SMR_E_STATE;
    if (structure >= s->shared.n_structures)
        return SMR_E_INPUT;
    const smr_shape_structure *one = &s->shape.structure[structure];
    if (!legal(mass, velocity, one->n_vertices))
        return SMR_E_INPUT;
    smr_dynamics *d = s->shape.dynamics;
    uint32_t other = 0;
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        const float before = d->mass[v];
        if (mass != NULL)
            d->mass[v] = mass[i] > FLT_MAX ? 0.0f : mass[i];
        other |= d->mass[v] < before || d->mass[v] > before;
        if (velocity != NULL)
            smr_put3(d->velocity, v, smr_get3(velocity, i));
    }
    d->weighed |= other && s->schedule.iteration > 0u; /* new masses: stored energies are outdated, if there are any */
    smr_abandon_iteration(s);
    if (s->schedule.iteration == 0u && smr_visibility_on(&s->forces.surface))
        smr_visibility_start(&s->forces.surface); /* the abandoned iteration may have judged it */
    smr_weights_add(s, (smr_piece){0, s->shared.n});
    smr_weights_set(s, (smr_piece){0, s->shared.n});
    smr_changed(s, SMR_LOG_MOTION, structure, &motion, one->n_vertices);
    return SMR_OK;
}

smr_status smr_get_velocities(const smr *s, uint32_t structure, float *velocity)
{
    SMR_TRY(check(s, velocity));
    return smr_copy_out(s, structure, s->shape.dynamics->velocity, smr_v(0, 0, 0), velocity);
}

typedef struct moments {
    float mass, kinetic, height; /* mass, g; kinetic and potential energy, g mm^2 / s^2 */
    smr_vec first;               /* sum of mass times position, g mm */
    uint32_t n_pinned;           /* number of pinned vertices */
} moments;

static void add_vertex(const smr *s, uint32_t v, moments *sum)
{
    const smr_dynamics *d = s->shape.dynamics;
    const float mass = smr_counted_mass(d, v);
    const smr_vec x = smr_get3(s->shape.x, v), speed = smr_get3(d->velocity, v);
    const smr_vec displacement = smr_sub(x, smr_get3(s->shape.start, v));
    sum->n_pinned += !(d->mass[v] > 0.0f);
    sum->mass += mass;
    sum->kinetic += 0.5f * mass * smr_dot(speed, speed);
    sum->height -= mass * smr_dot(smr_load(s->shared.config.dynamics.gravity), displacement);
    sum->first = smr_add(sum->first, smr_scale(x, mass));
}

/* Returns the sums over all vertices. Sums over each chunk, then over all chunks, keep rounding small. */
static moments moments_of(const smr *s)
{
    moments all = {0};
    for (uint32_t t = 0; t < s->shared.n_tasks; t++) {
        moments one = {0};
        for (uint32_t v = t * SMR_CHUNK; v < smr_chunk_end(&s->shared, t); v++)
            add_vertex(s, v, &one);
        all.mass += one.mass;
        all.kinetic += one.kinetic;
        all.height += one.height;
        all.first = smr_add(all.first, one.first);
        all.n_pinned += one.n_pinned;
    }
    return all;
}

smr_status smr_get_energy(const smr *s, smr_energy *energy)
{
    SMR_TRY(check(s, energy));
    const moments sum = moments_of(s);
    const smr_stored_energy *stored = &s->shape.dynamics->stored;
    const smr_vec mean = sum.mass > 0.0f ? smr_scale(sum.first, 1.0f / sum.mass) : smr_v(0, 0, 0);
    memset(energy, 0, sizeof *energy);
    energy->steps = s->schedule.iteration / SMR_SWEEPS;
    energy->sweeps = s->schedule.iteration % SMR_SWEEPS;
    energy->n_pinned = sum.n_pinned;
    energy->mass_g = sum.mass;
    smr_store(energy->centre, smr_add(mean, s->shape.origin));
    energy->kinetic_uj = 0.001f * sum.kinetic;
    energy->gravity_uj = 0.001f * sum.height;
    energy->elastic_uj = stored->elastic;
    energy->goals_uj = stored->goals;
    return SMR_OK;
}
