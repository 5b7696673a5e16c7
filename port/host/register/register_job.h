/* register_job.h: one registration, from input files to results: its verdicts, contact, landmarks as goals, and the
 * data that its steps share. cmd_register.c calls them in order.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_JOB_H
#define REGISTER_JOB_H

#include "base/system.h"
#include "labels/label_map.h"
#include "landmarks/landmarks.h"
#include "measure/surface_distances.h"
#include "model/model_from_files.h"

enum { HOST_VERDICT_GOOD = 0, HOST_VERDICT_LOOK, HOST_VERDICT_FAILED };

#define HOST_REASONS_MAX 24u
#define HOST_REASON_BYTES 240u

typedef struct host_verdict {
    int level;                                        /* HOST_VERDICT_...: the worst of its reasons */
    double probability;                               /* of being right, 0..1, at most what each reason leaves */
    double expected_error_mm;                         /* NaN: not known */
    uint32_t n_reasons;                               /* further ones are dropped */
    char reason[HOST_REASONS_MAX][HOST_REASON_BYTES]; /* each a sentence that says what to look at */
} host_verdict;

/* "good", "look" or "failed". */
const char *host_verdict_name(int level);

/* Adds a reason of this level. */
void host_verdict_add(host_verdict *verdict, int level, const char *reason, ...) HOST_PRINTF(3, 4);

#define HOST_CONTACT_MM 0.5f /* surfaces nearer than this touch */

/* Two surfaces that touch or overlap. */
typedef struct host_contact_pair {
    uint32_t a, b; /* structures; b - n_parts: a fixed surface */
    smr_contact_report report;
    float left_mm;  /* how deep they are in each other that should not be; 0 where one lies in the other by design */
    float asked_mm; /* how deep the structure's own target lies in the fixed surface: what contact works against */
} host_contact_pair;

typedef struct host_contacts {
    struct host_target *fixed; /* [n_fixed]; owned */
    uint32_t n_fixed;
    host_contact_pair *pair; /* [n_pairs] those that touch or overlap, in order; owned */
    uint32_t n_pairs;
    int measured; /* 1: pair is of the results */
} host_contacts;

struct host_job;

/* Reads the files of --contact-with, after the model. 0, or -1 with the error filled: also where nothing can touch. */
int host_job_load_fixed(struct host_job *job, host_error *error);

/* Sets them. */
smr_status host_job_set_fixed(struct host_job *job);

/* Measures all pairs of results and fixed surfaces. 0, or -1 with the error filled. */
int host_job_measure_contact(struct host_job *job, host_error *error);

/* Of the model as it is now: the deepest pair that contact should have parted, mm; 0: there is none, or contact is off.
 * 0, or -1 with the error filled. */
int host_job_contact_left(struct host_job *job, float *left_mm, host_error *error);

/* How deep surfaces may still lie in each other for a good result, mm: less where they keep a distance; any without
 * contact. */
float host_contact_bound(const struct host_job *job);

/* The name of a pair's surface. */
const char *host_contact_name(const struct host_job *job, uint32_t i);

void host_contacts_free(host_contacts *contacts);

typedef struct host_landmark_goals {
    host_landmarks set;                                           /* labels, and the points of the model at rest */
    float from[HOST_LANDMARKS_MAX][3], to[HOST_LANDMARKS_MAX][3]; /* mm */
    double residual[HOST_LANDMARKS_MAX];                          /* mm: how far each ended from its place */
    double mean, max;                                             /* of them */
} host_landmark_goals;

/* Reads two files of landmarks and pairs them. Mirroring the model or the target mirrors its landmarks, too. set (may
 * be NULL): the model's. 0, or -1 with the error filled. */
int host_landmark_pairs_read(const host_options *options, const host_files *files, host_landmarks *set,
                             float from[HOST_LANDMARKS_MAX][3], float to[HOST_LANDMARKS_MAX][3], uint32_t *n,
                             host_error *error);

/* Reads those of --landmark-goals. NULL with the error filled; the caller frees it. */
host_landmark_goals *host_landmark_goals_read(const host_options *options, host_error *error);

/* Draws the registration to them. */
smr_status host_landmark_goals_set(const host_landmark_goals *goals, float weight, smr *s);

/* Fills the residuals. */
smr_status host_landmark_goals_measure(host_landmark_goals *goals, const smr *s);

enum { HOST_LANDMARKS_AGREE = 0, HOST_LANDMARKS_SWAPPED, HOST_LANDMARK_OFF, HOST_LANDMARKS_APART };

/* What is wrong with pairs of landmarks. */
typedef struct host_landmark_doubt {
    uint32_t kind;   /* HOST_LANDMARKS_... */
    uint32_t first;  /* of the pairs in question: SWAPPED, OFF */
    uint32_t second; /* SWAPPED */
    double off_mm;   /* OFF: how far from where the others put it; APART: root mean square of what a fit leaves */
    double scale;    /* of the spreads, target over model; 0 where the model's landmarks lie in one place */
} host_landmark_doubt;

/* Compares pairs [n][3], mm, with the rotation, scale and translation that fits them best. Between two people that
 * leaves about a tenth of the landmarks' spread; fewer than 5 pairs are too few to tell.
 * SWAPPED: exchanging the targets of two pairs leaves clearly less. OFF: one pair is much farther off than
 * the others leave. APART: the pairs as a whole do not fit. */
host_landmark_doubt host_landmarks_agree(const float *from, const float *to, uint32_t n);

#define HOST_NO_TARGET 0xffffffffu

/* A target surface, or a structure's true surface when the target is an image. */
typedef struct host_target {
    const char *path; /* borrowed */
    char name[SMR_NAME_BYTES];
    host_mesh mesh;       /* owned; mirrored when an option says so */
    smr_surface *surface; /* lies in `memory`; NULL for a cloud */
    smr_points *points;   /* a file without triangles; lies in `memory`; NULL for a surface */
    void *memory;         /* owned */
    uint32_t users;       /* number of structures that are registered to it */
    uint32_t user;        /* index of the last of these structures */
} host_target;

/* Distances in both directions. */
typedef struct host_two_way {
    host_stats to_target; /* of the result to its target */
    host_stats to_result; /* of the target to the result; n = 0 when structures share the target */
} host_two_way;

/* The result of one structure. */
typedef struct host_result {
    uint32_t target;             /* index, or HOST_NO_TARGET: moved by its neighbours only */
    host_mesh mesh;              /* the registered structure; owned */
    smr_surface *surface;        /* of the mesh; lies in `memory`; NULL: not made since the mesh moved */
    void *memory;                /* owned */
    smr_structure_volume volume; /* closed is 0 where it is not known */
    host_folds folds;
    host_two_way area, vertices; /* distances integrated over the area, and over vertices */
    host_stats overlap;          /* to the target, over the area that it shows; n = 0 where it shows nothing */
    host_stats overlap_vertices; /* the same over vertices */
    host_stats by_vertex;        /* distances to the truth's vertices with the same index; n = 0 without such a truth */
    double dice,
        label_mm3[2]; /* with a label map as the truth: overlap, -1: none; voxels' volumes, its and the truth's */
    smr_structure_report report;
    host_verdict verdict;
    float local_volume[2]; /* least and most around a vertex, over that at rest; NaN: not known */
} host_result;

/* An iteration, as it was left. */
typedef struct host_step {
    uint32_t iteration; /* its number, from 1 */
    double radius_mm;
    float residual_mm, moved_max_mm; /* -1: not measured */
} host_step;

/* Kept for the page of the report, with --html only. */
typedef struct host_course {
    smr_config config; /* as the library has it */
    float *before_xyz; /* [all vertices][3], positions before the first tick; owned */
    host_step *step;   /* [n]; owned */
    size_t n, capacity;
} host_course;

typedef struct host_job {
    const host_options *options;
    host_port port;
    host_model model;
    int model_is_prepared;       /* 1: the model is read from a .smr */
    host_image reference, image; /* for an image target; the reference is freed once the model is prepared */
    host_target *target;         /* [n_targets]: target surfaces, or true surfaces when the target is an image; owned */
    double covered;              /* share of the model's vertices in the reference image, when one is read */
    char *truth_paths;           /* the paths of the true surfaces; owned */
    host_label_map *truth_map;   /* a label map as the truth; owned; NULL when it is a directory */
    uint32_t n_targets;
    host_result *result;                    /* [model.n_parts] */
    smr_pose pose;                          /* the start pose, of the whole with --align parts; where posed is 1 */
    int posed;                              /* 0: no start was asked for, or landmarks give a spline or a translation */
    float align_rms_mm;                     /* distance of surfaces or landmarks in the start pose */
    smr_align_report align_report;          /* of surfaces; n_alike 0 without */
    smr_align_part *part;                   /* [model.n_parts] with --align parts; surfaces are gone; owned; or NULL */
    smr_warp *warp;                         /* of the landmarks; lies in warp_memory; NULL without landmarks */
    void *warp_memory;                      /* owned */
    float *start_xyz;                       /* [all vertices][3], of landmarks or parts; owned; NULL without */
    uint32_t n_landmarks, warp_kind;        /* SMR_WARP_... */
    char landmark_doubt[HOST_REASON_BYTES]; /* what is wrong with the landmarks; empty when nothing is */
    host_landmark_goals *goals;             /* owned; NULL without --landmark-goals */
    double start_scale;                     /* by which the start scales the model; 0: not at all */
    double size_ratio;                      /* the targets' diagonal over the model's, where nothing is scaled; or 0 */
    void *arena;                            /* owned */
    size_t arena_bytes;
    smr *state;                    /* lies in the arena */
    void *log_memory;              /* of the library's log; owned; NULL without a log */
    size_t truth_first, truth_end; /* range of the files read that only measuring needs */
    smr_tick_report last;          /* report of the last tick */
    int target_seen;               /* 1: a vertex had a goal in some iteration */
    uint32_t ticks, overruns;
    float *tick_ms;    /* [ticks], owned */
    double ticks_s;    /* of all ticks */
    host_buffer trace; /* content of the trace's file; owned */
    float *trace_xyz;  /* [all vertices][3], positions of its last row; owned; NULL without */
    double trace_s;    /* spent on it */
    float *begun_xyz;  /* [all vertices][3], where a registration into an image began; owned; NULL without */
    int kept_start;    /* 1: the results are where it began, host_job_keep_start */
    host_course course;
    host_contacts contacts;
    size_t tick_capacity;
    double start_s, register_s, load_s, measure_s, begin_s;
    host_two_way area, vertices; /* over all structures with a target */
    host_stats overlap;          /* over the area of all that the targets show */
    host_stats overlap_vertices; /* over their vertices */
    host_stats by_vertex;        /* over all structures with a truth of as many vertices */
    host_folds folds;
    smr_verdict measures; /* what the library's verdict rests on */
    host_verdict verdict; /* on the whole */
} host_job;

/* The steps, in order. Each returns 0, or -1 with the error filled. */
int host_job_load(host_job *job, host_error *error);     /* reads all files */
int host_job_check(host_job *job, host_error *error);    /* refuses sizes that cannot be meant */
int host_job_match(host_job *job, host_error *error);    /* pairs structures and targets by name */
int host_job_start(host_job *job, host_error *error);    /* target surfaces; start pose or start positions */
int host_job_prepare(host_job *job, host_error *error);  /* prepares the model and calls host_job_start, in parallel */
int host_job_begin(host_job *job, host_error *error);    /* allocates the arena, calls smr_init */
int host_job_run(host_job *job, host_error *error);      /* runs ticks to the end of the schedule */
int host_job_evaluate(host_job *job, host_error *error); /* measures the results as they are, any number of times */
void host_job_free(host_job *job);

/* The results' positions as they are now, for measuring. 0, or -1 with the error filled. */
int host_job_copy_results(host_job *job, host_error *error);

/* The surface of a result, made when it is first asked for; NULL when memory is short. Forgets it: the mesh moves. */
smr_surface *host_result_surface(host_result *result);
void host_result_moves(host_result *result);

/* Measures contact and judges the result: fills the verdicts, after host_job_evaluate. 0, or -1, error filled. */
int host_job_verdict(host_job *job, host_error *error);

/* Where the vertices of all structures are now, *xyz [all vertices][3], mm, in place of what it was; owned by the
 * caller. 0, or -1 with the error filled. */
int host_job_positions(const host_job *job, float **xyz, host_error *error);

/* After the verdict: where the image is no more like the model in its place than elsewhere, nothing was found, and what
 * the model was moved by is chance: the results become the remembered start. 0, or -1 with the error filled. */
int host_job_keep_start(host_job *job, host_error *error);

/* Parts of these steps for an image target: read the volumes and the true surfaces, place the model by landmarks. */
int host_job_load_images(host_job *job, host_error *error);
int host_job_load_truth(host_job *job, host_error *error);
void host_job_measure_labels(host_job *job); /* the overlap with a label map, for host_job_evaluate */
int host_job_place(host_job *job, host_error *error);
/* host_job_place with given pairs, both [n_landmarks][3], mm. */
int host_job_place_pairs(host_job *job, const float *from, const float *to, host_error *error);
int host_job_place_by_goals(host_job *job, host_error *error); /* the pose, fitted to the landmark goals */
int host_job_warp(host_job *job, host_error *error);           /* start positions; needs the prepared model */
int host_job_bend(host_job *job, host_error *error); /* start positions of limbs; none: as the start pose has them */
int host_job_make_surfaces(host_job *job, host_error *error);

/* Sets every structure's start positions from the landmarks. */
smr_status host_job_put_start(const host_job *job);

/* Starts recording, right after host_job_begin; writes the content of the log file. */
int host_job_record(host_job *job, host_error *error);
int host_job_log(const host_job *job, host_buffer *out, host_error *error);

/* Writes the content of carry.bin, of the model as it is now. The buffer stores failure. */
void host_job_carry(const host_job *job, host_buffer *out);

/* Refuses a format that cannot hold all structures, once they are loaded; writes a structure's
 * surface file into the buffer, which stores failure. */
int host_job_check_format(const host_job *job, host_error *error);
void host_job_surface(const host_job *job, uint32_t part, host_buffer *buffer);

/* Starts the trace with the row of the start; adds the row of a complete iteration. */
int host_job_trace_begin(host_job *job, host_error *error);
int host_job_trace_row(host_job *job, host_error *error);

/* Keeps the start positions; a complete iteration. Both do nothing without --html. */
int host_job_course_begin(host_job *job, host_error *error);
int host_job_course_step(host_job *job, host_error *error);
void host_course_free(host_course *course);

/* Restores a saved registration into the arena; says whether all its targets are there again, status
 * being what setting them came to; writes it as bytes. */
int host_job_resume(host_job *job, const smr_config *config, host_error *error);
int host_job_resumed(host_job *job, smr_status status, host_error *error);
int host_job_save(const host_job *job, host_buffer *out, host_error *error);

/* 1 when nothing draws a structure: it has no target and no landmark goals, or no triangles. */
static inline int host_job_carries(const host_job *job, uint32_t part)
{
    return job->goals != NULL ? job->result[part].report.has_target == 0
                              : job->model.part[part].mesh.n_triangles == 0 ||
                                    (!job->options->image_target && job->result[part].target == HOST_NO_TARGET);
}

/* 1 when the schedule has ended and some vertex had a goal. */
static inline int host_job_converged(const host_job *job) { return job->last.done != 0 && job->target_seen; }

#endif
