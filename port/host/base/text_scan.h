/* text_scan.h: reads text word by word; types of numbers in files; coordinates that are mirrored.
 * SPDX-License-Identifier: MIT */
#ifndef TEXT_SCAN_H
#define TEXT_SCAN_H

#include <stddef.h>
#include <stdint.h>

typedef enum host_type {
    HOST_TYPE_NONE = 0,
    HOST_TYPE_I8,
    HOST_TYPE_U8,
    HOST_TYPE_I16,
    HOST_TYPE_U16,
    HOST_TYPE_I32,
    HOST_TYPE_U32,
    HOST_TYPE_I64,
    HOST_TYPE_F32,
    HOST_TYPE_F64
} host_type;

/* Bytes of one number of the type. */
size_t host_type_bytes(host_type type);

/* Converts one number from bytes in the given order. Whole numbers beyond 2^53 are rounded. */
double host_type_read(host_type type, const unsigned char *bytes, int big_endian);

enum { HOST_MIRROR_NONE = -1, HOST_MIRROR_X = 0, HOST_MIRROR_Y = 1, HOST_MIRROR_Z = 2 };

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
int host_word_is(host_word w, const char *name);
int host_word_is_nocase(host_word word, const char *name);

/* 1 when the word contains the text. */
int host_word_has(host_word word, const char *part);

/* Converts the whole word to a number. 1 on success. NaN and infinity are accepted: the callers refuse them. */
int host_word_double(host_word word, double *value);
int host_word_int(host_word word, int64_t *value);

#endif
