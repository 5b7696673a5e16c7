/* page_scene.h: what the page of a report shows: surfaces before and after, targets, what is known of each vertex.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_SCENE_H
#define PAGE_SCENE_H

#include "html/page_bytes.h"
#include "register/register_job.h"
#include "report/json_write.h"

/* Adds "scene" to the JSON; its arrays go to `bytes`, at the places that the JSON names. Fills the box of all. */
void host_page_scene(const host_job *job, host_json *json, host_buffer *bytes, host_page_box *box);

#endif
