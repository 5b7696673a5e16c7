/* report_volume.h: a structure's volume in report.json.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_VOLUME_H
#define REPORT_VOLUME_H

#include "register/register_job.h"
#include "report/json_write.h"

/* Writes volume_... of structure i: null where it encloses none, or where the results are where they began. */
void host_report_volume(const host_job *job, uint32_t i, host_json *json);

#endif
