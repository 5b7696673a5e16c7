/* cmd_register.c: smr register: calls the steps of a registration in order and writes its files.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include "cohort/report_head.h"
#include "commands/commands.h"
#include "html/page_data.h"
#include "report/register_report.h"
#include "scene/mrml_scene.h"

static int write_surfaces(const host_job *job, host_output *output, host_error *error)
{
    host_buffer buffer = {0};
    int result = 0;
    for (uint32_t i = 0; result == 0 && i < job->model.n_parts; i++) {
        char name[SMR_NAME_BYTES + 4u];
        (void)snprintf(name, sizeof name, "%s%s", job->model.part[i].name,
                       host_format_extension((int)job->options->format));
        host_job_surface(job, i, &buffer);
        result = host_output_take(output, name, &buffer, 0, error);
    }
    return result;
}

/* What points, fields and volumes are carried by. */
static int write_carry(const host_job *job, host_output *output, host_error *error)
{
    host_buffer buffer = {0};
    host_job_carry(job, &buffer);
    return host_output_take(output, HOST_CARRY_NAME, &buffer, 0, error);
}

/* The log, or the save. */
static int write_beside(const host_job *job, const char *path,
                        int (*content)(const host_job *, host_buffer *, host_error *), host_output *output,
                        host_error *error)
{
    host_buffer buffer = {0};
    int result = content(job, &buffer, error);
    if (result == 0)
        result = host_output_add_path(output, path, &buffer, error);
    host_buffer_free(&buffer);
    return result;
}

/* The exit status. */
static int status_of(const host_job *job)
{
    if (job->last.done == 0)
        return HOST_ENDED;
    if (job->verdict.level == HOST_VERDICT_FAILED)
        return HOST_FAILED;
    return job->verdict.level > (int)job->options->accept ? HOST_LOOK : HOST_DONE;
}

/* The page shows the report as it is before; then the report tells of the page, too. */
static int write_page(const host_job *job, host_output *output, host_error *error)
{
    host_buffer report = {0}, page = {0};
    host_job_report(job, status_of(job), output, &report);
    host_report_html(job, &report, &page);
    host_buffer_free(&report);
    return host_output_take(output, "report.html", &page, 0, error);
}

/* Writes results, scene, log, trace and save, then the report, which tells of the others. */
static int write_set(const host_job *job, host_output *output, host_buffer *report, host_error *error)
{
    if (write_surfaces(job, output, error) != 0 || write_carry(job, output, error) != 0)
        return -1;
    if (job->options->slicer != NULL && host_scene_add(job, output, error) != 0)
        return -1;
    if (job->options->log != NULL && /* may go into the directory that was just made */
        write_beside(job, job->options->log, host_job_log, output, error) != 0)
        return -1;
    if (job->options->save != NULL && write_beside(job, job->options->save, host_job_save, output, error) != 0)
        return -1;
    if (job->options->trace != NULL && host_output_add_path(output, job->options->trace, &job->trace, error) != 0)
        return -1;
    if (job->options->html && write_page(job, output, error) != 0)
        return -1;
    host_job_report(job, status_of(job), output, report);
    return host_output_add(output, HOST_REPORT_NAME, report, error);
}

/* All or nothing; what is said of it is said once it is there. */
static int write_all(const host_job *job, host_error *error)
{
    host_output *const output = host_output_begin(job->options->out);
    host_buffer report = {0};
    int result = host_output_end(output, write_set(job, output, &report, error), error);
    if (result == 0 && job->options->json)
        result = host_report_print(&report, job->options->out, error);
    else if (result == 0 && !job->options->quiet)
        host_job_summary(job);
    host_buffer_free(&report);
    return result;
}

/* Log, trace, save and scene may lie among the results, or elsewhere; each is a file of its own. */
static int check_files(const host_options *options, host_error *error)
{
    static const char *const others[] = {"another file than the log's", "another file than the trace's",
                                         "another file than the save's"};
    const char *const path[] = {options->log, options->trace, options->save, options->slicer};
    for (size_t i = 0; i < sizeof path / sizeof path[0]; i++) {
        if (path[i] != NULL && host_output_check_file(path[i], options->out, error) != 0)
            return -1;
        error->file = path[i];
        for (size_t k = 0; k < i; k++)
            if (path[i] != NULL && path[k] != NULL && strcmp(path[i], path[k]) == 0)
                return host_fail(error, "output", "%s", others[k]);
    }
    return 0;
}

static int run_steps(host_job *job, host_error *error)
{
    if (host_output_check(job->options->out, error) != 0 || check_files(job->options, error) != 0 ||
        host_port_open(&job->port, job->options->threads, error) != 0 || host_job_load(job, error) != 0 ||
        host_job_check_format(job, error) != 0 || host_job_check(job, error) != 0 || host_job_match(job, error) != 0 ||
        host_job_prepare(job, error) != 0 || host_job_run(job, error) != 0 || host_job_evaluate(job, error) != 0 ||
        host_job_verdict(job, error) != 0 || host_job_keep_start(job, error) != 0 || write_all(job, error) != 0)
        return HOST_REFUSED;
    return status_of(job);
}

/* The exit status of the result that is there already, or -1. Says why a result that is there is made again. */
static int skip_done(const host_options *options, host_error *error)
{
    host_report_head head;
    char why[HOST_WHY_BYTES];
    int status = -1;
    if (host_report_done(options, &head, why)) {
        status = host_report_skipped(&head, options, error) == 0 ? head.exit_status : HOST_REFUSED;
        host_report_free(&head);
    } else if (why[0] != '\0' && !options->quiet) {
        host_report_again(options->out, why);
    }
    return status;
}

int host_register(const host_options *options, host_error *error)
{
    host_job job = {0};
    int result = options->skip_done ? skip_done(options, error) : -1;
    if (result >= 0)
        return result;
    host_file_keep_checksums();
    job.options = options;
    job.begin_s = host_seconds();
    result = run_steps(&job, error);
    host_job_free(&job);
    return result;
}
