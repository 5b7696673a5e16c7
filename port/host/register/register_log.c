/* register_log.c: records a registration: memory for the library's log, and the log file, which also says how to read
 * the inputs again.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "files/file_read.h"
#include "files/log_file.h"
#include "register/register_job.h"

int host_job_record(host_job *job, host_error *error)
{
    const uint32_t ticks = job->options->ticks;
    const size_t n_ticks = ticks > 0 && ticks < HOST_LOG_TICKS_MAX ? ticks : HOST_LOG_TICKS_MAX;
    const size_t bytes =
        SMR_LOG_BYTES(n_ticks, 2u * (size_t)job->model.n_parts + 2u + HOST_LANDMARKS_MAX + SMR_FIXED_MAX);
    error->file = job->options->log;
    job->log_memory = malloc(bytes); /* pages that are never written cost nothing */
    if (job->log_memory == NULL || smr_set_log(job->state, job->log_memory, bytes) != SMR_OK)
        return host_fail(error, "log", "free memory");
    return 0;
}

/* Lists the input files, each once, sorted by name, since threads open them in any order. */
static int list_inputs(const host_job *job, host_log *log, host_error *error)
{
    host_input *list = NULL;
    const int n = host_file_list(job->truth_first, job->truth_end, &list);
    int i = 0, result = 0;
    log->input = calloc((size_t)(n < 0 ? 0 : n) + 1u, sizeof *log->input);
    if (n < 0 || log->input == NULL)
        result = host_fail(error, "log", "free memory");
    for (i = 0; result == 0 && i < n; i++)
        result = host_log_measure(list[i].path, &log->input[log->n_inputs++], error);
    free(list);
    return result;
}

int host_job_log(const host_job *job, host_buffer *out, host_error *error)
{
    smr_log_state state;
    host_log log;
    int i = 0, result = 0;
    memset(&log, 0, sizeof log);
    error->file = job->options->log;
    if (smr_get_log(job->state, &state) != SMR_OK)
        return host_fail(error, "log", "a registration that was recorded");
    log.log = job->log_memory;
    log.log_bytes = state.bytes;
    log.argument = calloc((size_t)job->options->n_arguments + 1u, sizeof *log.argument);
    if (log.argument == NULL)
        return host_fail(error, "log", "free memory");
    for (i = 0; i < job->options->n_arguments; i++)
        log.argument[log.n_arguments++] = job->options->arguments[i];
    if (log.n_arguments > HOST_LOG_ARGUMENTS_MAX)
        result = host_fail(error, "log", "at most %u arguments", HOST_LOG_ARGUMENTS_MAX);
    if (result == 0)
        result = list_inputs(job, &log, error);
    if (result == 0)
        host_log_write(&log, out);
    free(log.argument);
    free(log.input);
    return result;
}
