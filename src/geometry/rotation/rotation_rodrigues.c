/* rotation_rodrigues.c: rotation matrices from rotation vectors by the Rodrigues formula (paper 2.3, rigid body
 * kinematics). sin and cos are Taylor polynomials to a^13 and a^14, because results of libm differ between platforms.
 * Accuracy: 2e-7 on the whole range.
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation/rotation.h"

/* Writes *sine = sin(a) / a and *cosine = (1 - cos(a)) / a^2 for a2 = a^2, rad^2, 0 .. SMR_ANGLE_MAX^2. */
static void sinc(float a2, float *sine, float *cosine)
{
    float s = 1.0f / 6227020800.0f;
    s = s * a2 - 1.0f / 39916800.0f;
    s = s * a2 + 1.0f / 362880.0f;
    s = s * a2 - 1.0f / 5040.0f;
    s = s * a2 + 1.0f / 120.0f;
    s = s * a2 - 1.0f / 6.0f;
    *sine = s * a2 + 1.0f;
    float c = 1.0f / 87178291200.0f;
    c = c * a2 - 1.0f / 479001600.0f;
    c = c * a2 + 1.0f / 3628800.0f;
    c = c * a2 - 1.0f / 40320.0f;
    c = c * a2 + 1.0f / 720.0f;
    c = c * a2 - 1.0f / 24.0f;
    *cosine = c * a2 + 0.5f;
}

float smr_cos_degrees(float degrees)
{
    const float away = degrees > 90.0f ? degrees - 90.0f : 90.0f - degrees; /* cos(degrees) = +-sin(away) */
    const float half = away * 0.0087266463f;
    float s, c;
    sinc(half * half, &s, &c);
    const float sine = 2.0f * half * s * (1.0f - c * half * half); /* sin 2h = 2 sin h cos h */
    return degrees > 90.0f ? -sine : sine;
}

smr_vec smr_turn_within(smr_vec w, float most)
{
    const float a2 = smr_dot(w, w);
    if (a2 <= most * most)
        return w;
    if (!(a2 < 1.0e30f))
        w = smr_scale(w, 1.0e-25f);
    return smr_scale(smr_unit(w), most);
}

void smr_rodrigues(smr_vec w, float m[9])
{
    float a2 = smr_dot(w, w);
    if (!(a2 <= SMR_ANGLE_MAX * SMR_ANGLE_MAX)) {
        w = smr_turn_within(w, SMR_ANGLE_MAX);
        a2 = SMR_ANGLE_MAX * SMR_ANGLE_MAX;
    }
    float s, c;
    sinc(a2, &s, &c);
    /* R - I = s [w]x + c (w w^T - a^2 I) */
    m[0] = c * (w.x * w.x - a2);
    m[1] = c * w.x * w.y - s * w.z;
    m[2] = c * w.x * w.z + s * w.y;
    m[3] = c * w.x * w.y + s * w.z;
    m[4] = c * (w.y * w.y - a2);
    m[5] = c * w.y * w.z - s * w.x;
    m[6] = c * w.x * w.z - s * w.y;
    m[7] = c * w.y * w.z + s * w.x;
    m[8] = c * (w.z * w.z - a2);
}
