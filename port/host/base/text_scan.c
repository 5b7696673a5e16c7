/* text_scan.c: reads text word by word; types of numbers in files.
 * SPDX-License-Identifier: MIT */
#include "base/text_scan.h"
#include <stdlib.h>
#include <string.h>

size_t host_type_bytes(host_type type)
{
    static const unsigned char bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 4, 8};
    return bytes[type];
}

static uint64_t gather(const unsigned char *bytes, size_t n, int big_endian)
{
    uint64_t v = 0;
    for (size_t i = 0; i < n; i++)
        v = (v << 8) | bytes[big_endian ? i : n - 1u - i];
    return v;
}

static double from_bits(host_type type, uint64_t v)
{
    const uint32_t low = (uint32_t)v;
    float f = 0.0f;
    double d = 0.0;
    if (type == HOST_TYPE_F32) {
        memcpy(&f, &low, sizeof f);
        return (double)f;
    }
    memcpy(&d, &v, sizeof d);
    return d;
}

double host_type_read(host_type type, const unsigned char *bytes, int big_endian)
{
    const uint64_t v = gather(bytes, host_type_bytes(type), big_endian);
    switch (type) {
    case HOST_TYPE_I8: return v < 128u ? (double)v : (double)v - 256.0;
    case HOST_TYPE_I16: return v < 32768u ? (double)v : (double)v - 65536.0;
    case HOST_TYPE_I32: return v < 2147483648u ? (double)v : (double)v - 4294967296.0;
    case HOST_TYPE_I64: return v < (1ull << 63) ? (double)v : -(double)(~v + 1u);
    case HOST_TYPE_U8:
    case HOST_TYPE_U16:
    case HOST_TYPE_U32: return (double)v;
    case HOST_TYPE_F32:
    case HOST_TYPE_F64: return from_bits(type, v);
    case HOST_TYPE_NONE:
    default: return 0.0;
    }
}

#define NUMBER_CHARS 128u /* the longest number accepted */

host_text host_text_over(const void *data, size_t n) { return (host_text){data, (const char *)data + n, 1}; }

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

static int is_break(char c) { return c == '\n' || c == '\r'; }

/* Skips one line break: \n, \r\n or \r. */
static void skip_break(host_text *text)
{
    if (*text->at == '\r' && text->at + 1 < text->end && text->at[1] == '\n')
        text->at++;
    text->at++;
    text->line++;
}

int host_text_word_in_line(host_text *text, host_word *word)
{
    while (text->at < text->end && is_blank(*text->at))
        text->at++;
    word->start = text->at;
    while (text->at < text->end && !is_blank(*text->at) && !is_break(*text->at))
        text->at++;
    word->n = (size_t)(text->at - word->start);
    return word->n > 0;
}

int host_text_word(host_text *text, host_word *word)
{
    while (host_text_word_in_line(text, word) == 0) {
        if (text->at >= text->end)
            return 0;
        skip_break(text);
    }
    return 1;
}

int host_text_line(host_text *text, host_word *line)
{
    line->start = text->at;
    line->n = 0;
    if (text->at >= text->end)
        return 0;
    while (text->at < text->end && !is_break(*text->at))
        text->at++;
    line->n = (size_t)(text->at - line->start);
    if (text->at < text->end)
        skip_break(text);
    return 1;
}

host_word host_word_trimmed(const char *start, const char *end)
{
    host_word word;
    while (start < end && (*start == ' ' || *start == '\t'))
        start++;
    while (end > start && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    word.start = start;
    word.n = (size_t)(end - start);
    return word;
}

int host_word_is(host_word w, const char *name) { return w.n == strlen(name) && memcmp(w.start, name, w.n) == 0; }

static char lower(char c) { return (c >= 'A' && c <= 'Z') ? (char)(c - 'A' + 'a') : c; }

int host_word_is_nocase(host_word word, const char *name)
{
    if (word.n != strlen(name))
        return 0;
    for (size_t i = 0; i < word.n; i++)
        if (lower(word.start[i]) != lower(name[i]))
            return 0;
    return 1;
}

int host_word_has(host_word word, const char *part)
{
    const size_t n = strlen(part);
    for (size_t i = 0; i + n <= word.n; i++)
        if (memcmp(word.start + i, part, n) == 0)
            return 1;
    return 0;
}

static int slow_double(host_word word, double *value)
{
    char copy[NUMBER_CHARS];
    char *end = NULL;
    if (word.n == 0 || word.n >= sizeof copy)
        return 0;
    memcpy(copy, word.start, word.n);
    copy[word.n] = '\0';
    *value = strtod(copy, &end);
    return end == copy + word.n;
}

/* Reads digits with at most one point and counts the digits after it. Returns the first character not read. */
static const char *read_digits(const char *p, const char *end, uint64_t *mantissa, int *digits, int *decimals)
{
    int point = 0;
    for (; p < end; p++) {
        if (*p >= '0' && *p <= '9') {
            if (*digits < 19)
                *mantissa = *mantissa * 10u + (uint64_t)(*p - '0');
            *digits += 1;
            *decimals += point;
        } else if (*p == '.' && !point) {
            point = 1;
        } else {
            break;
        }
    }
    return p;
}

/* Reads an exponent such as "e-12" up to the end of the word. 1 when it has at most three digits or is empty. */
static int read_exponent(const char *p, const char *end, int *exponent)
{
    int sign = 1, digits = 0;
    *exponent = 0;
    if (p == end)
        return 1;
    if (*p != 'e' && *p != 'E')
        return 0;
    p++;
    if (p < end && (*p == '-' || *p == '+')) {
        sign = *p == '-' ? -1 : 1;
        p++;
    }
    for (; p < end && *p >= '0' && *p <= '9' && digits < 3; p++, digits++)
        *exponent = *exponent * 10 + (*p - '0');
    *exponent *= sign;
    return p == end && digits > 0;
}

int host_word_double(host_word word, double *value)
{
    static const double ten[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *p = word.start;
    const char *const end = word.start + word.n;
    uint64_t mantissa = 0;
    int digits = 0, decimals = 0, exponent = 0, negative = 0;
    if (p < end && (*p == '-' || *p == '+')) {
        negative = *p == '-';
        p++;
    }
    p = read_digits(p, end, &mantissa, &digits, &decimals);
    if (digits == 0 || digits > 19 || mantissa >= (1ull << 53) || !read_exponent(p, end, &exponent))
        return slow_double(word, value);
    exponent -= decimals;
    if (exponent < -22 || exponent > 22)
        return slow_double(word, value);
    *value = exponent < 0 ? (double)mantissa / ten[-exponent] : (double)mantissa * ten[exponent];
    if (negative)
        *value = -*value;
    return 1;
}

int host_word_int(host_word word, int64_t *value)
{
    size_t i = 0;
    int negative = 0;
    int64_t sum = 0;
    if (word.n > 0 && (word.start[0] == '-' || word.start[0] == '+')) {
        negative = word.start[0] == '-';
        i = 1;
    }
    if (i == word.n || word.n - i > 18)
        return 0;
    for (; i < word.n; i++) {
        if (word.start[i] < '0' || word.start[i] > '9')
            return 0;
        sum = sum * 10 + (word.start[i] - '0');
    }
    *value = negative ? -sum : sum;
    return 1;
}
