/* case_run.c: runs smr register and flattens its report.
 * SPDX-License-Identifier: MIT */
#include "case_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/system.h"
#include "files/file_read.h"
#include "landmarks/json_scan.h"

/* Where the scanner is. */
typedef struct place {
    case_run *run;
    char path[96];
    uint32_t item; /* of the list that is read */
} place;

static void keep(place *at, const char *text)
{
    case_value *v = NULL;
    size_t n = 0;
    if (at->run->n > 0 && strcmp(at->run->value[at->run->n - 1u].key, at->path) == 0) {
        v = &at->run->value[at->run->n - 1u];
        n = strlen(v->text);
        (void)snprintf(v->text + n, sizeof v->text - n, " + %s", text);
        return;
    }
    if (at->run->n >= CASE_KEYS)
        return;
    v = &at->run->value[at->run->n++];
    (void)snprintf(v->key, sizeof v->key, "%s", at->path);
    (void)snprintf(v->text, sizeof v->text, "%s", text);
}

static int read_value(host_scan *scan, const char *key, void *context);

static int read_list(host_scan *scan, void *context)
{
    place *const at = context;
    if (strcmp(at->path, "per_structure") == 0 && at->item++ > 0)
        return host_scan_skip(scan);
    return read_value(scan, NULL, at);
}

static int read_word(host_scan *scan, place *at)
{
    char text[160];
    size_t n = 0;
    const char *from = scan->text.at;
    if (*from == '"') {
        if (host_scan_text(scan, text, sizeof text, &n) != 0)
            return -1;
    } else {
        if (host_scan_skip(scan) != 0)
            return -1;
        (void)snprintf(text, sizeof text, "%.*s", (int)(scan->text.at - from), from);
    }
    keep(at, text);
    return 0;
}

static int read_value(host_scan *scan, const char *key, void *context)
{
    place at = *(place *)context;
    const char c = host_scan_peek(scan);
    const size_t n = strlen(at.path);
    if (key != NULL)
        (void)snprintf(at.path + n, sizeof at.path - n, "%s%s", n > 0 ? "." : "", key);
    at.item = 0;
    if (c == '{')
        return host_scan_object(scan, read_value, &at);
    if (c == '[')
        return host_scan_list(scan, read_list, &at);
    return read_word(scan, &at);
}

static void read_report(const char *path, case_run *run)
{
    host_bytes bytes;
    host_error error;
    host_scan scan;
    place at;
    memset(&error, 0, sizeof error);
    memset(&scan, 0, sizeof scan);
    memset(&at, 0, sizeof at);
    at.run = run;
    if (host_file_read(path, NULL, &bytes, &error) != 0)
        return;
    error.file = path;
    scan.text.at = (const char *)bytes.data;
    scan.text.end = (const char *)bytes.data + bytes.size;
    scan.text.line = 1;
    scan.error = &error;
    if (read_value(&scan, NULL, &at) != 0)
        host_error_print(&error);
    host_file_free(&bytes);
}

void case_register(experiment_command *words, const char *out, case_run *run)
{
    const char *const threads = getenv("CASE_THREADS");
    experiment_command whole = {{NULL}, 0};
    char path[CASE_TEXT];
    int i = 0;
    double begin = 0.0;
    memset(run, 0, sizeof *run);
    experiment_add(&whole, "register");
    experiment_add(&whole, "--threads");
    experiment_add(&whole, "%s", threads != NULL ? threads : "1");
    experiment_add_environment(&whole, "SMR_EXPERIMENT_OPTIONS");
    for (i = 0; i < words->n; i++)
        experiment_add(&whole, "%s", words->word[i]);
    experiment_add(&whole, "-o");
    experiment_add(&whole, "%s", out);
    experiment_free(words);
    (void)snprintf(path, sizeof path, "%.1000s/report.json", out);
    (void)remove(path);
    begin = host_seconds();
    run->status = experiment_run(&whole);
    run->seconds = host_seconds() - begin;
    if (run->status != 2)
        read_report(path, run);
}

void case_add_words(const case_data *data, const char *directory, experiment_command *words)
{
    static const char *const options[] = {"model", "target"};
    uint32_t i = 0;
    int k = 0;
    for (k = 0; k < 2; k++) {
        experiment_add(words, "--%s", options[k]);
        for (i = 0; i < data->n; i++)
            if (k == 0 || data->body[i].target.n_triangles > 0)
                experiment_add(words, "%s/%s/%s.ply", directory, options[k], data->body[i].name);
    }
}

const char *case_text(const case_run *run, const char *key)
{
    uint32_t i = 0;
    for (i = 0; i < run->n; i++)
        if (strcmp(run->value[i].key, key) == 0)
            return run->value[i].text;
    return "";
}

double case_number(const case_run *run, const char *key)
{
    const char *const text = case_text(run, key);
    char *end = NULL;
    const double value = strtod(text, &end);
    if (strcmp(text, "true") == 0 || strcmp(text, "false") == 0)
        return text[0] == 't';
    return end != text ? value : -1.0;
}
