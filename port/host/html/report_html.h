/* report_html.h: the page of a report: one file for a browser, with everything in it.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include "register/register_job.h"

/* Writes report.html into the buffer, which stores failure. report: the text of report.json. */
void host_report_html(const host_job *job, const host_buffer *report, host_buffer *out);

#endif
