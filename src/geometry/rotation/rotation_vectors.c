/* rotation_vectors.c: rotation matrices from rotation vectors by the Rodrigues formula (paper 2.3, rigid body
 * kinematics), and logarithm and exponential of rigid motions. sin, cos and the other functions of a^2 are polynomials,
 * because results of libm differ between platforms. The polynomials need no branch at small angles, and no difference
 * of nearly equal numbers. The arc tangent is that of Cephes (S. Moshier, atanf).
 * Accuracy against double precision: matrices 2e-7, rotation vectors 6e-7 rad, positions 2e-6 of |turn| |p| + |shift|.
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
    /* R - I = s [w]x + c (w w^T - a^2 I), with [w]x the matrix of the cross product */
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

#define SMR_TERMS 10u /* number of terms of each power series below */

/* Four functions of a^2, and the coefficients of (-a^2)^k, k = 0, 1, ... of each. SINE: sin(a) / a, 1 / (2k + 1)!.
 * COSINE: (1 - cos(a)) / a^2, 1 / (2k + 2)!. CUBIC: (a - sin(a)) / a^3, 1 / (2k + 3)!.
 * INVERSE: (2 (1 - cos(a)) / a^2 - sin(a) / a) / a^2, (k + 1) / (k + 2) / (2k + 3)!. */
enum { SINE, COSINE, CUBIC, INVERSE, SERIES };
static const float terms[SMR_TERMS][SERIES] = {
    {1.0f, 1.0f / 2.0f, 1.0f / 6.0f, 1.0f / 2.0f / 6.0f},
    {1.0f / 6.0f, 1.0f / 24.0f, 1.0f / 120.0f, 2.0f / 3.0f / 120.0f},
    {1.0f / 120.0f, 1.0f / 720.0f, 1.0f / 5040.0f, 3.0f / 4.0f / 5040.0f},
    {1.0f / 5040.0f, 1.0f / 40320.0f, 1.0f / 362880.0f, 4.0f / 5.0f / 362880.0f},
    {1.0f / 362880.0f, 1.0f / 3628800.0f, 1.0f / 39916800.0f, 5.0f / 6.0f / 39916800.0f},
    {1.0f / 39916800.0f, 1.0f / 479001600.0f, 1.0f / 6227020800.0f, 6.0f / 7.0f / 6227020800.0f},
    {1.0f / 6227020800.0f, 1.0f / 87178291200.0f, 1.0f / 1307674368000.0f, 7.0f / 8.0f / 1307674368000.0f},
    {1.0f / 1307674368000.0f, 1.0f / 20922789888000.0f, 1.0f / 355687428096000.0f, 8.0f / 9.0f / 355687428096000.0f},
    {1.0f / 355687428096000.0f, 1.0f / 6402373705728000.0f, 1.0f / 121645100408832000.0f,
     9.0f / 10.0f / 121645100408832000.0f},
    {1.0f / 121645100408832000.0f, 1.0f / 2432902008176640000.0f, 0.0f, 0.0f},
};

/* Returns the function `which`, SINE, COSINE, CUBIC or INVERSE, of the squared angle a2, rad^2. */
static inline float series(uint32_t which, float a2)
{
    float sum = terms[SMR_TERMS - 1u][which];
    for (uint32_t k = SMR_TERMS - 1u; k-- > 0u;)
        sum = terms[k][which] - a2 * sum;
    return sum;
}

/* Returns atan(y / x) / y for x >= 0 and y >= 0, not both 0; the limit 1 / x where y is 0. */
static float arc_over(float y, float x)
{
    /* atan(y / x) is pi / 4 + atan((y - x) / (y + x)) above pi / 8, pi / 2 - atan(x / y) above 3 pi / 8 */
    const int far = y > 2.4142136f * x, middle = !far && y > 0.41421357f * x;
    const float z = far ? -x / y : (middle ? (y - x) / (y + x) : y / x), z2 = z * z;
    const float p = 1.0f + z2 * (-3.33329491539e-1f +
                                 z2 * (1.99777106478e-1f + z2 * (-1.38776856032e-1f + z2 * 8.05374449538e-2f)));
    if (!far && !middle)
        return p / x;
    return ((far ? 1.5707964f : 0.78539818f) + z * p) / y;
}

/* Finds a multiple of R's quaternion (w, q); the largest of four squares, 1 or more, picks the formula (Shepperd 1978),
 * so (w, q) is not 0. */
smr_vec smr_rotation_log(const float m[9])
{
    const float w2 = 4.0f + m[0] + m[4] + m[8]; /* 4 w^2 of the quaternion (w, x, y, z); below: 4 x^2, 4 y^2, 4 z^2 */
    const float x2 = m[0] - m[4] - m[8], y2 = m[4] - m[0] - m[8], z2 = m[8] - m[0] - m[4];
    const smr_vec skew = smr_v(m[7] - m[5], m[2] - m[6], m[3] - m[1]);
    smr_vec q;
    float w;
    if (w2 >= x2 && w2 >= y2 && w2 >= z2)
        w = w2, q = skew;
    else if (x2 >= y2 && x2 >= z2)
        w = skew.x, q = smr_v(x2, m[1] + m[3], m[2] + m[6]);
    else if (y2 >= z2)
        w = skew.y, q = smr_v(m[1] + m[3], y2, m[5] + m[7]);
    else
        w = skew.z, q = smr_v(m[2] + m[6], m[5] + m[7], z2);
    /* (w, q) and (-w, -q) are one rotation: makes w positive, so that the angle is at most half a turn */
    if (w < 0.0f)
        q = smr_scale(q, -1.0f);
    w = smr_abs(w);
    const float length = smr_length(q);
    return smr_turn_within(smr_scale(q, 2.0f * arc_over(length, w)), SMR_HALF_TURN);
}

smr_twist smr_twist_about(smr_vec turn, smr_vec centre, smr_vec shift)
{
    const float a2 = smr_dot(turn, turn);
    const float k = 0.5f * series(INVERSE, a2) / series(COSINE, a2);
    /* the shift adds V^-1 shift to the rate, with V^-1 = I - [turn] / 2 + k [turn]^2 */
    const smr_vec across = smr_cross(turn, shift);
    const smr_vec bent = smr_sub(smr_scale(smr_cross(turn, across), k), smr_scale(across, 0.5f));
    return (smr_twist){turn, smr_sub(smr_add(shift, bent), smr_cross(turn, centre))};
}

/* Returns V (turn x p + u), V = I + (1 - cos a) / a^2 [turn] + (a - sin a) / a^3 [turn]^2; small motions keep digits */
smr_vec smr_twist_move(smr_twist twist, smr_vec p, smr_vec *normal)
{
    const smr_vec turn = smr_turn_within(twist.turn, SMR_HALF_TURN);
    const float a2 = smr_dot(turn, turn), c = series(COSINE, a2);
    const smr_vec rate = smr_add(smr_cross(turn, p), twist.rate), across = smr_cross(turn, rate);
    const smr_vec bent = smr_add(smr_scale(across, c), smr_scale(smr_cross(turn, across), series(CUBIC, a2)));
    const smr_vec aside = smr_cross(turn, *normal);
    *normal = smr_add(*normal, smr_add(smr_scale(aside, series(SINE, a2)), smr_scale(smr_cross(turn, aside), c)));
    return smr_add(rate, bent);
}
