/* track_frames.h: the frames of a tracking run: their files, points that go along, and how good each is.
 * SPDX-License-Identifier: MIT */
#ifndef TRACK_FRAMES_H
#define TRACK_FRAMES_H

#include "base/system.h"
#include "files/output_files.h"
#include "landmarks/landmarks.h"
#include "model/model_from_files.h"

#define HOST_NO_PART 0xfffffffeu

typedef struct host_frame {
    char name[SMR_NAME_BYTES]; /* the path's base name */
    host_files files;          /* owned, as its texts are */
} host_frame;

typedef struct host_frames {
    host_frame *frame; /* [n]; owned */
    uint32_t n;
} host_frames;

/* Finds the files of each frame. Names of frames differ. 0, or -1 with the error filled; always host_frames_free(). */
int host_frames_list(const host_files *paths, host_frames *frames, host_error *error);
void host_frames_free(host_frames *frames);

/* Reads a frame: loads [frame->files.n], owned by the caller. 0, or -1 with the error filled. */
int host_frame_load(const host_frame *frame, const smr_port *port, int mirror, host_load **loads, host_error *error);
void host_frame_unload(const host_frame *frame, host_load *loads);

/* Sets a structure's surface, or cloud where the file has no triangles. It lies in *memory, which the caller frees. */
smr_status host_frame_set_target(smr *s, uint32_t part, const host_mesh *mesh, void **memory);

/* 1: the frame is an image. */
int host_frame_is_image(const host_frame *frame);

/* The structure of file i, SMR_ALL for a frame's only file; HOST_NO_PART when no structure has its name. */
uint32_t host_frame_part(const host_frame *frame, uint32_t i, const host_model *model);

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
smr_status host_track_judge(smr *s, const host_model *images, int settled, smr_verdict *out, host_track_doubts *doubts);

/* Adds the next frame, whose name is borrowed until all is printed. */
void host_track_note(host_track_verdict *verdict, const host_frame_report *report);

/* Prints the verdict in words, with its reasons: of the last frame, and of the worst one where that is worse. */
void host_track_print_verdict(const host_track_verdict *verdict);

/* Prints which structures were not good and in how many frames; nothing where there are none. */
void host_track_print_doubts(const host_track_doubts *doubts, const host_model *model);

#define HOST_POINT_COLUMNS 5000u /* most points that the table has: programs for tables end at 16,384 columns */

typedef struct host_track_points {
    host_points points; /* where they are in the frame that was carried last; n 0: there are none */
    const char *path;   /* of the file that was read, for errors; borrowed */
    const char *file;   /* what a frame's directory has them as, by the format that they were read in */
    float *now;         /* [all vertices][3] mm, structures in a row; owned */
    void *memory;       /* of the map; owned */
    smr_carry *carry;   /* lies in memory */
} host_track_points;

/* Reads the file. 0, or -1 with the error filled. Call host_track_points_free() in both cases. */
int host_track_points_read(host_track_points *t, const char *path, host_error *error);

/* Binds the points to the prepared model at rest. mirror: the coordinate that was negated in the model's files; format:
 * of the frames' surfaces, none of which may be called as the points are. The port stays. Without points nothing is
 * done. 0, or -1 with the error filled. */
int host_track_points_bind(host_track_points *t, const host_model *model, int mirror, int format, const smr_port *port,
                           host_error *error);

/* Carries them to where the model of s is. Without points nothing is done. 0, or -1 with the error filled. */
int host_track_points_carry(host_track_points *t, const smr *s, const host_model *model, host_error *error);

/* Appends the table's columns for them, or their places, each with a comma before it. */
void host_track_points_columns(const host_track_points *t, host_buffer *out);
void host_track_points_row(const host_track_points *t, host_buffer *out);

/* Adds the frame's file of points. Without points nothing is done. 0, or -1 with the error filled. */
int host_track_points_add(const host_track_points *t, const char *frame, host_output *output, host_error *error);

void host_track_points_free(host_track_points *t);

#endif
