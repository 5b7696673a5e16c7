/* partial.h: capability: targets that show a part of the model, clouds of points, and landmarks. In: positions, results
 * of the closest-point search, landmarks. Out: each vertex' visibility, goals from points and landmarks, and a smooth
 * field that occluded vertices follow.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PARTIAL_H
#define SMR_PARTIAL_H

#include "registration/shape/overlaid_memory.h"
#include "registration/surface_goals/closest_point_goals.h"

#ifdef SMR_WITHOUT_PARTIAL
#define SMR_HAS_PARTIAL 0
#else
#define SMR_HAS_PARTIAL 1
#endif

/* ---- visibility ---- */

/* Returns 1 when the visibility of vertices is judged. */
static inline int smr_visibility_on(const smr_surface_goals *g) { return SMR_HAS_PARTIAL && g->visibility != NULL; }

/* Returns 1 when a target is a cloud of points. */
static inline int smr_is_points(const smr_surface *target) { return SMR_HAS_PARTIAL && smr_is_cloud(target); }

void smr_visibility_start(smr_surface_goals *g); /* decides which of the present targets are partial */
/* Returns 1 when the target stays partial to the end, not only until it is covered. */
int smr_visibility_always_partial(const smr_surface_goals *g, uint32_t structure);
/* Returns 1 when visibility is judged in this iteration. */
int smr_visibility_judged(const smr_surface_goals *g, uint32_t structure);
/* Judges the visibility of v from its closest point, or from the weight of the points that reached it. */
void smr_visibility_judge(smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit,
                          smr_vec displacement);
void smr_visibility_judge_points(smr_surface_goals *g, uint32_t v, float weight);
/* The visibility of vertex v, 0..1; 1 for any goal on a whole target. */
float smr_visibility_of(const smr_surface_goals *g, uint32_t v, int has_goal);
/* Returns 1 when little of the structure of v is visible, 0 when nearly all of it is, and values between. */
float smr_visibility_partial(const smr_surface_goals *g, uint32_t v);
void smr_visibility_commit(smr_surface_goals *g);    /* when forces are complete: keeps and counts visibilities */
void smr_visibility_note_view(smr_surface_goals *g); /* called when it is known whether targets have jumped */

/* ---- clouds of points ---- */

/* The smoothing of a cloud's pulls over the mesh. */
typedef struct smr_point_spread {
    const smr_shared *shared;
    const smr_shape *shape;
    smr_surface_goals *goals;
    smr_spread memory;
    uint32_t rounds;    /* number of rounds known to be needed so far */
    uint32_t n_reached; /* vertices with a weight in the current round */
    float weight;       /* sum of the weights of all pulling points */
} smr_point_spread;

/* Computes the displacement of v to its goal from a cloud, mm, and judges its visibility. Returns 0 without a goal. */
int smr_point_goal(smr_surface_goals *g, uint32_t v, smr_vec *displacement);

/* Step: smooths the pulls. Skipped without a cloud. Tasks run one after the other. */
smr_count_tasks smr_point_spread_tasks;
smr_run_task smr_point_spread_run;

/* ---- landmarks ---- */

#define SMR_LANDMARK_NEAR 24u /* vertices that rotate the offset of a landmark off the surface */
#define SMR_HARD_EDGES 4.0f   /* mean edge lengths: a hard landmark dominates within this distance of its triangle */

/* A landmark and the part of the model that it is bound to. */
typedef struct smr_bound_landmark {
    smr_landmark given;
    uint32_t corner[3]; /* stored vertices of the landmark's triangle; three times one vertex for a landmark on it */
    float share[3];     /* barycentric weights of the foot: the surface point closest to the landmark */
    smr_vec foot;       /* foot at rest, mm from the model's centre */
    smr_vec offset;     /* vector from the foot to the landmark at rest, mm */
    smr_vec more;       /* displacement added to a hard landmark's goal, mm, since clusters follow goals only in part */
    uint32_t n_near;    /* number of vertices in `near`; 0: the landmark lies on the surface */
    uint32_t near[SMR_LANDMARK_NEAR]; /* stored vertices whose motion rotates `offset` */
} smr_bound_landmark;

typedef struct smr_landmark_goals {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_bound_landmark *landmark; /* [config.partial.n_landmarks]; NULL: none can be set */
    uint32_t n;                   /* number of landmarks that are set */
    float reach;                  /* mm: range in which a hard landmark dominates */
    uint8_t *visibility;          /* [n vertices] 0 .. SMR_VISIBLE_ONE: visibility in the last search */
} smr_landmark_goals;

static inline int smr_landmarks_on(const smr_landmark_goals *g) { return SMR_HAS_PARTIAL && g->n > 0u; }

void smr_landmark_goals_layout(smr_arena *a, smr_landmark_goals *g, const smr_shared *shared);
void smr_landmark_goals_commit(smr_landmark_goals *g); /* when forces are complete: moves hard landmarks' goals */
void smr_landmark_goals_reset(smr_landmark_goals *g);  /* discards all results of the current forces */

/* The foot of landmark k, mm, with vertices at xyz [n][3]. */
smr_vec smr_landmark_foot(const smr_landmark_goals *g, uint32_t k, float *xyz);
/* The vector from the foot to the landmark, mm, with the vertices at their present positions. */
smr_vec smr_landmark_offset(const smr_landmark_goals *g, uint32_t k);
/* The goal of the foot of landmark k, mm from the shape's origin, without `more`. */
smr_vec smr_landmark_goal(const smr_landmark_goals *g, uint32_t k);
/* Weight of landmark k at vertex v: 1 at its triangle's corners, 0 at `reach` or farther in the start positions. */
float smr_landmark_hard_weight(const smr_landmark_goals *g, uint32_t k, uint32_t v);
int smr_landmark_binds(const smr_landmark_goals *g, uint32_t v); /* 1: a landmark is bound to vertex v */

/* Wendland's compactly supported covariance function: 1 at distance 0, 0 from distance 1 on (Wendland 1995). */
static inline float smr_wendland(float distance)
{
    const float left = smr_max(1.0f - distance, 0.0f), left2 = left * left;
    return left2 * left2 * (4.0f * distance + 1.0f);
}

/* ---- the field of occluded vertices ---- */

#define SMR_CONTROLS 64u          /* most controls whose displacement is known in all three directions */
#define SMR_FIELD_ROWS 192u       /* most controls whose displacement is known only along their normals */
#define SMR_FIELD_MOTIONS 7u      /* motions of a similarity: three shifts, three turns, one scale */
#define SMR_FIELD_TRIES 3u        /* number of tried roughnesses: shares of the kernel's short term */
#define SMR_TRY_TASKS 24u         /* tasks of each tried roughness */
#define SMR_FIELD_NOISE 0.003f    /* noise variance of a control, as a share of the field's variance */
#define SMR_FIELD_ROUNDED 1.0e-5f /* rounding error of a sum of SMR_FIELD_ROWS products, as a share of the variance */
#define SMR_FIELD_STEP 0.8f      /* share of the field's displacement that an iteration takes, controls along normals */
#define SMR_FIELD_FOLLOW 0.35f   /* SMR_FIELD_STEP while targets are tracked: new ones lack closest triangles */
#define SMR_FIELD_MEAN 0.1f      /* SMR_FIELD_STEP at the last radius: averages over controls of several iterations */
#define SMR_MOTION_VARIANCE 8.0f /* variance of motions / variance of the field; turns, scale at one kernel length */
#define SMR_CONTROLS_MAX (SMR_CONTROLS + SMR_LANDMARKS_MAX)

typedef struct smr_occluded_field {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    const smr_surface_goals *goals;
    const smr_landmark_goals *landmarks;
    const uint8_t *found;        /* [n] SMR_FOUND_... of the last complete forces */
    const uint32_t *has_image;   /* 1: structures without a target surface follow an image */
    const uint32_t *n_invisible; /* number of vertices that the image does not show */
    uint32_t most;               /* most controls that the memory holds */
    float *start;                /* [most][3] start positions of the controls, mm */
    float *coefficient;          /* [most][3] coefficients of the field; at first residuals after the pose, mm */
    float *lower;          /* [SMR_FACTOR_WORDS(most)] Cholesky factor, row by row; at first the chosen controls */
    float *noise_variance; /* [most] noise variance of each control */
    float *motion;         /* [most][SMR_FIELD_MOTIONS] displacement along a control's normal by each unit motion */
    float *whitened;       /* [most] residual i given those before, in standard deviations, in the current try */
    float *residual;       /* [most] residual along the normal, goal minus start in the pose, mm; then coefficients */
    float back[SMR_FIELD_MOTIONS]; /* motions from the pose to the start; then from the pose to the fitted place */
    smr_vec middle;                /* centre of turns and scale, mm */
    uint32_t sheet;                /* 1: the model is a sheet: only its borders determine its size */
    uint32_t by_normals;           /* 1: controls are known along their normals only. Set when controls are chosen */
    uint32_t n;                    /* controls in use, landmarks first; 0: no field */
    smr_pose pose;                 /* rigid pose from start to present positions of the controls */
    float per_length2;             /* 1 / l^2 of the kernel length l, 1 / mm^2 */
    float rough, per_rough2;       /* kernel's short term: variance, 0: no short term; 1 / l^2 of length l, 1 / mm^2 */
    float motion_variance;         /* variance of the motions divided by the field's variance */
    float rough_noise;             /* noise variance that the short term adds to each control */
    float likelihood;              /* largest log-likelihood of a roughness so far */
    uint32_t likeliest;            /* index of the roughness with this likelihood */
    float square, log; /* sums of the current try: of whitened residuals squared; of the factor's logarithms */
} smr_occluded_field;

/* ---- occluded_field_normals.c: controls along their normals ---- */

/* The visibility of a vertex in the target that the field follows, 0 .. SMR_VISIBLE_ONE. */
uint32_t smr_field_visibility(const smr_occluded_field *f, uint32_t v);
/* Returns 1 when controls are known along their normals only. */
uint32_t smr_field_normals_only(const smr_occluded_field *f);
/* Adds visible vertices at positions first .. last - 1 of an order of the model to n controls. Returns the new n. */
uint32_t smr_field_normals_choose(const smr_occluded_field *f, uint32_t first, uint32_t last, uint32_t *control,
                                  uint32_t n);
/* The share of the field's displacement that this iteration takes. */
float smr_field_normals_step(const smr_occluded_field *f);
/* Computes residuals along normals when the pose is fitted. control: stored vertices; middle: centre of turns, mm. */
void smr_field_normals_begin(smr_occluded_field *f, const uint32_t *control, smr_vec middle);
/* The covariance of two controls from the kernel between them. */
float smr_field_normals_between(const smr_occluded_field *f, uint32_t i, uint32_t j, float kernel);
void smr_field_normals_end(smr_occluded_field *f);    /* solves for the coefficients; adds the motions to the pose */
void smr_occluded_field_model(smr_occluded_field *f); /* sets `sheet`, once structures are known */

/* ---- occluded_field_covariance.c ---- */

/* The positions from which the field displaces, [n][3] mm: start, rest shape of tracking, or of the outdated image. */
float *smr_field_start(const smr_occluded_field *f);
int smr_field_hard(const smr_occluded_field *f, uint32_t k); /* 1: control k is a hard landmark */
/* The covariance of the field at a position with control k. sharp: includes the field of short range. */
float smr_field_with_control(const smr_occluded_field *f, smr_vec at, uint32_t k, int sharp);
/* The covariance of the observations of controls i and j, j <= i. */
float smr_occluded_field_between(const smr_occluded_field *f, uint32_t i, uint32_t j);
/* Tries each roughness in SMR_FIELD_TRIES * SMR_TRY_TASKS successive tasks, and sets the most likely one. */
void smr_field_roughness_try(smr_occluded_field *f, uint32_t task);

size_t smr_occluded_field_words(const smr_shared *shared); /* words of memory that the field needs during forces */
void smr_occluded_field_wire(smr_occluded_field *f,
                             const smr_overlay *overlay); /* places the arrays in smr_overlay.sum */

/* Returns 1 while images are tracked: an image determines nothing along a surface. */
static inline int smr_field_of_image(const smr_occluded_field *f)
{
    return SMR_HAS_PARTIAL && f->schedule->tracking && *f->has_image;
}

/* Returns 1 when the image shows a part of the model, whose vertices with a goal are visible. */
static inline int smr_field_of_part(const smr_occluded_field *f)
{
    return SMR_HAS_PARTIAL && *f->has_image && *f->n_invisible > 0u && f->goals->visibility != NULL;
}

/* Returns 1 when the tracked image is outdated. */
static inline int smr_field_of_past(const smr_occluded_field *f)
{
    return smr_field_of_image(f) && f->schedule->image_age == SMR_IMAGE_PAST;
}

/* Returns 1 when a surface shows a part of the vertex' structure and a current image shows the rest. */
static inline int smr_field_of_rest(const smr_occluded_field *f, uint32_t v)
{
    return SMR_HAS_PARTIAL && *f->has_image && !smr_field_of_past(f) &&
           smr_visibility_always_partial(f->goals, smr_model_owner(f->shared->model, v));
}

/* Step: chooses controls and solves the field. Skipped when no vertex is occluded. Tasks run one after the other. */
smr_count_tasks smr_occluded_field_tasks;
smr_run_task smr_occluded_field_solve;

/* The displacement from vertex v to the position that the field gives to v, mm. */
smr_vec smr_occluded_field_displacement(const smr_occluded_field *f, uint32_t v);
/* The share of that displacement that an iteration takes, mm: all of it where controls are known in all directions. */
smr_vec smr_occluded_field_follow(const smr_occluded_field *f, uint32_t v);
/* Adds the field's displacement along the surface to the goal's, mm, and averages with the field by visibility. */
void smr_occluded_field_blend(const smr_occluded_field *f, uint32_t v, int has_goal, smr_vec *displacement);
/* Averages the displacement of a vertex without a goal with the field. The field gets more weight as the nearest
 * landmark becomes nearer than the nearest visible control. */
void smr_occluded_field_fill(const smr_occluded_field *f, uint32_t v, smr_vec *displacement);
/* While images are tracked: a vertex with an image goal moves along the surface with the field, every other vertex
 * with the field alone. found: result of the image search. Returns SMR_NO_GOAL for an outlier. */
int smr_occluded_field_blend_image(const smr_occluded_field *f, uint32_t v, int found, smr_vec *displacement);
/* The largest weight of a hard landmark at a vertex, 0..1. */
float smr_occluded_field_hard_weight(const smr_occluded_field *f, uint32_t v);
/* Averages a displacement with the field by the weight of hard landmarks. */
void smr_occluded_field_blend_hard(const smr_occluded_field *f, uint32_t v, smr_vec *displacement);

/* Solves the field of landmarks alone. Returns the field's variance along an axis, mm^2; below 0: too few landmarks. */
float smr_landmark_field_solve(smr_occluded_field *f);
/* Returns the variance at a vertex given the landmarks, as a share of the field's variance. */
float smr_landmark_field_left(const smr_occluded_field *f, uint32_t v);

#endif
