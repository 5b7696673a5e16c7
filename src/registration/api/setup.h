/* setup.h: layout and save of a registration, and the inputs that a restored registration waits for.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SETUP_H
#define SMR_SETUP_H

#include "registration/registration.h"

/* Sets all fields that follow from model and configuration alone; the other fields become 0. */
void smr_count(smr *s, const smr_model *model, const smr_config *config);

/* Lists all arrays and saved values of s, after smr_count(). Returns the registration's place in the arena, or NULL. */
smr *smr_layout(smr_arena *a, smr *s);

/* Lists distinct targets (goal may be NULL); counts them and search tasks. Returns the needed size of target_warm. */
uint64_t smr_list_goals(const smr_surface_goals *g, smr_goal *goal, uint32_t *n_goals, uint32_t *n_tasks);
void smr_take_goals(smr_surface_goals *g); /* lists the distinct targets in g->goal; counts clouds and their points */
/* stores size and checksum of the target that structures first .. last - 1 share */
void smr_note_target(smr_surface_goals *g, uint32_t first, uint32_t last);
/* copies size and checksum of the target of structure `other` */
void smr_note_like(smr_surface_goals *g, uint32_t structure, uint32_t other);

/* Checks whether an input may be set. Errors: E_NULL, E_CONFIG (not built), E_STATE (not legal, or a tick runs),
 * E_DAMAGED. */
smr_status smr_settable(const smr *s, int built, int legal);

/* For a new input: marks measures as outdated, and discards results of searches, whose progress a replay does not know.
 * Incomplete forces start again; with complete ones the iteration ends. changed: as in smr_tracking_changed(). */
void smr_restart_forces(smr *s, uint32_t changed);

#define SMR_SAVED_MAGIC 0x53524d53u /* "SMRS" */
#define SMR_SAVED_VERSION 2u        /* version of the saved bytes that this library writes and reads */
#define SMR_SAVED_FIXED 32u         /* bytes of a save's header */

/* Words of a save's header. The configuration's words, the saved values and a CRC-32 of all bytes before follow. */
enum {
    SMR_SAVED_AT_MAGIC = 0,
    SMR_SAVED_AT_VERSION,
    SMR_SAVED_AT_BYTES,
    SMR_SAVED_AT_LIBRARY,
    SMR_SAVED_AT_MODEL,
    SMR_SAVED_AT_VERTICES,
    SMR_SAVED_AT_PLAN, /* checksum of the list of saved values, which differs between versions */
    SMR_SAVED_AT_CONFIG_WORDS
};

/* counts, saves, checks or restores fields of structs, and of slots the values in bytes k->first .. k->last - 1 */
void smr_go_over(smr *s, smr_keeper *k);
#define SMR_KEEP_PIECE 2048u /* bytes of a save that a task saves, checks or restores */

/* Returns the byte behind those of slots that a pass from byte `at` on processes, of `all`; the first pass: none. */
static inline size_t smr_keep_end(size_t at, size_t all, uint32_t whole)
{
    return whole || all - at < SMR_KEEP_PIECE ? all : at + (at == 0u ? SMR_SAVED_FIXED : SMR_KEEP_PIECE);
}

/* restore_awaited_inputs.c: saves checksums of the caller's inputs, and which structures share a surface. */
void smr_keep_inputs(smr_arena *a, smr *s);
/* Checksums of the present inputs in the making, in the list that smr_keep_inputs() saves. */
typedef struct smr_summing {
    uint32_t at, begun; /* entry of the list; 1: `sum` has begun */
    smr_input_sum sum;
} smr_summing;
int smr_sum_inputs(const smr *s, smr_summing *j,
                   uint32_t most);      /* adds items, as smr_sum_add(). Returns 1 at the end */
int smr_can_wait(const smr_shared *c);  /* 0: no memory for the list of awaited inputs: a forged model */
int smr_awaits_log(const smr_log *log); /* 1: restored without the log's memory, which must be set */

/* Sets an awaited input `what` of this kind (SMR_LOG_...) and number (structure or index). Errors: as smr_set_...(). */
smr_status smr_await(smr *s, uint32_t kind, uint32_t number, const void *what);
smr_status smr_await_log(smr *s, void *memory, size_t bytes); /* sets the awaited log or NULL. Errors: E_ARENA, E_LOG */

#endif
