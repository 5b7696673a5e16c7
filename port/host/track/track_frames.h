/* track_frames.h: the frames of a moving target: files, or directories with a file for each structure.
 * SPDX-License-Identifier: MIT */
#ifndef TRACK_FRAMES_H
#define TRACK_FRAMES_H

#include "base/threads.h"
#include "meshes/mesh_load.h"
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

/* Finds the files of each frame. Names of frames differ. 0, or -1 with the error filled; host_frames_free() in both
 * cases. */
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

#endif
