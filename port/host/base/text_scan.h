/* Words, lines and numbers out of a text in memory that need not end with a NUL.
 * SPDX-License-Identifier: MIT */
#ifndef TEXT_SCAN_H
#define TEXT_SCAN_H

#include <stddef.h>
#include <stdint.h>

/* A piece of a text; not owned. */
typedef struct host_word {
    const char *start;
    size_t n;
} host_word;

/* A place in a text. */
typedef struct host_text {
    const char *at, *end;
    uint32_t line; /* of `at`, from 1 */
} host_text;

host_text host_text_over(const void *data, size_t n);

/* The next word over any white space and line breaks; 0 when the text ends. */
int host_text_word(host_text *text, host_word *word);

/* The next word of the same line; 0 at the line's end, which is not passed. */
int host_text_word_in_line(host_text *text, host_word *word);

/* The rest of the line without its end, which is passed; 0 when the text ends. */
int host_text_line(host_text *text, host_word *line);

/* Compare with and without regard of case. */
int host_word_is(host_word word, const char *name);
int host_word_is_nocase(host_word word, const char *name);

/* Whether the piece holds the text. */
int host_word_has(host_word word, const char *part);

/* A whole word as a number: 1 on success. NaN and infinity are numbers here; their readers refuse them. */
int host_word_double(host_word word, double *value);
int host_word_int(host_word word, int64_t *value);

#endif
