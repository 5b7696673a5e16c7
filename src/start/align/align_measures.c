/* align_measures.c: measures of the pairs of closest points: their outlier limit, shares of matching samples, the cost
 * of a pose and root mean squares. Passes over the samples of both sides, in pieces: a radix search of a quantile of
 * each side's squared distances, four bits in a pass, since bits of floats >= 0 sort as floats; then a pass of sums.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"
#include "start/align/align.h"

#define SMR_MOSTLY 0.4f  /* share of a side's samples that is assumed to match the other side */
#define SMR_LIMIT 5.7f   /* outlier limit / quantile SMR_MOSTLY of distances: three deviations, if half-normal */
#define SMR_LEAST 0.045f /* smallest outlier limit / smaller spread of both sides: less would keep wrong poses */
#define SMR_SOME 1.0e-6f /* where sums of weights, which are divisors, start */
#define SMR_RANK_PASSES 8u

static uint32_t rank_passes(const smr_measure *m) { return m->of & SMR_MEASURE_RANKS ? SMR_RANK_PASSES : 0u; }

uint32_t smr_measure_visits(const smr_aligner *a, uint32_t of)
{
    return SMR_SIDES * a->used * ((of & SMR_MEASURE_RANKS ? SMR_RANK_PASSES : 0u) + (of & SMR_MEASURE_SUMS ? 1u : 0u));
}

void smr_measure_start(const smr_aligner *a, uint32_t of, const float share[SMR_SIDES], smr_measure *m)
{
    memset(m, 0, sizeof *m);
    m->of = of;
    m->within = SMR_SOME;
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        const float part = share != NULL ? share[side] : SMR_MOSTLY;
        m->rank[side] = smr_min_u32((uint32_t)(part * (float)a->used), a->used - 1u);
        m->all[side] = SMR_SOME;
    }
}

/* Counts the digits of samples first .. last-1 of a side in a pass; the last sample of the side finds the digit. */
static void count_digits(const smr_aligner *a, smr_measure *m, uint32_t pass, uint32_t side, smr_piece k)
{
    const uint32_t shift = 28u - 4u * pass, mask = pass > 0u ? UINT32_MAX << (shift + 4u) : 0u;
    uint32_t digit = 0;
    for (uint32_t i = k.first; i < k.last; i++) {
        const uint32_t bits = smr_float_bits(a->side[side].pair[i].d2);
        if ((bits & mask) == m->found[side])
            m->count[side][bits >> shift & 15u]++;
    }
    if (k.last < a->used)
        return;
    for (; digit < 15u && m->rank[side] >= m->count[side][digit]; digit++)
        m->rank[side] -= m->count[side][digit];
    m->found[side] |= digit << shift;
    memset(m->count[side], 0, sizeof m->count[side]);
}

/* Adds samples first .. last-1 of a side to the sums. A root mean square has sums of both sides. */
static void add_sums(const smr_aligner *a, smr_measure *m, uint32_t side, smr_piece k)
{
    const smr_align_side *s = &a->side[side];
    const float most = a->limit * a->limit, limit = smr_measure_limit(a, m), quantile = smr_float_of(m->found[side]);
    const uint32_t step = 2u * s->n / (2u * a->used), more = 2u * s->n % (2u * a->used);
    uint32_t at = smr_sample(s, k.first, a->used);
    uint32_t left = (uint32_t)(((uint64_t)2u * k.first + 1u) * s->n % (2u * (uint64_t)a->used));
    for (uint32_t i = k.first; i < k.last; i++) {
        const float d2 = s->pair[i].d2, weight = s->weight[at], within = d2 <= quantile ? weight : 0.0f;
        m->near[side] += d2 < limit * limit ? weight : 0.0f;
        m->sum[side] += weight * smr_min(d2, most);
        m->all[side] += weight;
        m->square += within * d2;
        m->within += within;
        at += step + (left + more >= 2u * a->used); /* at becomes smr_sample(s, i + 1), without its division */
        left += more - (left + more >= 2u * a->used ? 2u * a->used : 0u);
    }
}

void smr_measure_run(const smr_aligner *a, smr_measure *m, smr_piece visits)
{
    for (uint32_t at = visits.first; at < visits.last;) {
        const uint32_t pass = at / (SMR_SIDES * a->used), side = at / a->used % SMR_SIDES, k = at % a->used;
        const smr_piece samples = {k, smr_min_u32(a->used, k + visits.last - at)};
        if (pass < rank_passes(m))
            count_digits(a, m, pass, side, samples);
        else
            add_sums(a, m, side, samples);
        at += samples.last - k;
    }
}

float smr_measure_limit(const smr_aligner *a, const smr_measure *m)
{
    const float d2 = smr_min(smr_float_of(m->found[SMR_MODEL]), smr_float_of(m->found[SMR_TARGET]));
    const float limit = smr_max(SMR_LIMIT * SMR_SQRT(d2), SMR_LEAST * smr_aligner_spread(a));
    return m->of & SMR_MEASURE_CAPPED ? smr_min(limit, a->limit) : limit;
}

float smr_measure_share(const smr_measure *m, uint32_t side) { return m->near[side] / m->all[side]; }

/* Not inlined: of two quotients clang makes a vector, whose unused lanes trap on 0 / 0. */
__attribute__((noinline)) static float capped_mean(const smr_measure *m, uint32_t side, float most)
{
    return m->sum[side] / (m->all[side] * most);
}

float smr_measure_cost(const smr_aligner *a, const smr_measure *m)
{
    const float most = a->limit * a->limit;
    return smr_cost_of_sides(capped_mean(m, SMR_MODEL, most), capped_mean(m, SMR_TARGET, most));
}

float smr_measure_rms(const smr_measure *m) { return SMR_SQRT(m->square / m->within); }
