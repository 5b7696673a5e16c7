/* summary_cases.c: the results that a summary is of, as a table and as the data of a page.
 * SPDX-License-Identifier: MIT */
#include "cohort/summary_cases.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "html/page_data.h"

static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* Compares the numbers that both texts begin with, and goes on behind them. */
static int compare_numbers(const char **a, const char **b)
{
    size_t n = 0, m = 0;
    while (**a == '0')
        *a += 1;
    while (**b == '0')
        *b += 1;
    while (is_digit((*a)[n]))
        n++;
    while (is_digit((*b)[m]))
        m++;
    int order = n != m ? (n > m) - (n < m) : strncmp(*a, *b, n);
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
    while (n > 1 && path[n - 1u] == '/')
        n--;
    char *copy = malloc(n + 1u);
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
    host_bytes file = {NULL, 0};
    host_error error = {0};
    if (path == NULL)
        return -1;
    c->state = HOST_CASE_READ;
    if (host_report_bytes(path, &file, &error) != 0 || host_report_parse(file.data, file.size, &c->head, &error) != 0) {
        c->state = host_report_there(path) ? HOST_CASE_UNREADABLE : HOST_CASE_MISSING;
        if (c->state == HOST_CASE_MISSING)
            (void)snprintf(c->why, sizeof c->why, "no " HOST_REPORT_NAME);
        else
            (void)snprintf(c->why, sizeof c->why, "%s: expected %s", error.place, error.expected);
    }
    host_file_free(&file);
    free(path);
    return 0;
}

int host_cases_read(const host_files *directories, host_cases *cases, host_error *error)
{
    error->file = "summary";
    cases->n_lacking = 0;
    cases->n = 0;
    cases->one = calloc(directories->n + 1u, sizeof *cases->one);
    if (cases->one == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < directories->n; i++) {
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
    for (uint32_t i = 0; i < cases->n; i++) {
        free(cases->one[i].path);
        host_report_free(&cases->one[i].head);
    }
    free(cases->one);
    cases->one = NULL;
    cases->n = 0;
}

static const char *case_verdict(const host_case *c)
{
    if (c->state == HOST_CASE_READ)
        return host_verdict_name(c->head.verdict.level);
    return c->state == HOST_CASE_MISSING ? "missing" : "unreadable";
}

int host_case_rank(const host_case *c)
{
    return c->state == HOST_CASE_READ ? c->head.verdict.level : HOST_VERDICT_FAILED + c->state;
}

/* One more field of the row; texts are quoted where RFC 4180 wants it. */
static void put_quoted(host_buffer *out, const char *text)
{
    size_t n = 1;
    for (; *text != '\0'; text += n) {
        const char c = host_clean_next(text, &n);
        if (c == '"')
            host_buffer_add(out, "\"", 1);
        host_buffer_add(out, &c, 1);
        host_buffer_add(out, text + 1, n - 1u);
    }
}

static void put_text(host_buffer *out, const char *text)
{
    const int quoted = strpbrk(text, ",\"") != NULL;
    host_buffer_add(out, "\"", quoted ? 1 : 0);
    put_quoted(out, text);
    host_buffer_add(out, "\"", quoted ? 1 : 0);
}

static void put_number(host_buffer *out, double value)
{
    if (isfinite(value))
        host_buffer_print(out, ",%.7g", value);
    else
        host_buffer_add(out, ",", 1);
}

static double mean_of(const host_stats *stats) { return stats->n > 0 ? stats->mean : (double)NAN; }

/* All reasons in one field. */
static void put_reasons(host_buffer *out, const host_case *c)
{
    const host_verdict *const verdict = &c->head.verdict;
    host_buffer_add(out, ",\"", 2);
    if (c->state != HOST_CASE_READ)
        put_quoted(out, c->why);
    for (uint32_t i = 0; i < verdict->n_reasons; i++) {
        host_buffer_add(out, "; ", i > 0 ? 2 : 0);
        put_quoted(out, verdict->reason[i]);
    }
    host_buffer_add(out, "\"", 1);
}

static void put_row(host_buffer *out, const host_case *c, int times)
{
    const host_report_head *const head = &c->head;
    const host_report_part *const worst = host_report_worst(head);
    put_text(out, c->path);
    host_buffer_print(out, ",%s", case_verdict(c));
    if (c->state != HOST_CASE_READ) {
        host_buffer_print(out, ",,,,,,,,,%s", times ? "," : "");
    } else {
        put_number(out, head->verdict.expected_error_mm);
        put_number(out, mean_of(&head->to));
        put_number(out, mean_of(&head->from));
        put_number(out, head->hausdorff_mm);
        host_buffer_add(out, ",", 1);
        put_text(out, worst != NULL ? worst->name : "");
        put_number(out, worst != NULL ? worst->expected_error_mm : (double)NAN);
        host_buffer_print(out, ",%" PRIu64 ",%" PRIu64 ",", head->folds, head->iterations);
        put_text(out, head->state_hash);
        if (times)
            put_number(out, head->seconds);
    }
    put_reasons(out, c);
    host_buffer_add(out, "\n", 1);
}

void host_summary_table(const host_cases *cases, int times, host_buffer *out)
{
    host_buffer_print(out,
                      "path,verdict,expected_error_mm,mean_to_mm,mean_from_mm,hausdorff_mm,worst_structure,worst_"
                      "expected_error_mm,folds,iterations,state_hash,%sreasons\n",
                      times ? "seconds," : "");
    for (uint32_t i = 0; i < cases->n; i++)
        put_row(out, &cases->one[i], times);
}

#define VERTICES_ALL 3000000u /* of all pictures */
#define VERTICES_MOST 6000u   /* of a picture */
#define VERTICES_LEAST 300u
#define VERTICES_READ 8000000u /* of a result; further structures are left out */
#define VERTEX_BYTES 6u

/* A text of any bytes: control characters become blanks. */
static void put_clean(host_json *json, const char *key, const char *text)
{
    host_buffer clean = {0};
    for (size_t n = 1; *text != '\0'; text += n) {
        const char c = host_clean_next(text, &n);
        host_buffer_add(&clean, &c, 1);
        host_buffer_add(&clean, text + 1, n - 1u);
    }
    host_buffer_add(&clean, "", 1);
    host_json_text(json, key, clean.failed ? "" : (const char *)clean.data);
    json->out->failed |= clean.failed;
    host_buffer_free(&clean);
}

/* Where a card's title leads: to the result's own page, or to its report. */
static void put_link(const host_case *c, const char *page, host_json *json)
{
    static const char *const names[] = {"report.html", HOST_REPORT_NAME};
    for (size_t i = 0; i < 2; i++) {
        char *const file = host_report_beside(c->path, names[i]);
        char *const way = file != NULL && host_report_there(file) ? host_relative_path(page, file) : NULL;
        if (way != NULL)
            host_json_text(json, "link", way);
        free(file);
        free(way);
        if (way != NULL)
            return;
    }
}

static void put_facts(const host_report_head *h, host_json *json)
{
    const host_report_part *const worst = host_report_worst(h);
    char text[SMR_NAME_BYTES + 16u];
    host_json_number(json, "expected_error_mm", h->verdict.expected_error_mm);
    host_json_number(json, "mean_to_mm", h->to.n > 0 ? h->to.mean : (double)NAN);
    host_json_number(json, "mean_from_mm", h->from.n > 0 ? h->from.mean : (double)NAN);
    host_json_number(json, "hausdorff_mm", h->hausdorff_mm);
    if (worst != NULL) {
        (void)snprintf(text, sizeof text, "%s, %s", worst->name, host_verdict_name(worst->level));
        put_clean(json, "worst", text);
    }
    host_json_count(json, "folds", h->folds);
    host_json_count(json, "iterations", h->iterations);
}

static void list_reasons(const host_case *c, host_json *json)
{
    host_json_open(json, "reasons", '[');
    if (c->state != HOST_CASE_READ)
        put_clean(json, NULL, c->why);
    for (uint32_t i = 0; i < c->head.verdict.n_reasons; i++)
        put_clean(json, NULL, c->head.verdict.reason[i]);
    host_json_close(json, ']');
}

/* A structure's surface, whatever format it was written in. What cannot be read is left out. */
static void read_surface(const host_case *c, uint32_t part, host_mesh *mesh)
{
    static const char *const extensions[] = {"ply", "vtk", "obj", "stl"};
    for (size_t i = 0; i < sizeof extensions / sizeof extensions[0] && mesh->n_vertices == 0; i++) {
        char name[SMR_NAME_BYTES + 8u];
        host_error error = {0};
        (void)snprintf(name, sizeof name, "%s.%s", c->head.part[part].name, extensions[i]);
        char *const path = host_report_beside(c->path, name);
        if (path != NULL && host_report_there(path))
            (void)host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, mesh, &error);
        free(path);
    }
}

/* What the card's picture is drawn from. 0, or -1 when out of memory. */
static int put_surfaces(const host_case *c, size_t vertices_most, host_json *json)
{
    const uint32_t n = c->head.n_parts;
    host_mesh *const mesh = calloc((size_t)n + 1u, sizeof *mesh);
    host_page_part *const part = calloc((size_t)n + 1u, sizeof *part);
    uint64_t vertices = 0;
    float cell_mm = 0.0f;
    int result = mesh == NULL || part == NULL ? -1 : 0;
    for (uint32_t i = 0; result == 0 && i < n; i++) {
        if (vertices < VERTICES_READ)
            read_surface(c, i, &mesh[i]);
        vertices += mesh[i].n_vertices;
        part[i] = (host_page_part){&mesh[i], VERTEX_BYTES, {0}};
    }
    if (result == 0)
        result = host_page_thin_all(part, n, vertices_most, SIZE_MAX, &cell_mm);
    host_json_open(json, "surfaces", '[');
    for (uint32_t i = 0; result == 0 && i < n; i++) {
        if (mesh[i].n_vertices == 0)
            continue;
        host_json_open(json, NULL, '{');
        host_json_text(json, "level", host_verdict_name(c->head.part[i].level));
        host_page_triangles(json, &part[i].thin);
        host_page_points(json, "place", mesh[i].xyz, part[i].thin.keep, part[i].thin.n_vertices);
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
    for (uint32_t i = 0; mesh != NULL && i < n; i++)
        host_mesh_free(&mesh[i]);
    free(mesh);
    host_page_parts_free(part, n);
    return result;
}

int host_summary_page(const host_cases *cases, const char *page, host_buffer *out)
{
    const size_t share = VERTICES_ALL / (cases->n + 1u), most = share < VERTICES_MOST ? share : VERTICES_MOST;
    host_buffer text = {0};
    host_json json = {&text, 0, 1, 1};
    int result = 0;
    host_json_open(&json, NULL, '{');
    host_json_text(&json, "kind", "cohort");
    host_json_text(&json, "version", host_report_version());
    host_json_open(&json, "cases", '[');
    for (uint32_t i = 0; result == 0 && i < cases->n; i++) {
        const host_case *const c = &cases->one[i];
        host_json_open(&json, NULL, '{');
        host_json_text(&json, "verdict", case_verdict(c));
        put_clean(&json, "path", c->path);
        put_link(c, page, &json);
        list_reasons(c, &json);
        if (c->state == HOST_CASE_READ) {
            put_facts(&c->head, &json);
            result = put_surfaces(c, most > VERTICES_LEAST ? most : VERTICES_LEAST, &json);
        }
        host_json_close(&json, '}');
    }
    host_json_close(&json, ']');
    host_json_close(&json, '}');
    host_page_write(&text, out);
    host_buffer_free(&text);
    return result;
}
