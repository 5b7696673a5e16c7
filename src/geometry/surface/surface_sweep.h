/* surface_sweep.h: what surface_contact.c measures at places of one surface: depth in another surface, contact area.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_SWEEP_H
#define SMR_SURFACE_SWEEP_H

#include "geometry/surface/surface.h"

#define SMR_DEPTH_MOST 100.0f     /* mm: greater depths count as this depth */
#define SMR_SWEEP_MORE 1.001f     /* factor on lengths that must not be too short by rounding */
#define SMR_SWEEP_MORE_MM 1.0e-4f /* added to such lengths, mm */

/* What tasks have found of surface a in surface b. */
typedef struct smr_sweep_found {
    smr_box near;  /* box around all triangles of a that can reach into b, mm from a's origin */
    float deepest; /* largest depth in b, mm */
    float sum;     /* area in contact, mm^2; of lines: their length inside both surfaces, mm */
} smr_sweep_found;

/* Depth and contact area of surface a in surface b, measured at a's triangles and vertices. */
typedef struct smr_sweep {
    const smr_surface *a, *b;
    smr_vec shift;  /* vector from a's origin to b's, mm */
    smr_box around; /* box around b, mm from b's origin */
    float within;   /* largest distance that counts as contact, mm */
    smr_sweep_found found;
} smr_sweep;

/* A place whose signed distance to b is known. */
typedef struct smr_sweep_place {
    smr_vec at;    /* mm from b's origin */
    float side;    /* signed distance, mm; SMR_FAR: unknown */
    uint32_t warm; /* closest triangle of b, to be tried first at the next place; SMR_NONE: none */
    int inside;    /* 1: b's winding number is not 0; the side may be positive even then, where b overlaps itself */
} smr_sweep_place;

/* The middle of a triangle of one surface, and what is known of the other surface there. */
typedef struct smr_sweep_middle {
    smr_sweep_place at;
    float third; /* a third of the triangle's area, mm^2, where three points must be searched from; 0: none */
    float sum;   /* area that is in contact without these searches, mm^2 */
} smr_sweep_middle;

static const smr_box smr_sweep_no_box = {{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};

smr_box smr_sweep_box(const smr_surface *s); /* box around all triangles, mm from the surface's origin */
int smr_sweep_leaf(const smr_sweep *s, uint32_t leaf, smr_sweep_place *middle);
smr_sweep_middle smr_sweep_triangle(const smr_sweep *s, uint32_t k, smr_sweep_place *last, smr_sweep_found *f);
void smr_sweep_point(const smr_sweep *s, smr_vec p, float third, const smr_sweep_place *middle, smr_sweep_found *f);
void smr_sweep_vertices(const smr_sweep *s, smr_piece piece, smr_sweep_found *f);

#endif
