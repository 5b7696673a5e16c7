/* print.h: text on stdout, or on a board's debugger console, without stdio there.
 * SPDX-License-Identifier: MIT */
#ifndef PRINT_H
#define PRINT_H

#include <stdint.h>

void print_text(const char *text);
void print_hex(uint64_t value, uint32_t digits);
/* `before`, the number in base 10 or 16, `after`. */
void print_number(const char *before, uint64_t value, uint32_t base, const char *after);

/* 1 when status is SMR_OK; otherwise prints which step of the program failed and returns 0. */
int print_ok(const char *program, const char *step, int status);

#endif
