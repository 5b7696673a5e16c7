/* model_lists.h: a radius of a model as plain arrays, for tests and baselines that sum in their own way.
 * SPDX-License-Identifier: MIT */
#ifndef MODEL_LISTS_H
#define MODEL_LISTS_H

#include "smr.h"

/* All numbers are stored vertices unless said otherwise. The arrays live until rig_free_all(). */
typedef struct rig_lists {
    uint32_t n;      /* vertices */
    float *xyz;      /* [n][3] rest shape, mm, in the caller's coordinates */
    uint32_t *owner; /* [n] structure */
    /* whole clusters, found by comparing all pairs of vertices: independent of the library's search */
    uint32_t *zeta_start; /* [n + 1] */
    uint32_t *zeta;       /* [zeta_start[n]] ascending */
    /* the chain as stored in the image, in its order */
    uint32_t *vertex;                   /* [n] */
    uint32_t *parent;                   /* [n] vertex whose sum comes first; itself for a root */
    uint32_t *plus_start, *minus_start; /* [n + 1] */
    uint32_t *plus, *minus;
} rig_lists;

/* Decodes radius number `radius`. A cluster holds the vertices with d <= radius, joined with mesh neighbours when
 * ring is not 0, and only those of its own structure when the model says so. With pairs 0 zeta is taken from the
 * chain instead, which is quick. */
rig_lists rig_decode(const smr_model *model, uint32_t radius, int ring, int pairs);

#endif
