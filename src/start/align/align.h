/* align.h: the stages of the start pose between two surfaces, in the order in which they run on each other.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_H
#define SMR_ALIGN_H

#include "start/align/align_pose.h"
#include "start/align/align_side.h"

enum { SMR_MODEL, SMR_TARGET, SMR_SIDES };

/* Two surfaces being aligned, in the caller's memory. */
typedef struct smr_aligner {
    smr_align_side side[SMR_SIDES];
    uint32_t *order; /* [samples] bits of the squared distances */
    uint32_t used;   /* samples of each side in the last smr_pairs_find(): the first pairs */
    float far2;      /* squared search limit, mm^2; also the squared distance of samples without a pair */
    float limit;     /* distance beyond which samples do not match when poses are compared, mm */
} smr_aligner;

/* The smaller spread of both sides, mm. */
static inline float smr_aligner_spread(const smr_aligner *a)
{
    return smr_min(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread) + 1.0e-6f;
}

/* The cost of a pose from those of its sides: that of the better side plus half of the other. A part lies on the
 * whole, but not the whole on a part; and a pose that matches all of a part is better than one that matches a little
 * more of both. */
static inline float smr_cost_of_sides(float a, float b) { return smr_min(a, b) + 0.5f * smr_max(a, b); }

/* ---- align_pairs.c: closest points in both directions under a pose, and measures of the last pairs found ---- */

/* Finds the closest points of `samples` samples of each side. */
void smr_pairs_find(smr_aligner *a, const smr_pose *pose, uint32_t samples);

/* Distance beyond which pairs are outliers, mm: from the distances of the side that matches better. */
float smr_pairs_limit(const smr_aligner *a);

/* Share of a side's samples, 0..1, that are nearer than `limit` mm. */
float smr_pairs_share(const smr_aligner *a, uint32_t side, float limit);

/* Cost of the pairs: squared distances over a->limit, at most 1 each; 0 when all samples match, 1.5 when none does. */
float smr_pairs_cost(const smr_aligner *a);

/* Root mean square distance of the nearest share[] of each side's samples, mm. */
float smr_pairs_rms(const smr_aligner *a, const float share[SMR_SIDES]);

/* ---- align_coarse.c: samples of both surfaces as plain arrays, and the cost of a pose between them ---- */

#define SMR_COARSE 96u /* samples of each side; a multiple of SMR_COARSE_LANES */
#define SMR_COARSE_LANES 8u

typedef struct smr_coarse {
    float x[SMR_SIDES][6][SMR_COARSE];   /* positions, mm, and unit normals: three rows each */
    float weight[SMR_SIDES][SMR_COARSE]; /* weights, whose sum is 1 */
    float faced;                         /* 1; 0: the target is a cloud without normals */
    float limit;                         /* mm: samples farther apart do not match */
} smr_coarse;

void smr_coarse_take(smr_coarse *c, const smr_aligner *a);

/* The cost of a pose, as smr_pairs_cost(). */
float smr_coarse_cost(const smr_coarse *c, const smr_pose *pose);

/* Sample i of a side; the model's is rotated by the pose, but not translated. */
smr_vec smr_coarse_point(const smr_coarse *c, uint32_t side, uint32_t i, const smr_pose *pose);

/* ---- align_search.c: the coarse search ---- */

#define SMR_SHIFTS 7u      /* translations for each rotation */
#define SMR_SHIFTS_LONG 3u /* translations by the centroid and by the ends of the target's longest axis */

/* Searches the poses of this scale with the first n_shifts translations, of the model or, mirrored not 0, of its
 * mirror image. The list keeps the best poses, at most two with the same rotation. */
void smr_align_search(const smr_aligner *a, const smr_coarse *c, float scale, uint32_t n_shifts, int mirrored,
                      smr_pose_list *found);

/* ---- align_refine.c: iterative closest point in both directions ---- */

/* Bits that select how a refinement fits. */
#define SMR_REFINE_SCALED 1u  /* with a common scale */
#define SMR_REFINE_TRIMMED 2u /* outlier pairs lose their weight */

/* Refines *pose, mirrored or not, in at most `rounds` rounds over `samples` samples of each side. Returns 0 with too
 * few pairs or when the scale collapses; *pose then is the last one. */
int smr_align_refine(smr_aligner *a, uint32_t samples, uint32_t rounds, uint32_t how, smr_pose *pose);

/* ---- align_find.c: reduces all poses to a few good ones ---- */

/* State of smr_align() in the caller's memory. */
typedef struct smr_align_work {
    smr_aligner aligner;
    smr_coarse coarse;
    smr_pose_list found, shorter; /* poses of the current stage */
    smr_pose_list best;           /* result of smr_align_find() */
    uint32_t few, some, all;      /* number of samples in short, in longer and in the last refinements */
} smr_align_work;

/* Returns 1 when two poses differ by more than cosine `cosine` of rotation, or by more than `shift` of the target's
 * spread. */
int smr_pose_differs(const smr_aligner *a, const smr_pose *p, const smr_pose *q, float cosine, float shift);

/* Fills w->best, always with a scale: bones of two sizes are distinguished better so. `given` is one of the tried
 * poses. */
void smr_align_find(smr_align_work *w, const smr_pose *given);

/* The best pose of the model's mirror image near this scale. Needs w->coarse from smr_align_find(). */
smr_pose smr_align_find_mirrored(smr_align_work *w, float scale, int scaled);

#endif
