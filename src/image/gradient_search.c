/* gradient_search.c: maximal gradient search along the normal (paper 2.1): the steepest edge of the image near the
 * surface whose polarity and brightness agree with the edge of the reference profile, or the steepest edge of all. The
 * position of an edge is refined by a parabola through the neighbouring slopes. Bounds: 2 * reach + 1 samples.
 * SPDX-License-Identifier: MIT */
#include "image/intensity_profile.h"

#define SMR_EDGE_NEAR 3u   /* largest distance of the reference profile's edge from the surface, in samples */
#define SMR_EDGE_MIN 0.08f /* least slope of a usable reference edge, in units of the profile's range per sample */
#define SMR_STEEP 3.0f     /* slope / slope of the reference's edge at which edge_worth() is largest */

/* Returns the slope of the packed profile p at sample k, in units of the profile's range per sample. */
static float slope_at(const uint8_t *p, uint32_t k) { return ((float)p[k + 1u] - (float)p[k - 1u]) * (0.5f / 255.0f); }

/* The edge of the reference profile near the surface. */
typedef struct edge {
    float slope;  /* slope, profile's ranges per sample; > 0: brighter outwards; 0: no edge */
    float level;  /* brightness at the edge, 0 .. 1: the profile's lowest .. highest intensity */
    float beyond; /* distance from the surface to the edge, in samples; positive outwards */
} edge;

/* Returns the steepest edge of a packed profile within SMR_EDGE_NEAR samples of sample `zero`, which is the surface. */
static edge own_edge(const uint8_t *packed, uint32_t n, uint32_t zero)
{
    edge own = {0.0f, 0.0f, 0.0f};
    uint32_t at = 0;
    for (uint32_t k = zero > SMR_EDGE_NEAR ? zero - SMR_EDGE_NEAR : 1u; k <= zero + SMR_EDGE_NEAR && k + 1u < n; k++) {
        const float slope = slope_at(packed, k);
        if (smr_abs(slope) > smr_abs(own.slope)) {
            own.slope = slope;
            at = k;
        }
    }
    own.level = (float)packed[at] * (1.0f / 255.0f);
    own.beyond = (float)at - (float)zero;
    if (at >= 2u && at + 2u < n)
        own.beyond += smr_parabola_peak(slope_at(packed, at - 1u) / own.slope, slope_at(packed, at) / own.slope,
                                        slope_at(packed, at + 1u) / own.slope);
    return own;
}

/* Returns the worth of an edge `steep` times as steep as the reference's and `lighter` ranges brighter: above 1, that
 * is full confidence, if steep > about 0.5; largest at steep = SMR_STEEP. Steeper edges belong to other tissue. */
static float edge_worth(float steep, float lighter)
{
    const float over = steep * (1.0f / SMR_STEEP);
    return 2.0f * steep / ((1.0f + over * over) * (1.0f + lighter * lighter));
}

/* Returns 1 when sample k and two samples on either side lie inside the image. */
static int five_inside(const uint8_t *inside, uint32_t k)
{
    return inside == NULL || (inside[k - 2u] && inside[k - 1u] && inside[k] && inside[k + 1u] && inside[k + 2u]);
}

smr_peak smr_profile_edge(const smr_profile *reference, uint32_t zero, const float *line, const uint8_t *inside,
                          uint32_t m, uint32_t centre, uint32_t reach)
{
    const float range = reference->range;
    if (!(range > 0.0f) || reference->n < 3u || m < 3u || m > SMR_LINE_MAX)
        return (smr_peak){0.0f, 0.0f};
    const edge own = own_edge(reference->value, reference->n, zero);
    if (smr_abs(own.slope) < SMR_EDGE_MIN)
        return (smr_peak){0.0f, 0.0f};
    const uint32_t first = smr_max_u32(centre > reach ? centre - reach : 1u, 2u);
    const uint32_t end = smr_min_u32(centre + reach + 1u, m - 2u);
    const float scale = 0.5f / (range * own.slope);
    float best = 0.0f, worth[SMR_LINE_MAX];
    uint32_t at = 0;
    for (uint32_t k = first; k < end; k++) { /* without branches: the loop vectorises */
        const float steep = (line[k + 1u] - line[k - 1u]) * scale;
        const float away = smr_abs((float)((int32_t)k - (int32_t)centre)) / (float)(reach + 1u);
        worth[k] = edge_worth(steep, (line[k] - reference->low) / range - own.level) * (1.0f - 0.5f * away);
    }
    for (uint32_t k = first; k < end; k++)
        if (worth[k] > best && five_inside(inside, k)) {
            best = worth[k];
            at = k;
        }
    if (!(best > 0.0f))
        return (smr_peak){0.0f, 0.0f};
    const float *const l = line + at;
    const float part = smr_parabola_peak((l[0] - l[-2]) * scale, (l[1] - l[-1]) * scale, (l[2] - l[0]) * scale);
    return (smr_peak){(float)at + part - own.beyond, smr_min(best, 1.0f)};
}

smr_peak smr_steepest(const float *line, const uint8_t *inside, uint32_t m, uint32_t centre, uint32_t reach)
{
    const uint32_t first = smr_max_u32(centre > reach ? centre - reach : 2u, 2u);
    float best = 0.0f;
    uint32_t at = 0;
    for (uint32_t k = first; k <= centre + reach && k + 2u < m; k++) {
        const float steep = smr_abs(line[k + 1u] - line[k - 1u]);
        if (steep > best && five_inside(inside, k)) {
            best = steep;
            at = k;
        }
    }
    if (!(best > 0.0f))
        return (smr_peak){0.0f, 0.0f};
    const float *const l = line + at;
    const float part =
        smr_parabola_peak(smr_abs(l[0] - l[-2]) / best, smr_abs(l[1] - l[-1]) / best, smr_abs(l[2] - l[0]) / best);
    return (smr_peak){(float)at + part, 1.0f};
}
