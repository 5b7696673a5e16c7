/* commands.h: the commands. Each returns the program's exit status; at 2 the error is filled.
 * SPDX-License-Identifier: MIT */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "options/options.h"

enum {
    HOST_DONE = 0,
    HOST_FAILED = 1,  /* register: the result cannot be relied on; its files are written all the same */
    HOST_DIFFERS = 1, /* replay */
    HOST_LACKS = 1,   /* summary: a report is missing or cannot be read */
    HOST_REFUSED = 2, /* bad usage or input, nothing is written; or the text could not be printed */
    HOST_LOOK = 3,    /* register: somebody should look at the result */
    HOST_ENDED = 4    /* register: --ticks ended first */
};

int host_register(const host_options *options, host_error *error);
int host_build(const host_options *options, host_error *error);
int host_info(const host_options *options, host_error *error);
int host_phantom(const host_options *options, host_error *error);
int host_bench_run(const host_options *options, host_error *error);
int host_track(const host_options *options, host_error *error);
int host_replay(const host_options *options, host_error *error);
int host_carry(const host_options *options, host_error *error);
int host_field(const host_options *options, host_error *error);
int host_warp(const host_options *options, host_error *error);
int host_summary(const host_options *options, host_error *error);
int host_surfaces(const host_options *options, host_error *error);
int host_labels(const host_options *options, host_error *error);
int host_measure(const host_options *options, host_error *error);

#endif
