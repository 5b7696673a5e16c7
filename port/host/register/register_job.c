/* register_job.c: prepares the model and starts the registration in parallel; frees a job.
 * SPDX-License-Identifier: MIT */
#include "register/register_job.h"

#include <stdlib.h>
#include <string.h>

/* Two independent tasks: preparing the model, and placing the model on the targets. */
typedef struct both {
    host_job *job;
    host_error error[2];
    int failed[2];
} both;

/* port NULL: one thread. */
static int prepare(host_job *job, const smr_port *port, host_error *error)
{
    smr_prepare_config config = job->options->prepare;
    int result = 0;
    if (job->options->reference != NULL)
        config.reference = &job->reference.view;
    config.port = port;
    result = host_model_prepare(&job->model, &config, error);
    host_image_free(&job->reference);
    return result;
}

static void run_half(void *arg, uint32_t task, uint32_t worker)
{
    both *const b = arg;
    (void)worker;
    if (task == 1)
        b->failed[1] = host_job_start(b->job, &b->error[1]);
    else if (!b->job->model_is_prepared)
        b->failed[0] = prepare(b->job, NULL, &b->error[0]);
}

int host_job_prepare(host_job *job, host_error *error)
{
    both b;
    memset(&b, 0, sizeof b);
    b.job = job;
    if (job->options->align != HOST_ALIGN_NONE) {
        host_parallel(&job->port.port, run_half, &b, 2);
    } else { /* nearly all time is preparation: all workers share it */
        b.failed[0] = job->model_is_prepared ? 0 : prepare(job, &job->port.port, &b.error[0]);
        b.failed[1] = b.failed[0] ? 0 : host_job_start(job, &b.error[1]);
    }
    if (b.failed[0] || b.failed[1]) {
        *error = b.failed[0] ? b.error[0] : b.error[1];
        return -1;
    }
    return host_job_warp(job, error);
}

void host_job_free(host_job *job)
{
    uint32_t i = 0;
    for (i = 0; job->result != NULL && i < job->model.n_parts; i++)
        host_mesh_free(&job->result[i].mesh);
    for (i = 0; i < job->n_targets; i++) {
        host_mesh_free(&job->target[i].mesh);
        free(job->target[i].memory);
    }
    free(job->result);
    free(job->target);
    free(job->tick_ms);
    free(job->trace_xyz);
    free(job->begun_xyz);
    host_course_free(&job->course);
    host_contacts_free(&job->contacts);
    host_buffer_free(&job->trace);
    free(job->arena);
    free(job->log_memory);
    free(job->start_xyz);
    free(job->warp_memory);
    free(job->goals);
    free(job->truth_paths);
    if (job->truth_map != NULL)
        host_label_map_free(job->truth_map);
    free(job->truth_map);
    host_image_free(&job->reference);
    host_image_free(&job->image);
    host_model_free(&job->model);
    host_port_close(&job->port);
}
