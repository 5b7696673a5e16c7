/* The computed thigh in memory: meshes and images of the model and of a patient, landmarks.
 * SPDX-License-Identifier: MIT */
#ifndef THIGH_PHANTOM_H
#define THIGH_PHANTOM_H

#include "fixture_thigh.h"
#include "meshes/triangle_mesh.h"

enum { HOST_THIGH_MODEL = 0, HOST_THIGH_PATIENT = 1 };

/* Large: allocate it, with zeros. */
typedef struct host_thigh {
    const smr_port *port; /* borrowed */
    uint32_t small;       /* 1: longer edges, larger voxels */
    fixture_thigh thigh;
    fixture_pose pose[2];
    host_mesh mesh[2][FIXTURE_THIGH_PARTS]; /* owned; the patient's are the true places of the model's vertices */
    fixture_box box[2];
    uint8_t *voxels[2];   /* owned */
    float *scratch;       /* of all workers; owned */
    size_t scratch_words; /* of one worker */
    int failed[FIXTURE_THIGH_PARTS];
} host_thigh;

/* Computes all of it; 0, or -1 with the error filled. Ends with host_thigh_free() either way. */
int host_thigh_make(host_thigh *ph, const smr_port *port, uint32_t seed, uint32_t small, host_error *error);
void host_thigh_free(host_thigh *ph);

/* Landmark i < FIXTURE_THIGH_LANDMARKS and its place at[3], mm, on the model or on the patient. */
const fixture_landmark *host_thigh_landmark(const host_thigh *ph, int set, uint32_t i, float at[3]);

/* The image as the library sees it; borrows the voxels. */
smr_volume host_thigh_image(const host_thigh *ph, int set);

#endif
