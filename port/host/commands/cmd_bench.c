/* cmd_bench.c: smr bench: the paper's figures 1 and 2, and how far ticks go beyond their budgets.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "bench/bench_job.h"
#include "commands/commands.h"
#include "files/output_files.h"

int host_bench_run(const host_options *options, host_error *error)
{
    host_bench *const bench = calloc(1, sizeof *bench);
    int result = 0;
    error->file = "bench";
    if (bench == NULL) {
        (void)host_fail(error, "start", "free memory");
        return HOST_REFUSED;
    }
    result = host_output_check(options->out, error);
    if (result == 0) {
        result = host_bench_load(bench, options, error);
        if (result == 0)
            result = options->figure1   ? host_bench_figure1(bench, error)
                     : options->figure2 ? host_bench_figure2(bench, error)
                                        : host_bench_soak(bench, error);
        host_bench_free(bench);
    }
    free(bench);
    return result == 0 ? HOST_DONE : HOST_REFUSED;
}
