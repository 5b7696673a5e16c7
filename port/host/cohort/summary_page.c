/* summary_page.c: a cohort as one HTML file: a card for each result, those to be looked at first come first. It needs
 * no network and no script, and says in words what it says in colour.
 * SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clean_text.h"
#include "cohort/report_path.h"
#include "cohort/summary_table.h"
#include "files/file_names.h"

enum { RANKS = 5 };

/* [rank]: what it is called, and what to do about it. */
static const char *const rank_name[RANKS] = {"good", "look", "failed", "unreadable", "missing"};
static const char *const rank_meaning[RANKS] = {
    "nothing speaks against these", "somebody should look at these", "these cannot be relied on",
    "these reports are damaged or of another version", "these have no report: not computed, or not to the end"};

static const char *const head[] = {
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n",
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>smr: results</title>\n<style>\n",
    "body{font:15px/1.45 system-ui,sans-serif;margin:1.5rem auto;max-width:82rem;padding:0 1rem;color:#111;",
    "background:#fff}\nh1{font-size:1.4rem}h2{font-size:1.1rem;margin:2rem 0 .6rem}h3{font-size:1rem;margin:0}\n",
    ".grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(25rem,1fr));gap:.8rem}\n",
    "article{display:grid;grid-template-columns:7.2rem minmax(0,1fr);gap:.8rem;border:1px solid "
    "#777;border-radius:4px;",
    "padding:.7rem;break-inside:avoid}\n",
    "article.look{border:2px dashed #8a5a00}article.failed{border:5px double #a00000}\n",
    "article.missing,article.unreadable{border:2px dotted #333}\n",
    "svg{width:7.2rem;height:12rem}svg path{fill:none;stroke-width:1.05}\n",
    ".t0{stroke:#767676}.t1{stroke:#969696}.t2{stroke:#b2b2b2}.t3{stroke:#cccccc}.t4{stroke:#e4e4e4}.t5{stroke:#111}\n",
    ".none{display:grid;place-items:center;width:7.2rem;height:12rem;border:1px solid #bbb;color:#555;",
    "font-size:.8rem;text-align:center}\n",
    ".badge{display:inline-block;font-weight:700;border:1px solid;border-radius:3px;padding:0 .4em;",
    "text-transform:uppercase;font-size:.8rem}\n",
    ".good .badge{color:#0a5c1e}.look .badge{color:#fff;background:#8a5a00}.failed .badge{color:#fff;",
    "background:#a00000}\n",
    "dl{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:0 .7rem;margin:.4rem "
    "0}dt{color:#444}dd{margin:0;overflow-wrap:anywhere}\n",
    "ul{margin:.3rem 0 0;padding-left:1.1rem;font-size:.9rem;overflow-wrap:anywhere}h3 a{overflow-wrap:anywhere}\n",
    "</style>\n</head>\n<body>\n"};

static void put(host_buffer *out, const char *text) { host_buffer_add(out, text, strlen(text)); }

/* A text of any bytes as HTML. */
static void put_escaped(host_buffer *out, const char *text)
{
    size_t n = 1;
    for (; *text != '\0'; text += n) {
        const char c = host_clean_next(text, &n);
        if (strchr("&<>\"'", c) != NULL)
            host_buffer_print(out, "&#%d;", c);
        else
            host_buffer_add(out, &c, 1);
        host_buffer_add(out, text + 1, n - 1u);
    }
}

/* A path as a link's target. */
static void put_link(host_buffer *out, const char *path)
{
    static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
    for (; *path != '\0'; path++)
        if (strchr(plain, *path) != NULL)
            host_buffer_add(out, path, 1);
        else
            host_buffer_print(out, "%%%02X", (unsigned)(unsigned char)*path);
}

/* The way from one absolute directory to another path. */
static void put_way(host_buffer *out, const char *from, const char *to)
{
    size_t same = 0, i = 0;
    for (i = 0; from[i] != '\0' && from[i] == to[i]; i++)
        if (from[i] == '/')
            same = i + 1u;
    if (from[i] == '\0' && to[i] == '/')
        same = i + 1u;
    for (i = same; i < strlen(from); i++)
        if (i == same || from[i - 1u] == '/')
            put(out, "../");
    put_link(out, to + (same < strlen(to) ? same : strlen(to)));
}

/* The case's path as its title, which leads to its own page, or to its report. base: the page's directory. */
static void put_title(host_buffer *out, const host_case *c, const char *base)
{
    static const char *const names[] = {"report.html", HOST_REPORT_NAME};
    char *file = NULL, *whole = NULL;
    size_t i = 0;
    for (i = 0; i < 2 && whole == NULL && base != NULL; i++) {
        file = host_report_beside(c->path, names[i]);
        whole = file != NULL ? realpath(file, NULL) : NULL;
        free(file);
    }
    put(out, "<h3>");
    if (whole != NULL) {
        put(out, "<a href=\"");
        put_way(out, base, whole);
        put(out, "\">");
    }
    put_escaped(out, c->path);
    put(out, whole != NULL ? "</a></h3>" : "</h3>");
    free(whole);
}

static void put_figure(host_buffer *out, const char *name, double value, const char *unit)
{
    if (isfinite(value))
        host_buffer_print(out, "<dt>%s</dt><dd>%.3g%s</dd>", name, value, unit);
}

static void put_facts(host_buffer *out, const host_report_head *h)
{
    const host_report_part *const worst = host_report_worst(h);
    put(out, "<dl>");
    put_figure(out, "expected error", h->verdict.expected_error_mm, " mm");
    put_figure(out, "mean distance to", h->to.n > 0 ? h->to.mean : (double)NAN, " mm");
    put_figure(out, "mean distance from", h->from.n > 0 ? h->from.mean : (double)NAN, " mm");
    put_figure(out, "largest distance", h->hausdorff_mm, " mm");
    if (worst != NULL) {
        put(out, "<dt>look first at</dt><dd>");
        put_escaped(out, worst->name);
        host_buffer_print(out, ", %s</dd>", host_verdict_name(worst->level));
    }
    if (h->folds > 0)
        host_buffer_print(out, "<dt>folds</dt><dd>%" PRIu64 "</dd>", h->folds);
    host_buffer_print(out, "<dt>iterations</dt><dd>%" PRIu64 "</dd></dl>", h->iterations);
}

static void put_reasons(host_buffer *out, const host_case *c)
{
    const host_verdict *const verdict = &c->head.verdict;
    uint32_t i = 0;
    if (c->state == HOST_CASE_READ && verdict->n_reasons == 0)
        return;
    put(out, "<ul>");
    if (c->state != HOST_CASE_READ) {
        put(out, "<li>");
        put_escaped(out, c->why);
        put(out, "</li>");
    }
    for (i = 0; i < verdict->n_reasons; i++) {
        put(out, "<li>");
        put_escaped(out, verdict->reason[i]);
        put(out, "</li>");
    }
    put(out, "</ul>");
}

static int put_card(host_buffer *out, const host_case *c, const char *base)
{
    const char *const verdict = host_case_verdict(c);
    size_t before = 0;
    host_buffer_print(out, "<article class=\"%s\">\n<div>", verdict);
    before = out->size;
    if (c->state == HOST_CASE_READ && host_summary_picture(c, out) != 0)
        return -1;
    if (out->size == before)
        put(out, "<span class=\"none\">no surfaces</span>");
    put(out, "</div>\n<div>");
    put_title(out, c, base);
    host_buffer_print(out, "<span class=\"badge\">%s</span>", verdict);
    if (c->state == HOST_CASE_READ)
        put_facts(out, &c->head);
    put_reasons(out, c);
    put(out, "</div>\n</article>\n");
    return 0;
}

static int put_rank(host_buffer *out, const host_cases *cases, int rank, uint32_t n, const char *base)
{
    uint32_t i = 0;
    host_buffer_print(out, "<section id=\"%s\">\n<h2>%s: %u; %s</h2>\n<div class=\"grid\">\n", rank_name[rank],
                      rank_name[rank], n, rank_meaning[rank]);
    for (i = 0; i < cases->n; i++)
        if (host_case_rank(&cases->one[i]) == rank && put_card(out, &cases->one[i], base) != 0)
            return -1;
    put(out, "</div>\n</section>\n");
    return 0;
}

/* The directory of the page, which is there, as an absolute path to be freed; or NULL. */
static char *directory_of(const char *page)
{
    char *const parent = malloc(strlen(page) + 2u);
    char *whole = NULL;
    if (parent == NULL)
        return NULL;
    memcpy(parent, page, strlen(page) + 1u);
    host_path_to_parent(parent);
    whole = realpath(parent, NULL);
    free(parent);
    return whole;
}

int host_summary_page(const host_cases *cases, const char *page, host_buffer *out)
{
    uint32_t count[RANKS] = {0}, i = 0;
    char *const base = directory_of(page);
    int rank = 0, result = 0;
    for (i = 0; i < sizeof head / sizeof head[0]; i++)
        put(out, head[i]);
    for (i = 0; i < cases->n; i++)
        count[host_case_rank(&cases->one[i])]++;
    host_buffer_print(out, "<h1>smr: %u results</h1>\n<p>", cases->n);
    for (rank = RANKS - 1; rank >= 0; rank--)
        if (count[rank] > 0)
            host_buffer_print(out, "<a href=\"#%s\">%u %s</a> ", rank_name[rank], count[rank], rank_name[rank]);
    put(out, "</p>\n");
    for (rank = RANKS - 1; rank >= 0 && result == 0; rank--)
        if (count[rank] > 0)
            result = put_rank(out, cases, rank, count[rank], base);
    put(out, "</body>\n</html>\n");
    free(base);
    return result;
}
