/* carry.h: the map from the rest shape's space to the space of the deformed model.
 *
 * F(p) = T(p) + sum of c_k(p) (x_k - T(r_k)). r_k and x_k are the rest and the present position of a vertex near p,
 * and T is a similarity that fits the whole model. The coefficients c_k depend on the rest shape alone: those of
 * simple kriging (a Gaussian process' mean) with a smooth and a rough part of the covariance. A bound point costs
 * one sum of at most SMR_CARRY_NEAR terms. Vertices are taken at four densities, the nearest of each. The noise
 * variance of vertices that are about to leave the selection grows without bound, which keeps F continuous (Gribov
 * and Krivoruchko 2004, "Geostatistical mapping with continuous moving neighborhood").
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CARRY_H
#define SMR_CARRY_H

#include "geometry/box_tree/box_tree.h"

#define SMR_CARRY_MAGIC 0x63726163u
#define SMR_CARRY_DENSITIES 4u
#define SMR_CARRY_FIRST 16u /* how many vertices nearest to a point are taken from all vertices */
#define SMR_CARRY_MORE 12u  /* how many nearest vertices are taken from each thinner selection */
#define SMR_CARRY_NEAR (SMR_CARRY_FIRST + (SMR_CARRY_DENSITIES - 1u) * SMR_CARRY_MORE)
#define SMR_CARRY_CHUNK 64u    /* number of points that one task handles */
#define SMR_CARRY_ROUGH 0.002f /* variance of the covariance's rough (short-range) / smooth part */

/* A selection of vertices, every stride-th one along a Hilbert curve, and a tree of boxes around groups of eight. */
typedef struct smr_carry_thin {
    smr_box_tree groups;       /* tree of boxes around groups of eight vertices, in place of triangles */
    uint32_t first, stride, n; /* the selection holds n vertices: first, first + stride, ... */
    uint32_t take;             /* number of vertices nearest to a point that are taken out of this selection */
} smr_carry_thin;

/* The vertices near a point, the nearest one first, and the equations of their coefficients. Scratch of one worker. */
typedef struct smr_carry_site {
    uint32_t n;                           /* number of vertices near the point */
    uint32_t id[SMR_CARRY_NEAR];          /* index of each vertex on the Hilbert curve */
    float x[3][SMR_CARRY_NEAR];           /* x, y and z of the rest positions, mm from smr_carry.centre */
    float noise_variance[SMR_CARRY_NEAR]; /* noise variance of each vertex' residual; 0: the nearest vertex */
    float far[SMR_CARRY_NEAR];            /* loss of covariance g of each vertex' distance to the nearest vertex */
    float part[SMR_CARRY_NEAR];           /* correlation with the nearest vertex, 1 - far / (1 + rough) */
    float inverse[SMR_CARRY_NEAR];        /* 1 / pivot of each vertex; 0: the vertex gets no weight */
    float lower[SMR_CARRY_NEAR * SMR_CARRY_NEAR]; /* factor L of the matrix L D L^T, row-major; row 0 is not used */
    float side[SMR_CARRY_NEAR];                   /* right-hand side of the equations; once solved, the coefficients */
    float weight[3][SMR_CARRY_NEAR];              /* solutions for the vertices' residuals in x, y and z, mm */
} smr_carry_site;

struct smr_carry {
    const struct smr_carry *self; /* address of this struct itself: a copy at another address is refused */
    uint32_t magic;               /* SMR_CARRY_MAGIC marks a fitted map */
    uint32_t n_vertices, n_points, n_densities;
    smr_port port;
    smr_vec centre;   /* origin of stored positions, mm: middle of the rest shape's box, rounded */
    float per_smooth; /* 1 / range of the covariance's smooth part, 1 / mm */
    float per_rough;  /* 1 / range of the covariance's rough part, 1 / mm */
    float *rest;      /* [n_vertices][3] rest positions in the order of the Hilbert curve, mm from `centre` */
    uint32_t *item;   /* [n_vertices] caller's index of each vertex, in the order of the Hilbert curve */
    smr_carry_thin thin[SMR_CARRY_DENSITIES];
    smr_carry_site *site; /* [port.n_workers] scratch of each worker */
    uint32_t *near; /* [n_points][SMR_CARRY_NEAR] caller's indexes of vertices near a point; unused: the first one */
    float *coefficient; /* [n_points][SMR_CARRY_NEAR] coefficients c_k of the vertices in `near`; unused ones are 0 */
    float *rest_part;   /* [n_points][4] p - sum c_k r_k, mm, and 1 - sum c_k: the parts that T maps */
    uint32_t guard;     /* last: smr_byte_sum() of all members before, which hold pointers and counts */
};

/* Returns the caller's index of the vertex with index id on the Hilbert curve; < n_vertices also after a fault. */
static inline uint32_t smr_carry_item(const smr_carry *c, uint32_t id)
{
    return smr_index(c->item[smr_index(id, c->n_vertices)], c->n_vertices);
}

/* Writes the selections of n vertices, the shapes of their trees, the number of selections and that of all nodes. */
void smr_carry_shape(smr_carry_thin thin[SMR_CARRY_DENSITIES], uint32_t n, uint32_t *n_densities, uint32_t *n_nodes);
/* Fits the boxes of the tree's leaves first .. last-1 to rest positions. */
void smr_carry_boxes(const smr_carry_thin *thin, const float *rest, uint32_t first, uint32_t last);

/* The vertices of one selection that are nearest to a point, nearest first; at equal distances in the curve's order. */
typedef struct smr_carry_nearest {
    smr_vec p;                        /* position of the point, mm */
    uint32_t n, most;                 /* number of vertices found; largest number that the list keeps */
    uint32_t id[SMR_CARRY_NEAR + 1u]; /* index of each vertex on the Hilbert curve */
    float d2[SMR_CARRY_NEAR + 1u];    /* squared distance of each vertex from p, mm^2 */
} smr_carry_nearest;

void smr_carry_insert(smr_carry_nearest *f, uint32_t id, float d2); /* inserts by distance; drops the farthest */

/* Returns the rest position of vertex i of the site, mm from smr_carry.centre. */
static inline smr_vec smr_carry_place(const smr_carry_site *s, uint32_t i)
{
    return smr_v(s->x[0][i], s->x[1][i], s->x[2][i]);
}

/* Adds the product v w^T to the matrix m, row-major. */
static inline void smr_add_product(float m[9], smr_vec v, smr_vec w)
{
    const float a[3] = {v.x, v.y, v.z}, b[3] = {w.x, w.y, w.z};
    for (uint32_t i = 0; i < 9u; i++)
        m[i] += a[i / 3u] * b[i % 3u];
}

/* Writes the vertices near p (mm from smr_carry.centre), the nearest one first, and their noise variances to *s. */
void smr_carry_gather(const smr_carry *c, smr_vec p, smr_carry_site *s);
void smr_carry_fill(const smr_carry *c, smr_carry_site *s); /* sets the matrix of the equations */
/* Replaces columns first .. last-1 of the matrix by those of its factors; columns before are done. */
void smr_carry_factor(smr_carry_site *s, uint32_t first, uint32_t last);
/* Replaces the right-hand side b[1 .. n-1] of the factored equations by their solution; b[0] is not changed. */
void smr_carry_solve(const smr_carry_site *s, float *b);
/* Writes side[1 .. n-1], the equations' right-hand side for point p. Returns g of the nearest vertex' distance. */
float smr_carry_side(const smr_carry *c, smr_vec p, smr_carry_site *s);

/* A call that computes the positions of n points, in parallel. */
typedef struct smr_carry_call {
    smr_carry *c;
    const float *now;      /* [n_vertices][3] present positions in the caller's order, mm */
    float *out;            /* [n][3] computed positions of the points, mm */
    uint32_t n;            /* number of points */
    const float *xyz;      /* [n][3] points to map, mm; NULL: the points are bound */
    uint32_t inverse;      /* 1: the inverse of the map is computed; 0: the map */
    smr_carry_fact *facts; /* [n] miss and volume change of each point; NULL: not wanted */
    smr_pose trend;        /* similarity T that fits rest positions, mm from c->centre, to present positions */
} smr_carry_call;

/* Checks the carrying and present positions of a call. Returns SMR_OK, E_NULL, E_STATE, E_DAMAGED or E_INPUT. */
smr_status smr_carry_check(const smr_carry *c, const float *now);
/* Computes call->trend, and calls each(call, scratch of a worker, i) for each point i. Errors: E_STATE (port). */
typedef void smr_carry_each(const smr_carry_call *call, smr_carry_site *s, uint32_t i);
smr_status smr_carry_run(smr_carry_call *call, smr_carry_each *each);

#endif
