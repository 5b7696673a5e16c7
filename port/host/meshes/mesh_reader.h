/* What the readers of the single formats share: the mesh under construction, and numbers out of bytes.
 * SPDX-License-Identifier: MIT */
#ifndef MESH_READER_H
#define MESH_READER_H

#include <stddef.h>
#include <stdint.h>

#include "meshes/triangle_mesh.h"

/* A mesh being read. `unit` and `number` say where the reader is, for the error line. */
typedef struct host_mesh_reader {
    host_mesh *mesh;
    host_error *error;
    const char *unit; /* "vertex", "face", "line" */
    uint64_t number;
    size_t vertex_capacity, triangle_capacity;
    int ras; /* 1: the file says SPACE=RAS */
} host_mesh_reader;

/* Room for so many vertices or triangles in all. The counts must come from the file's size. */
int host_reader_reserve(host_mesh_reader *reader, size_t vertices, size_t triangles);

/* Adds one vertex; refuses what is not finite or too large. */
int host_reader_vertex(host_mesh_reader *reader, const double *xyz);

/* Adds one triangle; the indexes are checked by the caller. */
int host_reader_triangle(host_mesh_reader *reader, uint32_t a, uint32_t b, uint32_t c);

/* Adds the next index of a polygon as part of a fan. state[0] is the number of indexes so far. */
int host_reader_fan(host_mesh_reader *reader, uint32_t state[3], uint32_t index);

/* The error of a file that ends too early. */
int host_reader_ended(const host_mesh_reader *reader);

/* The readers. data holds the whole file. */
int host_read_ply(host_mesh_reader *reader, const unsigned char *data, size_t n);
int host_read_stl(host_mesh_reader *reader, const unsigned char *data, size_t n);
int host_read_obj(host_mesh_reader *reader, const unsigned char *data, size_t n);
int host_read_vtk(host_mesh_reader *reader, const unsigned char *data, size_t n);

/* Whether data of this size is a binary STL file by its own count. */
int host_is_binary_stl(const unsigned char *head, size_t n, size_t total);

#endif
