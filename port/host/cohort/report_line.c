/* report_line.c: a result as one line of JSON.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "cohort/report_line.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clean_text.h"
#include "report/json_write.h"

static void put_distances(host_json *json, const host_report_head *head)
{
    if (head->to.n == 0 && head->from.n == 0) {
        host_json_null(json, "distance_mm");
        return;
    }
    host_json_open(json, "distance_mm", '{');
    host_json_stats(json, "model_to_target", &head->to);
    host_json_stats(json, "target_to_model", &head->from);
    host_json_close(json, '}');
}

void host_report_line(const host_report_head *head, const char *directory, int skipped, host_buffer *out)
{
    host_json json = {out, 0, 1, 1};
    uint32_t i = 0;
    host_json_open(&json, NULL, '{');
    host_json_text(&json, "version", head->version);
    host_json_text(&json, "verdict", host_verdict_name(head->verdict.level));
    host_json_open(&json, "reasons", '[');
    for (i = 0; i < head->verdict.n_reasons; i++)
        host_json_text(&json, NULL, head->verdict.reason[i]);
    host_json_close(&json, ']');
    host_json_number(&json, "expected_error_mm", head->verdict.expected_error_mm);
    put_distances(&json, head);
    host_json_number(&json, "hausdorff_mm", head->hausdorff_mm);
    host_json_count(&json, "folds", head->folds);
    host_json_count(&json, "iterations", head->iterations);
    host_json_text(&json, "state_hash", head->state_hash);
    host_json_number(&json, "seconds", head->seconds);
    host_json_text(&json, "output", directory);
    host_json_count(&json, "exit_status", (uint64_t)(head->exit_status < 0 ? 0 : head->exit_status));
    host_json_flag(&json, "skipped", skipped);
    host_json_close(&json, '}');
}

/* One write(), so that lines that several programs append to one file do not mix; more only where the system takes a
 * part. */
static int put_line(const host_buffer *line, host_error *error)
{
    size_t at = 0;
    int failed = fflush(stdout) != 0;
    while (!failed && at < line->size) {
        const ssize_t n = write(STDOUT_FILENO, line->data + at, line->size - at);
        failed = n == 0 || (n < 0 && errno != EINTR);
        at += n > 0 ? (size_t)n : 0u;
    }
    if (!failed)
        return 0;
    error->file = "standard output";
    return host_fail(error, "output", "room for the line (%s)", strerror(errno));
}

static int print_line(const host_report_head *head, const char *directory, int skipped, host_error *error)
{
    host_buffer line = {NULL, 0, 0, 0};
    int result = 0;
    host_report_line(head, directory, skipped, &line);
    if (line.failed)
        result = host_fail(error, "output", "free memory");
    else
        result = put_line(&line, error);
    host_buffer_free(&line);
    return result;
}

int host_report_print(const host_buffer *report, const char *directory, host_error *error)
{
    host_report_head head;
    int result = 0;
    error->file = directory;
    if (host_report_parse(report->data, report->size, &head, error) != 0)
        return -1;
    result = print_line(&head, directory, 0, error);
    host_report_free(&head);
    return result;
}

int host_report_skipped(const host_report_head *head, const host_options *options, host_error *error)
{
    error->file = options->out;
    if (options->json)
        return print_line(head, options->out, 1, error);
    if (!options->quiet)
        (void)printf("%s: done before, verdict %s: nothing is computed\n", options->out,
                     host_verdict_name(head->verdict.level));
    return 0;
}

static void put_clean(const char *text)
{
    size_t n = 1;
    for (; *text != '\0'; text += n) {
        const char c = host_clean_next(text, &n);
        (void)fputc(c, stderr);
        (void)fwrite(text + 1, 1, n - 1u, stderr);
    }
}

void host_report_again(const char *directory, const char *why)
{
    (void)fputs("smr: ", stderr);
    put_clean(directory);
    (void)fputs(": computed again: ", stderr);
    put_clean(why);
    (void)fputc('\n', stderr);
}
