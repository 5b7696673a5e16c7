/* bench_figure2.h: the paper's figure 2: the measured values. bench_figure2.c measures, bench_figure2_write.c writes
 * the files.
 * SPDX-License-Identifier: MIT */
#ifndef BENCH_FIGURE2_H
#define BENCH_FIGURE2_H

#include "options/options.h"

#define HOST_SHARES 21u /* most shares: 0, 5, ... 95 % ignored, and the largest possible share */

/* Times of an iteration. WITH: all stages. WITHOUT: the same iterations without the external forces.
 * MATCHING: sums, match and average, the stages in which the two methods differ. */
enum { HOST_TIME_WITH = 0, HOST_TIME_WITHOUT, HOST_TIME_MATCHING, HOST_TIMES };
/* Rigid and polar with a fixed active share; rigid with an active share that grows to all vertices. */
enum { HOST_ERROR_RIGID = 0, HOST_ERROR_POLAR, HOST_ERROR_GROWING, HOST_ERRORS };

typedef struct host_line {
    double at_0, slope; /* y = at_0 + slope x; x: % of vertices ignored */
    double at_100, r2;  /* at_100: y at x = 100, extrapolated; r2: coefficient of determination */
} host_line;

typedef struct host_figure2 {
    uint32_t n_vertices, n_structures, seed, n_samples, repetitions; /* seed 0: real data */
    uint32_t n_times;                                                /* shares with times, at most HOST_SHARES */
    uint32_t active[HOST_SHARES];
    double ignored[HOST_SHARES];           /* %, as measured */
    double ms[2][HOST_TIMES][HOST_SHARES]; /* medians, ms; [SMR_METHOD_...][HOST_TIME_...][share] */
    double least_ms[2][HOST_TIMES][HOST_SHARES];
    host_line line[2][HOST_TIMES];                  /* fitted to the equally spaced shares */
    host_line line_all[2][HOST_TIMES];              /* fitted to all shares, the largest possible one included */
    uint32_t n_errors;                              /* shares with errors */
    double asked[HOST_SHARES];                      /* % ignored, as requested */
    uint32_t last_active[HOST_ERRORS][HOST_SHARES]; /* active vertices at the end; a small radius may need more */
    double to_truth[HOST_ERRORS][HOST_SHARES];      /* mean distance of the result's vertices to the truth, mm */
    double from_truth[HOST_ERRORS][HOST_SHARES];
    double by_vertex[HOST_ERRORS][HOST_SHARES];
} host_figure2;

/* Writes figure2.csv and figure2.svg into the output directory; prints a summary unless quiet. 0, or -1 with the
 * error filled. */
int host_figure2_write(host_figure2 *figure, const host_options *options, host_error *error);

#endif
