/* case_motion_image.c: images of the computed thigh as it flexes.
 * SPDX-License-Identifier: MIT */
#include "case_motion_image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "case.h"

fixture_pose case_motion_pose(double degrees)
{
    fixture_pose pose;
    memset(&pose, 0, sizeof pose);
    pose.seed = 1;
    pose.scale[0] = pose.scale[1] = pose.scale[2] = 1.0f;
    pose.flexion = (float)tan(0.5 * degrees * acos(-1.0) / 180.0);
    return pose;
}

void case_motion_image_open(case_motion_image *image, const float low[3], const float high[3])
{
    const float spacing[3] = {3.0f, 3.0f, 6.0f};
    const uint32_t *const n = image->box.n;
    fixture_thigh_init(&image->thigh);
    fixture_thigh_box(low, high, spacing, &image->box);
    image->voxels = case_alloc((size_t)n[0] * n[1] * n[2], 1);
    image->next = case_alloc((size_t)n[0] * n[1] * n[2], 1);
    image->scratch = case_alloc(FIXTURE_IMAGE_SCRATCH(n[0], n[1]), sizeof(float));
}

void case_motion_image_free(case_motion_image *image)
{
    free(image->voxels);
    free(image->next);
    free(image->scratch);
}

smr_volume case_motion_image_make(case_motion_image *image, double degrees)
{
    uint8_t *const voxels = image->next;
    smr_volume view;
    int i = 0;
    image->next = image->voxels;
    image->voxels = voxels;
    image->pose = case_motion_pose(degrees);
    if (!(degrees > 0.0))
        fixture_thigh_pose(0, &image->pose);
    fixture_thigh_slices(&image->thigh, &image->pose, &image->box, voxels, image->scratch);
    memset(&view, 0, sizeof view);
    view.voxels = voxels;
    view.type = SMR_VOXEL_UINT8;
    memcpy(view.size, image->box.n, sizeof view.size);
    memcpy(view.origin, image->box.low, sizeof view.origin);
    memcpy(view.spacing, image->box.spacing, sizeof view.spacing);
    for (i = 0; i < 3; i++)
        view.direction[4 * i] = 1.0f;
    return view;
}
