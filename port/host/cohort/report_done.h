/* report_done.h: whether a directory holds the result of a command already: register --skip-done.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_DONE_H
#define REPORT_DONE_H

#include "cohort/report_head.h"
#include "options/options.h"

#define HOST_WHY_BYTES 360u

/* Looks for a result in options->out. Returns 1 when its report.json is of this version, has the same words of the
 * command line (but for --skip-done, --json, --quiet and --threads, which change no result), and all inputs and results
 * that it names are there with the checksums that it names; the head is then filled and to be freed. Else 0, the head
 * empty, and why: what is another, or an empty text where there is no report. */
int host_report_done(const host_options *options, host_report_head *head, char why[HOST_WHY_BYTES]);

#endif
