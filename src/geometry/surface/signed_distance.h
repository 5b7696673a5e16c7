/* signed_distance.h: signed distance of a point to a closed surface, and the outward direction.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SIGNED_DISTANCE_H
#define SMR_SIGNED_DISTANCE_H

#include "geometry/box_tree/box_tree.h"

/* The position of a point relative to a surface. Distance and direction are continuous functions of the point. */
typedef struct smr_side {
    float mm;          /* signed distance, negative inside */
    smr_vec out;       /* gradient of the distance, about unit length; 0 where opposite directions are equally short */
    uint32_t triangle; /* closest triangle, in tree order */
    float weight[3];   /* barycentric weights of the closest point */
} smr_side;

/* Finds the signed distance of q->point to the acceptable triangles within `most` mm. normal: [vertices][3] unit vertex
 * normals. Returns 0, with *side unchanged, when there is no such triangle. */
int smr_signed_distance(const smr_box_tree *f, const float *normal, const smr_query *q, float most, smr_side *side);

#endif
