/* page_data.h: the pages of a registration and of a tracking run, what they show of surfaces and of an image, and the
 * data in them: JSON that holds surfaces and values as base64 of little-endian numbers.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_DATA_H
#define PAGE_DATA_H

#include "report/json_write.h"
#include "register/register_job.h"
#include "track/track_frames.h"

/* What is shown of a mesh. */
typedef struct host_page_mesh {
    uint32_t *keep;      /* [n_vertices] indices of the mesh's vertices; owned */
    uint32_t *triangles; /* [n_triangles][3] of the kept vertices; owned */
    uint32_t n_vertices, n_triangles;
} host_page_mesh;

/* Keeps one vertex in each cube of cell_mm, all for 0, and the triangles that are left. 0, or -1 when out of memory. */
int host_page_thin(const host_mesh *mesh, float cell_mm, host_page_mesh *out);
void host_page_mesh_free(host_page_mesh *mesh);

typedef struct host_page_part {
    const host_mesh *mesh; /* borrowed */
    size_t vertex_bytes;   /* of each vertex on the page */
    host_page_mesh thin;   /* owned */
} host_page_part;

/* Thins all parts with the smallest cube, about, that leaves at most so many vertices and bytes of vertices and
 * triangles. *cell_mm: the cube's side; 0: nothing was thinned. 0, or -1 when out of memory. */
int host_page_thin_all(host_page_part *part, uint32_t n, size_t vertices_most, size_t bytes_most, float *cell_mm);
void host_page_parts_free(host_page_part *part, uint32_t n); /* NULL is allowed */

typedef struct host_page_image {
    uint32_t size[3];
    float spacing[3];  /* mm; means over voxels of the image where it is larger than the image's */
    float first[3];    /* mm, centre of the first voxel */
    double low, high;  /* brightness that 0 and 255 stand for */
    unsigned char *at; /* [size[2]][size[1]][size[0]]; owned */
} host_page_image;

/* Cuts out what lies within margin_mm of the box, in at most so many voxels. 0, or -1 when out of memory. Where box
 * and image do not meet it is empty: at is NULL. */
int host_page_image_make(const host_volume *v, const host_box *box, float margin_mm, size_t most, host_page_image *out);

/* Adds n bytes as a text of base64. */
void host_page_bytes(host_json *json, const char *key, const void *bytes, size_t n);

/* Adds {"low", "high", "at"}: n points of xyz, or those in keep[n] (may be NULL), 16 bits an axis within their box. */
void host_page_points(host_json *json, const char *key, const float *xyz, const uint32_t *keep, size_t n);

/* Adds {"unit", "at"}: the values of the n vertices in keep, as multiples of the unit with 16 bits each. 65535: not
 * known, for values that are negative or not finite. */
void host_page_values(host_json *json, const char *key, const float *value, const uint32_t *keep, size_t n);

/* Adds "vertices", "triangles", and "index": the triangles with 2 bytes an index, or 4 beyond 65,536 vertices. */
void host_page_triangles(host_json *json, const host_page_mesh *mesh);

/* Adds "settings": every setting of the library with its value in `config` and its default; those of the preparation as
 * well unless the model was prepared before. */
void host_page_settings(const host_options *options, const smr_config *config, int prepared, host_json *json);

/* Writes the page around the JSON. What could end a script element is escaped; white space between values is left out.
 * The buffer stores failure, that of the JSON's as well. */
void host_page_write(const host_buffer *json, host_buffer *out);

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
