/* surface.h: a target surface in the caller's memory, ready for closest-point search.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_H
#define SMR_SURFACE_H

#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/box_tree/box_tree.h"
#include "geometry/surface/mesh.h"

/* Where building or refitting stands, and what only that needs. */
typedef struct smr_surface_work {
    smr_mesh mesh;                   /* the caller's; of a refit: its positions, and the surface's triangles */
    uint32_t stage, at;              /* stage of the list, and how far it is */
    uint32_t refit;                  /* 1: positions only */
    uint32_t *index;                 /* of a cloud's copy: [n][3], triangle k is point k; NULL: a mesh */
    const struct smr_surface *cloud; /* its normals and weights */
    uint32_t changes;                /* of the cloud, when this began */
    smr_box box;                     /* around the vertices so far */
    float area;                      /* of the surface so far, mm^2 */
    smr_order order;
    float *middle;       /* [n_triangles][3] centres of triangles */
    uint32_t *key, *tmp; /* [n_triangles], [2 n_triangles] */
    uint32_t *start;     /* [n_vertices + 1] triangles around vertices; then a flag a vertex; then a triangle of each */
    uint32_t *around;    /* [at least 3 n_triangles] */
} smr_surface_work;

struct smr_surface {
    uint32_t magic; /* SMR_SURFACE_MAGIC; SMR_SURFACE_BUSY while it is built or refitted */
    uint32_t n_vertices;
    uint32_t open;    /* 1 when some edge has only one triangle, besides scraps; a cloud is open, too */
    uint32_t n_used;  /* vertices with triangles that are no scraps */
    uint32_t n_stray; /* triangles of scraps: they show nothing (surface_strays.c) */
    uint32_t n_stray_vertices;
    uint32_t capacity;     /* most points of a cloud (points.h); 0: a mesh */
    uint32_t changes;      /* of a cloud's points, or refits of a mesh, so far */
    float area_mean;       /* mean of area[], mm^2 */
    smr_vec origin;        /* mm, whole numbers: centre of the bounding box; positions are relative to it */
    float *xyz;            /* [n_vertices][3] mm from origin, in the caller's order */
    float *normal;         /* [n_vertices][3] unit vertex normals */
    float *area;           /* [n_vertices] a third of the area of the adjacent triangles, mm^2; 0 of scraps */
    uint32_t *triangle;    /* [n_triangles][3] vertex indexes, in tree order */
    uint32_t *original;    /* [n_triangles] the caller's index of each triangle */
    unsigned char *border; /* [n_triangles] bit k: edge k..k+1 is a border edge; bit 3+k: corner k lies on one;
                            * SMR_SKIPPED: of a scrap */
    smr_facets facets;     /* the arrays above as a box tree */
    smr_surface_work work;
};

#define SMR_SURFACE_MAGIC 0x736d7253u
#define SMR_SURFACE_BUSY 0x736d7262u

/* 1 for a cloud of points: no triangles, so nothing is closest on it. */
static inline int smr_is_cloud(const smr_surface *s) { return s->capacity > 0u; }

/* cloud_copy.c: stages of building a cloud's copy. */
int smr_cloud_index(smr_surface *s, uint32_t first, uint32_t last);
int smr_cloud_copy(smr_surface *s, uint32_t first, uint32_t last);

/* 1 for a surface that is complete. */
static inline int smr_surface_valid(const smr_surface *s) { return s != NULL && s->magic == SMR_SURFACE_MAGIC; }

/* 1 for a vertex of a scrap. */
static inline int smr_surface_stray(const smr_surface *s, uint32_t v)
{
    return s->n_stray > 0u && s->work.start[v] != SMR_NONE && (s->border[s->work.start[v]] & SMR_SKIPPED) != 0u;
}

/* The closest acceptable triangle that is no scrap. */
static inline void smr_surface_search(const smr_surface *s, const smr_query *q, smr_hit *hit)
{
    smr_tree_closest_but(&s->facets, s->n_stray > 0u ? s->border : NULL, q, hit);
}

/* Stages of a build that find scraps; the last one belongs to a refit, too. */
int smr_strays_forget(smr_surface *s, uint32_t first, uint32_t last); /* vertices */
int smr_strays_join(smr_surface *s, uint32_t first, uint32_t last);   /* triangles */
int smr_strays_sum(smr_surface *s, uint32_t first, uint32_t last);
int smr_strays_mark(smr_surface *s, uint32_t first, uint32_t last);
int smr_strays_release(smr_surface *s, uint32_t first, uint32_t last); /* vertices */

/* 1 when the point with these barycentric weights on this triangle lies on a border edge. */
uint32_t smr_surface_on_border(const smr_surface *s, uint32_t triangle, const float weight[3]);

#endif
