/* gunzip.h: unpacks gzip files by the system's gzip program, without a shell.
 * SPDX-License-Identifier: MIT */
#ifndef GUNZIP_H
#define GUNZIP_H

#include "files/file_read.h"

/* Unpacks the file open at fd, from its start, into at most HOST_UNPACKED_MAX bytes. 0, or -1 with the error filled. */
int host_gzip_read(int fd, const char *path, host_accept accept, host_bytes *bytes, host_error *error);

#endif
