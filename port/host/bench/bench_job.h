/* bench_job.h: data that the benchmarks of the command line share: a model, an image or surfaces as the target, and the
 * truth.
 * SPDX-License-Identifier: MIT */
#ifndef BENCH_JOB_H
#define BENCH_JOB_H

#include "phantom/thigh_phantom.h"
#include "files/output_files.h"
#include "register/register_job.h"

typedef struct host_bench {
    const host_options *given;
    host_options options; /* a copy that runs may change; file lists are borrowed from `given` */
    host_job job;         /* but for figure 1, target i is the true surface of structure i */
    host_thigh *thigh;    /* the computed data; owned; NULL when files are used */
} host_bench;

/* Computes the thigh, or reads the files that the options name. 0, or -1 with the error filled. */
int host_bench_load(host_bench *bench, const host_options *options, host_error *error);
void host_bench_free(host_bench *bench);

/* Prepares the model, in place of an earlier one. image 1: with the reference image's profiles. */
int host_bench_prepare(host_bench *bench, smr_prepare_config config, int image, host_error *error);

/* Starts a registration in a new arena, at the start pose. image 1: the target is the image, 0: the true surfaces. */
int host_bench_init(host_bench *bench, const smr_config *config, const smr_port *port, int image, host_error *error);

/* Places every structure by the landmarks, or by the pose that --align asked for, and restarts the schedule. */
smr_status host_bench_start(const host_bench *bench);

/* Registers to the image with bench->options.config and measures the result against the truth. */
int host_bench_register(host_bench *bench, host_error *error);

/* Processor time of this thread, as a port's clock. */
uint64_t host_bench_processor_ns(void *ctx);

/* The benchmarks. Each writes its files into options.out. 0, or -1 with the error filled. */
int host_bench_figure1(host_bench *bench, host_error *error);
int host_bench_figure2(host_bench *bench, host_error *error);
int host_bench_soak(host_bench *bench, host_error *error);

#endif
