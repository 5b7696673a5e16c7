/* enclosed_volume.h: the volume that closed triangles enclose, and how it changes when vertices go along their normals.
 * In: triangles, positions. Out: whether there is a volume, and the volume.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ENCLOSED_VOLUME_H
#define SMR_ENCLOSED_VOLUME_H

#include "registration/shape/shape.h"

/* Volume while each vertex goes t mm along its normal: c[0] + c[1] t + c[2] t^2 + c[3] t^3, mm^3. Negative where
 * triangles look inwards. c[1] is the area, mm^2, but for how far normals of vertices lean. */
typedef struct smr_enclosed {
    float c[4];
} smr_enclosed;

/* A point amid the structure's vertices at xyz [n][3] (NULL: at rest), from a few of them. Cones start there. */
smr_vec smr_amid(const smr_shape *shape, uint32_t structure, float *xyz);

/* The volume of the cone over a triangle from a point at 0. at, normal: of its corners. */
smr_enclosed smr_cone(const smr_vec at[3], const smr_vec normal[3]);

static inline smr_enclosed smr_enclosed_add(smr_enclosed a, smr_enclosed b)
{
    for (uint32_t i = 0; i < 4u; i++)
        a.c[i] += b.c[i];
    return a;
}

/* The volume at t. */
static inline float smr_enclosed_at(const smr_enclosed *e, float t)
{
    return e->c[0] + t * (e->c[1] + t * (e->c[2] + t * e->c[3]));
}

/* How far the vertices must go for this volume, within +-most mm. */
float smr_enclosed_way(const smr_enclosed *e, float volume, float most);

/* The volume of a structure with its vertices at x [n][3] (NULL: at rest), mm^3. */
float smr_enclosed_of(const smr_shape *shape, uint32_t structure, float *x);

/* Of the rest shape: 1 when it is closed and encloses a volume, mm^3, and then its volume over its area, mm. */
int smr_rest_volume(const smr_shape *shape, uint32_t structure, float *mm3, float *thick_mm);

/* The scale of the similarity that lays the whole model's rest shape onto the start positions best. */
float smr_start_scale(const smr_shape *shape);

/* 1: the start positions are mirrored. */
int smr_start_mirrored(const smr_shape *shape);

#endif
