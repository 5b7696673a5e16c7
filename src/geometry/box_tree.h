/* box_tree.h: a bounding-box tree over triangles in tree order (order by smr_mesh_order). Eight children a node; the
 * shape follows from the number of triangles alone (node k of a level holds nodes 8k .. 8k+7 of the level below),
 * so there is nothing to build but boxes, and a deformed mesh only needs its boxes again.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_BOX_TREE_H
#define SMR_BOX_TREE_H

#include "base/vec.h"

#define SMR_TREE_WIDTH 8u
#define SMR_TREE_LEVELS 9u /* 8^8 > SMR_TRIANGLES_MAX */
#define SMR_FAR 1.0e15f    /* where empty boxes lie; its square still is a float */

typedef struct smr_node {
    float lo[3][SMR_TREE_WIDTH]; /* boxes of the children; empty ones lie at +-SMR_FAR */
    float hi[3][SMR_TREE_WIDTH];
} smr_node;

/* Triangles with their tree: a view, the arrays are somebody else's. */
typedef struct smr_facets {
    const float *xyz;         /* [n vertices][3] */
    const uint32_t *triangle; /* [n_triangles][3], in tree order */
    float *normal;            /* [n_triangles][3], unit; zero for zero-area triangles */
    smr_node *node;           /* [smr_tree_nodes(n_triangles)], leaves first */
    const uint32_t *rank;     /* [n_triangles] among equally near triangles the smallest wins; NULL: tree order */
    uint32_t n_triangles;
    uint32_t n_levels;               /* 0 for no triangles */
    uint32_t level[SMR_TREE_LEVELS]; /* first node of each level */
} smr_facets;

/* Number of nodes for so many triangles. */
uint32_t smr_tree_nodes(uint32_t n_triangles);

/* Fills in n_triangles, n_levels and level[]. */
void smr_tree_shape(smr_facets *f, uint32_t n_triangles);

static inline uint32_t smr_tree_leaves(const smr_facets *f) { return smr_ceil_div(f->n_triangles, SMR_TREE_WIDTH); }

/* Recomputes normals, and boxes when there are nodes, of leaves first..last-1 from the positions. */
void smr_tree_refit_leaves(const smr_facets *f, uint32_t first, uint32_t last);

/* Recomputes the levels above the leaves. */
void smr_tree_refit_upper(const smr_facets *f);

typedef struct smr_query {
    smr_vec point;
    smr_vec normal;       /* unit or zero */
    float min_cos;        /* triangle normals agree at least so much; -2 for any */
    uint32_t node_budget; /* nodes opened at most */
    uint32_t warm;        /* a triangle to try first, or SMR_NONE */
} smr_query;

typedef struct smr_hit {
    float d2;          /* in: squared search distance; out: squared distance */
    uint32_t triangle; /* in tree order; SMR_NONE when nothing was found */
    float weight[3];
} smr_hit;

/* The closest acceptable point within hit->d2. hit is left as it was when there is none. */
void smr_tree_closest(const smr_facets *f, const smr_query *q, smr_hit *hit);

#define SMR_NEAR_MOST 24u /* triangles around a vertex, and some */

/* The triangles that are nearest, or nearly. */
typedef struct smr_near {
    float share; /* 0 .. 1 */
    float d2;
    uint32_t triangle;
    float weight[3];
} smr_near;

typedef struct smr_near_list {
    uint32_t n; /* 0 when nothing was found */
    float cut2; /* squared distance of the nearest that had no room, or that the budget left out */
    smr_near item[SMR_NEAR_MOST];
} smr_near_list;

/* The same, and all acceptable triangles that are farther by less than a tenth, or than the first that SMR_NEAR_MOST or the
 * node budget left out. Their shares add up to 1 and fall to 0 there, so that it does not matter which of two is nearer by a
 * last bit. */
void smr_tree_near(const smr_facets *f, const smr_query *q, smr_hit *hit, smr_near_list *list);

/* The point that weights name on a triangle. */
smr_vec smr_facet_point(const smr_facets *f, uint32_t triangle, const float weight[3]);

#endif
