/* landmarks_table.c: reads landmarks from comma-separated lines: 3D Slicer's .fcsv and plain CSV.
 *
 * .fcsv: "# CoordinateSystem = ..." is required; "# columns = ..." names the columns.
 * CSV: label,x,y,z in LPS, with or without a header line; the same comments are understood.
 * SPDX-License-Identifier: MIT */
#include <string.h>

#include "landmarks/landmarks_reader.h"

#define FIELDS_MAX 32u

typedef struct table {
    host_landmarks *landmarks;
    host_error *error;
    int fcsv;
    size_t label, x, y, z; /* columns */
    host_word system;      /* n 0: no coordinate system was read */
    uint32_t system_line, line;
    int rows;
} table;

/* Splits at commas outside quotes; keeps the quotes around a field. Returns the number of fields. */
static size_t split(host_word line, host_word *fields)
{
    const char *const end = line.start + line.n;
    const char *start = line.start, *p = line.start;
    size_t n = 0;
    int quoted = 0;
    for (; n < FIELDS_MAX; p++) {
        if (p < end && *p == '"')
            quoted = !quoted;
        if (p < end && (quoted || *p != ','))
            continue;
        fields[n++] = host_word_trimmed(start, p);
        start = p + 1;
        if (p >= end)
            break;
    }
    return n;
}

/* Copies a field's text without its quotes; a doubled quote gives one. -1 when too long or wrongly quoted. */
static int unquote(const table *t, host_word field, char *to, host_word *label)
{
    size_t i = 0, n = 0, last = field.n;
    if (field.n > 0 && field.start[0] == '"') {
        if (field.n < 2u || field.start[field.n - 1u] != '"')
            return host_fail_at(t->error, "line", t->line, "a quote at the label's end");
        i = 1;
        last = field.n - 1u;
    }
    for (; i < last; i++) {
        if (last < field.n && field.start[i] == '"' && (++i >= last || field.start[i] != '"'))
            return host_fail_at(t->error, "line", t->line, "two quotes for one within a label");
        if (n < HOST_LABEL_BYTES)
            to[n] = field.start[i];
        n++;
    }
    label->start = to;
    label->n = n;
    return 0;
}

/* Reads the value of a comment "# key = value". 1 when the comment has this key. */
static int comment_is(host_word line, const char *key, host_word *value)
{
    const char *const sign = memchr(line.start, '=', line.n);
    if (sign == NULL || !host_word_is_nocase(host_word_trimmed(line.start, sign), key))
        return 0;
    *value = host_word_trimmed(sign + 1, line.start + line.n);
    return 1;
}

static int read_columns(table *t, host_word value)
{
    host_word fields[FIELDS_MAX];
    const size_t n = split(value, fields);
    size_t i = 0;
    t->label = t->x = t->y = t->z = FIELDS_MAX;
    for (i = 0; i < n; i++)
        if (host_word_is_nocase(fields[i], "label"))
            t->label = i;
        else if (host_word_is_nocase(fields[i], "x"))
            t->x = i;
        else if (host_word_is_nocase(fields[i], "y"))
            t->y = i;
        else if (host_word_is_nocase(fields[i], "z"))
            t->z = i;
    if (t->label == FIELDS_MAX || t->x == FIELDS_MAX || t->y == FIELDS_MAX || t->z == FIELDS_MAX)
        return host_fail_at(t->error, "line", t->line, "columns with label, x, y and z");
    return 0;
}

/* The default columns of the two formats. */
static void set_columns(table *t, int fcsv)
{
    t->fcsv = fcsv;
    t->label = fcsv ? 11 : 0;
    t->x = 1;
    t->y = 2;
    t->z = 3;
}

static int read_comment(table *t, host_word line)
{
    const host_word rest = host_word_trimmed(line.start + 1, line.start + line.n);
    host_word value;
    if (host_word_has(rest, "Markups fiducial file") && t->rows == 0) {
        set_columns(t, 1);
    } else if (comment_is(rest, "CoordinateSystem", &value)) {
        if (t->system_line != 0)
            return host_fail_at(t->error, "line", t->line, "one CoordinateSystem, found a second");
        t->system = value;
        t->system_line = t->line;
    } else if (comment_is(rest, "columns", &value)) {
        return read_columns(t, value);
    }
    return 0;
}

/* The highest column in use. */
static size_t last_column(const table *t)
{
    const size_t a = t->label > t->x ? t->label : t->x, b = t->y > t->z ? t->y : t->z;
    return a > b ? a : b;
}

static int read_row(table *t, host_word line)
{
    host_word fields[FIELDS_MAX], label;
    char text[HOST_LABEL_BYTES];
    double xyz[3] = {0};
    const size_t n = split(line, fields);
    const size_t columns[3] = {t->x, t->y, t->z};
    int good = 0, i = 0;
    if (n <= last_column(t) || (!t->fcsv && n != 4u))
        return host_fail_at(t->error, "line", t->line, "%s, found %zu fields%s",
                            t->fcsv ? "a field for every column" : "label,x,y,z", n,
                            t->fcsv ? "" : " (a label with commas needs quotes)");
    for (i = 0; i < 3; i++)
        good += host_word_double(fields[columns[i]], &xyz[i]);
    if (good == 0 && t->rows == 0 && !t->fcsv) { /* a header line */
        t->rows++;
        return 0;
    }
    if (good < 3)
        return host_fail_at(t->error, "line", t->line, "three numbers for x, y and z");
    t->rows++;
    if (unquote(t, fields[t->label], text, &label) != 0)
        return -1;
    return host_landmarks_add(t->landmarks, t->error, t->line, label, xyz);
}

int host_read_landmark_table(host_landmarks *landmarks, const char *data, size_t n, int slicer, host_error *error)
{
    table t;
    host_text text = host_text_over(data, n);
    host_word line;
    memset(&t, 0, sizeof t);
    t.landmarks = landmarks;
    t.error = error;
    set_columns(&t, slicer);
    for (t.line = text.line; host_text_line(&text, &line); t.line = text.line) {
        const host_word inner = host_word_trimmed(line.start, line.start + line.n);
        if (inner.n == 0)
            continue;
        if (inner.start[0] == '#' ? read_comment(&t, inner) != 0 : read_row(&t, inner) != 0)
            return -1;
    }
    if (t.system_line == 0)
        return t.fcsv ? host_fail(error, "header", "a line # CoordinateSystem = LPS or RAS") : 0;
    return host_landmarks_to_lps(landmarks, error, t.system_line, t.system, 0);
}
