/* What the benchmarks of the command line share: a model, an image or surfaces to register it to, and the truth.
 * SPDX-License-Identifier: MIT */
#ifndef BENCH_JOB_H
#define BENCH_JOB_H

#include "phantom/thigh_phantom.h"
#include "register/register_job.h"

typedef struct host_bench {
    const host_options *given;
    host_options options; /* a copy that runs may change; its file lists are borrowed from `given` */
    host_job job;         /* one structure's true surface is the target of the same index */
    host_thigh *thigh;    /* the computed data, owned; NULL with files */
} host_bench;

/* The computed thigh, or the files that the options name. 0, or -1 with the error filled. */
int host_bench_load(host_bench *bench, const host_options *options, host_error *error);
void host_bench_free(host_bench *bench);

/* Prepares the model anew, in place of an earlier one; image 1: with profiles of the reference. */
int host_bench_prepare(host_bench *bench, smr_prepare_config config, int image, host_error *error);

/* A registration in a new arena, at the start pose and with the image (or the true surfaces) as its target. */
int host_bench_init(host_bench *bench, const smr_config *config, const smr_port *port, int image, host_error *error);

/* Every structure where the landmarks put it, and the schedule from its start. */
smr_status host_bench_start(const host_bench *bench);

/* bench->options.config from start to end into the image, and measured against the truth. */
int host_bench_register(host_bench *bench, host_error *error);

/* The benchmarks: each writes its files into options.out. */
int host_bench_figure2(host_bench *bench, host_error *error);
int host_bench_soak(host_bench *bench, host_error *error);

#endif
