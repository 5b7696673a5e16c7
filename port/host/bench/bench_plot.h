/* bench_plot.h: line charts side by side in one SVG: axes, ticks, legends, measured points and fitted lines.
 * SPDX-License-Identifier: MIT */
#ifndef BENCH_PLOT_H
#define BENCH_PLOT_H

#include "base/byte_buffer.h"

#define HOST_CURVES_MAX 8u

typedef struct host_curve {
    const char *name, *colour, *dash; /* dash: an SVG dash array, or "none"; texts are not escaped */
    const double *x, *y;              /* [n] */
    uint32_t n;
    int fitted; /* 1: draws the line y = fit[0] + fit[1] x, 0: connects the points */
    double fit[2];
} host_curve;

typedef struct host_plot {
    const char *title, *x_label, *y_label;
    host_curve curve[HOST_CURVES_MAX];
    uint32_t n_curves;
    double x_max;    /* both axes start at 0 */
    double headroom; /* top of the y axis over the largest value; 0: enough for a short legend */
    int legend_left; /* 1: the legend is at the top left, 0: at the top right */
} host_plot;

void host_plot_write(const host_plot *plots, uint32_t n, const char *title, host_buffer *out);

#endif
