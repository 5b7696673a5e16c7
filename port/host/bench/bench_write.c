/* bench_write.c: writes a benchmark's table and figure.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "bench/bench_job.h"
#include "files/output_files.h"

static int add(host_output *output, const char *name, const char *extension, const host_buffer *content,
               host_error *error)
{
    char file[64];
    (void)snprintf(file, sizeof file, "%s.%s", name, extension);
    return host_output_add(output, file, content, error);
}

int host_bench_write(const char *directory, const char *name, host_buffer *csv, host_buffer *svg, host_error *error)
{
    host_output *const output = host_output_begin(directory);
    int result = 0;
    if (output == NULL) {
        result = host_fail(error, "output", "free memory");
    } else if (add(output, name, "csv", csv, error) != 0 ||
               (svg != NULL && add(output, name, "svg", svg, error) != 0)) {
        host_output_abandon(output);
        result = -1;
    } else {
        result = host_output_commit(output, error);
    }
    host_buffer_free(csv);
    if (svg != NULL)
        host_buffer_free(svg);
    return result;
}
