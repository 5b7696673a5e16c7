/* mesh_write.c: writes meshes. Text formats have nine significant digits, so that reading gives the same floats.
 * SPDX-License-Identifier: MIT */
#include <string.h>

#include "meshes/triangle_mesh.h"

static void write_ply_faces(const host_mesh *mesh, int ascii, host_buffer *buffer)
{
    size_t i = 0, k = 0;
    for (i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *const t = mesh->triangles + 3u * i;
        if (ascii) {
            host_buffer_print(buffer, "3 %u %u %u\n", t[0], t[1], t[2]);
        } else {
            host_buffer_add(buffer, "\003", 1);
            for (k = 0; k < 3; k++)
                host_buffer_u32(buffer, t[k]);
        }
    }
}

/* more: further properties of a vertex, a line each. */
static void write_ply_header(const host_mesh *mesh, int ascii, const char *more, host_buffer *buffer)
{
    host_buffer_print(buffer,
                      "ply\nformat %s 1.0\ncomment SPACE=LPS\ncomment units mm\nelement vertex %u\n"
                      "property float x\nproperty float y\nproperty float z\n%selement face %u\n"
                      "property list uchar int vertex_indices\nend_header\n",
                      ascii ? "ascii" : "binary_little_endian", mesh->n_vertices, more, mesh->n_triangles);
}

static void write_ply(const host_mesh *mesh, int ascii, host_buffer *buffer)
{
    size_t i = 0, k = 0;
    write_ply_header(mesh, ascii, "", buffer);
    (void)host_buffer_reserve(buffer, 12u * (size_t)mesh->n_vertices + 13u * (size_t)mesh->n_triangles);
    for (i = 0; i < mesh->n_vertices; i++) {
        const float *const x = mesh->xyz + 3u * i;
        if (ascii)
            host_buffer_print(buffer, "%.9g %.9g %.9g\n", (double)x[0], (double)x[1], (double)x[2]);
        else
            for (k = 0; k < 3; k++)
                host_buffer_f32(buffer, x[k]);
    }
    write_ply_faces(mesh, ascii, buffer);
}

void host_mesh_write_judged(const host_mesh *mesh, const unsigned char *seen, const float *expected_error,
                            host_buffer *buffer)
{
    size_t i = 0, k = 0;
    write_ply_header(mesh, 0, "property uchar seen\nproperty float expected_error\n", buffer);
    (void)host_buffer_reserve(buffer, 17u * (size_t)mesh->n_vertices + 13u * (size_t)mesh->n_triangles);
    for (i = 0; i < mesh->n_vertices; i++) {
        for (k = 0; k < 3; k++)
            host_buffer_f32(buffer, mesh->xyz[3u * i + k]);
        host_buffer_add(buffer, seen + i, 1);
        host_buffer_f32(buffer, expected_error[i]);
    }
    write_ply_faces(mesh, 0, buffer);
}

void host_mesh_write_coloured(const host_mesh *mesh, const unsigned char colour[3], host_buffer *buffer)
{
    size_t i = 0, k = 0;
    write_ply_header(mesh, 0, "property uchar red\nproperty uchar green\nproperty uchar blue\n", buffer);
    (void)host_buffer_reserve(buffer, 15u * (size_t)mesh->n_vertices + 13u * (size_t)mesh->n_triangles);
    for (i = 0; i < mesh->n_vertices; i++) {
        for (k = 0; k < 3; k++)
            host_buffer_f32(buffer, mesh->xyz[3u * i + k]);
        host_buffer_add(buffer, colour, 3);
    }
    write_ply_faces(mesh, 0, buffer);
}

/* The normal is written as zero: readers of the format compute it from the vertices. */
static void write_stl(const host_mesh *mesh, host_buffer *buffer)
{
    static const char title[80] = "smr SPACE=LPS units mm";
    size_t i = 0, k = 0;
    host_buffer_add(buffer, title, sizeof title);
    host_buffer_u32(buffer, mesh->n_triangles);
    for (i = 0; i < mesh->n_triangles; i++) {
        for (k = 0; k < 3; k++)
            host_buffer_f32(buffer, 0.0f);
        for (k = 0; k < 9; k++)
            host_buffer_f32(buffer, mesh->xyz[3u * (size_t)mesh->triangles[3u * i + k / 3u] + k % 3u]);
        host_buffer_add(buffer, "\0", 2);
    }
}

static void write_obj(const host_mesh *mesh, host_buffer *buffer)
{
    size_t i = 0;
    host_buffer_print(buffer, "# SPACE=LPS, units mm\n");
    for (i = 0; i < mesh->n_vertices; i++)
        host_buffer_print(buffer, "v %.9g %.9g %.9g\n", (double)mesh->xyz[3u * i], (double)mesh->xyz[3u * i + 1u],
                          (double)mesh->xyz[3u * i + 2u]);
    for (i = 0; i < mesh->n_triangles; i++)
        host_buffer_print(buffer, "f %u %u %u\n", mesh->triangles[3u * i] + 1u, mesh->triangles[3u * i + 1u] + 1u,
                          mesh->triangles[3u * i + 2u] + 1u);
}

static void write_vtk(const host_mesh *mesh, host_buffer *buffer)
{
    size_t i = 0;
    host_buffer_print(buffer,
                      "# vtk DataFile Version 3.0\nsmr SPACE=LPS units mm\nASCII\nDATASET POLYDATA\n"
                      "POINTS %u float\n",
                      mesh->n_vertices);
    for (i = 0; i < mesh->n_vertices; i++)
        host_buffer_print(buffer, "%.9g %.9g %.9g\n", (double)mesh->xyz[3u * i], (double)mesh->xyz[3u * i + 1u],
                          (double)mesh->xyz[3u * i + 2u]);
    if (mesh->n_triangles > 0)
        host_buffer_print(buffer, "POLYGONS %u %zu\n", mesh->n_triangles, 4u * (size_t)mesh->n_triangles);
    for (i = 0; i < mesh->n_triangles; i++)
        host_buffer_print(buffer, "3 %u %u %u\n", mesh->triangles[3u * i], mesh->triangles[3u * i + 1u],
                          mesh->triangles[3u * i + 2u]);
}

void host_mesh_write(const host_mesh *mesh, int format, host_buffer *buffer)
{
    if (format == HOST_FORMAT_STL)
        write_stl(mesh, buffer);
    else if (format == HOST_FORMAT_OBJ)
        write_obj(mesh, buffer);
    else if (format == HOST_FORMAT_VTK)
        write_vtk(mesh, buffer);
    else
        write_ply(mesh, format == HOST_FORMAT_PLY_ASCII, buffer);
}
