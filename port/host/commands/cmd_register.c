/* cmd_register.c: smr register: calls the steps of a registration in order and writes its files.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/commands.h"
#include "files/output_files.h"
#include "report/register_report.h"

static int write_surfaces(const host_job *job, host_output *output, host_error *error)
{
    host_buffer buffer;
    uint32_t i = 0;
    int result = 0;
    memset(&buffer, 0, sizeof buffer);
    for (i = 0; result == 0 && i < job->model.n_parts; i++) {
        char name[SMR_NAME_BYTES + 4u];
        (void)snprintf(name, sizeof name, "%s.ply", job->model.part[i].name);
        buffer.size = 0;
        host_mesh_write(&job->result[i].mesh, HOST_FORMAT_PLY, &buffer);
        result = host_output_add(output, name, &buffer, error);
    }
    host_buffer_free(&buffer);
    return result;
}

static int write_log(const host_job *job, host_output *output, host_error *error)
{
    host_buffer buffer;
    int result = 0;
    memset(&buffer, 0, sizeof buffer);
    result = host_job_log(job, &buffer, error);
    if (result == 0)
        result = host_output_add_path(output, job->options->log, &buffer, error);
    host_buffer_free(&buffer);
    return result;
}

static int write_report(const host_job *job, host_output *output, host_error *error)
{
    host_buffer buffer;
    int result = 0;
    memset(&buffer, 0, sizeof buffer);
    host_job_report(job, &buffer);
    result = host_output_add(output, "report.json", &buffer, error);
    host_buffer_free(&buffer);
    return result;
}

/* Writes results and log as one set. The report is its last file: where it lies, it tells of the files beside it. */
static int write_all(const host_job *job, host_error *error)
{
    host_output *const output = host_output_begin(job->options->out);
    int result = 0;
    if (output == NULL)
        return host_fail(error, "output", "free memory");
    result = write_surfaces(job, output, error);
    if (result == 0 && job->options->log != NULL) /* may go into the directory that was just made */
        result = write_log(job, output, error);
    if (result == 0)
        result = write_report(job, output, error);
    if (result == 0)
        return host_output_commit(output, error);
    host_output_abandon(output);
    return -1;
}

static int run_steps(host_job *job, host_error *error)
{
    if (host_output_check(job->options->out, error) != 0 ||
        (job->options->log != NULL && host_output_check_file(job->options->log, job->options->out, error) != 0) ||
        host_port_open(&job->port, job->options->threads, error) != 0 || host_job_load(job, error) != 0 ||
        host_job_check(job, error) != 0 || host_job_match(job, error) != 0 || host_job_prepare(job, error) != 0 ||
        host_job_run(job, error) != 0 || host_job_evaluate(job, error) != 0 || write_all(job, error) != 0)
        return HOST_REFUSED;
    if (!job->options->quiet)
        host_job_summary(job);
    return host_job_converged(job) ? HOST_DONE : HOST_NOT_CONVERGED;
}

int host_register(const host_options *options, host_error *error)
{
    host_job job;
    int result = 0;
    memset(&job, 0, sizeof job);
    job.options = options;
    job.begin_s = host_seconds();
    result = run_steps(&job, error);
    host_job_free(&job);
    return result;
}
