/* track_verdict.h: how good a frame is.
 * SPDX-License-Identifier: MIT */
#ifndef TRACK_VERDICT_H
#define TRACK_VERDICT_H

#include "model/model_from_files.h"

/* Frames in which each structure was not good, in images. */
typedef struct host_track_doubts {
    uint32_t frames[SMR_STRUCTURES_MAX];
} host_track_doubts;

/* What is known of a frame. */
typedef struct host_frame_report {
    const char *name; /* borrowed */
    smr_tick_report last;
    smr_verdict verdict;
    float overlap_mm; /* of what contact should have parted */
    uint32_t ticks;
} host_frame_report;

/* Of all frames so far. All 0 before the first one. */
typedef struct host_track_verdict {
    host_frame_report last, worst; /* worst: the first of those that none is worse than */
    uint32_t n[3];                 /* frames of each level */
} host_track_verdict;

/* What contact has left of a frame, by its depth in mm. */
#define HOST_OVERLAP_TEXT "surfaces that contact should part overlap by %.1f mm"

/* The verdict on the frame that s is at. images: the model where frames are images, otherwise NULL: the verdict on the
 * whole. In an image a structure may lie where nothing holds it while the whole is good, and a frame may end on its
 * way: then it is no better than `look`, and such structures' reasons are added. Returns the status of
 * smr_get_verdict(). */
smr_status host_track_judge(smr *s, const host_model *images, int settled, smr_verdict *verdict,
                            host_track_doubts *doubts);

/* Adds the next frame, whose name is borrowed until all is printed. */
void host_track_note(host_track_verdict *verdict, const host_frame_report *report);

/* Prints the verdict in words, with its reasons: of the last frame, and of the worst one where that is worse. */
void host_track_print_verdict(const host_track_verdict *verdict);

/* Prints which structures were not good and in how many frames; nothing where there are none. */
void host_track_print_doubts(const host_track_doubts *doubts, const host_model *model);

#endif
