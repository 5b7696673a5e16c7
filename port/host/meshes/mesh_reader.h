/* mesh_reader.h: shared by the readers of mesh formats: adds vertices and triangles to the mesh being read.
 * SPDX-License-Identifier: MIT */
#ifndef MESH_READER_H
#define MESH_READER_H

#include "meshes/triangle_mesh.h"

/* A mesh being read. `unit` and `number` are the reader's place in the file, for the error line. */
typedef struct host_mesh_reader {
    host_mesh *mesh;
    host_error *error;
    const char *unit; /* "vertex", "face", "line" */
    uint64_t number;
    size_t vertex_capacity, triangle_capacity;
    size_t n_normals, normal_capacity;
    int cloud; /* 1: normals of points are wanted */
    int ras;   /* 1: the file says SPACE=RAS */
} host_mesh_reader;

/* Reserves memory for a total of vertices and triangles. The numbers must be bounded by the file's size. */
int host_reader_reserve(host_mesh_reader *reader, size_t vertices, size_t triangles);

/* Adds one vertex. Refuses coordinates that are not finite or too large. */
int host_reader_vertex(host_mesh_reader *reader, const double *xyz);

/* Adds the next point's normal, where wanted. One that is no direction becomes 0. */
int host_reader_normal(host_mesh_reader *reader, const double *normal);

/* Numbers of a file, as text or binary. */
typedef struct host_numbers {
    host_mesh_reader *reader;
    host_text text; /* where reading is, in binary files as well */
    int binary, big_endian;
} host_numbers;

/* Reads one number, an index of one of n vertices, or three numbers. type: of binary files. */
int host_numbers_value(host_numbers *from, host_type type, double *value);
int host_numbers_index(host_numbers *from, host_type type, uint64_t n, uint32_t *index);
int host_numbers_three(host_numbers *from, host_type type, double value[3]);

/* 1 when the rest of the file can hold n numbers of the type. */
int host_numbers_fit(const host_numbers *from, host_type type, uint64_t n);
int host_numbers_skip(host_numbers *from, host_type type, uint64_t n);

/* Fills the error at the reader's place. Returns -1. */
int host_reader_fail(const host_mesh_reader *reader, const char *expected, ...) HOST_PRINTF(2, 3);

/* Adds one triangle. The caller checks the indexes. */
int host_reader_triangle(host_mesh_reader *reader, uint32_t a, uint32_t b, uint32_t c);

/* Adds the next vertex of a polygon, which becomes a fan of triangles. state: zeros at the start of each polygon;
 * state[0]: number of indexes so far. */
int host_reader_fan(host_mesh_reader *reader, uint32_t state[3], uint32_t index);

/* Fills the error of a file that ends too early. Returns -1. */
int host_reader_truncated(const host_mesh_reader *reader);

/* The readers of the formats. data: the whole file, n bytes. */
int host_read_ply(host_mesh_reader *reader, const unsigned char *data, size_t n);
int host_read_stl(host_mesh_reader *reader, const unsigned char *data, size_t n);
int host_read_obj(host_mesh_reader *reader, const unsigned char *data, size_t n);
int host_read_csv(host_mesh_reader *reader, const unsigned char *data, size_t n);
int host_read_vtk(host_mesh_reader *reader, const unsigned char *data, size_t n);

/* 1 when a binary STL file with the head's number of triangles has exactly `total` bytes. */
int host_is_binary_stl(const unsigned char *head, size_t n, size_t total);

/* 1 when the head's first word is "solid", regardless of case. */
int host_is_ascii_stl(const unsigned char *head, size_t n);

#endif
