/* points.h: a cloud of points in the caller's memory: a target surface without triangles. What attracts the model are a
 * surface's vertices, their normals and areas; points have the same, with weights for areas.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_POINTS_H
#define SMR_POINTS_H

#include "geometry/surface/surface.h"

struct smr_points {
    uint32_t magic;      /* SMR_POINTS_MAGIC */
    uint32_t next;       /* slot that the next point takes, < surface.capacity */
    smr_surface surface; /* xyz, normal (0: none) and area (the weight) of the first n_vertices slots; origin 0 */
};

#define SMR_POINTS_MAGIC 0x736d7250u
#define SMR_WEIGHT_MAX 4.0f /* of a point: the sums of pulls must fit */

/* 1 for points that smr_points_open() has made. */
static inline int smr_points_valid(const smr_points *p) { return p != NULL && p->magic == SMR_POINTS_MAGIC; }

#endif
