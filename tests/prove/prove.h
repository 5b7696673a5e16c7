/* prove.h: what the mains of `make prove` share. They are analysed by frama-c, never run.
 * SPDX-License-Identifier: MIT */
#ifndef PROVE_H
#define PROVE_H

#include "__fc_builtin.h"
#include <stdint.h>

#define PROVE_HOSTILE(at, n) Frama_C_make_unknown((char *)(at), (n)) /* the n bytes at `at` may hold anything */
#define PROVE_ANY(lo, hi) ((uint32_t)Frama_C_unsigned_int_interval((lo), (hi))) /* any number in lo .. hi */

/* Any word at all, as one case for each number below `few` and one for all others: k runs from 0 to few. */
#define PROVE_WORD(k, few) ((k) < (few) ? (k) : PROVE_ANY((few), UINT32_MAX))

/* Writes a word that is read byte by byte: 0 for k = 0; for k = 1 .. 4 any word whose byte k - 1 is not 0. */
static inline void prove_bytes(unsigned char *at, uint32_t k)
{
    for (uint32_t i = 0; i < 4u; i++)
        at[i] = (unsigned char)PROVE_ANY(k == i + 1u, k > 0u ? 255 : 0);
}

#endif
