/* unit_exercise.h: uses an opened model in every way the library does.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_EXERCISE_H
#define UNIT_EXERCISE_H

#include "unit_mesh.h"

/* Writes length and checksum into the head of an image, so that only its contents can be refused. */
void unit_repair(unsigned char *image, size_t bytes);

enum { UNIT_POLAR = 1, UNIT_JUDGED = 2, UNIT_ALL = 3 };

/* Reads everything out of the model, then runs smr_init() and a few ticks against the target. how, a sum: the polar
 * method, too; a verdict. Returns NULL, or what went wrong: a call that failed, an index out of range, a position that
 * is not finite. The target may be NULL. */
const char *unit_exercise(const smr_model *model, const smr_surface *target, uint32_t target_vertices, uint32_t how);

#endif
