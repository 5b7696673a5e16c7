/* ply_header.c: reads the PLY header (Turk 1994): "ply", "format", "element NAME COUNT", "property [list COUNT_TYPE]
 * TYPE NAME", comments, "end_header". Every count is checked against the bytes that follow.
 * SPDX-License-Identifier: MIT */
#include "meshes/ply_header.h"

#include <string.h>

#include "base/text_scan.h"

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
    size_t i = 0;
    for (i = 0; i < sizeof names / sizeof names[0]; i++)
        if (host_word_is(word, names[i].name))
            return names[i].type;
    return HOST_TYPE_NONE;
}

static int is_whole(host_type type) { return type != HOST_TYPE_NONE && type != HOST_TYPE_F32 && type != HOST_TYPE_F64; }

static int bad_line(const host_mesh_reader *reader, const char *expected)
{
    return host_fail_at(reader->error, "header line", reader->number, "%s", expected);
}

static int read_format(const host_mesh_reader *reader, host_text *line, host_ply_header *header)
{
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    host_word word;
    int i = 0;
    if (host_text_word_in_line(line, &word))
        for (i = 0; i < 3; i++)
            if (host_word_is(word, names[i])) {
                header->format = i;
                return 0;
            }
    return bad_line(reader, "the format ascii, binary_little_endian or binary_big_endian");
}

static int read_element(const host_mesh_reader *reader, host_text *line, host_ply_header *header)
{
    host_ply_element *element = NULL;
    host_word name, number;
    int64_t count = 0;
    if (!host_text_word_in_line(line, &name) || !host_text_word_in_line(line, &number) ||
        !host_word_int(number, &count) || count < 0)
        return bad_line(reader, "an element's name and a count of 0 or more");
    if (header->n_elements == HOST_PLY_ELEMENTS_MAX)
        return bad_line(reader, "at most 16 elements");
    element = &header->element[header->n_elements++];
    memset(element, 0, sizeof *element);
    element->count = (uint64_t)count;
    element->line = (uint32_t)reader->number;
    if (host_word_is(name, "vertex"))
        element->kind = HOST_PLY_VERTEX;
    else if (host_word_is(name, "face"))
        element->kind = HOST_PLY_FACE;
    if (element->kind == HOST_PLY_VERTEX && count > (int64_t)SMR_VERTICES_MAX)
        return host_fail_at(reader->error, "header line", reader->number, "at most %u vertices, found %lld",
                            SMR_VERTICES_MAX, (long long)count);
    if (element->kind == HOST_PLY_FACE && count > (int64_t)SMR_TRIANGLES_MAX)
        return host_fail_at(reader->error, "header line", reader->number, "at most %u faces, found %lld",
                            SMR_TRIANGLES_MAX, (long long)count);
    return 0;
}

/* The role of a property: see host_ply_property. */
static int role_of(int kind, const host_ply_property *property, host_word name)
{
    const int is_list = property->count_type != HOST_TYPE_NONE;
    if (kind == HOST_PLY_VERTEX && !is_list && name.n == 1 && name.start[0] >= 'x' && name.start[0] <= 'z')
        return name.start[0] - 'x';
    if (kind == HOST_PLY_VERTEX && !is_list && name.n == 2 && name.start[0] == 'n' && name.start[1] >= 'x' &&
        name.start[1] <= 'z')
        return 3 + name.start[1] - 'x';
    if (kind == HOST_PLY_FACE && is_list &&
        (host_word_is(name, "vertex_indices") || host_word_is(name, "vertex_index")))
        return 0;
    return -1;
}

static int read_property(const host_mesh_reader *reader, host_text *line, host_ply_header *header)
{
    host_ply_element *element = NULL;
    host_ply_property *property = NULL;
    host_word word;
    if (header->n_elements == 0)
        return bad_line(reader, "an element before its properties");
    element = &header->element[header->n_elements - 1u];
    if (element->n_properties == HOST_PLY_PROPERTIES_MAX)
        return bad_line(reader, "at most 64 properties");
    property = &element->property[element->n_properties++];
    property->count_type = HOST_TYPE_NONE;
    if (!host_text_word_in_line(line, &word))
        return bad_line(reader, "a property's type and name");
    if (host_word_is(word, "list")) {
        property->count_type = host_text_word_in_line(line, &word) ? type_named(word) : HOST_TYPE_NONE;
        if (!is_whole(property->count_type))
            return bad_line(reader, "a whole-number type for the list's count");
        if (!host_text_word_in_line(line, &word))
            return bad_line(reader, "the type of the list's values");
        element->has_list = 1;
    }
    property->type = type_named(word);
    if (property->type == HOST_TYPE_NONE || !host_text_word_in_line(line, &word))
        return bad_line(reader, "a property's type (char, ..., double) and name");
    property->role = role_of(element->kind, property, word);
    if (element->kind == HOST_PLY_FACE && property->role == 0 && !is_whole(property->type))
        return bad_line(reader, "whole numbers as vertex indexes");
    element->row_bytes +=
        host_type_bytes(property->count_type == HOST_TYPE_NONE ? property->type : property->count_type);
    return 0;
}

/* Checks that an element has each role it needs exactly once. */
static int check_roles(const host_mesh_reader *reader, const host_ply_element *element)
{
    uint32_t found[6] = {0, 0, 0, 0, 0, 0};
    uint32_t i = 0;
    for (i = 0; i < element->n_properties; i++)
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
    uint32_t i = 0, n_vertex = 0, n_face = 0;
    size_t need = 0;
    /* the last value of a text needs no line end */
    const size_t slack = header->format == HOST_PLY_ASCII ? 1u : 0u;
    for (i = 0; i < header->n_elements; i++) {
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
    return bad_line(reader, "format, element, property, comment or end_header");
}

int host_ply_read_header(host_mesh_reader *reader, const unsigned char *data, size_t n, host_ply_header *header)
{
    host_text text = host_text_over(data, n);
    host_word whole;
    int done = 0;
    memset(header, 0, sizeof *header);
    header->format = -1;
    reader->number = 1;
    if (!host_text_line(&text, &whole) || !host_word_is(whole, "ply"))
        return bad_line(reader, "the word ply");
    while (done == 0) {
        /* With old Mac line ends a body byte of 10 after end_header is data, not a line end. */
        const char *const before = text.at;
        reader->number = text.line;
        if (!host_text_line(&text, &whole))
            return bad_line(reader, "end_header, but the file ends here");
        done = read_line(reader, whole, header);
        if (done == 1 && data[3] == '\r' && data[4] != '\n')
            text.at = before + whole.n + 1;
    }
    if (done < 0)
        return -1;
    header->lines = (uint32_t)reader->number;
    header->body = (const unsigned char *)text.at;
    if (header->format < 0)
        return bad_line(reader, "a format line before it");
    return check_claims(reader, header, n - (size_t)(header->body - data));
}
