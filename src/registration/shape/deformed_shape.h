/* deformed_shape.h: the deforming model: positions, normals, reference shape and moving triangles. In: the model. Out:
 * positions that all stages read. x and x_next are exchanged when an iteration is complete.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_DEFORMED_SHAPE_H
#define SMR_DEFORMED_SHAPE_H

#include "geometry/box_tree/box_tree.h"
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/rotation/similarity_fit.h"
#include "registration/shape/schedule_state.h"

struct smr_dynamics;

typedef struct smr_shape_structure {
    uint32_t first_vertex, n_vertices; /* range in the caller's numbering */
    uint32_t first_triangle;
    uint32_t first_leaf; /* first leaf of its tree, counted over all structures */
    smr_box_tree tree;   /* the structure's triangles, normals and box tree as they move */
} smr_shape_structure;

/* State of the rest shape of tracking, besides arrays. */
typedef struct smr_track_rest {
    smr_box box;                /* box around track_rest_x, mm */
    smr_pose rest_pose;         /* pose of the model's rest shape when the schedule ended: near track_rest_x */
    smr_pose whole;             /* rigid pose from track_rest_x to x, all structures together */
    smr_fit one, all;           /* sums of the fits: of the current structure, of the whole model */
    uint32_t structure, vertex; /* position of the summation, in the caller's numbering */
    uint32_t n_tasks;           /* number of tasks of the summation */
    uint32_t due;               /* 1: x^r is to follow in this iteration. Written by tracking.c and dynamics.c */
    uint32_t predicted;         /* 1: structures were already moved on for the current targets */
    /* where a pose is to lay vertex v, which an iteration has taken to x; NULL: there. Written by
     * dynamics.c */
    smr_vec (*to)(const struct smr_dynamics *d, uint32_t v, smr_vec x);
} smr_track_rest;

typedef struct smr_shape {
    const smr_shared *shared;
    smr_vec origin; /* mm, whole numbers: positions are relative to it */
    /* written when positions are set */
    float *start;      /* [n][3] start positions */
    smr_box start_box; /* box around the start positions, mm */
    /* x_next is written by the current iteration; the two are exchanged when it is complete */
    float *x;      /* [n][3] positions of the last complete iteration */
    float *x_next; /* [n][3] positions of the current iteration; until it writes them, the positions before x */
    float *normal; /* [n][3] unit normals at x; 0 for vertices without triangles */
    /* written by plasticity, and when a registration starts */
    float *x_ref;                   /* [n][3] reference shape x^r */
    float *normal_ref;              /* [n][3] normals of the reference shape */
    smr_shape_structure *structure; /* [n_structures] structures of the model */
    /* [n] 1: the vertex belongs to a triangle; 0: no target attracts it, clusters carry it along */
    uint8_t *on_surface;
    float *triangle_normal; /* [n_triangles][3] unit normals of the triangles */
    /* [n_nodes] box trees of all structures, one after the other; NULL: neither attraction nor contact */
    smr_node *node;
    uint32_t n_nodes;
    uint32_t *own_triangle; /* [n_triangles][3] stored vertices in host order, on big-endian hosts only */
    smr_pose rest_pose;     /* similarity from the rest shape onto x */
    smr_fit fit;            /* sums of its fit so far */
    uint32_t rest_pose_due; /* 1: it is to be fitted to the present positions */
    /* NULL without tracking and dynamics */
    smr_track_rest *track_rest;
    float *track_rest_x;  /* [n][3] rest shape of tracking: the result of the schedule */
    float *image_x;       /* [n][3] x when the tracked image became outdated; NULL: no images can be tracked */
    smr_pose *track_pose; /* [n_structures] rigid pose of each structure, from track_rest_x to its present position */
    /* [n_structures] the same pose when targets were set last; NULL: structures are not moved on */
    smr_pose *track_pose_last;
    struct smr_dynamics *dynamics; /* NULL: no dynamics */
    /* [n][3] in dynamics, from the start of an iteration until evolve: where its sweep starts. NULL: at x. Over x_next;
     * written by dynamics.c */
    float *from;
} smr_shape;

void smr_shape_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared);

/* Computes the shapes of the box trees and their places in the arrays. */
void smr_shape_start(smr_shape *shape);

/* Triangles' normals, and box trees where there are any. */
void smr_triangles_follow(smr_shape *shape, const float *xyz); /* the triangles read these positions from now on */
void smr_triangles_now(smr_shape *shape);                      /* updates all normals and boxes at x */
uint32_t smr_triangles_tasks(const void *shape);
void smr_triangles_refit(void *shape, uint32_t task, uint32_t worker);
void smr_triangles_end(smr_shape *shape);

/* Fits rest_pose where it is due. Tasks run one after the other. */
uint32_t smr_rest_pose_tasks(const void *shape);
void smr_rest_pose_sum(void *shape, uint32_t task, uint32_t worker);
void smr_rest_pose_end(smr_shape *shape);
void smr_rest_pose_now(smr_shape *shape); /* fits rest_pose at once, without steps */

/* tracking_rest_shape.c, in tracking and dynamics: x^r is the held shape, each structure carried along by the pose that
 * lays it onto x best. The sums are of x_next, at the end of an iteration. */
void smr_track_rest_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared);
void smr_track_rest_wire(smr_shape *shape);   /* counts tasks, once the structures are known */
void smr_track_rest_derive(smr_shape *shape); /* computes what follows from a restored track_rest_x */
void smr_track_rest_start(smr_shape *shape);  /* x becomes the rest shape */
uint32_t smr_track_rest_sum_tasks(const void *shape);
void smr_track_rest_sum(void *shape, uint32_t task, uint32_t worker); /* tasks run one after the other */
void smr_track_rest_sum_end(smr_shape *shape);
void smr_track_rest_commit(smr_shape *shape); /* called when the iteration is complete: x^r follows */
/* keeps x as the positions of the image, which becomes outdated */
void smr_track_rest_keep_image(smr_shape *shape);
/* called for new targets: moves structures on as before, if steady is 1 */
void smr_track_rest_predict(smr_shape *shape, int steady);

/* The position of a stored vertex of the rest shape in rest_pose. */
static inline smr_vec smr_rest_posed(const smr_shape *shape, uint32_t vertex)
{
    return smr_pose_apply(&shape->rest_pose, smr_rest(shape->shared, vertex));
}

#endif
