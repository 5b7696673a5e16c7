/* unit_warp.h: landmark sets for tests, and the thin-plate spline in double precision to compare with.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_WARP_H
#define UNIT_WARP_H

#include "oracle.h"
#include "smr.h"

typedef struct unit_landmarks {
    float from[3 * SMR_LANDMARKS_MAX], to[3 * SMR_LANDMARKS_MAX];
    uint32_t n;
} unit_landmarks;

/* n random landmarks in a box of 600 mm around `at`; goals turned, moved, a tenth larger, and each its own way by up to
 * `bend` mm. */
unit_landmarks unit_warp_random(oracle_random *r, uint32_t n, double at, double bend);

/* to = m from + t */
typedef struct unit_affine {
    double m[9], t[3];
} unit_affine;

unit_affine unit_warp_affine(oracle_random *r); /* a rotation with shear and stretch */
void unit_affine_carry(const unit_affine *a, const float *p, float *q);

double unit_apart(const float *a, const float *b);

/* Fits in memory of exactly the size asked for, or ends the program. */
smr_warp *unit_warp_fit(const unit_landmarks *s, float smoothing, uint32_t *kind);
/* The largest distance of a carried landmark from its goal; DBL_MAX when a carried one is not finite. */
double unit_warp_miss(const smr_warp *w, const unit_landmarks *s);

/* The spline of distinct landmarks in double precision and mm: kernel -r, lambda on the diagonal. */
enum { ORACLE_SPLINE_ROWS = SMR_LANDMARKS_MAX + 4 };

typedef struct oracle_spline {
    double x[ORACLE_SPLINE_ROWS][3];
    double at[SMR_LANDMARKS_MAX][3];
    uint32_t n;
} oracle_spline;

void oracle_spline_fit(oracle_spline *w, const unit_landmarks *s, double lambda);
void oracle_spline_apply(const oracle_spline *w, const float *p, double q[3]);

#endif
