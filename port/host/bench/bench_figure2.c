/* bench_figure2.c: measures the paper's figure 2: time per iteration and segmentation error against the share of
 * ignored vertices.
 *
 * Times: one iteration in the paper's setting. One cluster radius of 30 mm, profiles of 30 samples every 0.5 mm,
 * searched within 10 mm, fixed reference positions (elastic), no fold handling, one thread. The clock is the thread's
 * processor time, which other programs hardly disturb.
 * Errors: whole registrations with the command line's defaults.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include "bench/bench_job.h"

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
    uint32_t n_vertices, n_structures, n_samples, repetitions;
    uint32_t n_times; /* shares with times, at most HOST_SHARES */
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

static const char *const methods[2] = {"rigid", "polar"};
static const char *const time_names[HOST_TIMES] = {"with_forces", "without_forces", "matching"};
static const char *const error_names[HOST_ERRORS][2] = {{"rigid", "fixed"}, {"polar", "fixed"}, {"rigid", "growing"}};

static void put_fits(const char *name, host_line line[2][HOST_TIMES], host_buffer *out)
{
    for (uint32_t m = 0; m < 2; m++)
        for (uint32_t p = 0; p < HOST_TIMES; p++)
            host_buffer_print(out, "%s,%s,%s,,,,,,,,,%.6f,%.6f,%.6f,%.6f\n", name, methods[m], time_names[p],
                              line[m][p].at_0, line[m][p].at_100, line[m][p].slope, line[m][p].r2);
}

/* One table for times, errors and fits: columns without a value stay empty. */
static void put_csv(host_figure2 *f, host_buffer *out)
{
    host_buffer_print(out, "row,method,part,ignored_percent,active_vertices,median_ms,least_ms,samples,to_truth_mm,"
                           "from_truth_mm,vertex_mm,ms_at_0_percent,ms_at_100_percent,ms_per_percent,r2\n");
    for (uint32_t m = 0; m < 2; m++)
        for (uint32_t p = 0; p < HOST_TIMES; p++)
            for (uint32_t i = 0; i < f->n_times; i++)
                host_buffer_print(out, "time,%s,%s,%.3f,%u,%.6f,%.6f,%u,,,,,,,\n", methods[m], time_names[p],
                                  f->ignored[i], f->active[i], f->ms[m][p][i], f->least_ms[m][p][i], f->n_samples);
    for (uint32_t p = 0; p < HOST_ERRORS; p++)
        for (uint32_t i = 0; i < f->n_errors; i++) {
            host_buffer_print(out, "error,%s,%s,%.3f,%u,,,,%.6f,%.6f,", error_names[p][0], error_names[p][1],
                              f->asked[i], f->last_active[p][i], f->to_truth[p][i], f->from_truth[p][i]);
            if (f->by_vertex[p][i] > 0.0)
                host_buffer_print(out, "%.6f", f->by_vertex[p][i]);
            host_buffer_print(out, ",,,,\n");
        }
    put_fits("fit", f->line, out);
    put_fits("fit_all", f->line_all, out);
}

static void print_summary(const host_figure2 *f, const char *out)
{
    (void)printf(
        "%u structures, %u vertices; time of an iteration, ms, median of %u; fit to equal steps (and the last share)\n",
        f->n_structures, f->n_vertices, f->n_samples);
    for (uint32_t m = 0; m < 2; m++)
        for (uint32_t p = 0; p < HOST_TIMES; p++)
            (void)printf(
                "%-6s %-15s %7.3f with all vertices, %7.3f with %u; fit: %7.3f at 100 %% ignored, R^2 %.4f (%.4f)\n",
                methods[m], time_names[p], f->ms[m][p][0], f->ms[m][p][f->n_times - 1u], f->active[f->n_times - 1u],
                f->line[m][p].at_100, f->line[m][p].r2, f->line_all[m][p].r2);
    for (uint32_t p = 0; p < HOST_TIMES; p++)
        (void)printf("%s: rigid takes %.1f %% less time than polar with all vertices\n", time_names[p],
                     100.0 * (1.0 - f->ms[SMR_METHOD_RIGID][p][0] / f->ms[SMR_METHOD_POLAR][p][0]));
    for (uint32_t p = 0; p < HOST_ERRORS; p++) {
        (void)printf("error, mm, %s, %s share, 0 to %.0f %% ignored:", error_names[p][0], error_names[p][1],
                     f->asked[f->n_errors - 1u]);
        for (uint32_t i = 0; i < f->n_errors; i++)
            (void)printf(" %.3f", f->to_truth[p][i]);
        (void)printf("\n");
    }
    (void)printf("%s: figure2.csv\n", out);
}

/* Writes figure2.csv into the output directory; prints a summary unless quiet. 0, or -1 with the error filled. */
static int host_figure2_write(host_figure2 *figure, const host_options *options, host_error *error)
{
    host_buffer csv = {0};
    put_csv(figure, &csv);
    if (host_output_file(options->out, "figure2.csv", &csv, 0, error) != 0)
        return -1;
    if (!options->quiet)
        print_summary(figure, options->out);
    return 0;
}

#define RADIUS_MM 30.0f
#define SEARCH_MM 10.0f
#define SAMPLES 30u
#define TICKS 5u /* timed ticks per run, after one that computes the clusters' centres */

typedef struct samples {
    double *ms[2][HOST_TIMES][HOST_SHARES]; /* [repetitions * TICKS] */
    uint32_t n;                             /* samples so far in each array */
} samples;

static smr_config paper_config(const host_bench *bench, uint32_t method, double ignored)
{
    smr_config config = bench->given->config;
    config.basic.method = method;
    config.basic.n_workers = 1;
    config.basic.active_share = (float)(1.0 - ignored / 100.0);
    config.schedule.active_first = 1.0f;
    config.schedule.active_enough = 0;
    config.image.sideways = 0.0f;
    config.image.profile_mm = config.image.profile_end_mm = SEARCH_MM;
    config.image.gradient_mm = config.image.gradient_end_mm = 0.5f * SEARCH_MM;
    config.motion.plastic_every = 0;
    config.motion.plastic_um = config.motion.settle_um = 0.0f;
    config.motion.fold_guard = 0;
    config.basic.iterations = config.basic.iterations_last = 100000;
    return config;
}

/* Runs TICKS iterations from the start and stores their times from samples[first] on. */
static int time_iterations(host_bench *bench, uint32_t method, uint32_t share, uint32_t first, host_figure2 *figure,
                           samples *to, host_error *error)
{
    const smr_port port = {NULL, 1, NULL, host_bench_processor_ns};
    const smr_config config = paper_config(bench, method, figure->asked[share]);
    smr_tick_report report;
    if (host_bench_init(bench, &config, &port, 1, error) != 0)
        return -1;
    for (uint32_t i = 0; i <= TICKS; i++) {
        double all = 0.0;
        if (smr_tick(bench->job.state, 0, &report) != SMR_OK)
            return host_fail(error, "tick", "input that can be registered");
        if (i == 0)
            continue;
        for (uint32_t phase = 0; phase < SMR_PHASES; phase++)
            all += 1e-6 * (double)report.details.phase_ns[phase];
        to->ms[method][HOST_TIME_WITH][share][first + i - 1u] = all;
        to->ms[method][HOST_TIME_WITHOUT][share][first + i - 1u] =
            all - 1e-6 * (double)report.details.phase_ns[SMR_PHASE_FORCES];
        to->ms[method][HOST_TIME_MATCHING][share][first + i - 1u] =
            1e-6 * (double)(report.details.phase_ns[SMR_PHASE_SUMS] + report.details.phase_ns[SMR_PHASE_MATCH] +
                            report.details.phase_ns[SMR_PHASE_AVERAGE]);
    }
    figure->active[share] = report.details.n_active;
    figure->ignored[share] = 100.0 * (1.0 - (double)report.details.n_active / figure->n_vertices);
    return 0;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Fits a line to n points by least squares. */
static host_line fit(const double *x, const double *y, uint32_t n)
{
    double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    host_line line;
    for (uint32_t i = 0; i < n; i++) {
        mx += x[i] / n;
        my += y[i] / n;
    }
    for (uint32_t i = 0; i < n; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
        yy += (y[i] - my) * (y[i] - my);
    }
    line.slope = xx > 0.0 ? xy / xx : 0.0;
    line.at_0 = my - line.slope * mx;
    line.at_100 = line.at_0 + 100.0 * line.slope;
    line.r2 = xx > 0.0 && yy > 0.0 ? xy * xy / (xx * yy) : 0.0;
    return line;
}

static void take_medians(host_figure2 *figure, const samples *from, uint32_t n)
{
    for (uint32_t method = 0; method < 2; method++)
        for (uint32_t part = 0; part < HOST_TIMES; part++) {
            for (uint32_t share = 0; share < figure->n_times; share++) {
                double *const ms = from->ms[method][part][share];
                qsort(ms, n, sizeof *ms, by_size);
                figure->ms[method][part][share] = 0.5 * (ms[(n - 1u) / 2u] + ms[n / 2u]);
                figure->least_ms[method][part][share] = ms[0];
            }
            /* the last point may be the largest possible share, which is not equally spaced */
            figure->line[method][part] = fit(figure->ignored, figure->ms[method][part],
                                             figure->n_times > figure->n_errors ? figure->n_errors : figure->n_times);
            figure->line_all[method][part] = fit(figure->ignored, figure->ms[method][part], figure->n_times);
        }
}

/* Measures the shares in turn, repeatedly, so that a slow moment of the machine does not affect one share only. */
static int measure_times(host_bench *bench, host_figure2 *figure, host_error *error)
{
    const uint32_t n = figure->repetitions * TICKS;
    double *const memory = calloc((size_t)n * 2u * HOST_TIMES * HOST_SHARES, sizeof *memory);
    smr_prepare_config prepare = smr_prepare_config_default();
    samples s;
    int result = memory != NULL ? 0 : host_fail(error, "times", "free memory");
    for (uint32_t i = 0; i < 2u * HOST_TIMES * HOST_SHARES; i++)
        s.ms[i / (HOST_TIMES * HOST_SHARES)][i / HOST_SHARES % HOST_TIMES][i % HOST_SHARES] = memory + (size_t)i * n;
    prepare.n_radii = 1;
    prepare.radius_mm[0] = RADIUS_MM;
    prepare.separate_below_mm = 0.0f;
    prepare.profile_samples = SAMPLES;
    if (result == 0)
        result = host_bench_prepare(bench, prepare, 1, error);
    figure->n_vertices = bench->job.model.info.n_vertices;
    figure->n_structures = bench->job.model.info.n_structures;
    for (uint32_t round = 0; result == 0 && round < figure->repetitions; round++)
        for (uint32_t i = 0; result == 0 && i < figure->n_times; i++)
            for (uint32_t method = 0; result == 0 && method < 2; method++)
                result = time_iterations(bench, method, i, round * TICKS, figure, &s, error);
    /* the clusters may need more active vertices than asked for: of equal numbers of them one point remains */
    while (figure->n_times > 1 && figure->active[figure->n_times - 1u] == figure->active[figure->n_times - 2u])
        figure->n_times--;
    if (result == 0)
        take_medians(figure, &s, n);
    free(memory);
    return result;
}

static int measure_error(host_bench *bench, host_figure2 *figure, uint32_t kind, uint32_t share, host_error *error)
{
    smr_config *const config = &bench->options.config;
    const float active = (float)(1.0 - figure->asked[share] / 100.0);
    *config = bench->given->config;
    config->basic.method = kind == HOST_ERROR_POLAR ? SMR_METHOD_POLAR : SMR_METHOD_RIGID;
    config->schedule.active_enough = 0;
    config->basic.active_share = kind == HOST_ERROR_GROWING ? 1.0f : active;
    config->schedule.active_first = active;
    if (host_bench_register(bench, error) != 0)
        return -1;
    figure->last_active[kind][share] = bench->job.last.details.n_active;
    figure->to_truth[kind][share] = bench->job.area.to_target.mean;
    figure->from_truth[kind][share] = bench->job.area.to_result.mean;
    figure->by_vertex[kind][share] = bench->job.by_vertex.n > 0 ? bench->job.by_vertex.mean : 0.0;
    return 0;
}

int host_bench_figure2(host_bench *bench, host_error *error)
{
    host_figure2 *const figure = calloc(1, sizeof *figure);
    if (figure == NULL)
        return host_fail(error, "figure", "free memory");
    figure->repetitions = bench->given->repeats;
    figure->n_samples = figure->repetitions * TICKS;
    figure->n_errors = (99u + bench->given->step) / bench->given->step;
    figure->n_times = figure->n_errors + 1u;
    for (uint32_t i = 0; i < figure->n_times; i++)
        figure->asked[i] = i < figure->n_errors ? (double)(i * bench->given->step) : 100.0;
    int result = measure_times(bench, figure, error);
    if (result == 0)
        result = host_bench_prepare(bench, bench->given->prepare, 1, error);
    for (uint32_t kind = 0; result == 0 && kind < HOST_ERRORS; kind++)
        for (uint32_t i = 0; result == 0 && i < figure->n_errors; i++)
            result = measure_error(bench, figure, kind, i, error);
    if (result == 0)
        result = host_figure2_write(figure, bench->given, error);
    free(figure);
    return result;
}
