/* enclosed_volume.h: the volume that closed triangles enclose, and its change while vertices move along their normals.
 * In: triangles, positions. Out: volumes.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ENCLOSED_VOLUME_H
#define SMR_ENCLOSED_VOLUME_H

#include "registration/shape/deformed_shape.h"

/* Volume after each vertex has moved t mm along its normal: c[0] + c[1] t + c[2] t^2 + c[3] t^3, mm^3. Negative when
 * triangles face inwards. c[1] is about the area, mm^2. */
typedef struct smr_enclosed {
    float c[4];
} smr_enclosed;

/* Returns the apex of a structure's cones, mm: the mean of some vertices at xyz [n][3] (NULL: rest shape). */
smr_vec smr_cone_apex(const smr_shape *shape, uint32_t structure, float *xyz);
/* Returns the volume of the cone from 0 to a triangle. at, normal: positions (mm) and normals of the corners. */
smr_enclosed smr_cone(const smr_vec at[3], const smr_vec normal[3]);

static inline smr_enclosed smr_enclosed_add(smr_enclosed a, smr_enclosed b)
{
    for (uint32_t i = 0; i < 4u; i++)
        a.c[i] += b.c[i];
    return a;
}

/* Returns the displacement of all vertices along their normals that gives this volume, mm, within +-most. */
float smr_enclosed_displacement(const smr_enclosed *e, float volume, float most);
/* Returns the volume of a structure with its vertices at x [n][3] (NULL: rest shape), mm^3. */
float smr_enclosed_of(const smr_shape *shape, uint32_t structure, float *x);
/* Returns 1 when the structure's rest shape is closed. *mm3: its volume; *thick_mm: volume / area. */
int smr_rest_volume(const smr_shape *shape, uint32_t structure, float *mm3, float *thick_mm);
/* Returns the scale of the similarity that maps the whole model's rest shape onto the start positions. */
float smr_start_scale(const smr_shape *shape);
int smr_start_mirrored(const smr_shape *shape); /* 1: the start positions are a mirror image of the rest shape */

#endif
