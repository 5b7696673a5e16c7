/* print.c: text on stdout, or on a board's debugger console, without stdio there.
 * SPDX-License-Identifier: MIT */
#include "print.h"
#include <smr.h>

#ifdef SMR_BAREMETAL
#include "smr_semihost.h"
#else
#include <stdio.h>
#endif

void print_text(const char *text)
{
#ifdef SMR_BAREMETAL
    smr_semihost_write(text);
#else
    (void)fputs(text, stdout);
#endif
}

void print_hex(uint64_t value, uint32_t digits)
{
    char text[17];
    for (uint32_t i = 0; i < digits; i++)
        text[i] = "0123456789abcdef"[(value >> (4u * (digits - 1u - i))) & 15u];
    text[digits] = '\0';
    print_text(text);
}

void print_number(const char *before, uint64_t value, uint32_t base, const char *after)
{
    char text[24];
    uint32_t at = sizeof text - 1u;
    text[at] = '\0';
    do {
        text[--at] = "0123456789abcdef"[value % base];
        value /= base;
    } while (value != 0u);
    print_text(before);
    print_text(text + at);
    print_text(after);
}

int print_ok(const char *program, const char *step, int status)
{
    if (status == SMR_OK)
        return 1;
    print_text(program);
    print_text(" error: ");
    print_text(step);
    print_text(" ");
    print_text(smr_status_name((smr_status)status));
    print_text("\n");
    return 0;
}
