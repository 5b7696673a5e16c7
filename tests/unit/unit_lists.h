/* unit_lists.h: cluster lists read from a model, for tests of prepare. Everything here is in stored order.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_LISTS_H
#define UNIT_LISTS_H

#include "model/model.h"
#include "unit_mesh.h"

/* Random records of one word per stored vertex; release with unit_free(). */
uint32_t *unit_records(oracle_random *r, uint32_t n);

/* Sums over every cluster along the order L: parent + zeta+ - zeta-, with wrap-around. sum: [n]. */
void unit_chain_sums(const smr_model *m, uint32_t radius, const uint32_t *record, uint32_t *sum);

/* The order L: vertex and parent vertex (itself for a root) of each entry, block after block. Both [n]. */
void unit_chain_order(const smr_model *m, uint32_t radius, uint32_t *vertex, uint32_t *parent);

/* Clusters as sets: member[i * n + k] is 1 when k is in zeta_i. Also checks that zeta+ brings only new members and
 * zeta- only removes present ones, that lists ascend, that parents come first and that counts agree: returns 0 when
 * one of these is wrong. member: [n * n], for small n. */
int unit_chain_sets(const smr_model *m, uint32_t radius, unsigned char *member);

/* The caller's vertices in stored order (all structures in a row), relative to the centre. Release with unit_free(). */
float *unit_stored(const smr_model *m);

/* What a cluster is said to be, from the mesh alone, by looking at every pair: Euclidean or along edges, shared or
 * separate, with mesh neighbours or without. member as above. */
typedef struct unit_rule {
    float radius;
    int geodesic, separate, ring;
} unit_rule;

/* 1 when separate clusters never join two stored vertices: they are of different structures, both with triangles. */
int unit_kept_apart(const smr_model *m, uint32_t a, uint32_t b);

void unit_brute_sets(const smr_model *m, const unit_rule *rule, unsigned char *member);

#endif
