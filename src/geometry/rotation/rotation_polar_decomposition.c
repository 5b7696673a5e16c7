/* rotation_polar_decomposition.c: the rotation nearest to a 3x3 matrix (paper 2.3, "polar decomposition"; Mueller et
 * al., "Meshless deformations based on shape matching", 2005).
 * Method: A^T A = V lambda V^T by cyclic Jacobi, warm-started from the last V; then R = U V^T with U = A V lambda^-1/2.
 * That equals the paper's A (A^T A)^-1/2 and stays defined when A is singular.
 * Bounds: 4 sweeps. Accuracy against double precision: 2e-6 for condition numbers up to 10, 2e-5 to 30, 2e-4 to 100.
 * SPDX-License-Identifier: MIT */
#include "geometry/linear_solve/eigen_jacobi.h"
#include "geometry/rotation/rotation.h"

#define SMR_SWEEPS_WARM 4u     /* number of Jacobi sweeps, which start from the eigenvectors of the last call */
#define SMR_RANK_FLOOR 1.0e-3f /* smallest singular value that does not count as 0 / largest singular value */

/* Returns a unit vector perpendicular to the unit vector a, always the same one for the same a. */
static smr_vec any_normal(smr_vec a)
{
    float x = smr_abs(a.x), y = smr_abs(a.y), z = smr_abs(a.z);
    smr_vec axis = x <= y && x <= z ? smr_v(1, 0, 0) : (y <= z ? smr_v(0, 1, 0) : smr_v(0, 0, 1));
    return smr_unit(smr_cross(a, axis));
}

/* Makes the matrix v a rotation again (Gram-Schmidt), because rounding errors add up in successive warm starts. */
static void orthonormalise(float v[9])
{
    const smr_vec a = smr_unit(smr_axis(v, 0)), oblique = smr_axis(v, 1);
    const smr_vec b = smr_unit(smr_sub(oblique, smr_scale(a, smr_dot(a, oblique)))), c = smr_cross(a, b);
    const float m[9] = {a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z};
    memcpy(v, m, sizeof m);
}

/* Writes R - I for the shortest rotation R from the unit vector a to the unit vector b, at most 90 degrees apart. */
static void shortest_near(smr_vec a, smr_vec b, float m[9])
{
    const smr_vec w = smr_cross(a, b);
    const float c = smr_dot(a, b), k = 1.0f / (1.0f + c), w2 = smr_dot(w, w);
    const float r[9] = {k * (w.x * w.x - w2), k * w.x * w.y - w.z,  k * w.x * w.z + w.y,
                        k * w.y * w.x + w.z,  k * (w.y * w.y - w2), k * w.y * w.z - w.x,
                        k * w.z * w.x - w.y,  k * w.z * w.y + w.x,  k * (w.z * w.z - w2)};
    memcpy(m, r, sizeof r);
}

/* Writes m = R - I for the shortest rotation R from a to b at any angle. Beyond 90 degrees 1 / (1 + c) would magnify
 * rounding errors, so R is a half turn H about the common normal n, from a to -a, and then a short rotation S. */
static void shortest(smr_vec a, smr_vec b, float m[9])
{
    if (smr_dot(a, b) >= 0.0f) {
        shortest_near(a, b, m);
        return;
    }
    const smr_vec w = smr_cross(a, b);
    const smr_vec n = smr_dot(w, w) > 1.0e-8f ? smr_unit(smr_sub(w, smr_scale(a, smr_dot(w, a)))) : any_normal(a);
    const float half[9] = {2 * n.x * n.x - 1, 2 * n.x * n.y, 2 * n.x * n.z, 2 * n.y * n.x,    2 * n.y * n.y - 1,
                           2 * n.y * n.z,     2 * n.z * n.x, 2 * n.z * n.y, 2 * n.z * n.z - 1};
    float s[9];
    shortest_near(smr_scale(a, -1.0f), b, s);
    for (int i = 0; i < 9; i++) /* R - I = (S - I) H + H - I */
        m[i] = s[i / 3 * 3] * half[i % 3] + s[i / 3 * 3 + 1] * half[3 + i % 3] + s[i / 3 * 3 + 2] * half[6 + i % 3] +
               half[i] - (i % 4 == 0 ? 1.0f : 0.0f);
}

void smr_polar(const float a[9], float v[9], float m[9])
{
    float largest = 0.0f;
    for (int i = 0; i < 9; i++)
        largest = smr_max(largest, smr_abs(a[i]));
    memset(m, 0, 9u * sizeof *m);
    if (!(largest > 1.0e-20f))
        return;
    float n[9], s[6], d[6];
    for (int i = 0; i < 9; i++)
        n[i] = a[i] / largest;
    const smr_vec column[3] = {smr_axis(n, 0), smr_axis(n, 1), smr_axis(n, 2)};
    smr_products(column, column, s); /* s = A^T A / largest^2 */
    smr_congruence(s, v, d);
    smr_jacobi(d, v, SMR_SWEEPS_WARM);
    orthonormalise(v);
    /* k is the index of the smallest eigenvalue; directions i and j determine R. (vi, vj, vk) is a proper rotation. */
    int k = d[SMR_XX] <= d[SMR_YY] && d[SMR_XX] <= d[SMR_ZZ] ? 0 : (d[SMR_YY] <= d[SMR_ZZ] ? 1 : 2);
    int i = (k + 1) % 3, j = (k + 2) % 3;
    smr_vec vi = smr_axis(v, i), vj = smr_axis(v, j), vk = smr_axis(v, k);
    smr_vec ui = smr_mul(n, vi), uj = smr_mul(n, vj);
    if (smr_dot(uj, uj) > smr_dot(ui, ui)) {
        smr_vec t = ui;
        ui = uj;
        uj = smr_scale(t, -1.0f);
        t = vi;
        vi = vj;
        vj = smr_scale(t, -1.0f);
    }
    float li = smr_length(ui);
    if (!(li > 1.0e-10f))
        return;
    ui = smr_scale(ui, 1.0f / li);
    uj = smr_sub(uj, smr_scale(ui, smr_dot(ui, uj)));
    float lj = smr_length(uj);
    if (lj <= SMR_RANK_FLOOR * li) {
        shortest(vi, ui, m);
        return;
    }
    uj = smr_scale(uj, 1.0f / lj);
    smr_vec uk = smr_cross(ui, uj);
    const float r[9] = {ui.x * vi.x + uj.x * vj.x + uk.x * vk.x - 1.0f, ui.x * vi.y + uj.x * vj.y + uk.x * vk.y,
                        ui.x * vi.z + uj.x * vj.z + uk.x * vk.z,        ui.y * vi.x + uj.y * vj.x + uk.y * vk.x,
                        ui.y * vi.y + uj.y * vj.y + uk.y * vk.y - 1.0f, ui.y * vi.z + uj.y * vj.z + uk.y * vk.z,
                        ui.z * vi.x + uj.z * vj.x + uk.z * vk.x,        ui.z * vi.y + uj.z * vj.y + uk.z * vk.y,
                        ui.z * vi.z + uj.z * vj.z + uk.z * vk.z - 1.0f};
    memcpy(m, r, sizeof r);
}
