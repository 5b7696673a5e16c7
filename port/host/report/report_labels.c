/* report_labels.c: the part of report.json on a label map as the truth.
 * SPDX-License-Identifier: MIT */
#include <math.h>

#include "report/register_report.h"

void host_report_labels(const host_job *job, uint32_t part, host_json *json)
{
    const host_result *const result = &job->result[part];
    const host_stats *const a = &result->area.to_target, *const b = &result->area.to_result;
    if (job->truth_map == NULL)
        return;
    if (result->dice < 0.0) {
        host_json_null(json, "labels");
        return;
    }
    host_json_open(json, "labels", '{');
    host_json_number(json, "dice", result->dice);
    host_json_number(json, "hausdorff95_mm", fmax(a->p95, b->p95));
    host_json_number(json, "surface_distance_mm",
                     (a->mean * a->weight + b->mean * b->weight) / (a->weight + b->weight));
    host_json_number(json, "volume_mm3", result->label_mm3[0]);
    host_json_number(json, "truth_volume_mm3", result->label_mm3[1]);
    host_json_close(json, '}');
}
