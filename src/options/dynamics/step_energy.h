/* step_energy.h: dynamics: velocities and energies at the end of a time step.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_STEP_ENERGY_H
#define SMR_STEP_ENERGY_H

#include "options/dynamics/time_steps.h"

/* Before the iteration that ends a time step stands: sums, in tasks one after the other. */
uint32_t smr_step_energy_tasks(const smr *s); /* 0 in other iterations */
void smr_step_energy(smr *s, uint32_t task);

/* When it stands: velocities. `begin` is where the step began, and becomes x. */
void smr_step_velocities(smr *s);

#endif
