/* page_data.h: the data of a page: JSON that holds surfaces and values as base64 of little-endian numbers.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_DATA_H
#define PAGE_DATA_H

#include "html/page_thin.h"
#include "options/options.h"
#include "report/json_write.h"

/* Adds n bytes as a text of base64. */
void host_page_bytes(host_json *json, const char *key, const void *bytes, size_t n);

/* Adds {"low", "high", "at"}: n points of xyz, or those in keep[n] unless it is NULL, with 16 bits an axis within their
 * box. */
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

#endif
