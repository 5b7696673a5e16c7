/* register_volume.c: volumes of structures: --volume-ratio, and the report's volume_... of each structure.
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

void host_report_volume(const host_job *job, uint32_t i, host_json *json)
{
    static const char *const keys[] = {"volume_mm3", "volume_rest_mm3", "volume_ratio", "volume_asked_mm3",
                                       "volume_ratio_asked"};
    smr_structure_volume v = {0};
    size_t k = 0;
    const int known = smr_get_structure_volume(job->state, i, &v) == SMR_OK && v.closed && !job->kept_start;
    const float value[] = {v.present_mm3, v.rest_mm3, v.ratio, v.asked_mm3, v.asked_ratio};
    for (k = 0; k < sizeof keys / sizeof keys[0]; k++)
        if (known && (k < 3 || job->options->config.volume > 0.0f))
            host_json_number(json, keys[k], (double)value[k]);
        else
            host_json_null(json, keys[k]);
}
