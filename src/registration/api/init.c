/* init.c: divides the arena, and starts a registration at the model's rest shape. Each stage names its slots and fields
 * once: smr_layout() measures for smr_arena_bytes(), places for smr_init(), on a copy on the stack until the arena is
 * known to be large enough, and lists the values of smr_save() and smr_restore().
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_steps.h"
#include "geometry/rotation/rotation.h"
#include "options/references/references.h"
#include "registration/config/config.h"
#include "registration/api/start.h"

/* Returns the parts of an iteration, SMR_PART_..., that model and configuration need. */
static uint32_t parts_of(const smr_shared *shared)
{
    const smr_config *const c = &shared->config;
    const int image = smr_le32(shared->model->profile_samples) > 0u, track = c->track.mode != SMR_TRACK_OFF;
    const int partial = c->partial.coverage != SMR_COVERAGE_WHOLE || c->partial.n_landmarks > 0u || (track && image) ||
                        smr_target_slots(shared) > 0u; /* clouds may be set */
    const int contact = c->contact.share > 0.0f || c->contact.volume > 0.0f || c->contact.smooth > 0.0f;
    const int caller = c->caller.goals || c->caller.force != SMR_CALLER_OFF;
    return SMR_PART_PLAIN | SMR_PART_REFERENCE | (SMR_HAS_IMAGE && image ? SMR_PART_IMAGE : 0u) |
           (SMR_HAS_PARTIAL && partial ? SMR_PART_PARTIAL : 0u) | (SMR_HAS_TRACK && track ? SMR_PART_TRACK : 0u) |
           (SMR_HAS_CONTACT && contact ? SMR_PART_CONTACT : 0u) |
           (SMR_HAS_DYNAMICS && c->dynamics.mode ? SMR_PART_DYNAMICS : 0u) | (caller ? SMR_PART_CALLER : 0u);
}

SMR_SELDOM void smr_count(smr *s, const smr_model *model, const smr_config *config)
{
    memset(s, 0, sizeof *s);
    s->shared.model = model;
    s->shared.config = *config;
    smr_config_settle(&s->shared.config);
    s->shared.n = smr_le32(model->n_vertices);
    s->shared.n_triangles = smr_le32(model->n_triangles);
    s->shared.n_structures = smr_le32(model->n_structures);
    s->shared.n_radii = smr_le32(model->n_radii);
    s->shared.n_dihedrals = smr_le32(model->n_dihedrals);
    if (SMR_HAS_REFERENCES)
        s->shared.n_references = smr_reference_count(model, smr_model_references(model));
    s->shared.n_tasks = smr_ceil_div(s->shared.n, SMR_CHUNK);
    s->shared.parts = parts_of(&s->shared);
}

SMR_SELDOM smr *smr_layout(smr_arena *a, smr *s)
{
    const smr_shared *shared = &s->shared;
    const size_t n_field = SMR_HAS_PARTIAL ? smr_occluded_field_words(shared) : 0u;
    const uint32_t dihedral_tasks = smr_ceil_div(shared->n_dihedrals, SMR_DIHEDRAL_CHUNK);
    smr *self = smr_slot_scratch(a, NULL, 1, sizeof *self);
    s->shared.worker = smr_slot_scratch(a, s->shared.worker, shared->config.basic.n_workers, sizeof *s->shared.worker);
    smr_overlay_layout(a, &s->overlay, shared->n, SMR_WORDS, n_field,
                       smr_max_u32(smr_ceil_div(shared->n, SMR_MATCH_CHUNK), dihedral_tasks));
    smr_shape_layout(a, &s->shape, shared);
    if (SMR_HAS_HELD)
        smr_track_rest_layout(a, &s->shape, shared);
    if (SMR_HAS_DYNAMICS)
        smr_dynamics_layout(a, &s->shape.dynamics, shared);
    if (SMR_HAS_REFERENCES)
        smr_references_layout(a, &s->shape.references, shared);
    smr_forces_layout(a, &s->forces, shared);
    smr_reference_layout(a, &s->reference, shared);
    smr_match_layout(a, &s->match, shared);
    smr_evolve_layout(a, &s->evolve, shared);
    if (SMR_HAS_CONTACT)
        smr_volumes_layout(a, &s->volumes, shared);
    smr_folds_layout(a, &s->folds, shared);
    if (smr_keeps(a))
        a->keeper->fields(a, s);
    return self;
}

/* Sets the pointers of the sources of goals to all that they read, except shared, schedule and shape. */
static void wire_sources(smr_forces *f, const smr_overlay *overlay)
{
    f->image.found = f->found_last;
    f->image.rings = f->smooth.rings = overlay->rings;
    f->points.goals = &f->surface;
    f->points.memory = overlay->spread;
    f->surface.spread = overlay->spread.pull;
    if (!SMR_HAS_PARTIAL)
        return;
    f->landmarks.reach = smr_max(SMR_HARD_EDGES * smr_le_float(f->shared->model->edge_mm), 1.0e-3f);
    f->occluded.shared = f->shared;
    f->occluded.schedule = f->schedule;
    f->occluded.shape = f->shape;
    f->occluded.goals = &f->surface;
    f->occluded.landmarks = &f->landmarks;
    f->occluded.found = f->found_last;
    f->occluded.has_image = &f->image.has_image;
    f->occluded.n_invisible = &f->image.n_invisible;
    smr_occluded_field_wire(&f->occluded, overlay);
}

/* Sets the pointers of each stage to what the stage reads. */
static void wire(smr *s)
{
    smr_forces *f = &s->forces;
    smr_tangent_smooth *tangent = &s->evolve.tangent_smooth;
    const smr_overlay *overlay = &s->overlay;
    s->shape.shared = s->sums.shared = s->reference.shared = s->match.shared = s->evolve.shared = tangent->shared =
        s->volumes.shared = s->folds.shared = &s->shared;
    f->shared = f->surface.shared = f->landmarks.shared = f->points.shared = f->image.shared = f->caller.shared =
        f->smooth.shared = f->contact.shared = &s->shared;
    s->sums.schedule = s->reference.schedule = s->match.schedule = tangent->schedule = s->volumes.schedule =
        s->folds.schedule = &s->schedule;
    f->schedule = f->surface.schedule = f->landmarks.schedule = f->image.schedule = f->caller.schedule =
        f->smooth.schedule = f->contact.schedule = &s->schedule;
    s->reference.shape = s->evolve.shape = tangent->shape = s->volumes.shape = s->folds.shape = &s->shape;
    f->shape = f->surface.shape = f->landmarks.shape = f->points.shape = f->image.shape = f->caller.shape =
        f->smooth.shape = f->contact.shape = &s->shape;
    f->tally = s->reference.tally = s->match.tally = s->evolve.tally = s->folds.tally = overlay->tally;
    wire_sources(f, overlay);
    f->contact.moved_mm = &s->evolve.moved_mm;
    s->sums.record = overlay->record;
    s->sums.sum = overlay->sum;
    s->volumes.sum = overlay->sum;
    s->sums.forces = f;
    s->reference.sums = &s->sums;
    s->match.sums = s->evolve.sums = &s->sums;
    s->match.reference = s->evolve.reference = &s->reference;
    tangent->goals = &f->surface;
    tangent->rings = s->folds.rings = overlay->rings;
    s->folds.tangent_smooth = tangent;
    if (smr_moves(s))
        smr_dynamics_wire(s->shape.dynamics, &s->shared);
}

smr_status smr_arena_bytes(const smr_model *model, const smr_config *config, size_t *bytes)
{
    smr s;
    if (model == NULL || config == NULL || bytes == NULL)
        return SMR_E_NULL;
    if (!smr_model_known(model))
        return SMR_E_MODEL;
    SMR_TRY(smr_config_check(config, model));
    smr_count(&s, model, config);
    smr_arena a = smr_arena_measure();
    (void)smr_layout(&a, &s);
    *bytes = a.used;
    return a.used == SIZE_MAX ? SMR_E_INPUT : SMR_OK;
}

/* ---- smr_init() as a job ---- */

#define SMR_ZERO_PIECE 16384u /* bytes of the arena that a task sets to 0 */

static smr *begun(const void *job) { return ((const smr_starting *)job)->job.s; }
static uint32_t zero_tasks(const void *job)
{
    return (uint32_t)((((const smr_initing *)job)->needed - 1u) / SMR_ZERO_PIECE) + 1u;
}

static void zero_arena(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_initing *j = job;
    const size_t at = (size_t)task * SMR_ZERO_PIECE, left = j->needed - at;
    memset((char *)j->arena + at, 0, left < SMR_ZERO_PIECE ? left : SMR_ZERO_PIECE);
}

/* Places the stages' arrays. The registration is not valid yet. */
static void place(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_initing *j = job;
    smr s;
    smr_arena a;
    smr_count(&s, j->model, &j->config);
    (void)smr_arena_start(&a, j->arena, j->needed);
    smr *self = smr_layout(&a, &s);
    s.placed = self;
    s.arena_bytes = j->needed;
    s.port = j->own;
    s.shared.min_cos = smr_cos_degrees(j->config.forces.normal_deg);
    s.shared.mass_unit = 1.0f;
    s.shared.triangle = SMR_BIG_ENDIAN ? s.shape.own_triangle : smr_at(j->model, j->model->at_triangles);
    const smr_stored_section *const relief = smr_model_section(j->model, SMR_SECTION_RELIEF);
    s.shared.relief = relief == NULL ? NULL : smr_at(j->model, relief->at);
    smr_budget_start(&s);
    *self = s;
    wire(self);
    smr_shape_start(&self->shape);
    if (SMR_HAS_HELD)
        smr_track_rest_wire(&self->shape);
    j->start.job.s = self;
}

static void find_masses(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_shared *c = &begun(job)->shared;
    const smr_piece p = smr_piece_of(task, SMR_START_PIECE, c->n);
    for (uint32_t v = p.first; v < p.last; v++) {
        const float m = smr_mass(c, v);
        if (smr_moves(begun(job)))
            begun(job)->shape.dynamics->mass[v] = m;
        c->mass_max = smr_max(c->mass_max, m);
        if (m != (float)(uint32_t)m)
            c->mass_unit = SMR_MASS_UNITS;
    }
}

static uint32_t triangle_tasks(const void *job)
{
    return smr_ceil_div(begun(job)->shared.n_triangles, SMR_TRIANGLE_CHUNK);
}

/* Copies triangles into host order where that differs, and marks their corners. */
static void mark_triangles(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr *s = begun(job);
    const smr_piece p = smr_piece_of(task, SMR_TRIANGLE_CHUNK, s->shared.n_triangles);
    const uint32_t *stored = smr_at(s->shared.model, s->shared.model->at_triangles);
    for (size_t i = 3u * (size_t)p.first; SMR_BIG_ENDIAN && i < 3u * (size_t)p.last; i++)
        s->shape.own_triangle[i] = smr_le32(stored[i]);
    smr_shape_mark(&s->shape, p.first, p.last);
}

static uint32_t bulk_tasks(const void *job)
{
    return SMR_HAS_CONTACT && (begun(job)->volumes.kept != NULL || begun(job)->forces.contact.closed != NULL);
}

/* Measures the structures' volumes at rest, a piece of one at a time. */
static void find_bulk(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr *s = j->job.s;
    if (SMR_HAS_CONTACT && smr_bulk_add(&j->bulk, &s->shape, j->k, NULL)) {
        smr_volumes_model(&s->volumes, j->k, &j->bulk);
        smr_contact_model(&s->forces.contact, j->k, &j->bulk);
        j->bulk = (smr_bulk){.at = 0};
        j->k++;
    }
    if (j->k < s->shared.n_structures)
        smr_job_again(&j->job.head);
}

/* Adds triangles to the sums of areas by which the model is a sheet or not. Triangles of a structure lie in a row. */
static void find_areas(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr *s = j->job.s;
    const smr_piece p = smr_piece_of(task, SMR_TRIANGLE_CHUNK, s->shared.n_triangles);
    for (uint32_t k = p.first, end; SMR_HAS_PARTIAL && k < p.last; k = end) {
        const uint32_t owner = smr_model_owner(s->shared.model, smr_model_triangle(&s->shared, k)[0]);
        const smr_shape_structure *one = &s->shape.structure[owner];
        const uint32_t behind = one->first_triangle + one->tree.n_triangles;
        end = behind > k ? smr_min_u32(p.last, behind) : p.last;
        smr_occluded_field_add(&s->shared, k, end, &j->area, &j->areas);
        if (end != behind)
            continue;
        j->open += smr_length(j->area);
        j->area = smr_v(0, 0, 0);
    }
    if (SMR_HAS_PARTIAL)
        smr_occluded_field_model(&s->forces.occluded, j->open, j->areas);
}

static uint32_t smooth_tasks(const void *job)
{
    const smr *s = begun(job);
    return SMR_HAS_CONTACT && s->forces.smooth.height != NULL ? s->shared.n_tasks + smr_triangle_tasks(&s->shared) : 0u;
}

static void sum_rings(void *job, uint32_t task, uint32_t worker)
{
    if (SMR_HAS_CONTACT)
        smr_smooth_sum(&begun(job)->forces.smooth, task, worker);
}

static uint32_t height_tasks(const void *job) { return smooth_tasks(job) > 0u ? begun(job)->shared.n_tasks : 0u; }

static void find_heights(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    if (SMR_HAS_CONTACT)
        smr_smooth_rest(&begun(job)->forces.smooth, task);
}

static void finish(void *job, SMR_UNUSED uint32_t task, uint32_t worker)
{
    smr_initing *j = job;
    smr *s = j->start.job.s;
    s->log.fresh = 1;
    s->log.changes = 1;
    s->magic = SMR_STATE_MAGIC;
    if (j->then != NULL) {
        j->then(j, 0, worker);
        return;
    }
    smr_guard_close(s);
    *j->out = s;
}

static const smr_stage stages_behind[] = {
    {smooth_tasks, sum_rings, smr_in_order, NULL},
    {height_tasks, find_heights, smr_in_order, NULL},
    {NULL, finish, NULL, NULL},
};

static void go_behind(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_job_go(job, stages_behind, sizeof stages_behind / sizeof stages_behind[0]);
}

static void go_masses(void *job, uint32_t task, uint32_t worker)
{
    smr_starting *j = job;
    j->then = go_behind;
    if (smr_moves(j->job.s))
        smr_start_masses_go(j);
    else
        go_behind(j, task, worker);
}

/* Sets the start positions: the rest shape. */
static void go_start(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_starting *j = job;
    j->pose = identity;
    j->then = go_masses;
    j->wrong = SMR_E_CONFIG;
    smr_start_go(j);
}

static const smr_stage stages_before[] = {
    {zero_tasks, zero_arena, smr_in_order, NULL},
    {NULL, place, NULL, NULL},
    {smr_start_vertices, find_masses, smr_in_order, NULL},
    {triangle_tasks, mark_triangles, smr_in_order, NULL},
    {bulk_tasks, find_bulk, NULL, NULL}, /* comes back for each piece */
    {triangle_tasks, find_areas, smr_in_order, NULL},
    {NULL, go_start, NULL, NULL},
};

SMR_SELDOM smr_status smr_init_check(smr_initing *j, const smr_model *model, const smr_config *config,
                                     const smr_port *port, void *arena, size_t bytes, smr **out)
{
    smr_arena a;
    if (out == NULL || j == NULL)
        return SMR_E_NULL;
    size_t needed;
    SMR_TRY(smr_arena_bytes(model, config, &needed));
    SMR_TRY(smr_arena_start(&a, arena, bytes));
    if (port != NULL && (port->n_workers < 1u || port->n_workers > config->basic.n_workers))
        return SMR_E_CONFIG;
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(arena, bytes);
    memset(j, 0, sizeof *j);
    j->model = model;
    j->config = *config;
    j->arena = arena;
    j->needed = needed;
    j->out = out;
    if (port != NULL)
        j->own = (smr_port){port->ctx, port->n_workers, port->parallel, port->now_ns};
    j->start.job.head = smr_job_begin(stages_before, sizeof stages_before / sizeof stages_before[0], port);
    return SMR_OK;
}

smr_status smr_init_begin(const smr_model *model, const smr_config *config, const smr_port *port, void *arena,
                          size_t bytes, smr **s, smr_job *job)
{
    return smr_init_check((smr_initing *)(void *)job, model, config, port, arena, bytes, s);
}

smr_status smr_init(const smr_model *model, const smr_config *config, const smr_port *port, void *arena, size_t bytes,
                    smr **s)
{
    smr_job job;
    return smr_job_whole(smr_init_begin(model, config, port, arena, bytes, s, &job), &job, &smr_alone);
}
