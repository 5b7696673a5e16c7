/* register_volume.h: volumes of structures: what --volume-ratio asks for.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_VOLUME_H
#define REGISTER_VOLUME_H

#include "register/register_job.h"

/* Asks the registration for them. 0, or -1 with the error filled: no such structure, or one that encloses no volume. */
int host_volume_ratios_set(const host_job *job, host_error *error);

#endif
