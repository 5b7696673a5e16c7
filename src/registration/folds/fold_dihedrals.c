/* fold_dihedrals.c: the cosine of a dihedral edge, runs of triangles, and pieces of passes, for all steps of folds.
 * Bounds: two triangles for each dihedral edge.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/folds/folds.h"

void smr_runs_clear(smr_folds *f)
{
    memset(f->touched, 0, sizeof f->touched);
    f->run_bits = f->n_touched = 0;
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

smr_fold_piece smr_fold_piece_of(const smr_folds *f, const smr_fold_pass *p, uint32_t over, uint32_t chunk)
{
    const smr_shape_structure *one = &f->shape->structure[p->structure];
    smr_fold_piece piece = {0, 0, 0, f->shared->n_dihedrals};
    if (over == SMR_OVER_TRIANGLES) {
        piece.first = one->first_triangle;
        piece.length = one->tree.n_triangles;
    } else if (over == SMR_OVER_VERTICES) {
        piece.first = one->first_vertex;
        piece.length = one->n_vertices;
    }
    piece.from = piece.first + p->at;
    piece.to = piece.first + smr_min_u32(p->at + chunk, piece.length);
    return piece;
}
