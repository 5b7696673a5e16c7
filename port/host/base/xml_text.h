/* xml_text.h: writes any text into XML, so that what comes out is well-formed.
 * SPDX-License-Identifier: MIT */
#ifndef XML_TEXT_H
#define XML_TEXT_H

#include "base/byte_buffer.h"

/* Appends a text, within an element or within an attribute's quotes. Control characters, bytes that are no UTF-8 and
 * characters that XML does not have become question marks. */
void host_xml_text(host_buffer *out, const char *text);

/* Appends ' key="text"'. */
void host_xml_attribute(host_buffer *out, const char *key, const char *text);

/* Likewise for the name of a file, in which readers decode %41: a per cent sign, control characters and bytes that are
 * no UTF-8 are written so, and the name that is read is the file's. */
void host_xml_file(host_buffer *out, const char *key, const char *path);

#endif
