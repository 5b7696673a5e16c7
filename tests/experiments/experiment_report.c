/* experiment_report.c: reads figures from report.json and prints them as a table.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "experiment.h"
#include "files/file_read.h"

/* Behind the next "key": from `at`; NULL when there is none, or when `at` is NULL. */
static const char *after(const char *at, const char *key)
{
    char quoted[64];
    if (at == NULL)
        return NULL;
    (void)snprintf(quoted, sizeof quoted, "\"%s\":", key);
    at = strstr(at, quoted);
    return at != NULL ? at + strlen(quoted) : NULL;
}

/* -1 when there is no number. */
static double number(const char *at)
{
    char *end = NULL;
    const double value = at != NULL ? strtod(at, &end) : -1.0;
    return at != NULL && end != at ? value : -1.0;
}

static void text_at(const char *at, char *text, size_t bytes)
{
    const char *const from = at != NULL ? strchr(at, '"') : NULL;
    const char *const to = from != NULL ? strchr(from + 1, '"') : NULL;
    text[0] = '\0';
    if (to != NULL)
        (void)snprintf(text, bytes, "%.*s", (int)(to - from - 1), from + 1);
}

static double larger(double a, double b) { return a > b ? a : b; }

static void read_structures(const char *at, experiment_result *r)
{
    double most = -1.0;
    for (at = after(at, "name"); at != NULL && r->n_structures < 32u; at = after(at, "name")) {
        experiment_structure *const s = &r->structure[r->n_structures++];
        text_at(at, s->name, sizeof s->name);
        text_at(after(at, "verdict"), s->verdict, sizeof s->verdict);
        s->to_truth = number(after(after(after(at, "distance_mm"), "model_to_target"), "mean"));
        s->to_model = number(after(after(after(at, "distance_mm"), "target_to_model"), "mean"));
        s->residual = number(after(at, "residual_mean_mm"));
        s->matched = number(after(at, "matched_share"));
        s->folds = number(after(at, "folds"));
        r->worst_to_truth = larger(r->worst_to_truth, s->to_truth);
        r->worst_to_model = larger(r->worst_to_model, s->to_model);
        if (larger(s->to_truth, s->to_model) > most) {
            most = larger(s->to_truth, s->to_model);
            memcpy(r->worst, s->name, sizeof r->worst);
        }
    }
}

static void read_report(const char *text, experiment_result *r)
{
    const char *const all = after(text, "distance_mm");
    r->to_truth = number(after(after(all, "model_to_target"), "mean"));
    r->to_model = number(after(after(all, "target_to_model"), "mean"));
    r->by_vertex = number(after(after(after(text, "truth"), "vertex_to_vertex_mm"), "mean"));
    if (strstr(text, "\"vertex_to_vertex_mm\": null") != NULL)
        r->by_vertex = -1.0;
    r->folds = number(after(text, "folds"));
    r->matched = number(after(text, "matched_share"));
    r->residual = number(after(text, "residual_mean_mm"));
    r->seconds = number(after(after(text, "time_s"), "total"));
    text_at(after(text, "method"), r->method, sizeof r->method);
    text_at(after(text, "start_kind"), r->start, sizeof r->start);
    read_structures(after(text, "per_structure"), r);
}

experiment_result experiment_register(experiment_command *command, const char *out)
{
    experiment_command whole = {{NULL}, 0};
    experiment_result r;
    host_bytes bytes;
    host_error error;
    char path[1200];
    int i = 0, prepares = 0;
    memset(&r, 0, sizeof r);
    r.to_truth = r.to_model = r.worst_to_truth = r.worst_to_model = r.by_vertex = r.folds = -1.0;
    (void)snprintf(path, sizeof path, "%s/report.json", out);
    experiment_add(&whole, "register");
    experiment_add(&whole, "--threads");
    experiment_add(&whole, "2");
    experiment_add_environment(&whole, "SMR_EXPERIMENT_OPTIONS"); /* first, so that the experiment's own win */
    for (i = 0; i < command->n; i++) {
        experiment_add(&whole, "%s", command->word[i]);
        prepares |= strcmp(command->word[i], "--reference") == 0;
    }
    experiment_free(command);
    if (prepares)
        experiment_add_environment(&whole, "SMR_EXPERIMENT_BUILD");
    experiment_add(&whole, "-o");
    experiment_add(&whole, "%s", out);
    r.status = experiment_run(&whole);
    memset(&error, 0, sizeof error);
    if (experiment_written(r.status) && host_file_read(path, NULL, &bytes, &error) == 0) {
        char *const text = calloc(bytes.size + 1u, 1);
        if (text != NULL) {
            memcpy(text, bytes.data, bytes.size);
            read_report(text, &r);
        }
        free(text);
        host_file_free(&bytes);
    }
    return r;
}

/* Without a truth, or after a failure, not a number: within no bound. */
double experiment_mean(const experiment_result *result)
{
    return result->to_truth >= 0.0 && result->to_model >= 0.0 ? larger(result->to_truth, result->to_model)
                                                              : (double)NAN;
}

void experiment_print_head(void)
{
    (void)printf("  %-26s %8s %8s %8s %8s %6s %6s %6s %7s  %s\n", "mm, means", "to truth", "to model", "worst of",
                 "worst of", "vertex", "folds", "goals", "time s", "worst structure");
}

void experiment_print(const char *name, const experiment_result *r)
{
    (void)printf("  %-26s %8.3f %8.3f %8.3f %8.3f %6.2f %6.0f %5.1f%% %7.2f  %s%s\n", name, r->to_truth, r->to_model,
                 r->worst_to_truth, r->worst_to_model, r->by_vertex, r->folds,
                 r->matched > 0.0 ? 100.0 * r->matched : 0.0, r->seconds, r->worst,
                 r->status == 0   ? ""
                 : r->status == 3 ? "  (LOOK)"
                                  : "  (NOT DONE)");
    (void)fflush(stdout);
}
