/* track_html.h: the page of a tracking run: one file for a browser, with everything in it.
 * SPDX-License-Identifier: MIT */
#ifndef TRACK_HTML_H
#define TRACK_HTML_H

#include "html/track_page.h"
#include "register/register_job.h"

/* Writes the page into the buffer, which stores failure. job: of the run; n_frames: of the whole run. */
void host_track_html(const host_job *job, const host_track_page *page, uint32_t n_frames, host_buffer *out);

#endif
