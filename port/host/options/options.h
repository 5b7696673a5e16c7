/* options.h: the options of the command line, checked and stored in one struct.
 * SPDX-License-Identifier: MIT */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "base/error_line.h"
#include "base/text_scan.h"
#include "smr.h"

enum {
    HOST_REGISTER = 1,
    HOST_BUILD = 2,
    HOST_INFO = 4,
    HOST_MEASURE = 8,
    HOST_PHANTOM = 16,
    HOST_BENCH = 32,
    HOST_REPLAY = 64,
    HOST_TRACK = 128,
    HOST_CARRY = 1024,
    HOST_FIELD = 2048,
    HOST_WARP = 4096,
    HOST_SUMMARY = 32768,
    HOST_SURFACES = 1 << 20,
    HOST_LABELS = 1 << 21
};
enum { HOST_ALIGN_NONE = 0, HOST_ALIGN_RIGID, HOST_ALIGN_SIMILARITY, HOST_ALIGN_PARTS };
enum { HOST_CLUSTERS_AUTO = 0, HOST_CLUSTERS_SHARED, HOST_CLUSTERS_SEPARATE };

/* A value that changes linearly over the schedule: "5" or "5,0". */
typedef struct host_span {
    float from, to; /* mm */
    uint32_t n;     /* count of numbers given: 0, 1, 2 */
} host_span;

/* File names; the texts are argv's. */
typedef struct host_files {
    const char **path; /* owned array */
    uint32_t n;
} host_files;

typedef struct host_options {
    int command; /* HOST_REGISTER, ... */
    host_files model, target, operands;
    host_files landmarks;               /* no files, or the model's and the target's */
    host_files frames;                  /* of a moving target: files or directories */
    host_files also;                    /* directories: shapes of further subjects */
    host_files contact_with;            /* surfaces that structures are kept out of */
    uint32_t contact;                   /* 1: structures are kept out of each other */
    host_files landmark_goals;          /* likewise: places that points of the model are drawn to */
    const char *landmark_weight;        /* "hard" or a number; NULL: 1 */
    float goal_weight;                  /* what that says; 0: hard */
    int start_by_goals;                 /* 1: the start pose is fitted to landmark_goals */
    const char *out, *c_array, *source; /* NULL when not given */
    const char *reference;              /* the image that the model was segmented from; NULL when not given */
    const char *log;                    /* path of the log file; NULL: no log */
    const char *result;                 /* a result's directory */
    const char *points, *like, *volume; /* files; NULL when not given */
    uint32_t keep_volume;               /* 1: closed structures keep their volume */
    host_files volume_ratio;            /* words NAME=R; implies keep_volume */
    const char *names;                  /* a file with labels and their names; NULL when not given */
    uint32_t passes;                    /* of smoothing the surfaces of a label map */
    uint32_t triangles;                 /* of each of them, at most; 0: all */
    uint32_t inverse;                   /* 1: from the result back to the model */
    float spacing;                      /* mm, of a field; 0: the default */
    uint32_t html;                      /* 1: a page of the report beside it */
    const char *trace;                  /* path of the trace's file; NULL: none */
    const char *save, *resume;          /* paths: where it goes on from; NULL when not given */
    char **arguments;                   /* the arguments after the command; the texts are argv's */
    int n_arguments;
    const char *truth;               /* directory of the true surfaces, for measuring; NULL when not given */
    int image_target;                /* 1: the target is one volume */
    uint64_t given[2];               /* bit i % 64 of i / 64: option i of the table was given */
    int mirror_model, mirror_target; /* HOST_MIRROR_... */
    uint32_t threads;                /* 0: one per processor */
    uint32_t ticks;                  /* 0: until the schedule ends */
    double budget_ms;                /* ms per tick; 0: no clock */
    uint32_t align;                  /* HOST_ALIGN_...; with landmarks: a pose is fitted to them */
    float smoothing;                 /* mm, of the landmarks' spline */
    int spline_if_better;            /* the start is a similarity where landmarks do not carry a spline */
    host_span search, gradient;      /* mm, of image forces; search.from also of surface forces */
    uint32_t clusters;               /* HOST_CLUSTERS_... */
    uint32_t quiet;
    uint32_t json;                   /* 1: the result as one line of JSON on standard output, nothing else there */
    uint32_t skip_done;              /* 1: nothing is computed where the result is there already */
    const char *overview;            /* path of the summary's page; NULL: none */
    uint32_t times;                  /* 1: the summary has columns of times */
    uint32_t paper;                  /* 1: both configurations start from the paper's */
    uint32_t vertex_errors;          /* 1: results have seen and expected_error of each vertex */
    uint32_t format;                 /* HOST_FORMAT_...: what results are written in */
    const char *slicer;              /* path of the scene for 3D Slicer; NULL: none */
    uint32_t accept;                 /* HOST_VERDICT_GOOD or _LOOK: the worst verdict with exit status 0 */
    uint32_t seed;                   /* seed of the phantom's patient */
    uint32_t small;                  /* 1: a coarse phantom */
    uint32_t figure1, figure2, soak; /* 1: this benchmark runs */
    uint32_t repeats, step;          /* figure 2: repetitions of its times; distance of its points, % ignored */
    double seconds;                  /* soak: s per budget */
    double fps;                      /* frames a second */
    const char *prepare_option;      /* the first option given that a prepared .smr refuses; NULL */
    smr_prepare_config prepare;
    smr_config config;
} host_options;

/* Reads argv[2..] for the command. 0, or -1 with the error filled. Call host_options_free() in both cases. */
int host_options_read(int command, int argc, char **argv, host_options *options, host_error *error);
void host_options_free(host_options *options);

/* Prints the whole help text on standard output. */
void host_help(void);

/* Prints the description of `smr register` as a module of 3D Slicer on standard output. 0, or -1: it is not whole. */
int host_module_xml(void);

/* NAME=R: how many characters are the name, and R. 0 when the word is none. A name may have '=' in it. */
int host_volume_ratio_split(const char *word, size_t *name, double *ratio);

#endif
