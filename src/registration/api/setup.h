/* setup.h: what the files of this folder share: how a registration is laid out, and which inputs a restored one waits
 * for.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SETUP_H
#define SMR_SETUP_H

#include "registration/registration.h"

/* layout.c */

/* Everything that follows from model and configuration alone; the rest is 0. */
void smr_count(smr *s, const smr_model *model, const smr_config *config);

/* Lists all slots and all that is kept (base/keep.h). Returns the slot of the registration itself; NULL when measuring,
 * or while kept values are gone over. The counts are in s already. */
smr *smr_layout(smr_arena *a, smr *s);

/* The stages' views of each other. */
void smr_wire(smr *s);

/* targets.c: distinct surfaces, their tasks and slots. goal may be NULL. Returns the slots they need. */
uint64_t smr_list_goals(const smr_surface_goals *g, smr_goal *goal, uint32_t *n_goals, uint32_t *n_tasks);

/* The same into g, and what else follows from the surfaces that structures have. */
void smr_take_goals(smr_surface_goals *g);
void smr_note_target(smr_surface_goals *g, uint32_t first, uint32_t last);    /* what these structures have got */
void smr_note_like(smr_surface_goals *g, uint32_t structure, uint32_t other); /* as another one */

/* Gives a structure, or SMR_ALL, a surface or a cloud, as smr_set_surface() and smr_set_points(). */
smr_status smr_set_target(smr *s, uint32_t structure, const smr_surface *surface);

/* keep_fields.c: goes over what is kept beside slots. */
void smr_keep_fields(smr_arena *a, smr *s);

/* waiting.c: borrowed inputs are not saved but their checksums, and a restored registration waits for the same ones. */

/* Lists which surfaces there are, which structures share them, the image, the caller's goals and force. */
void smr_keep_inputs(smr_arena *a, smr *s);

/* 1: there is memory for the list of what is waited for (not so in a forged model of empty structures alone). */
int smr_can_wait(const smr_shared *c);

/* 1: the log's memory is waited for. */
int smr_awaits_log(const smr_log *log);

/* Takes an input that s waits for; kind, number and what as in smr_log_note(), a smr_caller_force for FORCE.
 * Errors: E_INPUT, E_STATE (NULL), E_ARENA; as smr_set_...(). */
smr_status smr_await(smr *s, uint32_t kind, uint32_t number, const void *what);
smr_status smr_await_log(smr *s, void *memory, size_t bytes); /* NULL: recording ends. E_ARENA, E_LOG (another log) */

#endif
