/* fold_dihedrals.c: the cosine of a dihedral edge, and passes, for all steps of folds.
 * Bounds: two triangles for each dihedral edge.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/folds/folds.h"

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

int smr_marked_since(const smr_folds *f, const smr_tally *tally, uint32_t round)
{
    for (uint32_t k = tally->folds.first; k <= tally->folds.last && k < f->shared->n_structures; k++)
        if (f->folding[k] > round)
            return 1;
    return 0;
}

uint32_t smr_next_touched(const smr_folds *f, uint32_t from, uint32_t to)
{
    const smr_stored_dihedral *const dihedral = smr_edge_at(f, 0);
    const uint64_t *const touched = f->touched;
    const uint32_t n = f->shared->n_triangles;
    for (; from < to; from++) {
        const uint32_t first = smr_index(smr_le32(dihedral[from].first), n);
        const uint32_t second = smr_index(smr_le32(dihedral[from].bend) & SMR_DIHEDRAL_MASK, n);
        if ((touched[first / 64u] >> (first % 64u) | touched[second / 64u] >> (second % 64u)) & 1u)
            break;
    }
    return from;
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
