/* mesh_vtk.c: reads legacy VTK polydata ("VTK file formats", versions 1 to 5.1): geometry only, skips data arrays.
 * SPDX-License-Identifier: MIT */
#include "meshes/vtk_cells.h"

/* Reads the header: "# vtk DataFile Version", a title, ASCII or BINARY. */
static int read_head(host_vtk *vtk)
{
    host_word line;
    if (!host_text_line(&vtk->text, &line) || !host_word_has(line, "vtk DataFile"))
        return host_fail_at(vtk->reader->error, "line", 1, "# vtk DataFile Version");
    if (!host_text_line(&vtk->text, &line))
        return host_vtk_fail(vtk, "a title line");
    vtk->reader->ras = host_word_has(line, "SPACE=RAS");
    if (!host_text_word(&vtk->text, &line) ||
        !(host_word_is_nocase(line, "ASCII") || host_word_is_nocase(line, "BINARY")))
        return host_vtk_fail(vtk, "ASCII or BINARY");
    vtk->binary = host_word_is_nocase(line, "BINARY");
    if (!host_text_word(&vtk->text, &line) || !host_word_is_nocase(line, "DATASET") ||
        !host_text_word_in_line(&vtk->text, &line) || !host_word_is_nocase(line, "POLYDATA"))
        return host_vtk_fail(vtk, "DATASET POLYDATA");
    return 0;
}

static int read_points(host_vtk *vtk)
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
    if (n > SMR_VERTICES_MAX || !host_vtk_fits(vtk, type, 3u * n))
        return host_fail_at(reader->error, "line", vtk->text.line - 1u,
                            "a count of points the file can hold, found %llu", (unsigned long long)n);
    reader->unit = "vertex";
    reader->number = 0;
    if (host_reader_reserve(reader, (size_t)n, 0) != 0)
        return -1;
    for (reader->number = 0; reader->number < n; reader->number++) {
        double xyz[3];
        int i = 0;
        for (i = 0; i < 3; i++)
            if (host_vtk_value(vtk, type, &xyz[i]) != 0)
                return -1;
        if (host_reader_vertex(reader, xyz) != 0)
            return -1;
    }
    return 0;
}

/* Skips "FIELD name n" and its n arrays, each "name components tuples type" and data. */
static int skip_field(host_vtk *vtk)
{
    uint64_t arrays = 0, i = 0;
    host_word word;
    (void)host_text_word_in_line(&vtk->text, &word);
    if (host_vtk_count(vtk, "a count of arrays", &arrays) != 0)
        return -1;
    vtk->reader->unit = "field array";
    for (i = 0; i < arrays; i++) {
        uint64_t components = 0, tuples = 0;
        host_type type = HOST_TYPE_NONE;
        vtk->reader->number = i;
        if (!host_text_word(&vtk->text, &word))
            return host_reader_truncated(vtk->reader);
        if (host_vtk_count(vtk, "a count of components", &components) != 0 ||
            host_vtk_count(vtk, "a count of tuples", &tuples) != 0 ||
            host_vtk_type_word(vtk, "a numeric type", &type) != 0)
            return -1;
        host_vtk_end_line(vtk);
        if (host_vtk_skip(vtk, type, components * tuples) != 0)
            return -1;
    }
    return 0;
}

/* Skips "METADATA" and its lines up to an empty line. */
static void skip_metadata(host_vtk *vtk)
{
    host_word line;
    host_vtk_end_line(vtk);
    while (host_text_line(&vtk->text, &line) && line.n > 0)
        continue;
}

/* Reads the points' normals, where they come first: "POINT_DATA n", "NORMALS name type". */
static int read_normals(host_vtk *vtk)
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
        int i = 0;
        for (i = 0; i < 3; i++)
            if (host_vtk_value(vtk, type, &normal[i]) != 0)
                return -1;
        if (host_reader_normal(reader, normal) != 0)
            return -1;
    }
    return 0;
}

/* Reads one section. 1 at the end of the geometry, 0 to go on, -1 with the error filled. */
static int read_section(host_vtk *vtk, host_word keyword)
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
    if (host_word_is_nocase(keyword, "METADATA")) {
        skip_metadata(vtk);
        return 0;
    }
    if (host_word_is_nocase(keyword, "POINT_DATA") && vtk->reader->cloud && vtk->reader->mesh->n_triangles == 0)
        return read_normals(vtk) != 0 ? -1 : 1;
    if (host_word_is_nocase(keyword, "POINT_DATA") || host_word_is_nocase(keyword, "CELL_DATA"))
        return 1;
    return host_vtk_fail(vtk, "POINTS, POLYGONS, TRIANGLE_STRIPS, VERTICES, LINES, FIELD, POINT_DATA or CELL_DATA");
}

int host_read_vtk(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    host_vtk vtk;
    host_word keyword;
    int result = 0;
    vtk.reader = reader;
    vtk.text = host_text_over(data, n);
    vtk.binary = 0;
    if (read_head(&vtk) != 0)
        return -1;
    while (result == 0 && host_text_word(&vtk.text, &keyword))
        result = read_section(&vtk, keyword);
    return result < 0 ? -1 : 0;
}
