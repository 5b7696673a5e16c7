/* What a registration reached: report.json and the summary for people.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_REPORT_H
#define REGISTER_REPORT_H

#include "register/register_job.h"

/* The text of report.json. The buffer remembers failure. */
void host_job_report(const host_job *job, host_buffer *out);

/* A few lines on standard output. */
void host_job_summary(const host_job *job);

#endif
