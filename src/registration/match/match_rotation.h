/* match_rotation.h: the transform of each cluster and the average of the transforms (paper 2.3). In: sums of
 * displacements, the reference's centres and spreads. Out: T_i = [R_i, t_i]; then, from the sums of these, each vertex'
 * goal position. SPDX-License-Identifier: MIT */
#ifndef SMR_MATCH_ROTATION_H
#define SMR_MATCH_ROTATION_H

#include "base/fixed_point.h"
#include "geometry/rotation/rotation_logarithm.h"
#include "registration/match/cluster_reference.h"

typedef struct smr_match {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_reference *reference;
    const smr_sums *sums;
    smr_tally *tally;
    float *transform; /* [n][12] R - I row-major, t in mm; averaged by logarithms: the first 6 of 12 are a twist */
    float *eigen;     /* [n][9] start values of the polar decomposition; NULL for the rigid method */
    float largest[2]; /* largest entry of R - I or of the rotation vector; largest entry of t or of the rate, mm */
} smr_match;

static inline int smr_blends_logs(const smr_shared *shared) { return shared->config.motion.fusing == SMR_FUSING_LIE; }

/* Words of a transform's record; the last three hold t or the rate. */
static inline uint32_t smr_transform_words(const smr_shared *shared) { return smr_blends_logs(shared) ? 6u : 12u; }

void smr_match_layout(smr_arena *a, smr_match *m, const smr_shared *shared);
void smr_match_reset(smr_match *m); /* discards start values of the decompositions */

uint32_t smr_match_cluster_tasks(const void *match);
void smr_match_clusters(void *match, uint32_t task, uint32_t worker);
void smr_match_end(smr_match *m); /* computes `largest` */

uint32_t smr_average_tasks(const void *match);
void smr_average_record(void *match, uint32_t task, uint32_t worker);

/* The averaged twist of a vertex, from its sum of 6 words. */
static inline smr_twist smr_average_twist(const uint32_t *w, const float inverse[2], float share)
{
    const smr_vec turn = smr_unfix3(w, inverse[0]);
    const smr_vec rate = smr_unfix3(w + 3, inverse[1]);
    const smr_twist twist = {smr_scale(turn, share), smr_scale(rate, share)};
    return twist;
}

/* The averaged transform of a vertex, from its sum of 12 words: Sum_i(T) / |zeta_i|. inverse: 1 / sums.scale. */
static inline smr_vec smr_average_transform(const uint32_t *w, const float inverse[2], float share, float r_minus_i[9])
{
    for (uint32_t i = 0; i < 9u; i++)
        r_minus_i[i] = smr_unfix(w[i], inverse[0]) * share;
    const smr_vec t = smr_unfix3(w + 9, inverse[1]);
    return smr_scale(t, share);
}

#endif
