/* vtk_values.h: reads numbers of legacy VTK files, ASCII or binary (always big-endian).
 * SPDX-License-Identifier: MIT */
#ifndef VTK_VALUES_H
#define VTK_VALUES_H

#include "base/number_types.h"
#include "base/text_scan.h"
#include "meshes/mesh_reader.h"

typedef struct host_vtk {
    host_mesh_reader *reader;
    host_text text;
    int binary;
} host_vtk;

/* The type with this name ("float", "vtktypeint64", ...); HOST_TYPE_NONE when unknown. */
host_type host_vtk_type(host_word word);

/* 1 when the rest of the file can hold n values of the type. */
int host_vtk_fits(const host_vtk *vtk, host_type type, uint64_t n);

int host_vtk_value(host_vtk *vtk, host_type type, double *value);
int host_vtk_skip(host_vtk *vtk, host_type type, uint64_t n);

/* Reads the next word of the line as a count, 0 or more, that the file can hold. `what` names it in the error. */
int host_vtk_count(host_vtk *vtk, const char *what, uint64_t *count);

/* Reads the next word of the line as a type name. */
int host_vtk_type_word(host_vtk *vtk, const char *what, host_type *type);

/* Skips the rest of the line: binary data starts on the next. */
void host_vtk_end_line(host_vtk *vtk);

/* Fills the error of the current line. Returns -1. */
int host_vtk_fail(host_vtk *vtk, const char *expected);

#endif
