/* points_file.c: reads and writes sets of points. Texts have nine significant digits, so that reading gives the same
 * floats.
 * SPDX-License-Identifier: MIT */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "landmarks/landmarks.h"

/* Room for the orientations of so many points; what is new are the axes of LPS. */
static int grow_orientations(host_points *points, uint32_t wanted)
{
    static const float axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    float(*const more)[9] = realloc(points->orientation, wanted * sizeof *more);
    uint32_t i = points->orientation != NULL ? points->capacity : 0;
    if (more == NULL)
        return -1;
    points->orientation = more;
    for (; i < wanted; i++)
        memcpy(more[i], axes, sizeof axes);
    return 0;
}

int host_points_orient(host_points *points, const float orientation[9])
{
    if (points->orientation == NULL && grow_orientations(points, points->capacity) != 0)
        return -1;
    memcpy(points->orientation[points->n - 1u], orientation, sizeof points->orientation[0]);
    return 0;
}

void host_points_unorient(host_points *points)
{
    free(points->orientation);
    points->orientation = NULL;
}

int host_points_add(host_points *points, const char *label, size_t label_bytes, const float xyz[3])
{
    if (points->n == points->capacity) {
        const uint32_t wanted = points->capacity < 64u ? 64u : points->capacity * 2u;
        void *const more = realloc(points->xyz, wanted * sizeof *points->xyz);
        if (more == NULL)
            return -1;
        points->xyz = more;
        void *named = realloc(points->label, wanted * sizeof *points->label);
        if (named == NULL || wanted > SMR_VERTICES_MAX)
            return -1;
        points->label = named;
        if (points->orientation != NULL && grow_orientations(points, wanted) != 0)
            return -1;
        points->capacity = wanted;
    }
    memset(points->label[points->n], 0, sizeof points->label[0]);
    memcpy(points->label[points->n], label, label_bytes < HOST_LABEL_BYTES ? label_bytes : HOST_LABEL_BYTES - 1u);
    memcpy(points->xyz[points->n++], xyz, sizeof points->xyz[0]);
    return 0;
}

static int read_surface(const char *path, host_points *points, host_error *error)
{
    if (host_mesh_read(path, HOST_MESH_POINTS_TOO, HOST_MIRROR_NONE, &points->mesh, error) != 0)
        return -1;
    points->n = points->mesh.n_vertices;
    points->xyz = malloc((points->n + 1u) * sizeof *points->xyz);
    if (points->xyz == NULL)
        return host_fail(error, "points", "free memory");
    memcpy(points->xyz, points->mesh.xyz, points->n * sizeof *points->xyz);
    return 0;
}

static int accept_text(const host_head *head, host_error *error)
{
    if (memchr(head->data, '\0', head->n) != NULL)
        return host_fail(error, "content", "points: Slicer .mrk.json or .fcsv, CSV label,x,y,z, or a surface file");
    return 0;
}

static int read_labelled(const char *path, host_points *points, host_error *error)
{
    host_landmarks *const set = calloc(1, sizeof *set);
    host_bytes bytes;
    if (set == NULL)
        return host_fail(error, "points", "free memory");
    set->points = points;
    if (host_file_read(path, accept_text, &bytes, error) != 0) {
        free(set);
        return -1;
    }
    int result = host_landmarks_scan(set, path, &bytes, error);
    if (result == 0 && points->n == 0)
        result = host_fail(error, "points", "at least one point");
    host_file_free(&bytes);
    free(set);
    return result;
}

int host_points_read(const char *path, host_points *points, host_error *error)
{
    memset(points, 0, sizeof *points);
    error->file = path;
    int result = host_file_kind(path) == HOST_KIND_SURFACE ? read_surface(path, points, error)
                                                           : read_labelled(path, points, error);
    if (result != 0)
        host_points_free(points);
    return result;
}

int host_points_can_write(const char *path, host_error *error)
{
    error->file = path;
    if (!host_is_packed_name(path) && (host_has_extension(path, ".json") || host_has_extension(path, ".fcsv") ||
                                       host_has_extension(path, ".csv") || host_format_of(path) >= 0))
        return 0;
    return host_fail(error, "name", "an output that ends in .mrk.json, .fcsv, .csv, .ply, .stl, .vtk or .obj");
}

int host_points_fit(const host_points *points, const char *path, host_error *error)
{
    error->file = path;
    if (host_format_of(path) == HOST_FORMAT_STL && points->mesh.n_triangles == 0)
        return host_fail(error, "name", "another format than STL, which has triangles only, and these are points");
    return 0;
}

static const char *label_of(const host_points *p, uint32_t i) { return p->label != NULL ? p->label[i] : ""; }

void host_points_put_name(const host_points *points, uint32_t i, const char *tail, host_buffer *out)
{
    char number[16];
    (void)snprintf(number, sizeof number, "%u", i + 1u);
    host_csv_text(out, *label_of(points, i) != '\0' ? label_of(points, i) : number, tail);
}

/* A label within quotes; without one the point's number. */
static void put_csv_label(const host_points *points, uint32_t i, host_buffer *out)
{
    const char *c = label_of(points, i);
    if (*c == '\0') {
        host_buffer_print(out, "%u", i + 1u);
        return;
    }
    host_buffer_add(out, "\"", 1);
    for (; *c != '\0'; c++)
        host_buffer_add(out, *c == '"' ? "\"\"" : c, *c == '"' ? 2 : 1);
    host_buffer_add(out, "\"", 1);
}

/* JSON holds UTF-8 alone: any other byte becomes '?'. */
static void put_json_label(const host_points *points, uint32_t i, host_buffer *out)
{
    const char *c = label_of(points, i);
    size_t n = 0;
    if (*c == '\0')
        host_buffer_print(out, "%u", i + 1u);
    for (; *c != '\0'; c += n > 0 ? n : 1u) {
        n = host_utf8_bytes(c);
        if (*c == '"' || *c == '\\')
            host_buffer_add(out, "\\", 1);
        if ((unsigned char)*c < 0x20u || *c == 0x7f)
            host_buffer_print(out, "\\u%04x", (unsigned)(unsigned char)*c);
        else
            host_buffer_add(out, n > 0 ? c : "?", n > 0 ? n : 1u);
    }
}

static void put_json(const host_points *points, host_buffer *out)
{
    host_buffer_print(out, "{\n \"@schema\": "
                           "\"https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/"
                           "Resources/Schema/markups-schema-v1.0.3.json#\",\n \"markups\": [\n  {\n   \"type\": "
                           "\"Fiducial\",\n   \"coordinateSystem\": \"LPS\",\n   \"coordinateUnits\": \"mm\",\n"
                           "   \"controlPoints\": [\n");
    for (uint32_t i = 0; i < points->n; i++) {
        const float *const p = points->xyz[i];
        host_buffer_print(out, "    { \"id\": \"%u\", \"label\": \"", i + 1u);
        put_json_label(points, i, out);
        host_buffer_print(out, "\", \"position\": [%.9g, %.9g, %.9g], ", (double)p[0], (double)p[1], (double)p[2]);
        for (uint32_t k = 0; points->orientation != NULL && k < 9u; k++)
            host_buffer_print(out, "%s%.9g%s", k == 0 ? "\"orientation\": [" : "", (double)points->orientation[i][k],
                              k < 8u ? ", " : "], ");
        host_buffer_print(out, "\"positionStatus\": \"defined\" }%s\n", i + 1u < points->n ? "," : "");
    }
    host_buffer_print(out, "   ]\n  }\n ]\n}\n");
}

static void put_table(const host_points *points, int fcsv, host_buffer *out)
{
    if (fcsv)
        host_buffer_print(out, "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
                               "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n");
    else
        host_buffer_print(out, "label,x,y,z\n");
    for (uint32_t i = 0; i < points->n; i++) {
        const float *const p = points->xyz[i];
        if (fcsv)
            host_buffer_print(out, "%u", i + 1u);
        else
            put_csv_label(points, i, out);
        host_buffer_print(out, ",%.9g,%.9g,%.9g", (double)p[0], (double)p[1], (double)p[2]);
        if (fcsv) {
            host_buffer_print(out, ",0,0,0,1,1,1,0,");
            put_csv_label(points, i, out);
            host_buffer_print(out, ",,");
        }
        host_buffer_print(out, "\n");
    }
}

void host_points_write(const host_points *points, const char *path, host_buffer *out)
{
    host_mesh mesh = points->mesh;
    if (host_has_extension(path, ".json")) {
        put_json(points, out);
    } else if (host_format_of(path) >= 0) {
        mesh.xyz = points->xyz[0];
        mesh.n_vertices = points->n;
        host_mesh_write(&mesh, host_format_of(path), out);
    } else {
        put_table(points, host_has_extension(path, ".fcsv"), out);
    }
}

void host_points_free(host_points *points)
{
    host_mesh_free(&points->mesh);
    free(points->xyz);
    free(points->label);
    free(points->orientation);
    memset(points, 0, sizeof *points);
}
