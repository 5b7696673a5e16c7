/* landmarks_table.c: reads landmarks from comma-separated lines: 3D Slicer's .fcsv and plain CSV.
 *
 * .fcsv: "# CoordinateSystem = ..." is required; "# columns = ..." names the columns. Slicer writes 14 of them, and
 * newer ones two fields more: the status of the position and a flag.
 * CSV: label,x,y,z in LPS, or a header line of these names, of label,R,A,S or of label,L,P,S, in any order; the same
 * comments are understood.
 * SPDX-License-Identifier: MIT */
#include <string.h>

#include "landmarks/landmarks_reader.h"

#define FIELDS_MAX 32u
#define SLICER_FIELDS 14u /* of a row in .fcsv */
#define DEFINED "2"       /* the status of a point with a position */

typedef struct table {
    host_landmarks *landmarks;
    host_error *error;
    int fcsv;
    size_t label, axis[3], n_columns; /* the columns of the label and of x, y, z; fields of a row */
    int named;                        /* 1: the file names the columns */
    const char *named_system;         /* that the columns' names say; NULL: none */
    host_word system;
    uint32_t system_line, line; /* system_line 0: no coordinate system was read */
    int rows, header;           /* rows with landmarks; 1: a header line was read */
} table;

/* Splits at commas outside quotes; keeps the quotes around a field. Returns the number of fields, of which the first
 * FIELDS_MAX are stored. */
static size_t split(host_word line, host_word *fields)
{
    const char *const end = line.start + line.n;
    const char *start = line.start, *p = line.start;
    size_t n = 0;
    int quoted = 0;
    for (;; p++) {
        if (p < end && *p == '"')
            quoted = !quoted;
        if (p < end && (quoted || *p != ','))
            continue;
        if (n < FIELDS_MAX)
            fields[n] = host_word_trimmed(start, p);
        n++;
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

/* The text within a field's quotes. */
static host_word within_quotes(host_word field)
{
    if (field.n >= 2u && field.start[0] == '"' && field.start[field.n - 1u] == '"') {
        field.start++;
        field.n -= 2u;
    }
    return field;
}

/* The only column of this name, FIELDS_MAX when there is none or more than one. */
static size_t column_of(const host_word *fields, size_t n, const char *name)
{
    size_t found = FIELDS_MAX, i = 0;
    for (i = 0; i < n; i++)
        if (host_word_is_nocase(within_quotes(fields[i]), name)) {
            if (found != FIELDS_MAX)
                return FIELDS_MAX;
            found = i;
        }
    return found;
}

/* Takes the columns from their names. Returns 1, or 0 when a name is missing, twice or, in CSV, not known. */
static int take_names(table *t, const host_word *fields, size_t n)
{
    static const struct {
        const char *axis[3], *system;
    } sets[] = {{{"x", "y", "z"}, NULL}, {{"R", "A", "S"}, "RAS"}, {{"L", "P", "S"}, "LPS"}};
    size_t i = 0, k = 0;
    t->label = column_of(fields, n, "label");
    if (t->label == FIELDS_MAX || (!t->fcsv && n != 4u))
        return 0;
    for (i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        for (k = 0; k < 3u; k++) {
            t->axis[k] = column_of(fields, n, sets[i].axis[k]);
            if (t->axis[k] == FIELDS_MAX)
                break;
        }
        if (k < 3u)
            continue;
        t->named_system = sets[i].system;
        t->n_columns = n;
        t->named = 1;
        return 1;
    }
    return 0;
}

/* Reads the names of the columns, in a comment or a header line. */
static int read_columns(table *t, host_word line)
{
    host_word fields[FIELDS_MAX];
    const size_t n = split(line, fields);
    const table before = *t;
    if (t->rows > 0)
        return host_fail_at(t->error, "line", t->line, "the columns' names before the first landmark");
    if (n > FIELDS_MAX || !take_names(t, fields, n))
        return host_fail_at(t->error, "line", t->line, "columns label and x,y,z, R,A,S or L,P,S%s, found '%.*s'",
                            t->fcsv ? ", each once" : " and no others", (int)(line.n < 80u ? line.n : 80u), line.start);
    if (before.named && (before.label != t->label || memcmp(before.axis, t->axis, sizeof t->axis) != 0 ||
                         before.named_system != t->named_system))
        return host_fail_at(t->error, "line", t->line, "the columns that a line above names");
    return 0;
}

/* The default columns of the two formats. */
static void set_columns(table *t, int fcsv)
{
    t->fcsv = fcsv;
    t->label = fcsv ? 11 : 0;
    t->axis[0] = 1;
    t->axis[1] = 2;
    t->axis[2] = 3;
    t->n_columns = fcsv ? SLICER_FIELDS : 4u;
    t->named = 0;
    t->named_system = NULL;
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

/* 1 when the row has as many fields as there are columns, or Slicer's two more: status 0 to 2 and a flag. */
static int row_is_whole(const table *t, const host_word *fields, size_t n)
{
    int64_t status = 0, flag = 0;
    if (n == t->n_columns)
        return 1;
    return t->fcsv && t->n_columns == SLICER_FIELDS && n == SLICER_FIELDS + 2u &&
           host_word_int(fields[SLICER_FIELDS], &status) && status >= 0 && status <= 2 &&
           host_word_int(fields[SLICER_FIELDS + 1u], &flag) && flag >= 0 && flag <= 1;
}

/* 1 for a CSV file's first line without any number: the names of the columns. */
static int is_header(const table *t, const host_word *fields, size_t n)
{
    double value = 0.0;
    size_t i = 0;
    if (t->fcsv || t->rows > 0 || t->header)
        return 0;
    for (i = 0; i < n && i < FIELDS_MAX; i++)
        if (host_word_double(fields[i], &value))
            return 0;
    return 1;
}

static int read_row(table *t, host_word line)
{
    host_word fields[FIELDS_MAX], label;
    char text[HOST_LABEL_BYTES];
    double xyz[3] = {0};
    const size_t n = split(line, fields);
    size_t i = 0;
    if (is_header(t, fields, n)) {
        t->header = 1;
        return read_columns(t, line);
    }
    if (!row_is_whole(t, fields, n))
        return host_fail_at(t->error, "line", t->line, "%zu fields%s, found %zu (decimal point, commas in quotes)",
                            t->n_columns, t->fcsv ? " as there are columns" : ", such as label,x,y,z", n);
    t->rows++;
    if (n > t->n_columns && !host_word_is(fields[SLICER_FIELDS], DEFINED)) /* a point that was not placed */
        return 0;
    for (i = 0; i < 3u; i++)
        if (!host_word_double(fields[t->axis[i]], &xyz[i]))
            return host_fail_at(t->error, "line", t->line, "three numbers for x, y and z");
    if (unquote(t, fields[t->label], text, &label) != 0)
        return -1;
    return host_landmarks_add(t->landmarks, t->error, t->line, label, xyz);
}

/* Turns the landmarks into LPS as the comment or the columns' names say, which must not contradict each other. */
static int turn(const table *t)
{
    host_word system = t->system;
    if (t->named_system != NULL) {
        const int ras = t->named_system[0] == 'R';
        if (t->system_line != 0 && (host_word_is(system, "RAS") || host_word_is(system, "0")) != ras)
            return host_fail_at(t->error, "line", t->system_line, "CoordinateSystem = %s as the columns' names say",
                                t->named_system);
        if (t->system_line == 0) {
            system.start = t->named_system;
            system.n = 3;
        }
    } else if (t->system_line == 0) {
        return t->fcsv ? host_fail(t->error, "header", "a line # CoordinateSystem = LPS or RAS") : 0;
    }
    return host_landmarks_to_lps(t->landmarks, t->error, t->system_line, system, 0);
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
    return turn(&t);
}
