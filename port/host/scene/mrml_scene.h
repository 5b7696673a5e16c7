/* mrml_scene.h: writes a scene of 3D Slicer (.mrml): surfaces, volumes, points and a displacement field, each a file
 * that the scene names relative to its own directory. Identifiers count from 1 for each kind of node.
 * SPDX-License-Identifier: MIT */
#ifndef MRML_SCENE_H
#define MRML_SCENE_H

#include "base/byte_buffer.h"

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

#endif
