/* report_head.c: reads what a result's report.json says at its head.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "cohort/report_head.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "files/file_names.h"

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
    return stays_inside(name) ? host_path_in(directory, name) : NULL;
}

int host_report_there(const char *path)
{
    struct stat st;
    return lstat(path, &st) == 0;
}

static int is_object(const host_head *h, host_error *error)
{
    size_t i = 0;
    while (i < h->n && (h->data[i] == ' ' || h->data[i] == '\n' || h->data[i] == '\r' || h->data[i] == '\t'))
        i++;
    return i < h->n && h->data[i] == '{' ? 0 : host_fail(error, "content", "an object in braces");
}

int host_report_bytes(const char *path, host_bytes *bytes, host_error *error)
{
    return host_file_read(path, is_object, bytes, error);
}

#define TEXT_OF(x) #x
#define VERSION_TEXT(major, minor, patch) TEXT_OF(major) "." TEXT_OF(minor) "." TEXT_OF(patch)

typedef struct reading {
    host_report_head *head;
    uint32_t capacity;
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

static int read_count(host_scan *scan, void *to) { return host_scan_count(scan, to); }

/* A number or null (NaN). */
static int read_number(host_scan *scan, void *to)
{
    double *const value = to;
    *value = (double)NAN;
    if (host_scan_peek(scan) == 'n')
        return host_scan_skip(scan);
    if (host_scan_number(scan, value) != 0)
        return -1;
    return isfinite(*value) ? 0 : host_scan_fail(scan, "a finite number or null");
}

static int read_verdict(host_scan *scan, void *to)
{
    int *const level = to;
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

static int read_reason(host_scan *scan, void *context)
{
    host_verdict *const verdict = context;
    size_t n = 0;
    if (verdict->n_reasons == HOST_REASONS_MAX)
        return host_scan_text(scan, NULL, 0, &n);
    return host_scan_text(scan, verdict->reason[verdict->n_reasons++], HOST_REASON_BYTES, &n);
}

static int read_reasons(host_scan *scan, void *to) { return host_scan_list(scan, read_reason, to); }

/* An object of statistics, or null. */
static int read_stats(host_scan *scan, void *to)
{
    static const host_scan_field fields[] = {{"mean", read_number, offsetof(host_stats, mean)},
                                             {"rms", read_number, offsetof(host_stats, rms)},
                                             {"p95", read_number, offsetof(host_stats, p95)},
                                             {"max", read_number, offsetof(host_stats, max)}};
    const host_stats none = {(double)NAN, (double)NAN, (double)NAN, (double)NAN, 1, 0.0};
    host_scan_members o = {fields, sizeof fields / sizeof fields[0], to, 0, 0};
    memset(to, 0, sizeof none);
    if (host_scan_peek(scan) == 'n')
        return host_scan_skip(scan);
    memcpy(to, &none, sizeof none);
    return host_scan_struct(scan, &o);
}

static int read_distances(host_scan *scan, void *head)
{
    static const host_scan_field fields[] = {{"model_to_target", read_stats, offsetof(host_report_head, to)},
                                             {"whole_model_to_target", read_stats, offsetof(host_report_head, whole)},
                                             {"target_to_model", read_stats, offsetof(host_report_head, from)}};
    host_scan_members o = {fields, sizeof fields / sizeof fields[0], head, 0, 0};
    return host_scan_peek(scan) == 'n' ? host_scan_skip(scan) : host_scan_struct(scan, &o);
}

static int read_times(host_scan *scan, void *head)
{
    static const host_scan_field fields[] = {{"total", read_number, offsetof(host_report_head, seconds)}};
    host_scan_members o = {fields, sizeof fields / sizeof fields[0], head, 0, 0};
    return host_scan_struct(scan, &o);
}

static int read_name(host_scan *scan, void *to)
{
    size_t n = 0;
    return host_scan_text(scan, to, SMR_NAME_BYTES, &n);
}

static int read_hash(host_scan *scan, void *to)
{
    size_t n = 0;
    return host_scan_text(scan, to, sizeof((host_report_head *)0)->state_hash, &n);
}

static int add_part(host_scan *scan, reading *r, const host_report_part *part)
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
    head->part[head->n_parts++] = *part;
    return 0;
}

static int read_part(host_scan *scan, void *context)
{
    static const host_scan_field fields[] = {
        {"name", read_name, offsetof(host_report_part, name)},
        {"verdict", read_verdict, offsetof(host_report_part, level)},
        {"expected_error_mm", read_number, offsetof(host_report_part, expected_error_mm)}};
    host_report_part part = {"", 0, (double)NAN};
    host_scan_members o = {fields, sizeof fields / sizeof fields[0], &part, 0, 0};
    if (host_scan_struct(scan, &o) != 0)
        return -1;
    if ((o.has & 3u) != 3u)
        return host_scan_fail(scan, "name and verdict in the structure that ends here");
    return add_part(scan, context, &part);
}

static int read_parts(host_scan *scan, void *head)
{
    reading r = {head, 0};
    return host_scan_list(scan, read_part, &r);
}

static int read_exit_status(host_scan *scan, void *status)
{
    uint64_t value = 0;
    if (host_scan_count(scan, &value) != 0)
        return -1;
    if (value > 4u)
        return host_scan_fail(scan, "an exit status of at most 4");
    *(int *)status = (int)value;
    return 0;
}

static int read_version(host_scan *scan, void *version)
{
    const size_t bytes = sizeof((host_report_head *)0)->version;
    size_t n = 0;
    if (host_scan_text(scan, version, bytes, &n) != 0)
        return -1;
    if (n < bytes && strcmp(version, host_report_version()) == 0)
        return 0;
    return host_fail_at(scan->error, "line", scan->text.line, "version %s: register again", host_report_version());
}

#define IN_HEAD(member) offsetof(host_report_head, member)

/* The first N_NEEDED of these must be there, once. */
static const host_scan_field top_fields[] = {{"version", read_version, IN_HEAD(version)},
                                             {"verdict", read_verdict, IN_HEAD(verdict.level)},
                                             {"reasons", read_reasons, IN_HEAD(verdict)},
                                             {"iterations", read_count, IN_HEAD(iterations)},
                                             {"folds", read_count, IN_HEAD(folds)},
                                             {"per_structure", read_parts, 0},
                                             {"expected_error_mm", read_number, IN_HEAD(verdict.expected_error_mm)},
                                             {"probability", read_number, IN_HEAD(verdict.probability)},
                                             {"exit_status", read_exit_status, IN_HEAD(exit_status)},
                                             {"distance_mm", read_distances, 0},
                                             {"hausdorff_mm", read_number, IN_HEAD(hausdorff_mm)},
                                             {"time_s", read_times, 0},
                                             {"state_hash", read_hash, IN_HEAD(state_hash)}};

#define N_NEEDED 6u

static void clear(host_report_head *head)
{
    memset(head, 0, sizeof *head);
    head->exit_status = -1;
    head->verdict.probability = head->verdict.expected_error_mm = (double)NAN;
    head->hausdorff_mm = (double)NAN;
    head->seconds = (double)NAN;
}

int host_report_parse(const void *data, size_t n, host_report_head *head, host_error *error)
{
    const unsigned needed = (1u << N_NEEDED) - 1u;
    host_scan_members top = {top_fields, sizeof top_fields / sizeof top_fields[0], head, 0, needed};
    host_scan scan = {host_text_over(data, n), error, 0};
    clear(head);
    int result = host_scan_struct(&scan, &top);
    if (result == 0)
        result = host_scan_end(&scan);
    if (result == 0 && (top.has & needed) != needed)
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
