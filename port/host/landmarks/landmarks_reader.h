/* What the readers of landmark files share: the set under construction.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARKS_READER_H
#define LANDMARKS_READER_H

#include <stddef.h>

#include "landmarks/landmarks.h"
#include "base/text_scan.h"

/* Adds one landmark found at a line; refuses what the struct's promises do not allow. */
int host_landmarks_add(host_landmarks *landmarks, host_error *error, uint32_t line, host_word label,
                       const double xyz[3]);

/* The system a file names: turns the landmarks from `first` on into LPS; -1 for an unknown one. */
int host_landmarks_turn(host_landmarks *landmarks, host_error *error, uint32_t line, host_word system, uint32_t first);

int host_read_markups(host_landmarks *landmarks, const char *data, size_t n, host_error *error);
/* slicer 1: the file's name says .fcsv, so that it must name its coordinate system. */
int host_read_landmark_table(host_landmarks *landmarks, const char *data, size_t n, int slicer, host_error *error);

#endif
