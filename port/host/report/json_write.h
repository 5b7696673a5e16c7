/* json_write.h: writes JSON into a buffer.
 * SPDX-License-Identifier: MIT */
#ifndef JSON_WRITE_H
#define JSON_WRITE_H

#include "measure/surface_distances.h"

typedef struct host_json {
    host_buffer *out;
    int depth;
    int fresh;    /* 1: the current object or list is empty */
    int one_line; /* 1: no line breaks but the last */
} host_json;

/* key: NULL inside a list. */
void host_json_open(host_json *json, const char *key, char bracket);
/* Opens an object, or writes null where nothing is known. Returns known. */
int host_json_object(host_json *json, const char *key, int known);
void host_json_close(host_json *json, char bracket);
void host_json_text(host_json *json, const char *key, const char *value);
void host_json_count(host_json *json, const char *key, uint64_t value);
void host_json_flag(host_json *json, const char *key, int value);
/* A value that is not finite is written as null. */
void host_json_number(host_json *json, const char *key, double value);
/* A list of n numbers. */
void host_json_list(host_json *json, const char *key, const float *value, size_t n);
/* JSON that was written before. */
void host_json_raw(host_json *json, const char *key, const host_buffer *value);
void host_json_null(host_json *json, const char *key);
/* Writes {mean, rms, p95, max}, or null when n = 0. */
void host_json_stats(host_json *json, const char *key, const host_stats *stats);

#endif
