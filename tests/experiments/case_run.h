/* case_run.h: smr register as a child process, and everything that its report says.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_RUN_H
#define CASE_RUN_H

#include "case.h"
#include "experiment.h"

enum { CASE_KEYS = 400 };

/* A value of report.json: "distance_mm.model_to_target.mean" and its text. Of lists, words are joined by " + ", and
 * of per_structure only the first structure's values are there. */
typedef struct case_value {
    char key[96], text[160];
} case_value;

typedef struct case_run {
    int status;     /* the exit status */
    double seconds; /* by the wall clock */
    case_value value[CASE_KEYS];
    uint32_t n;
} case_run;

/* smr register WORDS... -o OUT; frees the words. SMR_EXPERIMENT_OPTIONS and CASE_THREADS (1) come first. */
void case_register(experiment_command *words, const char *out, case_run *run);

/* Adds --model and --target with the case's files below the directory. */
void case_add_words(const case_data *data, const char *directory, experiment_command *words);

/* The text of a value; "" when the report has none. */
const char *case_text(const case_run *run, const char *key);
/* The number, -1 when there is none. */
double case_number(const case_run *run, const char *key);

#endif
