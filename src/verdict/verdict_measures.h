/* verdict_measures.h: measures of a result, on demand between iterations. In: the whole registration, unchanged but for
 * the memory of records and sums. Out: means over structures, from which the verdict follows.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VERDICT_MEASURES_H
#define SMR_VERDICT_MEASURES_H

#include "registration/registration.h"

/* A weighted mean: sum of value times weight, and sum of weights. */
typedef struct smr_mean {
    float sum, weight;
} smr_mean;

#define SMR_MEANS 17u /* means in smr_evidence */

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

/* Returns 1 when the target showed stored vertex v at the last judgement of visibility. */
int smr_vertex_visible(const smr *s, uint32_t v);

/* Returns 1 when a structure follows landmarks and has neither a target surface nor an image. */
static inline int smr_follows_landmarks(const smr *s, uint32_t structure)
{
    const smr_forces *f = &s->forces;
    return f->landmarks.n > 0u && f->surface.target[structure].surface == NULL && !f->image.has_image;
}

/* Each function adds measures of one structure: of its shape against the rest shape; of its place on its target, with
 * all 0 only those that the expected errors need: residual and n_invisible. */
void smr_measure_shape(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_target(const smr *s, uint32_t structure, int all, smr_evidence *e);

/* Computes the expected errors of each vertex of a structure, smr_vertex_expected(), and adds their means. */
void smr_measure_expected(const smr *s, uint32_t structure, smr_evidence *e);

/* Measures the motion of a structure or of the whole model (SMR_ALL): scale, scale_rest and turned_deg. e: measures of
 * the structure, or of the last structure. */
void smr_measure_moved(const smr *s, uint32_t structure, const smr_evidence *e, smr_verdict *verdict);

/* Sets probability, level and reasons from the measures. whole: 1 for the whole model, 0 for one of several structures.
 * strays: share of a cloud's points that are outliers. */
void smr_judge(smr_verdict *verdict, float edge_mm, int whole, float strays);

/* Returns three values of stored vertex v, mm: expected error, its part across and its part along the surface; below 0:
 * unknown. The values lie in the memory of records behind the rings. */
static inline float *smr_vertex_expected(const smr *s, uint32_t v)
{
    return s->overlay.rings.displacement + 3u * ((size_t)s->shared.n + v);
}

#endif
