/* report_volume.c: a structure's volume in report.json.
 * SPDX-License-Identifier: MIT */
#include "report/report_volume.h"

void host_report_volume(const host_job *job, uint32_t i, host_json *json)
{
    static const char *const keys[] = {"volume_mm3", "volume_rest_mm3", "volume_ratio", "volume_asked_mm3",
                                       "volume_ratio_asked"};
    smr_structure_volume v = {0};
    size_t k = 0;
    const int known = smr_get_structure_volume(job->state, i, &v) == SMR_OK && v.closed && !job->kept_start;
    const float value[] = {v.present_mm3, v.rest_mm3, v.ratio, v.asked_mm3, v.asked_ratio};
    for (k = 0; k < sizeof keys / sizeof keys[0]; k++)
        if (known && (k < 3 || job->options->config.contact.volume > 0.0f))
            host_json_number(json, keys[k], (double)value[k]);
        else
            host_json_null(json, keys[k]);
}
