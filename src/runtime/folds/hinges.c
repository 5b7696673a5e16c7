/* hinges.c: the angle at a hinge, and runs of triangles that nothing has touched, for the steps of fold handling.
 * Bounds: two triangles a hinge.
 * SPDX-License-Identifier: MIT */
#include "geometry/triangle.h"
#include "runtime/folds/folds.h"

void smr_runs_clear(smr_folds *f)
{
    memset(f->touched, 0, sizeof f->touched);
    f->run_bits = 0;
    while (f->shared->n_triangles >> f->run_bits >= SMR_RUNS)
        f->run_bits++;
}

static smr_vec normal_at(const smr_folds *f, float *x, uint32_t triangle)
{
    const uint32_t *t = smr_corners(f, triangle);
    return smr_unit(
        smr_triangle_cross(smr_load(smr_at3(x, t[0])), smr_load(smr_at3(x, t[1])), smr_load(smr_at3(x, t[2]))));
}

float smr_hinge_cosine(const smr_folds *f, float *x, const smr_stored_hinge *h)
{
    return smr_dot(normal_at(f, x, smr_le32(h->first)), normal_at(f, x, smr_hinge_second(h)));
}
