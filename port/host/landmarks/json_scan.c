/* json_scan.c: a strict JSON scanner (RFC 8259): calls back for members and elements and stores nothing.
 * SPDX-License-Identifier: MIT */
#include "landmarks/json_scan.h"
#include <string.h>

#define DEPTH_MAX 32  /* deepest nesting of lists and objects */
#define KEY_BYTES 64u /* longer keys are cut; no format here has them */

int host_scan_fail(const host_scan *scan, const char *expected)
{
    return host_fail_at(scan->error, "line", scan->text.line, "%s", expected);
}

char host_scan_peek(host_scan *scan)
{
    host_text *const text = &scan->text;
    for (; text->at < text->end; text->at++) {
        const char c = *text->at;
        if (c == '\n')
            text->line++;
        else if (c != ' ' && c != '\t' && c != '\r')
            return c;
    }
    return 0;
}

/* Skips white space and one mark. */
static int pass(host_scan *scan, char mark, const char *expected)
{
    if (host_scan_peek(scan) != mark)
        return host_scan_fail(scan, expected);
    scan->text.at++;
    return 0;
}

static void put(char *to, size_t bytes, size_t *n, unsigned c)
{
    if (to != NULL && *n + 1u < bytes)
        to[*n] = (char)(unsigned char)c;
    *n += 1u;
}

/* Writes a code point as UTF-8. */
static void put_code(char *to, size_t bytes, size_t *n, unsigned c)
{
    if (c < 0x80u) {
        put(to, bytes, n, c);
    } else if (c < 0x800u) {
        put(to, bytes, n, 0xc0u | (c >> 6));
        put(to, bytes, n, 0x80u | (c & 63u));
    } else {
        if (c < 0x10000u) {
            put(to, bytes, n, 0xe0u | (c >> 12));
        } else {
            put(to, bytes, n, 0xf0u | (c >> 18));
            put(to, bytes, n, 0x80u | ((c >> 12) & 63u));
        }
        put(to, bytes, n, 0x80u | ((c >> 6) & 63u));
        put(to, bytes, n, 0x80u | (c & 63u));
    }
}

/* Reads four hexadecimal digits. */
static int hex4(host_scan *scan, unsigned *value)
{
    *value = 0;
    for (int i = 0; i < 4; i++) {
        const char c = scan->text.at < scan->text.end ? *scan->text.at : '\0';
        unsigned digit = 0;
        if (c >= '0' && c <= '9')
            digit = (unsigned)(c - '0');
        else if ((c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'))
            digit = (unsigned)((c | 32) - 'a') + 10u;
        else
            return host_scan_fail(scan, "four hexadecimal digits after \\u");
        *value = *value * 16u + digit;
        scan->text.at++;
    }
    return 0;
}

/* Reads the digits after \u; a surrogate pair gives one code point above 0xffff. */
static int read_code(host_scan *scan, unsigned *code)
{
    unsigned low = 0;
    if (hex4(scan, code) != 0)
        return -1;
    if (*code < 0xd800u || *code > 0xdfffu)
        return *code != 0 ? 0 : host_scan_fail(scan, "text without NUL");
    if (*code > 0xdbffu || scan->text.end - scan->text.at < 2 || memcmp(scan->text.at, "\\u", 2) != 0)
        return host_scan_fail(scan, "both halves of a character");
    scan->text.at += 2;
    if (hex4(scan, &low) != 0)
        return -1;
    if (low < 0xdc00u || low > 0xdfffu)
        return host_scan_fail(scan, "both halves of a character");
    *code = 0x10000u + ((*code - 0xd800u) << 10) + (low - 0xdc00u);
    return 0;
}

static int read_escape(host_scan *scan, unsigned *code)
{
    static const char names[] = "\"\\/bfnrt", codes[] = "\"\\/\b\f\n\r\t";
    const char c = scan->text.at < scan->text.end ? *scan->text.at : '\0';
    const char *const found = c != '\0' ? strchr(names, c) : NULL;
    if (c == 'u') {
        scan->text.at++;
        return read_code(scan, code);
    }
    if (found == NULL)
        return host_scan_fail(scan, "an escape of JSON after \\");
    scan->text.at++;
    *code = (unsigned)codes[found - names];
    return 0;
}

int host_scan_text(host_scan *scan, char *to, size_t bytes, size_t *n)
{
    size_t length = 0;
    if (pass(scan, '"', "a text in quotes") != 0)
        return -1;
    for (;;) {
        const char c = scan->text.at < scan->text.end ? *scan->text.at : '\0';
        unsigned code = 0;
        if ((unsigned char)c < 32u)
            return host_scan_fail(scan, "a quote at the text's end");
        scan->text.at++;
        if (c == '"')
            break;
        if (c != '\\') {
            put(to, bytes, &length, (unsigned char)c);
            continue;
        }
        if (read_escape(scan, &code) != 0)
            return -1;
        put_code(to, bytes, &length, code);
    }
    if (to != NULL)
        to[length < bytes ? length : bytes - 1u] = '\0';
    *n = length;
    return 0;
}

static const char *skip_digits(const char *p, const char *end)
{
    while (p < end && *p >= '0' && *p <= '9')
        p++;
    return p;
}

/* The end of a JSON number; NULL for others, such as "+1", "01", "1.", ".5", "nan". */
static const char *number_end(const char *p, const char *end)
{
    if (p < end && *p == '-')
        p++;
    const char *start = p;
    p = skip_digits(p, end);
    if (p == start || (*start == '0' && p - start > 1))
        return NULL;
    if (p < end && *p == '.') {
        start = ++p;
        p = skip_digits(p, end);
        if (p == start)
            return NULL;
    }
    if (p < end && (*p == 'e' || *p == 'E')) {
        p++;
        if (p < end && (*p == '-' || *p == '+'))
            p++;
        start = p;
        p = skip_digits(p, end);
        if (p == start)
            return NULL;
    }
    return p;
}

int host_scan_number(host_scan *scan, double *value)
{
    host_word word;
    (void)host_scan_peek(scan);
    word.start = scan->text.at;
    const char *end = number_end(word.start, scan->text.end);
    if (end == NULL)
        return host_scan_fail(scan, "a number");
    word.n = (size_t)(end - word.start);
    if (!host_word_double(word, value))
        return host_scan_fail(scan, "a number of usual length");
    scan->text.at = end;
    return 0;
}

/* Reads a list or an object: `member` for an object, `one` for a list; both NULL: skips it. */
static int scan_all(host_scan *scan, char close, host_scan_member member, host_scan_value one, void *context)
{
    char key[KEY_BYTES] = {0};
    size_t n = 0;
    int result = 0;
    if (++scan->depth > DEPTH_MAX)
        return host_scan_fail(scan, "fewer lists within lists");
    scan->text.at++;
    while (host_scan_peek(scan) != close || n > 0) {
        if (close == '}' && (host_scan_text(scan, key, sizeof key, &n) != 0 || pass(scan, ':', "a colon") != 0))
            return -1;
        result = member != NULL ? member(scan, key, context) : one != NULL ? one(scan, context) : host_scan_skip(scan);
        if (result != 0)
            return -1;
        if (host_scan_peek(scan) == close)
            break;
        if (pass(scan, ',', close == '}' ? "a comma or a closing brace" : "a comma or a closing bracket") != 0)
            return -1;
        n = 1; /* another one follows */
    }
    scan->text.at++;
    scan->depth--;
    return 0;
}

int host_scan_object(host_scan *in, host_scan_member each, void *to)
{
    return host_scan_peek(in) == '{' ? scan_all(in, '}', each, NULL, to) : host_scan_fail(in, "an object in braces");
}

static int read_member(host_scan *scan, const char *key, void *context)
{
    host_scan_members *const m = context;
    size_t i = 0;
    while (i < m->n && strcmp(key, m->fields[i].key) != 0)
        i++;
    if (i == m->n)
        return host_scan_skip(scan);
    if ((m->has & m->once & 1u << i) != 0) /* which one would count? */
        return host_scan_fail(scan, "each key once");
    m->has |= 1u << i;
    return m->fields[i].read(scan, (unsigned char *)m->to + m->fields[i].offset);
}

int host_scan_struct(host_scan *scan, host_scan_members *to) { return host_scan_object(scan, read_member, to); }

int host_scan_list(host_scan *in, host_scan_value each, void *to)
{
    return host_scan_peek(in) == '[' ? scan_all(in, ']', NULL, each, to) : host_scan_fail(in, "a list in brackets");
}

int host_scan_skip(host_scan *scan)
{
    static const char *const words[] = {"true", "false", "null"};
    const char c = host_scan_peek(scan);
    size_t n = 0;
    double value = 0.0;
    if (c == '{')
        return host_scan_object(scan, NULL, NULL);
    if (c == '[')
        return host_scan_list(scan, NULL, NULL);
    if (c == '"')
        return host_scan_text(scan, NULL, 0, &n);
    for (size_t i = 0; i < 3; i++) {
        n = strlen(words[i]);
        if ((size_t)(scan->text.end - scan->text.at) >= n && memcmp(scan->text.at, words[i], n) == 0) {
            scan->text.at += n;
            return 0;
        }
    }
    return c == '-' || (c >= '0' && c <= '9') ? host_scan_number(scan, &value) : host_scan_fail(scan, "a value");
}

int host_scan_end(host_scan *scan)
{
    if (host_scan_peek(scan) != 0 || scan->text.at < scan->text.end)
        return host_scan_fail(scan, "nothing after the closing brace");
    return 0;
}
