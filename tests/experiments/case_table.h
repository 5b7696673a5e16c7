/* case_table.h: the tables of registrations onto partial targets.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_TABLE_H
#define CASE_TABLE_H

#include "case.h"
#include "case_run.h"

/* A bone of the table. */
typedef struct case_bone {
    const char *name, *path;
    int right, femur;
} case_bone;

enum { CASE_BONES = 7, CASE_FEMURS = 5 };
extern const case_bone case_bones[CASE_BONES]; /* the femurs first */

/* A row: what was run and what came out. */
typedef struct case_row {
    char line[24], bone[24];
    uint32_t seed;
    double overlap;
    case_figures start, result;
    char verdict[16];
    int status; /* the exit status; -1: not run */
    double seconds;
    double expected; /* expected_error_mm of the report, -1: none */
} case_row;

/* What a line of a table came to. */
typedef struct case_score {
    char line[24];
    uint32_t rows, held; /* runs, and those within all bounds of their line */
    uint32_t good_far;   /* runs called good with vertices more than 3 mm off in the mean */
    uint32_t wrong_way;  /* persons: ends upside down */
    double mean, worst;  /* surface, mm */
    double vertex;       /* mean of the vertices' errors, mm */
} case_score;

/* Lines of case_table_deformed, in the order of their scores. */
enum {
    CASE_LINE_WHOLE = 0,
    CASE_LINE_SIDE,
    CASE_LINE_PATCHES,
    CASE_LINE_END,
    CASE_LINE_WHOLE_5, /* per cent of outliers */
    CASE_LINE_WHOLE_20,
    CASE_LINE_SIDE_5,
    CASE_LINE_SIDE_20,
    CASE_LINES
};

/* Runs counted by their error, that of vertices or of the surface. */
typedef struct case_views {
    uint32_t near, near_good, farther, farther_good, far, far_good;
} case_views;

/* Where the files of a run are kept, and whether they stay; NULL: scratch. */
void case_keep(const char *directory);

/* Makes the case, registers with the defaults and measures. Options are those of the row's line. */
case_row case_run_row(const char *line, const case_bone *bone, const case_options *options);

/* A case that is made already, with more words for smr. */
case_row case_run_data(const char *line, const char *name, uint32_t seed, const case_data *data, const char *words,
                       case_run *run);

/* The result's file of a row's first structure. */
const char *case_out(const case_data *data, const case_row *row);

/* The options of a line: "whole", "side", "patches", "end", with "+5" or "+20" per cent of outliers behind it. */
case_options case_line(const char *line, uint32_t seed);

/* Lines with known deformations, over bones and seeds; words as in case_named. score: [CASE_LINES], of lines that did
 * not run without rows. Returns how many bounds were missed, as all tables do. */
int case_table_deformed(const char *lines, const char *bones, uint32_t first, uint32_t last, case_score *score);

/* Another person's femur: 20 pairs, targets cut: score[2], top and lower end; and scales of part onto part. */
int case_table_persons(const char *models, const char *targets, case_score *score);
int case_table_lengths(const char *bones, case_score *score);
int case_table_thigh(uint32_t first, uint32_t last, case_score *score);
/* views: [2], by vertices and by the surface. */
int case_table_random(const char *bones, uint32_t first, uint32_t last, case_views *views);

/* 1 when a name begins with one of the words, which are separated by commas; "" means all. */
int case_named(const char *words, const char *name);

void case_print_head(void);
/* whole: vertex to vertex of the whole target's run, -1: none. said: what the bounds say. */
void case_print_row(const case_row *row, double whole, const char *said);

/* Runs the lines that the words ask for and prints a row each. 0 when all could run. */
int case_table(int n, char **word);

#endif
