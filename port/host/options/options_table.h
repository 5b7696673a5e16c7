/* options_table.h: the table of options: name, commands, kind, field, range.
 * SPDX-License-Identifier: MIT */
#ifndef OPTIONS_TABLE_H
#define OPTIONS_TABLE_H

#include <stddef.h>

#include "options/options.h"

enum {
    HOST_KIND_FILES,
    HOST_KIND_TEXT,
    HOST_KIND_FLAG,
    HOST_KIND_COUNT,
    HOST_KIND_FLOAT,
    HOST_KIND_DOUBLE,
    HOST_KIND_WORD,
    HOST_KIND_RADII,
    HOST_KIND_SPAN
};
enum { HOST_FOR_SURFACES = 1, HOST_FOR_IMAGES = 2 }; /* kinds of target */

typedef struct host_option {
    const char *name;
    int commands;      /* HOST_REGISTER | ... */
    int kind;          /* HOST_KIND_... */
    size_t field;      /* offset in host_options */
    double min, max;   /* of numbers */
    int open;          /* 1: above min, not equal */
    int prepares;      /* 1: matters only when a model is prepared */
    const char *words; /* HOST_KIND_WORD: "a|b|c", stored as 0, 1, 2 */
    int targets;       /* HOST_FOR_SURFACES, HOST_FOR_IMAGES, 0 for both */
} host_option;

extern const host_option host_option_table[];
extern const size_t host_option_count;

#define HOST_IMAGE_SEARCH_MAX 60.0 /* mm: the library's */

/* The command's option of this name, or NULL. */
const host_option *host_option_find(const char *name, int command);

/* Whether it was given. */
int host_option_given(const host_options *options, const char *name);

/* options_check.c: what options need beside them, and what they exclude, once all are read. 0, or -1 with the error
 * filled. */
int host_options_check(host_options *options, host_error *error);

#endif
