/* track_page.h: what the page of a tracking run shows, kept while the frames go by: a row for each frame, the model and
 * points of the target in some of them.
 * SPDX-License-Identifier: MIT */
#ifndef TRACK_PAGE_H
#define TRACK_PAGE_H

#include "html/page_bytes.h"
#include "model/model_from_files.h"

/* A frame, as track.csv has it. */
typedef struct host_track_row {
    char name[SMR_NAME_BYTES];
    uint32_t number, ticks; /* number: from 0 */
    uint32_t level, reasons, settled, jumped;
    float residual_mm; /* -1: not measured */
    float overlap_mm;  /* of what contact should have parted; 0: nothing */
} host_track_row;

typedef struct host_track_page host_track_page;

/* Starts a page of n_frames frames, 1 or more. The model is borrowed. NULL when out of memory. */
host_track_page *host_track_page_begin(const host_model *model, uint32_t n_frames);
void host_track_page_free(host_track_page *page); /* NULL is allowed */

/* Adds the next frame: its row, and where the model of s is. 0, or -1 when out of memory. */
int host_track_page_add(host_track_page *page, const host_track_row *row, const smr *s);

/* Adds points of a target of the frame that was added last; n: meshes that it has. 0, or -1 when out of memory. */
int host_track_page_target(host_track_page *page, const host_mesh *mesh, uint32_t n);

/* The results of all of it, for writing. */
typedef struct host_track_shown {
    const host_model *model;
    const uint32_t *frame;      /* [n_frames] numbers of the frames that are shown, rising */
    const float *model_xyz;     /* [n_frames][n_vertices][3] mm, structures in a row */
    const uint32_t *n_kept;     /* [n_parts] vertices of each structure */
    const uint32_t *triangles;  /* [all triangles][3] of the structure's kept vertices */
    const uint32_t *n_triangle; /* [n_parts] */
    const float *target_xyz;    /* [all points][3] mm */
    const uint32_t *n_target;   /* [n_frames] points */
    const host_track_row *row;  /* [n_rows] */
    uint32_t n_frames, n_vertices, n_rows, target_most;
    uint32_t levels[3], settled, jumped; /* counts over all frames */
    float cell_mm;
} host_track_shown;
host_track_shown host_track_page_shown(const host_track_page *page);

#endif
