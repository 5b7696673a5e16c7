/* summary_table.c: a cohort as a table.
 * SPDX-License-Identifier: MIT */
#include "cohort/summary_table.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/clean_text.h"

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
    uint32_t i = 0;
    host_buffer_add(out, ",\"", 2);
    if (c->state != HOST_CASE_READ)
        put_quoted(out, c->why);
    for (i = 0; i < verdict->n_reasons; i++) {
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
    host_buffer_print(out, ",%s", host_case_verdict(c));
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
    uint32_t i = 0;
    host_buffer_print(out,
                      "path,verdict,expected_error_mm,mean_to_mm,mean_from_mm,hausdorff_mm,worst_structure,"
                      "worst_expected_error_mm,folds,iterations,state_hash,%sreasons\n",
                      times ? "seconds," : "");
    for (i = 0; i < cases->n; i++)
        put_row(out, &cases->one[i], times);
}
