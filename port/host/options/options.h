/* options.h: the command line's options, checked strictly and laid into one struct.
 * SPDX-License-Identifier: MIT */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "base/error_line.h"
#include "base/mirror.h"
#include "smr.h"

enum {
    HOST_REGISTER = 1,
    HOST_BUILD = 2,
    HOST_INFO = 4,
    HOST_MEASURE = 8,
    HOST_PHANTOM = 16,
    HOST_BENCH = 32,
    HOST_REPLAY = 64
};
enum { HOST_ALIGN_NONE = 0, HOST_ALIGN_RIGID, HOST_ALIGN_SIMILARITY };
enum { HOST_CLUSTERS_AUTO = 0, HOST_CLUSTERS_SHARED, HOST_CLUSTERS_SEPARATE };

/* A value that falls linearly over the schedule: "5" or "5,0". */
typedef struct host_span {
    float from, to; /* mm */
    uint32_t n;     /* numbers given: 0, 1, 2 */
} host_span;

/* File names; they point into argv. */
typedef struct host_files {
    const char **path; /* owned array */
    uint32_t n;
} host_files;

typedef struct host_options {
    int command; /* HOST_REGISTER, ... */
    host_files model, target, operands;
    host_files landmarks;               /* none, or the model's and the target's */
    const char *out, *c_array, *source; /* NULL when not given */
    const char *reference;              /* the image that fits the model; NULL */
    const char *log;                    /* file for the log; NULL: none */
    char **arguments;                   /* as they were given behind the command; they point into argv */
    int n_arguments;
    const char *truth;               /* directory of the true surfaces, for measuring; NULL */
    int image_target;                /* 1: the target is one volume */
    uint64_t given;                  /* bit i: the table's option i was given */
    int mirror_model, mirror_target; /* HOST_MIRROR_... */
    uint32_t threads;                /* 0: as many as processors */
    uint32_t ticks;                  /* 0: until the schedule ends */
    double budget_ms;                /* 0: no clock */
    uint32_t align;                  /* HOST_ALIGN_...; with landmarks: fitted to them */
    float smoothing;                 /* mm: of the landmarks' spline */
    host_span search, gradient;      /* of image forces; search.from: of surfaces too */
    uint32_t clusters;               /* HOST_CLUSTERS_... */
    uint32_t quiet;
    uint32_t seed;              /* of the phantom's patient */
    uint32_t small;             /* 1: a coarse phantom */
    uint32_t figure2, soak;     /* 1: what to measure */
    uint32_t repeats, step;     /* of the figure: of its times; % ignored from point to point */
    double seconds;             /* of a soak, at each budget */
    const char *prepare_option; /* the first option given that a ready .smr has no use for */
    smr_prepare_config prepare;
    smr_config config;
} host_options;

/* Reads argv[2..] for the command. 0, or -1 with the error filled. Ends with host_options_free(). */
int host_options_read(int command, int argc, char **argv, host_options *options, host_error *error);
void host_options_free(host_options *options);

/* The whole help text, on stdout. */
void host_help(void);

#endif
