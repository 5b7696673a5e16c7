/* Unpacking through the system's gzip program, without a shell.
 * SPDX-License-Identifier: MIT */
#ifndef GUNZIP_H
#define GUNZIP_H

#include "files/file_read.h"

/* Unpacks the file open at fd (at its start) into bytes, at most HOST_UNPACKED_MAX of them. */
int host_gzip_read(int fd, const char *path, host_accept accept, host_bytes *bytes, host_error *error);

#endif
