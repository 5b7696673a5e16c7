/* case_point_table.c: the lines with clouds of points: one side, by many or few points, at once or arriving, with and
 * without normals.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_points.h"

#define NOISE_MM 0.3
#define SIDE_MM 0.7 /* bounds of the surface error */
#define FEW_MM 1.2

static const struct {
    const char *line;
    case_feed feed;
    double bound;
} lines[] = {
    {"points", {3000, 0, 1, 0}, SIDE_MM},           {"points bare", {3000, 0, 0, 0}, SIDE_MM},
    {"points arriving", {3000, 50, 1, 0}, SIDE_MM}, {"points bare arriving", {3000, 50, 0, 0}, SIDE_MM},
    {"points swept", {3000, 50, 0, 1}, HUGE_VAL},   {"points few", {300, 0, 1, 0}, FEW_MM},
    {"points few bare", {300, 0, 0, 0}, FEW_MM},
};
enum { LINES = sizeof lines / sizeof lines[0] };

typedef struct tally {
    double surface, worst, vertex;
    int n, missed;
} tally;

static void run_case(const case_bone *bone, uint32_t seed, const char *wanted, tally sums[LINES])
{
    case_options o = case_line("side", seed);
    case_data *const data = case_alloc(1, sizeof *data);
    int i = 0;
    o.noise_mm = 0.0; /* points have their own */
    if (!case_add(data, experiment_data("%s", bone->path), bone->right ? HOST_MIRROR_X : HOST_MIRROR_NONE))
        return;
    case_make(data, &o);
    for (i = 0; i < LINES; i++) {
        case_row row;
        int good = 0;
        if (!case_named(wanted, lines[i].line))
            continue;
        memset(&row, 0, sizeof row);
        (void)snprintf(row.line, sizeof row.line, "%s", lines[i].line);
        (void)snprintf(row.bone, sizeof row.bone, "%s", bone->name);
        row.seed = seed;
        row.overlap = data->overlap;
        row.start = case_measure_start(data);
        row.status = case_run_points(data, &lines[i].feed, NOISE_MM, seed, &row) ? 0 : -1;
        good = row.status == 0 && row.result.surface <= lines[i].bound;
        case_print_row(&row, -1.0, good ? "ok" : row.status == 0 ? "MISS" : "NOT DONE");
        sums[i].n++;
        sums[i].missed += !good;
        sums[i].surface += row.result.surface;
        sums[i].vertex += row.result.vertex;
        sums[i].worst = fmax(sums[i].worst, row.result.surface);
    }
    case_free(data);
    free(data);
}

int case_table_points(const char *wanted, const char *bones, uint32_t first, uint32_t last)
{
    tally sums[LINES];
    uint32_t seed = 0;
    int b = 0, i = 0, missed = 0;
    memset(sums, 0, sizeof sums);
    case_print_head();
    for (b = 0; b < CASE_BONES; b++)
        for (seed = first; case_named(bones, case_bones[b].name) && seed <= last; seed++)
            run_case(&case_bones[b], seed, wanted, sums);
    for (i = 0; i < LINES; i++) {
        if (sums[i].n > 0)
            (void)printf("sum %-20s %3d runs, %3d missed: surface mean %.3f worst %.3f, vertex mean %.3f\n",
                         lines[i].line, sums[i].n, sums[i].missed, sums[i].surface / sums[i].n, sums[i].worst,
                         sums[i].vertex / sums[i].n);
        missed += sums[i].missed;
    }
    return missed;
}
