/* align.h: the stages of the start pose between two surfaces, in the order in which they run on each other.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_H
#define SMR_ALIGN_H

#include "geometry/rotation/similarity_fit.h"
#include "geometry/surface/surface.h"

/* ---- arithmetic of rigid, scaled and mirrored poses, and short lists of them ---- */

/* Sets the pose's translation so that it maps `from` onto `to`. */
static inline void smr_pose_through(smr_pose *p, smr_vec from, smr_vec to)
{
    const smr_vec shift = smr_sub(to, smr_pose_turn(p, from));
    p->m[0][3] = shift.x;
    p->m[1][3] = shift.y;
    p->m[2][3] = shift.z;
}

static inline float smr_pose_scale(const smr_pose *p) { return smr_length(smr_column(p, 0)); }

/* align_closest_points.c: the inverse of a rigid, scaled or mirrored pose. */
smr_pose smr_pose_invert(const smr_pose *p);

/* Returns 1 when the pose contains a reflection. */
static inline int smr_pose_mirrors(const smr_pose *p)
{
    const smr_vec a = smr_v(p->m[0][0], p->m[0][1], p->m[0][2]), b = smr_v(p->m[1][0], p->m[1][1], p->m[1][2]);
    return smr_dot(smr_cross(a, b), smr_v(p->m[2][0], p->m[2][1], p->m[2][2])) < 0.0f;
}

#define SMR_LIST_MOST 24u /* largest number of poses in a list */

/* A short list of poses, cheapest first. */
typedef struct smr_pose_list {
    smr_pose pose[SMR_LIST_MOST];
    float cost[SMR_LIST_MOST]; /* 0..1.5: smr_pairs_cost() */
    uint32_t n, most;          /* number of poses; largest number that is kept, at most SMR_LIST_MOST */
} smr_pose_list;

static inline void smr_list_start(smr_pose_list *l, uint32_t most)
{
    l->n = 0;
    l->most = most;
}

/* Inserts a pose in order of cost, behind those of the same cost. A full list loses its last pose. */
static inline void smr_list_insert(smr_pose_list *l, const smr_pose *pose, float cost)
{
    uint32_t at = l->n < l->most ? l->n++ : l->most;
    for (; at > 0u && l->cost[at - 1u] > cost; at--)
        if (at < l->most) {
            l->cost[at] = l->cost[at - 1u];
            l->pose[at] = l->pose[at - 1u];
        }
    if (at < l->most) {
        l->cost[at] = cost;
        l->pose[at] = *pose;
    }
}

/* Removes pose `at`. */
static inline void smr_list_remove(smr_pose_list *l, uint32_t at)
{
    l->n--;
    for (; at < l->n; at++) {
        l->cost[at] = l->cost[at + 1u];
        l->pose[at] = l->pose[at + 1u];
    }
}

/* ---- align_side.c: one of the two surfaces: samples, principal axes, and whether it is inside out ---- */

/* The closest point of the other surface to a sample. */
typedef struct smr_pair {
    smr_vec at;        /* position in the other surface's coordinates, mm */
    float d2;          /* squared distance in the target's coordinates, mm^2; at most the search limit */
    uint32_t triangle; /* triangle of the other surface; SMR_NONE without an agreeing one within the limit */
    uint32_t border;   /* 1: the closest point lies on an open border */
} smr_pair;

/* A surface and its samples. */
typedef struct smr_align_side {
    const smr_surface *surface;
    uint32_t n;      /* number of samples */
    smr_vec *point;  /* [n] positions relative to the surface's origin, mm */
    smr_vec *normal; /* [n] unit normals, outward */
    float *weight;   /* [n] area around each sample divided by the mean area of a vertex */
    smr_pair *pair;  /* [n] closest point of each sample */
    uint32_t bare;   /* 1: the surface is a cloud without normals */
    float outward;   /* sign of the normals: 1; -1 for a closed surface that is inside out */
    smr_vec centre;  /* area-weighted centroid, mm */
    float axes[9];   /* principal axes (columns), that of largest variance first */
    float spread;    /* standard deviation of the positions, mm */
} smr_align_side;

/* The index of the k-th of n samples that are chosen evenly among a side's samples. */
static inline uint32_t smr_sample(const smr_align_side *side, uint32_t k, uint32_t n)
{
    return (uint32_t)(((uint64_t)2u * k + 1u) * side->n / (2u * (uint64_t)n));
}

/* Describes a surface and takes n samples. The caller has placed the arrays. */
void smr_align_side_make(smr_align_side *side, const smr_surface *surface, uint32_t n);

enum { SMR_MODEL, SMR_TARGET, SMR_SIDES };

/* Two surfaces being aligned, in the caller's memory. */
typedef struct smr_aligner {
    smr_align_side side[SMR_SIDES];
    uint32_t *order; /* [samples] scratch: bits of the squared distances whose quantile is sought */
    uint32_t used;   /* pairs of each side that the last smr_pairs_find() wrote */
    float far2;      /* squared search limit, mm^2; the squared distance of samples without a pair, too */
    float limit;     /* distance beyond which samples do not match when poses are compared, mm */
} smr_aligner;

/* The smaller spread of both sides, mm. */
static inline float smr_aligner_spread(const smr_aligner *a)
{
    return smr_min(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread) + 1.0e-6f;
}

/* Combines the costs of both sides: that of the better side plus half of the other. A part lies on the whole, but the
 * whole not on a part; and a pose that matches all of a part is better than one that matches a little more of both. */
static inline float smr_cost_of_sides(float a, float b) { return smr_min(a, b) + 0.5f * smr_max(a, b); }

/* ---- align_closest_points.c: pairs of closest points under a pose, their measures, and refinement by them ---- */

/* Finds the closest points of `samples` samples of each side under a pose. */
void smr_pairs_find(smr_aligner *a, const smr_pose *pose, uint32_t samples);
/* Returns the distance beyond which pairs are outliers, mm: from the distances of the side that matches better. */
float smr_pairs_limit(const smr_aligner *a);
/* Returns the share of a side's samples, 0..1, that are nearer than `limit` mm. */
float smr_pairs_share(const smr_aligner *a, uint32_t side, float limit);
/* Returns the cost of the pairs from means of (distance / a->limit)^2, at most 1 each; 0: all match, 1.5: none does. */
float smr_pairs_cost(const smr_aligner *a);
/* Returns the root mean square distance of each side's samples, mm, counting a side's nearest share, 0..1. */
float smr_pairs_rms(const smr_aligner *a, const float share[SMR_SIDES]);

#define SMR_REFINE_SCALED 1u  /* bit of a refinement: it fits a scale, too */
#define SMR_REFINE_TRIMMED 2u /* bit of a refinement: outlier pairs lose their weight */

/* Refines *pose, mirrored or not, in at most `rounds` rounds over `samples` samples of each side. how: SMR_REFINE_...
 * Returns 0 with too few pairs or when the scale collapses; *pose then is that of the last round. */
int smr_align_refine(smr_aligner *a, uint32_t samples, uint32_t rounds, uint32_t how, smr_pose *pose);

/* ---- align_coarse_search.c: the coarse search among samples of both surfaces ---- */

#define SMR_COARSE 96u     /* samples of each side; a multiple of SMR_COARSE_LANES in align_coarse_search.c */
#define SMR_SHIFTS 7u      /* translations for each rotation */
#define SMR_SHIFTS_LONG 3u /* translations by the centroid and by the ends of the target's longest axis */

/* Samples of both surfaces as plain arrays. */
typedef struct smr_coarse {
    float x[SMR_SIDES][6][SMR_COARSE];   /* positions, mm, and unit normals: three rows each */
    float weight[SMR_SIDES][SMR_COARSE]; /* weights, whose sum is 1 */
    float faced;                         /* factor on differences of normals: 1; 0: a cloud has no normals */
    float limit;                         /* mm: samples farther apart do not match */
} smr_coarse;

void smr_coarse_take(smr_coarse *c, const smr_aligner *a); /* copies samples of both sides */

/* Adds to `found` the best poses of this scale, at most two of a rotation, with the first n_shifts translations, of the
 * model or, with `mirrored` 1, of the model's mirror image. */
void smr_align_search(const smr_aligner *a, const smr_coarse *c, float scale, uint32_t n_shifts, int mirrored,
                      smr_pose_list *found);

#endif
