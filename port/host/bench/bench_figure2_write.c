/* bench_figure2_write.c: writes figure2.csv and figure2.svg, and prints the summary.
 * SPDX-License-Identifier: MIT */
#include "bench/bench_figure2.h"

#include <stdio.h>
#include <string.h>

#include "bench/bench_job.h"
#include "bench/bench_plot.h"

static const char *const methods[2] = {"rigid", "polar"};
static const char *const time_names[HOST_TIMES] = {"with_forces", "without_forces", "matching"};
static const char *const error_names[HOST_ERRORS][2] = {{"rigid", "fixed"}, {"polar", "fixed"}, {"rigid", "growing"}};

static void put_fits(const char *name, host_line line[2][HOST_TIMES], host_buffer *out)
{
    uint32_t m = 0, p = 0;
    for (m = 0; m < 2; m++)
        for (p = 0; p < HOST_TIMES; p++)
            host_buffer_print(out, "%s,%s,%s,,,,,,,,,%.6f,%.6f,%.6f,%.6f\n", name, methods[m], time_names[p],
                              line[m][p].at_0, line[m][p].at_100, line[m][p].slope, line[m][p].r2);
}

/* One table for times, errors and fits: columns without a value stay empty. */
static void put_csv(host_figure2 *f, host_buffer *out)
{
    uint32_t m = 0, p = 0, i = 0;
    host_buffer_print(out, "row,method,part,ignored_percent,active_vertices,median_ms,least_ms,samples,"
                           "to_truth_mm,from_truth_mm,vertex_mm,ms_at_0_percent,ms_at_100_percent,ms_per_percent,r2\n");
    for (m = 0; m < 2; m++)
        for (p = 0; p < HOST_TIMES; p++)
            for (i = 0; i < f->n_times; i++)
                host_buffer_print(out, "time,%s,%s,%.3f,%u,%.6f,%.6f,%u,,,,,,,\n", methods[m], time_names[p],
                                  f->ignored[i], f->active[i], f->ms[m][p][i], f->least_ms[m][p][i], f->n_samples);
    for (p = 0; p < HOST_ERRORS; p++)
        for (i = 0; i < f->n_errors; i++) {
            host_buffer_print(out, "error,%s,%s,%.3f,%u,,,,%.6f,%.6f,", error_names[p][0], error_names[p][1],
                              f->asked[i], f->last_active[p][i], f->to_truth[p][i], f->from_truth[p][i]);
            if (f->by_vertex[p][i] > 0.0)
                host_buffer_print(out, "%.6f", f->by_vertex[p][i]);
            host_buffer_print(out, ",,,,\n");
        }
    put_fits("fit", f->line, out);
    put_fits("fit_all", f->line_all, out);
}

static void put_svg(const host_figure2 *f, host_buffer *out)
{
    static const char *const names[2][2] = {{"rigid, with external forces", "rigid, without"},
                                            {"polar, with external forces", "polar, without"}};
    static const char *const error_texts[HOST_ERRORS] = {"rigid", "polar", "rigid, growing to all vertices"};
    static const char *const colours[HOST_ERRORS] = {"#0b6bb8", "#c8400f", "#2b8a3e"};
    host_plot plot[2];
    char title[160];
    uint32_t m = 0, p = 0;
    memset(plot, 0, sizeof plot);
    plot[0].title = "Time of an iteration (points) and linear fit";
    plot[0].y_label = "ms, one thread";
    plot[1].title = "Segmentation error after registration";
    plot[1].y_label = "mean distance to the truth, mm";
    plot[1].legend_left = 1;
    for (m = 0; m < 2; m++) {
        plot[m].x_label = "ignored vertices, %";
        plot[m].x_max = 100.0;
        for (p = HOST_TIME_WITH; p <= HOST_TIME_WITHOUT; p++) {
            const host_line *const line = &f->line[m][p];
            const host_curve curve = {names[m][p],
                                      colours[m],
                                      p == HOST_TIME_WITH ? "none" : "6 4",
                                      f->ignored,
                                      f->ms[m][p],
                                      f->n_times,
                                      1,
                                      {line->at_0, line->slope}};
            plot[0].curve[plot[0].n_curves++] = curve;
        }
    }
    for (p = 0; p < HOST_ERRORS; p++) {
        const host_curve curve = {error_texts[p],
                                  colours[p],
                                  p == HOST_ERROR_POLAR ? "6 4" : "none",
                                  f->asked,
                                  f->to_truth[p],
                                  f->n_errors,
                                  0,
                                  {0.0, 0.0}};
        plot[1].curve[plot[1].n_curves++] = curve;
    }
    (void)snprintf(title, sizeof title, "Complexity tuning: %s of %u structures, %u vertices",
                   f->seed > 0 ? "a computed thigh" : "a model", f->n_structures, f->n_vertices);
    host_plot_write(plot, 2, title, out);
}

static void print_summary(const host_figure2 *f, const char *out)
{
    uint32_t m = 0, p = 0, i = 0;
    (void)printf(
        "%u structures, %u vertices; time of an iteration, ms, median of %u; fit to equal steps (and the last share)\n",
        f->n_structures, f->n_vertices, f->n_samples);
    for (m = 0; m < 2; m++)
        for (p = 0; p < HOST_TIMES; p++)
            (void)printf(
                "%-6s %-15s %7.3f with all vertices, %7.3f with %u; fit: %7.3f at 100 %% ignored, R^2 %.4f (%.4f)\n",
                methods[m], time_names[p], f->ms[m][p][0], f->ms[m][p][f->n_times - 1u], f->active[f->n_times - 1u],
                f->line[m][p].at_100, f->line[m][p].r2, f->line_all[m][p].r2);
    for (p = 0; p < HOST_TIMES; p++)
        (void)printf("%s: rigid takes %.1f %% less time than polar with all vertices\n", time_names[p],
                     100.0 * (1.0 - f->ms[SMR_METHOD_RIGID][p][0] / f->ms[SMR_METHOD_POLAR][p][0]));
    for (p = 0; p < HOST_ERRORS; p++) {
        (void)printf("error, mm, %s, %s share, 0 to %.0f %% ignored:", error_names[p][0], error_names[p][1],
                     f->asked[f->n_errors - 1u]);
        for (i = 0; i < f->n_errors; i++)
            (void)printf(" %.3f", f->to_truth[p][i]);
        (void)printf("\n");
    }
    (void)printf("%s: figure2.csv, figure2.svg\n", out);
}

int host_figure2_write(host_figure2 *figure, const host_options *options, host_error *error)
{
    host_buffer csv, svg;
    memset(&csv, 0, sizeof csv);
    memset(&svg, 0, sizeof svg);
    put_csv(figure, &csv);
    put_svg(figure, &svg);
    if (host_bench_write(options->out, "figure2", &csv, &svg, error) != 0)
        return -1;
    if (!options->quiet)
        print_summary(figure, options->out);
    return 0;
}
