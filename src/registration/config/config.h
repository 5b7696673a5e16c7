/* config.h: ranges of the runtime configuration. In: the configuration, the model. Out: whether it is legal.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CONFIG_H
#define SMR_CONFIG_H

#include "model/model.h"

/* Checks that all fields are in range and agree with each other and with the model. Errors: E_CONFIG. */
smr_status smr_config_check(const smr_config *c, const smr_model *m);

/* The same configuration as registrations and logs hold it: without attraction there is no room for target vertices. */
void smr_config_settle(smr_config *c);

/* 1: a setting of a capability that this build leaves out is not at its default. */
int smr_config_left_out(const smr_config *c);

#endif
