/* vec.h: vectors of three floats, 3x3 matrices (row-major float[9]) and poses.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VEC_H
#define SMR_VEC_H

#include "base/base.h"

typedef struct smr_vec {
    float x, y, z;
} smr_vec;

static inline smr_vec smr_v(float x, float y, float z) { return (smr_vec){x, y, z}; }
static inline smr_vec smr_load(const float *p) { return smr_v(p[0], p[1], p[2]); }

static inline void smr_store(float *p, smr_vec a)
{
    p[0] = a.x;
    p[1] = a.y;
    p[2] = a.z;
}

/* Read (get), write (put) and, below, increase (add) the three floats of element i of an array [n][3]. */
static inline smr_vec smr_get3(const float *array, uint32_t i) { return smr_load(array + 3u * (size_t)i); }
static inline void smr_put3(float *array, uint32_t i, smr_vec a) { smr_store(array + 3u * (size_t)i, a); }

static inline smr_vec smr_add(smr_vec a, smr_vec b) { return smr_v(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline smr_vec smr_sub(smr_vec a, smr_vec b) { return smr_v(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline smr_vec smr_scale(smr_vec a, float s) { return smr_v(a.x * s, a.y * s, a.z * s); }
static inline float smr_dot(smr_vec a, smr_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline void smr_add3(float *array, uint32_t i, smr_vec a) { smr_put3(array, i, smr_add(smr_get3(array, i), a)); }

static inline smr_vec smr_cross(smr_vec a, smr_vec b)
{
    return smr_v(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline float smr_length(smr_vec a) { return SMR_SQRT(smr_dot(a, a)); }

/* Returns the squared distance between the points a and b. */
static inline float smr_distance2(smr_vec a, smr_vec b)
{
    const smr_vec d = smr_sub(a, b);
    return smr_dot(d, d);
}

/* Returns a / |a|; 0 when |a| <= 1e-15. */
static inline smr_vec smr_unit(smr_vec a)
{
    const float l2 = smr_dot(a, a);
    return l2 > 1.0e-30f ? smr_scale(a, 1.0f / SMR_SQRT(l2)) : smr_v(0.0f, 0.0f, 0.0f);
}

/* Returns the matrix-vector product m a. */
static inline smr_vec smr_mul(const float m[9], smr_vec a)
{
    return smr_v(m[0] * a.x + m[1] * a.y + m[2] * a.z, m[3] * a.x + m[4] * a.y + m[5] * a.z,
                 m[6] * a.x + m[7] * a.y + m[8] * a.z);
}

/* Returns a rounded to a whole number, halves away from zero, and limited to +-2^30. */
static inline float smr_whole_number(float a)
{
    const float v = smr_clamp(a, -1073741824.0f, 1073741824.0f);
    return (float)(int32_t)(v + (v < 0.0f ? -0.5f : 0.5f));
}

/* Returns a with each coordinate rounded to a whole number. Subtracting a whole origin loses few digits or none. */
smr_vec smr_whole(smr_vec a);

/* Returns 1 when each coordinate is finite and within +-limit. */
static inline int smr_within3(smr_vec a, float limit)
{
    return smr_within(a.x, limit) && smr_within(a.y, limit) && smr_within(a.z, limit);
}

/* Return, for each coordinate, the smaller (low) and the larger (high) one of the values in a and b. */
static inline smr_vec smr_low(smr_vec a, smr_vec b)
{
    return smr_v(smr_min(a.x, b.x), smr_min(a.y, b.y), smr_min(a.z, b.z));
}
static inline smr_vec smr_high(smr_vec a, smr_vec b)
{
    return smr_v(smr_max(a.x, b.x), smr_max(a.y, b.y), smr_max(a.z, b.z));
}

/* Returns column c, 0 .. 3, of the pose's 3x4 matrix. */
static inline smr_vec smr_column(const smr_pose *p, uint32_t c) { return smr_v(p->m[0][c], p->m[1][c], p->m[2][c]); }

/* Returns the vector a rotated and scaled by the pose, without the pose's translation. */
static inline smr_vec smr_pose_turn(const smr_pose *p, smr_vec a)
{
    return smr_v(p->m[0][0] * a.x + p->m[0][1] * a.y + p->m[0][2] * a.z,
                 p->m[1][0] * a.x + p->m[1][1] * a.y + p->m[1][2] * a.z,
                 p->m[2][0] * a.x + p->m[2][1] * a.y + p->m[2][2] * a.z);
}

/* Returns the point a, mm, moved by the pose. */
static inline smr_vec smr_pose_apply(const smr_pose *p, smr_vec a)
{
    return smr_v(p->m[0][0] * a.x + p->m[0][1] * a.y + p->m[0][2] * a.z + p->m[0][3],
                 p->m[1][0] * a.x + p->m[1][1] * a.y + p->m[1][2] * a.z + p->m[1][3],
                 p->m[2][0] * a.x + p->m[2][1] * a.y + p->m[2][2] * a.z + p->m[2][3]);
}

#endif
