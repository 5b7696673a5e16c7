/* landmark_goals_file.h: the landmarks of --landmark-goals: read from files, handed to the library, their residuals.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARK_GOALS_FILE_H
#define LANDMARK_GOALS_FILE_H

#include "landmarks/landmarks.h"
#include "options/options.h"

typedef struct host_landmark_goals {
    host_landmarks set; /* labels, and the points of the model at rest */
    float from[HOST_LANDMARKS_MAX][3], to[HOST_LANDMARKS_MAX][3]; /* mm */
    double residual[HOST_LANDMARKS_MAX]; /* mm: how far each ended from its place */
    double mean, max;                    /* of them */
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

#endif
