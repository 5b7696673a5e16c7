/* page_parts.c: writes script elements, and triangles with their counts.
 * SPDX-License-Identifier: MIT */
#include "html/page_parts.h"

#include <string.h>

static void put_text(host_buffer *out, const char *text) { host_buffer_add(out, text, strlen(text)); }

void host_page_put_json(host_buffer *out, const char *id, const host_buffer *json)
{
    host_buffer_print(out, "<script type=\"application/json\" id=\"%s\">", id);
    host_page_json(out, json->data, json->size);
    put_text(out, "</script>\n");
}

void host_page_put_bytes(host_buffer *out, const char *id, const host_buffer *bytes)
{
    host_buffer_print(out, "<script type=\"text/plain\" id=\"%s\">", id);
    host_page_base64(out, bytes->data, bytes->size);
    put_text(out, "</script>\n");
}

static void put_corner(const char *key, const float corner[3], host_json *json)
{
    int c = 0;
    host_json_open(json, key, '[');
    for (c = 0; c < 3; c++)
        host_json_number(json, NULL, (double)corner[c]);
    host_json_close(json, ']');
}

void host_page_put_box(const host_page_box *box, host_json *json)
{
    put_corner("low", box->low, json);
    put_corner("high", box->high, json);
}

void host_page_put_place(host_json *json, const char *key, host_buffer *bytes)
{
    while (bytes->size % 4u != 0)
        host_buffer_add(bytes, "", 1);
    host_json_count(json, key, bytes->size);
}

void host_page_put_triangles(host_json *json, host_buffer *bytes, const uint32_t *triangles, uint32_t n_triangles,
                             uint32_t n_vertices)
{
    const size_t n = 3u * (size_t)n_triangles;
    const int narrow = n_vertices <= 65536u;
    size_t i = 0;
    host_json_count(json, "vertices", n_vertices);
    host_json_count(json, "triangles", n_triangles);
    host_json_count(json, "index_bytes", narrow ? 2u : 4u);
    host_page_put_place(json, "index", bytes);
    for (i = 0; i < n; i++) {
        const uint32_t v = triangles[i];
        const unsigned char b[2] = {(unsigned char)(v & 255u), (unsigned char)(v >> 8 & 255u)};
        if (narrow)
            host_buffer_add(bytes, b, 2);
        else
            host_buffer_u32(bytes, v);
    }
}
