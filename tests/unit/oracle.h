/* oracle.h: the same mathematics in double precision, written another way, for tests to compare with.
 * SPDX-License-Identifier: MIT */
#ifndef ORACLE_H
#define ORACLE_H

#include <stddef.h>
#include <stdint.h>

/* A small generator (xorshift64*): the same numbers on every host. */
typedef struct oracle_random {
    uint64_t state; /* not 0 */
} oracle_random;

oracle_random oracle_seed(uint32_t seed);
uint32_t oracle_next(oracle_random *r);
uint32_t oracle_below(oracle_random *r, uint32_t n);
double oracle_uniform(oracle_random *r, double lo, double hi);
float oracle_uniformf(oracle_random *r, float lo, float hi);
void oracle_within_box(oracle_random *r, float lo, float hi, float p[3]); /* three numbers, one after the other */

/* 3x3 matrices are row-major double[9]. */
void oracle_rotation(oracle_random *r, double m[9]);               /* any rotation */
void oracle_turn(const double axis[3], double angle, double m[9]); /* axis need not be unit; zero: identity */
void oracle_product(const double a[9], const double b[9], double out[9]);
void oracle_transpose(const double a[9], double out[9]);
double oracle_determinant(const double m[9]);
/* The largest entry of |R^T R - I|, and |det R - 1| when that is larger. */
double oracle_not_rotation(const double m[9]);
double oracle_difference(const double *a, const double *b, size_t n); /* largest |a - b| */
void oracle_widen(const float *from, double *to, size_t n);

/* Symmetric a: eigenvalues, largest first, and eigenvectors as columns of a proper rotation. 60 Jacobi sweeps. */
void oracle_eigen(const double a[9], double value[3], double v[9]);
/* The proper rotation nearest to a (det R = 1, also for reflected a), by A = U S V^T. Singular values come largest
 * first. */
void oracle_polar(const double a[9], double r[9], double singular[3]);

/* Squared distance from p to the triangle: the least of the inside projection and the three edges. */
double oracle_triangle(const double p[3], const double a[3], const double b[3], const double c[3]);

/* CRC-32 bit by bit. */
uint32_t oracle_crc(const void *data, size_t n);

/* 1 when the residual is within its budget. SMR_PRINT_RESIDUALS=1 prints every one; a miss is always printed. */
int oracle_within(const char *what, double residual, double budget);

#endif
