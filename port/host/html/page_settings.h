/* page_settings.h: all settings of a registration as JSON.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_SETTINGS_H
#define PAGE_SETTINGS_H

#include "options/options.h"
#include "report/json_write.h"

/* Adds an array: of each setting its group, name, unit, sentence, value and default. prepared: the model was prepared
 * before, so that what it was prepared with is not known and left out. config: as the registration had it. */
void host_page_settings(const host_options *options, const smr_config *config, int prepared, host_json *json);

#endif
