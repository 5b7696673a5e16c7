/* intensity_profile.c: one-dimensional registration of intensity profiles (paper 2.1) and gradient search along the normal. Likeness is
 * normalised cross-correlation (Lewis 1995, with running sums), the sum of squared differences, or concordance,
 * 2 s_xy / (s_x^2 + s_y^2 + SMR_LEVEL (mean_x - mean_y)^2) (Lin 1989 has 1 for SMR_LEVEL: brightness differs between images
 * of one kind, but not by as much as between tissues).
 * Bounds: (m - n + 1) * n multiply-adds, no allocation. The peak is refined by a parabola through its neighbours.
 * SPDX-License-Identifier: MIT */
#include "image/intensity_profile.h"

#define SMR_FLAT 1.0e-30f /* intensity: a smaller range counts as none; 255 / range must stay finite */
#define SMR_LEVEL 0.1f
#define SMR_SCORE_LOW -0.999f /* -1 is kept for windows that are not all inside */
#define SMR_SCORE_MIN 0.3f    /* correlations below carry no confidence */
#define SMR_APART 4u          /* samples between a peak and another one that makes it less distinct */
#define SMR_DISTINCT 5.0f     /* confidence per correlation that the peak stands above others */
#define SMR_DISTINCT_MIN 0.2f
#define SMR_EDGE_NEAR 3u   /* samples around the surface in which the reference's edge is looked for */
#define SMR_EDGE_MIN 0.08f /* of the profile's range per sample: weaker is no edge */
#define SMR_STEEP 3.0f     /* times the reference's slope: so steep an edge counts most, steeper ones less again */

static const smr_peak none = {0.0f, 0.0f};

void smr_profile_pack(const float *value, const unsigned char *inside, uint32_t n, uint8_t *packed, float *low,
                      float *range)
{
    float lo = value[0], hi = value[0];
    int whole = 1;
    for (uint32_t k = 0; k < n; k++) {
        whole &= inside[k] != 0;
        lo = smr_min(lo, value[k]);
        hi = smr_max(hi, value[k]);
    }
    *low = whole ? lo : 0.0f;
    *range = whole && hi - lo > smr_max(1.0e-6f * (smr_abs(lo) + smr_abs(hi)), SMR_FLAT) ? hi - lo : 0.0f;
    for (uint32_t k = 0; k < n; k++)
        packed[k] = *range > 0.0f ? (uint8_t)((value[k] - lo) * (255.0f / *range) + 0.5f) : 0u;
}

/* Vertex of the parabola through three equally spaced scores, -0.5 .. 0.5. */
static float refine(float before, float at, float after)
{
    const float bend = before - 2.0f * at + after;
    return bend < 0.0f ? smr_clamp(0.5f * (before - after) / bend, -0.5f, 0.5f) : 0.0f;
}

/* One score: dot, sum and square are of the window's samples with the reference, alone and squared. */
static inline float score_of(uint32_t kind, float ref_norm, float noise2, float n, float dot, float sum, float square)
{
    const float ref2 = ref_norm * ref_norm, variance = square - sum * sum / n;
    if (kind == SMR_SIMILARITY_SSD)
        return 1.0f - (square - 2.0f * dot + ref2) / ref2;
    if (kind == SMR_SIMILARITY_CONCORDANCE)
        return 2.0f * dot / (smr_max(variance, 0.0f) + ref2 + n * noise2 + SMR_LEVEL * sum * sum / n);
    return variance > 1.0e-4f * ref2 ? dot / (SMR_SQRT(variance) * ref_norm) : 0.0f;
}

#define SMR_SIDE 32u /* offsets scored side by side, at most: loops over them are vector code */
#define SMR_WIDTH 4u /* their number is rounded up to a multiple of this */

/* Sums over a window's samples that go along with it from offset to offset. */
typedef struct running {
    float sum, square;
    uint32_t missing;
} running;

/* The same at neighbouring offsets. */
typedef struct windows {
    float sum[SMR_SIDE], square[SMR_SIDE];
    uint32_t missing[SMR_SIDE]; /* samples that are not inside */
} windows;

/* Takes the sums on to the windows at offsets o .. o+count-1. */
static void run_on(running *r, const float *line, const unsigned char *inside, uint32_t n, uint32_t o, uint32_t count,
                   windows *w)
{
    for (uint32_t i = 0; i < count; i++) {
        if (o + i > 0u) {
            const float out = line[o + i - 1u], in = line[o + i + n - 1u];
            r->sum += in - out;
            r->square += in * in - out * out;
            r->missing += (uint32_t)!inside[o + i + n - 1u] - (uint32_t)!inside[o + i - 1u];
        }
        w->sum[i] = r->sum;
        w->square[i] = r->square;
        w->missing[i] = r->missing;
    }
}

/* What all scores of one profile share. */
typedef struct scoring {
    float ref_norm, noise2, n; /* noise2: squared, in units of the reference's range */
    float middle, per_sample;  /* offset halfway, and 1 over it */
    float nearer;
} scoring;

/* Scores of `count` windows side by side, the first at offset o; -1 where a window is not all inside. */
static inline void score_side(uint32_t kind, const scoring *s, uint32_t o, uint32_t count, const float *dot,
                              const windows *w, float *score)
{
    for (uint32_t i = 0; i < count; i++) {
        const float away = ((float)(int32_t)(o + i) - s->middle) * s->per_sample;
        const float like =
            score_of(kind, s->ref_norm, s->noise2, s->n, dot[i], w->sum[i], w->square[i]) - s->nearer * away * away;
        const float score_in = smr_clamp(like, SMR_SCORE_LOW, 1.0f);
        score[i] = w->missing[i] > 0u ? -1.0f : score_in;
    }
}

/* dot[i]: sum over k of ref[k] line[k + i], in that order. */
static void dots(const float *ref, uint32_t n, const float *line, uint32_t count, float *dot)
{
    for (size_t i = 0; i < count; i++)
        dot[i] = 0.0f;
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < count; i++)
            dot[i] += ref[k] * line[k + i];
}

/* Scores at every offset. line and score have room for SMR_WIDTH - 1 more. */
static void scores_of(uint32_t kind, const scoring *s, const float *ref, uint32_t n, const float *line,
                      const unsigned char *inside, uint32_t offsets, float *score)
{
    float dot[SMR_SIDE];
    running r = {0.0f, 0.0f, 0};
    windows w;
    memset(&w, 0, sizeof w);
    for (uint32_t k = 0; k < n; k++) {
        r.sum += line[k];
        r.square += line[k] * line[k];
        r.missing += !inside[k];
    }
    for (uint32_t o = 0; o < offsets; o += SMR_SIDE) {
        const uint32_t some = smr_min_u32(offsets - o, SMR_SIDE), count = smr_ceil_div(some, SMR_WIDTH) * SMR_WIDTH;
        run_on(&r, line, inside, n, o, some, &w);
        dots(ref, n, line + o, count, dot);
        if (kind == SMR_SIMILARITY_SSD) /* each a loop of its own, without a branch */
            score_side(SMR_SIMILARITY_SSD, s, o, count, dot, &w, score + o);
        else if (kind == SMR_SIMILARITY_CONCORDANCE)
            score_side(SMR_SIMILARITY_CONCORDANCE, s, o, count, dot, &w, score + o);
        else
            score_side(SMR_SIMILARITY_NCC, s, o, count, dot, &w, score + o);
    }
}

/* The highest score from .. to-1 that is not below its neighbours; -1 for none. peak: scratch. Two loops without branches:
 * where scores rise and fall nobody can foretell. */
static float highest_peak(const float *score, uint32_t from, uint32_t to, float *peak)
{
    float highest = -1.0f;
    for (size_t o = from; o < to; o++) {
        const float above = score[o] >= score[o - 1u] ? score[o] : -1.0f;
        peak[o] = score[o] >= score[o + 1u] ? above : -1.0f;
    }
    for (size_t o = from; o < to; o++)
        highest = smr_max(peak[o], highest);
    return highest;
}

/* The best offset between samples, and how far it is to be believed. */
static smr_peak peak_of(const float *score, uint32_t offsets, float *scratch)
{
    uint32_t best = 0;
    float top = -1.0f;
    for (uint32_t o = 0; o < offsets; o++) {
        best = score[o] > top ? o : best;
        top = smr_max(score[o], top);
    }
    const float left = highest_peak(score, 1u, best > SMR_APART ? best - SMR_APART + 1u : 1u, scratch);
    const float second = smr_max(left, highest_peak(score, best + SMR_APART, offsets - 1u, scratch));
    smr_peak peak = {(float)best, 0.0f};
    if (best > 0u && best + 1u < offsets && score[best - 1u] > -1.0f && score[best + 1u] > -1.0f)
        peak.at += refine(score[best - 1u], score[best], score[best + 1u]);
    peak.confidence = smr_max(top - SMR_SCORE_MIN, 0.0f) * (1.0f / (1.0f - SMR_SCORE_MIN)) *
                      smr_clamp((top - second) * SMR_DISTINCT, SMR_DISTINCT_MIN, 1.0f);
    return peak;
}

smr_peak smr_profile_match(const smr_profile *reference, const float *line, const unsigned char *inside, uint32_t m,
                           const smr_likeness *how)
{
    const int level_counts = how->kind != SMR_SIMILARITY_NCC;
    const uint8_t *const packed = reference->value;
    const float low = reference->low, range = reference->range;
    const uint32_t n = reference->n;
    float ref[SMR_PROFILE_MAX], centred[SMR_LINE_MAX + SMR_WIDTH], score[SMR_LINE_MAX + SMR_WIDTH];
    if (!(range > 0.0f) || m < n || n < 3u || n > SMR_PROFILE_MAX || m > SMR_LINE_MAX)
        return none;
    const uint32_t offsets = m - n + 1u;
    /* everything relative to the reference's mean, in its units, so that sums lose no digits */
    float mean = 0.0f, norm = 0.0f;
    for (uint32_t k = 0; k < n; k++)
        mean += (float)packed[k] * (1.0f / 255.0f);
    mean /= (float)n;
    for (uint32_t k = 0; k < n; k++) {
        ref[k] = (float)packed[k] * (1.0f / 255.0f) - mean;
        norm += ref[k] * ref[k];
    }
    for (uint32_t k = 0; k < m; k++)
        centred[k] = inside[k] ? (line[k] - low) / range - mean : 0.0f;
    memset(centred + m, 0, SMR_WIDTH * sizeof *centred);
    float level = 0.0f, count = 0.0f;
    for (uint32_t k = 0; !level_counts && k < m; k++) {
        level += centred[k];
        count += inside[k] ? 1.0f : 0.0f;
    }
    for (uint32_t k = 0; !level_counts && k < m; k++)
        centred[k] -= inside[k] ? level / count : 0.0f;
    const float noise = how->noise / range, middle = 0.5f * (float)(offsets - 1u);
    const scoring how_to = {SMR_SQRT(norm), noise * noise, (float)n, middle, offsets > 1u ? 1.0f / middle : 0.0f,
                            how->nearer};
    score[0] = -1.0f; /* compilers do not see that there is always an offset */
    scores_of(how->kind, &how_to, ref, n, centred, inside, offsets, score);
    return peak_of(score, offsets, centred);
}

static float slope_at(const uint8_t *packed, uint32_t k)
{
    return ((float)packed[k + 1u] - (float)packed[k - 1u]) * (0.5f / 255.0f);
}

/* The reference's own edge. */
typedef struct edge {
    float slope;  /* its size is the measure, its sign the polarity; 0: there is none */
    float level;  /* brightness at its steepest sample, in units of the profile's range */
    float beyond; /* samples, and parts of one, that it lies beyond the surface */
} edge;

/* The strongest one near the reference's surface. */
static edge own_edge(const uint8_t *packed, uint32_t n, uint32_t zero)
{
    edge own = {0.0f, 0.0f, 0.0f};
    uint32_t at = 0;
    for (uint32_t k = 1; k + 1u < n; k++) {
        const float slope = slope_at(packed, k);
        if ((k > zero ? k - zero : zero - k) <= SMR_EDGE_NEAR && smr_abs(slope) > smr_abs(own.slope)) {
            own.slope = slope;
            at = k;
        }
    }
    own.level = (float)packed[at] * (1.0f / 255.0f);
    own.beyond = (float)at - (float)zero;
    if (at >= 2u && at + 2u < n)
        own.beyond += refine(slope_at(packed, at - 1u) / own.slope, slope_at(packed, at) / own.slope,
                             slope_at(packed, at + 1u) / own.slope);
    return own;
}

/* What an edge is worth that is `steep` times as steep as the reference's and `lighter` by so many of its ranges. From
 * half as steep on it is wholly believed; of several the one SMR_STEEP times as steep wins, and at the square of that it is worth what
 * the reference's own is: much steeper ones are somebody else's (bone next to a muscle in CT). */
static float edge_worth(float steep, float lighter)
{
    const float over = steep * (1.0f / SMR_STEEP);
    return 2.0f * steep / ((1.0f + over * over) * (1.0f + lighter * lighter));
}

static int all_inside(const unsigned char *inside, uint32_t n)
{
    uint32_t missing = 0;
    for (uint32_t k = 0; k < n; k++)
        missing += !inside[k];
    return missing == 0u;
}

smr_peak smr_profile_edge(const smr_profile *reference, uint32_t zero, const float *line, const unsigned char *inside,
                          uint32_t m, uint32_t centre, uint32_t reach)
{
    const float range = reference->range;
    if (!(range > 0.0f) || reference->n < 3u)
        return none;
    const edge own = own_edge(reference->value, reference->n, zero);
    if (smr_abs(own.slope) < SMR_EDGE_MIN)
        return none;
    const uint32_t first = smr_max_u32(centre > reach ? centre - reach : 1u, 2u);
    const uint32_t last = smr_min_u32(centre + reach, m - 2u);
    const float scale = 0.5f / (range * own.slope);
    float best = 0.0f;
    uint32_t at = 0;
    for (uint32_t k = first; k <= last && k + 2u < m; k++) {
        const float steep = (line[k + 1u] - line[k - 1u]) * scale;
        if (!(steep > 0.0f) || !all_inside(inside + k - 2u, 5u))
            continue;
        const float away = (float)(k > centre ? k - centre : centre - k) / (float)(reach + 1u);
        const float worth = edge_worth(steep, (line[k] - reference->low) / range - own.level) * (1.0f - 0.5f * away);
        if (worth > best) {
            best = worth;
            at = k;
        }
    }
    if (!(best > 0.0f))
        return none;
    const float *const l = line + at;
    const float part = refine((l[0] - l[-2]) * scale, (l[1] - l[-1]) * scale, (l[2] - l[0]) * scale);
    const smr_peak peak = {(float)at + part - own.beyond, smr_min(best, 1.0f)};
    return peak;
}
