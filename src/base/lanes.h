/* lanes.h: floats and vectors of several positions, computed at once, since compilers do not vectorise every loop. Each
 * lane has the bits of the same computation with one float, so the number of lanes changes no bit.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_LANES_H
#define SMR_LANES_H

#include "base/vec.h"

/* Positions that are computed at once. Processors without vectors have few registers, and shorter pieces with two. */
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
#define SMR_LANES 2u
typedef float smr_lanes __attribute__((vector_size(8)));
#else
#define SMR_LANES 4u
typedef float smr_lanes __attribute__((vector_size(16)));
#endif

typedef struct smr_lanes3 {
    smr_lanes x, y, z;
} smr_lanes3;

/* Return lanes that all hold the value a. The difference from 0 keeps all bits, a negative 0 included. */
static inline smr_lanes smr_lanes_of(float a) { return a - (smr_lanes){0}; }
static inline smr_lanes3 smr_lanes3_of(smr_vec a)
{
    return (smr_lanes3){smr_lanes_of(a.x), smr_lanes_of(a.y), smr_lanes_of(a.z)};
}

/* Return, and set, the vector in lane l of several vectors. */
static inline smr_vec smr_lane(const smr_lanes3 *a, uint32_t l) { return smr_v(a->x[l], a->y[l], a->z[l]); }
static inline void smr_lane_set(smr_lanes3 *a, uint32_t l, smr_vec v)
{
    a->x[l] = v.x;
    a->y[l] = v.y;
    a->z[l] = v.z;
}

static inline smr_lanes3 smr_lanes3_add(smr_lanes3 a, smr_lanes3 b)
{
    return (smr_lanes3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline smr_lanes3 smr_lanes3_scale(smr_lanes3 a, smr_lanes s) { return (smr_lanes3){a.x * s, a.y * s, a.z * s}; }
static inline smr_lanes smr_lanes3_dot(smr_lanes3 a, smr_lanes3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* Returns a less each of b[n] times s[n], one after the other. */
static inline smr_lanes3 smr_lanes3_less(smr_lanes3 a, const smr_lanes3 *b, const float *s, uint32_t n)
{
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M' /* compilers would keep vectors of two in memory */
    float x0 = a.x[0], x1 = a.x[1], y0 = a.y[0], y1 = a.y[1], z0 = a.z[0], z1 = a.z[1];
    for (uint32_t j = 0; j < n; j++) {
        x0 -= b[j].x[0] * s[j];
        x1 -= b[j].x[1] * s[j];
        y0 -= b[j].y[0] * s[j];
        y1 -= b[j].y[1] * s[j];
        z0 -= b[j].z[0] * s[j];
        z1 -= b[j].z[1] * s[j];
    }
    return (smr_lanes3){{x0, x1}, {y0, y1}, {z0, z1}};
#else
    for (uint32_t j = 0; j < n; j++)
        a = (smr_lanes3){a.x - b[j].x * s[j], a.y - b[j].y * s[j], a.z - b[j].z * s[j]};
    return a;
#endif
}

#endif
