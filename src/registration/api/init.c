/* init.c: starts a registration at the model's rest shape. smr_layout() runs twice: to measure for smr_arena_bytes(),
 * and to place for smr_init(), on a copy on the stack until the arena is known to be large enough.
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation/rotation.h"
#include "registration/config/config.h"
#include "registration/api/setup.h"

smr_status smr_arena_bytes(const smr_model *model, const smr_config *config, size_t *bytes)
{
    smr s;
    if (model == NULL || config == NULL || bytes == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_config_check(config, model));
    smr_count(&s, model, config);
    smr_arena a = smr_arena_measure();
    (void)smr_layout(&a, &s);
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
    SMR_TRY(smr_arena_bytes(model, config, &needed));
    SMR_TRY(smr_arena_start(&a, arena, arena_bytes));
    if (port != NULL && (port->n_workers < 1u || port->n_workers > config->basic.n_workers))
        return SMR_E_CONFIG;
    if (needed > arena_bytes)
        return SMR_E_ARENA;
    smr_count(&s, model, config);
    smr_arena_release(arena, arena_bytes);
    memset(arena, 0, needed);
    smr *self = smr_layout(&a, &s);
    s.magic = SMR_STATE_MAGIC;
    s.placed = self;
    if (port != NULL)
        s.port = *port;
    s.shared.min_cos = smr_cos_degrees(config->forces.normal_deg);
    start_triangles(&s);
    start_masses(&s.shared);
    smr_budget_start(&s);
    *self = s;
    smr_wire(self);
    smr_shape_start(&self->shape);
    if (SMR_HAS_HELD)
        smr_track_rest_wire(&self->shape);
    if (SMR_HAS_CONTACT) {
        smr_volumes_model(&self->volumes);
        smr_contact_model(&self->forces.contact);
    }
    if (SMR_HAS_PARTIAL)
        smr_occluded_field_model(&self->forces.occluded);
    if (smr_set_pose(self, &identity) != SMR_OK)
        return SMR_E_CONFIG;
    if (SMR_HAS_CONTACT)
        smr_smooth_rest(&self->forces.smooth);
    self->log.fresh = 1;
    *out = self;
    return SMR_OK;
}
