/* unseen_field.h: where the parts of the model lie that the target does not show. In: positions, which vertices are
 * seen, and landmarks. Out: a smooth field from the start positions, which unseen vertices follow.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_UNSEEN_FIELD_H
#define SMR_UNSEEN_FIELD_H

#include "options/partial/landmark_goals.h"
#include "registration/shape/overlaid_memory.h"

#define SMR_CONTROLS 64u          /* seen vertices that the field passes by, in space */
#define SMR_FIELD_ROWS 192u       /* without landmarks: those that it passes by along their normals */
#define SMR_FIELD_MOTIONS 7u      /* shifts, turns and scale */
#define SMR_FIELD_TRIES 3u        /* kinds of roughness, of which the likeliest is taken */
#define SMR_TRY_TASKS 24u         /* of each */
#define SMR_FIELD_ROUNDED 1.0e-5f /* of a variance: what sums of SMR_FIELD_ROWS products lose */
#define SMR_FIELD_STEP 0.8f       /* of the way that normals ask for, in an iteration */
#define SMR_FIELD_FOLLOW 0.35f    /* while targets are tracked: of new ones no triangle is known yet, only pulls */
#define SMR_FIELD_MEAN 0.1f       /* the same at the last radius: the mean of what vertices tell in turn */
#define SMR_MOTION_VARIANCE 8.0f  /* of the motions, over the field's: at a kernel length for turns and scale */
#define SMR_CONTROLS_MAX (SMR_CONTROLS + SMR_LANDMARKS_MAX)
#define SMR_FACTOR_WORDS(n) ((n) * ((n) + 1u) / 2u)

typedef struct smr_unseen_field {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    const smr_surface_goals *goals;
    const smr_landmark_goals *landmarks;
    const uint8_t *found;      /* [n] forces.found_last: what the last complete forces found */
    const uint32_t *has_image; /* 1: structures without a surface follow an image */
    uint32_t most;             /* controls that there is room for */
    float *start;              /* [most][3] start positions of the controls, mm */
    float *bend;               /* [most][3] coefficients of the field; while it is solved: what the pose leaves, mm */
    float *lower;  /* [SMR_FACTOR_WORDS(most)] Cholesky factor, row by row; before: which vertices are controls */
    float *loose;  /* [most] on the diagonal: how far the field may miss a control */
    float *motion; /* [most][SMR_FIELD_MOTIONS] along a control's normal, of motions by 1; without landmarks */
    float *told;   /* [most] of the try under way: what each row tells beside those before */
    float *left;   /* [most] from the pose to the goal along it, mm; then coefficients; without landmarks */
    float back[SMR_FIELD_MOTIONS]; /* motions: from the pose to the start, then to where normals show it */
    smr_vec middle;                /* about which motions turn and scale */
    uint32_t sheet;                /* 1: the model is one, whose size along itself is told by its borders alone */
    uint32_t by_normals;           /* 1: controls are known along their normals only; set when they are chosen */
    uint32_t n;                    /* controls in use, the landmarks first; 0: no field */
    smr_pose pose;                 /* rigid, from start to present positions of the controls */
    float per_length2;             /* 1 / mm^2, of the kernel's length */
    float rough, per_rough2;       /* the kernel's short term: its variance, 0: none; 1 / mm^2 */
    float motion_variance;         /* of the motions, over the field's */
    float rough_loose;             /* what a control may be off besides */
    float likelihood;              /* the largest one yet, and which roughness has it */
    uint32_t likeliest;
    float square, log; /* of the try under way: sums over its rows */
} smr_unseen_field;

static inline float *smr_field_row(const smr_unseen_field *f, uint32_t i)
{
    return f->lower + (size_t)i * (i + 1u) / 2u;
}

/* 1: nothing gives places, so controls are known along their normals only (field_normals.c). */
uint32_t smr_field_normals_only(const smr_unseen_field *f);
/* Adds seen vertices to n controls, from places first .. last - 1 of an order that winds through the model. Returns how
 * many controls there are then. */
uint32_t smr_field_normals_choose(const smr_unseen_field *f, uint32_t first, uint32_t last, uint32_t *control,
                                  uint32_t n);
/* The share of the way to take in this iteration. */
float smr_field_normals_step(const smr_unseen_field *f);
/* The pose is there, and `bend` holds present positions; control: stored vertices, middle: about which motions turn, at
 * the start. Then the covariance of what two controls tell, from the kernel between them. At the end, from the factor:
 * coefficients, and motions added to the pose. */
void smr_field_normals_begin(smr_unseen_field *f, const uint32_t *control, smr_vec middle);
float smr_field_normals_between(const smr_unseen_field *f, uint32_t i, uint32_t j, float kernel);
void smr_field_normals_end(smr_unseen_field *f);

/* Tries each roughness on the controls, in SMR_FIELD_TRIES * SMR_TRY_TASKS tasks, one after the other; then sets the
 * likeliest. */
void smr_field_roughness_try(smr_unseen_field *f, uint32_t task);
/* The covariance of what controls i and j <= i tell. */
float smr_unseen_field_between(const smr_unseen_field *f, uint32_t i, uint32_t j);

size_t smr_unseen_field_words(const smr_shared *shared); /* of memory that it needs while forces are computed */
void smr_unseen_field_wire(smr_unseen_field *f, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                           const smr_surface_goals *goals, const smr_landmark_goals *landmarks,
                           const smr_overlay *overlay);
/* Once the model's structures are there: whether they are sheets, of which normals say little that runs across them.
 * One pass over their triangles. */
void smr_unseen_field_model(smr_unseen_field *f);
void smr_unseen_field_watch(smr_unseen_field *f, const uint8_t *found, const uint32_t *has_image);

/* 1 while images are followed: an image says nothing along a surface, and of some surfaces little at all. */
static inline int smr_field_of_image(const smr_unseen_field *f) { return f->pace->tracking && *f->has_image; }

/* 1: what the image shows is of the past. */
static inline int smr_field_of_past(const smr_unseen_field *f)
{
    return smr_field_of_image(f) && f->pace->image_age == SMR_IMAGE_PAST;
}

/* 1: a surface shows a part of the vertex' structure, and the image, which is not of the past, the rest. */
static inline int smr_field_of_rest(const smr_unseen_field *f, uint32_t v)
{
    return *f->has_image && !smr_field_of_past(f) &&
           smr_overlap_lasting(f->goals, smr_model_owner(f->shared->model, v));
}

/* Steps, skipped where nothing is unseen; one task after the other. */
uint32_t smr_unseen_field_tasks(const void *field);
void smr_unseen_field_solve(void *field, uint32_t task, uint32_t worker);

/* Adds to the way to a goal what the field does along the surface, and blends it with the field as far as the vertex is
 * unseen. way: in: to the goal; out: mm. has_goal: whether there is one. */
void smr_unseen_field_blend(const smr_unseen_field *f, uint32_t v, int has_goal, smr_vec *way);

/* Blends the way of a vertex that has none, or none but that to its neighbours, with the field: as far as the nearest
 * landmark is nearer than the nearest vertex that is seen. */
void smr_unseen_field_fill(const smr_unseen_field *f, uint32_t v, smr_vec *way);

/* The same while images are followed: a vertex with a goal in the image goes along the surface with the field, every
 * other one goes with the field alone. seen: what the search in the image said. Returns SMR_NO_GOAL where the vertex
 * has strayed too far for its goal to count. */
int smr_unseen_field_steady(const smr_unseen_field *f, uint32_t v, int seen, smr_vec *way);

/* The way to where the field carries the vertex, mm: all that an image of the past leaves to go by. */
smr_vec smr_unseen_field_way(const smr_unseen_field *f, uint32_t v);

/* How far hard landmarks prevail at a vertex, 0..1. */
float smr_unseen_field_prevails(const smr_unseen_field *f, uint32_t v);

/* Blends a way with the field as far as a hard landmark prevails over targets. */
void smr_unseen_field_prevail(const smr_unseen_field *f, uint32_t v, smr_vec *way);

/* Between iterations: solves the field through the landmarks alone and returns the variance of their places along an
 * axis, mm^2; below 0 where they are too few. Then the share of it that is left at a vertex. */
float smr_landmark_field_solve(smr_unseen_field *f);
float smr_landmark_field_left(const smr_unseen_field *f, uint32_t v);

#endif
