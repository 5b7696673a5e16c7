/* setup.h: how a registration is laid out and saved, and which inputs a restored one waits for.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SETUP_H
#define SMR_SETUP_H

#include "registration/tick/iteration_steps.h"

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

/* Marks measures as outdated. An iteration whose forces are not complete starts them again; otherwise it ends with
 * the old goals. Discards all results of searches, since a replay does not know how far they had come. changed: as
 * in smr_tracking_changed(). */
static inline void smr_restart_forces(smr *s, uint32_t changed)
{
    smr_surface_goals *g = &s->forces.surface;
    for (uint32_t j = 0; g->target_warm != NULL && j < s->shared.config.basic.n_target_vertices; j++)
        g->target_warm[j] = SMR_NONE;
    for (uint32_t i = 0; i < s->shared.n_structures; i++)
        g->target[i].measured = 0;
    smr_forces_unmeasured(&s->forces);
    smr_tracking_changed(s, changed);
    if (!smr_forces_pending(s))
        return;
    smr_pulls_clear(g);
    s->step = s->next_task = 0;
}

#define SMR_SAVED_MAGIC 0x53524d53u /* "SMRS" */
#define SMR_SAVED_VERSION 1u
#define SMR_SAVED_FIXED 32u /* bytes of a header before the configuration */

/* Words of the header. Then follow the configuration's words, the saved values, and a CRC-32 of everything. */
enum {
    SMR_SAVED_AT_MAGIC = 0,
    SMR_SAVED_AT_VERSION,
    SMR_SAVED_AT_BYTES,
    SMR_SAVED_AT_LIBRARY,
    SMR_SAVED_AT_MODEL,
    SMR_SAVED_AT_VERTICES,
    SMR_SAVED_AT_PLAN, /* checksum of the list of saved values: another list is another version */
    SMR_SAVED_AT_CONFIG_WORDS
};

/* save_state_fields.c: goes over all slots and fields, in the keeper's mode. */
void smr_go_over(smr *s, smr_keeper *k);

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
