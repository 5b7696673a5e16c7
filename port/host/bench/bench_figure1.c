/* bench_figure1.c: the paper's figure 1, right: Hausdorff distance over time for four cluster radii, with and without
 * plasticity, by both methods.
 *
 * Geometric registration as in the paper: closest points in full, one radius, nothing that repairs, fades or smooths
 * (smr_config_paper), all vertices active. Elastic: x^r stays. Plastic: x^r = x when vertices move by less than 50 um
 * in the mean. The clock is the processor time of one thread, without the measuring; distances are report.json's.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench_job.h"
#include "bench/bench_plot.h"

enum { RADII = 4, POINTS = 16, METHODS = 2, KINDS = 2 };
enum { ELASTIC = 0, PLASTIC };

static const float radii_mm[RADII] = {100, 50, 30, 20};
/* Iterations after which distances are measured. */
static const uint32_t measured_at[POINTS] = {0, 1, 2, 3, 4, 6, 9, 13, 18, 25, 35, 50, 70, 95, 120, 150};
static const char *const methods[METHODS] = {"rigid", "polar"}; /* by SMR_METHOD_... */
static const char *const kinds[KINDS] = {"elastic", "plastic"};

typedef struct run {
    double ms[POINTS], hausdorff[POINTS], to[POINTS], from[POINTS]; /* ms since the start; mm */
    uint32_t updates[POINTS];                                       /* x^r = x so often */
} run;

typedef struct figure1 {
    run of[METHODS][KINDS][RADII];
    uint32_t n_vertices, n_structures;
    int computed; /* 1: of the computed thigh's femur */
} figure1;

static uint64_t processor_ns(void *ctx)
{
    struct timespec now;
    (void)ctx;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static smr_config config_of(uint32_t method, int kind, uint32_t radius)
{
    smr_config config = smr_config_paper();
    config.basic.method = method;
    config.schedule.active_first = 1.0f;
    config.schedule.radius_first = config.schedule.radius_last = radius;
    config.basic.iterations_last = measured_at[POINTS - 1];
    if (kind == ELASTIC)
        config.motion.plastic_um = 0.0f;
    return config;
}

static int measure(host_bench *bench, const smr_tick_report *report, double ms, run *to, int point, host_error *error)
{
    const host_job *const job = &bench->job;
    if (host_job_evaluate(&bench->job, error) != 0)
        return -1;
    to->ms[point] = ms;
    to->to[point] = job->area.to_target.mean;
    to->from[point] = job->area.to_result.mean;
    to->hausdorff[point] = fmax(job->area.to_target.max, job->area.to_result.max);
    to->updates[point] = report->details.plastic_updates;
    return 0;
}

static int run_one(host_bench *bench, const smr_config *config, run *to, host_error *error)
{
    const smr_port port = {NULL, 1, NULL, processor_ns};
    smr_tick_report report;
    double ms = 0.0;
    uint32_t phase = 0;
    int point = 0;
    memset(&report, 0, sizeof report);
    if (host_bench_init(bench, config, &port, 0, error) != 0)
        return -1;
    for (point = 0; point < POINTS; point++) {
        while (report.iteration < measured_at[point]) {
            if (smr_tick(bench->job.state, 0, &report) != SMR_OK)
                return host_fail(error, "tick", "input that can be registered");
            for (phase = 0; phase < SMR_PHASES; phase++)
                ms += 1e-6 * (double)report.details.phase_ns[phase];
        }
        if (measure(bench, &report, ms, to, point, error) != 0)
            return -1;
    }
    return 0;
}

static int run_all(host_bench *bench, figure1 *f, host_error *error)
{
    smr_prepare_config prepare = smr_prepare_config_paper();
    uint32_t r = 0, method = 0;
    int kind = 0;
    prepare.order = SMR_ORDER_FOREST; /* the same bits, sooner */
    prepare.n_radii = RADII;
    memcpy(prepare.radius_mm, radii_mm, sizeof radii_mm);
    if (host_job_make_surfaces(&bench->job, error) != 0 || host_bench_prepare(bench, prepare, 0, error) != 0)
        return -1;
    f->n_vertices = bench->job.model.info.n_vertices;
    f->n_structures = bench->job.model.info.n_structures;
    for (method = 0; method < METHODS; method++)
        for (kind = 0; kind < KINDS; kind++)
            for (r = 0; r < RADII; r++) {
                const smr_config config = config_of(method, kind, r);
                if (run_one(bench, &config, &f->of[method][kind][r], error) != 0)
                    return -1;
            }
    return 0;
}

static void put_csv(const figure1 *f, host_buffer *out)
{
    uint32_t i = 0, p = 0;
    host_buffer_print(out, "method,reference,radius_mm,iteration,time_ms,hausdorff_mm,mean_to_mm,mean_from_mm,"
                           "reference_updates\n");
    for (i = 0; i < METHODS * KINDS * RADII; i++) {
        const uint32_t method = i / (KINDS * RADII), kind = i / RADII % KINDS, r = i % RADII;
        const run *const one = &f->of[method][kind][r];
        for (p = 0; p < POINTS; p++)
            host_buffer_print(out, "%s,%s,%g,%u,%.4f,%.5f,%.5f,%.5f,%u\n", methods[method], kinds[kind],
                              (double)radii_mm[r], measured_at[p], one->ms[p], one->hausdorff[p], one->to[p],
                              one->from[p], one->updates[p]);
    }
}

static void put_svg(const figure1 *f, host_buffer *out)
{
    static const char *const colours[RADII] = {"#0b6bb8", "#2b8a3e", "#c8400f", "#7a3e9d"};
    static const char *const titles[METHODS] = {"Rigid-body kinematics", "Polar decomposition"};
    static char names[KINDS * RADII][32];
    host_plot plot[METHODS];
    char title[160];
    double longest = 0.0;
    uint32_t i = 0, method = 0;
    memset(plot, 0, sizeof plot);
    for (i = 0; i < METHODS * KINDS * RADII; i++) {
        const double end = f->of[i / (KINDS * RADII)][i / RADII % KINDS][i % RADII].ms[POINTS - 1];
        longest = end > longest ? end : longest;
    }
    for (method = 0; method < METHODS; method++) {
        plot[method].title = titles[method];
        plot[method].x_label = "time, ms, one thread";
        plot[method].y_label = "Hausdorff distance, mm";
        plot[method].x_max = longest;
        plot[method].headroom = 1.8;
        for (i = 0; i < KINDS * RADII; i++) {
            const uint32_t r = i / KINDS, kind = i % KINDS;
            const run *const one = &f->of[method][kind][r];
            (void)snprintf(names[i], sizeof names[i], "%g mm, %s", (double)radii_mm[r], kinds[kind]);
            plot[method].curve[plot[method].n_curves++] = (host_curve){
                names[i], colours[r], kind == ELASTIC ? "6 4" : "none", one->ms, one->hausdorff, POINTS, 0, {0.0, 0.0}};
        }
    }
    (void)snprintf(title, sizeof title, "Geometric registration of %s, %u vertices",
                   f->computed ? "a computed femur" : "a model", f->n_vertices);
    host_plot_write(plot, METHODS, title, out);
}

static void tell(const figure1 *f, const char *directory)
{
    uint32_t i = 0;
    (void)printf("%u structures, %u vertices; %u iterations; Hausdorff and mean distances, mm\n", f->n_structures,
                 f->n_vertices, measured_at[POINTS - 1]);
    for (i = 0; i < METHODS * KINDS * RADII; i++) {
        const uint32_t method = i / (KINDS * RADII), kind = i / RADII % KINDS, r = i % RADII;
        const run *const one = &f->of[method][kind][r];
        (void)printf("%-6s %-8s %4g mm: Hausdorff %7.3f -> %6.3f, means %6.3f / %6.3f, %7.1f ms, %u updates\n",
                     methods[method], kinds[kind], (double)radii_mm[r], one->hausdorff[0], one->hausdorff[POINTS - 1],
                     one->to[POINTS - 1], one->from[POINTS - 1], one->ms[POINTS - 1], one->updates[POINTS - 1]);
    }
    (void)printf("%s: figure1.csv, figure1.svg\n", directory);
}

static int write_files(const figure1 *f, const char *directory, host_error *error)
{
    host_buffer csv, svg;
    memset(&csv, 0, sizeof csv);
    memset(&svg, 0, sizeof svg);
    put_csv(f, &csv);
    put_svg(f, &svg);
    return host_bench_write(directory, "figure1", &csv, &svg, error);
}

int host_bench_figure1(host_bench *bench, host_error *error)
{
    figure1 *const f = calloc(1, sizeof *f);
    int result = 0;
    if (f == NULL)
        return host_fail(error, "figure", "free memory");
    f->computed = bench->thigh != NULL;
    result = run_all(bench, f, error);
    if (result == 0)
        result = write_files(f, bench->given->out, error);
    if (result == 0 && !bench->given->quiet)
        tell(f, bench->given->out);
    free(f);
    return result;
}
