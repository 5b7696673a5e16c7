/* iteration_end.h: how an iteration ends: it stands, or is given up.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ITERATION_END_H
#define SMR_ITERATION_END_H

#include "registration/registration.h"

/* The last step: positions, normals and all that follows become current at once. */
uint32_t smr_stand_tasks(const void *s);
void smr_stand(void *s, uint32_t task, uint32_t worker);

/* Gives up an iteration under way: x stands, as if it had just been reached without a step, however far the iteration
 * had come. Nothing of it is left, nor of what searches could start from, so that a replay need not know how far that
 * was. */
void smr_abandon_iteration(smr *s);

#endif
