/* mesh_ply.c: reads PLY: ASCII and both binary byte orders, any order and type of properties; skips other elements.
 * SPDX-License-Identifier: MIT */
#include <string.h>

#include "base/text_scan.h"
#include "meshes/ply_header.h"

/* The reading position in the values of a PLY file. */
typedef struct source {
    host_mesh_reader *reader;
    int format;
    host_text text;                /* ASCII */
    const unsigned char *at, *end; /* binary */
} source;

static int next_value(source *from, host_type type, double *value)
{
    if (from->format == HOST_PLY_ASCII) {
        host_word word;
        if (!host_text_word(&from->text, &word))
            return host_reader_truncated(from->reader);
        if (!host_word_double(word, value))
            return host_fail_at(from->reader->error, from->reader->unit, from->reader->number, "a number, found '%.*s'",
                                (int)(word.n < 40 ? word.n : 40), word.start);
    } else {
        const size_t bytes = host_type_bytes(type);
        if ((size_t)(from->end - from->at) < bytes)
            return host_reader_truncated(from->reader);
        *value = host_type_read(type, from->at, from->format == HOST_PLY_BIG);
        from->at += bytes;
    }
    return 0;
}

/* Skips n values of one type. */
static int skip_values(source *from, host_type type, uint64_t n)
{
    double ignored = 0.0;
    if (from->format != HOST_PLY_ASCII) {
        const size_t bytes = host_type_bytes(type);
        if (n > (size_t)(from->end - from->at) / bytes)
            return host_reader_truncated(from->reader);
        from->at += bytes * (size_t)n;
        return 0;
    }
    for (; n > 0; n--)
        if (next_value(from, type, &ignored) != 0)
            return -1;
    return 0;
}

static int next_count(source *from, host_type type, uint32_t least, uint64_t *count)
{
    double value = 0.0;
    if (next_value(from, type, &value) != 0)
        return -1;
    if (!(value >= (double)least && value <= 4294967295.0))
        return host_fail_at(from->reader->error, from->reader->unit, from->reader->number,
                            "a list count of %u or more, found %g", least, value);
    *count = (uint64_t)value;
    if ((double)*count < value)
        return host_fail_at(from->reader->error, from->reader->unit, from->reader->number,
                            "a whole list count, found %g", value);
    return 0;
}

static int skip_property(source *from, const host_ply_property *property)
{
    uint64_t count = 1;
    if (property->count_type != HOST_TYPE_NONE && next_count(from, property->count_type, 0, &count) != 0)
        return -1;
    return skip_values(from, property->type, count);
}

static int has_normals(const host_ply_element *element)
{
    uint32_t i = 0, found = 0;
    for (i = 0; i < element->n_properties; i++)
        if (element->property[i].role >= 3)
            found |= 1u << (element->property[i].role - 3);
    return found == 7u;
}

static int read_vertices(source *from, const host_ply_element *element)
{
    host_mesh_reader *const reader = from->reader;
    double value[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}; /* position and normal */
    const int faced = has_normals(element);
    if (host_reader_reserve(reader, (size_t)element->count, 0) != 0)
        return -1;
    for (reader->number = 0; reader->number < element->count; reader->number++) {
        uint32_t i = 0;
        for (i = 0; i < element->n_properties; i++) {
            const host_ply_property *const property = &element->property[i];
            const int result = property->role < 0 ? skip_property(from, property)
                                                  : next_value(from, property->type, &value[property->role]);
            if (result != 0)
                return -1;
        }
        if (host_reader_vertex(reader, value) != 0 || (faced && host_reader_normal(reader, value + 3) != 0))
            return -1;
    }
    return 0;
}

static int read_polygon(source *from, const host_ply_property *property, uint64_t n_vertices)
{
    host_mesh_reader *const reader = from->reader;
    uint32_t fan[3] = {0, 0, 0};
    uint64_t count = 0, i = 0;
    if (next_count(from, property->count_type, 3, &count) != 0)
        return -1;
    for (i = 0; i < count; i++) {
        double value = 0.0;
        if (next_value(from, property->type, &value) != 0)
            return -1;
        if (!(value >= 0.0 && value < (double)n_vertices) || (double)(uint32_t)value < value)
            return host_fail_at(reader->error, "face", reader->number, "vertex indexes from 0 to %llu, found %.10g",
                                (unsigned long long)n_vertices - 1u, value);
        if (host_reader_fan(reader, fan, (uint32_t)value) != 0)
            return -1;
    }
    return 0;
}

static int read_faces(source *from, const host_ply_element *element, uint64_t n_vertices)
{
    host_mesh_reader *const reader = from->reader;
    if (host_reader_reserve(reader, 0, (size_t)element->count) != 0)
        return -1;
    for (reader->number = 0; reader->number < element->count; reader->number++) {
        uint32_t i = 0;
        for (i = 0; i < element->n_properties; i++) {
            const host_ply_property *const property = &element->property[i];
            const int result =
                property->role < 0 ? skip_property(from, property) : read_polygon(from, property, n_vertices);
            if (result != 0)
                return -1;
        }
    }
    return 0;
}

static int skip_element(source *from, const host_ply_element *element)
{
    host_mesh_reader *const reader = from->reader;
    reader->number = 0;
    if (element->n_properties == 0)
        return 0; /* rows without properties take no bytes */
    if (!element->has_list && from->format != HOST_PLY_ASCII) {
        const size_t bytes = element->row_bytes * (size_t)element->count; /* bounded by the header check */
        if (bytes > (size_t)(from->end - from->at))
            return host_reader_truncated(reader);
        from->at += bytes;
        return 0;
    }
    for (; reader->number < element->count; reader->number++) {
        uint32_t i = 0;
        for (i = 0; i < element->n_properties; i++)
            if (skip_property(from, &element->property[i]) != 0)
                return -1;
    }
    return 0;
}

int host_read_ply(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    host_ply_header header;
    source from;
    uint32_t i = 0;
    if (host_ply_read_header(reader, data, n, &header) != 0)
        return -1;
    memset(&from, 0, sizeof from);
    from.reader = reader;
    from.format = header.format;
    from.at = header.body;
    from.end = data + n;
    from.text = host_text_over(header.body, (size_t)(from.end - header.body));
    for (i = 0; i < header.n_elements; i++) {
        const host_ply_element *const element = &header.element[i];
        int result = 0;
        reader->unit = element->kind == HOST_PLY_VERTEX ? "vertex" : element->kind == HOST_PLY_FACE ? "face" : "row";
        if (element->kind == HOST_PLY_VERTEX)
            result = read_vertices(&from, element);
        else if (element->kind == HOST_PLY_FACE && element->count > 0)
            result = read_faces(&from, element, header.n_vertices);
        else
            result = skip_element(&from, element);
        if (result != 0)
            return -1;
    }
    return 0;
}
