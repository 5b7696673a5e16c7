/* setup.h: what the calls share that prepare a registration and read its results.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SETUP_H
#define SMR_SETUP_H

#include "runtime/registration.h"

/* Ranges of the configuration, for a model. Errors: E_CONFIG. */
smr_status smr_config_check(const smr_config *c, const smr_model *m);

#endif
