/* evidence.h: what is measured of a result on demand, between iterations. In: the whole registration, unchanged but for
 * the memory of records and sums, which is free then. Out: means over structures, from which judge.c judges.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_EVIDENCE_H
#define SMR_EVIDENCE_H

#include "registration/registration.h"

/* A mean under way. */
typedef struct smr_mean {
    float sum, weight;
} smr_mean;

/* Fields are as in smr_verdict where they have its names. */
typedef struct smr_evidence {
    smr_mean seen, agree;    /* over the model's area; in an image: vertices */
    smr_mean covered;        /* over the target's area */
    smr_mean residual;       /* mm, over seen vertices */
    smr_mean goals;          /* over vertices, in an image */
    smr_mean likeness;       /* over comparisons */
    smr_mean strain2;        /* over edges */
    smr_mean stretch2;       /* over parts */
    smr_mean volume;         /* over rest volumes */
    smr_mean bend, expected; /* mm, over vertices */
    float rotation_deg;
} smr_evidence;

static inline void smr_mean_add(smr_mean *m, float value, float weight)
{
    m->sum += value * weight;
    m->weight += weight;
}

static inline float smr_mean_of(smr_mean m, float otherwise) { return m.weight > 0.0f ? m.sum / m.weight : otherwise; }

/* 1 where the target showed stored vertex v when that was last judged. */
int smr_vertex_seen(const smr *s, uint32_t v);

/* 1 where a structure has neither surface nor image and follows landmarks. */
static inline int smr_follows_landmarks(const smr *s, uint32_t structure)
{
    const smr_forces *f = &s->forces;
    return f->landmarks.n > 0u && f->surface.target[structure].surface == NULL && !f->image.has_image;
}

/* Each adds what one structure shows. */
void smr_measure_shape(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_surface(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_points(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_image(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_landmarks(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_caller(const smr *s, uint32_t structure, smr_evidence *e);
void smr_measure_expected(const smr *s, uint32_t structure, smr_evidence *e); /* fills smr_vertex_expected(), too */

/* How the whole of a structure, or of all, has moved: scale, scale_rest and turned_deg. */
void smr_measure_moved(const smr *s, uint32_t structure, smr_verdict *verdict);

/* Level and reasons, from the measures. whole: 1 for all of the model, 0 for a structure of several. */
void smr_judge(smr_verdict *verdict, float edge_mm, int whole);

/* In the memory of records, mm, by stored vertex, [n] each: distance to the target surface; expected error. */
static inline float *smr_vertex_away(const smr *s) { return (float *)s->overlay.record; }
static inline float *smr_vertex_expected(const smr *s) { return (float *)s->overlay.record + s->shared.n; }

#endif
