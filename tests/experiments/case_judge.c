/* case_judge.c: what the rows of many runs show about verdicts.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case.h"
#include "case_verdicts.h"

enum { LINE = 65536, FIELDS = 600, ROWS = 20000 };

typedef struct judged {
    char kind[24];
    uint32_t seed;
    int hopeless, good, image, named;
    double surface, vertex, spearman, ratio, overlap;
} judged;

static uint32_t split(char *line, char *field[FIELDS])
{
    uint32_t n = 0;
    char *at = line;
    while (at != NULL && n < FIELDS) {
        field[n++] = at;
        at = strchr(at, ',');
        if (at != NULL)
            *at++ = '\0';
    }
    if (n > 0)
        field[n - 1u][strcspn(field[n - 1u], "\r\n")] = '\0';
    return n;
}

static const char *value_of(char *const *names, char *const *field, uint32_t n, const char *name)
{
    uint32_t i = 0;
    for (i = 0; i < n; i++)
        if (strcmp(names[i], name) == 0)
            return field[i];
    return "";
}

static judged read_row(char *const *names, char *const *field, uint32_t n)
{
    const char *const verdict = value_of(names, field, n, "verdict");
    judged j;
    memset(&j, 0, sizeof j);
    (void)snprintf(j.kind, sizeof j.kind, "%s", value_of(names, field, n, "kind"));
    j.seed = (uint32_t)atoi(value_of(names, field, n, "seed"));
    j.hopeless = atoi(value_of(names, field, n, "hopeless"));
    j.image = atoi(value_of(names, field, n, "image"));
    j.overlap = atof(value_of(names, field, n, "overlap"));
    j.surface = atof(value_of(names, field, n, "surface"));
    j.vertex = atof(value_of(names, field, n, "vertex"));
    j.spearman = atof(value_of(names, field, n, "spearman_vertex"));
    j.ratio = atof(value_of(names, field, n, "ratio_vertex"));
    j.named = verdict[0] != '\0';
    j.good = j.named ? strcmp(verdict, "good") == 0 : atoi(value_of(names, field, n, "status")) == 0;
    return j;
}

static judged *read_rows(const char *csv, uint32_t *n)
{
    judged *const rows = case_alloc(ROWS, sizeof *rows);
    char *const head = case_alloc(LINE, 1), *const line = case_alloc(LINE, 1);
    char **const names = case_alloc(FIELDS, sizeof *names), **const field = case_alloc(FIELDS, sizeof *field);
    FILE *const file = fopen(csv, "r");
    *n = 0;
    if (file != NULL && fgets(head, LINE, file) != NULL) {
        const uint32_t columns = split(head, names);
        while (*n < ROWS && fgets(line, LINE, file) != NULL)
            if (split(line, field) == columns)
                rows[(*n)++] = read_row(names, field, columns);
    }
    if (file != NULL)
        (void)fclose(file);
    free(head);
    free(line);
    free(names);
    free(field);
    return rows;
}

/* The logarithm of n over k. */
static double log_choose(uint32_t n, uint32_t k)
{
    return lgamma((double)n + 1.0) - lgamma((double)k + 1.0) - lgamma((double)(n - k) + 1.0);
}

double case_upper_bound(uint32_t k, uint32_t n)
{
    double low = 0.0, high = 1.0;
    int i = 0;
    if (n == 0 || k >= n)
        return 1.0;
    for (i = 0; i < 60; i++) {
        const double p = 0.5 * (low + high);
        double sum = 0.0;
        uint32_t j = 0;
        for (j = 0; j <= k; j++)
            sum += exp(log_choose(n, j) + j * log(p) + (n - j) * log1p(-p));
        if (sum > 0.05)
            low = p;
        else
            high = p;
    }
    return 0.5 * (low + high);
}

/* A run's error, mm: by the places of vertices where they are known, or of the surface alone. */
static double error_of(const judged *j, int by_vertex)
{
    if (j->hopeless || j->surface < 0.0)
        return HUGE_VAL;
    return by_vertex && j->vertex >= 0.0 ? j->vertex : j->surface;
}

static void add_to(case_counts *s, const judged *j, int by_vertex)
{
    const double error = error_of(j, by_vertex);
    s->n++;
    s->far += error > 3.0;
    s->far_good += error > 3.0 && j->good;
    s->near += error < 1.0;
    s->near_not += error < 1.0 && !j->good;
    if (!j->hopeless && j->vertex >= 0.0 && !isnan(j->ratio)) {
        s->n_ratios++;
        s->ratios_in += j->ratio >= 0.7 && j->ratio <= 1.5;
    }
}

static double share(uint32_t k, uint32_t n) { return n > 0 ? 100.0 * k / n : 0.0; }

static void print_counts(const case_counts *s, int half, int by_vertex)
{
    (void)printf("%s seeds, by %-7s %4u runs; above 3 mm %4u, good %3u = %5.1f %% (<= %5.1f %%); below 1 mm %4u, not "
                 "good %3u = %5.1f %% (<= %5.1f %%)\n",
                 half ? "odd " : "even", by_vertex ? "vertex" : "surface", s->n, s->far, s->far_good,
                 share(s->far_good, s->far), 100.0 * case_upper_bound(s->far_good, s->far), s->near, s->near_not,
                 share(s->near_not, s->near), 100.0 * case_upper_bound(s->near_not, s->near));
    if (by_vertex && s->n_ratios > 0)
        (void)printf("%s seeds, expected errors: median Spearman %.2f over partial targets and images; mean over true "
                     "mean within 0.7..1.5 in %.0f %% of %u\n",
                     half ? "odd " : "even", s->spearman, share(s->ratios_in, s->n_ratios), s->n_ratios);
}

static int by_number(const void *a, const void *b)
{
    const double *const x = a, *const y = b;
    return (*x > *y) - (*x < *y);
}

/* Of partial runs and images. */
static double median_spearman(const judged *rows, uint32_t n, uint32_t half)
{
    double *const list = case_alloc(n, sizeof *list), median = (double)NAN;
    uint32_t i = 0, count = 0;
    for (i = 0; i < n; i++)
        if (rows[i].seed % 2u == half && !rows[i].hopeless && rows[i].vertex >= 0.0 && !isnan(rows[i].spearman) &&
            (rows[i].image || rows[i].overlap < 0.95))
            list[count++] = rows[i].spearman;
    qsort(list, count, sizeof *list, by_number);
    if (count > 0)
        median = list[count / 2u];
    free(list);
    return median;
}

static case_counts count_rows(const judged *rows, uint32_t n, int half, int by_vertex)
{
    case_counts s;
    uint32_t i = 0;
    memset(&s, 0, sizeof s);
    for (i = 0; i < n; i++)
        if (rows[i].seed % 2u == (uint32_t)half)
            add_to(&s, &rows[i], by_vertex);
    s.spearman = median_spearman(rows, n, (uint32_t)half);
    return s;
}

case_counts case_count(const char *csv, int half, int by_vertex)
{
    uint32_t n = 0;
    judged *const rows = read_rows(csv, &n);
    const case_counts s = count_rows(rows, n, half, by_vertex);
    free(rows);
    return s;
}

/* A line for each kind, in the order of the first run. */
static void print_kinds(const judged *rows, uint32_t n)
{
    double *const list = case_alloc(n, sizeof *list);
    uint32_t i = 0, k = 0;
    for (i = 0; i < n; i++) {
        double surface = 0.0;
        uint32_t count = 0, good = 0;
        for (k = 0; k < i && strcmp(rows[k].kind, rows[i].kind) != 0; k++)
            ;
        if (k < i)
            continue;
        for (k = 0; k < n; k++)
            if (strcmp(rows[k].kind, rows[i].kind) == 0) {
                list[count++] = rows[k].surface;
                good += (uint32_t)rows[k].good;
            }
        qsort(list, count, sizeof *list, by_number);
        surface = list[count / 2u];
        for (k = 0, count = 0; k < n; k++)
            if (strcmp(rows[k].kind, rows[i].kind) == 0)
                list[count++] = rows[k].vertex;
        qsort(list, count, sizeof *list, by_number);
        (void)printf("  %-20s %s %4u runs, %4u good; median surface %8.3f, vertex %8.3f\n", rows[i].kind,
                     rows[i].hopeless ? "hopeless" : "        ", count, good, surface, list[count / 2u]);
    }
    free(list);
}

int case_judge(const char *csv)
{
    uint32_t n = 0;
    judged *const rows = read_rows(csv, &n);
    int i = 0;
    for (i = 0; i < 4; i++) {
        const case_counts s = count_rows(rows, n, i % 2, i / 2);
        print_counts(&s, i % 2, i / 2);
    }
    print_kinds(rows, n);
    free(rows);
    return n > 0 ? 0 : 1;
}
