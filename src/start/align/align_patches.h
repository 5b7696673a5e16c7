/* align_patches.h: patches of a model, each with a rigid motion, that follow a target together.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_PATCHES_H
#define SMR_ALIGN_PATCHES_H

#include "geometry/surface/surface_cells.h"
#include "start/align/align.h"

#define SMR_BENT_LINKS 10u    /* largest number of neighbours of a patch */
#define SMR_BENT_MEMBERS 64u  /* largest number of members of a patch */
#define SMR_BENT_BODIES 16u   /* largest number of rigid bodies */
#define SMR_BENT_TOGETHER 25u /* number of rounds in which bodies follow the target; in the last they do not move */
#define SMR_BENT_SLICES 32u   /* largest number of searches in work */

/* A patch: the rigid motion of a cell of the model. Places are mm from the target's origin. */
typedef struct smr_patch {
    smr_vec rest, normal;              /* middle and unit normal of the cell in the start pose */
    smr_pose motion;                   /* from the start pose */
    smr_vec at;                        /* present place of the middle, by the motions of all members */
    smr_vec goal;                      /* closest point of the target */
    float weight;                      /* weight of the goal, 0..1; 0: none */
    float d2;                          /* squared distance to the closest point, mm^2; FLT_MAX: none */
    uint32_t triangle;                 /* the target's triangle with the closest point; SMR_NONE: none */
    float other_mm;                    /* lower bound of the distance to all other triangles ... */
    smr_vec searched;                  /* ... from the place of the last search */
    float moved;                       /* mm from the place of the search before */
    uint32_t rests;                    /* 1: the motion is that of the round before */
    uint32_t on;                       /* the target's cell with the closest point; SMR_NONE: none */
    uint32_t joined;                   /* step in which the patch joined; 0: not yet */
    uint32_t body;                     /* the rigid body to which it belongs; SMR_NONE: none */
    uint32_t found;                    /* 1: the goal of the round before had a weight */
    uint32_t n_links;                  /* number of neighbours */
    uint32_t link[SMR_BENT_LINKS];     /* [n_links] patches whose cells share an edge with this one */
    uint32_t n_near, n;                /* number of near members: up to neighbours' neighbours; of all members */
    uint32_t member[SMR_BENT_MEMBERS]; /* [n] the patch itself, its neighbours, theirs and so on */
} smr_patch;

#define SMR_BODY_UNKNOWNS 6u /* a turn and a shift */

/* Patches that move as a rigid body, and the sums of the least squares by which it follows the target. */
typedef struct smr_body {
    smr_pose motion;      /* from the start pose */
    smr_vec centre;       /* about which it turns, mm from the target's origin */
    float hold;           /* weight of the place that a patch has, relative to its goal's */
    float cost, all;      /* sum of squared distances across the surface by weight, mm^2; sum of weights */
    smr_pose kept_motion; /* those with the least mean cost, ... */
    smr_vec kept_centre;
    float least; /* ... and that, mm^2 */
    float matrix[SMR_BODY_UNKNOWNS][SMR_BODY_UNKNOWNS];
    float right[SMR_BODY_UNKNOWNS][3]; /* the first column is used */
} smr_body;

/* State of a call, in the caller's memory. */
typedef struct smr_bent {
    smr_cells side[SMR_SIDES];
    smr_patch *patch;       /* [SMR_CELLS_MOST] */
    smr_body *body;         /* [SMR_BENT_BODIES] */
    uint32_t n_bodies;      /* number of bodies */
    uint32_t body_round;    /* number of rounds in which they have followed the target */
    smr_align_slice *slice; /* [SMR_BENT_SLICES] searches of closest points in work */
    uint32_t next;          /* patch of the first of them */
    uint32_t *owner;        /* [SMR_CELLS_MOST] the patch that is nearest on each cell of the target; SMR_NONE: none */
    float *d2[SMR_SIDES];   /* [SMR_CELLS_MOST] squared distance of each cell from the other surface, mm^2; when bodies
                               begin, the area that agrees with a patch's motion, half in each, mm^2 */
    smr_pose start;         /* start pose between coordinates relative to the surfaces' origins */
    float radius;           /* of cells, mm of the target */
    uint32_t seed;          /* the patch whose near members join first, as a rigid part */
    float agree2;           /* squared distance at which members of a part agree by a half, mm^2; 0: patches join */
    float limit2;           /* squared distance at which a place costs 1, mm^2 */
    float before, least;    /* cost of the start pose; on the side that it explains better */
    float area, found_area; /* area of a step's patches; of those that joined before and have a goal, mm^2 */
    float found_cost;       /* sum of the latter's costs by area, mm^2 */
    uint32_t step;          /* 0: the start pose is measured */
    uint32_t round;         /* rounds done in this step */
    float *xyz;             /* the caller's */
    uint32_t *bent;         /* the caller's */
} smr_bent;

/* Adds the areas of some vertices to their cells; links patches whose cells share an edge of some triangles. */
void smr_patches_areas(const smr_cells *c, uint32_t first, uint32_t last);
void smr_patches_link(const smr_bent *w, uint32_t first, uint32_t last);

/* Puts a patch into the start pose and lists its members. */
void smr_patch_set(const smr_bent *w, uint32_t i);
/* Returns the place of a point of a patch by the motions of all members that have joined; rest: in the start pose, and
 * the result without any. */
smr_vec smr_patch_place(const smr_bent *w, const smr_patch *p, smr_vec rest);
/* Finds a patch's present place, and its closest point with a weight. Returns 0 when the work ended. */
int smr_patch_find(const smr_bent *w, smr_patch *p, smr_pause *pause);
/* Gives each cell of the target to the patch whose closest point there is nearest. */
void smr_patches_own(const smr_bent *w);
/* Adds neighbours of members to the members, as far as there is room. */
void smr_patch_extend(const smr_bent *w, smr_patch *p);
/* Fits the motion to goals and present places of members. Members that have not joined keep the patch in place. The
 * seed stays while patches join; then members that move otherwise lose their weight, so that parts become rigid. */
void smr_patch_fit(const smr_bent *w, smr_patch *p);
/* Adds some patches to the sums of a step. */
void smr_patches_compare(smr_bent *w, uint32_t first, uint32_t last);
/* Returns the squared distance of a point from the tangent plane of the nearest patch that faces as `normal`, mm^2. */
float smr_patches_distance2(const smr_bent *w, smr_vec at, smr_vec normal);

/* ---- align_articulated.c: the job ---- */

typedef struct smr_bent_job {
    smr_job_head head;
    smr_bent *w;
    uint32_t changes; /* sum of the surfaces' smr_surface.changes at the begin */
} smr_bent_job;

/* Stages that others go back or on to. */
enum {
    SMR_BENT_DIVIDE = 2,
    SMR_BENT_FIND = 5,
    SMR_BENT_GATHER = 12,
    SMR_BENT_SHARE = 15,
    SMR_BENT_SUM = 16,
    SMR_BENT_MEASURE = 20,
    SMR_BENT_MOVE = 25,
    SMR_BENT_END
};

/* ---- align_bodies.c: stages ---- */

/* Bodies are begun: each patch that has found the target and belongs to no body gathers the area of such patches that
 * agrees with its motion; a body begins with the motion that gathered most; such patches join it, piece by piece; and
 * again, until little is gathered. Then all patches get a body, piece by piece, and its motion. */
smr_run_task smr_bodies_gather, smr_bodies_begin, smr_bodies_take, smr_bodies_share;
/* A round, after closest points are found: least squares are summed, piece by piece in order; each body solves its own
 * and moves; patches go over to a neighbour's body that takes them nearer to their goals, in order. */
smr_run_task smr_bodies_sum, smr_bodies_move, smr_bodies_follow, smr_bodies_end_round;
smr_count_tasks smr_bodies_count, smr_bodies_halves, smr_bodies_pieces;

/* ---- align_patches.c: costs ---- */

void smr_patches_set_limit(smr_bent *w); /* sets limit2 from the spread of the model in the start pose */
float smr_patches_cost(const smr_bent *w, uint32_t side, uint32_t i); /* returns the cost of a cell, 0..1 */
float smr_patches_mean_cost(const smr_bent *w, uint32_t side);        /* returns the mean cost of a side */

#endif
