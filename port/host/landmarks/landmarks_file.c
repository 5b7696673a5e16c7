/* landmarks_file.c: reads landmarks: tables of Slicer and CSV, and what all formats share.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include "files/file_names.h"
#include "landmarks/landmarks.h"

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

/* Splits at commas outside quotes; keeps the quotes around a field. Returns how many; stores at most FIELDS_MAX. */
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
    size_t found = FIELDS_MAX;
    for (size_t i = 0; i < n; i++)
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
    size_t k = 0;
    t->label = column_of(fields, n, "label");
    if (t->label == FIELDS_MAX || (!t->fcsv && n != 4u))
        return 0;
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
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
    for (size_t i = 0; i < 3u; i++)
        t->axis[i] = i + 1u;
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
    if (t->fcsv || t->rows > 0 || t->header)
        return 0;
    for (size_t i = 0; i < n && i < FIELDS_MAX; i++)
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
    for (size_t i = 0; i < 3u; i++)
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
    table t = {.landmarks = landmarks, .error = error};
    host_text text = host_text_over(data, n);
    host_word line;
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

/* What a set of landmarks refuses of a label. */
static int check_label(const host_landmarks *landmarks, host_error *error, uint32_t line, host_word w)
{
    if (landmarks->n == HOST_LANDMARKS_MAX)
        return host_fail_at(error, "line", line, "at most %u landmarks", HOST_LANDMARKS_MAX);
    if (w.n == 0)
        return host_fail_at(error, "line", line, "a landmark with a label");
    if (w.n >= HOST_LABEL_BYTES)
        return host_fail_at(error, "line", line, "a label of at most %u bytes, found %zu", HOST_LABEL_BYTES - 1u, w.n);
    if (memchr(w.start, '\0', w.n) != NULL)
        return host_fail_at(error, "line", line, "a label without NUL");
    for (uint32_t i = 0; i < landmarks->n; i++)
        if (host_word_is(w, landmarks->label[i]))
            return host_fail_at(error, "line", line, "each label once, found a second \"%s\"", landmarks->label[i]);
    return 0;
}

int host_landmarks_add(host_landmarks *set, host_error *error, uint32_t line, host_word label, const double xyz[3])
{
    const int any = set->points != NULL; /* any number of points; the label may be empty or known */
    const double limit = (double)SMR_COORD_MAX;
    float at[3];
    if (any && (label.n >= HOST_LABEL_BYTES || (label.n > 0 && memchr(label.start, '\0', label.n) != NULL)))
        return host_fail_at(error, "line", line, "a label of at most %u bytes, without NUL", HOST_LABEL_BYTES - 1u);
    if (!any && check_label(set, error, line, label) != 0)
        return -1;
    for (uint32_t i = 0; i < 3; i++) {
        if (!(xyz[i] >= -limit && xyz[i] <= limit)) /* written so that NaN fails */
            return host_fail_at(error, "line", line, "finite coordinates within +-%.0f mm, found %g", limit, xyz[i]);
        at[i] = (float)xyz[i];
    }
    if (any && host_points_add(set->points, label.start, label.n, at) != 0)
        return host_fail_at(error, "line", line, "at most %u points, and free memory", SMR_VERTICES_MAX);
    if (!any) {
        memcpy(set->xyz[set->n], at, sizeof at);
        (void)snprintf(set->label[set->n], HOST_LABEL_BYTES, "%.*s", (int)label.n, label.start);
    }
    set->n++;
    return 0;
}

int host_landmarks_to_lps(host_landmarks *set, host_error *error, uint32_t line, host_word system, uint32_t first)
{
    float(*const xyz)[3] = set->points != NULL ? set->points->xyz : set->xyz;
    if (host_word_is(system, "LPS") || host_word_is(system, "1"))
        return 0;
    if (!host_word_is(system, "RAS") && !host_word_is(system, "0"))
        return host_fail_at(error, "line", line, "coordinate system LPS or RAS, found %.*s",
                            (int)(system.n < 32u ? system.n : 32u), system.start);
    for (uint32_t i = first; i < set->n; i++) {
        xyz[i][0] = 0.0f - xyz[i][0];
        xyz[i][1] = 0.0f - xyz[i][1];
        for (uint32_t k = 0; set->points != NULL && set->points->orientation != NULL && k < 6u; k++)
            set->points->orientation[i][k] = 0.0f - set->points->orientation[i][k];
    }
    return 0;
}

#define FILE_BYTES_MAX ((size_t)4u << 20) /* 64 landmarks take a few kilobytes */

/* Refuses files that are too large or binary before they are read whole. */
static int accept_small(const host_head *head, host_error *error)
{
    if (head->total > FILE_BYTES_MAX || memchr(head->data, '\0', head->n) != NULL)
        return host_fail(error, "content", "a small text file: Slicer .mrk.json or .fcsv, or CSV label,x,y,z");
    return 0;
}

int host_landmarks_scan(host_landmarks *landmarks, const char *path, const host_bytes *bytes, host_error *error)
{
    const char *data = (const char *)bytes->data;
    size_t n = bytes->size;
    host_word word;
    if (n >= 3u && memcmp(data, "\xef\xbb\xbf", 3) == 0) { /* the UTF-8 byte order mark */
        data += 3;
        n -= 3u;
    }
    host_text text = host_text_over(data, n);
    if (host_text_word(&text, &word) && word.start[0] == '{')
        return host_read_markups(landmarks, data, n, error);
    return host_read_landmark_table(landmarks, data, n, host_has_extension(path, ".fcsv"), error);
}

int host_landmarks_read(const char *path, host_landmarks *landmarks, host_error *error)
{
    host_bytes bytes;
    int result = 0;
    memset(landmarks, 0, sizeof *landmarks);
    if (host_file_read(path, accept_small, &bytes, error) != 0)
        return -1;
    result = host_landmarks_scan(landmarks, path, &bytes, error);
    if (result == 0 && landmarks->n == 0)
        result = host_fail(error, "landmarks", "at least one landmark (Slicer .mrk.json or .fcsv, or CSV label,x,y,z)");
    host_file_free(&bytes);
    if (result != 0)
        memset(landmarks, 0, sizeof *landmarks);
    return result;
}

/* Index of a label, n when it is missing. */
static uint32_t find(const host_landmarks *landmarks, const char *label)
{
    uint32_t i = 0;
    while (i < landmarks->n && strcmp(landmarks->label[i], label) != 0)
        i++;
    return i;
}

/* Checks that b has every label of a. */
static int all_in(const host_landmarks *a, const host_landmarks *b, const char *a_path, const char *b_path,
                  host_error *error)
{
    for (uint32_t i = 0; i < a->n; i++)
        if (find(b, a->label[i]) == b->n)
            return host_fail_of(error, b_path, "landmarks", "one labelled \"%s\" as in %s", a->label[i], a_path);
    return 0;
}

int host_landmarks_pair(const host_landmarks *model, const host_landmarks *target, const char *model_path,
                        const char *target_path, float from[HOST_LANDMARKS_MAX][3], float to[HOST_LANDMARKS_MAX][3],
                        uint32_t *n, host_error *error)
{
    *n = 0;
    if (all_in(model, target, model_path, target_path, error) != 0 ||
        all_in(target, model, target_path, model_path, error) != 0)
        return -1;
    for (uint32_t i = 0; i < model->n; i++) {
        memcpy(from[i], model->xyz[i], sizeof from[i]);
        memcpy(to[i], target->xyz[find(target, model->label[i])], sizeof to[i]);
    }
    *n = model->n;
    return 0;
}
