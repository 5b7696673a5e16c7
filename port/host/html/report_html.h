/* report_html.h: the pages of a registration and of a tracking run: one file for a browser, with everything in it.
 * SPDX-License-Identifier: MIT */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include "register/register_job.h"
#include "track/track_frames.h"

/* Writes report.html into the buffer, which stores failure. report: the text of report.json. */
void host_report_html(const host_job *job, const host_buffer *report, host_buffer *out);

/* The page of a tracking run. It is filled while the frames go by: a row for each frame, and the model and points of
 * the target in some of them. */
typedef struct host_track_page host_track_page;

/* Starts a page of n_frames frames, 1 or more. The job is borrowed. NULL when out of memory. */
host_track_page *host_track_page_begin(const host_job *job, uint32_t n_frames);
void host_track_page_free(host_track_page *page); /* NULL is allowed */

/* Adds the next frame as it was registered. 0, or -1 when out of memory. */
int host_track_page_add(host_track_page *page, const host_frame_report *report);

/* Adds points of a target of the frame that was added last; n: meshes that it has. */
void host_track_page_target(host_track_page *page, const host_mesh *mesh, uint32_t n);

/* Writes the page into the buffer, which stores failure. */
void host_track_page_write(host_track_page *page, host_buffer *out);

#endif
