/* deformed_shape.h: the deforming model: positions, normals, reference shape and moving triangles. In: the model.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_DEFORMED_SHAPE_H
#define SMR_DEFORMED_SHAPE_H

#include "geometry/box_tree/box_tree.h"
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/rotation/similarity_fit.h"
#include "registration/shape/step_worker.h"

struct smr_dynamics;
struct smr_references;

typedef struct smr_shape_structure {
    uint32_t first_vertex, n_vertices; /* range of vertices in the caller's numbering */
    uint32_t first_triangle;           /* index of the structure's first triangle in the model */
    uint32_t first_leaf; /* index of the first leaf of the structure's tree among the leaves of all structures */
    smr_box_tree tree;   /* triangles of the structure, with their current normals and box tree */
} smr_shape_structure;

/* State of tracking's rest shape, besides arrays. */
typedef struct smr_track_rest {
    smr_box box;                /* box around track_rest_x, mm */
    smr_pose rest_pose;         /* similarity from the model's rest shape onto track_rest_x */
    smr_pose whole;             /* rigid pose from track_rest_x to x, all structures together */
    smr_fit one, all;           /* sums of the fits: of the current structure, of the whole model */
    uint32_t structure, vertex; /* next structure and vertex of the summation, in the caller's numbering */
    uint32_t n_tasks;           /* number of tasks of the summation */
    uint32_t due;               /* 1: this iteration ends with x^r = track_rest_x in new poses */
    uint32_t predicted;         /* 1: structures were already moved ahead for the current targets */
    /* returns the place to which a structure's pose fits vertex v, which is at x; NULL: x. Set by dynamics.c */
    smr_vec (*to)(const struct smr_dynamics *d, uint32_t v, smr_vec x);
} smr_track_rest;

typedef struct smr_shape {
    const smr_shared *shared;
    smr_vec origin; /* origin of all positions in the caller's coordinates, mm, whole numbers */
    /* members set with the start positions */
    float *start;      /* [n][3] start positions, mm */
    smr_box start_box; /* box around the start positions, mm */
    uint32_t in_parts; /* 1: structures start as rigid bodies, each in its own pose; `start` is then the rest shape */
    /* x and x_next are exchanged when an iteration is complete */
    float *x;      /* [n][3] positions of the last complete iteration, mm */
    float *x_next; /* [n][3] positions of the current iteration, mm; until evolve, the positions before x */
    float *normal; /* [n][3] unit normals at x; 0 for vertices without triangles */
    /* members that plasticity, tracking and a start write */
    float *x_ref;                   /* [n][3] reference shape x^r, mm */
    float *normal_ref;              /* [n][3] unit normals of the reference shape */
    smr_shape_structure *structure; /* [n_structures] structures of the model */
    uint8_t *on_surface;            /* [n] 1: the vertex has a triangle; 0: only clusters move the vertex */
    float *triangle_normal;         /* [n_triangles][3] unit normals of the triangles */
    smr_node *node;            /* [n_nodes] box trees of all structures in turn; NULL: neither attraction nor contact */
    uint32_t n_nodes;          /* number of nodes of all box trees */
    uint32_t *own_triangle;    /* [n_triangles][3] stored vertices in host order, on big-endian hosts only */
    smr_pose rest_pose;        /* similarity from the rest shape onto x */
    smr_pose rest_pose_before; /* rest_pose when the current iteration began */
    smr_fit fit;               /* sums of the fit of rest_pose so far */
    uint32_t rest_pose_due;    /* 1: rest_pose must be fitted to x */
    smr_track_rest *track_rest; /* state of tracking's rest shape; NULL: neither tracking nor dynamics */
    float *track_rest_x;        /* [n][3] tracking's rest shape: the result of the schedule, mm */
    float *image_x;             /* [n][3] x when the tracked image became outdated, mm; NULL: images are not tracked */
    smr_pose *track_pose;       /* [n_structures] rigid pose of each structure, from track_rest_x to x */
    smr_pose *track_pose_last;  /* [n_structures] track_pose when targets were set last; NULL: nothing is predicted */
    struct smr_dynamics *dynamics;     /* velocities and masses of dynamics; NULL: no dynamics */
    struct smr_references *references; /* further subjects' shapes; NULL: none. With some, `start` is a blend */
    /* [n][3] start positions of a sweep of dynamics, mm, until evolve, in the memory of x_next; NULL: x */
    float *from;
} smr_shape;

/* returns the three stored vertices of a triangle of the model, as smr_triangle_at() */
const uint32_t *smr_model_triangle(const smr_shared *c, uint32_t k);
void smr_shape_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared);
void smr_shape_start(smr_shape *shape); /* computes the shapes of the box trees and their places in the arrays */
void smr_shape_mark(smr_shape *shape, uint32_t first, uint32_t last); /* sets on_surface at corners of triangles */

/* Moving triangles: their normals, and box trees where a stage needs them. */
void smr_triangles_follow(smr_shape *shape, const float *xyz); /* lets the triangles read their corners at xyz [n][3] */
void smr_triangles_now(smr_shape *shape);                      /* updates the normals and boxes of all triangles at x */
/* Steps: normals and boxes of triangles; boxes above the trees' leaves, one task after the other. */
smr_count_tasks smr_triangles_tasks, smr_uppers_tasks;
smr_run_task smr_triangles_refit, smr_uppers_refit;

/* Step: fits rest_pose where rest_pose_due is 1. Tasks run one after the other. */
smr_count_tasks smr_rest_pose_tasks;
smr_run_task smr_rest_pose_sum;
void smr_rest_pose_end(smr_shape *shape);

/* tracking_rest_shape.c, in tracking and dynamics: x^r is tracking's rest shape, each structure in its best-fitting
 * pose. The fit is to x_next at the end of an iteration. */
void smr_track_rest_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared);
void smr_track_rest_wire(smr_shape *shape);            /* counts the summation's tasks in n_tasks */
void smr_track_rest_poses(smr_shape *shape);           /* sets the poses of the rest shape to none */
void smr_track_rest_clear(smr_shape *shape);           /* the same, and empties the box */
void smr_track_rest_add(smr_shape *shape, uint32_t v); /* adds the next position of v, all one after the other */
smr_count_tasks smr_track_rest_sum_tasks;
smr_run_task smr_track_rest_sum; /* adds a chunk of vertices to the fits of poses; one task after the other */
void smr_track_rest_sum_end(smr_shape *shape);
smr_vec smr_track_rest_posed(const smr_shape *shape, uint32_t v); /* returns track_rest_x of v in the new poses */
void smr_track_rest_commit(smr_shape *shape);                     /* makes the new pose of the whole current */
void smr_track_rest_keep_image(smr_shape *shape); /* copies x to image_x when the tracked image becomes outdated */
/* for new targets: stores each structure's pose; steady 1: also moves structures ahead by their last motion */
void smr_track_rest_predict(smr_shape *shape, int steady);

/* Returns the position of a stored vertex in the rest shape, with the structures in the poses of the start, mm. */
static inline smr_vec smr_rest_in_parts(const smr_shape *shape, uint32_t vertex)
{
    return shape->in_parts ? smr_get3(shape->start, vertex) : smr_rest(shape->shared, vertex);
}

/* Returns the position of a stored vertex in that shape, mapped by rest_pose, mm. */
static inline smr_vec smr_rest_posed(const smr_shape *shape, uint32_t vertex)
{
    return smr_pose_apply(&shape->rest_pose, smr_rest_in_parts(shape, vertex));
}

#endif
