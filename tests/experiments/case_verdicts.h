/* case_verdicts.h: many runs with a known truth, as rows of a table that verdicts are tuned and judged by.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_VERDICTS_H
#define CASE_VERDICTS_H

#include <stdint.h>

/* Runs the seeds and writes a row each as CSV: what was run, its true errors, what the verdict said, and every value
 * of report.json. Only this kind when it is not NULL. The directory keeps what runs share. 0 when all could run. */
int case_verdicts(uint32_t first, uint32_t last, const char *kind, const char *directory, const char *csv);

/* What runs of even seeds (half 0) or odd ones (half 1) show. */
typedef struct case_counts {
    uint32_t n, far, far_good;    /* errors above 3 mm, or hopeless; how many of them were called good */
    uint32_t near, near_not;      /* errors below 1 mm; how many of them were not called good */
    double spearman;              /* median over partial runs and images; NaN: no expected errors */
    uint32_t n_ratios, ratios_in; /* mean expected over mean true error: how many lie within 0.7..1.5 */
} case_counts;

/* by_vertex: a run's error is that of the vertices' places, where they are known, or else the surface's. */
case_counts case_count(const char *csv, int half, int by_vertex);

/* Prints such counts for both halves and both errors, with 95 % upper bounds, and a line for each kind. */
int case_judge(const char *csv);

/* Clopper and Pearson: the largest share p for which k or fewer of n are not less likely than 5 %. */
double case_upper_bound(uint32_t k, uint32_t n);

#endif
