/* unit_warp.c: landmark sets for tests, and the thin-plate spline in double precision.
 * SPDX-License-Identifier: MIT */
#include "unit_warp.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "unit_mesh.h"

enum { ROWS = ORACLE_SPLINE_ROWS };

unit_landmarks unit_warp_random(oracle_random *r, uint32_t n, double at, double bend)
{
    unit_landmarks s;
    double turn[9];
    memset(&s, 0, sizeof s);
    oracle_rotation(r, turn);
    s.n = n;
    for (uint32_t i = 0; i < n; i++) {
        double p[3];
        for (int c = 0; c < 3; c++)
            p[c] = oracle_uniform(r, -300, 300);
        for (uint32_t c = 0; c < 3u; c++) {
            const double q = turn[3 * c] * p[0] + turn[3 * c + 1] * p[1] + turn[3 * c + 2] * p[2];
            s.from[3 * i + c] = (float)(p[c] + at);
            s.to[3 * i + c] = (float)(1.1 * q + 50.0 + oracle_uniform(r, -bend, bend));
        }
    }
    return s;
}

unit_affine unit_warp_affine(oracle_random *r)
{
    unit_affine a;
    oracle_rotation(r, a.m);
    for (int i = 0; i < 9; i++)
        a.m[i] += oracle_uniform(r, -0.3, 0.3);
    for (int c = 0; c < 3; c++)
        a.t[c] = oracle_uniform(r, -100, 100);
    return a;
}

void unit_affine_carry(const unit_affine *a, const float *p, float *q)
{
    for (int c = 0; c < 3; c++)
        q[c] = (float)(a->m[3 * c] * (double)p[0] + a->m[3 * c + 1] * (double)p[1] + a->m[3 * c + 2] * (double)p[2] +
                       a->t[c]);
}

static double apart(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

double unit_apart(const float *a, const float *b)
{
    double p[3], q[3];
    oracle_widen(a, p, 3);
    oracle_widen(b, q, 3);
    return apart(p, q);
}

smr_warp *unit_warp_fit(const unit_landmarks *s, float smoothing, uint32_t *kind)
{
    size_t bytes = 0;
    const smr_status sized = smr_warp_bytes(s->n, &bytes);
    void *memory = rig_rough(bytes);
    smr_warp *w = NULL;
    *kind = 99u;
    if (sized != SMR_OK || smr_warp_fit(s->from, s->to, s->n, smoothing, memory, bytes, &w, kind) != SMR_OK ||
        (void *)w != memory) {
        fprintf(stderr, "unit_warp_fit: refused\n");
        exit(1);
    }
    return w;
}

double unit_warp_miss(const smr_warp *w, const unit_landmarks *s)
{
    unit_landmarks at = *s;
    double worst = 0.0;
    if (smr_warp_apply(w, at.from, at.n) != SMR_OK)
        return DBL_MAX;
    for (uint32_t i = 0; i < s->n; i++) {
        const double d = unit_apart(at.from + 3 * i, s->to + 3 * i);
        if (!isfinite(d))
            return DBL_MAX;
        worst = fmax(worst, d);
    }
    return worst;
}

/* Gauss-Jordan with the largest pivot of each column; three right-hand sides behind the m columns. */
static void eliminate(double (*a)[ROWS + 3], uint32_t m)
{
    for (uint32_t k = 0; k < m; k++) {
        uint32_t best = k;
        for (uint32_t i = k + 1; i < m; i++)
            if (fabs(a[i][k]) > fabs(a[best][k]))
                best = i;
        for (uint32_t j = 0; j < m + 3; j++) {
            const double swap = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = swap;
        }
        for (uint32_t i = 0; i < m; i++) {
            const double f = i == k ? 0.0 : a[i][k] / a[k][k];
            for (uint32_t j = k; i != k && j < m + 3; j++)
                a[i][j] -= f * a[k][j];
        }
    }
}

void oracle_spline_fit(oracle_spline *w, const unit_landmarks *s, double lambda)
{
    double(*a)[ROWS + 3] = calloc(ROWS, sizeof *a);
    const uint32_t n = s->n, m = n + 4;
    if (a == NULL)
        exit(1);
    w->n = n;
    oracle_widen(s->from, w->at[0], 3u * (size_t)n);
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k < n; k++)
            a[i][k] = i == k ? lambda : -apart(w->at[i], w->at[k]);
        for (uint32_t c = 0; c < 4u; c++)
            a[i][n + c] = a[n + c][i] = c == 0 ? 300.0 : w->at[i][c - 1]; /* 300: entries of like size */
        for (uint32_t c = 0; c < 3u; c++)
            a[i][m + c] = (double)s->to[3 * i + c];
    }
    eliminate(a, m);
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t c = 0; c < 3u; c++)
            w->x[i][c] = a[i][m + c] / a[i][i];
    free(a);
}

void oracle_spline_apply(const oracle_spline *w, const float *p, double q[3])
{
    const double at[3] = {(double)p[0], (double)p[1], (double)p[2]};
    const double(*tail)[3] = w->x + w->n;
    for (int c = 0; c < 3; c++) {
        q[c] = 300.0 * tail[0][c] + tail[1][c] * at[0] + tail[2][c] * at[1] + tail[3][c] * at[2];
        for (uint32_t i = 0; i < w->n; i++)
            q[c] -= w->x[i][c] * apart(at, w->at[i]);
    }
}
