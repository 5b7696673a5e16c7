/* verdict_measures.h: measures of a result, on demand between iterations. In: the whole registration, unchanged but for
 * the memory of records and sums. Out: means over structures, from which the verdict follows.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VERDICT_MEASURES_H
#define SMR_VERDICT_MEASURES_H

#include "registration/registration.h"

typedef struct smr_mean {
    float sum, weight;
} smr_mean;

#define SMR_MEANS 11u /* means in smr_evidence */

/* Measures of a result. Fields are as in smr_verdict where names agree. */
typedef struct smr_evidence {
    union {
        struct {
            smr_mean visible, agree; /* over the model's area; with an image: over vertices */
            smr_mean covered;        /* over the target's area */
            smr_mean residual;       /* mm, mean over visible vertices */
            smr_mean goals;          /* mean over vertices, with an image */
            smr_mean similarity;     /* mean over comparisons */
            smr_mean strain2;        /* squared strain, mean over edges */
            smr_mean stretch2;       /* squared stretch, mean over parts */
            smr_mean volume;         /* volume ratio, weighted by rest volume */
            smr_mean bend, expected; /* mm, mean over vertices */
        };
        smr_mean mean[SMR_MEANS]; /* the same as a list */
    };
    float rotation_deg;
} smr_evidence;

_Static_assert(offsetof(smr_evidence, rotation_deg) == SMR_MEANS * sizeof(smr_mean), "the list names every mean");

static inline void smr_mean_add(smr_mean *m, float value, float weight)
{
    m->sum += value * weight;
    m->weight += weight;
}

static inline float smr_mean_of(smr_mean m, float otherwise) { return m.weight > 0.0f ? m.sum / m.weight : otherwise; }

/* Measures at surfaces and clouds. */
#define SMR_MEASURE_NODES 4096u /* most nodes that a search opens */
#define SMR_MEASURE_AGREE 0.0f  /* cosine between normals above which they agree */
#define SMR_MEASURE_EDGES 1.0f  /* distance up to which the target is covered, in mean edge lengths of the model */
#define SMR_MEASURE_TIMES 2.0f  /* the same distance over the mean residual; the larger one counts */

/* Adds a structure's residual to the measures. Returns the distance up to which its target is covered, mm. */
static inline float smr_add_residual(const smr *s, smr_mean residual, smr_evidence *e)
{
    const float edge = smr_max(smr_le_float(s->shared.model->edge_mm), 1.0e-6f);
    e->residual.sum += residual.sum;
    e->residual.weight += residual.weight;
    return smr_max(SMR_MEASURE_EDGES * edge, SMR_MEASURE_TIMES * smr_mean_of(residual, 0.0f));
}

/* Returns 1 when stored vertex v was visible in the target at the last judgement. */
int smr_vertex_visible(const smr *s, uint32_t v);

/* Returns 1 when a structure has neither surface nor image and follows landmarks. */
static inline int smr_follows_landmarks(const smr *s, uint32_t structure)
{
    const smr_forces *f = &s->forces;
    return f->landmarks.n > 0u && f->surface.target[structure].surface == NULL && !f->image.has_image;
}

/* Each function adds the measures of one structure. */
void smr_measure_shape(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_surface(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_points(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_image(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_landmarks(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_caller(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_expected(const smr *s, uint32_t structure, smr_evidence *e); /* also fills smr_vertex_expected() */
/* the same by the field through landmarks; -1 with too few of them */
void smr_measure_by_landmarks(const smr *s, uint32_t structure, smr_evidence *e);

/* The motion of a structure, or of the whole model: scale, scale_rest and turned_deg. */
void smr_measure_moved(const smr *s, uint32_t structure, smr_verdict *verdict);

/* Sets level and reasons from the measures. whole: 1 for the whole model, 0 for one of several structures. */
void smr_judge(smr_verdict *verdict, float edge_mm, int whole);

/* Per stored vertex, mm, in the memory of records, [n] each: distance to the target surface; expected error. */
static inline float *smr_vertex_distance(const smr *s) { return (float *)s->overlay.record; }
static inline float *smr_vertex_expected(const smr *s) { return (float *)s->overlay.record + s->shared.n; }

/* The displacement from the start as a Gaussian process: expected_error_field.c. */

#define SMR_OBSERVATIONS 64u /* most observations: visible vertices that the field is fitted to */

typedef struct smr_normal_field {
    const smr *s;
    float *at;         /* [n][3] start positions of the observed vertices, mm */
    float *normal;     /* [n][3] their normals in the start's frame */
    float *moved;      /* [n] observed displacement along the normal, mm */
    float *open;       /* [n] change of the coefficients by the variance of the motion from the start */
    float *lower;      /* Cholesky factor, row by row */
    uint32_t n;        /* number of observations; 0: too few */
    smr_vec middle;    /* middle of the structure's box at the start, mm */
    float motions;     /* variance of the motions over that of the displacement */
    float per_length2; /* 1 / l^2 of the kernel length l, 1 / mm^2 */
    float size2;       /* variance of the displacement along an axis, mm^2 */
    /* motion from the start to the pose of all visible vertices, in the start's frame: */
    smr_vec shift; /* of the middle, mm */
    smr_vec turn;  /* rotation about the middle, mm at a kernel length */
    float more;    /* variance of that motion's factor over the displacement's variance; 0: not used */
    float again;   /* factor on that motion that the field then has */
} smr_normal_field;

/* Solves the field of a structure in the memory of sums, which is free between iterations. */
void smr_normal_field_solve(smr_normal_field *f, const smr *s, uint32_t structure);

/* The standard deviation of the position of stored vertex v, mm. */
float smr_normal_field_error(const smr_normal_field *f, uint32_t v);

#endif
