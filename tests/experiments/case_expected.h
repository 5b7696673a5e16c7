/* case_expected.h: how well a result's expected errors tell its true ones.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_EXPECTED_H
#define CASE_EXPECTED_H

#include "case.h"

/* Against the distances to the true places where there are some, and to the true surface. Not a number: none. */
typedef struct case_told {
    double spearman[2], ratio[2]; /* rank correlation; mean expected over mean true error */
} case_told;

/* Reads the property expected_error of DIR/NAME.ply. All values are NaN when a file has none. */
case_told case_tell(const case_data *data, const char *directory);

/* Rank correlation; equal values share their mean rank. */
double case_spearman(const double *a, const double *b, size_t n);

#endif
