/* register_volume.c: volumes of structures: what --volume-ratio asks for.
 * SPDX-License-Identifier: MIT */
#include "register/register_volume.h"

#include <string.h>

#include "options/volume_ratios.h"

static uint32_t part_of(const host_job *job, const char *word, size_t n)
{
    uint32_t i = 0;
    while (i < job->model.n_parts &&
           (strlen(job->model.part[i].name) != n || strncmp(job->model.part[i].name, word, n) != 0))
        i++;
    return i;
}

int host_volume_ratios_set(const host_job *job, host_error *error)
{
    const host_files *const words = &job->options->volume_ratio;
    uint32_t i = 0;
    for (i = 0; i < words->n; i++) {
        size_t name = 0;
        double ratio = 0.0;
        error->file = "--volume-ratio";
        if (!host_volume_ratio_split(words->path[i], &name, &ratio) ||
            part_of(job, words->path[i], name) == job->model.n_parts)
            return host_fail(error, words->path[i], "the name of a structure of the model");
        if (smr_set_volume_ratio(job->state, part_of(job, words->path[i], name), (float)ratio) != SMR_OK)
            return host_fail(error, words->path[i], "a structure that is closed: each edge has two triangles");
    }
    error->file = NULL;
    return 0;
}
