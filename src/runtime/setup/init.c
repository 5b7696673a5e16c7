/* init.c: cuts the arena and starts a registration at the model's rest shape. layout() runs twice over the same code:
 * once to measure for smr_arena_bytes(), once to place for smr_init().
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation.h"
#include "runtime/config/config.h"
#include "runtime/registration.h"

/* Counts are in s already; s is a copy on the stack until the arena is known to be large enough. */
static smr *layout(smr_arena *a, smr *s)
{
    const smr_shared *shared = &s->shared;
    const uint32_t hinge_tasks = smr_ceil_div(shared->n_hinges, SMR_HINGE_CHUNK);
    smr *self = smr_arena_take(a, 1, sizeof *self);
    smr_overlay_layout(a, &s->overlay, shared->n, SMR_WORDS, smr_unseen_field_words(shared),
                       smr_max_u32(smr_ceil_div(shared->n, SMR_MATCH_CHUNK), hinge_tasks));
    smr_shape_layout(a, &s->shape, shared);
    smr_forces_layout(a, &s->forces, shared);
    smr_reference_layout(a, &s->reference, shared);
    smr_match_layout(a, &s->match, shared);
    smr_evolve_layout(a, &s->evolve, shared);
    smr_folds_layout(a, &s->folds, shared);
    return self;
}

/* The stages' views of each other. */
static void wire(smr *s)
{
    const smr_shared *shared = &s->shared;
    const smr_pace *pace = &s->pace;
    const smr_overlay *overlay = &s->overlay;
    s->shape.shared = shared;
    smr_forces_wire(&s->forces, shared, pace, &s->shape, overlay);
    smr_sums_wire(&s->sums, shared, pace, &s->forces, overlay);
    smr_reference_wire(&s->reference, shared, pace, &s->shape, &s->sums, overlay);
    smr_match_wire(&s->match, shared, pace, &s->reference, &s->sums, overlay);
    smr_evolve_wire(&s->evolve, shared, pace, &s->shape, &s->forces.surface, &s->reference, &s->sums, overlay);
    smr_folds_wire(&s->folds, shared, pace, &s->shape, &s->evolve.evening, overlay);
}

/* Everything that follows from model and configuration alone. */
static void count(smr *s, const smr_model *model, const smr_config *config)
{
    memset(s, 0, sizeof *s);
    s->shared.model = model;
    s->shared.config = *config;
    s->shared.n = smr_le32(model->n_vertices);
    s->shared.n_triangles = smr_le32(model->n_triangles);
    s->shared.n_structures = smr_le32(model->n_structures);
    s->shared.n_radii = smr_le32(model->n_radii);
    s->shared.n_hinges = smr_le32(model->n_hinges);
    s->shared.n_tasks = smr_ceil_div(s->shared.n, SMR_CHUNK);
}

smr_status smr_arena_bytes(const smr_model *model, const smr_config *config, size_t *bytes)
{
    smr s;
    if (model == NULL || config == NULL || bytes == NULL)
        return SMR_E_NULL;
    const smr_status status = smr_config_check(config, model);
    if (status != SMR_OK)
        return status;
    count(&s, model, config);
    smr_arena a = smr_arena_measure();
    (void)layout(&a, &s);
    *bytes = a.used;
    return a.used == SIZE_MAX ? SMR_E_INPUT : SMR_OK;
}

static void start_triangles(smr *s)
{
    const uint32_t *stored = smr_at(s->shared.model, s->shared.model->at_triangles);
    s->shared.triangle = stored;
    if (!SMR_BIG_ENDIAN)
        return;
    for (size_t i = 0; i < 3u * (size_t)s->shared.n_triangles; i++)
        s->shape.own_triangle[i] = smr_le32(stored[i]);
    s->shared.triangle = s->shape.own_triangle;
}

static void start_masses(smr_shared *c)
{
    c->mass_unit = 1.0f;
    for (uint32_t v = 0; v < c->n; v++) {
        const float m = smr_mass(c, v);
        c->mass_max = smr_max(c->mass_max, m);
        if (m != (float)(uint32_t)m)
            c->mass_unit = SMR_MASS_UNITS;
    }
}

smr_status smr_init(const smr_model *model, const smr_config *config, const smr_port *port, void *arena,
                    size_t arena_bytes, smr **out)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr s;
    smr_arena a;
    size_t needed;
    if (out == NULL)
        return SMR_E_NULL;
    smr_status status = smr_arena_bytes(model, config, &needed);
    if (status == SMR_OK)
        status = smr_arena_start(&a, arena, arena_bytes);
    if (status != SMR_OK)
        return status;
    if (port != NULL && (port->n_workers < 1u || port->n_workers > config->n_workers))
        return SMR_E_CONFIG;
    if (needed > arena_bytes)
        return SMR_E_ARENA;
    count(&s, model, config);
    smr_arena_release(arena, arena_bytes);
    smr *self = layout(&a, &s);
    s.magic = SMR_STATE_MAGIC;
    s.placed = self;
    if (port != NULL)
        s.port = *port;
    s.shared.min_cos = smr_cos_degrees(config->normal_deg);
    start_triangles(&s);
    start_masses(&s.shared);
    smr_budget_start(&s);
    *self = s;
    wire(self);
    smr_shape_start(&self->shape);
    if (smr_set_pose(self, &identity) != SMR_OK)
        return SMR_E_CONFIG;
    self->log.fresh = 1;
    *out = self;
    return SMR_OK;
}
