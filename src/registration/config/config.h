/* config.h: checks of the configuration against ranges and the model.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CONFIG_H
#define SMR_CONFIG_H

#include "model/model.h"

/* Checks that all fields are in range and agree with each other and with the model. Errors: E_CONFIG. */
smr_status smr_config_check(const smr_config *c, const smr_model *m);
void smr_config_settle(smr_config *c); /* turns attract 0 into attract 1, n_target_vertices 0: the form in logs */
int smr_config_left_out(const smr_config *c); /* 1: a setting of a missing capability is not at its default */

#endif
