/* signed_distance.h: on which side of a closed surface a point lies, how far from it, and the way out.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SIGNED_DISTANCE_H
#define SMR_SIGNED_DISTANCE_H

#include "geometry/box_tree/box_tree.h"

/* Where a point lies. Distance and direction are continuous in the positions. */
typedef struct smr_side {
    float mm;          /* signed distance, negative inside */
    smr_vec out;       /* about unit, gradient of the distance; 0 where opposite ways are equally short */
    uint32_t triangle; /* the closest one, in tree order */
    float weight[3];   /* barycentric weights of the closest point */
} smr_side;

/* Finds the side of q->point among acceptable triangles within `most` mm. normal: [number of vertices][3] unit vertex
 * normals. Returns 0 when there is no such triangle; *side is unchanged then. */
int smr_signed_distance(const smr_facets *f, const float *normal, const smr_query *q, float most, smr_side *side);

#endif
