/* unit_log.h: a small registration, its inputs and its log, for the tests of recording and replaying.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_LOG_H
#define UNIT_LOG_H

#include "smr.h"

#define UNIT_LOG_BYTES SMR_LOG_BYTES(200, 40)

/* A ball between two target surfaces. */
typedef struct unit_log {
    const smr_model *model;
    smr_mesh ball, goal[2];
    const smr_surface *surface[2];
    smr_config config;
    smr_points *cloud[2]; /* these three of unit_log_make_kinds() only */
    smr_goals goals[2];
    smr_caller_force force;
    smr_motion motion; /* of unit_log_make_motion() only */
    uint32_t ticks;
    int small;
    unsigned char log[UNIT_LOG_BYTES];
    size_t bytes;
} unit_log;

/* Sets up and records: a pose, a surface, 20 ticks cut by a clock, the other surface, 20 more ticks. rig_free_all()
 * frees it. */
void unit_log_make(unit_log *u);

/* With every kind of record but an image's: landmarks, goals and a force of the caller's own, clouds, positions, all
 * of them taken away again; the schedule is short and targets are followed after it. small: 12 vertices, few ticks. */
void unit_log_make_kinds(unit_log *u, int small);

/* With dynamics: masses and velocities, a surface, both again. */
void unit_log_make_motion(unit_log *u);

/* For smr_replay_start(), ctx is the unit_log: the input of that kind and checksum, or another one of that kind. */
const void *unit_log_input(void *ctx, const smr_log_record *record);

/* The one that a test program shares, and its CMocka fixtures. */
extern unit_log unit_recorded;
int unit_log_set_up(void **state);
int unit_log_tidy(void **state);

/* A registration of it as smr_init leaves it. port may be NULL. */
smr *unit_log_begin(const unit_log *u, const smr_port *port);

/* Records of a log. */
uint32_t unit_log_records(const unsigned char *log, size_t bytes);

/* The log's record number i from 0: where it begins, and its bytes; 0 past the end. */
size_t unit_log_record(const unsigned char *log, size_t bytes, uint32_t i, size_t *record_bytes);

/* Makes the checksums of header and records right again after a change. */
void unit_log_seal(unsigned char *log, size_t bytes);

#endif
