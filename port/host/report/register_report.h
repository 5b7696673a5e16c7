/* register_report.h: the result of a registration as report.json, and as a summary for people.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_REPORT_H
#define REGISTER_REPORT_H

#include "files/output_files.h"
#include "register/register_job.h"
#include "report/json_write.h"

/* Writes the text of report.json into the buffer, which stores failure. output: the set with all other files. */
void host_job_report(const host_job *job, int exit_status, const host_output *output, host_buffer *out);

/* Writes "labels", the overlap of a structure with its label; nothing when the truth is no label map. */
void host_report_labels(const host_job *job, uint32_t part, host_json *json);

/* Writes "contact"; null where nothing was measured. */
void host_report_contact(const host_job *job, host_json *json);

/* The name of SMR_WARP_... */
const char *host_warp_name(uint32_t kind);

/* Prints a few lines on standard output; the last is the verdict. */
void host_job_summary(const host_job *job);

/* "command": the words of the command line. */
void host_report_command(const host_options *options, host_json *json);

/* "inputs": every file that was read, those that only measuring needs, too. */
void host_report_inputs(host_json *json);

/* "results": the files of the set so far. "file" lies in the report's directory, "path" where it says. */
void host_report_results(const host_output *output, host_json *json);

/* Writes volume_... of structure i: null where it encloses none, or where the results are where they began. */
void host_report_volume(const host_job *job, uint32_t i, host_json *json);

#endif
