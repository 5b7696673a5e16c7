/* register_scene.h: a registration's results as a scene of 3D Slicer.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_SCENE_H
#define REGISTER_SCENE_H

#include "files/output_files.h"
#include "register/register_job.h"

/* Adds the scene of --slicer to the set, whose surfaces have been added, and what it needs beside them:
 * DIR/field.nrrd, from the patient's space to the model's, and markups of the landmarks. It shows the results, the
 * surfaces and the volume that they were registered to, and the reference volume, moved by the field. Files that Slicer
 * cannot read are left out, which is said on stderr. 0, or -1 with the error filled. */
int host_scene_add(const host_job *job, host_output *output, host_error *error);

#endif
