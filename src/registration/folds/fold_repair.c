/* fold_repair.c: repairs folds in one iteration before the last radius but one, or before the first radius if that is
 * the last. A patch around a fold gets the smoothest displacement from the rest shape that fits its surroundings. Some
 * folds remain: larger patches would lose more of what forces found than the folds do. The last radius opens most of
 * the rest.
 * Bounds: one pass over the dihedral edges; 2 SMR_REPAIR_RINGS + 2 SMR_REPAIR_SWEEPS + 1 over a structure.
 * SPDX-License-Identifier: MIT */
#include "registration/folds/folds.h"

#define SMR_EDGE_FLOOR 1.0e-3f /* mm: added to edge lengths in divisors */
#define SMR_REPAIR_CHUNK 128u  /* number of dihedral edges, triangles or vertices in a task */
#define SMR_REPAIR_RINGS 2u    /* number of rings of vertices in the patch, around those of the fold */
#define SMR_REPAIR_SWEEPS 10u  /* number of sweeps over the patch */

/* Stages of the repair: none; mark folds; then for each structure with folds the others, in this order. */
enum { REPAIR_IDLE, REPAIR_MARK, REPAIR_WIDER, REPAIR_JOIN, REPAIR_CLEAR, REPAIR_SUM, REPAIR_MOVE };

static void mark(smr_folds *f, uint32_t triangle)
{
    const uint32_t *t = smr_corners(f, triangle);
    for (uint32_t c = 0; c < 3u; c++)
        f->marked[t[c]] = 1;
    f->folding[smr_model_owner(f->shared->model, t[0])] = 1;
}

/* Marks the corners of dihedral edges that fold at x_next, in chunks where fold_find.c found folds. */
SMR_SELDOM static void mark_folds(smr_folds *f, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        const smr_stored_dihedral *h = smr_edge_at(f, i);
        if (f->tally[i / SMR_DIHEDRAL_CHUNK].folds.bent == 0u ||
            !(smr_dihedral_cosine(f, f->shape->x_next, h) < smr_edge_limit(h)))
            continue;
        mark(f, smr_edge_first(f, h));
        mark(f, smr_edge_second(f, h));
    }
}

/* Marks the mesh neighbours of marked vertices by another bit, so that a pass adds one ring. */
static void widen(smr_folds *f, uint32_t triangle, uint32_t last)
{
    for (; triangle < last; triangle++) {
        const uint32_t *const t = smr_corners(f, triangle);
        if ((f->marked[t[0]] | f->marked[t[1]] | f->marked[t[2]]) & 1u)
            for (uint32_t c = 0; c < 3u; c++)
                f->marked[t[c]] |= 2u;
    }
}

/* Makes the marks of all rings equal to 1. */
static void join(smr_folds *f, uint32_t triangle, uint32_t last)
{
    for (; triangle < last; triangle++)
        for (uint32_t c = 0; c < 3u; c++)
            f->marked[smr_corners(f, triangle)[c]] = f->marked[smr_corners(f, triangle)[c]] != 0u;
}

static void clear_ring(smr_folds *f, uint32_t v)
{
    smr_put3(f->rings.sum, v, smr_v(0, 0, 0));
    f->rings.weight[v] = 0.0f;
}

/* Clears the sums of triangles with marked corners, stores the corners' rest shape, and touches them. */
SMR_SELDOM static void clear_rings(smr_folds *f, uint32_t triangle, uint32_t last)
{
    for (; triangle < last; triangle++) {
        if (!smr_any_marked(f, triangle))
            continue;
        smr_triangle_touch(f, triangle);
        for (uint32_t c = 0; c < 3u; c++) {
            const uint32_t v = smr_corners(f, triangle)[c];
            clear_ring(f, v);
            smr_put3(f->rings.displacement, v, smr_rest_posed(f->shape, v));
        }
    }
}

static smr_vec rest_of(const smr_folds *f, uint32_t v) { return smr_get3(f->rings.displacement, v); }

/* Adds a triangle to the sums of neighbours' displacements. Near neighbours weigh more: slivers' corners move alike. */
static void sum_ring(smr_folds *f, const uint32_t *t)
{
    smr_vec at[3], moved[3];
    for (uint32_t c = 0; c < 3u; c++) {
        at[c] = rest_of(f, t[c]);
        moved[c] = smr_sub(smr_get3(f->shape->x_next, t[c]), at[c]);
    }
    for (uint32_t a = 0; a < 3u; a++) { /* the edge from corner a to the next, in both directions */
        const uint32_t b = (a + 1u) % 3u;
        const float w = 1.0f / (smr_length(smr_sub(at[a], at[b])) + SMR_EDGE_FLOOR);
        smr_add3(f->rings.sum, t[a], smr_scale(moved[b], w));
        smr_add3(f->rings.sum, t[b], smr_scale(moved[a], w));
        f->rings.weight[t[a]] += w;
        f->rings.weight[t[b]] += w;
    }
}

SMR_SELDOM static void sum_rings(smr_folds *f, uint32_t triangle, uint32_t last)
{
    for (; triangle < last; triangle++)
        if (f->touched[triangle / 64u] == 0u)
            triangle |= 63u;
        else if (smr_triangle_touched(f, triangle))
            sum_ring(f, smr_corners(f, triangle));
}

/* Sets the displacements of marked vertices to the weighted mean of their mesh neighbours' displacements. Several
 * sweeps approach the smoothest displacement that fits the surroundings. */
SMR_SELDOM static void move(smr_folds *f, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_model_position(f->shared->model, i);
        if (!f->marked[v])
            continue;
        const smr_vec mean = smr_scale(smr_get3(f->rings.sum, v), 1.0f / f->rings.weight[v]);
        smr_put3(f->shape->x_next, v, smr_add(rest_of(f, v), mean));
        clear_ring(f, v); /* the next sweep sums from 0 again */
    }
}

SMR_SELDOM static void next_structure(smr_folds *f)
{
    smr_fold_repair *r = &f->repair;
    r->pass.structure = smr_folding_from(f, r->pass.structure);
    r->ring = r->sweep = 0;
    r->pass.stage = r->pass.structure < f->shared->n_structures ? REPAIR_WIDER : REPAIR_IDLE;
}

SMR_SELDOM static void next_pass(smr_folds *f)
{
    smr_fold_repair *r = &f->repair;
    r->pass.at = 0;
    if (r->pass.stage == REPAIR_MARK) {
        next_structure(f);
    } else if (r->pass.stage == REPAIR_JOIN) {
        r->pass.stage = ++r->ring < SMR_REPAIR_RINGS ? REPAIR_WIDER : REPAIR_CLEAR;
    } else if (r->pass.stage != REPAIR_MOVE) {
        r->pass.stage++;
    } else if (++r->sweep < SMR_REPAIR_SWEEPS) {
        r->pass.stage = REPAIR_SUM;
    } else {
        r->pass.structure++;
        next_structure(f);
    }
}

void smr_fold_repair_start(smr_folds *f)
{
    memset(&f->repair, 0, sizeof f->repair);
    f->repair.pass.stage = REPAIR_MARK;
}

uint32_t smr_fold_repair_tasks(const void *folds) { return smr_fold_tasks(&((const smr_folds *)folds)->repair.pass); }

static const smr_fold_stage stages[] = {
    [REPAIR_MARK] = {SMR_OVER_DIHEDRALS, SMR_REPAIR_CHUNK, mark_folds},
    [REPAIR_WIDER] = {SMR_OVER_TRIANGLES, SMR_REPAIR_CHUNK, widen},
    [REPAIR_JOIN] = {SMR_OVER_TRIANGLES, SMR_REPAIR_CHUNK, join},
    [REPAIR_CLEAR] = {SMR_OVER_TRIANGLES, SMR_REPAIR_CHUNK, clear_rings},
    [REPAIR_SUM] = {SMR_OVER_TRIANGLES, SMR_REPAIR_CHUNK, sum_rings},
    [REPAIR_MOVE] = {SMR_OVER_VERTICES, SMR_REPAIR_CHUNK, move},
};

void smr_fold_repair_pass(void *arg, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_folds *f = arg;
    if (smr_fold_run(f, &f->repair.pass, stages))
        next_pass(f);
}
