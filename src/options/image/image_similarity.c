/* image_similarity.c: decides whether intensity profiles match better in their places than by chance: each profile is
 * compared in its place and in places beside it along the normal. In an image of noise as many comparisons are lost as
 * won, though nearly every vertex finds a goal. Verdicts use it, forces do not: far from its place a model matches
 * nowhere better.
 * Bounds: SMR_BESIDE + 1 places of 2 SMR_SLACK + 1 offsets, SMR_PROFILE_MAX multiply-adds each.
 * SPDX-License-Identifier: MIT */
#include "image/intensity_profile.h"
#include "options/image/image.h"

#define SMR_BESIDE 6u       /* number of places beside a vertex, along its normal, to compare with */
#define SMR_BESIDE_MM 12.0f /* distance between the vertex and the first place on either side, and between places, mm */
#define SMR_SLACK 2u        /* largest offset from a place, in samples; the best of all offsets counts */

/* Returns the concordance (profile_match.c) of profile and samples, each less its mean; -1 for NaN. */
static float concordance(const smr_profile *r, const float *line, float noise)
{
    float a = 0.0f, b = 0.0f, aa = 0.0f, bb = 0.0f, ab = 0.0f;
    const float per = 1.0f / (float)r->n, least = noise / r->range;
    for (uint32_t k = 0; k < r->n; k++) {
        const float x = (float)r->value[k] * (1.0f / 255.0f), y = (line[k] - r->low) / r->range;
        a += x;
        b += y;
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    a *= per;
    b *= per;
    const float spread = smr_max(aa * per - a * a, 0.0f) + smr_max(bb * per - b * b, 0.0f);
    const float score = 2.0f * (ab * per - a * b) / (spread + least * least);
    return smr_within(score, 1.0f) ? score : -1.0f;
}

/* Writes the best concordance of r with the image near the place `first`. Returns 0 when a sample lies outside. */
static int score_at(const smr_image_goals *g, const smr_profile *r, smr_vec first, smr_vec step, float noise,
                    float *best)
{
    float line[SMR_PROFILE_MAX + 2u * SMR_SLACK];
    unsigned char inside[SMR_PROFILE_MAX + 2u * SMR_SLACK];
    const uint32_t n = r->n + 2u * SMR_SLACK;
    const smr_vec start = smr_sub(first, smr_scale(step, (float)SMR_SLACK));
    if (smr_grid_line(&g->grid, start, step, n, line, inside) < n)
        return 0;
    *best = -1.0f;
    for (uint32_t o = 0; o <= 2u * SMR_SLACK; o++)
        *best = smr_max(*best, concordance(r, line + o, noise));
    return 1;
}

void smr_image_compare(const smr_image_goals *g, uint32_t v, int32_t *wins, uint32_t *n)
{
    const smr_model *m = g->shared->model;
    const uint32_t samples = smr_le32(m->profile_samples);
    const uint32_t *ranges = (const uint32_t *)smr_at(m, m->at_ranges) + 2u * (size_t)v;
    const smr_profile r = {(const uint8_t *)smr_at(m, m->at_profiles) + (size_t)v * samples, smr_le_float(ranges[0]),
                           smr_le_float(ranges[1]), samples};
    const float noise = g->structure[smr_model_owner(m, v)].noise;
    const smr_vec normal = smr_get3(g->shape->normal, v);
    const smr_vec step = smr_scale(normal, smr_le_float(m->profile_step));
    const smr_vec at = smr_add(smr_get3(g->shape->x, v), g->shape->origin);
    const smr_vec first = smr_sub(at, smr_scale(step, (float)smr_le32(m->profile_inward)));
    float own = 0.0f, other = 0.0f;
    *wins = 0;
    *n = 0;
    if (!(r.range > 0.0f) || smr_dot(normal, normal) < 0.5f || !score_at(g, &r, first, step, noise, &own))
        return;
    for (uint32_t k = 0; k < SMR_BESIDE; k++) {
        const float far = SMR_BESIDE_MM * (float)(1u + k / 2u) * (k % 2u != 0u ? -1.0f : 1.0f);
        if (!score_at(g, &r, smr_add(first, smr_scale(normal, far)), step, noise, &other))
            continue;
        *wins += (own > other) - (own < other);
        ++*n;
    }
}
