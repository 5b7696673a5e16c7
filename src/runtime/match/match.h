/* match.h: the transform of each cluster and the average of the transforms (paper 2.3). In: sums of displacements, the
 * reference's centres and spreads. Out: T_i = [R_i, t_i]; then, from the sums of these, each vertex' goal position.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MATCH_H
#define SMR_MATCH_H

#include "base/fixed_point.h"
#include "runtime/match/reference.h"

typedef struct smr_match {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_reference *reference;
    const smr_sums *sums;
    smr_tally *tally;
    float *transform; /* [n][12] R - I row-major, t in mm */
    float *eigen;     /* [n][9] warm start of the polar method; NULL for rigid */
    float largest[2]; /* entry of R - I, and of t in mm */
} smr_match;

void smr_match_layout(smr_arena *a, smr_match *m, const smr_shared *shared);
void smr_match_wire(smr_match *m, const smr_shared *shared, const smr_pace *pace, const smr_reference *reference,
                    const smr_sums *sums, const smr_overlay *overlay);
void smr_match_reset(smr_match *m); /* no warm start is left */

uint32_t smr_match_cluster_tasks(const void *match);
void smr_match_clusters(void *match, uint32_t task, uint32_t worker);
void smr_match_end(smr_match *m); /* largest */

/* average.c: the transforms as records, whose sums follow. */
uint32_t smr_average_tasks(const void *match);
void smr_average_record(void *match, uint32_t task, uint32_t worker);

/* The averaged transform of a vertex, out of its sum of 12 words: Sum_i(T) / |zeta_i|. inverse: 1 / sums.scale. */
static inline smr_vec smr_average_transform(const uint32_t *w, const float inverse[2], float share, float r_minus_i[9])
{
    for (uint32_t i = 0; i < 9u; i++)
        r_minus_i[i] = smr_unfix(w[i], inverse[0]) * share;
    const smr_vec t = smr_v(smr_unfix(w[9], inverse[1]), smr_unfix(w[10], inverse[1]), smr_unfix(w[11], inverse[1]));
    return smr_scale(t, share);
}

#endif
