/* correspondence_rejection.c: rejects correspondences: outliers by distance, pairs on an open border, and places
 * outside the box. The search rejects disagreeing normals (box_tree_search.c), the build of a target stray components
 * (surface_fragments.c), confidence rejects image goals (image_goals.c), and visibility weights the vertices of partial
 * targets (target_visibility.c).
 * Source: paper 2.1. Bounds: constant.
 * SPDX-License-Identifier: MIT */
#include "registration/surface_goals/closest_point_goals.h"

int smr_reject_outside(const smr_config *c, smr_vec p)
{
    const smr_forces_config *f = &c->forces;
    return f->use_box && (p.x < f->box_min[0] || p.y < f->box_min[1] || p.z < f->box_min[2] || p.x > f->box_max[0] ||
                          p.y > f->box_max[1] || p.z > f->box_max[2]);
}

int smr_reject_distance(const smr_surface_goals *g, float d2) { return g->limit > 0.0f && d2 > g->limit * g->limit; }

int smr_reject_border(const smr_surface_goals *g, const smr_surface *target, const smr_hit *hit)
{
    return g->shared->config.forces.reject_border && smr_surface_on_border(target, hit->triangle, hit->weight);
}

float smr_reject_limit(const smr_config *c, uint32_t n_forces, float mean, float mean_square)
{
    const float k = c->forces.reject_deviations;
    const float deviation = SMR_SQRT(smr_max(mean_square - mean * mean, 0.0f));
    return k > 0.0f && n_forces > 0u ? smr_max(mean + k * deviation, 1.0e-3f) : 0.0f;
}

smr_vec smr_shortened(smr_vec r, float by)
{
    return smr_scale(r, smr_positive(1.0f - by / smr_max(smr_length(r), by)));
}
