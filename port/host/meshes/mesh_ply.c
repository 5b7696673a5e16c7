/* mesh_ply.c: reads PLY: ASCII and both binary byte orders, any order and type of properties; skips other elements.
 * SPDX-License-Identifier: MIT */
#include <string.h>
#include "meshes/mesh_reader.h"

#define HOST_PLY_ELEMENTS_MAX 16u
#define HOST_PLY_PROPERTIES_MAX 64u

enum { HOST_PLY_OTHER = 0, HOST_PLY_VERTEX, HOST_PLY_FACE };
enum { HOST_PLY_ASCII = 0, HOST_PLY_LITTLE, HOST_PLY_BIG };

typedef struct host_ply_property {
    host_type type;
    host_type count_type; /* of a list's length; HOST_TYPE_NONE: a single value */
    int role; /* vertex: 0, 1, 2 for x, y, z, 3, 4, 5 for nx, ny, nz; face: 0 for the index list; -1: ignored */
} host_ply_property;

typedef struct host_ply_element {
    int kind; /* HOST_PLY_... */
    uint64_t count;
    uint32_t line; /* line of the header */
    uint32_t n_properties, has_list;
    size_t row_bytes; /* binary: bytes of one row, with empty lists */
    host_ply_property property[HOST_PLY_PROPERTIES_MAX];
} host_ply_element;

typedef struct host_ply_header {
    int format;                 /* HOST_PLY_ASCII, ... */
    uint32_t n_elements, lines; /* lines of the header, end_header included */
    uint64_t n_vertices;        /* count of the vertex element */
    const unsigned char *body;
    host_ply_element element[HOST_PLY_ELEMENTS_MAX];
} host_ply_header;

static host_type type_named(host_word word)
{
    static const struct {
        const char *name;
        host_type type;
    } names[] = {
        {"char", HOST_TYPE_I8},   {"int8", HOST_TYPE_I8},     {"uchar", HOST_TYPE_U8},   {"uint8", HOST_TYPE_U8},
        {"short", HOST_TYPE_I16}, {"int16", HOST_TYPE_I16},   {"ushort", HOST_TYPE_U16}, {"uint16", HOST_TYPE_U16},
        {"int", HOST_TYPE_I32},   {"int32", HOST_TYPE_I32},   {"uint", HOST_TYPE_U32},   {"uint32", HOST_TYPE_U32},
        {"float", HOST_TYPE_F32}, {"float32", HOST_TYPE_F32}, {"double", HOST_TYPE_F64}, {"float64", HOST_TYPE_F64}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (host_word_is(word, names[i].name))
            return names[i].type;
    return HOST_TYPE_NONE;
}

static int is_whole(host_type type) { return type != HOST_TYPE_NONE && type != HOST_TYPE_F32 && type != HOST_TYPE_F64; }

static int read_format(const host_mesh_reader *reader, host_text *line, host_ply_header *header)
{
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    host_word word;
    if (host_text_word_in_line(line, &word))
        for (int i = 0; i < 3; i++)
            if (host_word_is(word, names[i])) {
                header->format = i;
                return 0;
            }
    return host_reader_fail(reader, "the format ascii, binary_little_endian or binary_big_endian");
}

static int read_element(const host_mesh_reader *reader, host_text *line, host_ply_header *header)
{
    static const int64_t most[] = {INT64_MAX, SMR_VERTICES_MAX, SMR_TRIANGLES_MAX}; /* [HOST_PLY_...] */
    host_word name, number;
    int64_t count = 0;
    if (!host_text_word_in_line(line, &name) || !host_text_word_in_line(line, &number) ||
        !host_word_int(number, &count) || count < 0)
        return host_reader_fail(reader, "an element's name and a count of 0 or more");
    if (header->n_elements == HOST_PLY_ELEMENTS_MAX)
        return host_reader_fail(reader, "at most 16 elements");
    host_ply_element *element = &header->element[header->n_elements++];
    memset(element, 0, sizeof *element);
    element->count = (uint64_t)count;
    element->line = (uint32_t)reader->number;
    element->kind = host_word_is(name, "vertex") ? HOST_PLY_VERTEX : host_word_is(name, "face") ? HOST_PLY_FACE : 0;
    if (count > most[element->kind])
        return host_reader_fail(reader, "at most %lld %s, found %lld", (long long)most[element->kind],
                                element->kind == HOST_PLY_FACE ? "faces" : "vertices", (long long)count);
    return 0;
}

/* The role of a property: see host_ply_property. */
static int role_of(int kind, const host_ply_property *property, host_word w)
{
    const int list = property->count_type != HOST_TYPE_NONE;
    if (kind == HOST_PLY_VERTEX && !list && w.n == 1 && w.start[0] >= 'x' && w.start[0] <= 'z')
        return w.start[0] - 'x';
    if (kind == HOST_PLY_VERTEX && !list && w.n == 2 && w.start[0] == 'n' && w.start[1] >= 'x' && w.start[1] <= 'z')
        return 3 + w.start[1] - 'x';
    if (kind == HOST_PLY_FACE && list && (host_word_is(w, "vertex_indices") || host_word_is(w, "vertex_index")))
        return 0;
    return -1;
}

static int read_property(const host_mesh_reader *reader, host_text *line, host_ply_header *header)
{
    host_word word;
    if (header->n_elements == 0)
        return host_reader_fail(reader, "an element before its properties");
    host_ply_element *element = &header->element[header->n_elements - 1u];
    if (element->n_properties == HOST_PLY_PROPERTIES_MAX)
        return host_reader_fail(reader, "at most 64 properties");
    host_ply_property *p = &element->property[element->n_properties++];
    p->count_type = HOST_TYPE_NONE;
    if (!host_text_word_in_line(line, &word))
        return host_reader_fail(reader, "a property's type and name");
    if (host_word_is(word, "list")) {
        p->count_type = host_text_word_in_line(line, &word) ? type_named(word) : HOST_TYPE_NONE;
        if (!is_whole(p->count_type))
            return host_reader_fail(reader, "a whole-number type for the list's count");
        if (!host_text_word_in_line(line, &word))
            return host_reader_fail(reader, "the type of the list's values");
        element->has_list = 1;
    }
    p->type = type_named(word);
    if (p->type == HOST_TYPE_NONE || !host_text_word_in_line(line, &word))
        return host_reader_fail(reader, "a property's type (char, ..., double) and name");
    p->role = role_of(element->kind, p, word);
    if (element->kind == HOST_PLY_FACE && p->role == 0 && !is_whole(p->type))
        return host_reader_fail(reader, "whole numbers as vertex indexes");
    element->row_bytes += host_type_bytes(p->count_type == HOST_TYPE_NONE ? p->type : p->count_type);
    return 0;
}

/* Checks that an element has each role it needs exactly once. */
static int check_roles(const host_mesh_reader *reader, const host_ply_element *element)
{
    uint32_t found[6] = {0, 0, 0, 0, 0, 0};
    for (uint32_t i = 0; i < element->n_properties; i++)
        if (element->property[i].role >= 0)
            found[element->property[i].role]++;
    if (element->kind == HOST_PLY_VERTEX && (found[0] != 1 || found[1] != 1 || found[2] != 1))
        return host_fail_at(reader->error, "header line", element->line, "vertices with the properties x, y and z");
    if (element->kind == HOST_PLY_FACE && found[0] != 1 && element->count > 0)
        return host_fail_at(reader->error, "header line", element->line, "faces with one list vertex_indices");
    return 0;
}

/* Checks the counts against the remaining bytes: a value takes at least one byte, in text two. */
static int check_claims(const host_mesh_reader *reader, host_ply_header *header, size_t left)
{
    uint32_t n_vertex = 0, n_face = 0;
    size_t need = 0;
    /* the last value of a text needs no line end */
    const size_t slack = header->format == HOST_PLY_ASCII ? 1u : 0u;
    for (uint32_t i = 0; i < header->n_elements; i++) {
        const host_ply_element *const element = &header->element[i];
        size_t row = element->row_bytes;
        if (header->format == HOST_PLY_ASCII)
            row = 2u * element->n_properties;
        if (check_roles(reader, element) != 0)
            return -1;
        if (row > 0 && element->count > (left + slack - need) / row)
            return host_fail_at(reader->error, "header line", element->line,
                                "a count the file can hold, found %llu with %zu bytes left",
                                (unsigned long long)element->count, left - (need > left ? left : need));
        need += row * (size_t)element->count;
        if (element->kind == HOST_PLY_VERTEX) {
            header->n_vertices = element->count;
            n_vertex++;
        }
        n_face += element->kind == HOST_PLY_FACE;
    }
    if (n_vertex != 1 || n_face > 1)
        return host_fail_at(reader->error, "header line", header->lines,
                            "one element vertex and at most one element face before it");
    if (header->n_vertices == 0)
        return host_fail(reader->error, "header", "at least one vertex");
    return 0;
}

/* Reads one line. 1 when it was the last, 0 to go on, -1 with the error filled. */
static int read_line(host_mesh_reader *reader, host_word whole, host_ply_header *header)
{
    host_text line = host_text_over(whole.start, whole.n);
    host_word word;
    if (!host_text_word_in_line(&line, &word) || host_word_is(word, "obj_info"))
        return 0;
    if (host_word_is(word, "comment")) {
        reader->ras |= host_word_has(whole, "SPACE=RAS");
        return 0;
    }
    if (host_word_is(word, "end_header"))
        return 1;
    if (host_word_is(word, "format"))
        return read_format(reader, &line, header);
    if (host_word_is(word, "element"))
        return read_element(reader, &line, header);
    if (host_word_is(word, "property"))
        return read_property(reader, &line, header);
    return host_reader_fail(reader, "format, element, property, comment or end_header");
}

/* Reads the header and checks that the rest of the file can hold its counts. 0, or -1 with the error filled. */
static int host_ply_read_header(host_mesh_reader *reader, const unsigned char *data, size_t n, host_ply_header *header)
{
    host_text text = host_text_over(data, n);
    host_word whole;
    int done = 0;
    memset(header, 0, sizeof *header);
    header->format = -1;
    reader->number = 1;
    if (!host_text_line(&text, &whole) || !host_word_is(whole, "ply"))
        return host_reader_fail(reader, "the word ply");
    while (done == 0) {
        /* With old Mac line ends a body byte of 10 after end_header is data, not a line end. */
        const char *const before = text.at;
        reader->number = text.line;
        if (!host_text_line(&text, &whole))
            return host_reader_fail(reader, "end_header, but the file ends here");
        done = read_line(reader, whole, header);
        if (done == 1 && data[3] == '\r' && data[4] != '\n')
            text.at = before + whole.n + 1;
    }
    if (done < 0)
        return -1;
    header->lines = (uint32_t)reader->number;
    header->body = (const unsigned char *)text.at;
    if (header->format < 0)
        return host_reader_fail(reader, "a format line before it");
    return check_claims(reader, header, n - (size_t)(header->body - data));
}

static int next_count(host_numbers *from, host_type type, uint32_t least, uint64_t *count)
{
    double value = 0.0;
    if (host_numbers_value(from, type, &value) != 0)
        return -1;
    if (!(value >= (double)least && value <= 4294967295.0))
        return host_reader_fail(from->reader, "a list count of %u or more, found %g", least, value);
    *count = (uint64_t)value;
    if ((double)*count < value)
        return host_reader_fail(from->reader, "a whole list count, found %g", value);
    return 0;
}

static int skip_property(host_numbers *from, const host_ply_property *property)
{
    uint64_t count = 1;
    if (property->count_type != HOST_TYPE_NONE && next_count(from, property->count_type, 0, &count) != 0)
        return -1;
    return host_numbers_skip(from, property->type, count);
}

static int has_normals(const host_ply_element *element)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < element->n_properties; i++)
        if (element->property[i].role >= 3)
            found |= 1u << (element->property[i].role - 3);
    return found == 7u;
}

static int read_vertices(host_numbers *from, const host_ply_element *element)
{
    host_mesh_reader *const reader = from->reader;
    double value[6] = {0.0}; /* position and normal */
    const int faced = has_normals(element);
    if (host_reader_reserve(reader, (size_t)element->count, 0) != 0)
        return -1;
    for (reader->number = 0; reader->number < element->count; reader->number++) {
        for (uint32_t i = 0; i < element->n_properties; i++) {
            const host_ply_property *const property = &element->property[i];
            const int result = property->role < 0 ? skip_property(from, property)
                                                  : host_numbers_value(from, property->type, &value[property->role]);
            if (result != 0)
                return -1;
        }
        if (host_reader_vertex(reader, value) != 0 || (faced && host_reader_normal(reader, value + 3) != 0))
            return -1;
    }
    return 0;
}

static int read_polygon(host_numbers *from, const host_ply_property *p, uint64_t n_vertices)
{
    host_mesh_reader *const reader = from->reader;
    uint32_t fan[3] = {0, 0, 0};
    uint64_t count = 0;
    if (next_count(from, p->count_type, 3, &count) != 0)
        return -1;
    for (uint64_t i = 0; i < count; i++) {
        uint32_t index = 0;
        if (host_numbers_index(from, p->type, n_vertices, &index) != 0 || host_reader_fan(reader, fan, index) != 0)
            return -1;
    }
    return 0;
}

static int read_faces(host_numbers *from, const host_ply_element *element, uint64_t n_vertices)
{
    host_mesh_reader *const reader = from->reader;
    if (host_reader_reserve(reader, 0, (size_t)element->count) != 0)
        return -1;
    for (reader->number = 0; reader->number < element->count; reader->number++) {
        for (uint32_t i = 0; i < element->n_properties; i++) {
            const host_ply_property *const p = &element->property[i];
            const int result = p->role < 0 ? skip_property(from, p) : read_polygon(from, p, n_vertices);
            if (result != 0)
                return -1;
        }
    }
    return 0;
}

static int skip_element(host_numbers *from, const host_ply_element *element)
{
    host_mesh_reader *const reader = from->reader;
    reader->number = 0;
    if (element->n_properties == 0)
        return 0;                           /* rows without properties take no bytes */
    if (!element->has_list && from->binary) /* the header check bounds the product */
        return host_numbers_skip(from, HOST_TYPE_U8, element->row_bytes * element->count);
    for (; reader->number < element->count; reader->number++) {
        for (uint32_t i = 0; i < element->n_properties; i++)
            if (skip_property(from, &element->property[i]) != 0)
                return -1;
    }
    return 0;
}

int host_read_ply(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    host_ply_header header;
    if (host_ply_read_header(reader, data, n, &header) != 0)
        return -1;
    host_numbers from = {reader, host_text_over(header.body, n - (size_t)(header.body - data)),
                         header.format != HOST_PLY_ASCII, header.format == HOST_PLY_BIG};
    for (uint32_t i = 0; i < header.n_elements; i++) {
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
