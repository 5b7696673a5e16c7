/* points.h: a cloud of points in the caller's memory: a target surface without triangles. The points of a cloud attract
 * the model by position, normal and weight, as target vertices do by position, normal and area.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_POINTS_H
#define SMR_POINTS_H

#include "geometry/surface/surface.h"

struct smr_points {
    uint32_t magic;      /* SMR_POINTS_MAGIC */
    uint32_t next;       /* slot of the next point, < surface.capacity */
    smr_surface surface; /* the first n_vertices slots hold xyz, normal (0: none) and, as area, the weight; origin 0 */
};

#define SMR_POINTS_MAGIC 0x736d7250u
#define SMR_WEIGHT_MAX 4.0f /* largest weight of a point, so that the sums of target-to-model forces fit 32 bits */

/* Returns 1 for points opened by smr_points_open(). */
static inline int smr_points_valid(const smr_points *p) { return p != NULL && p->magic == SMR_POINTS_MAGIC; }

#endif
