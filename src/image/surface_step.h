/* surface_step.h: where along the surface an intensity profile fits better.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_STEP_H
#define SMR_SURFACE_STEP_H

#include "image/intensity_profile.h"
#include "image/volume.h"

/* A reference profile and the place in an image at which it was found. */
typedef struct smr_place {
    const smr_profile *reference;
    smr_vec start, step; /* of its samples there, world mm */
    smr_vec normal;      /* unit length, along step */
    const float *found;  /* [reference->n] the image's values there */
    float gain;          /* the image's contrast against the reference's: it differs between images of one kind */
    float noise;         /* intensity: contrast below it counts as none */
    float reach_mm;      /* above 0: how far to either side the image is looked at, and the longest way there is */
} smr_place;

/* The contrast of n values against the reference's: the ratio of their deviations; not negative, not NaN, 4 at most. */
float smr_contrast(const smr_profile *reference, const float *found);

/* The way across the normal, mm, on which the image's values come to be the reference's. 0 where the image does not change
 * across the normal, or part of what is looked at lies outside. */
smr_vec smr_sideways(const smr_grid *image, const smr_place *at);

#endif
