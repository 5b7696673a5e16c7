/* volume_ratios.h: the words NAME=R of --volume-ratio.
 * SPDX-License-Identifier: MIT */
#ifndef VOLUME_RATIOS_H
#define VOLUME_RATIOS_H

#include "options/options.h"

/* NAME=R: how many characters are the name, and R. 0 when the word is none. A name may have '=' in it. */
int host_volume_ratio_split(const char *word, size_t *name, double *ratio);

/* Checks all words, as far as words can tell. 0, or -1 with the error filled. */
int host_volume_ratios_check(const host_files *words, host_error *error);

#endif
