/* report_head.c: reads what a result's report.json says at its head.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "cohort/report_head.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* 1 when the name stays in its directory: no empty part, and none that starts with a dot. */
static int stays_inside(const char *name)
{
    for (;;) {
        if (*name == '\0' || *name == '/' || *name == '.')
            return 0;
        name += strcspn(name, "/");
        if (*name == '\0')
            return 1;
        name++;
    }
}

char *host_report_beside(const char *directory, const char *name)
{
    const size_t n = strlen(directory) + strlen(name) + 2u;
    char *path = stays_inside(name) ? malloc(n) : NULL;
    if (path != NULL)
        (void)snprintf(path, n, "%s/%s", directory, name);
    return path;
}

int host_report_there(const char *path)
{
    struct stat st;
    return lstat(path, &st) == 0;
}

static int is_object(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    size_t i = 0;
    (void)path;
    (void)total;
    while (i < n && (head[i] == ' ' || head[i] == '\n' || head[i] == '\r' || head[i] == '\t'))
        i++;
    return i < n && head[i] == '{' ? 0 : host_fail(error, "content", "an object in braces");
}

int host_report_bytes(const char *path, host_bytes *bytes, host_error *error)
{
    return host_file_read(path, is_object, bytes, error);
}

#define TEXT_OF(x) #x
#define VERSION_TEXT(major, minor, patch) TEXT_OF(major) "." TEXT_OF(minor) "." TEXT_OF(patch)

/* What the head must have. */
enum { HAS_VERSION = 1, HAS_VERDICT = 2, HAS_REASONS = 4, HAS_ITERATIONS = 8, HAS_FOLDS = 16, HAS_PARTS = 32 };
enum { HAS_ALL = 63 };

typedef struct reading {
    host_report_head *head;
    host_report_part part; /* the structure being read */
    host_stats *stats;     /* the distance being read */
    uint32_t capacity;
    unsigned has, part_has;
} reading;

const char *host_report_version(void) { return VERSION_TEXT(SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH); }

int host_scan_count(host_scan *scan, uint64_t *value)
{
    double number = 0.0;
    if (host_scan_number(scan, &number) != 0)
        return -1;
    if (!(number >= 0.0 && number <= 9007199254740992.0) || floor(number) != number)
        return host_scan_fail(scan, "a whole number");
    *value = (uint64_t)number;
    return 0;
}

int host_scan_number_or_null(host_scan *scan, double *value)
{
    *value = (double)NAN;
    if (host_scan_peek(scan) == 'n')
        return host_scan_skip(scan);
    if (host_scan_number(scan, value) != 0)
        return -1;
    return isfinite(*value) ? 0 : host_scan_fail(scan, "a finite number or null");
}

static int read_verdict(host_scan *scan, int *level)
{
    char text[16];
    size_t n = 0;
    if (host_scan_text(scan, text, sizeof text, &n) != 0)
        return -1;
    for (int i = HOST_VERDICT_GOOD; i <= HOST_VERDICT_FAILED; i++)
        if (strcmp(text, host_verdict_name(i)) == 0) {
            *level = i;
            return 0;
        }
    return host_scan_fail(scan, "good, look or failed");
}

static int read_reason(host_scan *scan, const char *key, void *context)
{
    host_verdict *const verdict = context;
    size_t n = 0;
    (void)key;
    if (verdict->n_reasons == HOST_REASONS_MAX)
        return host_scan_text(scan, NULL, 0, &n);
    return host_scan_text(scan, verdict->reason[verdict->n_reasons++], HOST_REASON_BYTES, &n);
}

static int read_statistic(host_scan *scan, const char *key, void *context)
{
    host_stats *const stats = context;
    double *const to = strcmp(key, "mean") == 0  ? &stats->mean
                       : strcmp(key, "rms") == 0 ? &stats->rms
                       : strcmp(key, "p95") == 0 ? &stats->p95
                       : strcmp(key, "max") == 0 ? &stats->max
                                                 : NULL;
    return to != NULL ? host_scan_number_or_null(scan, to) : host_scan_skip(scan);
}

/* An object of statistics, or null. */
static int read_stats(host_scan *scan, host_stats *stats)
{
    const host_stats none = {(double)NAN, (double)NAN, (double)NAN, (double)NAN, 1, 0.0};
    memset(stats, 0, sizeof *stats);
    if (host_scan_peek(scan) == 'n')
        return host_scan_skip(scan);
    *stats = none;
    return host_scan_object(scan, read_statistic, stats);
}

static int read_distance(host_scan *scan, const char *key, void *context)
{
    host_report_head *const head = context;
    if (strcmp(key, "model_to_target") == 0)
        return read_stats(scan, &head->to);
    return strcmp(key, "target_to_model") == 0 ? read_stats(scan, &head->from) : host_scan_skip(scan);
}

static int read_time(host_scan *scan, const char *key, void *context)
{
    host_report_head *const head = context;
    return strcmp(key, "total") == 0 ? host_scan_number_or_null(scan, &head->seconds) : host_scan_skip(scan);
}

static int read_part_member(host_scan *scan, const char *key, void *context)
{
    reading *const r = context;
    size_t n = 0;
    if (strcmp(key, "name") == 0) {
        r->part_has |= HAS_PARTS;
        return host_scan_text(scan, r->part.name, sizeof r->part.name, &n);
    }
    if (strcmp(key, "verdict") == 0) {
        r->part_has |= HAS_VERDICT;
        return read_verdict(scan, &r->part.level);
    }
    if (strcmp(key, "expected_error_mm") == 0)
        return host_scan_number_or_null(scan, &r->part.expected_error_mm);
    return host_scan_skip(scan);
}

static int add_part(host_scan *scan, reading *r)
{
    host_report_head *const head = r->head;
    if (head->n_parts == SMR_STRUCTURES_MAX)
        return host_scan_fail(scan, "as many structures as a model has at most");
    if (head->n_parts == r->capacity) {
        const uint32_t capacity = r->capacity > 0u ? 2u * r->capacity : 32u;
        host_report_part *const grown = realloc(head->part, capacity * sizeof *grown);
        if (grown == NULL)
            return host_scan_fail(scan, "free memory");
        head->part = grown;
        r->capacity = capacity;
    }
    head->part[head->n_parts++] = r->part;
    return 0;
}

static int read_part(host_scan *scan, const char *key, void *context)
{
    reading *const r = context;
    (void)key;
    memset(&r->part, 0, sizeof r->part);
    r->part.expected_error_mm = (double)NAN;
    r->part_has = 0;
    if (host_scan_object(scan, read_part_member, r) != 0)
        return -1;
    if (r->part_has != (HAS_PARTS | HAS_VERDICT))
        return host_scan_fail(scan, "name and verdict in the structure that ends here");
    return add_part(scan, r);
}

static int read_exit_status(host_scan *scan, int *status)
{
    uint64_t value = 0;
    if (host_scan_count(scan, &value) != 0)
        return -1;
    if (value > 4u)
        return host_scan_fail(scan, "an exit status of at most 4");
    *status = (int)value;
    return 0;
}

static int read_version(host_scan *scan, char *version, size_t bytes)
{
    size_t n = 0;
    if (host_scan_text(scan, version, bytes, &n) != 0)
        return -1;
    if (n < bytes && strcmp(version, host_report_version()) == 0)
        return 0;
    return host_fail_at(scan->error, "line", scan->text.line, "version %s: register again", host_report_version());
}

/* What needs no place of its own in the reading. */
static int read_other(host_scan *scan, const char *key, host_report_head *head)
{
    size_t n = 0;
    if (strcmp(key, "expected_error_mm") == 0)
        return host_scan_number_or_null(scan, &head->verdict.expected_error_mm);
    if (strcmp(key, "exit_status") == 0)
        return read_exit_status(scan, &head->exit_status);
    if (strcmp(key, "distance_mm") == 0 && host_scan_peek(scan) != 'n')
        return host_scan_object(scan, read_distance, head);
    if (strcmp(key, "hausdorff_mm") == 0)
        return host_scan_number_or_null(scan, &head->hausdorff_mm);
    if (strcmp(key, "time_s") == 0)
        return host_scan_object(scan, read_time, head);
    if (strcmp(key, "state_hash") == 0)
        return host_scan_text(scan, head->state_hash, sizeof head->state_hash, &n);
    return host_scan_skip(scan);
}

/* A key that is there twice is no report: which one would count? */
static int mark(host_scan *scan, reading *r, unsigned what)
{
    if ((r->has & what) != 0)
        return host_scan_fail(scan, "each key once");
    r->has |= what;
    return 0;
}

static int read_top(host_scan *scan, const char *key, void *context)
{
    static const char *const needed[] = {"version", "verdict", "reasons", "iterations", "folds", "per_structure"};
    reading *const r = context;
    host_report_head *const head = r->head;
    unsigned i = 0;
    while (i < 6u && strcmp(key, needed[i]) != 0)
        i++;
    if (i < 6u && mark(scan, r, 1u << i) != 0)
        return -1;
    switch (i) {
    case 0: return read_version(scan, head->version, sizeof head->version);
    case 1: return read_verdict(scan, &head->verdict.level);
    case 2: return host_scan_list(scan, read_reason, &head->verdict);
    case 3: return host_scan_count(scan, &head->iterations);
    case 4: return host_scan_count(scan, &head->folds);
    case 5: return host_scan_list(scan, read_part, r);
    default: return read_other(scan, key, head);
    }
}

static void clear(host_report_head *head)
{
    memset(head, 0, sizeof *head);
    head->exit_status = -1;
    head->verdict.expected_error_mm = (double)NAN;
    head->hausdorff_mm = (double)NAN;
    head->seconds = (double)NAN;
}

int host_report_parse(const void *data, size_t n, host_report_head *head, host_error *error)
{
    reading r = {0};
    clear(head);
    r.head = head;
    host_scan scan = {host_text_over(data, n), error, 0};
    int result = host_scan_object(&scan, read_top, &r);
    if (result == 0)
        result = host_scan_end(&scan);
    if (result == 0 && r.has != HAS_ALL)
        result = host_fail(error, "content", "a whole report.json of smr register, version %s", host_report_version());
    if (result != 0)
        host_report_free(head);
    return result;
}

const host_report_part *host_report_worst(const host_report_head *head)
{
    const host_report_part *worst = NULL;
    for (uint32_t i = 0; i < head->n_parts; i++) {
        const host_report_part *const p = &head->part[i];
        const double most = worst == NULL || isnan(worst->expected_error_mm) ? -1.0 : worst->expected_error_mm;
        if (worst == NULL || p->level > worst->level || (p->level == worst->level && p->expected_error_mm > most))
            worst = p;
    }
    return worst;
}

void host_report_free(host_report_head *head)
{
    free(head->part);
    clear(head);
}
