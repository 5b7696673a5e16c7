/* One registration from files to files: what its steps share. cmd_register.c knows their order.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_JOB_H
#define REGISTER_JOB_H

#include "base/threads.h"
#include "measure/surface_distances.h"
#include "model/model_from_files.h"
#include "volumes/volume_image.h"

#define HOST_NO_TARGET 0xffffffffu

/* A target surface; with an image as the target, a structure's true surface. */
typedef struct host_target {
    const char *path; /* borrowed */
    char name[SMR_NAME_BYTES];
    host_mesh mesh;       /* owned; mirrored when asked */
    smr_surface *surface; /* in memory */
    void *memory;         /* owned */
    uint32_t users;       /* structures that follow it */
    uint32_t user;        /* the last of them */
} host_target;

/* What came out for one structure. */
typedef struct host_result {
    uint32_t target; /* index, or HOST_NO_TARGET: carried along */
    host_mesh mesh;  /* owned: the structure's triangles at their new place */
    uint64_t folds, folds_absolute;
    host_stats to_target; /* of its vertices to its own target */
    host_stats to_result; /* of the target's vertices to it; none when others share the target */
    host_stats by_vertex; /* of its vertices to the truth's of the same index; none without such a truth */
    smr_structure_report report;
} host_result;

typedef struct host_job {
    const host_options *options;
    host_port port;
    host_model model;
    int ready_image;             /* 1: the model came prepared */
    host_image reference, image; /* with an image as the target; the reference goes once the model is prepared */
    host_target *target;         /* [n_targets]: the target surfaces, or the true ones when the target is an image */
    char *truth_paths;           /* texts the targets' paths point to, with an image as the target; owned */
    uint32_t n_targets;
    host_result *result; /* [model.n_parts] */
    smr_pose pose;       /* the start */
    float align_rms_mm;
    smr_warp *warp;    /* of the landmarks, in warp_memory; NULL */
    void *warp_memory; /* owned */
    float *start_xyz;  /* [all vertices][3] where landmarks put them, structure by structure; NULL; owned */
    uint32_t n_landmarks, warp_kind; /* SMR_WARP_... */
    void *arena;                     /* owned */
    size_t arena_bytes;
    smr *state;                    /* in the arena */
    void *log_memory;              /* of the log, when there is one; owned */
    size_t truth_first, truth_end; /* of the files read, those that only measuring needs */
    smr_tick_report last;          /* of the last tick */
    int target_seen;               /* 1: in some iteration a vertex had a goal */
    uint32_t ticks, overruns;
    float *tick_ms; /* [ticks], owned */
    size_t tick_capacity;
    double start_s, register_s, load_s, measure_s, begin_s;
    host_stats to_target, to_result, by_vertex; /* over all structures that have a target */
    uint64_t folds, folds_absolute;
} host_job;

/* The steps, each 0 or -1 with the error filled. */
int host_job_load(host_job *job, host_error *error);     /* files -> meshes, or a ready image */
int host_job_match(host_job *job, host_error *error);    /* structures to targets, by name */
int host_job_start(host_job *job, host_error *error);    /* target surfaces, start pose or start positions */
int host_job_prepare(host_job *job, host_error *error);  /* the model, and beside it host_job_start */
int host_job_begin(host_job *job, host_error *error);    /* arena and registration, as smr_init leaves it */
int host_job_run(host_job *job, host_error *error);      /* ticks */
int host_job_evaluate(host_job *job, host_error *error); /* results, distances, folds */
void host_job_free(host_job *job);

/* Parts of the steps for images: the volumes, the true surfaces, landmarks to start positions. */
int host_job_load_images(host_job *job, host_error *error);
int host_job_load_truth(host_job *job, host_error *error);
int host_job_place(host_job *job, host_error *error);
/* The same with n_landmarks pairs at hand, both [n_landmarks][3] mm. */
int host_job_place_pairs(host_job *job, const float *from, const float *to, host_error *error);
int host_job_warp(host_job *job, host_error *error); /* after the model is prepared */
int host_job_make_surfaces(host_job *job, host_error *error);

/* register_log.c: recording, from right after host_job_begin on, and the log file's content. */
int host_job_record(host_job *job, host_error *error);
int host_job_log(const host_job *job, host_buffer *out, host_error *error);

/* The schedule came to its end, and not for want of anything to do. */
static inline int host_job_converged(const host_job *job) { return job->last.done != 0 && job->target_seen; }

#endif
