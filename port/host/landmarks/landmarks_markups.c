/* landmarks_markups.c: reads 3D Slicer markups (.mrk.json): the control points of every markup in the file.
 * SPDX-License-Identifier: MIT */
#include <string.h>
#include "landmarks/json_scan.h"
#include "landmarks/landmarks.h"

#define MILLIMETRES "coordinateUnits \"mm\" or [\"mm\", \"UCUM\", ...]"

typedef struct markup {
    host_landmarks *landmarks;
    char system[16];
    uint32_t system_line; /* 0: no coordinate system was read */
    /* the control point being read */
    char label[HOST_LABEL_BYTES];
    size_t label_bytes;
    double xyz[3];
    int n_xyz;
    float orientation[9];
    int n_orientation;
    int undefined; /* 1: the point has no position */
} markup;

static int read_coordinate(host_scan *scan, void *context)
{
    markup *const m = context;
    double value = 0.0;
    if (host_scan_number(scan, &value) != 0)
        return -1;
    if (m->n_xyz < 3)
        m->xyz[m->n_xyz] = value;
    m->n_xyz++;
    return m->n_xyz <= 3 ? 0 : host_scan_fail(scan, "three coordinates");
}

static int read_axis_number(host_scan *scan, void *context)
{
    markup *const m = context;
    double value = 0.0;
    if (host_scan_number(scan, &value) != 0)
        return -1;
    if (m->n_orientation == 9 || !(value >= -1.001 && value <= 1.001))
        return host_scan_fail(scan, "an orientation of nine numbers from -1 to 1");
    m->orientation[m->n_orientation++] = (float)value;
    return 0;
}

/* Slicer writes null or "" for a point that was not placed. */
static int skip_no_position(host_scan *scan)
{
    const char c = host_scan_peek(scan);
    char text[2];
    size_t n = 0;
    if (c == 'n')
        return host_scan_skip(scan);
    if (c != '"')
        return host_scan_fail(scan, "a list in brackets");
    if (host_scan_text(scan, text, sizeof text, &n) != 0)
        return -1;
    return n == 0 ? 0 : host_scan_fail(scan, "a position of three numbers");
}

static int read_point_member(host_scan *scan, const char *key, void *context)
{
    markup *const m = context;
    char status[16];
    size_t n = 0;
    if (strcmp(key, "label") == 0)
        return host_scan_text(scan, m->label, sizeof m->label, &m->label_bytes);
    if (strcmp(key, "position") == 0) {
        m->n_xyz = 0;
        return host_scan_peek(scan) == '[' ? host_scan_list(scan, read_coordinate, m) : skip_no_position(scan);
    }
    if (strcmp(key, "orientation") == 0 && m->landmarks->points != NULL && host_scan_peek(scan) == '[') {
        m->n_orientation = 0;
        return host_scan_list(scan, read_axis_number, m);
    }
    if (strcmp(key, "positionStatus") == 0) {
        if (host_scan_text(scan, status, sizeof status, &n) != 0)
            return -1;
        m->undefined = strcmp(status, "undefined") == 0 || strcmp(status, "preview") == 0;
        return m->undefined || strcmp(status, "defined") == 0
                   ? 0
                   : host_scan_fail(scan, "positionStatus \"defined\", \"undefined\" or \"preview\"");
    }
    return host_scan_skip(scan);
}

static int read_point(host_scan *scan, void *context)
{
    markup *const m = context;
    (void)host_scan_peek(scan);
    const uint32_t line = scan->text.line;
    m->label_bytes = 0;
    m->n_xyz = m->n_orientation = m->undefined = 0;
    if (host_scan_object(scan, read_point_member, m) != 0)
        return -1;
    if (m->undefined)
        return 0;
    if (m->n_xyz != 3)
        return host_fail_at(scan->error, "line", line, "a control point with a position of three numbers");
    if (host_landmarks_add(m->landmarks, scan->error, line, (host_word){m->label, m->label_bytes}, m->xyz) != 0)
        return -1;
    if (m->n_orientation != 0 && m->n_orientation != 9)
        return host_fail_at(scan->error, "line", line, "an orientation of nine numbers");
    if (m->n_orientation == 9 && host_points_orient(m->landmarks->points, m->orientation) != 0)
        return host_fail_at(scan->error, "line", line, "free memory");
    return 0;
}

static int read_unit(host_scan *scan, void *context)
{
    static const char *const words[] = {"mm", "UCUM"};
    int *const at = context;
    char text[16];
    size_t n = 0;
    if (host_scan_text(scan, text, sizeof text, &n) != 0)
        return -1;
    return *at >= 2 || strcmp(text, words[(*at)++]) == 0 ? 0 : host_scan_fail(scan, MILLIMETRES);
}

/* Reads "mm" or, as a coded word with its scheme and meaning, ["mm", "UCUM", "millimeter"]. */
static int read_units(host_scan *scan)
{
    int n = 0;
    const char c = host_scan_peek(scan);
    if (c == '"')
        return read_unit(scan, &n);
    if (c != '[')
        return host_scan_fail(scan, MILLIMETRES);
    if (host_scan_list(scan, read_unit, &n) != 0)
        return -1;
    return n > 0 ? 0 : host_scan_fail(scan, MILLIMETRES);
}

static int read_markup_member(host_scan *scan, const char *key, void *context)
{
    markup *const m = context;
    size_t n = 0;
    if (strcmp(key, "controlPoints") == 0)
        return host_scan_list(scan, read_point, m);
    if (strcmp(key, "coordinateSystem") == 0) {
        if (host_scan_text(scan, m->system, sizeof m->system, &n) != 0)
            return -1;
        m->system_line = scan->text.line;
        return 0;
    }
    if (strcmp(key, "coordinateUnits") == 0)
        return read_units(scan);
    return host_scan_skip(scan);
}

/* Turns the points at the end of the markup, since the coordinate system may follow them. */
static int read_markup(host_scan *in, void *context)
{
    markup m = {0};
    m.landmarks = context;
    uint32_t first = m.landmarks->n;
    if (host_scan_object(in, read_markup_member, &m) != 0)
        return -1;
    if (m.system_line == 0)
        return host_scan_fail(in, "coordinateSystem \"LPS\" or \"RAS\" in the markup that ends here");
    return host_landmarks_to_lps(m.landmarks, in->error, m.system_line, (host_word){m.system, strlen(m.system)}, first);
}

static int read_top(host_scan *scan, const char *key, void *context)
{
    return strcmp(key, "markups") == 0 ? host_scan_list(scan, read_markup, context) : host_scan_skip(scan);
}

int host_read_markups(host_landmarks *landmarks, const char *data, size_t n, host_error *error)
{
    host_scan scan = {host_text_over(data, n), error, 0};
    return host_scan_object(&scan, read_top, landmarks) != 0 ? -1 : host_scan_end(&scan);
}
