/* report_head.h: the files of a directory of results, and what its report.json says at its head, read from bytes that
 * may be anything; whether a result is there already, for --skip-done; the line of --json.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_HEAD_H
#define REPORT_HEAD_H

#include "landmarks/json_scan.h"
#include "register/register_job.h"

/* "DIRECTORY/NAME", to be freed. NULL when out of memory, or where the name leads out of the directory. */
char *host_report_beside(const char *directory, const char *name);

/* 1 when there is such a file, of whatever kind. */
int host_report_there(const char *path);

/* Reads a report.json. 0, or -1 with the error filled; the error borrows the path. */
int host_report_bytes(const char *path, host_bytes *bytes, host_error *error);

#define HOST_REPORT_NAME "report.json"

/* A structure of the result. */
typedef struct host_report_part {
    char name[SMR_NAME_BYTES];
    int level;                /* HOST_VERDICT_... */
    double expected_error_mm; /* NaN: not known */
} host_report_part;

typedef struct host_report_head {
    char version[16];
    host_verdict verdict; /* longer and further reasons are cut */
    int exit_status;      /* -1: not said */
    host_stats to, from;  /* mm, model to target (or truth) and back; n = 0: not measured */
    host_stats whole;     /* mm, the whole model to the target */
    double hausdorff_mm;  /* NaN: not known */
    double seconds;       /* of the whole run; NaN: not known */
    uint64_t iterations, folds;
    char state_hash[20];
    host_report_part *part; /* [n_parts]; owned */
    uint32_t n_parts;
} host_report_head;

/* Reads n bytes of a report.json of this version. 0, or -1 with the error filled and the head empty. */
int host_report_parse(const void *data, size_t n, host_report_head *head, host_error *error);

/* The structure to look at first: of those with the worst verdict the one with the largest expected error, and of like
 * ones the first. NULL without structures. */
const host_report_part *host_report_worst(const host_report_head *head);

void host_report_free(host_report_head *head);

/* "0.1.0": the version of this program. */
const char *host_report_version(void);

/* Reads a whole number of 0 to 2^53. 0, or -1 with the error filled. */
int host_scan_count(host_scan *scan, uint64_t *value);

#define HOST_WHY_BYTES 360u

/* Looks for a result in options->out. Returns 1 when its report.json is of this version, has the same words of the
 * command line (but for --skip-done, --json, --quiet and --threads, which change no result), and all inputs and results
 * that it names are there with the checksums that it names; the head is then filled and to be freed. Else 0, the head
 * empty, and why: what is another, or an empty text where there is no report. */
int host_report_done(const host_options *options, host_report_head *head, char why[HOST_WHY_BYTES]);

/* Writes the head's facts by report.json's names on one line, with the directory and whether they were found done. */
void host_report_line(const host_report_head *head, const char *directory, int skipped, host_buffer *out);

/* Prints that line on stdout, of the bytes of a report.json, at once and after what stands there. 0, or -1. */
int host_report_print(const host_buffer *report, const char *directory, host_error *error);

/* Says that a result was found done: as that line, or as one for people; nothing where quiet says so. */
int host_report_skipped(const host_report_head *head, const host_options *options, host_error *error);

/* Says on standard error, in one line, why a result that is there is computed again. */
void host_report_again(const char *directory, const char *why);

#endif
