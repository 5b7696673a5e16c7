/* carry.h: the map from the rest shape's space to the space of the model as it is now, fixed by where vertices went.
 *
 * F(p) = T(p) + sum of c_k(p) (x_k - T(r_k)). r_k and x_k are the rest and the present place of a vertex near p, T is a
 * similarity that fits the whole model, and the coefficients c_k follow from the rest shape alone: those of simple
 * kriging (a Gaussian process' mean) with a smooth and a rough part of the covariance. So a bound point costs one sum
 * of at most SMR_CARRY_NEAR terms. Vertices are taken at four densities, the nearest of each, and those about to leave
 * the selection count with an error that grows without bound, which keeps F continuous (Gribov and Krivoruchko 2004,
 * "Geostatistical mapping with continuous moving neighborhood").
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CARRY_H
#define SMR_CARRY_H

#include "base/vec.h"
#include "geometry/box_tree/box_tree.h"

#define SMR_CARRY_MAGIC 0x63726163u
#define SMR_CARRY_DENSITIES 4u
#define SMR_CARRY_FIRST 16u /* nearest vertices taken of all */
#define SMR_CARRY_MORE 12u  /* of each thinner selection */
#define SMR_CARRY_NEAR (SMR_CARRY_FIRST + (SMR_CARRY_DENSITIES - 1u) * SMR_CARRY_MORE)
#define SMR_CARRY_CHUNK 64u /* points of a task */
#define SMR_CARRY_STEPS 7u  /* levels of a tree: 8^8 groups of 8 > SMR_VERTICES_MAX */

/* Every stride-th vertex along the curve, and boxes around each eight of them. */
typedef struct smr_carry_thin {
    smr_node *node;                  /* lowest level first; a child of its nodes is a group of 8 of these vertices */
    uint32_t first, stride, n;       /* vertices first, first + stride, ...: n of them */
    uint32_t take;                   /* nearest vertices taken of these */
    uint32_t n_steps;                /* levels of nodes */
    uint32_t step[SMR_CARRY_STEPS];  /* each level's first node */
    uint32_t count[SMR_CARRY_STEPS]; /* its nodes */
} smr_carry_thin;

/* The vertices near a point, the nearest first, and the equations of their coefficients; scratch of one worker. */
typedef struct smr_carry_site {
    uint32_t n;
    uint32_t id[SMR_CARRY_NEAR];                  /* along the curve */
    float x[3][SMR_CARRY_NEAR];                   /* mm, from the centre */
    float loose[SMR_CARRY_NEAR];                  /* on the diagonal; 0 for the nearest vertex */
    float far[SMR_CARRY_NEAR];                    /* g of the distance to the nearest vertex */
    float part[SMR_CARRY_NEAR];                   /* 1 - far / (1 + rough) */
    float inverse[SMR_CARRY_NEAR];                /* of the factor's pivots; 0 where a vertex adds nothing */
    float lower[SMR_CARRY_NEAR * SMR_CARRY_NEAR]; /* the factor L of L D L^T, row-major; entry 0 is not used */
    float side[SMR_CARRY_NEAR];                   /* a right-hand side, then its solution */
    float weight[3][SMR_CARRY_NEAR];              /* solutions for the vertices' displacements, mm */
} smr_carry_site;

struct smr_carry {
    const struct smr_carry *self; /* a copy of the memory is not a map */
    uint32_t magic;               /* SMR_CARRY_MAGIC */
    uint32_t n_vertices, n_points, n_densities;
    smr_port port;
    smr_vec centre;   /* mm, whole */
    float per_smooth; /* 1 / mm, of the smooth part's reach */
    float per_rough;  /* 1 / mm, of the rough part's reach */
    float *rest;      /* [n_vertices][3] mm from the centre, along the curve */
    uint32_t *item;   /* [n_vertices] the caller's vertex */
    smr_carry_thin thin[SMR_CARRY_DENSITIES];
    smr_carry_site *site;  /* [port.n_workers] */
    uint32_t *near;        /* [n_points][SMR_CARRY_NEAR] the caller's vertices; unused ones are the first */
    float *coefficient;    /* [n_points][SMR_CARRY_NEAR] c_k; unused ones are 0 */
    float *rest_part;      /* [n_points][4] p - sum c_k r_k, mm, and 1 - sum c_k: what T adds */
    uint32_t wrong_worker; /* the port used a number that it has not */
};

/* carry_nearest.c. Bytes are those of the trees' nodes for n vertices, all densities. */
void smr_carry_shape(smr_carry_thin thin[SMR_CARRY_DENSITIES], uint32_t n, uint32_t *n_densities, uint32_t *n_nodes);
void smr_carry_boxes(const smr_carry_thin *thin, const float *rest);

/* The vertices near p (mm from the centre), the nearest first, and how loose each is held. */
void smr_carry_gather(const smr_carry *c, smr_vec p, smr_carry_site *s);

/* carry_equations.c. Factors the equations of gathered vertices. */
void smr_carry_factor(const smr_carry *c, smr_carry_site *s);

/* Solves them for the right-hand side b[n], entry 0 untouched, in place. */
void smr_carry_solve(const smr_carry_site *s, float *b);

/* The right-hand side of a point: side[1..n-1]. Returns g of the distance to the nearest vertex. */
float smr_carry_side(const smr_carry *c, smr_vec p, smr_carry_site *s);

/* Variance of the rough part over that of the smooth one. */
#define SMR_CARRY_ROUGH 0.002f

/* carry_apply.c. The similarity T from rest, mm from the centre, to now. */
smr_pose smr_carry_trend(const smr_carry *c, const float *now);

/* E_NULL, E_STATE, E_INPUT as for smr_carry_apply(). */
smr_status smr_carry_check(const smr_carry *c, const float *now);

/* Runs a task for each chunk of n points; E_STATE when the port used a worker number that it has not. */
smr_status smr_carry_run(smr_carry *c, smr_task run, void *arg, uint32_t n);

/* The worker's scratch, or NULL with the carry told that there is none. */
smr_carry_site *smr_carry_site_of(smr_carry *c, uint32_t worker);

#endif
