/* align_articulated.c: start positions of one surface whose parts have turned about joints, as limbs do.
 * Method: about 1200 patches of the model each have a rigid motion, as in embedded deformation (Sumner, Schmid and
 * Pauly 2007). The seed is the patch around which the start pose fits best. Ring after ring of neighbours joins with
 * the motion of the patch before; in the rounds of each step all patches follow closest points and each other. A patch
 * follows a point only where the target faces as the patch does, where a neighbour has found the target, and where no
 * patch elsewhere on the model lies nearer: limbs side by side stay apart, and what the target lacks is carried along.
 * While patches join, those rest around which nothing moves, except in each eighth step.
 * The result is taken when it explains both surfaces much better than the start pose, and most of one of them; where a
 * surface lacks a part of the other, when it explains that surface nearly whole. Rigid bodies then follow the target.
 * Bounds: rounds * steps searches from each patch, a step is a ring of patches around the seed; then one in each round.
 * SPDX-License-Identifier: MIT */
#include "start/align/align_patches.h"

#define SMR_BENT_CELLS 1200.0f    /* area of the model / squared radius of a cell */
#define SMR_BENT_ROUNDS 20u       /* number of rounds in a step */
#define SMR_BENT_LAST 40u         /* number of rounds after all have joined */
#define SMR_BENT_SETTLE 10u       /* number of rounds after that */
#define SMR_BENT_AGREE 0.05f      /* distance at which members of a part agree by a half / radius of a cell */
#define SMR_BENT_STRICTER 0.85f   /* this distance / that of the round before; it starts at a radius */
#define SMR_BENT_DEAR 0.1f        /* smallest cost of the start pose on both sides with which parts are bent */
#define SMR_BENT_DEAR_PART 0.05f  /* the same where one surface lacks a part of the other */
#define SMR_BENT_PART 0.3f        /* cost of a side above which the other surface lacks a part of it */
#define SMR_BENT_OTHER 0.3f       /* the same cost below which the model may also be another body of the same kind */
#define SMR_BENT_SAME 0.015f      /* then the largest cost of a result / cost of the start pose, on the better side */
#define SMR_BENT_ALIKE 0.002f     /* where a part lacks: cost of a result that suffices, whatever the start pose's */
#define SMR_BENT_LOST 0.75f       /* cost on both sides above which the start pose is no start */
#define SMR_BENT_CHEAPER 0.5f     /* largest cost of a result / cost of the start pose */
#define SMR_BENT_UNEXPLAINED 0.2f /* largest cost of the side that a result explains better */

#define SMR_BENT_PIECE 128u /* vertices, triangles or patches in a task */
#define SMR_BENT_VISITS 64u /* visits in a task that divides surfaces */
#define SMR_BENT_NEW 64u    /* patches that a task clears */
#define SMR_BENT_MOVED 16u  /* vertices that a task moves */

_Static_assert(sizeof(smr_bent_job) <= SMR_JOB_BYTES, "a call in progress is found by the caller's job");

static void layout(smr_arena *arena, const smr_surface *model, const smr_surface *target, smr_bent **work, smr_bent *w)
{
    *work = smr_arena_take(arena, 1, sizeof **work);
    w->patch = smr_arena_take(arena, SMR_CELLS_MOST, sizeof *w->patch);
    w->body = smr_arena_take(arena, SMR_BENT_BODIES, sizeof *w->body);
    w->slice = smr_arena_take(arena, SMR_BENT_SLICES, sizeof *w->slice);
    w->owner = smr_arena_take(arena, SMR_CELLS_MOST, sizeof *w->owner);
    for (uint32_t i = 0; i < SMR_SIDES; i++) {
        w->d2[i] = smr_arena_take(arena, SMR_CELLS_MOST, sizeof *w->d2[i]);
        w->side[i].surface = i == SMR_MODEL ? model : target;
        smr_cells_layout(arena, &w->side[i]);
    }
}

static smr_bent *work_of(const void *job) { return ((const smr_bent_job *)job)->w; }
static uint32_t patch_tasks(const void *job) { return work_of(job)->side[SMR_MODEL].n; }

/* ---- cells and patches ---- */

static uint32_t items_of(const smr_cells *c)
{
    return smr_max_u32(c->surface->n_vertices, c->surface->tree.n_triangles);
}
static uint32_t item_tasks(const void *job)
{
    const smr_cells *side = work_of(job)->side;
    return smr_ceil_div(smr_max_u32(items_of(&side[SMR_MODEL]), items_of(&side[SMR_TARGET])), SMR_BENT_PIECE);
}

static uint32_t clear_tasks(const void *job) { return smr_max_u32(item_tasks(job), SMR_CELLS_MOST / SMR_BENT_NEW); }

static void clear(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_piece patches = smr_piece_of(task, SMR_BENT_NEW, SMR_CELLS_MOST);
    for (uint32_t i = patches.first; i < patches.last; i++)
        memset(&w->patch[i], 0, sizeof w->patch[i]);
    for (uint32_t i = 0; i < SMR_SIDES; i++) {
        const smr_piece piece = smr_piece_of(task, SMR_BENT_PIECE, w->side[i].surface->n_vertices);
        smr_cells_start(&w->side[i], piece.first, piece.last);
    }
}

static void chain(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    for (uint32_t i = 0; i < SMR_SIDES; i++) {
        const smr_cells *c = &work_of(job)->side[i];
        const smr_piece piece = smr_piece_of(task, SMR_BENT_PIECE, c->surface->tree.n_triangles);
        smr_cells_chain(c, piece.first, piece.last);
    }
}

static void divide(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent_job *const j = job;
    smr_cells *const side = j->w->side;
    int more = 1;
    for (uint32_t i = 0; i < SMR_BENT_VISITS && more; i++)
        more = smr_cells_divide(&side[SMR_MODEL]) || smr_cells_divide(&side[SMR_TARGET]);
    if (more)
        j->head.next_stage = SMR_BENT_DIVIDE;
    else if (side[SMR_MODEL].n == 0u || smr_max_u32(side[SMR_MODEL].n, side[SMR_TARGET].n) > SMR_CELLS_MOST)
        j->head.next_stage = SMR_BENT_END;
}

static void link_patches(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_piece piece = smr_piece_of(task, SMR_BENT_PIECE, w->side[SMR_MODEL].surface->tree.n_triangles);
    for (uint32_t i = 0; i < SMR_SIDES; i++) {
        const smr_piece vertices = smr_piece_of(task, SMR_BENT_PIECE, w->side[i].surface->n_vertices);
        smr_patches_areas(&w->side[i], vertices.first, vertices.last);
    }
    smr_patches_link(w, piece.first, piece.last);
}

static void set_patches(void *job, uint32_t task, SMR_UNUSED uint32_t worker) { smr_patch_set(work_of(job), task); }

/* ---- rounds ---- */

static uint32_t slice_tasks(const void *job)
{
    const smr_bent *w = work_of(job);
    return smr_min_u32(SMR_BENT_SLICES, w->side[SMR_MODEL].n - w->next);
}

static void find_goals(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent *w = work_of(job);
    smr_align_slice *const slice = &w->slice[task];
    slice->pause.left = SMR_ALIGN_WORK;
    if (!slice->done)
        slice->done = (uint32_t)smr_patch_find(w, &w->patch[w->next + task], &slice->pause);
}

/* Goes back to searches that are not complete, or to the next ones. */
static void end_goals(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent_job *const j = job;
    smr_bent *w = j->w;
    const uint32_t n = slice_tasks(job);
    uint32_t done = 0;
    for (uint32_t i = 0; i < n; i++)
        done += w->slice[i].done;
    for (uint32_t i = 0; i < n && done == n; i++)
        w->slice[i].done = 0;
    w->next += done == n ? n : 0u;
    if (w->next < w->side[SMR_MODEL].n)
        j->head.next_stage = SMR_BENT_FIND;
    else
        w->next = 0;
}

static void own_cells(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent_job *const j = job;
    const smr_bent *w = j->w;
    smr_patches_own(w);
    if (w->step == 0u || (w->agree2 > 0.0f && w->round == SMR_BENT_LAST && w->n_bodies == 0u))
        j->head.next_stage = SMR_BENT_MEASURE; /* the start pose, or the result, stands */
    else if (w->n_bodies > 0u && w->body_round < SMR_BENT_TOGETHER)
        j->head.next_stage = SMR_BENT_SUM;
    else if (w->n_bodies > 0u && w->round == SMR_BENT_LAST + SMR_BENT_SETTLE)
        j->head.next_stage = SMR_BENT_MOVE;
}

static uint32_t extend_tasks(const void *job)
{
    return work_of(job)->agree2 > 0.0f && work_of(job)->round == 0u ? patch_tasks(job) : 0u;
}

static void extend(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_patch_extend(work_of(job), &work_of(job)->patch[task]);
}

static void fit_motions(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_patch_fit(work_of(job), &work_of(job)->patch[task]);
}

/* Ends a round, and after the last one a step. */
static void end_round(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent_job *const j = job;
    smr_bent *w = j->w;
    const float cell2 = w->radius * w->radius;
    for (uint32_t k = 0; k < w->patch[w->seed].n_near && w->agree2 == 0.0f; k++) {
        w->patch[w->patch[w->seed].member[k]].motion = w->patch[w->seed].motion;
        w->patch[w->patch[w->seed].member[k]].rests = w->patch[w->seed].rests;
    }
    if (w->agree2 > 0.0f)
        w->agree2 = smr_max(SMR_BENT_STRICTER * SMR_BENT_STRICTER * w->agree2, SMR_BENT_AGREE * SMR_BENT_AGREE * cell2);
    if (++w->round < SMR_BENT_ROUNDS || w->agree2 > 0.0f) {
        j->head.next_stage = SMR_BENT_FIND;
        return;
    }
    w->step++;
    w->round = 0;
    w->agree2 = cell2;
}

static uint32_t join_tasks(const void *job) { return smr_ceil_div(work_of(job)->side[SMR_MODEL].n, SMR_BENT_PIECE); }

/* Returns 1 when half of the model lies on another body of the same kind: it costs more than decide() accepts of the
 * result, which costs more than patches that still follow the target one by one. */
static int is_other_body(const smr_bent *w)
{
    const float alike = smr_max(SMR_BENT_SAME * w->least, SMR_BENT_ALIKE);
    return w->least < SMR_BENT_OTHER && w->found_area > 0.5f * w->area && w->found_cost > alike * w->found_area;
}

/* After a step the neighbours of all patches join; once there are none, parts become rigid. Another body of the same
 * kind ends the call here: the rest would take most of the time, and be refused. */
static void join(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent_job *const j = job;
    smr_bent *w = j->w;
    const smr_piece piece = smr_piece_of(task, SMR_BENT_PIECE, w->side[SMR_MODEL].n);
    if (task == 0u)
        w->area = w->found_area = w->found_cost = 0.0f;
    smr_patches_compare(w, piece.first, piece.last);
    j->head.next_stage = piece.last == w->side[SMR_MODEL].n && is_other_body(w) ? SMR_BENT_END : SMR_BENT_FIND;
    for (uint32_t i = piece.first; i < piece.last; i++) {
        smr_patch *const p = &w->patch[i];
        for (uint32_t k = 0; k < p->n_links && p->joined == 0u; k++) {
            const smr_patch *q = &w->patch[p->link[k]];
            if (q->joined == 0u || q->joined == w->step)
                continue;
            p->motion = q->motion;
            p->joined = w->step;
            w->agree2 = 0.0f;
        }
    }
}

/* ---- measures of the start pose and of the result ---- */

static uint32_t measure_tasks(const void *job)
{
    const smr_bent *w = work_of(job);
    return smr_max_u32(w->side[SMR_MODEL].n, w->side[SMR_TARGET].n);
}

static void measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_cells *t = &w->side[SMR_TARGET];
    if (task < w->side[SMR_MODEL].n)
        w->d2[SMR_MODEL][task] = w->patch[task].weight > 0.0f ? w->patch[task].d2 : FLT_MAX;
    if (task >= t->n)
        return;
    const uint32_t v = t->cell[task].middle;
    w->d2[SMR_TARGET][task] = smr_patches_distance2(w, smr_get3(t->surface->xyz, v), smr_get3(t->surface->normal, v));
}

static uint32_t limit_tasks(const void *job) { return work_of(job)->step == 0u; }

static void set_limit(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_patches_set_limit(work_of(job));
}

/* Decides on the start pose, or on the result. */
static void decide(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent_job *const j = job;
    smr_bent *w = j->w;
    const float on_model = smr_patches_mean_cost(w, SMR_MODEL), on_target = smr_patches_mean_cost(w, SMR_TARGET);
    const float least = smr_min(on_model, on_target), both = smr_cost_of_sides(on_model, on_target);
    const int part = smr_max(on_model, on_target) > SMR_BENT_PART;
    if (w->step == 0u) {
        w->before = both;
        w->least = least;
        if (least < (part ? SMR_BENT_DEAR_PART : SMR_BENT_DEAR) || least > SMR_BENT_LOST)
            j->head.next_stage = SMR_BENT_END;
        return;
    }
    const int other = w->least < SMR_BENT_OTHER;
    const float alike = smr_max(SMR_BENT_SAME * w->least, part ? SMR_BENT_ALIKE : 0.0f);
    if (least <= (other ? alike : SMR_BENT_UNEXPLAINED) && ((other && part) || both <= SMR_BENT_CHEAPER * w->before))
        *w->bent = 1u + (uint32_t)(1.0e6f * both);
    j->head.next_stage = *w->bent > 0u ? SMR_BENT_GATHER : SMR_BENT_END;
}

/* Sums the costs around a patch. */
static void weigh(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    smr_patch *const p = &w->patch[task];
    p->weight = 0.0f;
    for (uint32_t k = 0; k < p->n_near; k++)
        p->weight += smr_patches_cost(w, SMR_MODEL, p->member[k]);
    p->joined = p->found = 0;
}

/* Chooses the seed, around which the start pose costs least. */
static void seed(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent_job *const j = job;
    smr_bent *w = j->w;
    const smr_patch *best = w->patch;
    float least = best->weight / (float)best->n_near;
    for (uint32_t i = 1; i < w->side[SMR_MODEL].n; i++) {
        const smr_patch *p = &w->patch[i];
        best = p->weight < least * (float)p->n_near ? p : best;
        least = smr_min(least, p->weight / (float)p->n_near);
    }
    for (uint32_t k = 0; k < best->n_near; k++)
        w->patch[best->member[k]].joined = w->patch[best->member[k]].found = 1;
    w->seed = (uint32_t)(best - w->patch);
    w->step = 1;
    w->round = 0;
    j->head.next_stage = SMR_BENT_FIND;
}

static uint32_t move_tasks(const void *job)
{
    return smr_ceil_div(work_of(job)->side[SMR_MODEL].surface->n_vertices, SMR_BENT_MOVED);
}

static void move(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_cells *m = &w->side[SMR_MODEL];
    const smr_piece piece = smr_piece_of(task, SMR_BENT_MOVED, m->surface->n_vertices);
    for (uint32_t v = piece.first; v < piece.last; v++) {
        const smr_vec rest = smr_pose_apply(&w->start, smr_get3(m->surface->xyz, v));
        const smr_vec at = m->of[v] == SMR_NONE ? rest : smr_patch_place(w, &w->patch[m->of[v]], rest);
        smr_put3(w->xyz, v, smr_add(at, w->side[SMR_TARGET].surface->origin));
    }
}

static const smr_stage stages[] = {
    {clear_tasks, clear, NULL, NULL},
    {item_tasks, chain, smr_in_order, NULL},
    {NULL, divide, NULL, NULL},
    {item_tasks, link_patches, smr_in_order, NULL},
    {patch_tasks, set_patches, NULL, NULL},
    {slice_tasks, find_goals, NULL, NULL},
    {NULL, end_goals, NULL, NULL},
    {NULL, own_cells, NULL, NULL},
    {extend_tasks, extend, NULL, NULL},
    {patch_tasks, fit_motions, NULL, NULL},
    {NULL, end_round, NULL, NULL},
    {join_tasks, join, smr_in_order, NULL},
    {smr_bodies_halves, smr_bodies_gather, NULL, NULL},
    {NULL, smr_bodies_begin, NULL, NULL},
    {smr_bodies_pieces, smr_bodies_take, smr_in_order, NULL},
    {smr_bodies_pieces, smr_bodies_share, smr_in_order, NULL},
    {smr_bodies_pieces, smr_bodies_sum, smr_in_order, NULL},
    {smr_bodies_count, smr_bodies_move, NULL, NULL},
    {smr_bodies_pieces, smr_bodies_follow, smr_in_order, NULL},
    {NULL, smr_bodies_end_round, NULL, NULL},
    {measure_tasks, measure, NULL, NULL},
    {limit_tasks, set_limit, NULL, NULL},
    {NULL, decide, NULL, NULL},
    {patch_tasks, weigh, NULL, NULL},
    {NULL, seed, NULL, NULL},
    {move_tasks, move, NULL, NULL},
};

static int is_mesh(const smr_surface *s) { return smr_surface_valid(s) && !smr_is_cloud(s); }

static int is_unchanged(void *job, int enter)
{
    const smr_bent_job *j = job;
    const smr_surface *a = j->w->side[SMR_MODEL].surface, *b = j->w->side[SMR_TARGET].surface;
    return !enter || (is_mesh(a) && is_mesh(b) && a->changes + b->changes == j->changes);
}

smr_status smr_articulated_bytes(const smr_surface *model, const smr_surface *target, size_t *bytes)
{
    smr_arena arena = smr_arena_measure();
    smr_bent w, *work;
    if (model == NULL || target == NULL || bytes == NULL)
        return SMR_E_NULL;
    if (!is_mesh(model) || !is_mesh(target))
        return SMR_E_STATE;
    layout(&arena, model, target, &work, &w);
    *bytes = arena.used;
    return SMR_OK;
}

smr_status smr_articulated_begin(const smr_surface *model, const smr_surface *target, const smr_pose *start,
                                 const smr_port *port, void *memory, size_t bytes, float *xyz, uint32_t *bent,
                                 smr_job *job)
{
    smr_bent_job *const j = (smr_bent_job *)(void *)job;
    smr_arena arena;
    smr_bent w = {.xyz = xyz, .bent = bent};
    if (model == NULL || target == NULL || start == NULL || xyz == NULL || bent == NULL || job == NULL)
        return SMR_E_NULL;
    if (!is_mesh(model) || !is_mesh(target))
        return SMR_E_STATE;
    if (!smr_pose_legal(start))
        return SMR_E_INPUT;
    SMR_TRY(smr_arena_start(&arena, memory, bytes));
    memset(j, 0, sizeof *j);
    layout(&arena, model, target, &j->w, &w);
    if (arena.used > bytes)
        return SMR_E_ARENA;
    memset(w.slice, 0, SMR_BENT_SLICES * sizeof *w.slice);
    w.start = *start;
    smr_pose_through(&w.start, smr_v(0, 0, 0), smr_sub(smr_pose_apply(start, model->origin), target->origin));
    w.side[SMR_MODEL].radius = SMR_SQRT(model->area_mean * (float)model->n_used / SMR_BENT_CELLS);
    w.side[SMR_TARGET].radius = w.radius = w.side[SMR_MODEL].radius * smr_pose_scale(start);
    *bent = 0;
    *j->w = w;
    j->head = smr_job_begin(stages, sizeof stages / sizeof stages[0], port);
    j->head.guard = is_unchanged;
    j->changes = model->changes + target->changes;
    return SMR_OK;
}
