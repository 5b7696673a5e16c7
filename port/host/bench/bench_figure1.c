/* bench_figure1.c: the paper's figure 1, right: Hausdorff distance over time for four cluster radii, with and without
 * plasticity, by both methods.
 *
 * Geometric registration as in the paper: closest points in full, one radius, nothing that repairs, fades or smooths
 * (smr_config_paper), all vertices active. Elastic: x^r stays. Plastic: x^r = x when vertices move by less than 50 um
 * in the mean. The clock is the processor time of one thread, without the measuring; distances are report.json's.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "bench/bench_job.h"

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
} figure1;

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
    const smr_port port = {NULL, 1, NULL, host_bench_processor_ns};
    smr_tick_report report = {0};
    double ms = 0.0;
    if (host_bench_init(bench, config, &port, 0, error) != 0)
        return -1;
    for (int point = 0; point < POINTS; point++) {
        while (report.iteration < measured_at[point]) {
            if (smr_tick(bench->job.state, 0, &report) != SMR_OK)
                return host_fail(error, "tick", "input that can be registered");
            for (uint32_t phase = 0; phase < SMR_PHASES; phase++)
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
    prepare.order = SMR_ORDER_FOREST; /* the same bits, sooner */
    prepare.n_radii = RADII;
    memcpy(prepare.radius_mm, radii_mm, sizeof radii_mm);
    if (host_job_make_surfaces(&bench->job, error) != 0 || host_bench_prepare(bench, prepare, 0, error) != 0)
        return -1;
    f->n_vertices = bench->job.model.info.n_vertices;
    f->n_structures = bench->job.model.info.n_structures;
    for (uint32_t method = 0; method < METHODS; method++)
        for (int kind = 0; kind < KINDS; kind++)
            for (uint32_t r = 0; r < RADII; r++) {
                const smr_config config = config_of(method, kind, r);
                if (run_one(bench, &config, &f->of[method][kind][r], error) != 0)
                    return -1;
            }
    return 0;
}

static int write_csv(const figure1 *f, const char *directory, host_error *error)
{
    host_buffer csv = {0};
    host_buffer_print(
        &csv, "method,reference,radius_mm,iteration,time_ms,hausdorff_mm,mean_to_mm,mean_from_mm,reference_updates\n");
    for (uint32_t i = 0; i < METHODS * KINDS * RADII; i++) {
        const uint32_t m = i / (KINDS * RADII), k = i / RADII % KINDS, r = i % RADII;
        const run *const one = &f->of[m][k][r];
        for (uint32_t p = 0; p < POINTS; p++)
            host_buffer_print(&csv, "%s,%s,%g,%u,%.4f,%.5f,%.5f,%.5f,%u\n", methods[m], kinds[k], (double)radii_mm[r],
                              measured_at[p], one->ms[p], one->hausdorff[p], one->to[p], one->from[p], one->updates[p]);
    }
    return host_output_file(directory, "figure1.csv", &csv, 0, error);
}

static void tell(const figure1 *f, const char *directory)
{
    (void)printf("%u structures, %u vertices; %u iterations; Hausdorff and mean distances, mm\n", f->n_structures,
                 f->n_vertices, measured_at[POINTS - 1]);
    for (uint32_t i = 0; i < METHODS * KINDS * RADII; i++) {
        const uint32_t method = i / (KINDS * RADII), kind = i / RADII % KINDS, r = i % RADII;
        const run *const one = &f->of[method][kind][r];
        (void)printf("%-6s %-8s %4g mm: Hausdorff %7.3f -> %6.3f, means %6.3f / %6.3f, %7.1f ms, %u updates\n",
                     methods[method], kinds[kind], (double)radii_mm[r], one->hausdorff[0], one->hausdorff[POINTS - 1],
                     one->to[POINTS - 1], one->from[POINTS - 1], one->ms[POINTS - 1], one->updates[POINTS - 1]);
    }
    (void)printf("%s: figure1.csv\n", directory);
}

int host_bench_figure1(host_bench *bench, host_error *error)
{
    figure1 *const f = calloc(1, sizeof *f);
    if (f == NULL)
        return host_fail(error, "figure", "free memory");
    int result = run_all(bench, f, error);
    if (result == 0)
        result = write_csv(f, bench->given->out, error);
    if (result == 0 && !bench->given->quiet)
        tell(f, bench->given->out);
    free(f);
    return result;
}
