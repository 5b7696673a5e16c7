/* oracle.c: double-precision references: slow, plain, and not derived from the code under test.
 * SPDX-License-Identifier: MIT */
#include "oracle.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

oracle_random oracle_seed(uint32_t seed)
{
    oracle_random r = {0x9e3779b97f4a7c15u + seed};
    for (int i = 0; i < 8; i++)
        (void)oracle_next(&r);
    return r;
}

uint32_t oracle_next(oracle_random *r)
{
    r->state ^= r->state >> 12;
    r->state ^= r->state << 25;
    r->state ^= r->state >> 27;
    return (uint32_t)((r->state * 0x2545f4914f6cdd1du) >> 32);
}

uint32_t oracle_below(oracle_random *r, uint32_t n) { return (uint32_t)(((uint64_t)oracle_next(r) * n) >> 32); }

double oracle_uniform(oracle_random *r, double lo, double hi)
{
    return lo + (hi - lo) * ((double)oracle_next(r) / 4294967296.0);
}

float oracle_uniformf(oracle_random *r, float lo, float hi) { return (float)oracle_uniform(r, (double)lo, (double)hi); }

void oracle_within_box(oracle_random *r, float lo, float hi, float p[3])
{
    for (uint32_t c = 0; c < 3u; c++)
        p[c] = oracle_uniformf(r, lo, hi);
}

void oracle_turn(const double axis[3], double angle, double m[9])
{
    const double l = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    memcpy(m, identity, sizeof identity);
    if (l <= 0.0)
        return;
    const double x = axis[0] / l, y = axis[1] / l, z = axis[2] / l, c = cos(angle), s = sin(angle), k = 1.0 - c;
    const double r[9] = {c + k * x * x,     k * x * y - s * z, k * x * z + s * y, k * x * y + s * z, c + k * y * y,
                         k * y * z - s * x, k * x * z - s * y, k * y * z + s * x, c + k * z * z};
    memcpy(m, r, sizeof r);
}

void oracle_rotation(oracle_random *r, double m[9])
{
    double axis[3], l2;
    do {
        for (int i = 0; i < 3; i++)
            axis[i] = oracle_uniform(r, -1.0, 1.0);
        l2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
    } while (l2 > 1.0 || l2 < 1e-3);
    oracle_turn(axis, oracle_uniform(r, -3.14159265, 3.14159265), m);
}

void oracle_product(const double a[9], const double b[9], double out[9])
{
    double m[9];
    for (int i = 0; i < 9; i++)
        m[i] = a[i / 3 * 3] * b[i % 3] + a[i / 3 * 3 + 1] * b[3 + i % 3] + a[i / 3 * 3 + 2] * b[6 + i % 3];
    memcpy(out, m, sizeof m);
}

void oracle_transpose(const double a[9], double out[9])
{
    const double m[9] = {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
    memcpy(out, m, sizeof m);
}

double oracle_determinant(const double m[9])
{
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

double oracle_difference(const double *a, const double *b, size_t n)
{
    double worst = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double d = fabs(a[i] - b[i]);
        if (!(d <= worst))
            worst = isnan(d) ? HUGE_VAL : d;
    }
    return worst;
}

double oracle_not_rotation(const double m[9])
{
    double t[9], p[9];
    oracle_transpose(m, t);
    oracle_product(t, m, p);
    const double off = oracle_difference(p, identity, 9), det = fabs(oracle_determinant(m) - 1.0);
    return off >= det ? off : (isnan(det) ? HUGE_VAL : det);
}

void oracle_widen(const float *from, double *to, size_t n)
{
    for (size_t i = 0; i < n; i++)
        to[i] = (double)from[i];
}

void oracle_eigen(const double a[9], double value[3], double v[9])
{
    double d[9], t[9], g[9];
    memcpy(d, a, sizeof d);
    memcpy(v, identity, sizeof identity);
    for (int sweep = 0; sweep < 60; sweep++) {
        for (int p = 0; p < 2; p++) {
            for (int q = p + 1; q < 3; q++) {
                const double angle = 0.5 * atan2(2.0 * d[3 * p + q], d[4 * p] - d[4 * q]);
                memcpy(g, identity, sizeof identity);
                g[4 * p] = g[4 * q] = cos(angle);
                g[3 * q + p] = sin(angle);
                g[3 * p + q] = -sin(angle);
                oracle_transpose(g, t);
                oracle_product(t, d, d);
                oracle_product(d, g, d);
                oracle_product(v, g, v);
            }
        }
    }
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 3; i++)
        for (int k = i + 1; k < 3; k++)
            if (d[4 * order[k]] > d[4 * order[i]]) {
                const int swap = order[i];
                order[i] = order[k];
                order[k] = swap;
            }
    memcpy(t, v, sizeof t);
    for (int k = 0; k < 3; k++) {
        value[k] = d[4 * order[k]];
        for (int row = 0; row < 3; row++)
            v[3 * row + k] = t[3 * row + order[k]];
    }
    if (oracle_determinant(v) < 0.0)
        for (int row = 0; row < 3; row++)
            v[3 * row + 2] = -v[3 * row + 2];
}

void oracle_polar(const double a[9], double r[9], double singular[3])
{
    double t[9], s[9], v[9], u[9];
    oracle_transpose(a, t);
    oracle_product(t, a, s);
    oracle_eigen(s, singular, v);
    oracle_product(a, v, u); /* columns: singular value times left vector */
    for (int k = 0; k < 2; k++) {
        for (int j = 0; j < k; j++) {
            const double dot = u[j] * u[k] + u[3 + j] * u[3 + k] + u[6 + j] * u[6 + k];
            for (int row = 0; row < 9; row += 3)
                u[row + k] -= dot * u[row + j];
        }
        const double l = sqrt(u[k] * u[k] + u[3 + k] * u[3 + k] + u[6 + k] * u[6 + k]);
        for (int row = 0; row < 9; row += 3)
            u[row + k] = l > 0.0 ? u[row + k] / l : 0.0;
    }
    for (int k = 0; k < 3; k++)
        singular[k] = sqrt(singular[k] > 0.0 ? singular[k] : 0.0);
    u[2] = u[3] * u[7] - u[6] * u[4]; /* the third from the first two: a proper rotation */
    u[5] = u[6] * u[1] - u[0] * u[7];
    u[8] = u[0] * u[4] - u[3] * u[1];
    oracle_transpose(v, t);
    oracle_product(u, t, r);
}

static double segment2(const double p[3], const double a[3], const double b[3])
{
    double t = 0.0, l2 = 0.0, d2 = 0.0;
    for (int i = 0; i < 3; i++) {
        t += (p[i] - a[i]) * (b[i] - a[i]);
        l2 += (b[i] - a[i]) * (b[i] - a[i]);
    }
    t = l2 > 0.0 ? fmin(fmax(t / l2, 0.0), 1.0) : 0.0;
    for (int i = 0; i < 3; i++) {
        const double d = p[i] - a[i] - t * (b[i] - a[i]);
        d2 += d * d;
    }
    return d2;
}

double oracle_triangle(const double p[3], const double a[3], const double b[3], const double c[3])
{
    double best = fmin(segment2(p, a, b), fmin(segment2(p, b, c), segment2(p, c, a)));
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double n2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (!(n2 > 0.0))
        return best;
    double h = 0.0, side[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        h += (p[i] - a[i]) * n[i];
    const double *corner[4] = {a, b, c, a};
    for (int e = 0; e < 3; e++) { /* on which side of each edge's wall */
        const double *f = corner[e], *g = corner[e + 1];
        const double x[3] = {g[0] - f[0], g[1] - f[1], g[2] - f[2]}, y[3] = {p[0] - f[0], p[1] - f[1], p[2] - f[2]};
        side[e] = n[0] * (x[1] * y[2] - x[2] * y[1]) + n[1] * (x[2] * y[0] - x[0] * y[2]) +
                  n[2] * (x[0] * y[1] - x[1] * y[0]);
    }
    if (side[0] >= 0.0 && side[1] >= 0.0 && side[2] >= 0.0)
        best = fmin(best, h * h / n2);
    return best;
}

uint32_t oracle_crc(const void *data, size_t n)
{
    const unsigned char *p = data;
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < n; i++) {
        crc ^= p[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1u)));
    }
    return ~crc;
}

int oracle_within(const char *what, double residual, double budget)
{
    const char *print = getenv("SMR_PRINT_RESIDUALS");
    const int good = residual <= budget;
    if (!good || (print != NULL && strcmp(print, "1") == 0))
        printf("residual %-44s %.3g of %.3g%s\n", what, residual, budget, good ? "" : "  MISSED");
    return good;
}
