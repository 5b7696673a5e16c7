/* summary_cases.c: the results that a summary is of.
 * SPDX-License-Identifier: MIT */
#include "cohort/summary_cases.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cohort/report_path.h"

static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* Compares the numbers that both texts begin with, and goes on behind them. */
static int compare_numbers(const char **a, const char **b)
{
    size_t n = 0, m = 0;
    int order = 0;
    while (**a == '0')
        *a += 1;
    while (**b == '0')
        *b += 1;
    while (is_digit((*a)[n]))
        n++;
    while (is_digit((*b)[m]))
        m++;
    order = n != m ? (n > m) - (n < m) : strncmp(*a, *b, n);
    *a += n;
    *b += m;
    return order;
}

int host_natural_order(const char *a, const char *b)
{
    const char *p = a, *q = b;
    int order = 0;
    while (*p != '\0' && *q != '\0' && order == 0)
        if (is_digit(*p) && is_digit(*q))
            order = compare_numbers(&p, &q);
        else
            order = (int)(unsigned char)*p++ - (int)(unsigned char)*q++;
    if (order == 0)
        order = (*p != '\0') - (*q != '\0');
    if (order == 0)
        order = strcmp(a, b);
    return (order > 0) - (order < 0);
}

static int by_path(const void *a, const void *b)
{
    return host_natural_order(((const host_case *)a)->path, ((const host_case *)b)->path);
}

static char *copy_path(const char *path)
{
    size_t n = strlen(path);
    char *copy = NULL;
    while (n > 1 && path[n - 1u] == '/')
        n--;
    copy = malloc(n + 1u);
    if (copy != NULL) {
        memcpy(copy, path, n);
        copy[n] = '\0';
    }
    return copy;
}

/* -1 when out of memory. */
static int read_case(host_case *c)
{
    char *const path = host_report_beside(c->path, HOST_REPORT_NAME);
    host_bytes bytes = {NULL, 0};
    host_error error;
    memset(&error, 0, sizeof error);
    if (path == NULL)
        return -1;
    c->state = HOST_CASE_READ;
    if (host_report_bytes(path, &bytes, &error) != 0 ||
        host_report_parse(bytes.data, bytes.size, &c->head, &error) != 0) {
        c->state = host_report_there(path) ? HOST_CASE_UNREADABLE : HOST_CASE_MISSING;
        if (c->state == HOST_CASE_MISSING)
            (void)snprintf(c->why, sizeof c->why, "no " HOST_REPORT_NAME);
        else
            (void)snprintf(c->why, sizeof c->why, "%s: expected %s", error.place, error.expected);
    }
    host_file_free(&bytes);
    free(path);
    return 0;
}

int host_cases_read(const host_files *directories, host_cases *cases, host_error *error)
{
    uint32_t i = 0;
    error->file = "summary";
    cases->n_lacking = 0;
    cases->n = 0;
    cases->one = calloc(directories->n + 1u, sizeof *cases->one);
    if (cases->one == NULL)
        return host_fail(error, "start", "free memory");
    for (i = 0; i < directories->n; i++) {
        host_case *const c = &cases->one[cases->n];
        c->path = copy_path(directories->path[i]);
        if (c->path == NULL)
            return host_fail(error, "start", "free memory");
        cases->n++;
        if (read_case(c) != 0)
            return host_fail(error, "start", "free memory");
        cases->n_lacking += c->state != HOST_CASE_READ;
    }
    qsort(cases->one, cases->n, sizeof *cases->one, by_path);
    return 0;
}

void host_cases_free(host_cases *cases)
{
    uint32_t i = 0;
    for (i = 0; i < cases->n; i++) {
        free(cases->one[i].path);
        host_report_free(&cases->one[i].head);
    }
    free(cases->one);
    cases->one = NULL;
    cases->n = 0;
}

const char *host_case_verdict(const host_case *c)
{
    if (c->state == HOST_CASE_READ)
        return host_verdict_name(c->head.verdict.level);
    return c->state == HOST_CASE_MISSING ? "missing" : "unreadable";
}

int host_case_rank(const host_case *c)
{
    return c->state == HOST_CASE_READ ? c->head.verdict.level : HOST_VERDICT_FAILED + c->state;
}
