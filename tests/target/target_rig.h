/* target_rig.h: what the programs for the emulated boards share: small models with a target, the board's clock with a
 * record of the step it is read in, and numbers as text.
 * SPDX-License-Identifier: MIT */
#ifndef TARGET_RIG_H
#define TARGET_RIG_H

#include <smr.h>
#include "registration/tick/iteration_steps.h"
#include "smr_baremetal.h"
#include "smr_semihost.h"

/* A surface or an image, one method or the other. */
typedef struct target_case {
    const char *name;
    uint32_t image;  /* 1: two structures of the computed thigh in a patient's image; 0: a bone onto a deformed one */
    uint32_t method; /* SMR_METHOD_... */
    uint32_t part;   /* 1: the deformed bone without its upper end: an open target */
    uint32_t more;   /* 1: contact, volumes, smoothing and fusing by logarithms are on */
    uint32_t moves;  /* 1: dynamics: time steps, which never end; nothing is left out */
} target_case;

#define TARGET_CASES 4u     /* that the table of instructions is made of */
#define TARGET_BUDGETED 10u /* with those that only budgets are tried on */
extern const target_case target_cases[TARGET_BUDGETED];

/* What is registered onto what; one at a time, in static memory. */
typedef struct target_scene {
    const target_case *what;
    const smr_model *model;
    smr_surface *surface; /* NULL with an image */
    smr_mesh goal;        /* that it was built from */
    smr_volume volume;
} target_scene;

int target_set_up(const target_case *what, target_scene *scene);

/* A registration of the scene, in arena 0 or 1. NULL when the library refuses. */
smr *target_start(const target_scene *scene, const smr_config *config, const smr_port *port, uint32_t arena);

/* Puts it where it started. */
int target_again(const target_scene *scene, smr *s);

/* The configuration for the scene's kind: all vertices may take part, a short schedule. */
smr_config target_config(const target_scene *scene);

/* The board's clock, and the longest stretch between two readings within a tick. */
typedef struct target_clock {
    smr_port port;
    const smr *watched;              /* says which step is under way; may be NULL */
    uint64_t last, longest;          /* ns */
    uint64_t in_step[SMR_STEPS_MAX]; /* the longest stretch that ended in a step */
    uint32_t running;                /* 1 within a tick */
} target_clock;

uint64_t target_now(void *clock); /* as smr_port.now_ns */
void target_forget(target_clock *clock);

/* One tick of the watched registration; returns the time it took, ns. */
uint64_t target_tick(smr *s, target_clock *clock, uint64_t budget_ns, smr_tick_report *report, smr_status *status);

/* What a step's work is in proportion to: the model's vertices, triangles, or vertices and indexes of the radius' lists
 * together; or the target's vertices. */
enum { TARGET_VERTICES = 0, TARGET_TRIANGLES, TARGET_INDEXES, TARGET_GOALS, TARGET_UNITS };

/* A step in words, and its unit; number is its place in smr_steps. */
const char *target_step_name(uint32_t number, uint32_t *unit);

void target_text(const char *text);
void target_number(uint64_t value);                 /* digits alone */
void target_line(const char *name, uint64_t value); /* name, number, end of line */
int target_ok(const char *what, int good);          /* says what failed; returns good */
uint32_t target_word(uint32_t otherwise);           /* the number on the command line */

#endif
