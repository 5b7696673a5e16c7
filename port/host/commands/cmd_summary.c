/* cmd_summary.c: smr summary: a table and a page of many results.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include "cohort/summary_cases.h"
#include "commands/commands.h"
#include "files/output_files.h"

static int check_outputs(const host_options *options, host_error *error)
{
    const char *const path[] = {options->out, options->overview};
    for (int i = 0; i < 2; i++)
        if (path[i] != NULL && host_output_check_file(path[i], "", error) != 0)
            return -1;
    error->file = options->overview;
    if (path[0] != NULL && path[1] != NULL && strcmp(path[0], path[1]) == 0)
        return host_fail(error, "output", "another file than the table's");
    return 0;
}

static int add_table(const host_cases *cases, const host_options *options, host_output *output, host_error *error)
{
    host_buffer buffer = {NULL, 0, 0, 0};
    host_summary_table(cases, (int)options->times, &buffer);
    return host_output_take(output, options->out, &buffer, 0, error);
}

static int add_page(const host_cases *cases, const host_options *options, host_output *output, host_error *error)
{
    host_buffer buffer = {NULL, 0, 0, 0};
    int result = 0;
    error->file = options->overview;
    if (host_summary_page(cases, options->overview, &buffer) != 0)
        result = host_fail(error, "output", "free memory");
    return host_output_take(output, options->overview, &buffer, result, error);
}

static int write_outputs(const host_cases *cases, const host_options *options, host_error *error)
{
    host_output *const output = host_output_begin(NULL);
    int result = 0;
    if (options->overview != NULL)
        result = add_page(cases, options, output, error);
    if (result == 0 && options->out != NULL)
        result = add_table(cases, options, output, error);
    return host_output_end(output, result, error);
}

static void tell(const host_cases *cases)
{
    uint32_t count[5] = {0}, i = 0;
    for (i = 0; i < cases->n; i++)
        count[host_case_rank(&cases->one[i])]++;
    (void)printf("%u results: %u good, %u look, %u failed, %u unreadable, %u missing\n", cases->n, count[0], count[1],
                 count[2], count[3], count[4]);
}

int host_summary(const host_options *options, host_error *error)
{
    host_cases cases = {0};
    int result = HOST_REFUSED;
    if (check_outputs(options, error) == 0 && host_cases_read(&options->operands, &cases, error) == 0 &&
        write_outputs(&cases, options, error) == 0) {
        result = cases.n_lacking > 0 ? HOST_LACKS : HOST_DONE;
        if (!options->quiet)
            tell(&cases);
    }
    host_cases_free(&cases);
    return result;
}
