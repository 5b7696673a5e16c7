/* partial.h: capability: targets that show a part of the model, with clouds of points and landmarks. In: positions, what
 * the surface search found of each vertex, landmarks. Out: how far each vertex is visible, what points ask of vertices
 * around them, and a smooth field that vertices follow which no target shows.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PARTIAL_H
#define SMR_PARTIAL_H

#include "geometry/gaussian_process/gaussian_process.h"
#include "registration/shape/overlaid_memory.h"
#include "registration/surface_goals/surface_goal.h"

#ifdef SMR_WITHOUT_PARTIAL
#define SMR_HAS_PARTIAL 0
#else
#define SMR_HAS_PARTIAL 1
#endif

/* ---- visibility ---- */

/* 1: it is judged how far targets show each vertex. */
static inline int smr_visibility_on(const smr_surface_goals *g) { return SMR_HAS_PARTIAL && g->seen != NULL; }

/* 1: the vertices of this target's structure count as far as they are visible. */
static inline int smr_shows_part(const smr_target *t) { return SMR_HAS_PARTIAL && t->partial; }

/* 1: a target that is a cloud of points. */
static inline int smr_is_points(const smr_surface *target) { return SMR_HAS_PARTIAL && smr_is_cloud(target); }

/* overlap.c: how well the target shows each vertex, and which structures are seen in part. */
void smr_overlap_start(smr_surface_goals *g); /* with the targets as they are now */
/* 1: partial from the start to the end, not only until it is covered. */
int smr_overlap_lasting(const smr_surface_goals *g, uint32_t structure);
int smr_overlap_judged(const smr_surface_goals *g, uint32_t structure); /* 1: in this iteration */
void smr_overlap_judge(smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit, smr_vec way);
void smr_overlap_judge_points(smr_surface_goals *g, uint32_t v, float weight); /* of points that reached it */
/* 0..1: how far its target shows vertex v, a whole one in full where there is a goal; and how far that is a part, 0 of
 * a structure that is shown nearly whole. */
float smr_overlap_shown(const smr_surface_goals *g, uint32_t v, int has_goal);
float smr_overlap_part(const smr_surface_goals *g, uint32_t v);
void smr_overlap_stand(smr_surface_goals *g); /* the forces under way are complete */
void smr_overlap_look(smr_surface_goals *g);  /* then, once it is known whether targets have jumped */

/* ---- clouds of points ---- */

typedef struct smr_point_spread {
    const smr_shared *shared;
    const smr_shape *shape;
    smr_surface_goals *goals;
    smr_spread memory;
    uint32_t rounds;    /* of spreading, so far as is known */
    uint32_t n_reached; /* vertices with a weight, in the round under way */
    float weight;       /* of all points that pull */
} smr_point_spread;

void smr_point_spread_wire(smr_point_spread *p, const smr_shared *shared, const smr_shape *shape,
                           smr_surface_goals *goals, const smr_overlay *overlay);

/* The way that the points of a cloud ask of v, mm, and how far they show it. Returns 0 where no point asks anything. */
int smr_point_goal(smr_surface_goals *g, uint32_t v, smr_vec *way);

/* Steps, skipped where there is no cloud; one task after the other. */
uint32_t smr_point_spread_tasks(const void *spread);
void smr_point_spread_run(void *spread, uint32_t task, uint32_t worker);

/* ---- landmarks ---- */

#define SMR_LANDMARK_NEAR 24u /* vertices that carry a point which does not lie on a surface */
#define SMR_HARD_EDGES 4.0f   /* mean edges: a hard landmark prevails within this distance of its triangle */

/* A landmark and what of the model it is bound to. Written by setup/landmarks.c. */
typedef struct smr_bound_landmark {
    smr_landmark given;
    uint32_t corner[3]; /* stored vertices; with a vertex all the same */
    float share[3];     /* barycentric: of the foot, the point of the surface nearest to the landmark's */
    smr_vec foot;       /* at rest, mm from the model's centre */
    smr_vec apart;      /* from there to the point at rest, mm */
    smr_vec more;       /* hard: what is asked for beyond its place, mm, since clusters do not follow in full */
    uint32_t n_near;    /* 0: the point is the foot */
    uint32_t near[SMR_LANDMARK_NEAR]; /* stored vertices whose motion turns `apart` */
} smr_bound_landmark;

typedef struct smr_landmark_goals {
    const smr_shared *shared;
    const smr_shape *shape;
    smr_bound_landmark *landmark; /* [config.partial.n_landmarks]; NULL: none can be set */
    uint32_t n;                   /* set now */
    float reach;                  /* mm: how far a hard one prevails */
    const smr_pace *pace;
    uint8_t *seen; /* [n vertices] 0 .. SMR_SEEN_ONE: what the target showed when it last was sought */
} smr_landmark_goals;

/* 1: some landmark is set. */
static inline int smr_landmarks_on(const smr_landmark_goals *g) { return SMR_HAS_PARTIAL && g->n > 0u; }

void smr_landmark_goals_layout(smr_arena *a, smr_landmark_goals *g, const smr_shared *shared);
void smr_landmark_goals_wire(smr_landmark_goals *g, const smr_shared *shared, const smr_pace *pace,
                             const smr_shape *shape);
void smr_landmark_goals_stand(smr_landmark_goals *g); /* the forces under way are complete */
void smr_landmark_goals_reset(smr_landmark_goals *g); /* nothing of the forces so far is left */

/* The foot of landmark k where its vertices are in `xyz`, [n][3]. */
smr_vec smr_landmark_foot(const smr_landmark_goals *g, uint32_t k, float *xyz);

/* From the foot to the point, where the vertices are now. */
smr_vec smr_landmark_apart(const smr_landmark_goals *g, uint32_t k);

/* Where landmark k wants its foot, mm from the shape's origin. What it asks for lies `more` beyond. */
smr_vec smr_landmark_goal(const smr_landmark_goals *g, uint32_t k);

/* 1 at a vertex that landmark k is bound to, falling to 0 at a distance of `reach` at the start. */
float smr_landmark_prevails(const smr_landmark_goals *g, uint32_t k, uint32_t v);

/* Falls from 1 at distance 0 to 0 at 1 and beyond; a covariance in space (Wendland 1995). */
static inline float smr_bump(float distance)
{
    const float left = smr_max(1.0f - distance, 0.0f), left2 = left * left;
    return left2 * left2 * (4.0f * distance + 1.0f);
}

/* 1 at a vertex that a landmark is bound to. */
int smr_landmark_binds(const smr_landmark_goals *g, uint32_t v);

/* ---- the field ---- */

#define SMR_CONTROLS 64u          /* seen vertices that the field passes by, in space */
#define SMR_FIELD_ROWS 192u       /* without landmarks: those that it passes by along their normals */
#define SMR_FIELD_MOTIONS 7u      /* shifts, turns and scale */
#define SMR_FIELD_TRIES 3u        /* kinds of roughness, of which the likeliest is taken */
#define SMR_TRY_TASKS 24u         /* of each */
#define SMR_FIELD_LOOSE 0.003f    /* of the variance: what a control may be off */
#define SMR_FIELD_ROUNDED 1.0e-5f /* of a variance: what sums of SMR_FIELD_ROWS products lose */
#define SMR_FIELD_STEP 0.8f       /* of the way that normals ask for, in an iteration */
#define SMR_FIELD_FOLLOW 0.35f    /* while targets are tracked: of new ones no triangle is known yet, only pulls */
#define SMR_FIELD_MEAN 0.1f       /* the same at the last radius: the mean of what vertices tell in turn */
#define SMR_MOTION_VARIANCE 8.0f  /* of the motions, over the field's: at a kernel length for turns and scale */
#define SMR_CONTROLS_MAX (SMR_CONTROLS + SMR_LANDMARKS_MAX)

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

static inline float *smr_field_row(const smr_unseen_field *f, uint32_t i) { return smr_factor_row(f->lower, i); }

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
/* field_covariance.c: where the field starts, [n][3] mm; whether control k is a hard landmark; the covariance of the field
 * at a place with control k, a landmark's with the mean of its corners (sharp: with the field of short reach, too). */
float *smr_field_start(const smr_unseen_field *f);
int smr_field_hard(const smr_unseen_field *f, uint32_t k);
float smr_field_with_control(const smr_unseen_field *f, smr_vec at, uint32_t k, int sharp);
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
static inline int smr_field_of_image(const smr_unseen_field *f)
{
    return SMR_HAS_PARTIAL && f->pace->tracking && *f->has_image;
}

/* 1: what the image shows is of the past. */
static inline int smr_field_of_past(const smr_unseen_field *f)
{
    return smr_field_of_image(f) && f->pace->image_age == SMR_IMAGE_PAST;
}

/* 1: a surface shows a part of the vertex' structure, and the image, which is not of the past, the rest. */
static inline int smr_field_of_rest(const smr_unseen_field *f, uint32_t v)
{
    return SMR_HAS_PARTIAL && *f->has_image && !smr_field_of_past(f) &&
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
