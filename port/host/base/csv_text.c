/* csv_text.c: texts as fields of a table.
 * SPDX-License-Identifier: MIT */
#include "base/csv_text.h"

#include <string.h>

void host_csv_text(host_buffer *out, const char *text, const char *tail)
{
    const char *const quote = strpbrk(text, ",;\"\r\n") != NULL ? "\"" : "";
    host_buffer_print(out, "%s", quote);
    for (; *text != '\0'; text++)
        host_buffer_add(out, *text == '"' ? "\"\"" : text, *text == '"' ? 2 : 1);
    host_buffer_print(out, "%s%s", tail, quote);
}
