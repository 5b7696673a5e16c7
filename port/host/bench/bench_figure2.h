/* The paper's figure 2: what is measured for it. bench_figure2.c measures, bench_figure2_write.c writes.
 * SPDX-License-Identifier: MIT */
#ifndef BENCH_FIGURE_H
#define BENCH_FIGURE_H

#include "options/options.h"

#define HOST_SHARES 21u /* at most: 0, 5, ... 95 % ignored, and as many as can be */

/* An iteration's time in parts, each a median. WITHOUT: all but the external forces, of the same iterations;
 * MATCHING: sums, transforms and averages, which is what the two methods differ in. */
enum { HOST_TIME_WITH = 0, HOST_TIME_WITHOUT, HOST_TIME_MATCHING, HOST_TIMES };
/* Rigid and polar with a fixed share; rigid with a share that grows from there to all vertices. */
enum { HOST_ERROR_RIGID = 0, HOST_ERROR_POLAR, HOST_ERROR_GROWING, HOST_ERRORS };

typedef struct host_line {
    double at_0, slope; /* y = at_0 + slope x, x in % ignored */
    double at_100, r2;  /* at_100: extrapolated to all vertices ignored; r2: 1 when all points lie on the line */
} host_line;

typedef struct host_figure2 {
    uint32_t n_vertices, n_structures, seed, n_samples, repetitions; /* seed 0: real data */
    uint32_t n_times;                                                /* shares with a time, at most HOST_SHARES */
    uint32_t active[HOST_SHARES];
    double ignored[HOST_SHARES];           /* %, as it was */
    double ms[2][HOST_TIMES][HOST_SHARES]; /* [SMR_METHOD_...]: medians */
    double least_ms[2][HOST_TIMES][HOST_SHARES];
    host_line line[2][HOST_TIMES];                  /* through the shares in equal steps */
    host_line line_all[2][HOST_TIMES];              /* and the last one, of as many ignored as can be */
    uint32_t n_errors;                              /* shares with an error */
    double asked[HOST_SHARES];                      /* % ignored, as asked for */
    uint32_t last_active[HOST_ERRORS][HOST_SHARES]; /* active vertices at the end: the finest radius may need more */
    double to_truth[HOST_ERRORS][HOST_SHARES];      /* mm, means */
    double from_truth[HOST_ERRORS][HOST_SHARES];
    double by_vertex[HOST_ERRORS][HOST_SHARES];
} host_figure2;

/* figure2.csv and figure2.svg into the directory, and the figures in words on stdout unless quiet. */
int host_figure2_write(host_figure2 *figure, const host_options *options, host_error *error);

#endif
