/* experiment.h: what the experiments on real data share: the real command line as a child process, its report, bounds.
 * SPDX-License-Identifier: MIT */
#ifndef EXPERIMENT_H
#define EXPERIMENT_H

#include <stdint.h>

#include "landmarks/landmarks.h"
#include "meshes/triangle_mesh.h"

/* Fails the test that calls it, saying what could not be done. */
#define EXPERIMENT_NEED(done)                                                                                          \
    do {                                                                                                               \
        if (!(done))                                                                                                   \
            fail_msg("could not: %s", #done);                                                                          \
    } while (0)

/* The words of one run of smr. */
typedef struct experiment_command {
    char *word[96]; /* owned; NULL behind the last */
    int n;
} experiment_command;

/* One structure of report.json. */
typedef struct experiment_structure {
    char name[64], verdict[16];
    double to_truth, to_model; /* means, mm */
    double residual, matched, folds;
} experiment_structure;

/* What report.json says. Distances in mm, over the area; -1: not in the report. */
typedef struct experiment_result {
    int status;                            /* the exit status */
    double to_truth, to_model;             /* means over all structures */
    double worst_to_truth, worst_to_model; /* the largest mean of one structure */
    char worst[64];                        /* that structure, by the larger of both */
    double by_vertex;                      /* mean distance to the true place of each vertex */
    double folds, matched, seconds, residual;
    char method[16], start[40];
    experiment_structure structure[32];
    uint32_t n_structures;
} experiment_result;

/* 1: all seeds and tables; 0: the short form that `make check` runs. SMR_EXPERIMENTS=full asks for all. */
int experiment_full(void);

/* 1: all runs with generated truth, too, about an hour (SMR_EXPERIMENTS=all); the full form runs a part of them. */
int experiment_all(void);

/* The data's path of this name, in SMR_TEST_DATA or ../shared/data; NULL with a line when it is not there, and
 * for the short form in an instrumented build. The texts of the last 16 calls stay. */
const char *experiment_data(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* A path in this program's own directory of scratch files, which goes when the program ends. */
const char *experiment_scratch(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Makes a directory; 1 when it is there. */
int experiment_directory(const char *path);

void experiment_add(experiment_command *command, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Every DIR/NAME.ply, sorted by name. */
void experiment_add_surfaces(experiment_command *command, const char *directory);

void experiment_free(experiment_command *command);

/* smr WORDS...: the exit status; frees the command. Output goes to a log that is shown when nothing was written. */
int experiment_run(experiment_command *command);

/* 1 when a registration with this exit status has written its results. */
int experiment_written(int status);

/* smr build of a surface or of a directory of them. 1 when it is done. */
int experiment_build(const char *surfaces, const char *reference, const char *out);

/* The words of an environment variable. For trying things out, SMR_EXPERIMENT_OPTIONS go to every registration and
 * SMR_EXPERIMENT_BUILD wherever a model is prepared. */
void experiment_add_environment(experiment_command *command, const char *name);

/* smr register --threads 2 WORDS... -o OUT: runs it, reads OUT/report.json, frees the command. */
experiment_result experiment_register(experiment_command *command, const char *out);

/* The result's larger mean. */
double experiment_mean(const experiment_result *result);

/* One line of a table about a registration; `before` the names of its columns. */
void experiment_print_head(void);
void experiment_print(const char *name, const experiment_result *result);

/* Tells whether value <= limit, remembers a miss. */
void experiment_bound(const char *what, double value, double limit);

/* Ends a test: fails it after a miss. */
#define EXPERIMENT_END() assert_int_equal(experiment_misses(), 0)

/* Misses since the last call. */
int experiment_misses(void);

/* Landmarks as CSV, LPS. */
int experiment_write_landmarks(const char *path, const host_landmarks *landmarks);

/* Distances of `from` to `to` over the area of the triangles whose corners all have a use that is not 0 (NULL: all):
 * mean and largest, mm. */
int experiment_distance(const host_mesh *from, const unsigned char *use, const host_mesh *to, double *mean,
                        double *max);

#endif
