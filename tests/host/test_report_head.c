/* test_report_head.c: reports of any bytes are read or refused; what is read is within its bounds, and becomes a row, a
 * line and a card that keep to their formats.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */

#include "suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "cohort/report_head.h"
#include "cohort/summary_cases.h"
#include "unit/oracle.h"

enum { DAMAGED = 20000, ROOM = 4096 };

static const char good[] =
    "{\n  \"version\": \"%s\",\n  \"verdict\": \"look\",\n  \"reasons\": [\n    \"2 folds, \\\"left\\\"\",\n    "
    "\"b\\n\"\n  ],\n"
    "  \"expected_error_mm\": 0.5,\n  \"exit_status\": 3,\n  \"command\": [\"smr\", {\"a\": [1, null, true]}],\n"
    "  \"iterations\": 151,\n  \"time_s\": {\"load\": 0.1, \"total\": 1.25},\n"
    "  \"distance_mm\": {\"model_to_target\": {\"mean\": 0.1, \"rms\": 0.2, \"p95\": 0.3, \"max\": 0.4},\n"
    "    \"target_to_model\": null},\n  \"hausdorff_mm\": 0.4,\n  \"folds\": 2,\n  \"state_hash\": "
    "\"0123456789abcdef\",\n"
    "  \"per_structure\": [{\"name\": \"femur\", \"verdict\": \"good\", \"expected_error_mm\": 9},\n"
    "    {\"name\": \"tibia\", \"verdict\": \"look\", \"expected_error_mm\": null},\n"
    "    {\"name\": \"a<b>&\", \"verdict\": \"look\", \"expected_error_mm\": 0.75}]\n}\n";

static size_t make(char *text) { return (size_t)snprintf(text, ROOM, good, host_report_version()); }

/* Parses a copy of exactly n bytes, so that a sanitizer sees every step beyond. */
static int parse(const char *text, size_t n, host_report_head *head, host_error *error)
{
    char *const copy = malloc(n + (n == 0));
    assert_non_null(copy);
    memcpy(copy, text, n);
    memset(error, 0, sizeof *error);
    int result = host_report_parse(copy, n, head, error);
    free(copy);
    return result;
}

TEST(a_report_is_read)
{
    char text[ROOM];
    const size_t n = make(text);
    host_report_head head;
    host_error error;
    assert_int_equal(parse(text, n, &head, &error), 0);
    assert_int_equal(head.verdict.level, HOST_VERDICT_LOOK);
    assert_int_equal(head.verdict.n_reasons, 2);
    assert_string_equal(head.verdict.reason[0], "2 folds, \"left\"");
    assert_true(head.verdict.expected_error_mm == 0.5 && head.hausdorff_mm == 0.4 && head.seconds == 1.25);
    assert_true(head.to.n == 1 && head.to.mean == 0.1 && head.to.max == 0.4 && head.from.n == 0);
    assert_true(head.exit_status == 3 && head.iterations == 151 && head.folds == 2 && head.n_parts == 3);
    assert_string_equal(host_report_worst(&head)->name, "a<b>&");
    host_report_free(&head);
    assert_null(host_report_worst(&head));
}

/* Replaces the first `from` of the good report. */
static size_t changed(char *text, const char *from, const char *to)
{
    char whole[ROOM];
    (void)make(whole);
    char *at = strstr(whole, from);
    assert_non_null(at);
    return (size_t)snprintf(text, ROOM, "%.*s%s%s", (int)(at - whole), whole, to, at + strlen(from));
}

TEST(others_are_refused)
{
    static const char *const change[][2] = {{"\"version\": \"", "\"version\": \"9"},
                                            {"\"verdict\": \"look\"", "\"verdict\": \"fine\""},
                                            {"\"verdict\": \"look\"", "\"verdict\": 1"},
                                            {"\"iterations\": 151", "\"iterations\": -1"},
                                            {"151", "1.5"},
                                            {"151", "1e300"},
                                            {"\"folds\": 2", "\"folds\": null"},
                                            {"\"exit_status\": 3", "\"exit_status\": 5"},
                                            {"\"folds\": 2", "\"fold\": 2"},
                                            {"\"folds\": 2,", "\"folds\": 2, \"folds\": 3,"},
                                            {"0.5", "1e999"},
                                            {"0.5", "nan"},
                                            {"\"name\": \"femur\",", ""},
                                            {"\"verdict\": \"good\"", "\"verdict\": \"best\""},
                                            {"\"per_structure\": [", "\"per_structure\": [1,"},
                                            {"]\n}\n", "]\n}\n}"},
                                            {"{\n", "[\n"},
                                            {"\\n", "\\x"}};
    char text[ROOM];
    host_report_head head;
    host_error error;
    size_t i = 0, n = 0;
    for (i = 0; i < sizeof change / sizeof change[0]; i++) {
        n = changed(text, change[i][0], change[i][1]);
        assert_int_equal(parse(text, n, &head, &error), -1);
        assert_true(error.place[0] != '\0' && error.expected[0] != '\0' && head.part == NULL && head.n_parts == 0);
    }
    n = make(text) - 3u; /* every one that is cut off before its closing brace */
    for (i = 0; i < n; i++)
        assert_int_equal(parse(text, i, &head, &error), -1);
}

/* Lists without end: reasons are dropped, structures refused; texts are cut. */
TEST(long_lists_end)
{
    host_buffer text = {NULL, 0, 0, 0};
    host_report_head head;
    host_error error;
    char start[ROOM];
    (void)changed(start, "\"b\\n\"", "");
    *strstr(start, "\n  ],") = '\0';
    host_buffer_print(&text, "%s \"%0999d\"", start, 7);
    for (uint32_t i = 0; i < 100; i++)
        host_buffer_print(&text, ", \"reason\"");
    (void)make(start);
    host_buffer_print(&text, "%s", strstr(start, "\n  ],"));
    assert_int_equal(parse((const char *)text.data, text.size, &head, &error), 0);
    assert_int_equal(head.verdict.n_reasons, HOST_REASONS_MAX);
    assert_int_equal(strlen(head.verdict.reason[1]), HOST_REASON_BYTES - 1u);
    host_report_free(&head);
    text.size -= 4;
    for (uint32_t i = 0; i < SMR_STRUCTURES_MAX; i++)
        host_buffer_print(&text, ", {\"name\": \"x\", \"verdict\": \"good\"}");
    host_buffer_print(&text, "]}");
    assert_int_equal(parse((const char *)text.data, text.size, &head, &error), -1);
    host_buffer_free(&text);
}

static size_t count(const host_buffer *b, char c)
{
    size_t i = 0, n = 0;
    for (i = 0; i < b->size; i++)
        n += b->data[i] == (unsigned char)c;
    return n;
}

/* A table of one row has two lines, quotes in pairs, and commas between its columns alone. */
static void check_table(const host_cases *cases)
{
    host_buffer out = {NULL, 0, 0, 0};
    size_t i = 0, commas = 0;
    int quoted = 0;
    host_summary_table(cases, 1, &out);
    assert_false(out.failed);
    assert_int_equal(count(&out, '\n'), 2);
    assert_int_equal(count(&out, '"') % 2u, 0);
    for (i = 0; i < out.size; i++) {
        quoted ^= out.data[i] == '"';
        commas += out.data[i] == ',' && !quoted;
        assert_true(out.data[i] == '\n' || (out.data[i] >= 32 && out.data[i] != 127));
    }
    assert_int_equal(commas, 2u * 12u);
    host_buffer_free(&out);
}

static void check_line_and_page(const host_cases *cases)
{
    const host_cases none = {0};
    host_buffer out = {NULL, 0, 0, 0};
    host_report_line(&cases->one[0].head, cases->one[0].path, 0, &out);
    assert_int_equal(count(&out, '\n'), 1);
    assert_int_equal(out.data[out.size - 1u], '\n');
    out.size = 0;
    assert_int_equal(host_summary_page(&none, "page.html", &out), 0);
    const size_t tags = count(&out, '<'); /* of the page without data */
    out.size = 0;
    assert_int_equal(host_summary_page(cases, "page.html", &out), 0);
    assert_false(out.failed);
    assert_int_equal(count(&out, '<'), tags);
    host_buffer_free(&out);
}

static size_t damage(char *text, size_t n, oracle_random *r)
{
    const uint32_t times = 1u + oracle_next(r) % 4u;
    for (uint32_t i = 0; i < times; i++) {
        const size_t at = oracle_next(r) % n;
        switch (oracle_next(r) % 4u) {
        case 0: text[at] = (char)(unsigned char)(oracle_next(r) & 255u); break;
        case 1: text[at] = "\"{}[],:\\09-.en"[oracle_next(r) % 14u]; break;
        case 2: memmove(text + at, text + at + 1, n - at - 1u); break;
        default: text[at] = text[oracle_next(r) % n]; break;
        }
    }
    return oracle_next(r) % 8u == 0 ? oracle_next(r) % n : n;
}

TEST(damaged_reports_do_no_harm)
{
    char path[] = "no \"such\", \xff<dir>&";
    oracle_random r = oracle_seed(5);
    host_case one;
    host_cases cases = {&one, 1, 0};
    int i = 0, read = 0;
    memset(&one, 0, sizeof one);
    one.path = path;
    for (i = 0; i < DAMAGED; i++) {
        char text[ROOM];
        const size_t n = make(text);
        host_error error;
        if (parse(text, damage(text, n, &r), &one.head, &error) != 0)
            continue;
        read++;
        assert_in_range(one.head.verdict.level, HOST_VERDICT_GOOD, HOST_VERDICT_FAILED);
        assert_true(one.head.exit_status >= -1 && one.head.exit_status <= 4);
        check_table(&cases);
        if (read % 16 == 0)
            check_line_and_page(&cases);
        host_report_free(&one.head);
    }
    assert_true(read > DAMAGED / 50 && read < DAMAGED);
}

typedef struct directory {
    char path[64], input[80], result[80], report[80];
    char *arguments[2];
    host_options options;
} directory;

static void write_bytes(const char *path, const char *bytes, size_t n)
{
    FILE *const f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
}

/* A directory with one result of one input, both of the text "123456789". Returns its report's length. */
static size_t make_done(directory *d, char *text)
{
    static char out[] = "-o";
    char *at = NULL, tail[ROOM];
    (void)make(text);
    at = strstr(text, "\"command\"");
    (void)snprintf(tail, sizeof tail, "%s", strchr(at, '\n'));
    (void)snprintf(d->input, sizeof d->input, "%s/input", d->path);
    (void)snprintf(d->result, sizeof d->result, "%s/result", d->path);
    (void)snprintf(d->report, sizeof d->report, "%s/report.json", d->path);
    write_bytes(d->input, "123456789", 9);
    write_bytes(d->result, "123456789", 9);
    d->arguments[0] = out;
    d->arguments[1] = d->path;
    d->options.out = d->path;
    d->options.arguments = d->arguments;
    d->options.n_arguments = 2;
    return (size_t)(at - text) +
           (size_t)snprintf(at, ROOM - (size_t)(at - text),
                            "\"command\": [\"smr\", \"register\", \"--threads\", \"2\", \"-o\", \"%s\", \"--json\"],\n"
                            "\"inputs\": [{\"path\": \"%s\", \"bytes\": 9, \"crc32\": \"cbf43926\"}],\n"
                            "\"results\": [{\"file\": \"result\", \"bytes\": 9, \"crc32\": \"cbf43926\"}],%s",
                            d->path, d->input, tail);
}

static int is_done(const directory *d, const char *text, size_t n)
{
    host_report_head head;
    char why[HOST_WHY_BYTES];
    write_bytes(d->report, text, n);
    memset(why, 1, sizeof why);
    int done = host_report_done(&d->options, &head, why);
    assert_non_null(memchr(why, 0, sizeof why));
    assert_int_equal(done, why[0] == '\0');
    assert_int_equal(done, head.n_parts > 0);
    host_report_free(&head);
    return done;
}

/* Done is what names itself whole; what is damaged anywhere else is refused, or done. */
TEST(damaged_reports_are_done_or_not)
{
    char text[ROOM], dotted[80];
    oracle_random r = oracle_seed(6);
    directory d;
    int i = 0, done = 0;
    memset(&d, 0, sizeof d);
    (void)snprintf(d.path, sizeof d.path, "/tmp/report_head.XXXXXX");
    assert_non_null(mkdtemp(d.path));
    size_t n = make_done(&d, text);
    assert_true(is_done(&d, text, n));
    for (i = 0; i < 600; i++) {
        n = make_done(&d, text);
        done += is_done(&d, text, damage(text, n, &r));
    }
    assert_true(done < 300);
    n = make_done(&d, text);
    write_bytes(d.result, "12345678x", 9);
    assert_false(is_done(&d, text, n));
    n = make_done(&d, text);
    (void)snprintf(dotted, sizeof dotted, "%s/.esult", d.path); /* as "../..." begins */
    write_bytes(dotted, "123456789", 9);
    memcpy(strstr(text, "\"result\""), "\".esult\"", 8);
    assert_false(is_done(&d, text, n));
    assert_int_equal(remove(dotted), 0);
    n = make_done(&d, text);
    assert_int_equal(remove(d.input), 0);
    assert_false(is_done(&d, text, n));
    n = make_done(&d, text);
    d.options.n_arguments = 1;
    assert_false(is_done(&d, text, n));
    (void)remove(d.input);
    (void)remove(d.result);
    (void)remove(d.report);
    (void)remove(d.path);
}

TEST(order_is_natural)
{
    static const char *const sorted[] = {
        "",  "a",   "a/1", "a/2", "a/02b", "a/10", "a1", "a9999999999999999999999", "a10000000000000000000000",
        "b", "b01", "b1",  "b1c", "c"};
    const size_t n = sizeof sorted / sizeof sorted[0];
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++)
            assert_int_equal(host_natural_order(sorted[i], sorted[k]), (i > k) - (i < k));
}
