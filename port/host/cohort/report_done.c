/* report_done.c: whether a directory holds the result of a command already.
 * SPDX-License-Identifier: MIT */
#include "cohort/report_done.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cohort/report_path.h"
#include "files/file_checksum.h"
#include "files/file_read.h"

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

static int compare_word(host_scan *scan, const char *key, void *context)
{
    static const char *const start[] = {"smr", "register"};
    done_check *const c = context;
    const char *now = NULL;
    size_t n = 0;
    int idle = 0;
    (void)key;
    if (host_scan_text(scan, c->path, sizeof c->path, &n) != 0 || n >= sizeof c->path)
        return differs(c, "another command", "");
    if (c->word < 2)
        return strcmp(c->path, start[c->word++]) == 0 ? 0 : differs(c, "another command", "");
    if (c->skip > 0) {
        c->skip--;
        return 0;
    }
    idle = idle_words(c->path);
    if (idle >= 0) {
        c->skip = idle;
        return 0;
    }
    now = next_argument(c);
    return now != NULL && strcmp(now, c->path) == 0 ? 0
                                                    : differs(c, "another command, from", now != NULL ? now : c->path);
}

static int compare_command(host_scan *scan, done_check *c)
{
    const char *left = NULL;
    if (host_scan_list(scan, compare_word, c) != 0)
        return -1;
    left = next_argument(c);
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
    char *path = NULL;
    int same = 0;
    if (c->has != 7u || c->path_bytes >= sizeof c->path || strlen(c->crc32) != 8u || *end != '\0' || sum > 0xffffffffu)
        return 0;
    path = c->inside ? host_report_beside(c->options->out, c->path) : NULL;
    same = (!c->inside || path != NULL) && host_file_is(path != NULL ? path : c->path, c->bytes, (uint32_t)sum);
    free(path);
    return same;
}

static int compare_file(host_scan *scan, const char *key, void *context)
{
    done_check *const c = context;
    (void)key;
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
    host_error error;
    host_scan scan;
    done_check *const c = calloc(1, sizeof *c);
    int same = 0;
    if (c == NULL)
        return 0;
    memset(&error, 0, sizeof error);
    c->options = options;
    c->why = why;
    scan.text = host_text_over(bytes->data, bytes->size);
    scan.error = &error;
    scan.depth = 0;
    same = host_scan_object(&scan, compare_top, c) == 0 && c->saw == SAW_ALL;
    if (!same && why[0] == '\0')
        (void)snprintf(why, HOST_WHY_BYTES, "a report that lacks its files");
    free(c);
    return same;
}

int host_report_done(const host_options *options, host_report_head *head, char why[HOST_WHY_BYTES])
{
    const size_t read_before = host_file_count();
    char *const path = host_report_beside(options->out, HOST_REPORT_NAME);
    host_error error;
    host_bytes bytes = {NULL, 0};
    int done = 0;
    memset(head, 0, sizeof *head);
    memset(&error, 0, sizeof error);
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
