/* csv_text.h: texts as fields of a table.
 * SPDX-License-Identifier: MIT */
#ifndef CSV_TEXT_H
#define CSV_TEXT_H

#include "base/byte_buffer.h"

/* Appends a text and the tail, which needs no quotes, as one field: within quotes, its own twice, where RFC 4180 or a
 * program that takes semicolons wants it. */
void host_csv_text(host_buffer *out, const char *text, const char *tail);

#endif
