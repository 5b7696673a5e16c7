/* thigh_phantom.h: the computed thigh in memory: meshes and images of the model and of a patient, and landmarks.
 * SPDX-License-Identifier: MIT */
#ifndef THIGH_PHANTOM_H
#define THIGH_PHANTOM_H

#include "fixture_thigh.h"
#include "meshes/triangle_mesh.h"

enum { HOST_THIGH_MODEL = 0, HOST_THIGH_PATIENT = 1 };

/* Large: to be allocated, filled with zeros. */
typedef struct host_thigh {
    const smr_port *port; /* borrowed */
    uint32_t small;       /* 1: longer edges, larger voxels */
    fixture_thigh thigh;
    fixture_pose pose[2];
    host_mesh mesh[2][FIXTURE_THIGH_PARTS]; /* owned; the patient's vertices are the true positions of the model's */
    fixture_box box[2];
    uint8_t *voxels[2];   /* owned */
    float *scratch;       /* of all workers, [n_workers][scratch_words]; owned */
    size_t scratch_words; /* per worker */
    int failed[FIXTURE_THIGH_PARTS];
} host_thigh;

/* Computes the phantom, without its images where `images` is 0. 0, or -1 with the error filled. Call host_thigh_free()
 * in both cases. */
int host_thigh_make(host_thigh *ph, const smr_port *port, uint32_t seed, uint32_t small, int images, host_error *error);
void host_thigh_free(host_thigh *ph);

/* Landmark i < FIXTURE_THIGH_LANDMARKS: returns its name; at[3]: its position on the model or the patient, mm. */
const fixture_landmark *host_thigh_landmark(const host_thigh *ph, int set, uint32_t i, float at[3]);

/* The image as the library's type; borrows the voxels. */
smr_volume host_thigh_image(const host_thigh *ph, int set);

#endif
