/* intensity_profile.h: intensity profiles along vertex normals, and their registration in one dimension.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_INTENSITY_PROFILE_H
#define SMR_INTENSITY_PROFILE_H

#include "base/vec.h"

#define SMR_PROFILE_MAX 64u /* samples of a reference profile */
#define SMR_LINE_MAX 320u   /* samples of a line searched */

/* Where a goal lies along the line, in samples, and how much it is to be believed, 0..1 (0: no goal). */
typedef struct smr_peak {
    float at;
    float confidence;
} smr_peak;

/* A reference profile as it is compared: sample k is low + value[k] * range / 255. */
typedef struct smr_profile {
    const uint8_t *value;
    float low, range;
    uint32_t n;
} smr_profile;

/* Packs n samples into bytes between their minimum and maximum. low, range: value = low + byte * range / 255. range is 0
 * when the profile is flat or not all of it is inside: such a profile never gives a goal. */
void smr_profile_pack(const float *value, const unsigned char *inside, uint32_t n, uint8_t *packed, float *low,
                      float *range);

/* How likeness is scored. */
typedef struct smr_likeness {
    uint32_t kind; /* SMR_SIMILARITY_... */
    float noise;   /* intensity: concordance takes contrast below it for none */
    float
        nearer; /* what a score loses at the ends of the line, less towards its middle: of like peaks the nearer wins */
} smr_likeness;

/* The offset 0 .. m - n at which the n samples of the reference fit the line best. low and range matter but for correlation. */
smr_peak smr_profile_match(const smr_profile *reference, const float *line, const unsigned char *inside, uint32_t m,
                           const smr_likeness *how);

/* The best edge within `reach` samples of line sample `centre`: of the polarity and brightness of the reference's own, which is
 * its strongest one near its sample `zero`, rather steeper than less steep, but not by far, and rather near. The goal is moved
 * by as much as the reference's own edge misses `zero`. */
smr_peak smr_profile_edge(const smr_profile *reference, uint32_t zero, const float *line, const unsigned char *inside,
                          uint32_t m, uint32_t centre, uint32_t reach);

#endif
