/* step_energy.h: dynamics: velocities and energies at the end of a time step.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_STEP_ENERGY_H
#define SMR_STEP_ENERGY_H

#include "runtime/tick/time_steps.h"

/* At the end of a time step, while x^r is still that of x and `begin` is where the step began. */
void smr_step_velocities(smr *s);

#endif
