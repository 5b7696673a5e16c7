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
/* The volume of a structure: sums over its triangles so far, and what follows from them. */
typedef struct smr_bulk {
    uint32_t at;     /* number of triangles that the sums contain */
    uint32_t half;   /* 1: `mm3` contains SMR_TRIANGLE_CHUNK triangles more */
    float mm3, area; /* volume, mm^3; area at rest, mm^2 */
    smr_vec apex;    /* apex of the cones, mm */
    uint64_t edges;  /* sum of hashes of the edges at rest: 0 when closed */
    uint32_t closed; /* result at rest: 1: the structure encloses a volume */
    float thick_mm;  /* result at rest: volume / area, mm */
} smr_bulk;

/* Adds SMR_TRIANGLE_CHUNK triangles to the sums, which begin as 0; those of the rest shape (x NULL) in two calls.
 * Returns 1 at the end. x: [n][3] mm. */
int smr_bulk_add(smr_bulk *b, const smr_shape *shape, uint32_t structure, float *x);
smr_bulk smr_rest_volume(const smr_shape *shape, uint32_t structure); /* the same at once, for the rest shape */

/* Adds the vertices first .. last - 1 to the fit of the rest shape to the start positions, or starts it at 0. */
void smr_start_fit(const smr_shape *shape, smr_fit *fit, uint32_t first, uint32_t last);
float smr_start_scale(const smr_fit *fit);  /* scale of the start, from the fit of all vertices */
int smr_start_mirrored(const smr_fit *fit); /* 1: the start positions are a mirror image of the rest shape */

#endif
