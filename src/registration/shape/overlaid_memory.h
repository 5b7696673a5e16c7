/* overlaid_memory.h: memory that several stages use, one after the other.
 *
 *   memory          steps of an iteration, in order                           contents
 *   record          smr_restore() -> the last input is set again              checksums of awaited inputs
 *   record          fill -> forces                                            rings: mean of mesh neighbours
 *                   point spread -> forces                                    spread: pulls of a cloud's points
 *                   smoothing -> forces are taken                            rings: mesh neighbours' positions
 *                   reference records -> their sums                           moments of x^r
 *                   records of displacements -> their sums                    displacements, fixed point
 *                   records of transforms -> their sums                       transforms, fixed point
 *                   tangential smoothing -> evolve                            rings: neighbours' displacements
 *                   fold repair or fold limit                                 rings: neighbours' displacements or steps
 *   sum             field of occluded vertices -> forces                      controls, factor and coefficients
 *                   reference records -> match                                sums over clusters
 *                   match -> records of transforms                            transforms, floats
 *                   records of transforms -> evolve                           sums over clusters
 *   sum, words 12+  evolve -> end of the iteration                            next normals (below)
 *   sum, words 0-2  exchange of normals -> end of the iteration               the former x^r (below)
 *   tally           within each step and its end                              results of tasks for the step's end;
 *                   fold find -> fold limit, repair and open                  counts of folds in each chunk of edges
 *   x_next          end of the iteration -> evolve                            the positions before x (deformed_shape.h)
 *                   evolve -> end of the iteration                            positions of the current iteration
 * SPDX-License-Identifier: MIT */
#ifndef SMR_OVERLAID_MEMORY_H
#define SMR_OVERLAID_MEMORY_H

#include "registration/shape/schedule_state.h"

/* Results of a task for the end of its step, which reduces the results in task order. */
typedef union smr_tally {
    struct {
        float goal_sum, goal_sum2; /* sum, mm, and sum of squares, mm^2, of the distances to goals */
        float sum, sum2, max;      /* sum, mm, sum of squares, mm^2, and maximum, mm, of the residuals */
        float largest[2];          /* largest mass times displacement; largest mass times displacement times position */
        uint8_t n_forces, n_rejected, n_residuals; /* numbers of vertices: with a goal; without; with a residual */
    } forces;
    struct {
        float deviation2; /* largest squared distance of x^r from the rest shape in its pose, mm^2 */
    } reference;
    struct {
        uint32_t index; /* first index of the block's next piece */
    } sums;
    struct {
        float largest[2]; /* largest entry of R - I or of rotation vectors; largest entry of t or of rates, mm */
    } match;
    struct {
        float moved2;  /* largest squared displacement, mm^2 */
        float moved;   /* sum of displacements, mm, where the configuration needs it */
        uint64_t hash; /* sum of the hashes of the vertices */
    } evolve;
    struct {
        /* a bit for each piece of the dihedral edges: some fold or must be limited; are folded but were open at rest */
        uint32_t bent, open;
        uint32_t quiet;       /* likewise: no edge has a touched triangle, or none was touched yet, ... */
        uint32_t round;       /* ... in this round of fold_limit.c */
        uint32_t first, last; /* the edges lie in these structures and some between them */
    } folds;
} smr_tally;

/* Sums over the mesh neighbours of each vertex, in the memory of the records. */
typedef struct smr_rings {
    float *sum;    /* [n][3] sum of the mesh neighbours' displacements, positions or steps, mm */
    float *weight; /* [n] sum of the neighbours' weights in `sum` */
    /* [n][3] tangential smoothing: displacement from the posed rest shape; fold repair: that shape near folds, mm */
    float *displacement;
    float *requested; /* [n] fold limit: largest share that an edge requests; in the memory of displacement */
    uint32_t *listed; /* [n] fold limit: the vertices with requests in this round; behind requested */
} smr_rings;

/* Adds value [n][3] of each corner of triangle t to the sums of the other two: a neighbour counts once a triangle. */
static inline void smr_ring_add(const smr_rings *rings, const uint32_t *t, const float *value)
{
    float *const sum = rings->sum, *const weight = rings->weight;
    float *const p = sum + 3u * (size_t)t[0], *const q = sum + 3u * (size_t)t[1], *const r = sum + 3u * (size_t)t[2];
    const smr_vec a = smr_get3(value, t[0]), b = smr_get3(value, t[1]), c = smr_get3(value, t[2]);
    smr_store(p, smr_add(smr_load(p), smr_add(b, c)));
    smr_store(q, smr_add(smr_load(q), smr_add(c, a)));
    smr_store(r, smr_add(smr_load(r), smr_add(a, b)));
    weight[t[0]] += 2.0f;
    weight[t[1]] += 2.0f;
    weight[t[2]] += 2.0f;
}

/* Pulls of a cloud during their smoothing over the mesh, in the memory of the records behind the rings. */
typedef struct smr_spread {
    float *pull;  /* [n][4] weighted sum of the pulls on a vertex, mm, and sum of their weights */
    float *next;  /* [n][4] sum of the neighbours' pulls and weights in the current round of smoothing */
    float *count; /* [n] number of mesh neighbours of a vertex, counted once a triangle */
} smr_spread;

typedef struct smr_overlay {
    uint32_t *record; /* [n][SMR_WORDS] fixed-point records of vertices, or other contents (top of this file) */
    uint32_t *sum;    /* [n][SMR_WORDS] sums of records over clusters and next normals; at least n_sum words */
    smr_rings rings;
    smr_spread spread;
    smr_tally *tally; /* [n_tallies] results of tasks for the end of their step */
} smr_overlay;

/* Takes record, sum and tally from the arena. words: words of a record; n_sum: fewest words of `sum`. */
static inline void smr_overlay_layout(smr_arena *a, smr_overlay *o, uint32_t n, uint32_t words, size_t n_sum,
                                      uint32_t n_tallies)
{
    const size_t n_words = (size_t)n * words;
    o->record = smr_slot_scratch(a, o->record, n, words * sizeof(uint32_t));
    o->sum = smr_slot_scratch(a, o->sum, n_words > n_sum ? n_words : n_sum, sizeof(uint32_t));
    o->tally = smr_slot_scratch(a, o->tally, n_tallies, sizeof *o->tally);
    if (o->record == NULL)
        return;
    o->rings.sum = (float *)o->record;
    o->rings.weight = o->rings.sum + 3u * (size_t)n;
    o->rings.displacement = o->rings.weight + n;
    o->rings.requested = o->rings.displacement;
    o->rings.listed = (uint32_t *)(o->rings.requested + n);
    o->spread.pull = o->rings.displacement + 3u * (size_t)n;
    o->spread.next = o->spread.pull + 4u * (size_t)n;
    o->spread.count = o->spread.next + 4u * (size_t)n;
}

/* Three words of a vertex' sum (smr_overlay.sum) from word `word` on, as a vector: from evolve on the next normal; once
 * normals are exchanged the former one, and the former x^r if an iteration's end sets x^r. */
#define SMR_FORMER_REF 0u
#define SMR_NEXT_NORMAL 12u /* averaging uses the words before */

static inline smr_vec smr_sum_vec(const uint32_t *sum, uint32_t v, uint32_t word)
{
    smr_vec vec;
    memcpy(&vec, sum + SMR_WORDS * (size_t)v + word, sizeof vec);
    return vec;
}

static inline void smr_sum_vec_set(uint32_t *sum, uint32_t v, uint32_t word, smr_vec vec)
{
    memcpy(sum + SMR_WORDS * (size_t)v + word, &vec, sizeof vec);
}

static inline smr_vec smr_next_normal(const uint32_t *sum, uint32_t v) { return smr_sum_vec(sum, v, SMR_NEXT_NORMAL); }

static inline void smr_next_normal_set(uint32_t *sum, uint32_t v, smr_vec normal)
{
    smr_sum_vec_set(sum, v, SMR_NEXT_NORMAL, normal);
}

#endif
