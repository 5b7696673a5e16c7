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

/* Returns 1 when visibilities of vertices are judged: their array exists. */
static inline int smr_visibility_on(const smr_surface_goals *g) { return SMR_HAS_PARTIAL && g->visibility != NULL; }

/* Returns 1 when the target is a cloud of points. */
static inline int smr_is_points(const smr_surface *target) { return SMR_HAS_PARTIAL && smr_is_cloud(target); }

void smr_visibility_start(smr_surface_goals *g); /* sets which of the present targets are partial */
/* Returns 1 when the target of a structure stays partial to the end, not only until vertices cover the target. */
int smr_visibility_always_partial(const smr_surface_goals *g, uint32_t structure);
/* Returns 1 when the visibility of a structure's vertices is judged in this iteration. */
int smr_visibility_judged(const smr_surface_goals *g, uint32_t structure);
/* Stores the visibility of v, from its closest point `hit` on the target or from the weight of points that reach v. */
void smr_visibility_judge(smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit,
                          smr_vec displacement);
void smr_visibility_judge_points(smr_surface_goals *g, uint32_t v, float weight);
void smr_visibility_note_view(smr_surface_goals *g); /* sets mean normals of the vertices counted below */
/* Returns the visibility of vertex v, 0..1. On a whole target the visibility is 1 with a goal, 0 without. */
float smr_visibility_of(const smr_surface_goals *g, uint32_t v, int has_goal);
/* Returns 1 when at most 70 % of the structure of v is visible, 0 from 90 % on, and values between. */
float smr_visibility_partial(const smr_surface_goals *g, uint32_t v);
/* Step: counts visibilities. When forces are complete, the next function stores visibilities and their numbers. */
smr_count_tasks smr_visibility_tasks;
smr_run_task smr_visibility_count;
void smr_visibility_commit(smr_surface_goals *g);

/* ---- clouds of points ---- */

/* State of the smoothing over the mesh of the pulls by a cloud's points. */
typedef struct smr_point_spread {
    const smr_shared *shared;
    const smr_shape *shape;
    smr_surface_goals *goals;
    smr_spread memory;
    uint32_t rounds;           /* number of smoothing rounds; grows while another one is needed */
    uint32_t n_reached;        /* number of vertices that pulls have reached in the current round */
    uint32_t n, n_smallest;    /* number of vertices of all structures with a cloud, and of the smallest one */
    float weight;              /* sum of the weights of all pulls */
    float along, pulls, steps; /* sums, mm^2: pulls times last displacements; squares of pulls; of last displacements */
} smr_point_spread;

/* Returns the mean of the smoothed pulls on v, mm, which is 0 where none reaches v. */
static inline smr_vec smr_points_goal(const smr_surface_goals *g, uint32_t v)
{
    const float *pull = g->spread + 4u * (size_t)v;
    return pull[3] > 0.0f ? smr_off_surface(g, v, smr_scale(smr_load(pull), 1.0f / pull[3])) : smr_v(0, 0, 0);
}

/* Functions for clouds in an iteration. Programs without smr_set_points(), which names them, link none. */
typedef struct smr_cloud_calls {
    /* writes the displacement of v to its goal and the distance to the points, mm, and stores v's visibility; returns 0
     * without a goal */
    int (*goal)(smr_surface_goals *g, uint32_t v, smr_vec *displacement, float *residual);
    smr_run_task *spread;                     /* runs a task of smr_point_spread_run() */
    int (*swings)(const smr_point_spread *p); /* returns 1 when momentum would make the model swing about the points */
    smr_run_task *compare;                    /* runs a task of smr_point_share_run() */
    void (*view)(smr_surface_goals *g);       /* sets mean normals of visible vertices, smr_target.view */
    uint64_t (*checksum)(const float *xyz, uint32_t n); /* returns the checksum of n points */
} smr_cloud_calls;

extern const smr_cloud_calls smr_clouds;

/* Step: smooths the pulls of clouds over the mesh. No tasks without a cloud. Tasks run one after the other. */
smr_count_tasks smr_point_spread_tasks;
smr_run_task smr_point_spread_run;
/* Step: sets the share of its goals that each cloud's points confirm. Tasks run one after the other. */
smr_count_tasks smr_point_share_tasks;
smr_run_task smr_point_share_run;

/* ---- landmarks ---- */

#define SMR_LANDMARK_NEAR 24u /* number of vertices whose motion turns the offset of a landmark off the surface */
#define SMR_HARD_EDGES 4.0f   /* range of a hard landmark around its triangle / mean edge length */

/* A landmark and the part of the model that it is bound to. */
typedef struct smr_bound_landmark {
    smr_landmark given;
    uint32_t corner[3]; /* stored vertices of the foot's triangle; for a landmark on a vertex, thrice that vertex */
    float share[3];     /* barycentric weights of the foot: the surface point closest to the landmark */
    smr_vec foot;       /* foot's rest position, mm from the model's centre */
    smr_vec offset;     /* vector from the foot to the landmark at rest, mm */
    smr_vec more;       /* displacement added to a hard landmark's goal, mm: clusters follow goals only in part */
    uint32_t n_near;    /* number of vertices in `near`; 0: the landmark lies on the surface */
    uint32_t near[SMR_LANDMARK_NEAR]; /* [n_near] stored vertices whose motion turns `offset` */
} smr_bound_landmark;

typedef struct smr_landmark_goals {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_bound_landmark *landmark; /* [config.partial.n_landmarks] landmarks; NULL: none can be set */
    uint32_t n;                   /* number of landmarks that are set */
    float reach;                  /* range of a hard landmark around the landmark's triangle, mm */
    uint8_t *visibility;          /* [number of vertices] visibility in the last search, 0 .. SMR_VISIBLE_ONE */
} smr_landmark_goals;

static inline int smr_landmarks_on(const smr_landmark_goals *g) { return SMR_HAS_PARTIAL && g->n > 0u; }

void smr_landmark_goals_layout(smr_arena *a, smr_landmark_goals *g, const smr_shared *shared);
void smr_landmark_keep(smr_landmark_goals *g, uint32_t k); /* after forces: sets `more` of a hard landmark */
/* sets `more` and a part of `visibility` to 0 */
void smr_landmark_goals_reset(smr_landmark_goals *g, uint32_t part, uint32_t parts);

/* Returns the foot of landmark k, mm, with the model's vertices at xyz[n][3]. */
smr_vec smr_landmark_foot(const smr_landmark_goals *g, uint32_t k, float *xyz);
/* Returns the vector from the foot to landmark k, mm, turned and scaled with the present positions of `near`. */
smr_vec smr_landmark_offset(const smr_landmark_goals *g, uint32_t k);
/* Returns the goal of the foot of landmark k, mm from the shape's origin, without the displacement `more`. */
smr_vec smr_landmark_goal(const smr_landmark_goals *g, uint32_t k);
/* Returns the share of the way to its goal that the foot of landmark k goes in an iteration: less than 1 where the
 * offset is longer than `near` reaches, since a small turn of `near` then moves the landmark farther than the foot. */
float smr_landmark_share(const smr_landmark_goals *g, uint32_t k);
/* Returns the weight of landmark k at vertex v: 1 at its triangle's corners, 0 from `reach` on, in start positions. */
float smr_landmark_hard_weight(const smr_landmark_goals *g, uint32_t k, uint32_t v);
int smr_landmark_binds(const smr_landmark_goals *g, uint32_t v); /* returns 1 if a landmark's foot depends on v */

/* Returns Wendland's compactly supported covariance: 1 at distance 0, 0 from distance 1 on (Wendland 1995). */
static inline float smr_wendland(float distance)
{
    const float left = smr_max(1.0f - distance, 0.0f), left2 = left * left;
    return left2 * left2 * (4.0f * distance + 1.0f);
}

/* ---- the field of occluded vertices ---- */

#define SMR_CONTROLS 64u          /* largest number of vertices as controls known in all three directions */
#define SMR_FIELD_ROWS 192u       /* largest number of controls known only along their normals */
#define SMR_FIELD_MOTIONS 7u      /* number of motions of a similarity: three shifts, three turns, one scale */
#define SMR_FIELD_TRIES 3u        /* number of variances of the kernel's short term that are tried */
#define SMR_TRY_TASKS 48u         /* number of tasks that try one roughness */
#define SMR_FIELD_NOISE 0.003f    /* noise variance of a control / variance of the field */
#define SMR_FIELD_ROUNDED 1.0e-5f /* rounding error of a sum of SMR_FIELD_ROWS products / variance */
#define SMR_FIELD_STEP 0.8f      /* with controls along normals: share of the field's displacement an iteration takes */
#define SMR_FIELD_FOLLOW 0.35f   /* share of the field's displacement an iteration takes while targets are tracked */
#define SMR_FIELD_MEAN 0.1f      /* share of the field's displacement that an iteration at the last radius takes */
#define SMR_MOTION_VARIANCE 8.0f /* variance of motions, as displacements at one kernel length / field's variance */
#define SMR_CONTROLS_MAX (SMR_CONTROLS + SMR_LANDMARKS_MAX)

typedef struct smr_occluded_field {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    const smr_surface_goals *goals;
    const smr_landmark_goals *landmarks;
    const uint8_t *found;        /* [n] result of each vertex' search, SMR_FOUND_..., in the last complete forces */
    const uint32_t *has_image;   /* 1: structures without a target surface follow an image */
    const uint32_t *n_invisible; /* number of vertices that the image does not show */
    uint32_t most;               /* largest number of controls that the memory holds */
    float *start;                /* [most][3] start positions of the controls, mm */
    float *coefficient;          /* [most][3] coefficients of the controls, mm; before: residuals after the pose */
    float *lower;          /* [SMR_FACTOR_WORDS(most)] rows of the Cholesky factor; before: the choice of controls */
    float *noise_variance; /* [most] noise variance of each control */
    float *motion;         /* [most][n_motions] displacement along a control's normal by each unit motion */
    float *whitened;       /* [most] residual i given those before, in standard deviations: the current try */
    float *residual;       /* [most] goal minus posed start along the normal, mm; after the solution: coefficient */
    uint32_t n_motions;    /* SMR_FIELD_MOTIONS, plus the number of references: each one's difference from the mean */
    float unit;            /* prior variance of a reference's weight / motion_variance, 1 / mm^2; 0: weights stay */
    float apart2;          /* sum of squares of the references' motions along normals at the controls, mm^2 */
    float back[SMR_FIELD_MOTIONS]; /* motions from the pose to the start; after the fit, to the fitted pose */
    smr_vec middle;                /* centre of the motions' turns and scale, mm */
    uint32_t sheet;                /* 1: the model is a sheet, whose area vectors do not cancel */
    uint32_t by_normals;           /* 1: the chosen controls are known along their normals only */
    uint32_t n;                    /* number of controls in use, landmarks first; 0: no field */
    smr_fit fit;                   /* sums over the controls, of which the pose follows */
    smr_pose pose;                 /* pose that fits the controls' start positions to present ones */
    float per_length2;             /* 1 / (length of the kernel)^2, 1 / mm^2 */
    float rough, per_rough2;       /* kernel's short term: variance, 0: none; 1 / length^2, 1 / mm^2 */
    float motion_variance;         /* variance of the seven motions / variance of the field */
    float rough_noise;             /* noise variance that the short term adds to each control */
    float likelihood;              /* 2 log2(likelihood) of the likeliest variance of the short term tried so far */
    uint32_t likeliest;            /* index of the likeliest variance of the short term tried so far */
    float square, log;             /* sums in the current try: whitened^2; -2 log2(diagonal of the factor) */
} smr_occluded_field;

/* ---- occluded_field_normals.c: controls along their normals ---- */

/* Returns the visibility of vertex v in the target that the field follows, 0 .. SMR_VISIBLE_ONE. */
uint32_t smr_field_visibility(const smr_occluded_field *f, uint32_t v);
/* Returns 1 when goals fix controls only along their normals: no landmark, tracked image or sheet, a partial target. */
uint32_t smr_field_normals_only(const smr_occluded_field *f);
/* Appends visible vertices at positions first .. last - 1 of a spread order to control[n]. Returns the new n. */
uint32_t smr_field_normals_choose(const smr_occluded_field *f, uint32_t first, uint32_t last, uint32_t *control,
                                  uint32_t n);
/* Returns the share of the field's displacement that vertices take in this iteration, with controls along normals. */
float smr_field_normals_step(const smr_occluded_field *f);
/* After the fit of the pose: sets the motions to the start; middle: box centre, mm. Then computes residuals along the
 * normals of controls first .. last - 1, stored vertices control[]. */
void smr_field_normals_begin(smr_occluded_field *f, smr_vec middle);
void smr_field_normals_residuals(smr_occluded_field *f, const uint32_t *control, uint32_t first, uint32_t last);
/* Returns the covariance of displacements along the normals of controls i and j from the kernel between them. */
float smr_field_normals_between(const smr_occluded_field *f, uint32_t i, uint32_t j, float kernel);
/* Returns a start position in the pose that fits the controls, mm. */
smr_vec smr_field_posed(const smr_occluded_field *f, smr_vec at);
void smr_field_normals_end(smr_occluded_field *f); /* computes coefficients; applies the motions to the pose */
/* Adds twice the area vectors and areas at rest of triangles first .. last - 1 to the sums. */
void smr_occluded_field_add(const smr_shared *shared, uint32_t first, uint32_t last, smr_vec *sum, float *areas);
/* Sets `sheet` from the sums over all triangles: lengths of the structures' area vectors, and areas. */
void smr_occluded_field_model(smr_occluded_field *f, float open, float areas);

/* ---- occluded_field_covariance.c ---- */

/* Returns positions [n][3], mm, that the field displaces: start, tracking's rest shape, or at the outdated image. */
float *smr_field_start(const smr_occluded_field *f);
int smr_field_hard(const smr_occluded_field *f, uint32_t k); /* returns 1 for a hard landmark */
/* Returns the covariance of the field at a position with control k. sharp: 1: includes hard landmarks' short field. */
float smr_field_with_control(const smr_occluded_field *f, smr_vec at, uint32_t k, int sharp);
/* Returns the covariance of the values known at controls i and j, j <= i, without noise. */
float smr_occluded_field_between(const smr_occluded_field *f, uint32_t i, uint32_t j);
/* Runs one of SMR_FIELD_TRIES * SMR_TRY_TASKS tasks that try each roughness. The last task sets the likeliest one. */
void smr_field_roughness_try(smr_occluded_field *f, uint32_t task);

size_t smr_occluded_field_words(const smr_shared *shared); /* returns 32-bit words that the field needs */
/* Places the field's arrays in overlay->sum. */
void smr_occluded_field_wire(smr_occluded_field *f, const smr_overlay *overlay);

/* Returns 1 while images are tracked, which do not hold a structure along its surface. */
static inline int smr_field_of_image(const smr_occluded_field *f)
{
    return SMR_HAS_PARTIAL && f->schedule->tracking && *f->has_image;
}

/* Returns 1 when the image shows only a part of the model: vertices with a goal then count as visible. */
static inline int smr_field_of_part(const smr_occluded_field *f)
{
    return SMR_HAS_PARTIAL && *f->has_image && *f->n_invisible > 0u && f->goals->visibility != NULL;
}

/* Returns 1 when the tracked image is outdated: other targets have changed since. */
static inline int smr_field_of_past(const smr_occluded_field *f)
{
    return smr_field_of_image(f) && f->schedule->image_age == SMR_IMAGE_PAST;
}

/* Returns 1 when a surface shows a part of v's structure and a current image shows the rest. */
static inline int smr_field_of_rest(const smr_occluded_field *f, uint32_t v)
{
    return SMR_HAS_PARTIAL && *f->has_image && !smr_field_of_past(f) &&
           smr_visibility_always_partial(f->goals, smr_model_owner(f->shared->model, v));
}

/* Step: chooses controls and solves for the field's coefficients. No tasks if all is visible. Tasks run in order. */
smr_count_tasks smr_occluded_field_tasks;
smr_run_task smr_occluded_field_solve;

/* Returns the displacement from vertex v to the position that the field gives to v, mm. */
smr_vec smr_occluded_field_displacement(const smr_occluded_field *f, uint32_t v);
/* Returns the part of v's displacement by the field that an iteration takes, mm; all if controls are known fully. */
smr_vec smr_occluded_field_follow(const smr_occluded_field *f, uint32_t v);
/* Adds the field's displacement along the surface to *displacement, mm, and averages with the field by visibility. */
void smr_occluded_field_blend(const smr_occluded_field *f, uint32_t v, int has_goal, smr_vec *displacement);
/* Averages *displacement, mm, of a vertex without a goal, with the field's, whose weight is c / (c + l). c, l: squared
 * distances to the nearest visible control and to the nearest landmark. */
void smr_occluded_field_fill(const smr_occluded_field *f, uint32_t v, smr_vec *displacement);
/* While images are tracked: a vertex with an image goal moves along the surface with the field, every other vertex
 * with the field alone. found: result of the image search. Returns SMR_NO_GOAL for an outlier. */
int smr_occluded_field_blend_image(const smr_occluded_field *f, uint32_t v, int found, smr_vec *displacement);
/* Returns the largest weight, 0..1, that a hard landmark has at vertex v. */
float smr_occluded_field_hard_weight(const smr_occluded_field *f, uint32_t v);
/* Averages *displacement of v, mm, with the field's, which gets the largest weight of a hard landmark at v. */
void smr_occluded_field_blend_hard(const smr_occluded_field *f, uint32_t v, smr_vec *displacement);

/* Solves the field of the landmarks alone. Returns its variance along one axis, mm^2; -1: too few landmarks. */
float smr_landmark_field_solve(smr_occluded_field *f);
/* Returns the variance that is left at vertex v once the landmarks are known / the field's variance, 0..1. */
float smr_landmark_field_left(const smr_occluded_field *f, uint32_t v);

#endif
