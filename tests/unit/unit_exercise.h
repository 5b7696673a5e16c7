/* unit_exercise.h: uses an opened model in every way the library does.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_EXERCISE_H
#define UNIT_EXERCISE_H

#include "unit_mesh.h"

/* Writes length and checksum into the head of an image, so that only its contents can be refused. */
void unit_repair(unsigned char *image, size_t bytes);

/* Reads everything out of the model, then runs smr_init() and a few ticks against the target, with both methods when
 * `both`. Returns NULL, or what went wrong: a call that failed, an index out of range, a position that is not finite.
 * The target may be NULL. */
const char *unit_exercise(const smr_model *model, const smr_surface *target, uint32_t target_vertices, int both);

#endif
