/* input_check.h: inputs that can be read but hardly be meant: turned inside out, of another unit, elsewhere.
 * SPDX-License-Identifier: MIT */
#ifndef INPUT_CHECK_H
#define INPUT_CHECK_H

#include "base/error_line.h"
#include "meshes/triangle_mesh.h"
#include "model/model_from_files.h"

/* 1 when the surface is closed and its normals point inwards: its volume is negative. */
int host_is_inside_out(const host_mesh *mesh);

/* Prints a line on stderr when it is so. */
void host_warn_inside_out(const char *path, const host_mesh *mesh);

/* What a closed surface encloses, mm^3: below 0 where it is inside out. */
double host_enclosed_volume(const host_mesh *mesh);

/* The box around points. Start with count = 0. */
typedef struct host_box {
    float low[3], high[3]; /* mm */
    size_t count;          /* of points in it */
} host_box;

void host_box_add(host_box *box, const float *xyz, size_t n);
void host_box_add_volume(host_box *box, const smr_volume *volume);

/* Refuses a target whose diagonal and the model's differ by a factor above 100: one is in metres, perhaps. */
int host_check_target_size(const host_model *model, const host_box *target, host_error *error);

/* The diagonal of a box around the targets over that of the model; 0 where either is a point. */
double host_size_ratio(const host_model *model, const host_box *target);

/* Refuses an image when its diagonal and the model's differ by a factor above 500. */
int host_check_image_size(const host_model *model, const smr_volume *image, host_error *error);

/* Share of the model's vertices that lie in the image, 0..1. */
double host_share_covered(const host_model *model, const smr_volume *image);

#endif
