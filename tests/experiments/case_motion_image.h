/* case_motion_image.h: images of the computed thigh as it flexes.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_MOTION_IMAGE_H
#define CASE_MOTION_IMAGE_H

#include "fixture_thigh.h"
#include "smr.h"

typedef struct case_motion_image {
    fixture_thigh thigh;
    fixture_box box;   /* of all images */
    uint8_t *voxels;   /* owned */
    uint8_t *next;     /* owned: an image stays borrowed until the next one is set */
    float *scratch;    /* owned */
    fixture_pose pose; /* of the image that was made last */
} case_motion_image;

/* The pose of a thigh that flexes by this angle and does nothing else. */
fixture_pose case_motion_pose(double degrees);

/* Images that hold all of low..high, mm. */
void case_motion_image_open(case_motion_image *image, const float low[3], const float high[3]);
void case_motion_image_free(case_motion_image *image);

/* The image at this angle, in memory that the image before the last one had. */
smr_volume case_motion_image_make(case_motion_image *image, double degrees);

#endif
