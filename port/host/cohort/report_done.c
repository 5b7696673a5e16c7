/* report_done.c: whether a result is there already, for --skip-done; the line of --json.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "cohort/report_head.h"
#include "report/json_write.h"

/* 1 when the path leads to a regular file of so many bytes with this checksum (files/gzip_write.h). Does not count as
 * reading it (files/file_read.h). */
static int is_file(const char *path, uint64_t bytes, uint32_t crc32)
{
    /* Without O_NONBLOCK, opening a named pipe without a writer would block for ever. */
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    host_error ignored = {0};
    uint64_t found = 0;
    uint32_t sum = 0;
    struct stat st;
    if (fd < 0)
        return 0;
    int same = fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && (uint64_t)st.st_size == bytes &&
               host_file_sum(fd, &found, &sum, &ignored) == 0 && found == bytes && sum == crc32;
    (void)close(fd);
    return same;
}

#define PATH_BYTES 4096u

enum { SAW_COMMAND = 1, SAW_INPUTS = 2, SAW_RESULTS = 4, SAW_ALL = 7 };

typedef struct done_check {
    const host_options *options;
    char *why;
    unsigned saw;
    int in_results;
    /* of the command: the next argument to compare, and how many of the report's words belong to an option */
    int at, word, skip;
    /* the file being read */
    char path[PATH_BYTES];
    size_t path_bytes;
    int inside; /* 1: of the report's directory */
    uint64_t bytes;
    char crc32[16];
    unsigned has;
} done_check;

static int differs(done_check *c, const char *what, const char *name)
{
    (void)snprintf(c->why, HOST_WHY_BYTES, "%s%s%.200s", what, name[0] != '\0' ? " " : "", name);
    return -1;
}

/* Words that change no result, the option's own and how many values follow it: -1 for others. */
static int idle_words(const char *word)
{
    if (strcmp(word, "--skip-done") == 0 || strcmp(word, "--json") == 0 || strcmp(word, "--quiet") == 0)
        return 0;
    return strcmp(word, "--threads") == 0 ? 1 : -1;
}

/* The next argument of the present command that counts, or NULL. */
static const char *next_argument(done_check *c)
{
    while (c->at < c->options->n_arguments) {
        const char *const word = c->options->arguments[c->at++];
        const int idle = idle_words(word);
        if (idle < 0)
            return word;
        c->at += idle;
    }
    return NULL;
}

static int compare_word(host_scan *scan, void *context)
{
    static const char *const start[] = {"smr", "register"};
    done_check *const c = context;
    size_t n = 0;
    if (host_scan_text(scan, c->path, sizeof c->path, &n) != 0 || n >= sizeof c->path)
        return differs(c, "another command", "");
    if (c->word < 2)
        return strcmp(c->path, start[c->word++]) == 0 ? 0 : differs(c, "another command", "");
    if (c->skip > 0) {
        c->skip--;
        return 0;
    }
    int idle = idle_words(c->path);
    if (idle >= 0) {
        c->skip = idle;
        return 0;
    }
    const char *it = next_argument(c);
    return it != NULL && strcmp(it, c->path) == 0 ? 0 : differs(c, "another command, from", it != NULL ? it : c->path);
}

static int compare_command(host_scan *scan, done_check *c)
{
    if (host_scan_list(scan, compare_word, c) != 0)
        return -1;
    const char *left = next_argument(c);
    return left == NULL && c->word == 2 ? 0 : differs(c, "another command, from", left != NULL ? left : "");
}

static int read_file_member(host_scan *scan, const char *key, void *context)
{
    done_check *const c = context;
    size_t n = 0;
    if (strcmp(key, "path") == 0 || strcmp(key, "file") == 0) {
        c->inside = key[0] == 'f';
        c->has |= 1u;
        return host_scan_text(scan, c->path, sizeof c->path, &c->path_bytes);
    }
    if (strcmp(key, "bytes") == 0) {
        c->has |= 2u;
        return host_scan_count(scan, &c->bytes);
    }
    if (strcmp(key, "crc32") == 0) {
        c->has |= 4u;
        return host_scan_text(scan, c->crc32, sizeof c->crc32, &n);
    }
    return host_scan_skip(scan);
}

static int is_same_file(const done_check *c)
{
    char *end = NULL;
    const unsigned long sum = strtoul(c->crc32, &end, 16);
    if (c->has != 7u || c->path_bytes >= sizeof c->path || strlen(c->crc32) != 8u || *end != '\0' || sum > 0xffffffffu)
        return 0;
    char *path = c->inside ? host_report_beside(c->options->out, c->path) : NULL;
    int same = (!c->inside || path != NULL) && is_file(path != NULL ? path : c->path, c->bytes, (uint32_t)sum);
    free(path);
    return same;
}

static int compare_file(host_scan *scan, void *context)
{
    done_check *const c = context;
    c->has = 0;
    c->path[0] = '\0';
    if (host_scan_object(scan, read_file_member, c) != 0)
        return -1;
    if (is_same_file(c))
        return 0;
    return differs(c, c->in_results ? "the result is not as it was written:" : "the input is another:", c->path);
}

static int compare_top(host_scan *scan, const char *key, void *context)
{
    done_check *const c = context;
    if (strcmp(key, "command") == 0 && (c->saw & SAW_COMMAND) == 0) {
        c->saw |= SAW_COMMAND;
        return compare_command(scan, c);
    }
    if (strcmp(key, "inputs") == 0 || strcmp(key, "results") == 0) {
        c->in_results = key[0] == 'r';
        c->saw |= c->in_results ? SAW_RESULTS : SAW_INPUTS;
        return host_scan_list(scan, compare_file, c);
    }
    return host_scan_skip(scan);
}

/* The second reading of a report whose head is sound. */
static int compare(const host_options *options, const host_bytes *bytes, char *why)
{
    host_error error = {0};
    done_check *const c = calloc(1, sizeof *c);
    if (c == NULL)
        return 0;
    c->options = options;
    c->why = why;
    host_scan scan = {host_text_over(bytes->data, bytes->size), &error, 0};
    int same = host_scan_object(&scan, compare_top, c) == 0 && c->saw == SAW_ALL;
    if (!same && why[0] == '\0')
        (void)snprintf(why, HOST_WHY_BYTES, "a report that lacks its files");
    free(c);
    return same;
}

int host_report_done(const host_options *options, host_report_head *head, char why[HOST_WHY_BYTES])
{
    const size_t read_before = host_file_count();
    char *const path = host_report_beside(options->out, HOST_REPORT_NAME);
    host_error error = {0};
    host_bytes bytes = {NULL, 0};
    int done = 0;
    memset(head, 0, sizeof *head);
    why[0] = '\0';
    if (path == NULL)
        return 0;
    if (host_report_bytes(path, &bytes, &error) == 0) {
        if (host_report_parse(bytes.data, bytes.size, head, &error) != 0)
            (void)snprintf(why, HOST_WHY_BYTES, "%s: expected %s", error.place, error.expected);
        else if (head->exit_status < 0)
            (void)snprintf(why, HOST_WHY_BYTES, "a report without an exit status");
        else
            done = compare(options, &bytes, why);
    } else if (host_report_there(path)) {
        (void)snprintf(why, HOST_WHY_BYTES, "%s: expected %s", error.place, error.expected);
    }
    if (!done)
        host_report_free(head);
    host_file_free(&bytes);
    free(path);
    host_file_forget(read_before); /* it is no input, and will be written anew */
    return done;
}

static void put_distances(host_json *json, const host_report_head *head)
{
    if (!host_json_object(json, "distance_mm", head->to.n > 0 || head->from.n > 0))
        return;
    host_json_stats(json, "model_to_target", &head->to);
    host_json_stats(json, "whole_model_to_target", &head->whole);
    host_json_stats(json, "target_to_model", &head->from);
    host_json_close(json, '}');
}

void host_report_line(const host_report_head *head, const char *directory, int skipped, host_buffer *out)
{
    host_json json = {out, 0, 1, 1};
    host_json_open(&json, NULL, '{');
    host_json_text(&json, "version", head->version);
    host_json_text(&json, "verdict", host_verdict_name(head->verdict.level));
    host_json_open(&json, "reasons", '[');
    for (uint32_t i = 0; i < head->verdict.n_reasons; i++)
        host_json_text(&json, NULL, head->verdict.reason[i]);
    host_json_close(&json, ']');
    host_json_number(&json, "probability", head->verdict.probability);
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

/* One write(), so that lines that several programs append to a file do not mix; more if the system takes a part. */
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
    error->file = directory;
    if (host_report_parse(report->data, report->size, &head, error) != 0)
        return -1;
    int result = print_line(&head, directory, 0, error);
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
