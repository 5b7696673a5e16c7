/* landmarks_agree.h: whether pairs of landmarks can be meant as they are.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARKS_AGREE_H
#define LANDMARKS_AGREE_H

#include <stdint.h>

enum { HOST_LANDMARKS_AGREE = 0, HOST_LANDMARKS_SWAPPED, HOST_LANDMARK_OFF, HOST_LANDMARKS_APART };

/* What is wrong with pairs of landmarks. */
typedef struct host_landmark_doubt {
    uint32_t kind;   /* HOST_LANDMARKS_... */
    uint32_t first;  /* of the pairs in question: SWAPPED, OFF */
    uint32_t second; /* SWAPPED */
    double off_mm;   /* OFF: how far from where the others put it; APART: root mean square of what a fit leaves */
    double scale;    /* of the spreads, target over model; 0 where the model's landmarks lie in one place */
} host_landmark_doubt;

/* Compares pairs [n][3], mm, with the rotation, scale and translation that fits them best. Between two people that
 * leaves about a tenth of the landmarks' spread; fewer than 5 pairs are too few to tell.
 * SWAPPED: exchanging the targets of two pairs leaves clearly less. OFF: one pair is much farther off than
 * the others leave. APART: the pairs as a whole do not fit. */
host_landmark_doubt host_landmarks_agree(const float *from, const float *to, uint32_t n);

#endif
