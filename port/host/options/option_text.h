/* option_text.h: what help, man pages and completion say of an option. Those that set one of the library's settings are
 * told by its table, the others by option_text.c.
 * SPDX-License-Identifier: MIT */
#ifndef OPTION_TEXT_H
#define OPTION_TEXT_H

#include "options/options_table.h"

/* What stands for its value: "FILE...", "MM", "x|y|z"; "" for a flag. */
const char *host_option_value(const host_option *o, int command);

/* Its sentence, without a full stop, with the default in brackets; "" when option_text.c does not have it. */
void host_option_sentence(const host_option *o, int command, char *to, size_t bytes);

/* A value of a setting as it is typed: a number, or a word of its choices. */
void host_setting_value(const smr_setting *s, double value, char *to, size_t bytes);

/* Prints the words of a text in lines of at most 110 columns: a blank before each, but at a line's start, behind the
 * `column` columns that stand already and `left` blanks on further lines. */
void host_print_wrapped(size_t column, size_t left, const char *text);

#endif
