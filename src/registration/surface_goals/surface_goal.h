/* surface_goal.h: goals on target surfaces (paper 2.1; 3, geometric registration): the closest point of the target,
 * blended with the target's own pull. In: positions, normals, target surfaces. Out: the way to each vertex' goal.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_GOAL_H
#define SMR_SURFACE_GOAL_H

#include "geometry/surface/surface.h"
#include "registration/shape/shape.h"

#define SMR_FORCE_CHUNK 4u        /* vertices of a task that seeks goals on a surface, or the model from a target */
#define SMR_SEEN_ONE 255u         /* seen in full */
#define SMR_PULL_SCALE 1048576.0f /* 2^20: pulls are summed in units of 2^-20 mm times weight */
#define SMR_PULL_FULL 0.25f       /* mean areas of target that count in full */

/* The surface of one structure. Written by setup/targets.c; begun by tick/schedule.c, measured by forces.c, too. */
typedef struct smr_target {
    const smr_surface *surface;   /* NULL: none */
    uint32_t partial;             /* 1: vertices count as far as they are seen; 0: all in full. Written by overlap.c */
    uint32_t n_seen, n_judged;    /* vertices seen, and all that were judged, when they last were */
    uint32_t begun;               /* 1: it had one when the iteration under way began */
    uint32_t measured;            /* 1: there were complete forces since it was set or taken away */
    uint32_t n_vertices, changes; /* of the surface when it was set */
    float spread;                 /* of a cloud: mean weight that reached a vertex. Written by point_spread.c */
    smr_vec view;                 /* of a cloud: mean normal of what it shows; 0: none. Written by overlap.c */
} smr_target;

/* A distinct target surface; structures may share it. Written by setup/targets.c. */
typedef struct smr_goal {
    const smr_surface *surface;
    uint32_t first_task; /* of the target-to-model search */
    uint32_t n_vertices; /* when it was set */
    uint32_t first_warm; /* its vertices' slots in target_warm */
} smr_goal;

/* The points of a structure's cloud when it was set. */
typedef struct smr_points_then {
    uint64_t sum; /* smr_points_checksum() of their places; 0: it was no cloud */
    uint32_t n;
} smr_points_then;

typedef struct smr_surface_goals {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    smr_target *target;    /* [n_structures] */
    smr_goal *goal;        /* [n_structures], the first n_goals are in use */
    smr_points_then *then; /* [n_structures]; NULL where no target attracts. Written by setup/targets.c */
    uint32_t n_goals;
    uint32_t n_goals_begun; /* n_goals when the iteration under way began: a later one does not count in it */
    uint32_t n_tasks;       /* of the target-to-model search */
    uint32_t n_clouds;      /* goals that are clouds */
    uint32_t n_points;      /* points of all clouds */
    uint32_t n_clouds_begun, n_points_begun; /* when the iteration under way began */
    const float *spread; /* [n][4] of structures with a cloud: sum of its points' pulls, mm, and their weight */
    /* written by the search for goals */
    uint32_t *warm;        /* [n] closest triangle of the target, of the last complete forces; SMR_NONE: none */
    uint32_t *warm_next;   /* [n] the same, of those under way: they may have to start again */
    uint32_t *target_warm; /* [n_target_vertices] closest triangle of the model; NULL: no attraction */
    int64_t *pull;         /* [n_workers][n][4] target-to-model pulls: three sums and the weight; NULL: no attraction */
    uint8_t *seen;         /* [n] 0 .. SMR_SEEN_ONE, of the last complete forces that judged it; NULL: nobody does */
    uint8_t *seen_next;    /* [n] the same, of those under way */
    uint32_t partial;      /* 1: some structure is seen in part */
    float limit;           /* mm: longer ways are dropped; 0: none are. Written by forces.c; 0 after new inputs */
} smr_surface_goals;

void smr_surface_goals_layout(smr_arena *a, smr_surface_goals *g, const smr_shared *shared);
void smr_surface_goals_wire(smr_surface_goals *g, const smr_shared *shared, const smr_pace *pace,
                            const smr_shape *shape);
void smr_surface_goals_reset(smr_surface_goals *g); /* nothing of the searches so far is left */
void smr_surface_goals_stand(smr_surface_goals *g); /* the forces under way are complete */
void smr_pulls_clear(smr_surface_goals *g);
int smr_targets_stand(const smr_surface_goals *g); /* 1: every target surface is still the one that was set */

/* What a vertex found on its target. */
typedef struct smr_surface_find {
    smr_hit hit; /* the closest point with an agreeing normal; triangle SMR_NONE: none counts */
    smr_vec way; /* mm: from the vertex there */
} smr_surface_find;

/* The way from vertex v to its goal on the target mesh, mm. Returns 0 for none. */
int smr_surface_goal(smr_surface_goals *g, uint32_t v, const smr_surface *target, smr_vec *way, smr_surface_find *find);

/* Before the search: the same with the triangle that was the closest in the last complete forces, whatever runs along
 * the surface; 0 for a vertex that had none and is not pulled. Looks at the pulls and leaves them. */
smr_vec smr_surface_goal_again(const smr_surface_goals *g, uint32_t v);

/* A way without what runs along the model's surface, except the share that may count. */
smr_vec smr_off_surface(const smr_surface_goals *g, uint32_t v, smr_vec way);

/* 1: p, mm in the caller's coordinates, lies where no goal counts. */
static inline int smr_outside_box(const smr_config *c, smr_vec p)
{
    return c->forces.use_box &&
           (p.x < c->forces.box_min[0] || p.y < c->forces.box_min[1] || p.z < c->forces.box_min[2] ||
            p.x > c->forces.box_max[0] || p.y > c->forces.box_max[1] || p.z > c->forces.box_max[2]);
}

/* target_attraction.c: target-to-model attraction, when target vertices pull in this iteration. */
int smr_attraction_on(const smr_surface_goals *g);
int smr_attracts(const smr_surface_goals *g, const smr_surface *target); /* this one does; a cloud always */
uint32_t smr_attract_tasks(const void *goals);
void smr_attract_search(void *goals, uint32_t task, uint32_t worker);

/* Sum and weight of the pulls on a stored vertex, in units of 1 / SMR_PULL_SCALE. Then the same, and clears them. */
void smr_pull_look(const smr_surface_goals *g, uint32_t v, int64_t sum[4]);
void smr_pull_sum(smr_surface_goals *g, uint32_t v, int64_t sum[4]);

/* The mean of that, mm, and how much it counts, 0..1. */
float smr_pull_mean(const int64_t sum[4], smr_vec *mean);

/* The mean pull on a stored vertex, mm; clears it for the next iteration. Returns how much it counts, 0..1: less when
 * little of the target pulls there, so that no target vertex makes a difference by barely reaching a triangle. */
float smr_pull_take(smr_surface_goals *g, uint32_t v, smr_vec *mean);

#endif
