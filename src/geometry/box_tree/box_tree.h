/* box_tree.h: a bounding-box tree over triangles, for closest-point search.
 * Triangles are in tree order (smr_mesh_order). Node k of a level holds nodes 8k .. 8k+7 of the level below, so the
 * tree's shape follows from the number of triangles alone, and a deformed mesh needs new boxes only.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_BOX_TREE_H
#define SMR_BOX_TREE_H

#include "geometry/box_tree/hilbert_curve.h"

#define SMR_TREE_WIDTH 8u  /* children of a node, and triangles of a leaf */
#define SMR_TREE_LEVELS 9u /* largest number of levels of a tree: 8^8 > SMR_TRIANGLES_MAX */

/* A node: the boxes of its eight children, mm. Empty children have all coordinates SMR_FAR. */
typedef struct smr_node {
    float lo[3][SMR_TREE_WIDTH], hi[3][SMR_TREE_WIDTH];
} smr_node;

/* A triangle mesh with its box tree: a view of arrays that belong to the caller. */
typedef struct smr_box_tree {
    const float *xyz;         /* [number of vertices][3] positions, mm */
    const uint32_t *triangle; /* [n_triangles][3] vertex indexes, in tree order */
    float *normal;            /* [n_triangles][3] unit normals of the triangles; 0 for zero-area triangles */
    smr_node *node;           /* [smr_tree_nodes(n_triangles)] nodes, leaves first; NULL: refits compute normals only */
    const uint32_t *rank;     /* [n_triangles] of equally close triangles the smallest rank wins; NULL: tree order */
    uint32_t n_triangles;
    uint32_t n_levels;               /* levels of the tree; 0 without triangles */
    uint32_t level[SMR_TREE_LEVELS]; /* index of each level's first node */
    uint32_t n_vertices;             /* number of vertices at xyz */
} smr_box_tree;

uint32_t smr_tree_nodes(uint32_t n_triangles); /* returns the number of nodes of the tree over n_triangles */
void smr_tree_shape(smr_box_tree *f, uint32_t n_triangles); /* sets n_triangles, n_levels and level[] */

/* Returns the root of a tree with triangles. */
static inline const smr_node *smr_tree_root(const smr_box_tree *f) { return &f->node[f->level[f->n_levels - 1u]]; }

/* Returns the number of leaves: nodes of the lowest level. */
static inline uint32_t smr_tree_leaves(const smr_box_tree *f) { return smr_ceil_div(f->n_triangles, SMR_TREE_WIDTH); }

/* Recomputes normals and, where f->node is not NULL, boxes of the leaves first .. last-1 from the positions. */
void smr_tree_refit_leaves(const smr_box_tree *f, uint32_t first, uint32_t last);
/* Recomputes the boxes of the nodes first .. last-1 above the leaves. All lower nodes must be recomputed already. */
void smr_tree_refit_nodes(const smr_box_tree *f, uint32_t first, uint32_t last);

/* Recomputes the boxes of all levels above the leaves. */
static inline void smr_tree_refit_upper(const smr_box_tree *f)
{
    smr_tree_refit_nodes(f, smr_tree_leaves(f), smr_tree_nodes(f->n_triangles));
}

/* The bit of child k in a set of children. A table, because not all compilers vectorise variable shifts. */
static const uint32_t smr_child_bit[SMR_TREE_WIDTH] = {1, 2, 4, 8, 16, 32, 64, 128};

smr_box smr_node_box(const smr_node *node); /* returns the box around all children of a node */

/* Writes the squared distance d2[k], mm^2, from p to each child box. Returns the children with d2 <= bound as bits. */
static inline uint32_t smr_box_distances(const smr_node *node, smr_vec p, float bound, float d2[SMR_TREE_WIDTH])
{
    uint32_t near = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        /* the box' point next to p is p with each coordinate limited to the box */
        const float x = p.x - smr_min(smr_max(p.x, node->lo[0][k]), node->hi[0][k]);
        const float y = p.y - smr_min(smr_max(p.y, node->lo[1][k]), node->hi[1][k]);
        const float z = p.z - smr_min(smr_max(p.z, node->lo[2][k]), node->hi[2][k]);
        const float sum = x * x + y * y + z * z;
        d2[k] = sum;
        near |= sum <= bound ? smr_child_bit[k] : 0u;
    }
    return near;
}

/* A node to be opened by a search. */
typedef struct smr_visit {
    float d2;              /* squared distance to the node's box, mm^2; 0 in searches without distances */
    uint32_t level, index; /* the node's level, and index in that level */
} smr_visit;

/* Pushes the children in the set `near` (a bit each) of a node onto the stack, the nearest last, but no empty children.
 * d2: squared distances of the children, mm^2; first: the node's first child. Returns the new height of the stack. */
static inline uint32_t smr_push_near(uint32_t near, const float d2[SMR_TREE_WIDTH], smr_visit first, smr_visit *stack,
                                     uint32_t height)
{
    const uint32_t bottom = height;
    for (; near != 0u; near &= near - 1u) {
        const uint32_t k = (uint32_t)__builtin_ctz(near);
        if (d2[k] >= SMR_FAR)
            continue;
        uint32_t at = height++;
        for (; at > bottom && stack[at - 1u].d2 < d2[k]; at--)
            stack[at] = stack[at - 1u];
        stack[at] = (smr_visit){d2[k], first.level, first.index + k};
    }
    return height;
}

/* Prefetch what a search reads first that tries triangle i; later, when that has been read, also its corners. */
static inline void smr_tree_ahead(const smr_box_tree *f, uint32_t i)
{
    if (i >= f->n_triangles)
        return;
    const float *const box = f->node[i / SMR_TREE_WIDTH].lo[0];
    for (uint32_t k = 0; k < sizeof(smr_node) / sizeof *box; k += 2u * SMR_TREE_WIDTH)
        __builtin_prefetch(box + k);
    __builtin_prefetch(f->normal + 3u * (size_t)i);
    __builtin_prefetch(f->triangle + 3u * (size_t)i);
}
static inline void smr_tree_ahead_corners(const smr_box_tree *f, uint32_t i)
{
    for (uint32_t c = 0; c < 3u && i < f->n_triangles; c++)
        __builtin_prefetch(f->xyz + 3u * (size_t)f->triangle[3u * (size_t)i + c]);
}

/* The input of a search for the closest triangle. */
typedef struct smr_query {
    smr_vec point;        /* position from which triangles are searched, mm */
    smr_vec normal;       /* unit normal at the position; 0: no normal */
    float min_cos;        /* smallest accepted cosine between `normal` and a triangle's normal; -2: accept all */
    uint32_t node_budget; /* largest number of nodes that the search opens */
    uint32_t warm;        /* triangle that the search tries first, or SMR_NONE */
} smr_query;

/* The result of a search for the closest triangle. */
typedef struct smr_hit {
    float d2;          /* in: squared search distance, mm^2; out: squared distance to the triangle */
    uint32_t triangle; /* number of the closest triangle in tree order; SMR_NONE when none was found */
    float weight[3];   /* barycentric weights of the closest point on the triangle */
} smr_hit;

/* Leaves triangles of group 0, and triangles of groups with a `use` of 0, out of a search. */
typedef struct smr_tree_mask {
    const unsigned char *group; /* [n_triangles] group of each triangle */
    const unsigned char *use;   /* [largest group + 1] not 0: the group is searched; NULL: all groups but 0 are */
} smr_tree_mask;

/* Returns 1 for a triangle that the mask leaves out. */
static inline int smr_tree_left_out(const smr_tree_mask *mask, uint32_t triangle)
{
    const unsigned char group = mask->group[triangle];
    return group == 0u || (mask->use != NULL && mask->use[group] == 0u);
}

struct smr_pause;

/* A lower bound of the distance to all triangles but the closest one. The next search from a point nearby ends at once
 * while no other triangle can be closer, and finds the triangle that a whole search would find. */
typedef struct smr_certainty {
    float slack_mm; /* how far beyond the closest triangle the search looks, so that other_mm is large; negative: the
                     * search seeks no other_mm and is cheaper */
    float
        other_mm; /* in: lower bound of the distance to all triangles but q->warm, accepted or not, mm; 0: unknown; out:
                     * lower bound of the distance to all triangles but hit->triangle, mm */
    uint32_t sure;           /* out: 1: q->warm is the closest triangle without a search; other_mm is as before */
    struct smr_pause *pause; /* limits the work of the search; NULL: no limit */
} smr_certainty;

#define SMR_NEAR_MOST 24u /* largest number of triangles in a smr_near_list: more than usually meet at a vertex */

/* A triangle nearly as close as the closest triangle. */
typedef struct smr_near {
    float share; /* weight of the triangle, 0 .. 1; all shares of a list add up to 1 */
    float d2;    /* squared distance from the searched position to the triangle, mm^2 */
    uint32_t triangle;
    float weight[3]; /* barycentric weights of the triangle's closest point */
} smr_near;

typedef struct smr_near_list {
    uint32_t n; /* number of triangles in the list; 0 when none was found */
    float cut2; /* squared distance, mm^2, of the nearest triangle that the list's size or the node budget left out */
    smr_near item[SMR_NEAR_MOST];
} smr_near_list;

/* Squared lower bounds, mm^2, of distances to triangles. */
typedef struct smr_bounds {
    float other2;               /* bound of all triangles tested or in skipped nodes, except the closest triangle */
    float lane[SMR_TREE_WIDTH]; /* bound of all nodes that were never pushed, for each child index */
    float best2;                /* bound of the closest triangle, found in a leaf; FLT_MAX: none */
    float reach2;               /* squared distance, mm^2, within which nodes are opened to bound other2 */
} smr_bounds;

#define SMR_ENDLESS UINT32_MAX /* value of smr_pause.left: work has no limit */

/* State of a search in progress, besides its stack. */
typedef struct smr_walk {
    uint32_t top;    /* number of nodes on the stack */
    uint32_t opened; /* number of opened nodes that could hold a closer triangle */
    uint32_t ties;   /* number of nodes taken off the stack that are as far away as the closest triangle so far */
    uint32_t beyond; /* number of nodes opened only for other2 */
    smr_hit warm;    /* the query's warm triangle, if measured */
    smr_bounds b;
} smr_walk;

/* A limit of work, in instructions of a Cortex-M7 at most, and the state of a search that stopped there. */
typedef struct smr_pause {
    uint32_t left;      /* work that may still be done; SMR_ENDLESS: no limit */
    uint32_t after;     /* work that must be left when a search ends, for the use of its result */
    uint32_t kept;      /* 1: work ended within a task, which the next call for it continues */
    uint32_t in_search; /* 1: work ended within a search; the members below are its state */
    smr_walk walk;
    smr_hit hit; /* the closest triangle so far */
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    smr_near_list list;
} smr_pause;

/* Subtracts `work` from the work that may still be done. */
static inline void smr_work(smr_pause *pause, uint32_t work)
{
    if (pause->left != SMR_ENDLESS)
        pause->left -= smr_min_u32(work, pause->left);
}

/* Updates *hit when q and the mask (NULL: none) accept triangle i, which is closer, or as close with a smaller rank. */
void smr_tree_try(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t i, smr_hit *hit);

/* Find the closest triangle within hit->d2 that q accepts, or leave *hit unchanged. mask NULL: no triangle is left out;
 * known NULL: no bound is known or wanted. Return 0 when known->pause ended the work, which the next call continues. */
int smr_tree_closest_but(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit,
                         smr_certainty *known);
static inline int smr_tree_closest(const smr_box_tree *f, const smr_query *q, smr_hit *hit)
{
    return smr_tree_closest_but(f, NULL, q, hit, NULL);
}

/* Finds the closest acceptable triangle, and all triangles less than a tenth farther and nearer than list->cut2. Shares
 * fall to 0 at that limit: rounding does not decide between equal distances. Returns as smr_tree_closest_but(). */
int smr_tree_near(const smr_box_tree *f, const smr_query *q, smr_hit *hit, smr_near_list *list, smr_certainty *known);
/* Returns the point, mm, of a triangle with these barycentric weights. */
smr_vec smr_triangle_point(const smr_box_tree *f, uint32_t triangle, const float weight[3]);
/* Writes order[n], the mesh's triangle indexes in tree order. Scratch: centre [n][3], key [n], tmp [2 n]. */
void smr_mesh_order(const smr_mesh *mesh, uint32_t *order, float *centre, uint32_t *key, uint32_t *tmp);

/* A sort into tree order in steps: smr_mesh_centres(), smr_order_start(), then smr_order_step() until it returns 1. */
typedef struct smr_order {
    const float *centre;                 /* [n][3] centres of triangles, times 3, mm */
    uint32_t *order, *key, *tmp, *count; /* [n] result; scratch: [n], [2 n], [SMR_SORT_BYTES] for n > SMR_SORT_SMALL */
    uint32_t n;
    uint32_t stack[2u * 3u * SMR_TREE_LEVELS + 2u], top; /* first and end of each range still to sort; entries in use */
    uint32_t first, size; /* first entry and size of the range being sorted; size 0: none */
    uint32_t stage, at;   /* SMR_ORDER_... stage of the range being sorted; entries done in that stage */
    float lo[3], hi[3];   /* box around the centres of the range */
} smr_order;

/* For each triangle k of first .. last-1 writes centre[k], the sum of its corners, mm, and order[k] = k. */
void smr_mesh_centres(const smr_mesh *mesh, float *centre, uint32_t *order, uint32_t first, uint32_t last);
void smr_order_start(smr_order *o, uint32_t n, const float *centre, uint32_t *order, uint32_t *key, uint32_t *tmp,
                     uint32_t *count);
/* Continues the sort for about `most` visits of triangles. Returns 1 when the order is complete. */
int smr_order_step(smr_order *o, uint32_t most);

#endif
