/* verdict_measures.h: measures of a result, on demand between iterations. In: the whole registration, unchanged but for
 * the memory of records and sums. Out: means over structures, from which the verdict follows. The stages of the job run
 * for one structure after the other.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VERDICT_MEASURES_H
#define SMR_VERDICT_MEASURES_H

#include "registration/measure_job.h"

/* A weighted mean: sum of value times weight, and sum of weights. */
typedef struct smr_mean {
    float sum, weight;
} smr_mean;

#define SMR_MEANS 18u /* means in smr_evidence */

/* Measures of a result. Fields are as in smr_verdict where names agree. */
typedef struct smr_evidence {
    union {
        struct {
            smr_mean visible, agree; /* visible share of the model's area; share with normals like the target's */
            smr_mean covered;        /* covered share of the target's area */
            smr_mean others;         /* share of the target's area in bodies that the model does not reach */
            smr_mean strays;         /* share of a cloud's points that are outliers */
            smr_mean residual;       /* distance of visible vertices to the target, mm */
            smr_mean goals;          /* share of vertices with a goal in an image */
            smr_mean similarity;     /* comparisons won minus lost, mean over all in an image */
            smr_mean strain2;        /* squared strain, mean over edges */
            smr_mean stretch2;       /* squared stretch, mean over parts */
            smr_mean volume;         /* volume ratio, weighted by rest volume */
            smr_mean bend, expected; /* standard deviation of the displacement; expected error, mm */
            smr_mean across, along;  /* expected error across the surface and along it, mm */
            smr_mean on_visible;     /* expected error of visible vertices, mm */
            smr_mean strange;        /* distance from the subjects' blends / distance between subjects */
            smr_mean hidden;         /* expected error where the image does not show the model, mm */
        };
        smr_mean mean[SMR_MEANS]; /* all means as a list */
    };
    float scale_rest;     /* scale of the similarity from the rest shape to the present positions */
    float rotation_deg;   /* largest rotation of a part against the whole structure, degrees */
    uint32_t n_invisible; /* vertices that the image does not show */
} smr_evidence;

_Static_assert(offsetof(smr_evidence, scale_rest) == SMR_MEANS * sizeof(smr_mean), "the list names every mean");

static inline void smr_mean_add(smr_mean *m, float value, float weight)
{
    m->sum += value * weight;
    m->weight += weight;
}

static inline float smr_mean_of(smr_mean m, float otherwise) { return m.weight > 0.0f ? m.sum / m.weight : otherwise; }

#define SMR_OBSERVATIONS 64u /* most observations: visible vertices that the field is fitted to */

/* Terms of an observation in its covariances with other positions. */
typedef struct smr_terms {
    smr_vec turn; /* vector from the middle, in kernel lengths, cross normal */
    float scale;  /* that vector . normal */
    float more;   /* smr_normal_field.more times the motion from the start . normal */
} smr_terms;

/* A vertex' expected error follows from the displacement from the start as a Gaussian process, observed along normals
 * (expected_error.c). */
typedef struct smr_normal_field {
    smr_terms *term;  /* [n] in the memory of records behind the expected errors */
    float *at;        /* [n][3] start positions of the observed vertices, mm */
    float *normal;    /* [n][3] normals of the observed vertices in the start's frame */
    float *moved;     /* [n] observed displacement along the normal, mm */
    float *open;      /* [n] change of the coefficients by the variance of the motion from the start */
    float *lower;     /* Cholesky factor of the observations' covariance, row by row */
    uint32_t most, n; /* largest number of observations; number of observations, 0: too few */
    uint32_t total;   /* number of observed vertices */
    union {
        uint32_t met;  /* number of those that the choice of observations has met */
        float marked2; /* then: mean squared distance of landmarks beside a target to their goals, mm^2 */
    };
    uint32_t round;    /* number of rounds that have found size2 */
    float noise2;      /* measured noise variance, mm^2 */
    float noise;       /* noise variance along a normal / size2 */
    float along;       /* variance along the surface / process' variance */
    float across2;     /* variance by noise across the surface, mm^2 */
    smr_pose pose;     /* rigid pose that moves the start onto all visible vertices */
    int image_part;    /* 1: an image shows a part of the structure */
    smr_vec middle;    /* middle of the structure's box at the start, mm */
    float motions;     /* variance of shift, turn and scale / variance of the displacement */
    float per_length2; /* 1 / l^2 of the kernel length l, 1 / mm^2 */
    float size2;       /* variance of the displacement along an axis, mm^2 */
    smr_vec shift;     /* motion from the start to the pose of all visible vertices: shift of the middle, mm */
    smr_vec turn;      /* motion from the start to that pose: rotation about the middle, mm at a kernel length */
    float more;        /* variance of a factor on the motion from the start / size2; 0: not used */
    float again;       /* factor on the motion from the start, as the observations give it */
} smr_normal_field;

/* What shows a structure's place; SMR_BY_MEMORY: an earlier call left the results, which are only copied. */
enum { SMR_BY_NOTHING = 0, SMR_BY_SURFACE, SMR_BY_CLOUD, SMR_BY_IMAGE, SMR_BY_LANDMARKS, SMR_BY_CALLER, SMR_BY_MEMORY };

#define SMR_JUDGE_PIECE 192u /* vertices or triangles in a task that visits them */
#define SMR_JUDGE_PLACES 23u /* tasks whose results wait to be added */

/* A verdict, or expected errors, in progress. */
typedef struct smr_judgement {
    smr_measuring job;
    const smr *s;
    uint32_t asked;       /* structure that the call names, or SMR_ALL */
    uint32_t structure;   /* structure that is measured now */
    uint32_t by;          /* SMR_BY_...: what shows the structure */
    uint32_t n_listed;    /* number of vertices in smr_judged_list() so far */
    smr_verdict *verdict; /* the caller's; NULL: expected errors */
    float *mm[3];         /* the caller's arrays: expected errors, parts across, parts along; NULL: not wanted */
    smr_evidence e, all;  /* measures of the structure; sums over all structures so far */
    float n, n_doubtful;  /* number of vertices in judged structures, and in those that are not good */
    smr_pose first;       /* pose `start` of the first judged structure */
    float apart;          /* smallest cosine between the rotations of `first` and of the pose of another structure */
    smr_fit fit;          /* sums of the fit in progress */
    smr_box box;          /* box around the structure's rest or start positions visited so far, mm */
    smr_pose rest, start; /* similarity from rest, and from the start, to present positions */
    smr_mean residual;    /* residual of the structure so far, mm */
    float volume[3];      /* six times the volume now and at rest, mm^3; twice the area at rest, mm^2 */
    smr_vec areas;        /* twice the sum of area vectors at rest, mm^2 */
    float near;           /* distance up to which the target counts as covered, mm */
    smr_mean mean;        /* a mean in progress */
    smr_normal_field field;
    float bend2; /* variance of the displacement along an axis, mm^2: the square of the bend; below 0: unknown */
    smr_occluded_field through; /* a copy of the field, which landmarks solve: the memory is free, the original stays */
    smr_mean place[SMR_JUDGE_PLACES][3]; /* results of tasks */
} smr_judgement;

_Static_assert(sizeof(smr_judgement) <= SMR_JOB_BYTES, "a verdict in progress lies in the caller's job");

static inline const smr_shape_structure *smr_judged(const smr_judgement *j)
{
    return &j->s->shape.structure[j->structure];
}

/* Return the vertices or triangles of a structure in task `task`, and the stored vertex i of the structure. */
static inline smr_piece smr_judged_vertices(const smr_judgement *j, uint32_t task)
{
    return smr_piece_of(task, SMR_JUDGE_PIECE, smr_judged(j)->n_vertices);
}
static inline smr_piece smr_judged_triangles(const smr_judgement *j, uint32_t task)
{
    return smr_piece_of(task, SMR_JUDGE_PIECE, smr_judged(j)->tree.n_triangles);
}
static inline uint32_t smr_judged_vertex(const smr_judgement *j, uint32_t i)
{
    return smr_model_position(j->s->shared.model, smr_judged(j)->first_vertex + i);
}

/* Returns 1 when a call before left the expected errors in memory. */
static inline int smr_knows_expected(const smr_judgement *j) { return j->s->judged_turn == j->job.turn; }

/* Returns the surface or cloud that the structure is registered to; NULL: none. */
static inline const smr_surface *smr_judged_target(const smr_judgement *j)
{
    return j->s->forces.surface.target[j->structure].surface;
}

#define SMR_JUDGE_WORDS 7u /* words a vertex of the memory of records before smr_vertex_expected() */

/* Return arrays [n] of stored vertices: distance to the target surface, mm, SMR_FAR: none; the closest triangle of the
 * target, SMR_NONE: none. */
static inline float *smr_judged_distance(const smr_judgement *j) { return (float *)j->s->overlay.record; }
static inline uint32_t *smr_judged_nearest(const smr_judgement *j) { return j->s->overlay.record + j->s->shared.n; }

/* Returns the place of a task's results, emptied. */
static inline smr_mean *smr_judge_place(smr_judgement *j, uint32_t task)
{
    memset(j->place[task % SMR_JUDGE_PLACES], 0, sizeof j->place[0]);
    return j->place[task % SMR_JUDGE_PLACES];
}

/* Adds result k of the tasks first .. last-1 to a mean. */
static inline void smr_judge_take(const smr_judgement *j, uint32_t first, uint32_t last, uint32_t k, smr_mean *to)
{
    for (uint32_t task = first; task < last; task++) {
        to->sum += j->place[task % SMR_JUDGE_PLACES][k].sum;
        to->weight += j->place[task % SMR_JUDGE_PLACES][k].weight;
    }
}

/* Returns the stored vertices [n_vertices] of the structure, ascending: neighbours are mostly near each other. */
static inline uint32_t *smr_judged_list(const smr_judgement *j)
{
    return j->s->overlay.record + 14u * (size_t)j->s->shared.n;
}

#define SMR_JUDGED_VISIBLE 1u /* the vertex is visible */
#define SMR_JUDGED_POINT 2u   /* the vertex is the nearest corner to a point of a cloud */

/* Returns the array [n] of SMR_JUDGED_... of the structure's vertices; the memory of records ends behind it. */
static inline unsigned char *smr_judged_visible(const smr *s)
{
    return (unsigned char *)(s->overlay.record + 15u * (size_t)s->shared.n);
}

/* Returns 1 when the target showed stored vertex v at the last judgement of visibility. */
int smr_vertex_visible(const smr *s, uint32_t v);

/* Returns 1 when a structure follows landmarks and has neither a target surface nor an image. */
static inline int smr_follows_landmarks(const smr *s, uint32_t structure)
{
    const smr_forces *f = &s->forces;
    return f->landmarks.n > 0u && f->surface.target[structure].surface == NULL && !f->image.has_image;
}

/* Fits the similarity from the rest shape, or from the start, to the present positions of n vertices from `first` on,
 * in the caller's order, piece by piece. The last piece sets j->rest or j->start. */
void smr_fit_piece(smr_judgement *j, uint32_t task, uint32_t first, uint32_t n, int from_start);

typedef void smr_take_results(void *job, uint32_t first, uint32_t last);

/* verdict_shape_measures.c: stages that measure a structure's shape against the rest shape. */
smr_count_tasks smr_rest_fit_tasks, smr_edges_tasks, smr_parts_tasks, smr_parts_abreast;
smr_run_task smr_rest_fit_add, smr_edges_measure, smr_parts_add;
smr_take_results smr_parts_take;

/* verdict_references.c: stage that compares a structure's shape with those of the model's several subjects. */
smr_count_tasks smr_blend_tasks;
smr_run_task smr_blend_measure;

/* Returns the cosine of the angle between the rotations of two poses, each of which may have a scale. */
float smr_cosine_between(const smr_pose *a, const smr_pose *b);

/* Measures the motion of a structure or of the whole model (SMR_ALL): scale, scale_rest and turned_deg, from j->start,
 * and for a whole model of several structures j->rest. e: measures of the structure, or of the last structure. */
void smr_measure_moved(const smr_judgement *j, uint32_t structure, const smr_evidence *e, smr_verdict *verdict);

/* verdict_target_measures.c, verdict_vertex_measures.c: stages that measure a structure on its target; for expected
 * errors only what these need: residual and n_invisible. */
void smr_target_begin(smr_judgement *j);
smr_count_tasks smr_list_tasks, smr_visible_tasks, smr_distances_tasks, smr_cloud_tasks, smr_profiles_tasks;
smr_count_tasks smr_vertices_tasks, smr_triangles_measure_tasks, smr_cover_tasks, smr_points_tasks;
smr_count_tasks smr_places_abreast;
smr_run_task smr_list_vertices, smr_visible_find, smr_distances_find, smr_cloud_measure, smr_profiles_compare;
smr_run_task smr_vertices_measure, smr_triangles_measure, smr_cover_measure, smr_points_measure;
smr_take_results smr_cloud_take, smr_profiles_take, smr_triangles_take, smr_cover_take, smr_points_take;

/* expected_error.c, expected_error_observations.c: stages that compute the expected errors of each vertex,
 * smr_vertex_expected(), and add their means. */
smr_count_tasks smr_observed_tasks, smr_noise_tasks, smr_noise_rings_tasks, smr_factor_tasks, smr_round_tasks;
smr_count_tasks smr_marks_tasks, smr_errors_tasks, smr_errors_add_tasks;
smr_run_task smr_observed_count, smr_observe, smr_field_begin, smr_noise_begin, smr_noise_rings_add, smr_noise_add;
smr_run_task smr_marks_observe;
smr_run_task smr_factor_rows, smr_round_end, smr_errors_find, smr_errors_add;

/* Sets probability, level and reasons from the measures. whole: 1 for the whole model, 0 for one of several structures.
 * strays: share of a cloud's points that are outliers; below 0: no cloud.
 * misfit: 0..1, part of the residual that is not noise. */
void smr_judge(smr_verdict *verdict, float edge_mm, int whole, float strays, float misfit);

/* Returns three values of stored vertex v, mm: expected error, its part across and its part along the surface; below 0:
 * unknown. The values lie in the memory of records behind the rings. */
static inline float *smr_vertex_expected(const smr *s, uint32_t v)
{
    return s->overlay.rings.displacement + 3u * ((size_t)s->shared.n + v);
}

#endif
