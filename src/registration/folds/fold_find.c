/* fold_find.c: searches for dihedral edges that fold. Shape matching makes folds rare, but crossing forces can turn a
 * triangle over, and a plastic reference shape keeps the triangle so. Coarse radii move the model almost rigidly and
 * undo most folds, so the search begins at the last radius but one.
 * Bounds: one pass over the dihedral edges.
 * SPDX-License-Identifier: MIT */
#include "registration/folds/folds.h"

void smr_folds_layout(smr_arena *a, smr_folds *f, const smr_shared *shared)
{
    f->n_dihedral_tasks = smr_ceil_div(shared->n_dihedrals, SMR_DIHEDRAL_CHUNK);
    f->marked = smr_slot_scratch(a, f->marked, shared->n, 1);
    f->touched = smr_slot_scratch(a, f->touched, smr_ceil_div(shared->n_triangles, 64), sizeof *f->touched);
    f->folding = smr_slot_scratch(a, f->folding, shared->n_structures, sizeof *f->folding);
    smr_keep_words(a, &f->n_guarded, 1, shared->n);
}

void smr_folds_reset(smr_folds *f)
{
    memset(&f->repair, 0, sizeof f->repair);
    memset(&f->limit, 0, sizeof f->limit);
    memset(&f->open, 0, sizeof f->open);
    f->moved = 0;
}

int smr_folds_guarded(const smr_shared *c, const smr_schedule *p)
{
    return c->config.motion.fold_guard && !c->config.dynamics.mode && p->radius + 2u > smr_last_radius(c);
}

uint32_t smr_fold_find_tasks(const void *arg)
{
    const smr_folds *f = arg;
    return smr_folds_guarded(f->shared, f->schedule) ? f->n_dihedral_tasks : 0u;
}

#define SMR_FIND_PIECE 128u   /* number of dihedral edges that a worker tests before the worker may stop */
#define SMR_WORK_DIHEDRAL 60u /* instructions at most for a dihedral edge that does not bend, ... */
#define SMR_WORK_BENT 400u    /* ... and for a dihedral edge that bends */

/* Widens the range of structures in *tally to those of edges from .. to - 1. */
static void add_structures(const smr_folds *f, uint32_t from, uint32_t to, smr_tally *tally)
{
    const smr_stored_dihedral *const dihedral = smr_edge_at(f, 0);
    uint32_t begin = 0, n = 0; /* triangles of the edge's structure before */
    for (; from < to; from++) {
        const uint32_t first = smr_le32(dihedral[from].first);
        if (first - begin < n)
            continue;
        const uint32_t corner = smr_corners(f, smr_index(first, f->shared->n_triangles))[0];
        const uint32_t owner = smr_model_owner(f->shared->model, smr_index(corner, f->shared->n));
        begin = f->shape->structure[owner].first_triangle;
        n = f->shape->structure[owner].tree.n_triangles;
        tally->folds.first = smr_min_u32(tally->folds.first, owner);
        tally->folds.last = smr_max_u32(tally->folds.last, owner);
    }
}

/* Notes in *tally where edges from .. to - 1 fold or must be limited at x_next. Returns the number of bent edges. */
static uint32_t find(const smr_folds *f, uint32_t from, uint32_t to, smr_tally *tally)
{
    const smr_stored_dihedral *const dihedral = smr_edge_at(f, 0);
    const int repairing = f->schedule->repairing > 0u;
    uint32_t close = 0;
    for (uint32_t i = from; i < to; i++) {
        const smr_stored_dihedral *h = dihedral + i;
        const float next = smr_refitted_cosine(f, h);
        if (!(next < SMR_LIMIT_BELOW))
            continue;
        close++;
        if (repairing ? next < smr_edge_limit(h) : smr_fold_limit_share(f, h, next) > 0.0f)
            tally->folds.bent |= smr_piece_bit(i);
        if (smr_edge_open(h) && next < SMR_FOLD_COS)
            tally->folds.open |= smr_piece_bit(i);
    }
    return close;
}

void smr_fold_find(void *arg, uint32_t task, uint32_t worker)
{
    smr_folds *f = arg;
    smr_worker *w = &f->shared->worker[worker];
    const uint32_t first = task * SMR_DIHEDRAL_CHUNK;
    const uint32_t last = smr_min_u32(first + SMR_DIHEDRAL_CHUNK, f->shared->n_dihedrals);
    const int several = f->shared->n_structures > 1u;
    if (w->at == 0u) {
        memset(&f->tally[task].folds, 0, sizeof f->tally[task].folds);
        f->tally[task].folds.first = several ? SMR_NONE : 0u;
    }
    smr_worker_needs(w, SMR_FIND_PIECE * (SMR_WORK_DIHEDRAL + SMR_WORK_BENT));
    for (uint32_t from = first + w->at; from < last; from += SMR_FIND_PIECE) {
        if (smr_worker_stops(w, from - first))
            return;
        const uint32_t to = smr_min_u32(from + SMR_FIND_PIECE, last), n = find(f, from, to, &f->tally[task]);
        if (several)
            add_structures(f, from, to, &f->tally[task]);
        smr_work(&w->pause, SMR_FIND_PIECE * SMR_WORK_DIHEDRAL + n * SMR_WORK_BENT);
    }
}

SMR_SELDOM void smr_fold_find_end(smr_folds *f)
{
    uint32_t bent = 0, open = 0;
    f->n_guarded = 0;
    for (uint32_t task = 0; task < f->n_dihedral_tasks; task++) {
        bent |= f->tally[task].folds.bent;
        open |= f->tally[task].folds.open;
    }
    if ((bent | open) == 0u)
        return;
    memset(f->folding, 0, f->shared->n_structures * sizeof *f->folding);
    memset(f->marked, 0, f->shared->n);
    memset(f->touched, 0, smr_ceil_div(f->shared->n_triangles, 64) * sizeof *f->touched);
    if (bent != 0u && f->schedule->repairing > 0u)
        smr_fold_repair_start(f);
    else if (bent != 0u)
        smr_fold_limit_start(f);
    smr_fold_open_start(f);
}

void smr_folds_moved(smr_folds *f)
{
    f->n_guarded = 0;
    for (uint32_t v = 0; v < f->shared->n; v++)
        f->n_guarded += f->marked[v];
    f->moved = 1;
}
