/* report_files.h: what report.json says of the command and of the files that it read and wrote.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_FILES_H
#define REPORT_FILES_H

#include "files/output_files.h"
#include "options/options.h"
#include "report/json_write.h"

/* "command": the words of the command line. */
void host_report_command(const host_options *options, host_json *json);

/* "inputs": every file that was read, those that only measuring needs, too. */
void host_report_inputs(host_json *json);

/* "results": the files of the set so far. "file" lies in the report's directory, "path" where it says. */
void host_report_results(const host_output *output, host_json *json);

#endif
