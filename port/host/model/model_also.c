/* model_also.c: shapes of further subjects: directories of results of the same model, files named as its structures.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/file_names.h"
#include "model/model_from_files.h"

/* Appends one structure of a result; its vertices and triangles must be the model's. */
static int add_part(const char *path, const host_part *part, host_mesh *all, host_error *error)
{
    host_mesh mesh = {0};
    if (host_mesh_read(path, HOST_MESH_POINTS_TOO, HOST_MIRROR_NONE, &mesh, error) != 0)
        return -1;
    int result = 0;
    if (mesh.n_vertices != part->mesh.n_vertices || mesh.n_triangles != part->mesh.n_triangles ||
        (mesh.n_triangles > 0 && memcmp(mesh.triangles, part->mesh.triangles, 12u * (size_t)mesh.n_triangles) != 0))
        result = host_fail(error, part->name, "the vertices and triangles of the model: a result of registering it");
    else if (host_mesh_append(all, &mesh) != 0)
        result = host_fail(error, part->name, "free memory");
    host_mesh_free(&mesh);
    return result;
}

int host_also_read(const host_model *model, const host_files *directories, host_mesh *all, host_error *error)
{
    int result = 0;
    error->file = "--also";
    if (directories->n >= SMR_REFERENCES_MAX)
        return host_fail(error, "value", "at most %u directories", SMR_REFERENCES_MAX - 1u);
    for (uint32_t k = 0; k < directories->n; k++)
        for (uint32_t i = 0; result == 0 && i < model->n_parts; i++) {
            char name[SMR_NAME_BYTES + 4u];
            (void)snprintf(name, sizeof name, "%s.ply", model->part[i].name);
            char *const path = host_path_in(directories->path[k], name);
            error->file = directories->path[k];
            result = path == NULL ? host_fail(error, name, "free memory") : add_part(path, &model->part[i], all, error);
            if (result != 0)
                error->file = directories->path[k]; /* the path is freed */
            free(path);
        }
    return result;
}
