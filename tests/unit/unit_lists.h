/* unit_lists.h: cluster lists read from a model, for tests of prepare. Everything here is in stored order.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_LISTS_H
#define UNIT_LISTS_H

#include "model/model.h"
#include "unit_mesh.h"

/* Number i of a radius' index list, and its entry i, of 16 or 32 bits in the image. */
uint32_t unit_list_index(const smr_lists *l, size_t i);
smr_entry32 unit_list_entry(const smr_lists *l, uint32_t i);

/* Random records of one word per stored vertex. */
uint32_t *unit_records(oracle_random *r, uint32_t n);

/* Sums over every cluster along the order L: parent + zeta+ - zeta-, with wrap-around. sum: [n]. */
void unit_chain_sums(const smr_model *m, uint32_t radius, const uint32_t *record, uint32_t *sum);

/* Clusters as sets: member[i * n + k] is 1 when k is in zeta_i. Also checks that zeta+ brings only new members and
 * zeta- only removes present ones, that lists ascend, that parents come first and that counts agree: returns 0 when
 * one of these is wrong. member: [n * n], for small n. */
int unit_chain_sets(const smr_model *m, uint32_t radius, unsigned char *member);

/* What a cluster is said to be, from the mesh alone, by looking at every pair: Euclidean or along edges, shared or
 * separate, with mesh neighbours or without. member as above. */
typedef struct unit_rule {
    float radius;
    int geodesic, separate, ring;
} unit_rule;

void unit_brute_sets(const smr_model *m, const unit_rule *rule, unsigned char *member);

#endif
