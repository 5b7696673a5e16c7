/* mesh_vtk.c: reads legacy VTK polydata ("VTK file formats", versions 1 to 5.1): geometry only, skips data arrays.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include "meshes/mesh_reader.h"

/* The type with this name ("float", "vtktypeint64", ...); HOST_TYPE_NONE when unknown. */
static host_type host_vtk_type(host_word word)
{
    static const struct {
        const char *name;
        host_type type;
    } names[] = {{"float", HOST_TYPE_F32},          {"double", HOST_TYPE_F64},        {"char", HOST_TYPE_I8},
                 {"signed_char", HOST_TYPE_I8},     {"unsigned_char", HOST_TYPE_U8},  {"short", HOST_TYPE_I16},
                 {"unsigned_short", HOST_TYPE_U16}, {"int", HOST_TYPE_I32},           {"unsigned_int", HOST_TYPE_U32},
                 {"vtktypeint32", HOST_TYPE_I32},   {"vtktypeint64", HOST_TYPE_I64},  {"vtkIdType", HOST_TYPE_I32},
                 {"long", HOST_TYPE_I64},           {"vtktypeint8", HOST_TYPE_I8},    {"vtktypeuint8", HOST_TYPE_U8},
                 {"vtktypeint16", HOST_TYPE_I16},   {"vtktypeuint32", HOST_TYPE_U32}, {"vtktypeuint16", HOST_TYPE_U16}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (host_word_is_nocase(word, names[i].name))
            return names[i].type;
    return HOST_TYPE_NONE;
}

/* Fills the error of the current line. Returns -1. */
static int host_vtk_fail(host_numbers *vtk, const char *expected)
{
    return host_fail_at(vtk->reader->error, "line", vtk->text.line, "%s", expected);
}

/* Text is not read to its end where it cannot hold the numbers. */
static int skip(host_numbers *vtk, host_type type, uint64_t n)
{
    return host_numbers_fit(vtk, type, n) ? host_numbers_skip(vtk, type, n) : host_reader_truncated(vtk->reader);
}

/* Reads the next word of the line as a count, 0 or more, that the file can hold. `what` names it in the error. */
static int host_vtk_count(host_numbers *vtk, const char *what, uint64_t *count)
{
    host_word word;
    int64_t value = 0;
    if (!host_text_word_in_line(&vtk->text, &word) || !host_word_int(word, &value) || value < 0)
        return host_fail_at(vtk->reader->error, "line", vtk->text.line, "%s of 0 or more", what);
    if ((uint64_t)value > (uint64_t)(vtk->text.end - vtk->text.at) + 1u)
        return host_fail_at(vtk->reader->error, "line", vtk->text.line, "%s the file can hold, found %lld", what,
                            (long long)value);
    *count = (uint64_t)value;
    return 0;
}

/* Reads the next word of the line as a type name. */
static int host_vtk_type_word(host_numbers *vtk, const char *what, host_type *type)
{
    host_word word;
    *type = HOST_TYPE_NONE;
    if (host_text_word_in_line(&vtk->text, &word))
        *type = host_vtk_type(word);
    return *type == HOST_TYPE_NONE ? host_vtk_fail(vtk, what) : 0;
}

/* Skips the rest of the line: binary data starts on the next. */
static void host_vtk_end_line(host_numbers *vtk)
{
    host_word rest;
    (void)host_text_line(&vtk->text, &rest);
}

/* How to read the cells of a section. */
enum { HOST_VTK_SKIP = 0, HOST_VTK_POLYGONS, HOST_VTK_STRIPS };

/* Reads one cell of n indexes. Every second triangle of a strip is reversed, so that all have the same outside. */
static int read_cell(host_numbers *vtk, int use, host_type type, uint64_t n)
{
    host_mesh_reader *const reader = vtk->reader;
    uint32_t fan[3] = {0, 0, 0}, c = 0, a = 0, b = 0;
    if (use == HOST_VTK_SKIP)
        return skip(vtk, type, n);
    if (n < 3)
        return host_reader_fail(reader, "at least 3 vertices, found %llu", (unsigned long long)n);
    for (uint64_t i = 0; i < n; i++) {
        int result = 0;
        if (host_numbers_index(vtk, type, reader->mesh->n_vertices, &c) != 0)
            return -1;
        if (use == HOST_VTK_POLYGONS)
            result = host_reader_fan(reader, fan, c);
        else if (i >= 2)
            result = i % 2u == 0 ? host_reader_triangle(reader, a, b, c) : host_reader_triangle(reader, b, a, c);
        if (result != 0)
            return -1;
        a = b;
        b = c;
    }
    return 0;
}

/* Reads rows "n i j k ...", `size` numbers in total. */
static int read_rows(host_numbers *vtk, int use, uint64_t cells, uint64_t size)
{
    host_mesh_reader *const reader = vtk->reader;
    if (!host_numbers_fit(vtk, HOST_TYPE_I32, size) || cells > size)
        return host_vtk_fail(vtk, "cell counts the file can hold");
    for (reader->number = 0; reader->number < cells; reader->number++) {
        double n = 0.0;
        if (host_numbers_value(vtk, HOST_TYPE_I32, &n) != 0)
            return -1;
        if (!(n >= 0.0 && n < (double)size))
            return host_reader_fail(reader, "a count of indexes below %llu, found %g", (unsigned long long)size, n);
        if (read_cell(vtk, use, HOST_TYPE_I32, (uint64_t)n) != 0)
            return -1;
    }
    return 0;
}

/* Reads the line "OFFSETS type" or "CONNECTIVITY type". */
static int array_line(host_numbers *vtk, const char *name, host_type *type)
{
    host_word word;
    if (!host_text_word(&vtk->text, &word) || !host_word_is_nocase(word, name))
        return host_fail_at(vtk->reader->error, "line", vtk->text.line, "%s", name);
    if (host_vtk_type_word(vtk, "the type of an array of indexes", type) != 0)
        return -1;
    host_vtk_end_line(vtk);
    return 0;
}

static int read_offsets(host_numbers *vtk, host_type type, uint64_t n, uint64_t size, uint32_t *offset)
{
    host_mesh_reader *const reader = vtk->reader;
    double last = 0.0;
    for (reader->number = 0; reader->number < n; reader->number++) {
        double value = 0.0;
        if (host_numbers_value(vtk, type, &value) != 0)
            return -1;
        if (!(value >= last && value <= (double)size) || (reader->number == 0 && value > 0.0))
            return host_reader_fail(reader, "offsets rising from 0 to %llu, found %g", (unsigned long long)size, value);
        last = value;
        offset[reader->number] = (uint32_t)value;
    }
    return 0;
}

/* Reads cells of version 5.1: n offsets (one more than cells), then `size` indexes. */
static int read_arrays(host_numbers *vtk, int use, uint64_t n, uint64_t size)
{
    host_mesh_reader *const reader = vtk->reader;
    host_type type = HOST_TYPE_NONE;
    if (array_line(vtk, "OFFSETS", &type) != 0)
        return -1;
    if (!host_numbers_fit(vtk, type, n) || size > 0xffffffffu)
        return host_vtk_fail(vtk, "cell counts the file can hold");
    uint32_t *offset = malloc(sizeof *offset * ((size_t)n + 1u));
    if (offset == NULL)
        return host_vtk_fail(vtk, "more free memory");
    int result = read_offsets(vtk, type, n, size, offset);
    if (result == 0)
        result = array_line(vtk, "CONNECTIVITY", &type);
    for (reader->number = 0; result == 0 && reader->number + 1u < n; reader->number++)
        result = read_cell(vtk, use, type, offset[reader->number + 1u] - offset[reader->number]);
    free(offset);
    return result;
}

/* Reads a section whose keyword has just been read: counts, then "n i j k ..." rows or, since version 5.1,
 * the arrays OFFSETS and CONNECTIVITY. */
static int host_vtk_cells(host_numbers *vtk, int use)
{
    uint64_t cells = 0, size = 0;
    host_word word;
    if (host_vtk_count(vtk, "a count of cells", &cells) != 0 || host_vtk_count(vtk, "a count of indexes", &size) != 0)
        return -1;
    host_vtk_end_line(vtk);
    vtk->reader->unit = use == HOST_VTK_SKIP ? "cell" : "face";
    host_text ahead = vtk->text;
    if (host_text_word(&ahead, &word) && host_word_is_nocase(word, "OFFSETS"))
        return read_arrays(vtk, use, cells, size);
    return read_rows(vtk, use, cells, size);
}

/* Reads the header: "# vtk DataFile Version", a title, ASCII or BINARY. */
static int read_head(host_numbers *vtk)
{
    host_word w;
    if (!host_text_line(&vtk->text, &w) || !host_word_has(w, "vtk DataFile"))
        return host_fail_at(vtk->reader->error, "line", 1, "# vtk DataFile Version");
    if (!host_text_line(&vtk->text, &w))
        return host_vtk_fail(vtk, "a title line");
    vtk->reader->ras = host_word_has(w, "SPACE=RAS");
    if (!host_text_word(&vtk->text, &w) || !(host_word_is_nocase(w, "ASCII") || host_word_is_nocase(w, "BINARY")))
        return host_vtk_fail(vtk, "ASCII or BINARY");
    vtk->binary = host_word_is_nocase(w, "BINARY");
    if (!host_text_word(&vtk->text, &w) || !host_word_is_nocase(w, "DATASET") ||
        !host_text_word_in_line(&vtk->text, &w) || !host_word_is_nocase(w, "POLYDATA"))
        return host_vtk_fail(vtk, "DATASET POLYDATA");
    return 0;
}

static int read_points(host_numbers *vtk)
{
    host_mesh_reader *const reader = vtk->reader;
    host_type type = HOST_TYPE_NONE;
    uint64_t n = 0;
    if (reader->mesh->n_vertices > 0)
        return host_vtk_fail(vtk, "POINTS once");
    if (host_vtk_count(vtk, "a count of points", &n) != 0 ||
        host_vtk_type_word(vtk, "the type of the points, float or double", &type) != 0)
        return -1;
    host_vtk_end_line(vtk);
    if (n > SMR_VERTICES_MAX || !host_numbers_fit(vtk, type, 3u * n))
        return host_fail_at(reader->error, "line", vtk->text.line - 1u,
                            "a count of points the file can hold, found %llu", (unsigned long long)n);
    reader->unit = "vertex";
    reader->number = 0;
    if (host_reader_reserve(reader, (size_t)n, 0) != 0)
        return -1;
    for (reader->number = 0; reader->number < n; reader->number++) {
        double xyz[3];
        if (host_numbers_three(vtk, type, xyz) != 0 || host_reader_vertex(reader, xyz) != 0)
            return -1;
    }
    return 0;
}

/* Skips "FIELD name n" and its n arrays, each "name components tuples type" and data. */
static int skip_field(host_numbers *vtk)
{
    uint64_t arrays = 0;
    host_word word;
    (void)host_text_word_in_line(&vtk->text, &word);
    if (host_vtk_count(vtk, "a count of arrays", &arrays) != 0)
        return -1;
    vtk->reader->unit = "field array";
    for (uint64_t i = 0; i < arrays; i++) {
        uint64_t components = 0, n = 0;
        host_type type = HOST_TYPE_NONE;
        vtk->reader->number = i;
        if (!host_text_word(&vtk->text, &word))
            return host_reader_truncated(vtk->reader);
        if (host_vtk_count(vtk, "a count of components", &components) != 0 ||
            host_vtk_count(vtk, "a count of tuples", &n) != 0 || host_vtk_type_word(vtk, "a numeric type", &type) != 0)
            return -1;
        host_vtk_end_line(vtk);
        if (skip(vtk, type, components * n) != 0)
            return -1;
    }
    return 0;
}

/* Skips "METADATA" and its lines up to an empty line. */
static int skip_metadata(host_numbers *vtk)
{
    host_word line;
    host_vtk_end_line(vtk);
    while (host_text_line(&vtk->text, &line) && line.n > 0)
        continue;
    return 0;
}

/* Reads the points' normals, where they come first: "POINT_DATA n", "NORMALS name type". */
static int read_normals(host_numbers *vtk)
{
    host_mesh_reader *const reader = vtk->reader;
    host_type type = HOST_TYPE_NONE;
    host_word word;
    uint64_t n = 0;
    if (host_vtk_count(vtk, "a count of points", &n) != 0)
        return -1;
    if (n != reader->mesh->n_vertices || !host_text_word(&vtk->text, &word) || !host_word_is_nocase(word, "NORMALS") ||
        !host_text_word_in_line(&vtk->text, &word))
        return 0;
    if (host_vtk_type_word(vtk, "the type of the normals, float or double", &type) != 0)
        return -1;
    host_vtk_end_line(vtk);
    reader->unit = "normal";
    for (reader->number = 0; reader->number < n; reader->number++) {
        double normal[3];
        if (host_numbers_three(vtk, type, normal) != 0 || host_reader_normal(reader, normal) != 0)
            return -1;
    }
    return 0;
}

/* Reads one section. 1 at the end of the geometry, 0 to go on, -1 with the error filled. */
static int read_section(host_numbers *vtk, host_word keyword)
{
    if (host_word_is_nocase(keyword, "POINTS"))
        return read_points(vtk);
    if (host_word_is_nocase(keyword, "POLYGONS"))
        return host_vtk_cells(vtk, HOST_VTK_POLYGONS);
    if (host_word_is_nocase(keyword, "TRIANGLE_STRIPS"))
        return host_vtk_cells(vtk, HOST_VTK_STRIPS);
    if (host_word_is_nocase(keyword, "VERTICES") || host_word_is_nocase(keyword, "LINES"))
        return host_vtk_cells(vtk, HOST_VTK_SKIP);
    if (host_word_is_nocase(keyword, "FIELD"))
        return skip_field(vtk);
    if (host_word_is_nocase(keyword, "METADATA"))
        return skip_metadata(vtk);
    if (host_word_is_nocase(keyword, "POINT_DATA") && vtk->reader->cloud && vtk->reader->mesh->n_triangles == 0)
        return read_normals(vtk) != 0 ? -1 : 1;
    if (host_word_is_nocase(keyword, "POINT_DATA") || host_word_is_nocase(keyword, "CELL_DATA"))
        return 1;
    return host_vtk_fail(vtk, "POINTS, POLYGONS, TRIANGLE_STRIPS, VERTICES, LINES, FIELD, POINT_DATA or CELL_DATA");
}

int host_read_vtk(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    host_numbers vtk = {reader, host_text_over(data, n), 0, 1};
    host_word keyword;
    int result = 0;
    if (read_head(&vtk) != 0)
        return -1;
    while (result == 0 && host_text_word(&vtk.text, &keyword))
        result = read_section(&vtk, keyword);
    return result < 0 ? -1 : 0;
}
