/* landmarks_reader.h: shared by the readers of landmark formats: adds landmarks to the set being read.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARKS_READER_H
#define LANDMARKS_READER_H

#include <stddef.h>

#include "landmarks/landmarks.h"
#include "base/text_scan.h"

/* Adds the landmark of a line. Refuses labels and coordinates that host_landmarks does not allow. */
int host_landmarks_add(host_landmarks *landmarks, host_error *error, uint32_t line, host_word label,
                       const double xyz[3]);

/* Turns the landmarks from `first` on from the named coordinate system into LPS. -1 for an unknown system. */
int host_landmarks_to_lps(host_landmarks *landmarks, host_error *error, uint32_t line, host_word system,
                          uint32_t first);

int host_read_markups(host_landmarks *landmarks, const char *data, size_t n, host_error *error);
/* slicer 1: the file is .fcsv, which must name its coordinate system. */
int host_read_landmark_table(host_landmarks *landmarks, const char *data, size_t n, int slicer, host_error *error);

#endif
