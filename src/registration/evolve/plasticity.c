/* plasticity.c: the reference shape follows the positions, x^r = x (paper 2.3, the last line of an iteration). When it
 * does is decided by tick/schedule.c.
 * SPDX-License-Identifier: MIT */
#include "registration/evolve/evolve.h"

void smr_plastic_positions(smr_shape *shape)
{
    memcpy(shape->x_ref, shape->x, 3u * (size_t)shape->shared->n * sizeof(float));
}

void smr_plastic_normals(smr_shape *shape)
{
    memcpy(shape->normal_ref, shape->normal, 3u * (size_t)shape->shared->n * sizeof(float));
}
