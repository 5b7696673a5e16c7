/* tangential_shift.h: the displacement along the surface after which an image agrees better with a reference profile.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TANGENTIAL_SHIFT_H
#define SMR_TANGENTIAL_SHIFT_H

#include "image/intensity_profile.h"
#include "image/volume.h"

/* Reference profile and image, each less its mean, divided by the reference's range. */
typedef struct smr_centred {
    float reference[SMR_PROFILE_MAX], image[SMR_PROFILE_MAX]; /* [n] of the reference's n samples */
} smr_centred;

/* A reference profile, and the line of image samples that it is compared with. */
typedef struct smr_place {
    const smr_profile *reference;
    smr_vec start, spacing;  /* the first sample's position, and the vector from one sample to the next, mm */
    smr_vec normal;          /* unit normal of the surface, along `spacing` */
    const smr_centred *both; /* reference and image at the samples */
    float gain;              /* contrast of the image divided by that of the reference (smr_contrast) */
    float noise;             /* noise level, intensity: shifts that such noise could cause are damped */
    float reach_mm;          /* mm, > 0: distance of four other lines from this line; longest shift */
} smr_place;

/* Writes *both from a reference with a range and found[reference->n], intensities of the image. */
void smr_centre(const smr_profile *reference, const float *found, smr_centred *both);

/* Returns the standard deviation of n samples of the image divided by the reference's, limited to 0 .. 4, never NaN. */
float smr_contrast(const smr_centred *both, uint32_t n);

/* Returns the displacement across the normal, mm, at most at->reach_mm long, after which the image agrees best with
 * the reference. 0 where the image does not change along the surface, or where a sample lies outside the image. */
smr_vec smr_tangential_shift(const smr_grid *image, const smr_place *at);

#endif
