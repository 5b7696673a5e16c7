/* mesh_write.c: triangle meshes in memory, and to files.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "meshes/triangle_mesh.h"

static const char *const extensions[] = {".ply", ".stl", ".vtk", ".obj", ".ply", ".vtk"}; /* [HOST_FORMAT_...] */

const char *host_format_extension(int format) { return extensions[format]; }

int host_format_of(const char *path)
{
    int format = HOST_FORMAT_PLY;
    while (format <= HOST_FORMAT_OBJ && !host_has_extension(path, extensions[format]))
        format++;
    return format <= HOST_FORMAT_OBJ ? format : -1;
}

/* Vertices as lines of text, behind a word. */
static void put_vertices(const host_mesh *mesh, const char *word, host_buffer *buffer)
{
    for (size_t i = 0; i < mesh->n_vertices; i++)
        host_buffer_print(buffer, "%s%.9g %.9g %.9g\n", word, (double)mesh->xyz[3u * i], (double)mesh->xyz[3u * i + 1u],
                          (double)mesh->xyz[3u * i + 2u]);
}

/* Likewise triangles; first: the number of the first vertex. */
static void put_triangles(const host_mesh *mesh, const char *word, uint32_t first, host_buffer *buffer)
{
    for (size_t i = 0; i < mesh->n_triangles; i++)
        host_buffer_print(buffer, "%s %u %u %u\n", word, mesh->triangles[3u * i] + first,
                          mesh->triangles[3u * i + 1u] + first, mesh->triangles[3u * i + 2u] + first);
}

static void write_ply_faces(const host_mesh *mesh, host_buffer *buffer)
{
    for (size_t i = 0; i < 3u * (size_t)mesh->n_triangles; i++) {
        host_buffer_add(buffer, "\003", i % 3u == 0 ? 1 : 0);
        host_buffer_u32(buffer, mesh->triangles[i]);
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

static void write_ply_ascii(const host_mesh *mesh, host_buffer *buffer)
{
    write_ply_header(mesh, 1, "", buffer);
    put_vertices(mesh, "", buffer);
    put_triangles(mesh, "3", 0, buffer);
}

static void write_ply(const host_mesh *mesh, host_buffer *buffer)
{
    write_ply_header(mesh, 0, "", buffer);
    (void)host_buffer_reserve(buffer, 12u * (size_t)mesh->n_vertices + 13u * (size_t)mesh->n_triangles);
    for (size_t i = 0; i < 3u * (size_t)mesh->n_vertices; i++)
        host_buffer_f32(buffer, mesh->xyz[i]);
    write_ply_faces(mesh, buffer);
}

static void write_ply_judged(const host_mesh *mesh, const host_vertex_values *values, host_buffer *buffer)
{
    write_ply_header(mesh, 0,
                     "property uchar seen\nproperty float expected_error\nproperty float local_volume\n"
                     "property float expected_across\nproperty float expected_along\n",
                     buffer);
    (void)host_buffer_reserve(buffer, 29u * (size_t)mesh->n_vertices + 13u * (size_t)mesh->n_triangles);
    for (size_t i = 0; i < mesh->n_vertices; i++) {
        for (size_t k = 0; k < 3; k++)
            host_buffer_f32(buffer, mesh->xyz[3u * i + k]);
        host_buffer_add(buffer, values->seen + i, 1);
        host_buffer_f32(buffer, values->expected_error[i]);
        host_buffer_f32(buffer, values->local_volume[i]);
        host_buffer_f32(buffer, values->across[i]);
        host_buffer_f32(buffer, values->along[i]);
    }
    write_ply_faces(mesh, buffer);
}

void host_mesh_write_coloured(const host_mesh *mesh, const unsigned char colour[3], host_buffer *buffer)
{
    write_ply_header(mesh, 0, "property uchar red\nproperty uchar green\nproperty uchar blue\n", buffer);
    (void)host_buffer_reserve(buffer, 15u * (size_t)mesh->n_vertices + 13u * (size_t)mesh->n_triangles);
    for (size_t i = 0; i < mesh->n_vertices; i++) {
        for (size_t k = 0; k < 3; k++)
            host_buffer_f32(buffer, mesh->xyz[3u * i + k]);
        host_buffer_add(buffer, colour, 3);
    }
    write_ply_faces(mesh, buffer);
}

/* The normal is written as zero: readers of the format compute it from the vertices. */
static void write_stl(const host_mesh *mesh, host_buffer *buffer)
{
    static const char title[80] = "smr SPACE=LPS units mm";
    host_buffer_add(buffer, title, sizeof title);
    host_buffer_u32(buffer, mesh->n_triangles);
    for (size_t i = 0; i < mesh->n_triangles; i++) {
        for (size_t k = 0; k < 3; k++)
            host_buffer_f32(buffer, 0.0f);
        for (size_t k = 0; k < 9; k++)
            host_buffer_f32(buffer, mesh->xyz[3u * (size_t)mesh->triangles[3u * i + k / 3u] + k % 3u]);
        host_buffer_add(buffer, "\0", 2);
    }
}

static void write_obj(const host_mesh *mesh, host_buffer *buffer)
{
    host_buffer_print(buffer, "# SPACE=LPS, units mm\n");
    put_vertices(mesh, "v ", buffer);
    put_triangles(mesh, "f", 1, buffer);
}

static void write_vtk_ascii(const host_mesh *mesh, host_buffer *buffer)
{
    host_buffer_print(buffer,
                      "# vtk DataFile Version 3.0\nsmr SPACE=LPS units mm\nASCII\nDATASET POLYDATA\n"
                      "POINTS %u float\n",
                      mesh->n_vertices);
    put_vertices(mesh, "", buffer);
    if (mesh->n_triangles > 0)
        host_buffer_print(buffer, "POLYGONS %u %zu\n", mesh->n_triangles, 4u * (size_t)mesh->n_triangles);
    put_triangles(mesh, "3", 0, buffer);
}

static void put_big(host_buffer *buffer, uint32_t value)
{
    const unsigned char b[4] = {(unsigned char)(value >> 24), (unsigned char)(value >> 16 & 255u),
                                (unsigned char)(value >> 8 & 255u), (unsigned char)(value & 255u)};
    host_buffer_add(buffer, b, 4);
}

static void put_big_floats(host_buffer *buffer, const float *values, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t bits = 0;
        memcpy(&bits, &values[i], 4);
        put_big(buffer, bits);
    }
    host_buffer_add(buffer, "\n", 1);
}

static void write_vtk(const host_mesh *mesh, host_buffer *buffer)
{
    host_buffer_print(buffer,
                      "# vtk DataFile Version 4.2\nsmr SPACE=LPS units mm\nBINARY\nDATASET POLYDATA\nPOINTS %u float\n",
                      mesh->n_vertices);
    (void)host_buffer_reserve(buffer, 12u * (size_t)mesh->n_vertices + 16u * (size_t)mesh->n_triangles + 100u);
    put_big_floats(buffer, mesh->xyz, 3u * (size_t)mesh->n_vertices);
    if (mesh->n_triangles == 0)
        return;
    host_buffer_print(buffer, "POLYGONS %u %zu\n", mesh->n_triangles, 4u * (size_t)mesh->n_triangles);
    for (size_t i = 0; i < 3u * (size_t)mesh->n_triangles; i++) {
        if (i % 3u == 0)
            put_big(buffer, 3u);
        put_big(buffer, mesh->triangles[i]);
    }
    host_buffer_add(buffer, "\n", 1);
}

static void write_vtk_values(const host_mesh *mesh, const host_vertex_values *values, host_buffer *buffer)
{
    const size_t n = mesh->n_vertices;
    host_buffer_print(buffer, "POINT_DATA %zu\nSCALARS expected_error float 1\nLOOKUP_TABLE default\n", n);
    put_big_floats(buffer, values->expected_error, n);
    host_buffer_print(buffer, "SCALARS expected_across float 1\nLOOKUP_TABLE default\n");
    put_big_floats(buffer, values->across, n);
    host_buffer_print(buffer, "SCALARS expected_along float 1\nLOOKUP_TABLE default\n");
    put_big_floats(buffer, values->along, n);
    host_buffer_print(buffer, "SCALARS local_volume float 1\nLOOKUP_TABLE default\n");
    put_big_floats(buffer, values->local_volume, n);
    host_buffer_print(buffer, "SCALARS seen unsigned_char 1\nLOOKUP_TABLE default\n");
    host_buffer_add(buffer, values->seen, n);
    host_buffer_print(buffer, "\nVECTORS displacement float\n");
    put_big_floats(buffer, values->displacement, 3u * n);
}

void host_mesh_write_judged(const host_mesh *mesh, int format, const host_vertex_values *values, host_buffer *buffer)
{
    if (format == HOST_FORMAT_PLY)
        write_ply_judged(mesh, values, buffer);
    else
        host_mesh_write(mesh, format, buffer);
    if (format == HOST_FORMAT_VTK)
        write_vtk_values(mesh, values, buffer);
}

void host_mesh_write(const host_mesh *mesh, int format, host_buffer *buffer)
{
    switch (format) {
    case HOST_FORMAT_STL: write_stl(mesh, buffer); break;
    case HOST_FORMAT_OBJ: write_obj(mesh, buffer); break;
    case HOST_FORMAT_VTK: write_vtk(mesh, buffer); break;
    case HOST_FORMAT_VTK_ASCII: write_vtk_ascii(mesh, buffer); break;
    case HOST_FORMAT_PLY_ASCII: write_ply_ascii(mesh, buffer); break;
    default: write_ply(mesh, buffer);
    }
}

void host_mesh_negate(host_mesh *mesh, int axis)
{
    for (size_t i = (size_t)axis; i < 3u * (size_t)mesh->n_vertices; i += 3u) {
        mesh->xyz[i] = -mesh->xyz[i];
        if (mesh->normals != NULL)
            mesh->normals[i] = -mesh->normals[i];
    }
}

void host_mesh_mirror(host_mesh *mesh, int axis)
{
    host_mesh_negate(mesh, axis);
    for (size_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t second = mesh->triangles[3u * i + 1u];
        mesh->triangles[3u * i + 1u] = mesh->triangles[3u * i + 2u];
        mesh->triangles[3u * i + 2u] = second;
    }
}

void host_mesh_free(host_mesh *mesh)
{
    free(mesh->xyz);
    free(mesh->triangles);
    free(mesh->normals);
    memset(mesh, 0, sizeof *mesh);
}

smr_mesh host_mesh_view(const host_mesh *mesh)
{
    return (smr_mesh){mesh->xyz, mesh->n_triangles > 0 ? mesh->triangles : NULL, mesh->n_vertices, mesh->n_triangles};
}

/* Joins normals, which both must have. Called before the vertices are joined. */
static int append_normals(host_mesh *whole, const host_mesh *part)
{
    const size_t before = whole->n_vertices, more = part->n_vertices;
    if (part->normals == NULL || (before > 0 && whole->normals == NULL)) {
        free(whole->normals);
        whole->normals = NULL;
        return 0;
    }
    float *grown = realloc(whole->normals, 12u * (before + more) + 1u);
    if (grown == NULL)
        return -1;
    memcpy(grown + 3u * before, part->normals, 12u * more);
    whole->normals = grown;
    return 0;
}

int host_mesh_append(host_mesh *whole, const host_mesh *part)
{
    const size_t vertices = (size_t)whole->n_vertices + part->n_vertices;
    const size_t triangles = (size_t)whole->n_triangles + part->n_triangles;
    const uint32_t first = whole->n_vertices;
    if (vertices > SMR_VERTICES_MAX || triangles > SMR_TRIANGLES_MAX)
        return -1;
    if (append_normals(whole, part) != 0)
        return -1;
    float *xyz = realloc(whole->xyz, 12u * vertices + 1u);
    if (xyz == NULL)
        return -1;
    whole->xyz = xyz;
    uint32_t *rows = realloc(whole->triangles, 12u * triangles + 1u);
    if (rows == NULL)
        return -1;
    whole->triangles = rows;
    if (part->n_vertices > 0)
        memcpy(xyz + 3u * (size_t)first, part->xyz, 12u * (size_t)part->n_vertices);
    for (size_t i = 0; i < 3u * (size_t)part->n_triangles; i++)
        rows[3u * (size_t)whole->n_triangles + i] = part->triangles[i] + first;
    whole->n_vertices = (uint32_t)vertices;
    whole->n_triangles = (uint32_t)triangles;
    return 0;
}

static int by_vertex(const void *a, const void *b)
{
    const host_half_edge *const x = a, *const y = b;
    const int other = (x->other > y->other) - (x->other < y->other);
    return other != 0 ? other : (x->side > y->side) - (x->side < y->side);
}

static void group(const smr_mesh *mesh, host_half_edges *edges)
{
    size_t *const first = edges->first;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < 3u * (size_t)mesh->n_triangles; i++) {
            const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
            const uint32_t low = a < b ? a : b;
            if (a == b)
                continue;
            if (pass == 0) {
                first[low + 2u]++;
            } else {
                host_half_edge *const to = &edges->edge[first[low + 1u]++];
                to->other = a < b ? b : a;
                to->side = (uint32_t)i;
            }
        }
        for (size_t v = 2; pass == 0 && v < (size_t)mesh->n_vertices + 2u; v++)
            first[v] += first[v - 1u];
    }
}

int host_half_edges_make(const smr_mesh *mesh, host_half_edges *edges)
{
    edges->first = calloc((size_t)mesh->n_vertices + 2u, sizeof *edges->first);
    edges->edge = malloc(3u * (size_t)mesh->n_triangles * sizeof *edges->edge + 1u);
    if (edges->first == NULL || edges->edge == NULL) {
        host_half_edges_free(edges);
        return -1;
    }
    group(mesh, edges);
    for (size_t v = 0; v < mesh->n_vertices; v++)
        qsort(edges->edge + edges->first[v], edges->first[v + 1u] - edges->first[v], sizeof *edges->edge, by_vertex);
    return 0;
}

void host_half_edges_free(host_half_edges *edges)
{
    free(edges->first);
    free(edges->edge);
    memset(edges, 0, sizeof *edges);
}
