/* vtk_cells.c: reads cells of legacy VTK polydata, before and since version 5.1.
 * SPDX-License-Identifier: MIT */
#include "meshes/vtk_cells.h"

#include <stdlib.h>

static int index_value(host_vtk *vtk, host_type type, uint32_t *index)
{
    const host_mesh_reader *const reader = vtk->reader;
    double value = 0.0;
    if (host_vtk_value(vtk, type, &value) != 0)
        return -1;
    if (!(value >= 0.0 && value < (double)reader->mesh->n_vertices) || (double)(uint32_t)value < value)
        return host_fail_at(reader->error, reader->unit, reader->number, "vertex indexes from 0 to %lld, found %.10g",
                            (long long)reader->mesh->n_vertices - 1, value);
    *index = (uint32_t)value;
    return 0;
}

/* Reads one cell of n indexes. Every second triangle of a strip is reversed, so that all have the same outside. */
static int read_cell(host_vtk *vtk, int use, host_type type, uint64_t n)
{
    host_mesh_reader *const reader = vtk->reader;
    uint32_t fan[3] = {0, 0, 0}, index = 0, a = 0, b = 0;
    uint64_t i = 0;
    if (use == HOST_VTK_SKIP)
        return host_vtk_skip(vtk, type, n);
    if (n < 3)
        return host_fail_at(reader->error, reader->unit, reader->number, "at least 3 vertices, found %llu",
                            (unsigned long long)n);
    for (i = 0; i < n; i++) {
        int result = 0;
        if (index_value(vtk, type, &index) != 0)
            return -1;
        if (use == HOST_VTK_POLYGONS)
            result = host_reader_fan(reader, fan, index);
        else if (i >= 2)
            result =
                i % 2u == 0 ? host_reader_triangle(reader, a, b, index) : host_reader_triangle(reader, b, a, index);
        if (result != 0)
            return -1;
        a = b;
        b = index;
    }
    return 0;
}

/* Reads rows "n i j k ...", `size` numbers in total. */
static int read_rows(host_vtk *vtk, int use, uint64_t cells, uint64_t size)
{
    host_mesh_reader *const reader = vtk->reader;
    if (!host_vtk_fits(vtk, HOST_TYPE_I32, size) || cells > size)
        return host_vtk_fail(vtk, "cell counts the file can hold");
    for (reader->number = 0; reader->number < cells; reader->number++) {
        double n = 0.0;
        if (host_vtk_value(vtk, HOST_TYPE_I32, &n) != 0)
            return -1;
        if (!(n >= 0.0 && n < (double)size))
            return host_fail_at(reader->error, reader->unit, reader->number, "a count of indexes below %llu, found %g",
                                (unsigned long long)size, n);
        if (read_cell(vtk, use, HOST_TYPE_I32, (uint64_t)n) != 0)
            return -1;
    }
    return 0;
}

/* Reads the line "OFFSETS type" or "CONNECTIVITY type". */
static int array_line(host_vtk *vtk, const char *name, host_type *type)
{
    host_word word;
    if (!host_text_word(&vtk->text, &word) || !host_word_is_nocase(word, name))
        return host_fail_at(vtk->reader->error, "line", vtk->text.line, "%s", name);
    if (host_vtk_type_word(vtk, "the type of an array of indexes", type) != 0)
        return -1;
    host_vtk_end_line(vtk);
    return 0;
}

static int read_offsets(host_vtk *vtk, host_type type, uint64_t n, uint64_t size, uint32_t *offset)
{
    host_mesh_reader *const reader = vtk->reader;
    double last = 0.0;
    for (reader->number = 0; reader->number < n; reader->number++) {
        double value = 0.0;
        if (host_vtk_value(vtk, type, &value) != 0)
            return -1;
        if (!(value >= last && value <= (double)size) || (reader->number == 0 && value > 0.0))
            return host_fail_at(reader->error, reader->unit, reader->number, "offsets rising from 0 to %llu, found %g",
                                (unsigned long long)size, value);
        last = value;
        offset[reader->number] = (uint32_t)value;
    }
    return 0;
}

/* Reads cells of version 5.1: n offsets (one more than cells), then `size` indexes. */
static int read_arrays(host_vtk *vtk, int use, uint64_t n, uint64_t size)
{
    host_mesh_reader *const reader = vtk->reader;
    host_type type = HOST_TYPE_NONE;
    uint32_t *offset = NULL;
    int result = 0;
    if (array_line(vtk, "OFFSETS", &type) != 0)
        return -1;
    if (!host_vtk_fits(vtk, type, n) || size > 0xffffffffu)
        return host_vtk_fail(vtk, "cell counts the file can hold");
    offset = malloc(sizeof *offset * ((size_t)n + 1u));
    if (offset == NULL)
        return host_vtk_fail(vtk, "more free memory");
    result = read_offsets(vtk, type, n, size, offset);
    if (result == 0)
        result = array_line(vtk, "CONNECTIVITY", &type);
    for (reader->number = 0; result == 0 && reader->number + 1u < n; reader->number++)
        result = read_cell(vtk, use, type, offset[reader->number + 1u] - offset[reader->number]);
    free(offset);
    return result;
}

int host_vtk_cells(host_vtk *vtk, int use)
{
    uint64_t cells = 0, size = 0;
    host_text ahead;
    host_word word;
    if (host_vtk_count(vtk, "a count of cells", &cells) != 0 || host_vtk_count(vtk, "a count of indexes", &size) != 0)
        return -1;
    host_vtk_end_line(vtk);
    vtk->reader->unit = use == HOST_VTK_SKIP ? "cell" : "face";
    ahead = vtk->text;
    if (host_text_word(&ahead, &word) && host_word_is_nocase(word, "OFFSETS"))
        return read_arrays(vtk, use, cells, size);
    return read_rows(vtk, use, cells, size);
}
