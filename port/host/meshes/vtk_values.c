/* vtk_values.c: reads numbers of legacy VTK files.
 * SPDX-License-Identifier: MIT */
#include "meshes/vtk_values.h"

host_type host_vtk_type(host_word word)
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
    size_t i = 0;
    for (i = 0; i < sizeof names / sizeof names[0]; i++)
        if (host_word_is_nocase(word, names[i].name))
            return names[i].type;
    return HOST_TYPE_NONE;
}

int host_vtk_fail(host_vtk *vtk, const char *expected)
{
    return host_fail_at(vtk->reader->error, "line", vtk->text.line, "%s", expected);
}

int host_vtk_fits(const host_vtk *vtk, host_type type, uint64_t n)
{
    const size_t left = (size_t)(vtk->text.end - vtk->text.at);
    /* text: a digit and a space each, but for the last */
    return vtk->binary ? n <= left / host_type_bytes(type) : n <= (left + 1u) / 2u;
}

int host_vtk_value(host_vtk *vtk, host_type type, double *value)
{
    const host_mesh_reader *const reader = vtk->reader;
    host_word word;
    if (vtk->binary) {
        const size_t bytes = host_type_bytes(type);
        if ((size_t)(vtk->text.end - vtk->text.at) < bytes)
            return host_reader_truncated(reader);
        *value = host_type_read(type, (const unsigned char *)vtk->text.at, 1);
        vtk->text.at += bytes;
        return 0;
    }
    if (!host_text_word(&vtk->text, &word))
        return host_reader_truncated(reader);
    if (!host_word_double(word, value))
        return host_fail_at(reader->error, reader->unit, reader->number, "a number, found '%.*s'",
                            (int)(word.n < 40 ? word.n : 40), word.start);
    return 0;
}

int host_vtk_skip(host_vtk *vtk, host_type type, uint64_t n)
{
    double ignored = 0.0;
    if (!host_vtk_fits(vtk, type, n))
        return host_reader_truncated(vtk->reader);
    if (vtk->binary) {
        vtk->text.at += host_type_bytes(type) * (size_t)n;
        return 0;
    }
    for (; n > 0; n--)
        if (host_vtk_value(vtk, type, &ignored) != 0)
            return -1;
    return 0;
}

int host_vtk_count(host_vtk *vtk, const char *what, uint64_t *count)
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

int host_vtk_type_word(host_vtk *vtk, const char *what, host_type *type)
{
    host_word word;
    *type = HOST_TYPE_NONE;
    if (host_text_word_in_line(&vtk->text, &word))
        *type = host_vtk_type(word);
    return *type == HOST_TYPE_NONE ? host_vtk_fail(vtk, what) : 0;
}

void host_vtk_end_line(host_vtk *vtk)
{
    host_word rest;
    (void)host_text_line(&vtk->text, &rest);
}
