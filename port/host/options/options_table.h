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
    size_t setting;    /* offset in host_options of the library's setting whose range and words these are; 0: none */
    double min, max;   /* of numbers; both 0: as the setting's */
    int open;          /* 1: above min, not equal */
    int prepares;      /* 1: matters only when a model is prepared */
    const char *words; /* HOST_KIND_WORD: "a|b|c", stored as 0, 1, 2; NULL: as the setting's */
    int targets;       /* HOST_FOR_SURFACES, HOST_FOR_IMAGES, 0 for both */
} host_option;

extern const host_option host_option_table[];
extern const size_t host_option_count;

typedef struct host_range {
    double min, max;
    int open; /* 1: above min, not equal */
} host_range;

/* The library's setting behind an option, or NULL. */
const smr_setting *host_option_setting(const host_option *o);

/* What an option takes: its own range and words, or its setting's. */
host_range host_option_range(const host_option *o);
const char *host_option_words(const host_option *o);

/* mm: how far the library searches in images at most. */
double host_image_search_max(void);

/* The command's option of this name, or NULL. */
const host_option *host_option_find(const char *name, int command);

/* Whether it was given: by its place in the table, or by its name. */
int host_option_was_given(const host_options *options, size_t i);
int host_option_given(const host_options *options, const char *name);

/* options_check.c: what options need beside them, and what they exclude, once all are read. 0, or -1 with the error
 * filled. */
int host_options_check(host_options *options, host_error *error);

#endif
