/* profile_match.c: one-dimensional registration of intensity profiles along the normal (paper 2.1): the offset at
 * which a line of image samples is most similar to the reference profile, between samples, and its confidence.
 * Similarity measures: normalised cross-correlation (paper 3; Lewis 1995, with running sums), sum of squared
 * differences, and concordance, 2 s_xy / (s_x^2 + s_y^2 + SMR_LEVEL (mean_x - mean_y)^2). Lin 1989 has SMR_LEVEL = 1; a
 * smaller value allows for different brightness of images of one kind. Bounds: (m - n + 1) * n multiply-adds.
 * SPDX-License-Identifier: MIT */
#include "base/lanes.h"
#include "image/intensity_profile.h"

#define SMR_LEVEL 0.1f        /* weight of the squared difference in mean brightness in the concordance */
#define SMR_SCORE_LOW -0.999f /* lowest score of a window inside the image; -1 marks windows partly outside */
#define SMR_SCORE_MIN 0.3f    /* score at or below which a match has the confidence 0 */
#define SMR_APART 4u          /* smallest distance between first and second peak, samples */
#define SMR_DISTINCT 5.0f     /* confidence factor / (score of the first peak minus score of the second), up to 1 */
#define SMR_DISTINCT_MIN 0.2f /* lowest factor on the confidence for a second peak as high as the first */
#define SMR_FLAT 1.0e-30f     /* intensity: ranges at or below count as 0, so that 255 / range is finite */

void smr_profile_pack(const float *value, const uint8_t *inside, uint32_t n, uint8_t *packed, float *low, float *range)
{
    float lo = value[0], hi = value[0];
    int all_inside = 1;
    for (uint32_t k = 0; k < n; k++) {
        all_inside &= inside[k] != 0;
        lo = smr_min(lo, value[k]);
        hi = smr_max(hi, value[k]);
    }
    *low = all_inside ? lo : 0.0f;
    *range = all_inside && hi - lo > smr_max(1.0e-6f * (smr_abs(lo) + smr_abs(hi)), SMR_FLAT) ? hi - lo : 0.0f;
    for (uint32_t k = 0; k < n; k++)
        packed[k] = *range > 0.0f ? (uint8_t)((value[k] - lo) * (255.0f / *range) + 0.5f) : 0u;
}

/* Returns the similarity of a window of n samples with the reference, both relative to the reference's mean and in
 * units of its range. dot: sum of products; sum, square: sums of the window's samples and of their squares; ref_norm:
 * root of the reference's sum of squares; noise2: squared noise. */
static inline float score_of(uint32_t kind, float ref_norm, float noise2, float n, float dot, float sum, float square)
{
    const float ref2 = ref_norm * ref_norm, variance = square - sum * sum / n;
    if (kind == SMR_SIMILARITY_SSD)
        return 1.0f - (square - 2.0f * dot + ref2) / ref2;
    if (kind == SMR_SIMILARITY_CONCORDANCE)
        return 2.0f * dot / (smr_max(variance, 0.0f) + ref2 + n * noise2 + SMR_LEVEL * sum * sum / n);
    /* smr_max(): vectors take the root of all lanes, and a root of less than 0 is an exception */
    return variance > 1.0e-4f * ref2 ? dot / (SMR_SQRT(smr_max(variance, 0.0f)) * ref_norm) : 0.0f;
}

#define SMR_SIDE 32u               /* largest number of offsets whose scores one vectorised loop computes */
#define SMR_WIDTH (4u * SMR_LANES) /* loops that score offsets take a multiple of this many offsets */

/* Sums over the samples of the windows at successive offsets: values, squares. */
typedef struct windows {
    float sum[SMR_SIDE], square[SMR_SIDE];
} windows;

/* Moves *sum and *square, the sums over the first n samples of a line, by `count` offsets. Writes the sums at each
 * offset to w. */
static void slide(float *sum, float *square, const float *line, uint32_t n, uint32_t count, windows *w)
{
    for (uint32_t i = 0; i < count; i++) { /* differences first, in a loop that vectorises */
        const float out = line[i], in = line[i + n];
        w->sum[i] = in - out;
        w->square[i] = in * in - out * out;
    }
    for (uint32_t i = 0; i < count; i++) {
        const float more = w->sum[i], more2 = w->square[i];
        w->sum[i] = *sum;
        w->square[i] = *square;
        *sum += more;
        *square += more2;
    }
}

/* Parameters that the scores at all offsets of one profile share. */
typedef struct scoring {
    float ref_norm;   /* root of the reference's sum of squared deviations from its mean, in units of its range */
    float noise2;     /* squared noise level in units of the reference's range */
    float n;          /* number of samples of the reference */
    float middle;     /* offset halfway between the first and the last one */
    float per_sample; /* 1 / middle; 0 with a single offset */
    float nearer;     /* score subtracted at the first and the last offset */
} scoring;

/* Writes score[i], the score of the window at offset o + i, i < count. */
static inline void score_side(uint32_t kind, const scoring *s, uint32_t o, uint32_t count, const float *dot,
                              const windows *w, float *score)
{
    for (uint32_t i = 0; i < count; i++) {
        const float away = ((float)(int32_t)(o + i) - s->middle) * s->per_sample;
        const float similarity = score_of(kind, s->ref_norm, s->noise2, s->n, dot[i], w->sum[i], w->square[i]);
        score[i] = smr_clamp(similarity - s->nearer * away * away, SMR_SCORE_LOW, 1.0f);
    }
}

/* Writes dot[i], i < count: the sum of ref[k] * line[k + i] for k = 0 .. n-1, added in the order of k. */
static void dots(const float *ref, uint32_t n, const float *line, uint32_t count, float *dot)
{
    memset(dot, 0, count * sizeof *dot);
    for (uint32_t k = 0; SMR_LANES < 4u && k < n; k++) /* processors without vectors */
        for (uint32_t i = 0; i < count; i++)
            dot[i] += ref[k] * line[k + i];
    for (uint32_t i = 0; SMR_LANES >= 4u && i < count; i += SMR_WIDTH) {
        smr_lanes sum[SMR_WIDTH / SMR_LANES] = {{0}}, l; /* SMR_WIDTH sums, which stay in registers */
        for (uint32_t k = 0; k < n; k++)
            for (uint32_t j = 0; j < SMR_WIDTH / SMR_LANES; j++) {
                memcpy(&l, line + i + k + j * SMR_LANES, sizeof l);
                sum[j] += smr_lanes_of(ref[k]) * l;
            }
        memcpy(dot + i, sum, sizeof sum);
    }
}

/* Writes score[o], the similarity at each offset o. line and score have room for SMR_WIDTH more values. */
static void scores_of(uint32_t kind, const scoring *s, const float *ref, uint32_t n, const float *line,
                      uint32_t offsets, float *score)
{
    float dot[SMR_SIDE], sum = 0.0f, square = 0.0f;
    windows w;
    for (uint32_t k = 0; k < n; k++) {
        sum += line[k];
        square += line[k] * line[k];
    }
    for (uint32_t o = 0; o < offsets; o += SMR_SIDE) {
        const uint32_t count = smr_ceil_div(smr_min_u32(offsets - o, SMR_SIDE), SMR_WIDTH) * SMR_WIDTH;
        slide(&sum, &square, line + o, n, count, &w);
        dots(ref, n, line + o, count, dot);
        if (kind == SMR_SIMILARITY_SSD) /* each measure has its own loop without branches */
            score_side(SMR_SIMILARITY_SSD, s, o, count, dot, &w, score + o);
        else if (kind == SMR_SIMILARITY_CONCORDANCE)
            score_side(SMR_SIMILARITY_CONCORDANCE, s, o, count, dot, &w, score + o);
        else
            score_side(SMR_SIMILARITY_NCC, s, o, count, dot, &w, score + o);
    }
}

/* Sets the score at offsets whose window of n samples is partly outside the image to -1. */
static void drop_scores(const uint8_t *inside, uint32_t n, uint32_t offsets, float *score)
{
    for (uint32_t k = 0; k + 1u < offsets + n; k++)
        for (uint32_t o = k + 1u > n ? k + 1u - n : 0u; !inside[k] && o <= k && o < offsets; o++)
            score[o] = -1.0f;
}

/* Returns the largest of value[from .. to-1], at least -1. */
static float largest(const float *value, uint32_t from, uint32_t to)
{
    float top[4] = {-1.0f, -1.0f, -1.0f, -1.0f}; /* of every fourth value: four maxima do not wait for each other */
    for (; from + 4u <= to; from += 4u)
        for (uint32_t i = 0; i < 4u; i++)
            top[i] = smr_max(value[from + i], top[i]);
    for (; from < to; from++)
        top[0] = smr_max(value[from], top[0]);
    return smr_max(smr_max(top[0], top[1]), smr_max(top[2], top[3]));
}

/* Returns the offset with the highest score, refined by a parabola through its neighbours. The confidence grows with
 * the score and with the difference from the second peak's score. plain: a match always has the confidence 1. */
static smr_peak peak_of(const float *score, uint32_t offsets, uint32_t plain, float *maxima)
{
    const float top = largest(score, 0, offsets);
    uint32_t best = 0;
    while (best + 1u < offsets && score[best] < top)
        best++;
    for (size_t o = 1; o + 1u < offsets; o++) { /* local maxima */
        const float above = score[o] >= score[o - 1u] ? score[o] : -1.0f;
        maxima[o] = score[o] >= score[o + 1u] ? above : -1.0f;
    }
    const float left = largest(maxima, 1u, best > SMR_APART ? best - SMR_APART + 1u : 1u);
    const float second = smr_max(left, largest(maxima, best + SMR_APART, offsets - 1u));
    smr_peak peak = {(float)best, 0.0f};
    if (best > 0u && best + 1u < offsets && score[best - 1u] > -1.0f && score[best + 1u] > -1.0f)
        peak.at += smr_parabola_peak(score[best - 1u], score[best], score[best + 1u]);
    peak.confidence = smr_max(top - SMR_SCORE_MIN, 0.0f) * (1.0f / (1.0f - SMR_SCORE_MIN)) *
                      smr_clamp((top - second) * SMR_DISTINCT, SMR_DISTINCT_MIN, 1.0f);
    if (plain)
        peak.confidence = top > 0.0f ? 1.0f : 0.0f;
    return peak;
}

smr_peak smr_profile_match(const smr_profile *reference, const float *line, const uint8_t *inside, uint32_t m,
                           const smr_similarity *how)
{
    const int level_counts = how->kind != SMR_SIMILARITY_NCC;
    const uint8_t *const packed = reference->value;
    const float low = reference->low, range = reference->range;
    const uint32_t n = reference->n;
    float ref[SMR_PROFILE_MAX], centred[SMR_LINE_MAX + SMR_WIDTH], score[SMR_LINE_MAX + SMR_WIDTH];
    if (!(range > 0.0f) || m < n || n < 3u || n > SMR_PROFILE_MAX || m > SMR_LINE_MAX)
        return (smr_peak){0.0f, 0.0f};
    const uint32_t offsets = m - n + 1u;
    /* ref[] and centred[] are relative to the reference's mean, in units of its range, so that sums lose no digits */
    float mean = 0.0f, norm = 0.0f;
    for (uint32_t k = 0; k < n; k++) {
        ref[k] = (float)packed[k] * (1.0f / 255.0f);
        mean += ref[k];
    }
    mean /= (float)n;
    for (uint32_t k = 0; k < n; k++) {
        ref[k] -= mean;
        norm += ref[k] * ref[k];
    }
    for (uint32_t k = 0; k < m; k++)
        centred[k] = (line[k] - low) / range - mean;
    for (uint32_t k = 0; inside != NULL && k < m; k++)
        centred[k] = inside[k] ? centred[k] : 0.0f;
    memset(centred + m, 0, SMR_WIDTH * sizeof *centred);
    float level = 0.0f, count = 0.0f;
    for (uint32_t k = 0; !level_counts && k < m; k++) {
        level += centred[k];
        count += inside == NULL || inside[k] ? 1.0f : 0.0f;
    }
    for (uint32_t k = 0; !level_counts && k < m; k++)
        centred[k] -= inside == NULL || inside[k] ? level / count : 0.0f;
    const float noise = how->noise / range, middle = 0.5f * (float)(offsets - 1u);
    const float per_sample = offsets > 1u ? 1.0f / middle : 0.0f;
    const scoring how_to = {SMR_SQRT(norm), noise * noise, (float)n, middle, per_sample, how->nearer};
    score[0] = -1.0f; /* silences a warning: offsets is at least 1 */
    scores_of(how->kind, &how_to, ref, n, centred, offsets, score);
    if (inside != NULL)
        drop_scores(inside, n, offsets, score);
    return peak_of(score, offsets, how->plain, centred);
}
