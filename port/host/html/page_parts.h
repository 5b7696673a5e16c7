/* page_parts.h: what pages of one file are put together from: their head and tail, and script elements with data.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_PARTS_H
#define PAGE_PARTS_H

#include "html/page_bytes.h"
#include "report/json_write.h"

/* Pages without their data: what stands before them and behind. Made from report_page.html and track_page.html by
 * embed_page.sh. */
extern const unsigned char host_report_page_head[], host_report_page_tail[];
extern const size_t host_report_page_head_bytes, host_report_page_tail_bytes;
extern const unsigned char host_track_page_head[], host_track_page_tail[];
extern const size_t host_track_page_head_bytes, host_track_page_tail_bytes;

/* Adds a script element with this id that holds JSON, or bytes as base64. */
void host_page_put_json(host_buffer *out, const char *id, const host_buffer *json);
void host_page_put_bytes(host_buffer *out, const char *id, const host_buffer *bytes);

/* Adds "low" and "high" of the box. */
void host_page_put_box(const host_page_box *box, host_json *json);

/* Fills the bytes up to a multiple of 4 and adds their number, a place in them. key: NULL inside a list. */
void host_page_put_place(host_json *json, const char *key, host_buffer *bytes);

/* Adds "vertices", "triangles", "index_bytes" and "index", the place of the triangles [n_triangles][3], which go to the
 * bytes with 2 bytes each, or 4 where vertices are many. */
void host_page_put_triangles(host_json *json, host_buffer *bytes, const uint32_t *triangles, uint32_t n_triangles,
                             uint32_t n_vertices);

#endif
