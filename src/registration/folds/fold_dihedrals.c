/* fold_dihedrals.c: the cosine of a dihedral edge, runs of triangles, and passes, for all steps of folds.
 * Bounds: two triangles for each dihedral edge.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/folds/folds.h"

void smr_runs_clear(smr_folds *f)
{
    memset(f->touched, 0, sizeof f->touched);
    f->run_bits = 0;
    while (f->shared->n_triangles >> f->run_bits >= SMR_RUNS)
        f->run_bits++;
}

static smr_vec normal_at(const smr_folds *f, float *x, uint32_t triangle)
{
    return smr_unit(smr_corners_cross(x, smr_corners(f, triangle)));
}

float smr_dihedral_cosine(const smr_folds *f, float *x, const smr_stored_dihedral *h)
{
    return smr_dot(normal_at(f, x, smr_edge_first(f, h)), normal_at(f, x, smr_edge_second(f, h)));
}

uint32_t smr_folding_from(const smr_folds *f, uint32_t structure)
{
    while (structure < f->shared->n_structures && !f->folding[structure])
        structure++;
    return structure;
}

int smr_fold_run(smr_folds *f, smr_fold_pass *p, const smr_fold_stage *stages)
{
    const smr_fold_stage *stage = &stages[p->stage];
    const smr_shape_structure *one = &f->shape->structure[p->structure];
    uint32_t first = 0, length = f->shared->n_dihedrals;
    if (stage->over == SMR_OVER_TRIANGLES) {
        first = one->first_triangle;
        length = one->tree.n_triangles;
    } else if (stage->over == SMR_OVER_VERTICES) {
        first = one->first_vertex;
        length = one->n_vertices;
    } else if (stage->over == SMR_OVER_LISTED) {
        length = smr_min_u32(f->limit.n_listed, f->shared->n);
    }
    const uint32_t end = smr_min_u32(p->at + stage->chunk, length);
    stage->run(f, first + p->at, first + end);
    p->at = end;
    p->n_done++;
    return end == length;
}
