/* report_done.h: whether a result is there already, for --skip-done; the line of --json.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_DONE_H
#define REPORT_DONE_H

#include "base/byte_buffer.h"
#include "cohort/report_head.h"
#include "options/options.h"

#define HOST_WHY_BYTES 360u

/* Looks for a result in options->out. Returns 1 when its report.json is of this version, has the same words of the
 * command line (but for --skip-done, --json, --quiet and --threads, which change no result), and all inputs and results
 * that it names are there with the checksums that it names; the head is then filled and to be freed. Else 0, the head
 * empty, and why: what is another, or an empty text where there is no report. */
int host_report_done(const host_options *options, host_report_head *head, char why[HOST_WHY_BYTES]);

/* Writes the head's facts by report.json's names on one line, with the directory, and whether they were found done. The
 * buffer stores failure. */
void host_report_line(const host_report_head *head, const char *directory, int skipped, host_buffer *out);

/* Prints that line on standard output, of the bytes of a report.json, at once and after what stands there. 0, or -1
 * with the error filled. */
int host_report_print(const host_buffer *report, const char *directory, host_error *error);

/* Says that a result was found done: as that line, or as one for people; nothing where quiet says so. */
int host_report_skipped(const host_report_head *head, const host_options *options, host_error *error);

/* Says on standard error, in one line, why a result that is there is computed again. */
void host_report_again(const char *directory, const char *why);

#endif
