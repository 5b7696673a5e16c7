/* summary_table.h: a cohort as a table, and as a page.
 * SPDX-License-Identifier: MIT */
#ifndef SUMMARY_TABLE_H
#define SUMMARY_TABLE_H

#include "base/byte_buffer.h"
#include "cohort/summary_cases.h"

/* Writes CSV, quoted as RFC 4180 says, into the buffer, which stores failure. times: 1 for columns of times, which
 * differ from run to run; all others depend on inputs and command alone. */
void host_summary_table(const host_cases *cases, int times, host_buffer *out);

/* Writes one HTML file with all that it shows: those to be looked at first come first. page: its path, from where its
 * links lead to the results. 0, or -1 when out of memory. */
int host_summary_page(const host_cases *cases, const char *page, host_buffer *out);

/* Writes a picture of a case's surfaces, seen from the front, as SVG. Structures whose verdict is not good are marked.
 * Nothing where there is none of them. 0, or -1 when out of memory. */
int host_summary_picture(const host_case *c, host_buffer *out);

#endif
