/* mesh.c: checks of triangle meshes, and vertex normals and areas.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/mesh.h"
#include "base/bytes.h"
#include "geometry/box_tree/triangle.h"

smr_status smr_mesh_check(const smr_mesh *mesh)
{
    if (mesh == NULL || mesh->xyz == NULL || (mesh->triangles == NULL && mesh->n_triangles > 0u))
        return SMR_E_NULL;
    if (mesh->n_vertices == 0u || mesh->n_vertices > SMR_VERTICES_MAX || mesh->n_triangles > SMR_TRIANGLES_MAX)
        return SMR_E_INPUT;
    int legal = smr_all_within(mesh->xyz, 3u * (size_t)mesh->n_vertices, SMR_COORD_MAX);
    for (size_t i = 0; i < 3u * (size_t)mesh->n_triangles; i++)
        legal &= mesh->triangles[i] < mesh->n_vertices;
    return legal ? SMR_OK : SMR_E_INPUT;
}

void smr_mesh_add_normals(const float *xyz, const uint32_t *triangle, uint32_t n_vertices, uint32_t first,
                          uint32_t last, float *normal, float *area)
{
    for (uint32_t k = first; k < last; k++) {
        const uint32_t *t = smr_triangle_of(triangle, k, n_vertices);
        const smr_vec n = smr_corners_cross(xyz, t);
        const float third = smr_length(n) * (1.0f / 6.0f);
        for (uint32_t c = 0; c < 3u; c++) {
            smr_add3(normal, t[c], n);
            if (area != NULL)
                area[t[c]] += third;
        }
    }
}

void smr_mesh_normals(const smr_mesh *mesh, float *normal, float *area)
{
    memset(normal, 0, 3u * (size_t)mesh->n_vertices * sizeof *normal);
    if (area != NULL)
        memset(area, 0, mesh->n_vertices * sizeof *area);
    smr_mesh_add_normals(mesh->xyz, mesh->triangles, mesh->n_vertices, 0, mesh->n_triangles, normal, area);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        smr_put3(normal, i, smr_unit(smr_get3(normal, i)));
}

/* Returns the hash of the edge from a to b; the edge from b to a has the opposite hash. */
static uint64_t edge(uint32_t a, uint32_t b)
{
    const uint64_t mixed = a < b ? smr_mix((uint64_t)a << 32 | b) : smr_mix((uint64_t)b << 32 | a);
    return a == b ? 0u : a < b ? mixed : 0u - mixed;
}

uint64_t smr_mesh_edges(const uint32_t *triangle, uint32_t n_triangles)
{
    uint64_t sum = 0;
    for (size_t k = 0; k < n_triangles; k++) {
        const uint32_t *t = triangle + 3u * k;
        sum += edge(t[0], t[1]) + edge(t[1], t[2]) + edge(t[2], t[0]);
    }
    return sum;
}
