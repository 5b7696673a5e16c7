/* triangle_mesh.c: mirrors, joins and frees meshes in memory.
 * SPDX-License-Identifier: MIT */
#include "meshes/triangle_mesh.h"

#include <stdlib.h>
#include <string.h>

void host_mesh_mirror(host_mesh *mesh, int axis)
{
    size_t i = 0;
    for (i = 0; i < mesh->n_vertices; i++)
        mesh->xyz[3u * i + (size_t)axis] = -mesh->xyz[3u * i + (size_t)axis];
    for (i = 0; mesh->normals != NULL && i < mesh->n_vertices; i++)
        mesh->normals[3u * i + (size_t)axis] = -mesh->normals[3u * i + (size_t)axis];
    for (i = 0; i < mesh->n_triangles; i++) {
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
    smr_mesh view;
    view.xyz = mesh->xyz;
    view.triangles = mesh->n_triangles > 0 ? mesh->triangles : NULL;
    view.n_vertices = mesh->n_vertices;
    view.n_triangles = mesh->n_triangles;
    return view;
}

/* Joins normals, which both must have. Called before the vertices are joined. */
static int append_normals(host_mesh *whole, const host_mesh *part)
{
    const size_t before = whole->n_vertices, more = part->n_vertices;
    float *grown = NULL;
    if (part->normals == NULL || (before > 0 && whole->normals == NULL)) {
        free(whole->normals);
        whole->normals = NULL;
        return 0;
    }
    grown = realloc(whole->normals, 12u * (before + more) + 1u);
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
    float *xyz = NULL;
    uint32_t *rows = NULL;
    size_t i = 0;
    if (vertices > SMR_VERTICES_MAX || triangles > SMR_TRIANGLES_MAX)
        return -1;
    if (append_normals(whole, part) != 0)
        return -1;
    xyz = realloc(whole->xyz, 12u * vertices + 1u);
    if (xyz == NULL)
        return -1;
    whole->xyz = xyz;
    rows = realloc(whole->triangles, 12u * triangles + 1u);
    if (rows == NULL)
        return -1;
    whole->triangles = rows;
    if (part->n_vertices > 0)
        memcpy(xyz + 3u * (size_t)first, part->xyz, 12u * (size_t)part->n_vertices);
    for (i = 0; i < 3u * (size_t)part->n_triangles; i++)
        rows[3u * (size_t)whole->n_triangles + i] = part->triangles[i] + first;
    whole->n_vertices = (uint32_t)vertices;
    whole->n_triangles = (uint32_t)triangles;
    return 0;
}
