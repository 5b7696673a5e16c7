/* register_surfaces.c: the content of the result's surface files, in the format of --format.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "register/register_job.h"

int host_job_check_format(const host_job *job, host_error *error)
{
    uint32_t i = 0;
    for (i = 0; i < job->model.n_parts && job->options->format == HOST_FORMAT_STL; i++)
        if (job->model.part[i].mesh.n_triangles == 0) {
            error->file = "--format";
            return host_fail(error, "stl", "triangles in each structure, %.100s has points only",
                             job->model.part[i].name);
        }
    return 0;
}

/* How far each vertex is from where it was in the model. */
static int fill_displacement(const host_job *job, uint32_t part, float *displacement)
{
    const host_mesh *const mesh = &job->result[part].mesh;
    size_t i = 0;
    if (smr_model_mesh(job->model.model, part, displacement, NULL) != SMR_OK)
        return -1;
    for (i = 0; i < 3u * (size_t)mesh->n_vertices; i++)
        displacement[i] = mesh->xyz[i] - displacement[i];
    return 0;
}

/* What is known of the vertices. Where the start was kept that is of what was rejected: nothing of these. */
static int fill_known(const host_job *job, uint32_t part, unsigned char *seen, float *expected, float *volume)
{
    uint32_t i = 0;
    if (smr_get_visible(job->state, part, seen) != SMR_OK ||
        smr_get_expected_error(job->state, part, expected) != SMR_OK ||
        smr_get_local_volume(job->state, part, 0, volume) != SMR_OK)
        return -1;
    for (i = 0; job->kept_start && i < job->result[part].mesh.n_vertices; i++) {
        seen[i] = 0;
        expected[i] = -1.0f;
        volume[i] = 1.0f;
    }
    return 0;
}

static void write_judged(const host_job *job, uint32_t part, host_buffer *buffer)
{
    const host_mesh *const mesh = &job->result[part].mesh;
    float *const expected = malloc((mesh->n_vertices + 1u) * sizeof *expected);
    float *const displacement = malloc((mesh->n_vertices + 1u) * 3u * sizeof *displacement);
    unsigned char *const seen = malloc(mesh->n_vertices + 1u);
    float *const volume = malloc((mesh->n_vertices + 1u) * sizeof *volume);
    const host_vertex_values values = {seen, expected, displacement, volume};
    if (expected == NULL || displacement == NULL || seen == NULL || volume == NULL ||
        fill_known(job, part, seen, expected, volume) != 0 || fill_displacement(job, part, displacement) != 0)
        buffer->failed = 1;
    else
        host_mesh_write_judged(mesh, (int)job->options->format, &values, buffer);
    free(expected);
    free(displacement);
    free(seen);
    free(volume);
}

void host_job_surface(const host_job *job, uint32_t part, host_buffer *buffer)
{
    if (job->options->vertex_errors)
        write_judged(job, part, buffer);
    else
        host_mesh_write(&job->result[part].mesh, (int)job->options->format, buffer);
}
