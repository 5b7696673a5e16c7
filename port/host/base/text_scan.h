/* text_scan.h: words, lines and numbers from a text in memory that need not end with a NUL.
 * SPDX-License-Identifier: MIT */
#ifndef TEXT_SCAN_H
#define TEXT_SCAN_H

#include <stddef.h>
#include <stdint.h>

/* Part of a text; borrowed. */
typedef struct host_word {
    const char *start;
    size_t n;
} host_word;

/* A reading position in a text. */
typedef struct host_text {
    const char *at, *end;
    uint32_t line; /* line number of `at`, from 1 */
} host_text;

host_text host_text_over(const void *data, size_t n);

/* Reads the next word; skips white space and line breaks before it. 0 at the end of the text. */
int host_text_word(host_text *text, host_word *word);

/* Reads the next word of the same line. 0 at the end of the line, which is not skipped. */
int host_text_word_in_line(host_text *text, host_word *word);

/* Reads the rest of the line without its line break, which is skipped. 0 at the end of the text. */
int host_text_line(host_text *text, host_word *line);

/* The text from start to end without spaces and tabs around it. */
host_word host_word_trimmed(const char *start, const char *end);

/* Compare, with and without regard to case. */
int host_word_is(host_word word, const char *name);
int host_word_is_nocase(host_word word, const char *name);

/* 1 when the word contains the text. */
int host_word_has(host_word word, const char *part);

/* Converts the whole word to a number. 1 on success. NaN and infinity are accepted: the callers refuse them. */
int host_word_double(host_word word, double *value);
int host_word_int(host_word word, int64_t *value);

#endif
