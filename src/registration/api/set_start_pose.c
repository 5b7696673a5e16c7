/* set_start_pose.c: sets the start positions of a registration: the rest shape in a pose, or given positions. A job
 * (base/job.h). Nothing is written until all positions are checked; from then on no other call is allowed.
 * Bounds: about ten passes over vertices and two over triangles, in tasks of SMR_START_PIECE and SMR_TRIANGLE_CHUNK.
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_steps.h"
#include "geometry/surface/mesh.h"
#include "options/references/references.h"
#include "registration/api/start.h"

#define SMR_FAR_OFF 500.0f     /* distance of the model from the origin, mm, from which on the origin is moved */
#define SMR_POSE_LEAST 1.0e-9f /* smallest legal determinant of a pose (metres to kilometres); reflections are below */
#define SMR_POSE_MOST 1.0e9f   /* largest legal determinant of a pose (kilometres to metres) */
#define SMR_BORDER (SMR_COORD_MAX + 1.0f) /* mm: rounding may move a rest shape a little beyond SMR_COORD_MAX */
#define SMR_RIGID_MM 0.01f /* largest distance of a start position from the rest shape in a rigid pose, mm */
#define SMR_FITS (SMR_START_PIECE / SMR_MATCH_CHUNK) /* tasks of the rest pose's fit in a task */

static smr *of(void *job) { return ((smr_starting *)job)->job.s; }
static const smr *in(const void *job) { return ((const smr_starting *)job)->job.s; }
static uint32_t pieces(uint32_t n) { return smr_ceil_div(n, SMR_START_PIECE); }
static smr_piece piece_of(const smr *s, uint32_t task) { return smr_piece_of(task, SMR_START_PIECE, s->shared.n); }

uint32_t smr_start_vertices(const void *job) { return pieces(in(job)->shared.n); }
static int is_last(const void *job, uint32_t task) { return task + 1u == smr_start_vertices(job); }

/* Returns the number of vertices whose positions are set, and in *first the first of them in the caller's numbering. */
static uint32_t given(const smr_starting *j, uint32_t *first)
{
    const int all = j->xyz == NULL || j->structure == SMR_ALL;
    const smr_shape_structure *const one = j->job.s->shape.structure + (all ? 0u : j->structure);
    *first = one->first_vertex;
    return all ? j->job.s->shared.n : one->n_vertices;
}

static uint32_t n_given(const smr_starting *j) { return given(j, &(uint32_t){0}); }

static uint32_t given_tasks(const void *job) { return pieces(n_given(job)); }

/* Returns the point p of the model in the pose. Not inlined, which saves room. */
SMR_SHARED static smr_vec posed(const smr_starting *j, smr_vec p) { return smr_pose_apply(&j->pose, p); }

static void check_given(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    const smr_shared *c = &of(j)->shared;
    const smr_piece p = smr_piece_of(task, SMR_START_PIECE, n_given(j));
    const smr_vec centre = smr_model_centre(c->model);
    int legal = j->xyz == NULL || smr_all_within(j->xyz + 3u * (size_t)p.first, 3u * (p.last - p.first), SMR_COORD_MAX);
    for (uint32_t v = p.first; v < p.last && j->xyz == NULL; v++)
        legal &= smr_within3(posed(j, smr_add(smr_rest(c, v), centre)), SMR_BORDER);
    if (!legal)
        j->job.head.status = j->wrong;
}

/* Keeps other calls out, and chooses the origin of a pose. */
static void claim(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr *s = of(j);
    s->ticking = SMR_STARTING;
    j->claimed = 1;
    s->shape.in_parts = 0;
    if (j->xyz != NULL)
        return;
    const smr_vec moved = posed(j, smr_model_centre(s->shared.model));
    s->shape.origin = smr_whole(moved);
    j->shift = smr_sub(moved, s->shape.origin);
    j->pose.m[0][3] = j->pose.m[1][3] = j->pose.m[2][3] = 0.0f;
}

static void place_given(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_starting *j = job;
    const smr *s = j->job.s;
    uint32_t first;
    const smr_piece p = smr_piece_of(task, SMR_START_PIECE, given(j, &first));
    for (uint32_t i = p.first; i < p.last && j->xyz == NULL; i++)
        smr_put3(s->shape.x, i, smr_add(posed(j, smr_rest(&s->shared, i)), j->shift));
    for (uint32_t i = p.first; i < p.last && j->xyz != NULL; i++) {
        const smr_vec x = smr_load(j->xyz + 3u * (size_t)i);
        smr_put3(s->shape.x, smr_model_position(s->shared.model, first + i), smr_sub(x, s->shape.origin));
    }
}

SMR_SHARED void smr_start_add_to_box(smr_starting *j, uint32_t task, float *xyz)
{
    const smr_piece p = piece_of(j->job.s, task);
    if (task == 0u)
        j->box = (smr_box){smr_get3(xyz, 0), smr_get3(xyz, 0)};
    for (uint32_t v = p.first; v < p.last; v++)
        smr_box_grow(&j->box, smr_get3(xyz, v));
}

/* Finds the box around the positions; then moves the origin, by whole millimetres, to the middle of a model far off. */
static void find_middle(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr_shape *shape = &of(j)->shape;
    smr_start_add_to_box(j, task, shape->x);
    if (!is_last(j, task))
        return;
    j->shift = smr_whole(smr_scale(smr_add(j->box.lo, j->box.hi), 0.5f));
    if (smr_dot(j->shift, j->shift) < SMR_FAR_OFF * SMR_FAR_OFF)
        j->shift = smr_v(0, 0, 0);
    else
        shape->origin = smr_add(shape->origin, j->shift);
}

static uint32_t shift_tasks(const void *job)
{
    const smr_vec shift = ((const smr_starting *)job)->shift;
    return smr_dot(shift, shift) > 0.0f ? smr_start_vertices(job) : 0u;
}

static void shift_origin(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_starting *j = job;
    const smr *s = j->job.s;
    const smr_piece p = piece_of(s, task);
    for (uint32_t v = p.first; v < p.last; v++)
        smr_put3(s->shape.x, v, smr_sub(smr_get3(s->shape.x, v), j->shift));
}

static void fit_rest(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_shape *shape = &of(job)->shape;
    const uint32_t n = smr_ceil_div(shape->shared->n, SMR_MATCH_CHUNK);
    for (uint32_t k = SMR_FITS * task; k < smr_min_u32(n, SMR_FITS * (task + 1u)); k++)
        smr_rest_pose_sum(shape, k, 0);
    if (is_last(job, task))
        smr_rest_pose_end(shape);
}

/* Copies a piece of the positions to the start and the reference shape, and clears forces and normals. */
static void copy_start(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr *s = of(j);
    const smr_piece p = piece_of(s, task);
    const size_t first = 3u * (size_t)p.first, bytes = 3u * (size_t)(p.last - p.first) * sizeof(float);
    memcpy(s->shape.start + first, s->shape.x + first, bytes);
    memcpy(s->shape.x_ref + first, s->shape.x + first, bytes);
    memcpy(s->shape.x_next + first, s->shape.x + first, bytes);
    memset(s->shape.normal + first, 0, bytes);
    memset(s->forces.force + first, 0, bytes);
    memset(s->folds.marked + p.first, 0, p.last - p.first);
    s->folds.n_guarded = 0;
    j->k = j->at = 0;
}

static uint32_t reset_tasks(const void *job)
{
    const smr_basic_config *c = &in(job)->shared.config.basic;
    return pieces(smr_max_u32(in(job)->shared.n * c->n_workers, c->n_target_vertices));
}

static void reset_arrays(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_iteration_reset(of(job), task, reset_tasks(job));
}

uint32_t smr_start_in_parts(const void *job) { return in(job)->shared.n_structures > 1u; }

/* Fits a rigid pose of the rest shape to the start of each structure, then of all, and measures the distances left.
 * Sets in_parts where each structure is rigid and the whole is not. */
SMR_SELDOM void smr_start_find_parts(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr_shape *shape = &of(j)->shape;
    const smr_shared *c = shape->shared;
    const int all = j->k == c->n_structures;
    const uint32_t n = all ? c->n : shape->structure[j->k].n_vertices,
                   at = all ? 0u : shape->structure[j->k].first_vertex;
    if (j->at == 0u) {
        smr_fit_start(&j->fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
        j->most = 0.0f;
    }
    for (uint32_t end = smr_min_u32(2u * n, j->at + SMR_START_PIECE); j->at < end; j->at++) {
        const uint32_t v = smr_model_position(c->model, at + j->at % n);
        const smr_vec rest = smr_rest(c, v), start = smr_get3(shape->start, v);
        if (j->at == n)
            j->pose = smr_fit_solve(&j->fit, 0);
        if (j->at < n) {
            smr_fit_add(&j->fit, rest, start, 1.0f);
            continue;
        }
        const smr_vec off = smr_sub(posed(j, rest), start);
        j->most = smr_max(j->most, smr_dot(off, off));
    }
    const int over = j->at == 2u * n, rigid = j->most <= SMR_RIGID_MM * SMR_RIGID_MM;
    if (over && all)
        shape->in_parts = !rigid;
    if (over) {
        j->k++;
        j->at = 0;
    }
    if (!over || (rigid && !all))
        smr_job_again(&j->job.head);
}

static uint32_t refit_tasks(const void *job) { return in(job)->shape.in_parts ? smr_start_vertices(job) : 0u; }
static uint32_t blend_tasks(const void *job) { return smr_blends(&in(job)->shape) ? smr_start_vertices(job) : 0u; }

static void blend_start(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_piece p = piece_of(of(job), task);
    if (SMR_HAS_REFERENCES)
        smr_references_start(&of(job)->shape, ((smr_starting *)job)->xyz == NULL, p.first, p.last);
}

void smr_start_box(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr_start_add_to_box(j, task, of(j)->shape.start);
    of(j)->shape.start_box = j->box;
}

uint32_t smr_start_fits(const void *job)
{
    const smr *s = in(job);
    return SMR_HAS_CONTACT && (s->volumes.kept != NULL || s->forces.smooth.height != NULL) ? smr_start_vertices(job)
                                                                                           : 0u;
}

/* Finds scale and side of the start, which volumes and heights at rest depend on. */
void smr_start_scale_fit(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr *s = of(j);
    const smr_piece p = piece_of(s, task);
    smr_start_fit(&s->shape, &j->fit, p.first, p.last);
    if (!is_last(j, task))
        return;
    s->forces.smooth.side = smr_start_mirrored(&j->fit) ? -1.0f : 1.0f;
    if (SMR_HAS_CONTACT)
        smr_volumes_scale(&s->volumes, smr_start_scale(&j->fit), s->forces.smooth.side);
    j->k = 0;
    j->bulk = (smr_bulk){.at = 0};
}

static uint32_t volume_tasks(const void *job) { return (uint32_t)smr_volumes_used(&in(job)->volumes); }

/* Measures the volumes of structures, a piece of one at a time. */
static void find_volumes(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr *s = of(j);
    while (SMR_HAS_CONTACT && j->k < s->shared.n_structures && !smr_volume_asked(&s->volumes, j->k))
        j->k++;
    if (!SMR_HAS_CONTACT || j->k == s->shared.n_structures)
        return;
    if (smr_bulk_add(&j->bulk, &s->shape, j->k, s->shape.x)) {
        smr_volumes_start(&s->volumes, j->k++, j->bulk.mm3);
        j->bulk = (smr_bulk){.at = 0};
    }
    smr_job_again(&j->job.head);
}

uint32_t smr_start_leaves(const void *job) { return smr_triangles_tasks(&in(job)->shape); }
uint32_t smr_start_uppers(const void *job) { return smr_uppers_tasks(&in(job)->shape); }

void smr_start_refit_leaves(void *job, uint32_t task, uint32_t worker)
{
    smr_triangles_follow(&of(job)->shape, of(job)->shape.x);
    smr_triangles_refit(&of(job)->shape, task, worker);
}

void smr_start_refit_uppers(void *job, uint32_t task, uint32_t worker)
{
    smr_uppers_refit(&of(job)->shape, task, worker);
}

static uint32_t motion_tasks(const void *job) { return smr_moves(in(job)) ? smr_start_vertices(job) : 0u; }

static void copy_motion(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    if (SMR_HAS_DYNAMICS)
        smr_time_steps_copy(of(job), piece_of(of(job), task));
}

static uint32_t normal_tasks(const void *job) { return smr_triangle_tasks(&in(job)->shared); }

static void add_normals(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr *s = of(job);
    const smr_piece p = smr_piece_of(task, SMR_TRIANGLE_CHUNK, s->shared.n_triangles);
    smr_mesh_add_normals(s->shape.x, s->shared.triangle, s->shared.n, p.first, p.last, s->shape.normal, NULL);
}

static void end_normals(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr *s = of(job);
    const smr_piece p = piece_of(s, task);
    for (uint32_t v = p.first; v < p.last; v++) {
        smr_put3(s->shape.normal, v, smr_unit(smr_get3(s->shape.normal, v)));
        smr_put3(s->shape.normal_ref, v, smr_get3(s->shape.normal, v));
    }
}

static void start_schedule(void *job, SMR_UNUSED uint32_t task, uint32_t worker)
{
    smr_starting *j = job;
    smr *s = of(j);
    memset(&s->report, 0, sizeof s->report);
    s->refused = s->schedule.serial = s->ticking = j->claimed = 0;
    smr_schedule_start(s);
    if (j->then != NULL)
        j->then(j, 0, worker);
}

/* The positions are set, all results of the iteration before are discarded, and the schedule starts. */
static const smr_stage stages[] = {
    {given_tasks, check_given, smr_in_order, NULL},
    {NULL, claim, NULL, NULL},
    {given_tasks, place_given, smr_in_order, NULL},
    {smr_start_vertices, find_middle, smr_in_order, NULL},
    {shift_tasks, shift_origin, smr_in_order, NULL},
    {smr_start_vertices, fit_rest, smr_in_order, NULL},
    {smr_start_vertices, copy_start, smr_in_order, NULL},
    {smr_start_in_parts, smr_start_find_parts, NULL, NULL}, /* comes back for each piece */
    {refit_tasks, fit_rest, smr_in_order, NULL},
    {blend_tasks, blend_start, smr_in_order, NULL},
    {smr_start_vertices, smr_start_box, smr_in_order, NULL},
    {motion_tasks, copy_motion, smr_in_order, NULL},
    {smr_start_fits, smr_start_scale_fit, smr_in_order, NULL},
    {volume_tasks, find_volumes, NULL, NULL}, /* likewise */
    {smr_start_leaves, smr_start_refit_leaves, smr_in_order, NULL},
    {smr_start_uppers, smr_start_refit_uppers, smr_in_order, NULL},
    {reset_tasks, reset_arrays, smr_in_order, NULL},
    {normal_tasks, add_normals, smr_in_order, NULL},
    {smr_start_vertices, end_normals, smr_in_order, NULL},
    {NULL, start_schedule, NULL, NULL},
};

void smr_start_go(smr_starting *j) { smr_job_go(&j->job.head, stages, sizeof stages / sizeof stages[0]); }

static void note_start(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    const void *const what = j->xyz == NULL ? (const void *)&j->given : j->xyz;
    const uint32_t given_as = j->structure == SMR_ALL ? SMR_LOG_ALL_POSITIONS : SMR_LOG_POSITIONS;
    const uint32_t kind = j->xyz == NULL ? SMR_LOG_POSE : given_as;
    smr_changed(of(j), kind, j->xyz == NULL ? 0u : j->structure, what, j->xyz == NULL ? 0u : n_given(j));
}

/* Keeps other calls out of a step, and behind it, once positions are written. */
static int guard(void *job, int enter)
{
    smr_starting *j = job;
    smr *s = of(j);
    const uint32_t busy = j->claimed ? SMR_STARTING : 0u;
    if (!smr_hold_guard(&j->job, enter, s->n_awaited == 0u && s->ticking == busy))
        return 0;
    if (busy != 0u)
        s->ticking = busy;
    if (enter)
        s->guard.closed = 0; /* the struct changes */
    else
        smr_guard_close(s);
    return 1;
}

/* Begins to set positions, which are known to be legal for the registration. */
SMR_SELDOM static void begin(smr *s, smr_starting *j)
{
    memset(j, 0, sizeof *j);
    j->job = smr_measure_begin(s, stages, sizeof stages / sizeof stages[0]);
    j->job.head.guard = guard;
    j->then = note_start;
    j->claimed = s->ticking == SMR_STARTING; /* positions are half those of a job that was left */
    j->wrong = SMR_E_INPUT;
}

/* Checks that positions may be set; again 1: also while another job is setting them. */
SMR_SELDOM static smr_status may_start(const smr *s, int again)
{
    if (s == NULL)
        return SMR_E_NULL;
    const int busy = s->ticking != 0u && !(again && s->ticking == SMR_STARTING);
    return smr_valid(s) && !busy && s->n_awaited == 0u ? smr_sound(s) : SMR_E_STATE;
}

SMR_SELDOM smr_status smr_set_pose_begin(smr *s, const smr_pose *pose, smr_job *job)
{
    smr_starting *const j = (smr_starting *)(void *)job;
    SMR_TRY(pose == NULL || job == NULL ? SMR_E_NULL : may_start(s, 1));
    if (!smr_all_within(&pose->m[0][0], 12, SMR_COORD_MAX))
        return SMR_E_INPUT;
    const float volume = smr_dot(smr_column(pose, 0), smr_cross(smr_column(pose, 1), smr_column(pose, 2)));
    if (!(volume >= SMR_POSE_LEAST && volume <= SMR_POSE_MOST) ||
        !smr_within3(smr_pose_apply(pose, smr_model_centre(s->shared.model)), SMR_BORDER))
        return SMR_E_INPUT;
    const smr_pose given = *pose; /* may lie in the job */
    begin(s, j);
    j->pose = j->given = given;
    return SMR_OK;
}

SMR_SELDOM smr_status smr_set_positions_begin(smr *s, uint32_t structure, const float *xyz, smr_job *job)
{
    smr_starting *const j = (smr_starting *)(void *)job;
    SMR_TRY(xyz == NULL || job == NULL ? SMR_E_NULL : may_start(s, 0));
    if (structure >= s->shared.n_structures && structure != SMR_ALL)
        return SMR_E_INPUT;
    begin(s, j);
    j->xyz = xyz;
    j->structure = structure;
    return SMR_OK;
}

SMR_SELDOM smr_status smr_set_pose(smr *s, const smr_pose *pose)
{
    smr_job job;
    return smr_job_whole(smr_set_pose_begin(s, pose, &job), &job, &smr_alone);
}

SMR_SELDOM smr_status smr_set_positions(smr *s, uint32_t structure, const float *xyz)
{
    smr_job job;
    return smr_job_whole(smr_set_positions_begin(s, structure, xyz, &job), &job, &smr_alone);
}
