/* surface.h: a target surface in the caller's memory, ready for closest-point search.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_H
#define SMR_SURFACE_H

#include "geometry/box_tree.h"

struct smr_surface {
    uint32_t magic; /* SMR_SURFACE_MAGIC */
    uint32_t n_vertices;
    uint32_t open;         /* 1 when some edge has only one triangle; a cloud is open, too */
    uint32_t capacity;     /* most points of a cloud (points.h); 0: a mesh */
    uint32_t changes;      /* of a cloud's points, so far */
    float area_mean;       /* mean of area[], mm^2 */
    smr_vec origin;        /* mm, whole numbers: centre of the bounding box; positions are relative to it */
    float *xyz;            /* [n_vertices][3] mm from origin, in the caller's order */
    float *normal;         /* [n_vertices][3] unit vertex normals */
    float *area;           /* [n_vertices] a third of the area of the adjacent triangles, mm^2 */
    uint32_t *triangle;    /* [n_triangles][3] vertex indexes, in tree order */
    uint32_t *original;    /* [n_triangles] the caller's index of each triangle */
    unsigned char *border; /* [n_triangles] bit k: edge k..k+1 is a border edge; bit 3+k: corner k lies on one */
    smr_facets facets;     /* the arrays above as a box tree */
};

#define SMR_SURFACE_MAGIC 0x736d7253u

/* 1 for a cloud of points: no triangles, so nothing is closest on it. */
static inline int smr_is_cloud(const smr_surface *s) { return s->capacity > 0u; }

/* 1 for a surface that smr_surface_build() has built. */
static inline int smr_surface_valid(const smr_surface *s) { return s != NULL && s->magic == SMR_SURFACE_MAGIC; }

/* 1 when the point with these barycentric weights on this triangle lies on a border edge. */
uint32_t smr_surface_on_border(const smr_surface *s, uint32_t triangle, const float weight[3]);

#endif
