/* align_side.h: one of the two aligned surfaces: samples, principal axes, and whether it is inside out.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_SIDE_H
#define SMR_ALIGN_SIDE_H

#include "geometry/surface/surface.h"

/* The closest point of the other surface to a sample. */
typedef struct smr_pair {
    smr_vec at;        /* position in the other surface's coordinates, mm */
    float d2;          /* squared distance in the target's coordinates, mm^2; at most the search limit */
    uint32_t triangle; /* triangle of the other surface; SMR_NONE without an agreeing one within the limit */
    uint32_t border;   /* 1: the closest point lies on an open border */
} smr_pair;

typedef struct smr_align_side {
    const smr_surface *surface;
    uint32_t n;      /* number of samples */
    smr_vec *point;  /* [n] positions relative to the surface's origin, mm */
    smr_vec *normal; /* [n] unit normals, outward */
    float *weight;   /* [n] area that a sample represents, over the mean */
    smr_pair *pair;  /* [n] closest point of each sample */
    uint32_t bare;   /* 1: the surface is a cloud without normals */
    float outward;   /* 1; -1 for a closed surface that is inside out */
    smr_vec centre;  /* area-weighted centroid, mm */
    float axes[9];   /* principal axes (columns), longest first */
    float spread;    /* standard deviation of the positions, mm */
} smr_align_side;

/* The index of the k-th of n evenly chosen samples. */
static inline uint32_t smr_sample(const smr_align_side *side, uint32_t k, uint32_t n)
{
    return (uint32_t)(((uint64_t)2u * k + 1u) * side->n / (2u * (uint64_t)n));
}

/* Describes a surface and takes n samples. The arrays are already placed. */
void smr_align_side_make(smr_align_side *side, const smr_surface *surface, uint32_t n);

#endif
