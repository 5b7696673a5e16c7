/* options_table.h: the options of the command line, and what help, man pages and completion say of them and of the
 * commands.
 * SPDX-License-Identifier: MIT */
#ifndef OPTIONS_TABLE_H
#define OPTIONS_TABLE_H

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

/* What stands for its value: "FILE...", "MM", "x|y|z"; "" for a flag. */
const char *host_option_value(const host_option *o, int command);

/* Its sentence, without a full stop, with the default in brackets; "" when option_text.c does not have it. */
void host_option_sentence(const host_option *o, int command, char *to, size_t bytes);

/* A value of a setting as it is typed: a number, or a word of its choices. */
void host_setting_value(const smr_setting *s, double value, char *to, size_t bytes);

/* Prints the words of a text in lines of at most 110 columns: a blank before each, but at a line's start, behind the
 * `column` columns that stand already and `left` blanks on further lines. */
void host_print_wrapped(size_t column, size_t left, const char *text);

typedef struct host_command_text {
    const char *name;
    int command;              /* HOST_REGISTER, ... */
    const char *purpose;      /* a few words, in lower case */
    const char *synopsis[4];  /* what follows the name, a way to call it each; at most three */
    const char *paragraph[6]; /* at most five */
    const char *status;       /* exit status other than 0 and 2; "" for none */
} host_command_text;

extern const host_command_text host_command_texts[];
extern const size_t host_command_count;

/* The groups in which a command's options are shown. NULL behind the last. */
extern const char *const host_option_groups[];

/* The option's group: its place in host_option_groups. */
size_t host_option_group(const host_option *o, int command);

/* What every page ends with: status 0 and 2. */
extern const char host_status_text[];

/* Prints what `smr NAME --help` says; 0, or -1 when there is no such command. */
int host_command_help(const char *name);

#endif
