/* rig_motion.h: a model with mass in time: set-up of tests of dynamics, and what its energy does.
 * SPDX-License-Identifier: MIT */
#ifndef RIG_MOTION_H
#define RIG_MOTION_H

#include "property/rig.h"

typedef struct rig_motion {
    const smr_model *model;
    smr_config config; /* dynamics on, at the first radius */
    uint32_t n;        /* vertices */
    float *mass;       /* [n] g: 1 */
    float *speed;      /* [n][3] mm/s: 0 */
} rig_motion;

rig_motion rig_motion_make(const smr_mesh *mesh, const smr_prepare_config *radii);

/* n by n vertices around the origin, `step` apart along x and y. */
smr_mesh rig_plate(uint32_t n, float step);

/* Velocities of a spin about the centre, a bend along x and a translation, for the vertices that are not pinned. */
void rig_throw(rig_motion *m, const smr_mesh *mesh, const float centre[3], float spin, float bend);

smr_energy rig_energy(const smr *s);
void rig_steps(smr *s, uint32_t n); /* whole time steps */

/* Time steps, at most n, until kinetic and elastic energy come to more than before and `more` of the first kinetic one.
 * left[0], left[1]: of the first kinetic energy what is there after the last step, and before it. Returns how many have
 * passed. */
uint32_t rig_falls(smr *s, uint32_t n, float more, double left[2]);

#endif
