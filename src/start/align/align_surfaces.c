/* align_surfaces.c: smr_align() as a job: the work that the steps of align_steps.c request, in parallel over poses and
 * samples. Poses of a list are refined together, as many as there are samples for.
 * Bounds: SMR_ALIGN_WORK of a search, a part of a pose of the coarse search, or SMR_ALIGN_COLLECT pairs in a task.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "start/align/align.h"

typedef struct align_job {
    smr_job_head head;
    smr_align_work *w;
    uint32_t changes; /* sum of the surfaces' smr_surface.changes at the begin */
} align_job;

_Static_assert(sizeof(align_job) <= SMR_JOB_BYTES, "an alignment in progress is found by the caller's job");

smr_align_config smr_align_config_default(void)
{
    return (smr_align_config){
        .cookie = SMR_COOKIE('A', smr_align_config), .scaled = 1, .iterations = 60, .samples = 600};
}

static int is_legal(const smr_align_config *c)
{
    return c->cookie == SMR_COOKIE('A', smr_align_config) && c->scaled <= 1u && c->iterations >= 1u &&
           c->iterations <= 1000u && c->n_parts <= SMR_STRUCTURES_MAX && (c->n_parts == 0u || c->part != NULL) &&
           c->samples >= 16u && c->samples <= 100000u &&
           (c->port == NULL || (c->port->n_workers >= 1u && c->port->n_workers <= SMR_WORKERS_MAX));
}

static uint32_t n_slices(const smr_align_config *config)
{
    return config->port != NULL ? smr_max_u32(config->port->n_workers, SMR_ALIGN_SLICES) : SMR_ALIGN_SLICES;
}

static void layout(smr_arena *arena, const smr_align_config *config, smr_align_work **work, smr_coarse_place **place,
                   smr_align_slice **slice, smr_joint **joint, smr_aligner *a)
{
    const uint32_t n = config->samples;
    *work = smr_arena_take(arena, 1, sizeof **work);
    *place = smr_arena_take(arena, SMR_ALIGN_PLACES, sizeof **place);
    *slice = smr_arena_take(arena, n_slices(config), sizeof **slice);
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        a->side[side].point = smr_arena_take(arena, n, sizeof(smr_vec));
        a->side[side].normal = smr_arena_take(arena, n, sizeof(smr_vec));
        a->side[side].weight = smr_arena_take(arena, n, sizeof(float));
        a->side[side].pair = smr_arena_take(arena, n, sizeof(smr_pair));
    }
    *joint = smr_arena_take(arena, config->n_parts, sizeof **joint);
}

smr_status smr_align_bytes(const smr_align_config *config, size_t *bytes)
{
    smr_align_work *work;
    smr_coarse_place *place;
    smr_align_slice *slice;
    smr_joint *joint;
    smr_aligner a;
    if (config == NULL || bytes == NULL)
        return SMR_E_NULL;
    if (!is_legal(config))
        return SMR_E_CONFIG;
    smr_arena arena = smr_arena_measure();
    layout(&arena, config, &work, &place, &slice, &joint, &a);
    *bytes = arena.used;
    return SMR_OK;
}

/* ---- the stages ---- */

/* Stages that others go back or on to. */
enum {
    SMR_ALIGN_SIDES,
    SMR_ALIGN_STEP = 2,
    SMR_ALIGN_GROUPS = 4,
    SMR_ALIGN_PAIRS,
    SMR_ALIGN_MEASURES = 7,
    SMR_ALIGN_JOINT = 12
};

static smr_align_work *work_of(const void *job) { return ((const align_job *)job)->w; }

static uint32_t joint_tasks(const void *job) { return smr_joint_tasks(work_of(job)); }
static void find_joint(void *job, uint32_t task, SMR_UNUSED uint32_t worker) { smr_joint_find(work_of(job), task); }

static void begin_part(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    align_job *const j = job;
    const int searched = smr_align_begin_part(j->w);
    j->head.next_stage = searched < 0 ? j->head.n_stages : (uint32_t)(searched ? SMR_ALIGN_SIDES : SMR_ALIGN_JOINT);
}

static uint32_t side_tasks(const void *job)
{
    const smr_align_work *w = work_of(job);
    return smr_align_side_tasks(&w->aligner.side[SMR_MODEL]) + smr_align_side_tasks(&w->aligner.side[SMR_TARGET]);
}

static void make_sides(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_align_work *w = work_of(job);
    const uint32_t n = smr_align_side_tasks(&w->aligner.side[SMR_MODEL]), side = task < n ? SMR_MODEL : SMR_TARGET;
    smr_align_side_make(&w->aligner.side[side], &w->sum[side], task < n ? task : task - n);
}

static uint32_t disc_tasks(const void *job) { return (void)job, SMR_SIDES * SMR_DISC_TASKS; }

static void make_discs(void *job, uint32_t task, SMR_UNUSED uint32_t worker) { smr_discs_make(work_of(job), task); }

/* Runs a step of the call. Another step follows, unless the step requests work. */
static void run_step(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    align_job *const j = job;
    const int result = smr_align_step(j->w);
    if (result < 0 && j->w->current == NULL)
        j->head.status = SMR_E_INPUT;
    else if (result == 0)
        j->head.next_stage = SMR_ALIGN_STEP;
    else if (result == SMR_ALIGN_MEASURE)
        j->head.next_stage = SMR_ALIGN_MEASURES;
    else if (result != 1) {
        smr_align_end_part(j->w, result == SMR_ALIGN_END);
        j->head.next_stage = SMR_ALIGN_JOINT;
    }
}

/* Tasks visit the first part of SMR_ALIGN_PLACES poses, the other parts, then the next poses. */
static uint32_t try_places(const void *job) { return (void)job, SMR_ALIGN_PLACES; }
static uint32_t try_tasks(const void *job)
{
    return smr_ceil_div(work_of(job)->n_tried, SMR_ALIGN_PLACES) * SMR_ALIGN_PLACES * SMR_COARSE_PARTS;
}

/* Returns the number of the pose of a task; n_tried or more: none. */
static uint32_t tried_by(uint32_t task)
{
    return task / (SMR_ALIGN_PLACES * SMR_COARSE_PARTS) * SMR_ALIGN_PLACES + task % SMR_ALIGN_PLACES;
}
static uint32_t part_of(uint32_t task) { return task / SMR_ALIGN_PLACES % SMR_COARSE_PARTS; }

static void try_pose(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_align_work *w = work_of(job);
    if (tried_by(task) < w->n_tried)
        smr_align_try(&w->aligner, &w->coarse, &w->search, tried_by(task), part_of(task),
                      &w->place[task % SMR_ALIGN_PLACES]);
}

static void take_poses(void *job, uint32_t first, uint32_t last)
{
    smr_align_work *w = work_of(job);
    for (uint32_t task = first; task < last; task++)
        if (part_of(task) + 1u == SMR_COARSE_PARTS && tried_by(task) < w->n_tried)
            smr_align_tried(&w->search, tried_by(task), &w->place[task % SMR_ALIGN_PLACES], &w->found);
}

/* Starts the refinement of as many poses as there are samples for. */
static void begin_group(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_align_work *w = work_of(job);
    w->n_tried = 0;
    w->last = w->rounds == 0u;
    w->n = smr_min_u32(smr_min_u32(w->all / w->aligner.used, SMR_ALIGN_GROUP), w->from->n - w->first);
    for (uint32_t i = 0; i < w->n; i++)
        w->group[i] = (smr_refined){.pose = w->from->pose[w->first + i], .last = FLT_MAX, .state = SMR_REFINE_GOES_ON};
}

static smr_aligner aligner_of(const smr_align_work *w, uint32_t i)
{
    smr_aligner a = w->aligner;
    for (uint32_t side = 0; side < SMR_SIDES; side++)
        a.side[side].pair += (size_t)i * a.used;
    return a;
}

static uint32_t n_pairs(const smr_align_work *w) { return w->n * SMR_SIDES * w->aligner.used; }

static uint32_t pairs_tasks(const void *job)
{
    const smr_align_work *w = work_of(job);
    return w->at_once ? w->n * SMR_SIDES * smr_ceil_div(w->aligner.used, SMR_ALIGN_PIECE) : w->n_slices;
}

/* Finds pairs of pose i of the group. Returns 0 when the work ended. */
static int find_piece(const smr_align_work *w, uint32_t i, uint32_t side, smr_piece piece, smr_pause *pause)
{
    const smr_refined *r = &w->group[i];
    smr_aligner a = aligner_of(w, i);
    a.far2 = smr_min(a.far2, smr_align_range2(w, r));
    if (r->state != SMR_REFINE_GOES_ON && (!w->last || r->state == SMR_REFINE_FAILED))
        return 1;
    if (r->round >= w->disc_rounds)
        return smr_pairs_find(&a, side, &r->pose, piece, pause);
    smr_discs_find(&a, &w->discs[side == SMR_MODEL ? SMR_TARGET : SMR_MODEL], side, &r->pose, piece);
    return 1;
}

static void find_some(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_align_work *w = work_of(job);
    const uint32_t used = w->aligner.used, pieces = smr_ceil_div(used, SMR_ALIGN_PIECE), pair = w->next_pair + task;
    if (w->at_once) {
        (void)find_piece(w, task / (SMR_SIDES * pieces), task / pieces % SMR_SIDES,
                         smr_piece_of(task % pieces, SMR_ALIGN_PIECE, used), NULL);
        return;
    }
    smr_align_slice *const slice = &w->slice[task];
    if (pair >= n_pairs(w) || slice->done)
        return;
    slice->pause.left = SMR_ALIGN_WORK;
    slice->done = (uint32_t)find_piece(w, pair / (SMR_SIDES * used), pair / used % SMR_SIDES,
                                       (smr_piece){pair % used, pair % used + 1u}, &slice->pause);
}

/* Goes back to the searches that are not complete, or to the next ones. */
static void end_pairs(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    align_job *const j = job;
    smr_align_work *w = j->w;
    uint32_t left = 0;
    for (uint32_t k = 0; k < w->n_slices && !w->at_once; k++)
        left += w->next_pair + k < n_pairs(w) && !w->slice[k].done;
    if (left == 0u) {
        for (uint32_t k = 0; k < w->n_slices && !w->at_once; k++)
            w->slice[k].done = 0;
        w->next_pair += w->n_slices;
    }
    if (left > 0u || (!w->at_once && w->next_pair < n_pairs(w)))
        j->head.next_stage = SMR_ALIGN_PAIRS;
    else
        w->next_pair = 0;
}

static uint32_t group_tasks(const void *job) { return work_of(job)->n; }

/* Returns what is measured: outlier limits of rounds, costs of refined poses, or what a step has requested. */
static uint32_t measures_of(const smr_align_work *w)
{
    if (!w->last)
        return w->how & SMR_REFINE_TRIMMED ? SMR_MEASURE_RANKS : 0u;
    return w->into != NULL ? SMR_MEASURE_SUMS : w->of;
}

/* Tasks visit a piece of the samples for each pose of the group, then the next piece. */
static uint32_t measure_tasks(const void *job)
{
    const smr_align_work *w = work_of(job);
    return w->n * smr_ceil_div(smr_measure_visits(&w->aligner, measures_of(w)), SMR_ALIGN_VISITS);
}

static void measure_some(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_align_work *w = work_of(job);
    const uint32_t i = task % w->n, of = measures_of(w);
    smr_refined *const r = &w->group[i];
    const smr_aligner a = aligner_of(w, i);
    if (r->state != SMR_REFINE_GOES_ON && (!w->last || r->state == SMR_REFINE_FAILED))
        return;
    if (task < w->n)
        smr_measure_start(&a, of, w->last && w->into == NULL ? w->parts : NULL, &r->measure);
    smr_measure_run(&a, &r->measure, smr_piece_of(task / w->n, SMR_ALIGN_VISITS, smr_measure_visits(&a, of)));
}

/* Sets the outlier limit of a pose of the group, or computes the refined pose's cost. */
static void find_limit(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_align_work *w = work_of(job);
    smr_refined *const r = &w->group[task];
    const smr_aligner a = aligner_of(w, task);
    if (w->last && w->into != NULL && r->state != SMR_REFINE_FAILED)
        r->cost = smr_measure_cost(&a, &r->measure);
    if (!w->last && r->state == SMR_REFINE_GOES_ON)
        smr_align_limit(&a, w->how, r);
}

/* Tasks visit a piece of the pairs for each pose of the group, then the next piece. */
static uint32_t collect_tasks(const void *job)
{
    const smr_align_work *w = work_of(job);
    return w->last ? 0u : w->n * SMR_SIDES * smr_ceil_div(w->aligner.used, SMR_ALIGN_COLLECT);
}

static void collect(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_align_work *w = work_of(job);
    const uint32_t i = task % w->n, pieces = smr_ceil_div(w->aligner.used, SMR_ALIGN_COLLECT), at = task / w->n;
    const smr_aligner a = aligner_of(w, i);
    if (w->group[i].state == SMR_REFINE_GOES_ON)
        smr_align_collect(&a, at / pieces, smr_piece_of(at % pieces, SMR_ALIGN_COLLECT, a.used), &w->group[i]);
}

static void fit(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_align_work *w = work_of(job);
    smr_refined *const r = &w->group[task];
    if (w->last || r->state != SMR_REFINE_GOES_ON)
        return;
    if (r->round == w->disc_rounds)
        r->last = FLT_MAX; /* distances to discs are others than those to the surface */
    r->state = smr_align_round(w->how, r);
    if (r->state == SMR_REFINE_GOES_ON && r->round == w->rounds)
        r->state = SMR_REFINE_ENDED;
}

/* Goes on with the next round, with the last search of pairs, with the next group, or with the steps. */
static void end_round(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    align_job *const j = job;
    smr_align_work *w = j->w;
    int goes_on = 0;
    for (uint32_t i = 0; i < w->n; i++)
        goes_on |= !w->last && w->group[i].state == SMR_REFINE_GOES_ON;
    if (goes_on || (!w->last && w->into != NULL)) {
        w->last = !goes_on;
        j->head.next_stage = SMR_ALIGN_PAIRS;
        return;
    }
    for (uint32_t i = 0; i < w->n; i++)
        if (w->into == NULL)
            w->one.pose[0] = w->group[i].pose;
        else if (w->group[i].state != SMR_REFINE_FAILED)
            smr_align_insert(&w->aligner, &w->group[i].pose, w->group[i].cost, w->into);
    w->first += w->n;
    j->head.next_stage = w->first < w->from->n ? SMR_ALIGN_GROUPS : SMR_ALIGN_STEP;
}

static const smr_stage stages[] = {
    {side_tasks, make_sides, smr_in_order, NULL},
    {disc_tasks, make_discs, smr_in_order, NULL},
    {NULL, run_step, NULL, NULL},
    {try_tasks, try_pose, try_places, take_poses},
    {NULL, begin_group, NULL, NULL},
    {pairs_tasks, find_some, NULL, NULL},
    {NULL, end_pairs, NULL, NULL},
    {measure_tasks, measure_some, group_tasks, NULL},
    {group_tasks, find_limit, NULL, NULL},
    {collect_tasks, collect, group_tasks, NULL},
    {group_tasks, fit, NULL, NULL},
    {NULL, end_round, NULL, NULL},
    {joint_tasks, find_joint, smr_in_order, NULL},
    {NULL, begin_part, NULL, NULL},
};

/* Returns 1 while all surfaces are as at the begin. */
static int is_unchanged(void *job, int enter)
{
    const align_job *j = job;
    uint32_t changes = 0;
    return !enter || (smr_align_changes(j->w, &changes) && changes == j->changes);
}

smr_status smr_align_begin(const smr_surface *model, const smr_surface *target, const smr_align_config *config,
                           void *memory, size_t bytes, smr_pose *pose, smr_align_report *report, smr_job *job)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_surface *surface[SMR_SIDES] = {model, target};
    align_job *const j = (align_job *)(void *)job;
    smr_arena arena;
    smr_align_work *w;
    smr_coarse_place *place;
    smr_align_slice *slice;
    smr_joint *joint;
    smr_aligner parts;
    if (model == NULL || target == NULL || config == NULL || pose == NULL || job == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(model) || !smr_surface_valid(target))
        return SMR_E_STATE;
    if (!is_legal(config))
        return SMR_E_CONFIG;
    const smr_pose given = config->given == NULL ? identity : *config->given;
    if (!smr_pose_legal(&given))
        return SMR_E_INPUT;
    SMR_TRY(smr_arena_start(&arena, memory, bytes));
    memset(&parts, 0, sizeof parts);
    layout(&arena, config, &w, &place, &slice, &joint, &parts);
    if (arena.used > bytes)
        return SMR_E_ARENA;
    memset(w, 0, sizeof *w);
    memset(slice, 0, n_slices(config) * sizeof *slice);
    memset(j, 0, sizeof *j);
    j->head = smr_job_begin(stages, sizeof stages / sizeof stages[0], config->port);
    j->head.guard = is_unchanged;
    j->w = w;
    w->aligner = parts;
    w->place = place;
    w->slice = slice;
    w->n_slices = n_slices(config);
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        w->aligner.side[side].surface = w->whole_of[side] = surface[side];
        w->aligner.side[side].n = config->samples;
    }
    w->part = config->part;
    w->n_parts = config->n_parts;
    if (!smr_align_changes(w, &j->changes))
        return SMR_E_STATE;
    w->joint = joint;
    for (uint32_t i = 0; i < w->n_parts; i++)
        w->part[i].order = 0;
    memset(joint, 0, w->n_parts * sizeof *joint);
    w->few = config->samples / 10u + 8u;
    w->some = config->samples / 3u + 8u;
    w->all = config->samples;
    w->scaled = config->scaled ? SMR_REFINE_SCALED : 0u;
    w->iterations = config->iterations;
    w->as_given = w->given = given;
    smr_pose_through(&w->given, smr_v(0, 0, 0), smr_sub(smr_pose_apply(&given, model->origin), target->origin));
    w->pose = pose;
    w->report = report;
    return SMR_OK;
}

static void run_at_once(smr_job *job) { work_of(job)->at_once = 1; }

smr_status smr_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config, void *memory,
                     size_t bytes, smr_pose *pose, smr_align_report *report)
{
    smr_job job;
    SMR_TRY(smr_align_begin(model, target, config, memory, bytes, pose, report, &job));
    run_at_once(&job);
    return smr_job_step(&job, 0, NULL, 0);
}
