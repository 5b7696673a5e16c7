/* register_bend.c: start positions of a model of one structure whose parts have turned about joints.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "register/register_job.h"

#define SAME 5000u /* what turned parts of the same body leave at most, as smr_articulated_begin() says it */

/* Finds start positions from a pose; xyz and *bent as smr_articulated_begin() writes them. */
static smr_status bend_from(const host_job *job, const smr_surface *model, const smr_surface *target,
                            const smr_pose *pose, float *xyz, uint32_t *bent)
{
    size_t bytes = 0;
    smr_job call;
    smr_status status = smr_articulated_bytes(model, target, &bytes);
    void *const memory = status == SMR_OK ? host_alloc(bytes) : NULL;
    if (status == SMR_OK)
        status = memory == NULL
                     ? SMR_E_ARENA
                     : smr_articulated_begin(model, target, pose, &job->port.port, memory, bytes, xyz, bent, &call);
    if (status == SMR_OK)
        status = smr_job_step(&call, 0, NULL, 0);
    free(memory);
    return status;
}

/* Returns 1 with a start by alignment of one structure with triangles onto a target with triangles. */
static int may_bend(const host_job *job)
{
    return job->options->align != HOST_ALIGN_NONE && job->model.n_parts == 1 &&
           job->model.part[0].mesh.n_triangles > 0 && !job->options->image_target && job->n_targets == 1 &&
           job->target[0].surface != NULL && job->n_landmarks == 0 && job->goals == NULL &&
           job->options->resume == NULL;
}

/* Finds start positions from the poses that the alignment compared, and from the place where the files have the model.
 * Takes the start that leaves least unexplained; what the place of the files leaves counts half. If the best pose needs
 * no turned parts, another start must explain nearly all. */
static smr_status bend(const host_job *job, const smr_surface *model, float *xyz, float *trial, uint32_t *bent)
{
    static const smr_pose here = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_align_report *const found = &job->align_report;
    const size_t bytes = 3u * sizeof *xyz * job->model.part[0].mesh.n_vertices;
    uint32_t left = 0;
    smr_status status = bend_from(job, model, job->target[0].surface, &job->pose, xyz, bent);
    uint32_t most = *bent > 0u ? *bent : SAME;
    for (uint32_t i = 0; status == SMR_OK && (*bent > 0u || found->n_alike > 1u) && i <= found->n_other; i++) {
        const smr_pose *const pose = i < found->n_other ? &found->other[i] : &here;
        if (pose == &here && found->given)
            break; /* that was the best pose */
        status = bend_from(job, model, job->target[0].surface, pose, trial, &left);
        if (status != SMR_OK || left == 0u || (pose == &here && *bent > 0u ? left / 2u : left) >= most)
            continue;
        memcpy(xyz, trial, bytes);
        *bent = most = left;
    }
    return status;
}

int host_job_bend(host_job *job, host_error *error)
{
    uint32_t bent = 0;
    void *surface_memory = NULL;
    if (!may_bend(job))
        return 0;
    const uint32_t n = job->model.part[0].mesh.n_vertices;
    float *const rest = malloc(3u * sizeof *rest * n);
    float *const xyz = malloc(6u * sizeof *xyz * n);
    smr_status status = rest == NULL || xyz == NULL ? SMR_E_ARENA : smr_model_mesh(job->model.model, 0, rest, NULL);
    smr_mesh mesh = host_mesh_view(&job->model.part[0].mesh);
    mesh.xyz = rest; /* as prepared, so that a .smr and the surfaces it was built from give the same bits */
    const smr_surface *const model = status == SMR_OK ? host_surface_make(&mesh, &surface_memory) : NULL;
    if (status == SMR_OK)
        status = model == NULL ? SMR_E_ARENA : bend(job, model, xyz, xyz + 3u * (size_t)n, &bent);
    free(surface_memory);
    free(rest);
    if (bent && status == SMR_OK)
        job->start_xyz = xyz;
    else
        free(xyz);
    error->file = "--model";
    return status == SMR_OK ? 0 : host_fail(error, "start pose", "free memory (%s)", smr_status_name(status));
}
