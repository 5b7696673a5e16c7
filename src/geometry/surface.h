/* surface.h: a target surface inside the caller's memory.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_H
#define SMR_SURFACE_H

#include "geometry/box_tree.h"

struct smr_surface {
    uint32_t magic;
    uint32_t n_vertices;
    uint32_t open;         /* 1 when some edge has one triangle only */
    float area_mean;       /* mm^2 per vertex */
    smr_vec origin;        /* whole mm: positions are relative to it, so that moving everything costs no digits */
    float *xyz;            /* [n_vertices][3] in the caller's order */
    float *normal;         /* [n_vertices][3] unit */
    float *area;           /* [n_vertices] a third of the triangles around, mm^2 */
    uint32_t *triangle;    /* [n_triangles][3] in tree order */
    uint32_t *original;    /* [n_triangles] the caller's index of each */
    unsigned char *border; /* [n_triangles] bit k: edge k..k+1 is a border; bit 3+k: corner k lies on one */
    smr_facets facets;
};

#define SMR_SURFACE_MAGIC 0x736d7253u

static inline int smr_surface_valid(const smr_surface *s) { return s != NULL && s->magic == SMR_SURFACE_MAGIC; }

/* 1 when the point that weight names on this triangle lies on a border edge. */
uint32_t smr_surface_on_border(const smr_surface *s, uint32_t triangle, const float weight[3]);

#endif
