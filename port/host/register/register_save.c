/* register_save.c: a registration that goes on where another run of the program stopped: `--save` writes it as bytes,
 * `--resume` restores it.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "base/memory.h"
#include "files/file_read.h"
#include "register/register_job.h"

static int is_save(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    (void)path;
    (void)total;
    if (n >= 4u && head[0] == 'S' && head[1] == 'M' && head[2] == 'R' && head[3] == 'S')
        return 0;
    return host_fail(error, "header", "a file that register --save wrote");
}

static int refuse(host_error *error, smr_status status)
{
    switch (status) {
    case SMR_E_SAVE: return host_fail(error, "content", "an undamaged save of this version");
    case SMR_E_MODEL: return host_fail(error, "model", "--model as it was when this was saved");
    case SMR_E_CONFIG: return host_fail(error, "options", "options and targets as they were when this was saved");
    default: return host_fail(error, "memory", "free memory (%s)", smr_status_name(status));
    }
}

int host_job_resume(host_job *job, const smr_config *config, host_error *error)
{
    host_bytes bytes = {NULL, 0};
    error->file = job->options->resume;
    if (host_file_read(job->options->resume, is_save, &bytes, error) != 0)
        return -1;
    const smr_status status = smr_restore(job->model.model, config, &job->port.port, bytes.data, bytes.size, job->arena,
                                          job->arena_bytes, &job->state);
    host_file_free(&bytes);
    return status == SMR_OK ? 0 : refuse(error, status);
}

int host_job_resumed(host_job *job, smr_status status, host_error *error)
{
    uint32_t n = 0;
    error->file = job->options->resume;
    if (status == SMR_OK)
        status = smr_get_awaited(job->state, &n);
    return status == SMR_OK && n == 0 ? 0 : host_fail(error, "targets", "--target as it was when this was saved");
}

int host_job_save(const host_job *job, host_buffer *out, host_error *error)
{
    size_t bytes = 0;
    error->file = job->options->save;
    if (smr_save_bytes(job->state, &bytes) != SMR_OK || host_buffer_reserve(out, bytes) != 0 ||
        smr_save(job->state, out->data + out->size, bytes) != SMR_OK)
        return host_fail(error, "save", "free memory, and a registration between two iterations");
    out->size += bytes;
    return 0;
}
