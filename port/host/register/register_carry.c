/* register_carry.c: what points, fields and volumes are carried by.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "carry/carry_file.h"
#include "register/register_job.h"

/* Rest and present positions, structures in a row. */
static int fill(const host_job *job, host_carry_shape *shape)
{
    uint32_t i = 0;
    size_t at = 0;
    shape->n_vertices = job->model.info.n_vertices;
    shape->n_structures = job->model.n_parts;
    shape->mirror = job->options->mirror_model;
    shape->name = calloc(shape->n_structures, sizeof *shape->name);
    shape->count = calloc(shape->n_structures, sizeof *shape->count);
    shape->rest = malloc(3u * sizeof(float) * shape->n_vertices);
    shape->now = malloc(3u * sizeof(float) * shape->n_vertices);
    if (shape->name == NULL || shape->count == NULL || shape->rest == NULL || shape->now == NULL)
        return -1;
    for (i = 0; i < job->model.n_parts; at += 3u * (size_t)shape->count[i], i++) {
        (void)snprintf(shape->name[i], SMR_NAME_BYTES, "%s", job->model.part[i].name);
        shape->count[i] = job->model.part[i].mesh.n_vertices;
        if (smr_model_mesh(job->model.model, i, shape->rest + at, NULL) != SMR_OK ||
            smr_get_positions(job->state, i, shape->now + at) != SMR_OK)
            return -1;
        if (job->kept_start) /* what is written is not what was found */
            memcpy(shape->now + at, job->result[i].mesh.xyz, 3u * sizeof(float) * shape->count[i]);
    }
    return 0;
}

void host_job_carry(const host_job *job, host_buffer *out)
{
    host_carry_shape shape;
    memset(&shape, 0, sizeof shape);
    if (fill(job, &shape) != 0)
        out->failed = 1;
    else
        host_carry_write(&shape, out);
    host_carry_free(&shape);
}
