/* bench_soak.c: the soak benchmark: a histogram of how far ticks end beyond their budgets, for this machine and its
 * present load. It is measured by the wall clock and by the processor time of the calling thread. With one thread,
 * processor time beyond the budget is the library's own, since other programs do not count. With more threads the
 * caller also waits for the others, which uses no processor time.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <string.h>
#include <time.h>
#include "bench/bench_job.h"

enum { BUDGETS = 6, BINS = 12, KINDS = 2 };
enum { WALL = 0, PROCESSOR, CLOCKS };

static const double budgets_ms[BUDGETS] = {1, 2, 4, 8, 16, 33};
/* Upper ends of the bins, us beyond the budget. The first bin is "in time", the last has no upper end. */
static const double bin_us[BINS - 1] = {0, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000};
static const char *const kinds[KINDS] = {"surface", "image"};
static const char *const clocks[CLOCKS] = {"wall", "processor"};

typedef struct soak_row {
    uint32_t ticks, whole, runs; /* whole: ticks that completed an iteration; runs: completed registrations */
    double worst_us[CLOCKS];
    uint32_t bin[CLOCKS][BINS];
} soak_row;

static void count(soak_row *row, int clock, double over_us)
{
    int i = 0;
    while (i < BINS - 1 && over_us > bin_us[i])
        i++;
    row->bin[clock][i]++;
    row->worst_us[clock] = over_us > row->worst_us[clock] ? over_us : row->worst_us[clock];
}

/* Repeats the registration until the time is over. */
static int run_budget(host_bench *bench, double budget_ms, soak_row *row, host_error *error)
{
    const double end = host_seconds() + bench->given->seconds;
    double before = host_seconds();
    while (before < end) {
        smr_tick_report report;
        const double begin = 1e-9 * (double)host_bench_processor_ns(NULL);
        const smr_status status = smr_tick(bench->job.state, (uint64_t)(budget_ms * 1e6), &report);
        const double after = host_seconds();
        if (status < 0)
            return host_fail(error, "tick", "input that can be registered (%s)", smr_status_name(status));
        count(row, WALL, (after - before) * 1e6 - budget_ms * 1e3);
        count(row, PROCESSOR, (1e-9 * (double)host_bench_processor_ns(NULL) - begin) * 1e6 - budget_ms * 1e3);
        row->ticks++;
        row->whole += status == SMR_OK;
        if (report.done) {
            row->runs++;
            if (host_bench_start(bench) != SMR_OK)
                return host_fail(error, "start", "positions within the library's limits");
        }
        before = host_seconds();
    }
    return 0;
}

static int run_kind(host_bench *bench, int image, soak_row *rows, host_error *error)
{
    host_job *const job = &bench->job;
    smr_config config = image ? bench->given->config : smr_config_default();
    config.basic.n_workers = job->port.port.n_workers;
    for (uint32_t k = 0; !image && k < job->n_targets; k++)
        config.basic.n_target_vertices += job->target[k].mesh.n_vertices;
    if (host_bench_prepare(bench, bench->given->prepare, image, error) != 0)
        return -1;
    for (int i = 0; i < BUDGETS; i++)
        if (host_bench_init(bench, &config, &job->port.port, image, error) != 0 ||
            run_budget(bench, budgets_ms[i], &rows[i], error) != 0)
            return -1;
    return 0;
}

static void put_csv(soak_row rows[KINDS][BUDGETS], host_buffer *out)
{
    host_buffer_print(out, "target,budget_ms,clock,above_us,to_us,ticks\n");
    for (int line = 0; line < KINDS * BUDGETS * CLOCKS; line++) {
        const int kind = line / (BUDGETS * CLOCKS), i = line / CLOCKS % BUDGETS, clock = line % CLOCKS;
        for (int b = 0; b < BINS; b++) {
            host_buffer_print(out, "%s,%g,%s,", kinds[kind], budgets_ms[i], clocks[clock]);
            if (b > 0)
                host_buffer_print(out, "%g", bin_us[b - 1]);
            host_buffer_print(out, ",");
            if (b < BINS - 1)
                host_buffer_print(out, "%g", bin_us[b]);
            host_buffer_print(out, ",%u\n", rows[kind][i].bin[clock][b]);
        }
    }
}

static void tell(soak_row rows[KINDS][BUDGETS], const host_bench *bench)
{
    (void)printf("ticks that ended so many us beyond their budget; %u threads, %g s each\n",
                 bench->job.port.port.n_workers, bench->given->seconds);
    (void)printf("%-8s %6s %-9s %7s %7s %5s %8s", "target", "budget", "clock", "ticks", "whole", "runs", "in time");
    for (int b = 1; b < BINS - 1; b++)
        (void)printf(" %6g", bin_us[b]);
    (void)printf("   more   worst\n");
    for (int line = 0; line < KINDS * BUDGETS * CLOCKS; line++) {
        const int kind = line / (BUDGETS * CLOCKS), i = line / CLOCKS % BUDGETS, clock = line % CLOCKS;
        const soak_row *const row = &rows[kind][i];
        (void)printf("%-8s %3g ms %-9s %7u %7u %5u %8u", kinds[kind], budgets_ms[i], clocks[clock], row->ticks,
                     row->whole, row->runs, row->bin[clock][0]);
        for (int b = 1; b < BINS; b++)
            (void)printf(" %6u", row->bin[clock][b]);
        (void)printf(" %7.0f\n", row->worst_us[clock]);
    }
    (void)printf("%s: soak.csv\n", bench->given->out);
}

int host_bench_soak(host_bench *bench, host_error *error)
{
    soak_row rows[KINDS][BUDGETS];
    host_buffer csv = {0};
    memset(rows, 0, sizeof rows);
    if (host_job_make_surfaces(&bench->job, error) != 0)
        return -1;
    for (int image = 0; image < KINDS; image++)
        if (run_kind(bench, image, rows[image], error) != 0)
            return -1;
    put_csv(rows, &csv);
    if (host_output_file(bench->given->out, "soak.csv", &csv, 0, error) != 0)
        return -1;
    if (!bench->given->quiet)
        tell(rows, bench);
    return 0;
}
