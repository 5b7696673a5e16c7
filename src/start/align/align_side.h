/* align_side.h: one of the two surfaces that are aligned: samples, principal axes, whether it is inside out.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_SIDE_H
#define SMR_ALIGN_SIDE_H

#include "geometry/surface/surface.h"

/* The closest point of the other surface to a sample. */
typedef struct smr_pair {
    smr_vec at;        /* mm, in the other surface's coordinates */
    float d2;          /* mm^2, in the target's coordinates; at most the search limit */
    uint32_t triangle; /* of the other surface; SMR_NONE when none is within the limit and agrees */
    uint32_t border;   /* 1: on an open border */
} smr_pair;

typedef struct smr_align_side {
    const smr_surface *surface;
    uint32_t n;      /* samples */
    smr_vec *point;  /* [n] mm, relative to the surface's origin */
    smr_vec *normal; /* [n] unit, outward */
    float *weight;   /* [n] the area it stands for, over the mean */
    smr_pair *pair;  /* [n] */
    uint32_t bare;   /* 1: a cloud whose points have no normals */
    float outward;   /* 1; -1 for a closed surface that is inside out */
    smr_vec centre;  /* mm: area-weighted */
    float axes[9];   /* principal axes (columns), longest first */
    float spread;    /* standard deviation, mm */
} smr_align_side;

/* The sample that is the k-th of n evenly chosen ones. */
static inline uint32_t smr_sample(const smr_align_side *side, uint32_t k, uint32_t n)
{
    return (uint32_t)(((uint64_t)2u * k + 1u) * side->n / (2u * (uint64_t)n));
}

/* Describes a surface and takes n samples. point, normal, weight and pair are set already. */
void smr_align_side_make(smr_align_side *side, const smr_surface *surface, uint32_t n);

#endif
