/* shape.h: the deforming model: positions, normals, reference shape, and its triangles as they move.
 * In: the model. Out: positions that all stages read. x and x_next change places when an iteration stands.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SHAPE_H
#define SMR_SHAPE_H

#include "geometry/box_tree/box_tree.h"
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/rotation/transform_fit.h"
#include "registration/shape/state.h"

struct smr_dynamics;

/* One structure of the model. */
typedef struct smr_shape_structure {
    uint32_t first_vertex, n_vertices; /* in the caller's numbering */
    uint32_t first_triangle;
    uint32_t first_leaf; /* of its tree, counted over all structures */
    smr_facets facets;   /* triangles, normals and box tree, as they move */
} smr_shape_structure;

/* What tracking is elastic about, besides arrays. */
typedef struct smr_held {
    smr_box box;                /* around held_x, mm */
    smr_pose rest_pose;         /* of the rest shape when the last radius began: near held_x */
    smr_pose whole;             /* of held_x onto x, all structures together */
    smr_fit one, all;           /* sums so far: of a structure, of the whole model */
    uint32_t structure, vertex; /* where these sums stand, in the caller's numbering */
    uint32_t n_tasks;           /* that the sums take */
    uint32_t due;               /* 1: x^r is to follow in this iteration. Written by tracking.c and time_steps.c */
    uint32_t ahead;             /* 1: structures went on already for the iteration under way */
    /* where a pose is to lay vertex v, which an iteration has taken to x; NULL: there. Written by time_steps.c */
    smr_vec (*to)(const struct smr_dynamics *d, uint32_t v, smr_vec x);
} smr_held;

typedef struct smr_shape {
    const smr_shared *shared;
    smr_vec origin; /* mm, whole: positions are relative to it */
    /* written by setup/start.c */
    float *start;      /* [n][3] start positions */
    smr_box start_box; /* around them, mm */
    /* x_next is written by evolve and folds; tick/iteration_end.c exchanges the two; setup/start.c sets both */
    float *x;      /* [n][3] positions of the last complete iteration */
    float *x_next; /* [n][3] positions under way; until evolve writes them, the positions before x */
    float *normal; /* [n][3] unit, at x; 0 where there is no triangle */
    /* written by evolve/plasticity.c, and where a registration starts by setup/start.c */
    float *x_ref;      /* [n][3] reference shape x^r */
    float *normal_ref; /* [n][3] normals that belong to it */
    /* written by moving_triangles.c */
    smr_shape_structure *structure; /* [n_structures] */
    uint8_t *on_surface;            /* [n] 1: a corner of some triangle; 0: nothing draws it, it is carried */
    float *facet_normal;            /* [n_triangles][3] */
    smr_node *node;                 /* [n_nodes] box trees, one structure after the other; NULL: no attraction */
    uint32_t n_nodes;
    uint32_t *own_triangle; /* [n_triangles][3] on big-endian hosts */
    /* written by rest_pose.c; tick/schedule.c says when it is due */
    smr_pose rest_pose;     /* the similarity that lays the rest shape onto x best */
    smr_fit fit;            /* its sums so far */
    uint32_t rest_pose_due; /* 1: it is to be made of the present positions */
    /* written by held_shape.c; NULL where nothing is tracked */
    smr_held *held;
    float *held_x;          /* [n][3] the schedule's result, which tracking is elastic about */
    float *image_x;         /* [n][3] x when the image was left behind; NULL: no images can be followed */
    smr_pose *held_pose;    /* [n_structures] rigid, lays each structure of held_x onto its present positions */
    smr_pose *held_last;    /* [n_structures] the same when targets were set last; NULL: structures do not go on */
    struct smr_dynamics *dynamics; /* NULL: relaxation, without mass */
    /* [n][3] in dynamics, from the start of an iteration until evolve: where its sweep starts. NULL: at x. Over x_next;
     * written by time_steps.c */
    float *from;
} smr_shape;

void smr_shape_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared);

/* Shapes of the trees and their places in the arrays. */
void smr_shape_start(smr_shape *shape);

/* moving_triangles.c: triangles' normals, and box trees where there are any. */
void smr_facets_follow(smr_shape *shape, const float *xyz); /* from here on of these positions */
void smr_facets_now(smr_shape *shape);                      /* all of them, at x */
uint32_t smr_facets_tasks(const void *shape);
void smr_facets_refit(void *shape, uint32_t task, uint32_t worker);
void smr_facets_end(smr_shape *shape);

/* rest_pose.c: fits rest_pose where it is due. Serial. */
uint32_t smr_rest_pose_tasks(const void *shape);
void smr_rest_pose_sum(void *shape, uint32_t task, uint32_t worker);
void smr_rest_pose_end(smr_shape *shape);
void smr_rest_pose_now(smr_shape *shape); /* at once, without steps */

/* held_shape.c, in tracking and dynamics: x^r is the held shape, each structure carried along by the pose that lays it onto x best.
 * The sums are of x_next, at the end of an iteration. */
void smr_held_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared);
void smr_held_wire(smr_shape *shape);   /* nothing is held yet; the structures are known */
void smr_held_derive(smr_shape *shape); /* what follows from held_x, which was restored */
void smr_held_start(smr_shape *shape);  /* x is the held shape from here on */
uint32_t smr_held_sum_tasks(const void *shape);
void smr_held_sum(void *shape, uint32_t task, uint32_t worker); /* serial */
void smr_held_sum_end(smr_shape *shape);
void smr_held_stand(smr_shape *shape); /* the iteration stands: x^r follows */
void smr_held_leave(smr_shape *shape); /* what else is followed goes on from here, and the image stays behind */
void smr_held_ahead(smr_shape *shape, int steady); /* new targets: structures go on as they went, if that is steady */

/* A stored vertex of the rest shape in its pose. */
static inline smr_vec smr_rest_posed(const smr_shape *shape, uint32_t vertex)
{
    return smr_pose_apply(&shape->rest_pose, smr_rest(shape->shared, vertex));
}

#endif
