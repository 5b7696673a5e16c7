/* mrml_scene.h: writes a scene of 3D Slicer (.mrml): surfaces, volumes, points and a displacement field, each a file
 * that the scene names relative to its own directory. Identifiers count from 1 for each kind of node.
 * SPDX-License-Identifier: MIT */
#ifndef MRML_SCENE_H
#define MRML_SCENE_H

#include "carry/carry_result.h"
#include "files/output_files.h"
#include "register/register_job.h"

typedef struct host_scene {
    host_buffer *out; /* stores failure */
    const char *path; /* of the scene; its directory exists */
    int has_field;    /* 1: there is a displacement field, which what is `moved` follows */
    uint32_t n_models, n_volumes, n_points;
} host_scene;

typedef struct host_scene_model {
    const char *name, *file; /* the file is in LPS, or says what it is in */
    float color[3];          /* 0..1 */
    float opacity;
    const char *scalars; /* array of the file's points that can be shown, in mm, or NULL */
    double most;         /* mm: where that array's colours end */
} host_scene_model;

void host_scene_begin(host_scene *scene);

/* At most one, before what it moves. The field is that of the patient's space, and Slicer moves by its inverse. */
void host_scene_field(host_scene *scene, const char *name, const char *file);

/* The first volume is shown in the slices. moved: 1: the field carries it to the patient. */
void host_scene_volume(host_scene *scene, const char *name, const char *file, int moved);
void host_scene_model_add(host_scene *scene, const host_scene_model *model);
void host_scene_points(host_scene *scene, const char *name, const char *file, const float color[3]);
void host_scene_end(host_scene *scene);

#define HOST_SCENE_VOXELS 500000u /* at most, 12 bytes each */

/* Writes the field from the patient's space to the model's around the result as NRRD into the buffer, which stores
 * failure: every 4 mm, or coarser where that gives too many voxels. It is computed at every second voxel along each
 * axis, halved between them, and fitted to the vertices as host_carried_field() does. Returns at how many of the voxels
 * that are computed the way back was not found, in *share their share; or -1 with the error filled. */
int64_t host_scene_field_write(host_carried *c, host_buffer *out, double *share, host_error *error);

/* Adds the scene of --slicer to the set, whose surfaces have been added, and what it needs beside them:
 * DIR/field.nrrd, from the patient's space to the model's, and markups of the landmarks. It shows the results, the
 * surfaces and the volume that they were registered to, and the reference volume, moved by the field. Files that Slicer
 * cannot read are left out, which is said on stderr. 0, or -1 with the error filled. */
int host_scene_add(const host_job *job, host_output *output, host_error *error);

#endif
