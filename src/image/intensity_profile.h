/* intensity_profile.h: intensity profiles along vertex normals and the two ways to a goal position (paper 2.1):
 * profile registration (profile_match.c) and maximal gradient search (gradient_search.c).
 * SPDX-License-Identifier: MIT */
#ifndef SMR_INTENSITY_PROFILE_H
#define SMR_INTENSITY_PROFILE_H

#include "base/vec.h"

#define SMR_PROFILE_MAX 64u /* largest number of samples of a reference profile */
#define SMR_LINE_MAX 320u   /* largest number of samples of a line that is searched */

/* A goal position found along a line of image samples. */
typedef struct smr_peak {
    float at;         /* position of the goal on the line, in samples */
    float confidence; /* confidence of the goal, 0 .. 1; 0: no goal */
} smr_peak;

/* A reference profile: the intensity of sample k is low + value[k] * range / 255. */
typedef struct smr_profile {
    const uint8_t *value; /* [n] packed intensities, 0 .. 255 */
    float low, range;     /* lowest intensity; highest minus lowest one. range 0: flat or partly outside, no goal */
    uint32_t n;           /* number of samples, at most SMR_PROFILE_MAX */
} smr_profile;

/* Packs the intensities value[n] into packed[n], *low and *range, which are the fields of an smr_profile. */
void smr_profile_pack(const float *value, const uint8_t *inside, uint32_t n, uint8_t *packed, float *low, float *range);

/* How smr_profile_match() measures the similarity of profiles. */
typedef struct smr_similarity {
    uint32_t kind;  /* SMR_SIMILARITY_...: which similarity measure */
    float noise;    /* noise level, intensity: concordance of lower contrasts is near 0 */
    float nearer;   /* score subtracted at the first and last offset; less near the middle: * (distance / half)^2 */
    uint32_t plain; /* 1: a match has the confidence 1 whatever its score */
} smr_similarity;

/* Returns the offset 0 .. m - n at which the reference, of n samples, is most similar to line[m]. Without a match the
 * confidence is 0. With correlation the result does not depend on the reference's low and range. inside[m]: 1 for
 * samples inside the image; NULL: all are. */
smr_peak smr_profile_match(const smr_profile *reference, const float *line, const uint8_t *inside, uint32_t m,
                           const smr_similarity *how);

/* Returns the goal by the best edge within `reach` samples of line sample `centre`: the reference edge's polarity and
 * similar brightness, steep, near. The reference edge is the reference's steepest edge near its sample `zero`, the
 * surface. The goal is as far from the best edge as `zero` is from the reference edge. Confidence 0: no edge.
 * inside NULL: all samples are inside. */
smr_peak smr_profile_edge(const smr_profile *reference, uint32_t zero, const float *line, const uint8_t *inside,
                          uint32_t m, uint32_t centre, uint32_t reach);
/* Returns the steepest place within `reach` samples of sample `centre` (paper 3). Confidence 1; on constant lines 0.
 * inside NULL: all samples are inside. */
smr_peak smr_steepest(const float *line, const uint8_t *inside, uint32_t m, uint32_t centre, uint32_t reach);

/* Returns where a parabola through three successive values has its maximum: -0.5 .. 0.5 samples from the middle one. */
static inline float smr_parabola_peak(float before, float at, float after)
{
    const float bend = before - 2.0f * at + after;
    return bend < 0.0f ? smr_clamp(0.5f * (before - after) / bend, -0.5f, 0.5f) : 0.0f;
}

#endif
