/* align.h: types and functions that find the start pose between two surfaces, each part built on those above.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_H
#define SMR_ALIGN_H

#include "base/job.h"
#include "geometry/rotation/similarity_fit.h"
#include "geometry/surface/surface.h"

/* ---- arithmetic of rigid, scaled and mirrored poses, and short lists of them ---- */

/* Sets the translation of *p so that the pose maps `from` onto `to`. */
static inline void smr_pose_through(smr_pose *p, smr_vec from, smr_vec to)
{
    const smr_vec shift = smr_sub(to, smr_pose_turn(p, from));
    p->m[0][3] = shift.x;
    p->m[1][3] = shift.y;
    p->m[2][3] = shift.z;
}

static inline float smr_pose_scale(const smr_pose *p) { return smr_length(smr_column(p, 0)); }

/* Returns the inverse of a rigid, scaled or mirrored pose (align_closest_points.c). */
smr_pose smr_pose_invert(const smr_pose *p);

/* Returns 1 when *p is a rotation with one scale for all axes and a translation, all within the limits. */
int smr_pose_legal(const smr_pose *p);

/* Returns 1 when the pose mirrors: its determinant is negative. */
static inline int smr_pose_mirrors(const smr_pose *p)
{
    const smr_vec a = smr_v(p->m[0][0], p->m[0][1], p->m[0][2]), b = smr_v(p->m[1][0], p->m[1][1], p->m[1][2]);
    return smr_dot(smr_cross(a, b), smr_v(p->m[2][0], p->m[2][1], p->m[2][2])) < 0.0f;
}

#define SMR_LIST_MOST 48u /* largest number of poses in a list */

/* A short list of poses, cheapest first. */
typedef struct smr_pose_list {
    smr_pose pose[SMR_LIST_MOST];
    float cost[SMR_LIST_MOST]; /* cost of each pose, 0..1.5 (smr_measure_cost) */
    uint32_t n, most;          /* number of poses in the list; largest number that it keeps, <= SMR_LIST_MOST */
} smr_pose_list;

static inline void smr_list_start(smr_pose_list *l, uint32_t most)
{
    l->n = 0;
    l->most = most;
}

/* Inserts a pose in order of cost, behind poses of equal cost. A full list loses its most expensive pose. */
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

/* Removes pose number `at` from the list. */
static inline void smr_list_remove(smr_pose_list *l, uint32_t at)
{
    l->n--;
    for (; at < l->n; at++) {
        l->cost[at] = l->cost[at + 1u];
        l->pose[at] = l->pose[at + 1u];
    }
}

/* ---- align_side.c: one of the two surfaces: samples, principal axes, and whether it is inside out ---- */

/* A sample's closest point on the other surface. */
typedef struct smr_pair {
    smr_vec at;        /* position of the closest point in the other surface's coordinates, mm */
    float d2;          /* squared distance, mm^2 of the target; at most smr_aligner.far2 */
    uint32_t triangle; /* triangle of the closest point, or SMR_DISC + a disc's number; SMR_NONE: none in range with an
                        * agreeing normal */
    uint32_t border;   /* 1: the closest point lies on an open border of its surface */
} smr_pair;

/* The region of a target that a part shares with others: within its reach of the joint, without what placed parts
 * explain. */
typedef struct smr_align_mask {
    const smr_align_part *part; /* [n_parts] all parts; those with an order are placed */
    uint32_t n_parts;
    smr_vec centre; /* place of the joint, mm from the target's origin */
    float reach2;   /* squared distance from the joint to the part's farthest point, mm^2 */
} smr_align_mask;

/* Returns 1 for a point of the target, mm from its origin, with its unit normal, in the region (align_parts.c). */
int smr_mask_holds(const smr_align_mask *mask, const smr_surface *target, smr_vec p, smr_vec normal);

/* One of the two surfaces and its samples. */
typedef struct smr_align_side {
    const smr_surface *surface;
    const smr_align_mask *mask; /* region that counts; NULL: the whole surface */
    uint32_t kept;              /* number of vertices that count */
    uint32_t n;                 /* number of samples of the surface */
    smr_vec *point;             /* [n] position of each sample relative to the surface's origin, mm */
    smr_vec *normal;            /* [n] outward unit normal of each sample */
    float *weight;              /* [n] area around each sample / mean area around a vertex */
    smr_pair *pair;             /* [n] closest point of each sample on the other surface */
    uint32_t bare;              /* 1: the surface is a cloud without normals */
    float outward;              /* factor that turns normals outwards: 1; -1: closed and inside out */
    smr_vec centre;             /* area-weighted centroid of the surface, mm */
    float axes[9];              /* principal axes in columns, the one of largest variance first */
    float spread;               /* standard deviation of the vertices' positions, mm */
} smr_align_side;

/* Returns the index of the k-th of n samples that are chosen evenly among a side's samples. */
static inline uint32_t smr_sample(const smr_align_side *side, uint32_t k, uint32_t n)
{
    return (uint32_t)(((uint64_t)2u * k + 1u) * side->n / (2u * (uint64_t)n));
}

/* Sums of the passes over a surface. */
typedef struct smr_side_work {
    smr_vec sum;           /* positions from the first one on, mm, by area */
    float weight, inverse; /* sum of areas, mm^2; 1 / that sum */
    float c[6];            /* covariance of positions, mm^2 */
    float skew[2];         /* third moments along two axes */
    float volume;          /* six times the volume, mm^3 */
    uint32_t at[2];        /* next sample; number of vertices outside fragments so far */
} smr_side_work;

/* Tasks, in order, that fill *side: samples of its surface, axes, centroid, spread. The caller has set surface and n,
 * and placed the arrays. */
uint32_t smr_align_side_tasks(const smr_align_side *side);
void smr_align_side_make(smr_align_side *side, smr_side_work *w, uint32_t task);

enum { SMR_MODEL, SMR_TARGET, SMR_SIDES };

/* The two surfaces that are aligned, their samples, and scratch, in the caller's memory. */
typedef struct smr_aligner {
    smr_align_side side[SMR_SIDES];
    uint32_t used; /* number of samples of each side that have pairs */
    float far2;    /* squared search range, mm^2; also stored for samples without a closest point */
    float limit;   /* distance beyond which a sample does not match, for costs of poses, mm */
} smr_aligner;

/* Returns the smaller one of both sides' spreads, mm. */
static inline float smr_aligner_spread(const smr_aligner *a)
{
    return smr_min(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread) + 1.0e-6f;
}

/* Returns the cost of a pose: the better side's cost plus half of the other side's. A part lies on the whole, but the
 * whole not on a part; and a pose that matches all of a part is better than one that matches a little more of both. */
static inline float smr_cost_of_sides(float a, float b) { return smr_min(a, b) + 0.5f * smr_max(a, b); }

#define SMR_AGREE 0.1f /* smallest cosine between the normals of a sample and its closest point */

/* ---- align_closest_points.c: pairs of closest points under a pose ---- */

/* Writes the closest points of a piece of a side's a->used samples on the other side, with the model moved by the pose.
 * pause: NULL, or limits the work of a piece of one sample. Returns 0 when the work ended; the same call continues. */
int smr_pairs_find(const smr_aligner *a, uint32_t side, const smr_pose *pose, smr_piece piece, smr_pause *pause);
/* ---- align_measures.c: measures of the pairs, in passes over the samples of both sides ---- */

#define SMR_MEASURE_RANKS 1u  /* bit of `of`: a quantile of each side's distances is found */
#define SMR_MEASURE_SUMS 2u   /* bit: then shares, cost and root mean square are summed */
#define SMR_MEASURE_CAPPED 4u /* bit: the outlier limit is at most smr_aligner.limit */

/* Measures of one pose's pairs. */
typedef struct smr_measure {
    uint32_t of;                           /* SMR_MEASURE_... */
    uint32_t rank[SMR_SIDES];              /* rank of the quantile among samples with the digits found so far */
    uint32_t found[SMR_SIDES];             /* digits of the quantile's squared distance, mm^2, as a float's bits */
    uint32_t count[SMR_SIDES][16];         /* number of samples with each next digit */
    float near[SMR_SIDES], all[SMR_SIDES]; /* weight of each side's samples nearer than the limit, and of all */
    float sum[SMR_SIDES];                  /* sum of squared distances up to smr_aligner.limit, mm^2 */
    float square, within;                  /* of both sides: sum up to the quantiles, mm^2, and its weight */
} smr_measure;

/* Returns the number of visits of samples that the measures need. */
uint32_t smr_measure_visits(const smr_aligner *a, uint32_t of);
/* share: of each side's samples, 0..1, at which the quantile lies; NULL: that of outlier limits. */
void smr_measure_start(const smr_aligner *a, uint32_t of, const float share[SMR_SIDES], smr_measure *m);
/* Makes a piece of the visits, in order. */
void smr_measure_run(const smr_aligner *a, smr_measure *m, smr_piece visits);
/* Returns the distance beyond which pairs are outliers, mm, from the quantile of the better-matching side. */
float smr_measure_limit(const smr_aligner *a, const smr_measure *m);
/* Returns the share of a side's samples, 0..1, weighted by area, that are nearer to the other side than the limit. */
float smr_measure_share(const smr_measure *m, uint32_t side);
/* Returns the cost of a pose from both sides' means of min(1, distance / a->limit)^2. 0: all match; 1.5: none does. */
float smr_measure_cost(const smr_aligner *a, const smr_measure *m);
/* Returns the root mean square distance of the samples up to each side's quantile, mm. */
float smr_measure_rms(const smr_measure *m);

/* ---- align_closest_points.c: refinement by pairs ---- */

#define SMR_REFINE_SCALED 1u  /* bit of `how`: the refinement fits scale, rotation and translation */
#define SMR_REFINE_TRIMMED 2u /* bit of `how`: outlier pairs get no weight */

enum { SMR_REFINE_GOES_ON = 0, SMR_REFINE_ENDED, SMR_REFINE_FAILED };

/* A pose in refinement, mirrored or not. */
typedef struct smr_refined {
    smr_pose pose;
    uint32_t round; /* number of rounds done */
    float last;     /* least sum of squared distances so far; FLT_MAX before the first round */
    uint32_t state; /* SMR_REFINE_... */
    float cost;     /* smr_measure_cost() of the refined pose */
    float limit;    /* distance beyond which pairs are outliers in this round, mm */
    float sum;      /* weighted sum of the squared distances collected in this round, mm^2 */
    smr_fit fit;    /* of the pairs collected in this round, from model to target */
    smr_measure measure;
} smr_refined;

/* A round: sets the outlier limit from the pairs, which belong to the pose; adds the pairs of both sides, the model's
 * first, piece by piece; fits the pose. how: SMR_REFINE_SCALED, SMR_REFINE_TRIMMED. The last function returns
 * SMR_REFINE_ENDED when the distances shrink no more, or SMR_REFINE_FAILED with too few pairs or when the scale leaves
 * 0.1 .. 10; the pose then stays. */
void smr_align_limit(const smr_aligner *a, uint32_t how, smr_refined *r);
void smr_align_collect(const smr_aligner *a, uint32_t side, smr_piece piece, smr_refined *r);
uint32_t smr_align_round(uint32_t how, smr_refined *r);

/* ---- align_coarse_search.c: the coarse search among samples of both surfaces ---- */

#define SMR_COARSE 96u        /* number of samples of each side; a multiple of SMR_TREE_WIDTH */
#define SMR_COARSE_BLOCKS 16u /* boxes around SMR_TREE_WIDTH samples each; a multiple of SMR_TREE_WIDTH */
#define SMR_SHIFTS 7u         /* number of translations tried with each rotation */
#define SMR_SHIFTS_LONG 3u    /* number of translations: by centroids, and by both ends of the longest axis */

/* The samples of both surfaces for the coarse search. */
typedef struct smr_coarse {
    float x[SMR_SIDES][6][SMR_COARSE];   /* x, y, z of positions, mm, then of unit normals; target: along an axis */
    float weight[SMR_SIDES][SMR_COARSE]; /* weight of each sample; a side's sum is 1 */
    uint32_t place[SMR_COARSE];          /* place in x[SMR_TARGET] of each sample of the target */
    smr_node block[SMR_COARSE_BLOCKS / SMR_TREE_WIDTH]; /* boxes around the target's samples along the axis */
    float faced; /* 1: normals are compared; 0: a side is a cloud without normals */
    float limit; /* distance beyond which samples do not match, mm */
} smr_coarse;

void smr_coarse_take(smr_coarse *c, const smr_aligner *a); /* fills *c with SMR_COARSE samples of each side */
void smr_coarse_sort(smr_coarse *c); /* sorts the target's samples along an axis, and sets their boxes */

#define SMR_CUBE 24u       /* number of rotations of a cube */
#define SMR_JOINT_STEPS 7u /* number of rotations about a joint along each axis of rotation vectors */
#define SMR_TURNS 8u       /* number of further rotations; each is combined with all rotations of the cube */

/* A coarse search at one scale, of the model or of its mirror image. */
typedef struct smr_coarse_search {
    float scale;
    uint32_t n_shifts; /* translations tried with each of SMR_CUBE * SMR_TURNS rotations */
    int mirrored;      /* 1: of the mirror image */
    int jointed;       /* 1: of SMR_JOINT_STEPS^3 rotations of the given pose about the joint */
    smr_pose given;
    smr_vec joint;      /* mm from the model's origin */
    smr_pose_list best; /* best two poses of the current rotation */
} smr_coarse_search;

#define SMR_COARSE_PARTS 6u /* tasks into which the comparison of a pose is divided; a divisor of SMR_COARSE */

/* A pose of the search whose cost is computed. */
typedef struct smr_coarse_place {
    smr_pose pose;
    float sum, cost;        /* sum over the model's samples so far, mm^2; cost once complete */
    float best[SMR_COARSE]; /* smallest cost of each target sample so far, mm^2 */
} smr_coarse_place;

/* Adds a part of the comparison of pose `number` of the search. The parts of a pose follow each other. */
void smr_align_try(const smr_aligner *a, const smr_coarse *c, const smr_coarse_search *search, uint32_t number,
                   uint32_t part, smr_coarse_place *to);
/* Takes the poses in order: inserts at most two poses of each rotation. */
void smr_align_tried(smr_coarse_search *search, uint32_t number, const smr_coarse_place *tried, smr_pose_list *found);

/* ---- align_discs.c: pairs with discs, which stand for a surface in first rounds ---- */

#define SMR_DISCS 256u       /* largest number of discs of a side; a multiple of the square of SMR_TREE_WIDTH */
#define SMR_DISC 0x80000000u /* smr_pair.triangle of disc 0; more than any triangle's number */
#define SMR_DISC_NODES (SMR_DISCS / (SMR_TREE_WIDTH * SMR_TREE_WIDTH))

/* Samples of a side, each with the part of the tangent plane around it. */
typedef struct smr_discs {
    float x[6][SMR_DISCS];          /* x, y, z of centres, mm from the surface's origin, then of outward unit normals */
    smr_node block[SMR_DISC_NODES]; /* boxes around SMR_TREE_WIDTH centres each */
    float radius;                   /* of a disc, mm */
} smr_discs;

/* Does what smr_pairs_find() does, with the other side's discs, d, instead of its surface. Neither side is a cloud. */
void smr_discs_find(const smr_aligner *a, const smr_discs *d, uint32_t side, const smr_pose *pose, smr_piece piece);

/* ---- align_steps.c: the call as steps, each of which requests a search, a refinement or pairs ---- */

#define SMR_ALIGN_PLACES 32u   /* poses of the coarse search that are compared together */
#define SMR_ALIGN_GROUP 10u    /* largest number of poses that are refined together */
#define SMR_ALIGN_COLLECT 128u /* pairs in a task that adds them to a fit */
#define SMR_ALIGN_VISITS 2048u /* visits of samples in a task that measures pairs */
#define SMR_ALIGN_SLICES 4u    /* fewest searches of closest points that are in work together, in pieces */
#define SMR_ALIGN_WORK 75000u  /* work of a search in a piece, instructions at most */
#define SMR_ALIGN_PIECE 4u     /* samples in a task that searches closest points */

/* A search of a closest point, which may take several pieces. */
typedef struct smr_align_slice {
    smr_pause pause;
    uint32_t done; /* 1: the search is complete */
} smr_align_slice;
/* The joint between a part and the placed part that it touches most, its neighbour. */
typedef struct smr_joint {
    smr_vec sum;  /* positions weighted by nearness to the placed part in work, mm from the part's origin */
    float weight; /* sum of weights, mm^2 */
    smr_vec at;   /* the joint so far, mm from the part's origin */
    float touch;  /* weight of the neighbour so far */
    const smr_align_part *neighbour; /* NULL: no part is placed */
    smr_box box;                     /* around the part, mm from its origin */
} smr_joint;

/* Working state of smr_align(), in the caller's memory. Poses are relative to the surfaces' origins. */
typedef struct smr_align_work {
    smr_aligner aligner;
    smr_side_work sum[SMR_SIDES];
    smr_coarse coarse;
    smr_discs discs[SMR_SIDES];
    smr_pose_list found, nearer, shorter; /* lists of poses that a stage reads and writes */
    smr_pose_list best;                   /* poses after the longer refinement, cheapest first */
    smr_pose_list one;                    /* the one pose in work */
    uint32_t few, some, all;              /* samples of each side in short, longer, last refinements */

    /* the coarse search */
    smr_coarse_search search;
    uint32_t n_tried;        /* number of poses to try; 0: no search */
    smr_coarse_place *place; /* [SMR_ALIGN_PLACES] poses in work */

    /* the refinement of a list, a group of poses at a time */
    const smr_pose_list *from;
    smr_pose_list *into;  /* refined poses go here, without failed ones, one of similar ones; NULL: to w->one */
    uint32_t first, n;    /* first pose of the group; number of its poses */
    uint32_t rounds;      /* most rounds; 0: only pairs are found */
    uint32_t disc_rounds; /* number of first rounds that pair with discs; SMR_NONE: all rounds, and costs, too */
    uint32_t how;         /* SMR_REFINE_... */
    uint32_t last;        /* 1: pairs are found for the last time, to be measured */
    uint32_t of;          /* SMR_MEASURE_... of the one pose of a list without `into` */
    const float *parts;   /* [SMR_SIDES] share of each side's samples up to which these measures go; NULL: as usual */
    smr_refined group[SMR_ALIGN_GROUP];
    smr_align_slice *slice;       /* [n_slices] searches in work */
    uint32_t n_slices, next_pair; /* number of searches in work; first one of them among all pairs of the group */
    uint32_t at_once;             /* 1: the call has no pieces, and a task does SMR_ALIGN_PIECE searches */

    /* the steps of the call */
    uint32_t at;    /* the next step */
    uint32_t other; /* pose of `best` that is compared with the result */
    smr_pose given, result;
    float cost;  /* of the best pose before its last refinement */
    float least; /* share of matching samples at that pose, of the side that matches less */
    float share[SMR_SIDES];
    int whole; /* 1: both surfaces are wholes and all pairs count */
    uint32_t scaled, iterations;
    smr_align_report said;

    /* the parts */
    smr_align_part *part; /* [n_parts] the caller's */
    uint32_t n_parts, n_placed;
    const smr_surface *whole_of[SMR_SIDES]; /* surfaces of the whole */
    smr_align_part *current;                /* the part in work; NULL: the whole */
    smr_joint *joint;                       /* [n_parts] joints with placed parts */
    const smr_joint *jointed;               /* of the part in work; NULL: none */
    smr_align_mask mask;                    /* of its target, if shared */
    smr_pose start;                         /* the whole's */

    smr_pose as_given;
    smr_pose *pose; /* the caller's */
    smr_align_report *report;
} smr_align_work;

#define SMR_ALIGN_END 2     /* result of smr_align_step() after the last step */
#define SMR_ALIGN_MEASURE 3 /* result of a step that requests other measures of the same pairs */

/* ---- align_parts.c ---- */

uint32_t smr_joint_tasks(const smr_align_work *w); /* tasks, in order, that find joints with the part placed last */
void smr_joint_find(smr_align_work *w, uint32_t task);

/* Chooses the next part and sets its start. Returns 1; 0: it has no target, and is placed; -1: all are placed. */
int smr_align_begin_part(smr_align_work *w);
/* Adds the changes of all surfaces to *changes. Returns 0 when one is no surface. */
int smr_align_changes(const smr_align_work *w, uint32_t *changes);
void smr_align_end_part(smr_align_work *w, int found); /* found 0: the part takes its neighbour's pose */

/* ---- align_discs.c: making discs ---- */

#define SMR_DISC_PIECE 32u                           /* discs in a task that finds places on a Hilbert curve */
#define SMR_DISC_PLACES (SMR_DISCS / SMR_DISC_PIECE) /* number of these tasks; then discs are sorted, then made */
#define SMR_DISC_TASKS (SMR_DISC_PLACES + 2u)        /* tasks, in order, of a side; those of the model are first */
/* Makes discs of both sides from their samples. w->place holds the order of discs between tasks. */
void smr_discs_make(smr_align_work *w, uint32_t task);

/* ---- align_steps.c ---- */

/* Returns the squared distance, mm^2, beyond which a pair of a pose in refinement counts as much as none: for its cost,
 * or for its weight, as the next round's limit of outliers is hardly larger. */
float smr_align_range2(const smr_align_work *w, const smr_refined *r);

/* Runs the next step. Returns 1 when the step requests work, 0 when it does not, -1 when no pose was found. */
int smr_align_step(smr_align_work *w);
/* Inserts a pose into a list, unless the list has a similar one. A similar pose that costs clearly more is replaced. */
void smr_align_insert(const smr_aligner *a, const smr_pose *pose, float cost, smr_pose_list *into);

#endif
