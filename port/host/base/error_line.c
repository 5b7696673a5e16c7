/* error_line.c: the error line: readers and option checks fill it, main prints it once.
 * SPDX-License-Identifier: MIT */
#include "base/error_line.h"
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

int host_fail(host_error *error, const char *place, const char *expected, ...)
{
    va_list list;
    (void)snprintf(error->place, sizeof error->place, "%s", place);
    va_start(list, expected);
    (void)vsnprintf(error->expected, sizeof error->expected, expected, list);
    va_end(list);
    return -1;
}

int host_fail_of(host_error *error, const char *file, const char *place, const char *expected, ...)
{
    va_list list;
    error->file = file;
    (void)snprintf(error->place, sizeof error->place, "%s", place);
    va_start(list, expected);
    (void)vsnprintf(error->expected, sizeof error->expected, expected, list);
    va_end(list);
    return -1;
}

int host_fail_at(host_error *error, const char *unit, uint64_t number, const char *expected, ...)
{
    va_list list;
    (void)snprintf(error->place, sizeof error->place, "%s %" PRIu64, unit, number);
    va_start(list, expected);
    (void)vsnprintf(error->expected, sizeof error->expected, expected, list);
    va_end(list);
    return -1;
}

void host_error_keep(host_error *error)
{
    static char file[4096];
    if (error->file == NULL)
        return;
    (void)snprintf(file, sizeof file, "%s", error->file);
    error->file = file;
}

/* Replaces control characters: a file name may contain line breaks, but the error is one line. */
static void put_clean(const char *text)
{
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        (void)fputc((c < 32 || c == 127) ? '?' : c, stderr);
    }
}

void host_error_print(const host_error *error)
{
    (void)fputs("smr: ", stderr);
    put_clean(error->file != NULL ? error->file : "smr");
    (void)fputs(": ", stderr);
    put_clean(error->place);
    (void)fputs(": expected ", stderr);
    put_clean(error->expected);
    (void)fputc('\n', stderr);
}
