/* register_volume.h: volumes of structures: what --volume-ratio asks for, and what the report says of them.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_VOLUME_H
#define REGISTER_VOLUME_H

#include "register/register_job.h"
#include "report/json_write.h"

/* Asks the registration for them. 0, or -1 with the error filled: no such structure, or one that encloses no volume. */
int host_volume_ratios_set(const host_job *job, host_error *error);

/* Writes what has become of structure i. */
void host_report_volume(const host_job *job, uint32_t i, host_json *json);

#endif
