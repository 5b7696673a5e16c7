/* cmd_replay.c: smr replay: reads the inputs of a recorded registration again and repeats its ticks.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include "commands/commands.h"
#include "files/log_file.h"
#include "register/register_job.h"

/* Numbers of the log's records, counted before the first tick is repeated. */
typedef struct tick_counts {
    uint32_t ticks, iterations, partial, cut;
} tick_counts;

typedef struct replayed {
    const char *path;
    host_log log;
    host_options options; /* from the recorded command line */
    host_job job;
    tick_counts counts;
    char **arguments; /* owned */
    int positions;    /* 1: start positions were set, which may depend on the start pose */
    int earlier;      /* 1: the log may be of a version that started landmarks by a spline always */
} replayed;

/* Checks every record of the log and counts them. */
static int count_ticks(replayed *r, host_error *error)
{
    smr_log_reader from;
    smr_log_record record;
    smr_log_info info;
    smr_status status = smr_log_open(r->log.log, r->log.log_bytes, &from, &info);
    error->file = r->path;
    if (status != SMR_OK)
        return host_fail(error, "log", "a log of this version (%s)", smr_status_name(status));
    do {
        status = smr_log_next(&from, &record);
        if (status != SMR_OK)
            return host_fail_at(error, "log, byte", from.at, "a whole, undamaged record (%s)", smr_status_name(status));
        r->positions |= record.kind == SMR_LOG_POSITIONS || record.kind == SMR_LOG_ALL_POSITIONS;
        if (record.kind != SMR_LOG_TICK)
            continue;
        r->counts.ticks++;
        r->counts.iterations += record.complete;
        r->counts.partial += !record.complete;
        r->counts.cut += record.complete && record.n_taken < info.n_vertices;
    } while (record.kind != 0 && record.kind != SMR_LOG_FULL);
    return 0;
}

/* Checks that each input file still has its recorded size and checksum. */
static int check_inputs(const host_log *log, host_error *error)
{
    for (uint32_t i = 0; i < log->n_inputs; i++) {
        const host_log_input *const was = &log->input[i];
        host_log_input is;
        if (host_log_measure(was->path, &is, error) != 0)
            return -1;
        if (is.bytes != was->bytes || is.checksum != was->checksum)
            return host_fail(error, "file",
                             "%" PRIu64 " bytes with checksum %016" PRIx64 " as recorded, found %" PRIu64
                             " with %016" PRIx64,
                             was->bytes, was->checksum, is.bytes, is.checksum);
    }
    return 0;
}

/* Reads the options from the recorded command line. */
static int read_options(replayed *r, uint32_t threads, host_error *error)
{
    const uint32_t n = r->log.n_arguments;
    smr_log_reader reader;
    smr_log_info info;
    r->arguments = calloc(n + 3u, sizeof *r->arguments);
    if (r->arguments == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < n; i++)
        r->arguments[2u + i] = r->log.argument[i];
    if (host_options_read(HOST_REGISTER, (int)(n + 2u), r->arguments, &r->options, error) != 0)
        return -1;
    r->options.threads = threads;
    if (smr_log_open(r->log.log, r->log.log_bytes, &reader, &info) == SMR_OK) { /* defaults may have been others */
        info.config.basic.n_target_vertices = r->options.config.basic.n_target_vertices; /* is counted again */
        r->options.config = info.config;
    }
    r->options.spline_if_better &= !r->earlier;
    r->options.truth = NULL; /* a replay measures nothing */
    r->options.log = NULL;
    if (r->options.landmarks.n == 0 && !r->positions)
        r->options.align = HOST_ALIGN_NONE; /* the pose is in the log */
    return 0;
}

static const void *target_of(const host_target *target, uint32_t kind)
{
    return kind == SMR_LOG_POINTS ? (const void *)target->points : target->surface;
}

/* Finds the input that a record names. */
static const void *input_of(void *ctx, const smr_log_record *r)
{
    const host_job *const job = ctx;
    const float *xyz = job->start_xyz;
    const uint32_t part = r->structure;
    if (r->kind == SMR_LOG_FIXED_SURFACE)
        return r->index < job->contacts.n_fixed ? job->contacts.fixed[r->index].surface : NULL;
    if (r->kind == SMR_LOG_VOLUME)
        return job->options->image_target ? &job->image.view : NULL;
    if ((r->kind == SMR_LOG_SURFACE || r->kind == SMR_LOG_POINTS) && part == SMR_ALL)
        return job->n_targets == 1 ? target_of(&job->target[0], r->kind) : NULL;
    if (r->kind == SMR_LOG_ALL_POSITIONS)
        return xyz;
    if (part >= job->model.n_parts)
        return NULL;
    if (r->kind == SMR_LOG_SURFACE || r->kind == SMR_LOG_POINTS)
        return job->result[part].target != HOST_NO_TARGET ? target_of(&job->target[job->result[part].target], r->kind)
                                                          : NULL;
    for (uint32_t i = 0; xyz != NULL && i < part; i++)
        xyz += 3u * (size_t)job->model.part[i].mesh.n_vertices;
    return xyz;
}

static int refuse_start(replayed *r, smr_status status, host_error *error)
{
    error->file = r->path;
    if (status == SMR_E_MODEL)
        return host_fail(error, "model", "inputs that prepare to the model that was recorded");
    if (status == SMR_E_CONFIG)
        return host_fail(error, "configuration", "the one that its command line gives here");
    return host_fail(error, "log", "a log that can be repeated (%s)", smr_status_name(status));
}

static int refuse_tick(const replayed *r, const smr_replay_report *report, smr_status status, host_error *error)
{
    error->file = r->path;
    return host_fail_at(error, "before or at tick", report->tick,
                        status == SMR_E_INPUT ? "the inputs that were recorded (%s)"
                                              : "a tick that can be repeated (%s)",
                        smr_status_name(status));
}

static void print_agreement(const replayed *r, const smr_replay_report *report)
{
    const tick_counts *const n = &r->counts;
    (void)printf("%s: all %u ticks agree (%u partial, %u iterations, %u of them cut), %u threads, state %016" PRIx64
                 "%s\n",
                 r->path, report->tick, n->partial, n->iterations, n->cut, r->job.port.port.n_workers,
                 smr_state_hash(r->job.state), report->full ? "; the log was full then" : "");
}

static void print_difference(const replayed *r, const smr_replay_report *report)
{
    const smr_log_record *const a = &report->record, *const b = &report->found;
    (void)printf("%s: tick %u of %u differs: recorded iteration %u, %u vertices, %u forces, state %016" PRIx64
                 "; here %u, %u, %u, %016" PRIx64 "\n",
                 r->path, report->tick, r->counts.ticks, a->iteration, a->n_taken, a->n_forces, a->state_hash,
                 b->iteration, b->n_taken, b->n_forces, b->state_hash);
}

static int repeat(replayed *r, host_error *error)
{
    smr_replay replay;
    smr_replay_report report;
    smr_status status = smr_replay_start(r->job.state, r->log.log, r->log.log_bytes, input_of, &r->job, &replay);
    if (status != SMR_OK) {
        (void)refuse_start(r, status, error);
        return HOST_REFUSED;
    }
    do {
        status = smr_replay_tick(&replay, &report);
    } while (status == SMR_OK && !report.ended && !report.differs);
    if (status != SMR_OK) {
        (void)refuse_tick(r, &report, status, error);
        return HOST_REFUSED;
    }
    if (report.differs)
        print_difference(r, &report);
    else
        print_agreement(r, &report);
    return report.differs ? HOST_DIFFERS : HOST_DONE;
}

static int run(replayed *r, uint32_t threads, host_error *error)
{
    host_job *const job = &r->job;
    if (host_log_read(r->path, &r->log, error) != 0 || count_ticks(r, error) != 0 ||
        check_inputs(&r->log, error) != 0 || read_options(r, threads, error) != 0)
        return HOST_REFUSED;
    job->options = &r->options;
    if (host_port_open(&job->port, threads, error) != 0 || host_job_load(job, error) != 0 ||
        host_job_match(job, error) != 0 || host_job_prepare(job, error) != 0 || host_job_begin(job, error) != 0)
        return HOST_REFUSED;
    return repeat(r, error);
}

/* earlier 1: landmarks start by a spline, as versions did that knew no other start by them. *again: try that. */
static int replay(const host_options *options, int earlier, int *again, host_error *error)
{
    replayed r = {0};
    r.path = options->operands.path[0];
    r.earlier = earlier;
    int result = run(&r, options->threads, error);
    *again = result == HOST_REFUSED && !earlier && r.options.landmarks.n > 0 && r.options.spline_if_better;
    if (result == HOST_REFUSED && !*again)
        host_error_keep(error); /* it may borrow one of the log's texts */
    host_job_free(&r.job);
    host_options_free(&r.options);
    host_log_free(&r.log);
    free(r.arguments);
    return result;
}

int host_replay(const host_options *options, host_error *error)
{
    const host_error none = *error;
    int again = 0;
    const int result = replay(options, 0, &again, error);
    if (!again)
        return result;
    *error = none;
    return replay(options, 1, &again, error);
}
