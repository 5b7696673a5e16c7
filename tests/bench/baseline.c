/* baseline.c: rigid shape matching with plain float sums. A record has 16 floats, a cache line, as in the library;
 * six or twelve of them are summed. The compiler may vectorise all loops.
 * SPDX-License-Identifier: MIT */
#include "baseline.h"
#include <math.h>
#include <string.h>
#include "../property/rig.h"

#define WORDS 16u

static inline void add_direct(const baseline *b, const uint32_t words)
{
    const rig_lists *l = &b->lists;
    for (uint32_t v = 0; v < l->n; v++) {
        float sum[WORDS] = {0};
        for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
            const float *r = b->record + WORDS * (size_t)l->zeta[k];
            for (uint32_t w = 0; w < words; w++)
                sum[w] += r[w];
        }
        memcpy(b->sum + WORDS * (size_t)v, sum, sizeof sum);
    }
}

static inline void add_chain(const baseline *b, const uint32_t words)
{
    const rig_lists *l = &b->lists;
    for (uint32_t i = 0; i < l->n; i++) {
        float sum[WORDS] = {0};
        if (l->parent[i] != l->vertex[i])
            memcpy(sum, b->sum + WORDS * (size_t)l->parent[i], sizeof sum);
        for (uint32_t k = l->plus_start[i]; k < l->plus_start[i + 1u]; k++) {
            const float *r = b->record + WORDS * (size_t)l->plus[k];
            for (uint32_t w = 0; w < words; w++)
                sum[w] += r[w];
        }
        for (uint32_t k = l->minus_start[i]; k < l->minus_start[i + 1u]; k++) {
            const float *r = b->record + WORDS * (size_t)l->minus[k];
            for (uint32_t w = 0; w < words; w++)
                sum[w] -= r[w];
        }
        memcpy(b->sum + WORDS * (size_t)l->vertex[i], sum, sizeof sum);
    }
}

static void add(const baseline *b, int chain, int wide)
{
    if (chain && wide)
        add_chain(b, 12);
    else if (chain)
        add_chain(b, 8);
    else if (wide)
        add_direct(b, 12);
    else
        add_direct(b, 8);
}

/* Inverse of a symmetric 3x3 matrix by cofactors. */
static void invert(const double m[9], float out[9])
{
    double cofactor[9];
    for (uint32_t i = 0; i < 3u; i++) {
        for (uint32_t k = 0; k < 3u; k++) {
            const uint32_t a = (i + 1u) % 3u, b = (i + 2u) % 3u, c = (k + 1u) % 3u, d = (k + 2u) % 3u;
            cofactor[3u * k + i] = m[3u * a + c] * m[3u * b + d] - m[3u * a + d] * m[3u * b + c];
        }
    }
    const double det = m[0] * cofactor[0] + m[1] * cofactor[3] + m[2] * cofactor[6];
    for (uint32_t i = 0; i < 9u; i++)
        out[i] = fabs(det) > 1.0e-6 ? (float)(cofactor[i] / det) : 0.0f;
}

baseline baseline_start(const smr_model *model)
{
    baseline b = {.lists = rig_decode(model, 0, 0, 0)};
    const rig_lists *l = &b.lists;
    b.ref = rig_alloc(l->n * 3u * sizeof(float));
    b.goal = rig_alloc(l->n * 3u * sizeof(float));
    b.centre = rig_alloc(l->n * 3u * sizeof(float));
    b.inverse = rig_alloc(l->n * 9u * sizeof(float));
    b.record = rig_alloc(l->n * WORDS * sizeof(float));
    b.sum = rig_alloc(l->n * WORDS * sizeof(float));
    b.x = rig_alloc(l->n * 3u * sizeof(float));
    smr_model_info info;
    (void)smr_model_get_info(model, &info);
    for (size_t i = 0; i < 3u * (size_t)l->n; i++) {
        b.ref[i] = l->xyz[i] - info.centre[i % 3u];
        b.goal[i] = b.ref[i] + 3.0f * sinf(b.ref[i / 3u * 3u] * 0.05f + (float)(i % 3u));
    }
    for (uint32_t v = 0; v < l->n; v++) {
        const double n = (double)(l->zeta_start[v + 1u] - l->zeta_start[v]);
        double sum[3] = {0, 0, 0}, inertia[9] = {0};
        for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++)
            for (uint32_t a = 0; a < 3u; a++)
                sum[a] += (double)b.ref[3u * (size_t)l->zeta[k] + a] / n;
        for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
            double d[3], d2 = 0.0;
            for (uint32_t a = 0; a < 3u; a++) {
                d[a] = (double)b.ref[3u * (size_t)l->zeta[k] + a] - sum[a];
                d2 += d[a] * d[a];
            }
            for (uint32_t a = 0; a < 9u; a++)
                inertia[a] += (a % 4u == 0u ? d2 : 0.0) - d[a / 3u] * d[a % 3u];
        }
        invert(inertia, b.inverse + 9u * (size_t)v);
        for (uint32_t a = 0; a < 3u; a++)
            b.centre[3u * (size_t)v + a] = (float)sum[a];
    }
    return b;
}

/* [R - I, t] of one cluster out of its sums. */
static void match_one(const baseline *b, uint32_t v, float *to)
{
    const float *s = b->sum + WORDS * (size_t)v, *c = b->centre + 3u * (size_t)v,
                *inverse = b->inverse + 9u * (size_t)v;
    const float n = (float)(b->lists.zeta_start[v + 1u] - b->lists.zeta_start[v]);
    const float l[3] = {s[3] - (c[1] * s[2] - c[2] * s[1]), s[4] - (c[2] * s[0] - c[0] * s[2]),
                        s[5] - (c[0] * s[1] - c[1] * s[0])};
    float w[3], a2 = 1.0e-20f;
    for (uint32_t i = 0; i < 3u; i++) {
        w[i] = inverse[3u * i] * l[0] + inverse[3u * i + 1u] * l[1] + inverse[3u * i + 2u] * l[2];
        a2 += w[i] * w[i];
    }
    const float a = sqrtf(a2), sine = sinf(a) / a, cosine = (1.0f - cosf(a)) / a2;
    const float skew[9] = {0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0};
    for (uint32_t i = 0; i < 9u; i++)
        to[i] = sine * skew[i] + cosine * (w[i / 3u] * w[i % 3u] - (i % 4u == 0u ? a2 : 0.0f));
    for (uint32_t i = 0; i < 3u; i++)
        to[9u + i] = s[i] / n - (to[3u * i] * c[0] + to[3u * i + 1u] * c[1] + to[3u * i + 2u] * c[2]);
}

void baseline_match(baseline *b, int chain)
{
    const uint32_t n = b->lists.n;
    for (uint32_t v = 0; v < n; v++) {
        float *r = b->record + WORDS * (size_t)v, u[3];
        const float *ref = b->ref + 3u * (size_t)v;
        for (uint32_t a = 0; a < 3u; a++)
            r[a] = u[a] = b->goal[3u * (size_t)v + a] - ref[a];
        r[3] = ref[1] * u[2] - ref[2] * u[1];
        r[4] = ref[2] * u[0] - ref[0] * u[2];
        r[5] = ref[0] * u[1] - ref[1] * u[0];
        r[6] = r[7] = 0.0f;
    }
    add(b, chain, 0);
    for (uint32_t v = 0; v < n; v++)
        match_one(b, v, b->record + WORDS * (size_t)v);
    add(b, chain, 1);
    for (uint32_t v = 0; v < n; v++) {
        const float *s = b->sum + WORDS * (size_t)v, *ref = b->ref + 3u * (size_t)v;
        const float share = 1.0f / (float)(b->lists.zeta_start[v + 1u] - b->lists.zeta_start[v]);
        for (uint32_t i = 0; i < 3u; i++) {
            b->x[3u * (size_t)v + i] =
                ref[i] + share * (s[3u * i] * ref[0] + s[3u * i + 1u] * ref[1] + s[3u * i + 2u] * ref[2] + s[9u + i]);
        }
    }
}
