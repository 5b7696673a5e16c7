/* init.c: cuts the arena and starts a registration at the model's rest shape. layout() runs twice over the same code:
 * once to measure for smr_arena_bytes(), once to place for smr_init().
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation.h"
#include "runtime/state.h"

/* Counts are in s already; s is a copy on the stack until the arena is known to be large enough. */
static smr *layout(smr_arena *a, smr *s)
{
    const size_t n = s->n, three = 3u * sizeof(float);
    const int pulls = s->config.n_target_vertices > 0u;
    const int polar = s->config.method == SMR_METHOD_POLAR;
    smr *self = smr_arena_take(a, 1, sizeof *self);
    s->part = smr_arena_take(a, s->n_parts, sizeof *s->part);
    s->goal = smr_arena_take(a, s->n_parts, sizeof *s->goal);
    s->x = smr_arena_take(a, n, three);
    s->x_next = smr_arena_take(a, n, three);
    s->x_ref = smr_arena_take(a, n, three);
    s->normal = smr_arena_take(a, n, three);
    s->normal_ref = smr_arena_take(a, n, three);
    s->start = smr_arena_take(a, n, three);
    s->force = smr_arena_take(a, n, three);
    s->residual = smr_arena_take(a, n, sizeof(float));
    s->centre = smr_arena_take(a, n, three);
    s->spread = smr_arena_take(a, n, 6u * sizeof(float));
    s->cluster_mass = smr_arena_take(a, n, sizeof(float));
    s->share = smr_arena_take(a, n, sizeof(float));
    s->warm = smr_arena_take(a, n, sizeof(uint32_t));
    s->warm_next = smr_arena_take(a, n, sizeof(uint32_t));
    s->record = smr_arena_take(a, n, SMR_WORDS * sizeof(uint32_t));
    s->sum = smr_arena_take(a, n, SMR_WORDS * sizeof(uint32_t));
    s->transform = smr_arena_take(a, n, 12u * sizeof(float));
    s->eigen = polar ? smr_arena_take(a, n, 9u * sizeof(float)) : NULL;
    s->ring_sum = (float *)s->record; /* records are done when folds are looked for */
    s->ring_weight = s->ring_sum == NULL ? NULL : s->ring_sum + 3u * n;
    s->displaced = s->ring_sum == NULL ? NULL : s->ring_sum + 4u * n;
    s->guard = smr_arena_take(a, n, 1);
    s->held = smr_arena_take(a, n, 1);
    s->found = smr_arena_take(a, n, 1);
    s->seen = smr_arena_take(a, n, 1);
    s->contrast = smr_arena_take(a, n, 1);
    s->contrast_next = smr_arena_take(a, n, 1);
    s->lighter = smr_arena_take(a, n, 1);
    s->lighter_next = smr_arena_take(a, n, 1);
    s->tally = smr_arena_take(a, smr_max_u32(smr_ceil_div(s->n, SMR_MATCH_CHUNK), s->n_hinge_tasks), sizeof *s->tally);
    s->facet_normal = smr_arena_take(a, s->n_triangles, three);
    if (SMR_BIG_ENDIAN)
        s->own_triangle = smr_arena_take(a, s->n_triangles, 3u * sizeof(uint32_t));
    s->target_warm = pulls ? smr_arena_take(a, s->config.n_target_vertices, sizeof(uint32_t)) : NULL;
    s->pull = pulls ? smr_arena_take(a, s->config.n_workers * n, 4u * sizeof(int64_t)) : NULL;
    s->node = pulls ? smr_arena_take(a, s->n_nodes, sizeof *s->node) : NULL;
    return self;
}

/* Everything that follows from model and configuration alone. */
static void count(smr *s, const smr_model *model, const smr_config *config)
{
    memset(s, 0, sizeof *s);
    s->model = model;
    s->config = *config;
    s->n = smr_le32(model->n_vertices);
    s->n_triangles = smr_le32(model->n_triangles);
    s->n_parts = smr_le32(model->n_structures);
    s->n_radii = smr_le32(model->n_radii);
    s->n_tasks = smr_ceil_div(s->n, SMR_CHUNK);
    s->n_hinges = smr_le32(model->n_hinges);
    s->n_hinge_tasks = smr_ceil_div(s->n_hinges, SMR_HINGE_CHUNK);
    for (uint32_t i = 0; i < s->n_parts; i++)
        s->n_nodes += smr_tree_nodes(smr_le32(smr_model_record(model, i)->n_triangles));
}

smr_status smr_arena_bytes(const smr_model *model, const smr_config *config, size_t *bytes)
{
    smr s;
    if (model == NULL || config == NULL || bytes == NULL)
        return SMR_E_NULL;
    smr_status status = smr_config_check(config, model);
    if (status != SMR_OK)
        return status;
    count(&s, model, config);
    smr_arena a = smr_arena_measure();
    (void)layout(&a, &s);
    *bytes = a.used;
    return a.used == SIZE_MAX ? SMR_E_INPUT : SMR_OK;
}

static void start_parts(smr *s)
{
    uint32_t leaf = 0, node = 0;
    for (uint32_t i = 0; i < s->n_parts; i++) {
        const smr_stored_structure *r = smr_model_record(s->model, i);
        smr_part *part = &s->part[i];
        memset(part, 0, sizeof *part);
        part->first_vertex = smr_le32(r->first_vertex);
        part->n_vertices = smr_le32(r->n_vertices);
        part->first_triangle = smr_le32(r->first_triangle);
        part->first_leaf = leaf;
        smr_tree_shape(&part->facets, smr_le32(r->n_triangles));
        part->facets.triangle = s->triangle + 3u * (size_t)part->first_triangle;
        part->facets.normal = s->facet_normal + 3u * (size_t)part->first_triangle;
        part->facets.node = s->node == NULL ? NULL : s->node + node;
        leaf += smr_tree_leaves(&part->facets);
        node += smr_tree_nodes(part->facets.n_triangles);
    }
}

static void start_masses(smr *s)
{
    s->mass_unit = 1.0f;
    for (uint32_t v = 0; v < s->n; v++) {
        const float m = smr_full_mass(s, v);
        s->mass_max = smr_max(s->mass_max, m);
        if (m != (float)(uint32_t)m)
            s->mass_unit = SMR_MASS_UNITS;
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
    if (port != NULL)
        s.port = *port;
    s.min_cos = smr_cos_degrees(config->normal_deg);
    if (SMR_BIG_ENDIAN) {
        for (size_t i = 0; i < 3u * (size_t)s.n_triangles; i++)
            s.own_triangle[i] = smr_le32(((const uint32_t *)smr_at(model, model->at_triangles))[i]);
        s.triangle = s.own_triangle;
    } else {
        s.triangle = smr_at(model, model->at_triangles);
    }
    start_parts(&s);
    start_masses(&s);
    if (s.pull != NULL)
        memset(s.pull, 0, s.config.n_workers * (size_t)s.n * 4u * sizeof(int64_t));
    smr_control_start(&s);
    *self = s;
    if (smr_set_pose(self, &identity) != SMR_OK)
        return SMR_E_CONFIG;
    self->fresh = 1;
    *out = self;
    return SMR_OK;
}
