/* setup.h: how a registration is laid out, and which inputs a restored one waits for.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SETUP_H
#define SMR_SETUP_H

#include "registration/registration.h"


/* Sets everything that follows from model and configuration alone; the rest is 0. */
void smr_count(smr *s, const smr_model *model, const smr_config *config);

/* Lists all slots and all saved values. Returns the slot of the registration; NULL when measuring or saving. The
 * counts in s are already set. */
smr *smr_layout(smr_arena *a, smr *s);

/* Connects the stages to what they read. */
void smr_wire(smr *s);

/* Lists distinct targets, their tasks and indexes. goal may be NULL. Returns the number of indexes needed. */
uint64_t smr_list_goals(const smr_surface_goals *g, smr_goal *goal, uint32_t *n_goals, uint32_t *n_tasks);

/* Lists the targets into g, and sets what else follows from them. */
void smr_take_goals(smr_surface_goals *g);
void smr_note_target(smr_surface_goals *g, uint32_t first, uint32_t last); /* stores the clouds of these structures */
/* copies the stored cloud of another structure */
void smr_note_like(smr_surface_goals *g, uint32_t structure, uint32_t other);

/* Gives a structure, or SMR_ALL, a surface or a cloud, as smr_set_surface() and smr_set_points(). */
smr_status smr_set_target(smr *s, uint32_t structure, const smr_surface *surface);

/* save_state_fields.c: goes over what is kept beside slots. */
void smr_keep_fields(smr_arena *a, smr *s);

/* Saves checksums of the caller's inputs; a restored registration waits for the same inputs. */

/* Saves which surfaces there are, which structures share them, the image, the caller's goals and force. */
void smr_keep_inputs(smr_arena *a, smr *s);

/* Returns 1 when there is memory for the list of awaited inputs (not in a forged model of empty structures). */
int smr_can_wait(const smr_shared *c);

int smr_awaits_log(const smr_log *log);

/* Takes an input that s waits for; kind, number and what as in smr_log_note(), a smr_caller_force for FORCE.
 * Errors: E_INPUT, E_STATE (NULL), E_ARENA; as smr_set_...(). */
smr_status smr_await(smr *s, uint32_t kind, uint32_t number, const void *what);
smr_status smr_await_log(smr *s, void *memory, size_t bytes); /* NULL: recording ends. E_ARENA, E_LOG (another log) */

#endif
