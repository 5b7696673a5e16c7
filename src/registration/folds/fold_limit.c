/* fold_limit.c: limits the steps x_next - x that would fold dihedral edges, at the finest radii. In an iteration the
 * cosine of an edge may use a share of the remaining margin. Beyond that share the steps of the edge's four corners
 * move towards their mean: equal steps do not turn the edge. A vertex of several such edges moves towards the weighted
 * mean of their requests by the largest requested share. Edges with common corners affect each other, so several rounds
 * follow. The result is continuous in the positions. Steps of edges that still fold are halved, then removed.
 * Bounds: SMR_LIMIT_ROUNDS passes over dihedral edges and over triangles of structures with folds; SMR_SOFT_ROUNDS over
 * vertices with requests.
 * SPDX-License-Identifier: MIT */
#include "registration/folds/folds.h"

#define SMR_LIMIT_SHARE 0.75f  /* largest fraction of the remaining margin that an edge may use in an iteration */
#define SMR_LIMIT_ROOM 0.05f   /* distance of a cosine to its limit below which the edge creeps: moves by small steps */
#define SMR_LIMIT_CREEP 0.001f /* largest change of the cosine of a creeping edge in an iteration */
#define SMR_LIMIT_LEFT 0.05f   /* largest change of a cosine, as a share of the distance to its limit, never reached */
#define SMR_SOFT_ROUNDS 20u    /* largest number of rounds in which edges request shorter steps of vertices */
#define SMR_HALVINGS 3u        /* number of rounds that halve steps; later rounds remove steps */
#define SMR_LIMIT_ROUNDS 40u   /* largest number of rounds in an iteration, soft rounds and halvings together */
#define SMR_ENOUGH 0.001f      /* largest requested share at which the soft rounds end */

enum { SMR_LIMIT_IDLE = 0, SMR_LIMIT_LOOK, SMR_LIMIT_TOUCH, SMR_LIMIT_MOVE };
enum { SMR_MARKED = 1, SMR_REQUESTED = 2 };

float smr_fold_limit_share(const smr_folds *f, const smr_stored_dihedral *h, float next)
{
    const float limit = smr_edge_limit(h), near = limit + SMR_LIMIT_ROOM;
    if (!(next < 1.0f - SMR_LIMIT_SHARE * (1.0f - near)))
        return 0.0f; /* no limit: the next cosine stays within the edge's share of the margin, even from a flat edge */
    const float now = smr_dihedral_cosine(f, f->shape->x, h);
    const float creep = smr_min(SMR_LIMIT_CREEP, SMR_LIMIT_LEFT * smr_abs(now - limit));
    const float may = SMR_LIMIT_SHARE * smr_positive(now - near) + creep;
    return now - next > may ? 1.0f - may / (now - next) : 0.0f;
}

static smr_vec step_of(const smr_folds *f, uint32_t v)
{
    return smr_sub(smr_get3(f->shape->x_next, v), smr_get3(f->shape->x, v));
}

static void set_step(const smr_folds *f, uint32_t v, smr_vec step)
{
    smr_put3(f->shape->x_next, v, smr_add(smr_get3(f->shape->x, v), step));
}

/* Writes the four corners of a dihedral edge: those of the first triangle, then the other corner of the second. */
static void corners_of(const smr_folds *f, const smr_stored_dihedral *h, uint32_t corner[4])
{
    const uint32_t *a = smr_corners(f, smr_edge_first(f, h)), *b = smr_corners(f, smr_edge_second(f, h));
    memcpy(corner, a, 3u * sizeof *a);
    corner[3] = a[0];
    for (uint32_t c = 0; c < 3u; c++)
        if (b[c] != a[0] && b[c] != a[1] && b[c] != a[2])
            corner[3] = b[c];
}

/* Marks a vertex. If it had no mark, the triangles around it, in its structure, are touched behind this round. */
static void mark(smr_folds *f, uint32_t v, uint8_t bits)
{
    if (f->marked[v] == 0u)
        f->folding[smr_model_owner(f->shared->model, v)] = f->limit.round + 1u;
    f->marked[v] |= bits;
}

/* Requests that the steps of an edge's corners move towards their mean by `share`, 0..1. */
static void request(smr_folds *f, const smr_stored_dihedral *h, float share)
{
    uint32_t corner[4];
    corners_of(f, h, corner);
    smr_vec mean = smr_v(0, 0, 0);
    for (uint32_t c = 0; c < 4u; c++)
        mean = smr_add(mean, smr_scale(step_of(f, corner[c]), 0.25f));
    for (uint32_t c = 0; c < 4u; c++) {
        const uint32_t v = corner[c];
        if (!(f->marked[v] & SMR_REQUESTED)) {
            smr_put3(f->rings.sum, v, smr_v(0, 0, 0));
            f->rings.weight[v] = f->rings.requested[v] = 0.0f;
            f->rings.listed[smr_index(f->limit.n_listed++, f->shared->n)] = v;
        }
        smr_add3(f->rings.sum, v, smr_scale(mean, share));
        f->rings.weight[v] += share;
        f->rings.requested[v] = smr_max(f->rings.requested[v], share);
        mark(f, v, SMR_MARKED | SMR_REQUESTED);
    }
}

/* Multiplies the steps of an edge's corners by `keep`, 0..1. */
static void hold(smr_folds *f, const smr_stored_dihedral *h, float keep)
{
    uint32_t corner[4];
    corners_of(f, h, corner);
    for (uint32_t c = 0; c < 4u; c++) {
        set_step(f, corner[c], smr_scale(step_of(f, corner[c]), keep));
        mark(f, corner[c], SMR_MARKED);
        smr_tangent_limit(f->tangent_smooth, corner[c], 1.0f);
    }
}

/* Tests an edge with a cosine of `next` at x_next. */
SMR_SHARED static void test(smr_folds *f, const smr_stored_dihedral *h, float next)
{
    smr_fold_limit *l = &f->limit;
    const float limit = smr_edge_limit(h);
    if (l->round < SMR_SOFT_ROUNDS) {
        const float share = smr_fold_limit_share(f, h, next);
        if (share > 0.0f) {
            request(f, h, share);
            l->most = smr_max(l->most, share);
        }
    } else if (next < limit && !(smr_dihedral_cosine(f, f->shape->x, h) < limit)) {
        hold(f, h, l->round < SMR_SOFT_ROUNDS + SMR_HALVINGS ? 0.5f : 0.0f);
        l->most = 1.0f;
    }
}

/* Tests dihedral edges from .. to - 1, of one task of fold_find.c, with corners marked before this round. Skips all of
 * them if the round before found none and marked no vertex of their structures. */
static void look(smr_folds *f, uint32_t from, uint32_t to)
{
    smr_tally *tally = &f->tally[from / SMR_DIHEDRAL_CHUNK];
    const smr_stored_dihedral *const dihedral = smr_edge_at(f, 0);
    const uint32_t round = f->limit.round, piece = smr_piece_bit(from);
    uint32_t i = from;
    if (round == 0u) {
        tally->folds.quiet = ~0u;
        for (; (tally->folds.bent & piece) && i < to; i++)
            test(f, dihedral + i, smr_refitted_cosine(f, dihedral + i));
        return;
    }
    if (tally->folds.round != round && smr_marked_since(f, tally, tally->folds.round))
        tally->folds.quiet = 0;
    tally->folds.round = round;
    if (tally->folds.quiet & piece)
        return;
    if ((i = smr_next_touched(f, i, to)) == to)
        tally->folds.quiet |= piece;
    for (; i < to; i = smr_next_touched(f, i + 1u, to))
        test(f, dihedral + i, smr_dihedral_cosine(f, f->shape->x_next, dihedral + i));
}

static void touch(smr_folds *f, uint32_t triangle, uint32_t last)
{
    for (; triangle < last; triangle++)
        if (smr_any_marked(f, triangle))
            smr_triangle_touch(f, triangle);
}

/* Moves the listed vertices from .. to - 1 as edges requested. */
static void move(smr_folds *f, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_index(f->rings.listed[i], f->shared->n);
        const smr_vec mean = smr_scale(smr_get3(f->rings.sum, v), 1.0f / f->rings.weight[v]), step = step_of(f, v);
        const float requested = f->rings.requested[v];
        set_step(f, v, smr_add(step, smr_scale(smr_sub(mean, step), requested)));
        f->marked[v] = SMR_MARKED;
        smr_tangent_limit(f->tangent_smooth, v, requested);
    }
}

/* Begins a round of tests; none beyond SMR_LIMIT_ROUNDS. */
static void begin_round(smr_fold_limit *l, uint32_t round)
{
    l->pass.stage = round < SMR_LIMIT_ROUNDS ? SMR_LIMIT_LOOK : SMR_LIMIT_IDLE;
    l->round = round;
    l->most = 0.0f;
    l->n_listed = 0;
}

/* Touches triangles of the next structure with vertices marked in this round, from `structure` on; then moves vertices
 * as requested. */
SMR_SELDOM static void touch_from(smr_folds *f, uint32_t structure)
{
    smr_fold_limit *l = &f->limit;
    while (structure < f->shared->n_structures && f->folding[structure] != l->round + 1u)
        structure++;
    l->pass.stage = SMR_LIMIT_TOUCH;
    l->pass.structure = structure;
    if (structure < f->shared->n_structures)
        return;
    l->pass.structure = 0;
    l->pass.stage = SMR_LIMIT_MOVE;
}

SMR_SELDOM static void next_pass(smr_folds *f)
{
    smr_fold_limit *l = &f->limit;
    l->pass.at = 0;
    if (l->pass.stage == SMR_LIMIT_TOUCH)
        touch_from(f, l->pass.structure + 1u);
    else if (l->pass.stage == SMR_LIMIT_MOVE)
        begin_round(l, l->round < SMR_SOFT_ROUNDS && l->most < SMR_ENOUGH ? SMR_SOFT_ROUNDS : l->round + 1u);
    else if (l->most > 0.0f)
        touch_from(f, 0);
    else
        begin_round(l, l->round < SMR_SOFT_ROUNDS ? SMR_SOFT_ROUNDS : SMR_LIMIT_ROUNDS);
}

void smr_fold_limit_start(smr_folds *f)
{
    memset(&f->limit, 0, sizeof f->limit);
    f->limit.pass.stage = SMR_LIMIT_LOOK;
}

uint32_t smr_fold_limit_tasks(const void *folds) { return smr_fold_tasks(&((const smr_folds *)folds)->limit.pass); }

static const smr_fold_stage stages[] = {
    [SMR_LIMIT_LOOK] = {SMR_OVER_DIHEDRALS, SMR_EDGE_PIECE, look},
    [SMR_LIMIT_TOUCH] = {SMR_OVER_TRIANGLES, SMR_TRIANGLE_CHUNK, touch},
    [SMR_LIMIT_MOVE] = {SMR_OVER_LISTED, SMR_TRIANGLE_CHUNK, move},
};

void smr_fold_limit_pass(void *arg, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_folds *f = arg;
    if (smr_fold_run(f, &f->limit.pass, stages))
        next_pass(f);
}
