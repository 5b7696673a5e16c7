/* case_motion.h: targets that move, with a known truth: a bone turns and bends to and fro, a thigh
 * flexes; seen in whole or from one side.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_MOTION_H
#define CASE_MOTION_H

#include "case.h"
#include "smr.h"

/* How it moves and how it is followed. */
typedef struct case_motion_options {
    uint32_t seed;              /* of the axis, the view and the resampling */
    double turn_deg, bend_mm;   /* at the end of a turn */
    double turn_s;              /* one way takes so long, and so does the way back */
    double flex_deg;            /* of the computed thigh, besides */
    double jump_mm, jump_deg;   /* added from jump_frame on */
    uint32_t jump_frame;        /* 0: never */
    double side_deg;            /* triangles whose normals lie within it of the view are seen; 180: all */
    double shift_mm, start_deg; /* how far the model starts from the first frame */
    double fps;
    uint32_t n_frames, most_ticks; /* most_ticks: of a frame */
    uint32_t every;                /* frames between two measurements */
    uint32_t n_points;             /* targets are clouds of so many points without normals; 0: surfaces */
    double noise_mm;               /* of points */
    uint32_t image_every;          /* computed thigh: frames between two images; bones have surfaces. 0: no image */
    smr_config config;             /* n_target_vertices is set */
} case_motion_options;

/* A frame, or means over several. */
typedef struct case_motion_frame {
    double surface, vertex; /* as in case_figures */
    double ticks, residual, seen;
    uint32_t settled, jumped;
} case_motion_frame;

case_motion_options case_motion_defaults(void);

/* Follows the surfaces of files. frame: [n_frames]; what was not measured is that of the frame before. Returns 0 when
 * something failed. every 0: nothing is measured. */
int case_motion_run(const char *const *file, uint32_t n, const case_motion_options *options, case_motion_frame *frame);

/* Means over frames first .. last-1. */
case_motion_frame case_motion_mean(const case_motion_frame *frame, uint32_t first, uint32_t last);

#endif
