/* prove_contracts.c: contracts of functions without a loop, which a prover shows for all numbers: indexes that a fault
 * changed, and the sections that a model's header states.
 * SPDX-License-Identifier: MIT */
#include "model/model.h"

/*@ assigns \nothing;
    ensures \result == v; */
static inline uint32_t smr_le32(uint32_t v);

/*@ requires n >= 1;
    assigns \nothing;
    ensures \result < n;
    ensures i < n ==> \result == i; */
static inline uint32_t smr_index(uint32_t i, uint32_t n);

/*@ requires b >= 1;
    assigns \nothing;
    ensures (\result - 1) * b < a || a == 0;
    ensures a == 0 ==> \result == 0; */
static inline uint32_t smr_ceil_div(uint32_t a, uint32_t b);

/*@ requires \valid_read(m);
    requires size <= 0xffffffff;
    assigns \nothing;
    ensures \result != 0 ==> stored_offset % 64 == 0 && stored_offset >= sizeof(struct smr_model);
    ensures \result != 0 ==> stored_offset + count * size <= m->bytes; */
static int section(const smr_model *m, uint32_t stored_offset, uint64_t count, uint64_t size);

#include "model/model_open.c"
