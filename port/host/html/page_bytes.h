/* page_bytes.h: what a page of one file is made of: text in base64, JSON in plain ASCII, numbers in few bytes.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_BYTES_H
#define PAGE_BYTES_H

#include "base/byte_buffer.h"

/* Adds n bytes as base64, in lines. */
void host_page_base64(host_buffer *out, const unsigned char *bytes, size_t n);

/* Adds JSON as ASCII that cannot end a script element: what is not ASCII, and '<', '>' and '&', becomes \uXXXX, bytes
 * that are no UTF-8 become '?'; white space between the values is left out. */
void host_page_json(host_buffer *out, const unsigned char *json, size_t n);

/* Adds n numbers as 16 bits each, 65535 for what is not finite; numbers below 0 count as such. Returns the unit: a
 * number is about that times its 16 bits. */
double host_page_values(host_buffer *out, const float *value, size_t n);

/* A box in space, mm. Positions in it become 16 bits an axis. */
typedef struct host_page_box {
    float low[3], high[3];
} host_page_box;

/* A box that holds nothing; one that holds n further points [n][3]. */
host_page_box host_page_box_empty(void);
void host_page_box_add(host_page_box *box, const float *xyz, size_t n);

/* mm: the largest side; 0 of an empty box. */
float host_page_box_side(const host_page_box *box);

/* Adds the points keep[n] of xyz (NULL: the first n) as 16 bits an axis. */
void host_page_points(host_buffer *out, const host_page_box *box, const float *xyz, const uint32_t *keep, size_t n);

#endif
