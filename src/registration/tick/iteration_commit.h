/* iteration_commit.h: the end of an iteration: its results become current, or it is abandoned.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ITERATION_COMMIT_H
#define SMR_ITERATION_COMMIT_H

#include "registration/registration.h"

uint32_t smr_commit_tasks(const void *s);
void smr_commit(void *s, uint32_t task, uint32_t worker);

/* Abandons the current iteration: x stays, as if it had been reached without a displacement. All results are
 * discarded, including the starts of searches, so that a replay need not know how far the iteration had come. */
void smr_abandon_iteration(smr *s);

#endif
