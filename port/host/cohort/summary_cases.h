/* summary_cases.h: the results that a summary is of, as a table and as a page.
 * SPDX-License-Identifier: MIT */
#ifndef SUMMARY_CASES_H
#define SUMMARY_CASES_H

#include "cohort/report_head.h"

enum { HOST_CASE_READ = 0, HOST_CASE_UNREADABLE, HOST_CASE_MISSING };

/* A directory, and what its report says. */
typedef struct host_case {
    char *path;    /* as it was given, without slashes at its end; owned */
    int state;     /* HOST_CASE_... */
    char why[360]; /* what is wrong, where nothing was read */
    host_report_head head;
} host_case;

typedef struct host_cases {
    host_case *one; /* [n]; owned */
    uint32_t n;
    uint32_t n_lacking; /* missing or unreadable */
} host_cases;

/* Reads the reports of all directories, sorted by path in natural order: p2 before p10. What is missing or cannot be
 * read is a case as well. 0, or -1 with the error filled. Call host_cases_free() in both cases. */
int host_cases_read(const host_files *directories, host_cases *cases, host_error *error);
void host_cases_free(host_cases *cases);

/* -1, 0 or 1: numbers within the texts count by their value; the bytes decide between what is alike otherwise. */
int host_natural_order(const char *a, const char *b);

/* How soon it is to be looked at: 0 good to 4 missing. */
int host_case_rank(const host_case *c);

/* Writes CSV, quoted as RFC 4180 says, into the buffer, which stores failure. times: 1 for columns of times, which
 * differ from run to run; all others depend on inputs and command alone. */
void host_summary_table(const host_cases *cases, int times, host_buffer *out);

/* Writes one HTML file with all that it shows: those to be looked at first come first. page: its path, from where its
 * links lead to the results. 0, or -1 when out of memory. */
int host_summary_page(const host_cases *cases, const char *page, host_buffer *out);

#endif
