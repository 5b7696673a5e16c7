/* test_jacobi.c: eigenvectors of symmetric matrices. Accuracy against double precision, relative to the largest entry:
 * eigenvalues 2e-6, A V = V D 4e-6, V a rotation 3e-6, pseudo-inverse times s 1e-4 for condition numbers to 100.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>

#include "geometry/linear_solve/eigen_jacobi.h"
#include "oracle.h"

/* R diag(value) R^T as six floats; full: what those floats say, in double. */
static void make(const double value[3], const double r[9], float s[6], double full[9])
{
    static const int at[6] = {0, 1, 2, 4, 5, 8}, mirror[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    double d[9] = {value[0], 0, 0, 0, value[1], 0, 0, 0, value[2]}, t[9];
    oracle_transpose(r, t);
    oracle_product(r, d, d);
    oracle_product(d, t, d);
    for (int i = 0; i < 6; i++)
        s[i] = (float)d[at[i]];
    for (int i = 0; i < 9; i++)
        full[i] = (double)s[mirror[i]];
}

static double largest(const double m[9])
{
    double l = 0.0;
    for (int i = 0; i < 9; i++)
        l = fmax(l, fabs(m[i]));
    return l;
}

/* Spectra of every kind: random, double, triple, zero, negative, spread over six decades. */
static void spectrum(oracle_random *r, uint32_t kind, double value[3])
{
    for (int i = 0; i < 3; i++)
        value[i] = oracle_uniform(r, -1.0, 1.0);
    switch (kind) {
    case 1: value[1] = value[0]; break;
    case 2: value[1] = value[2] = value[0]; break;
    case 3: value[2] = 0.0; break;
    case 4: value[1] = value[2] = 0.0; break;
    case 5:
        for (int i = 0; i < 3; i++)
            value[i] = pow(10.0, oracle_uniform(r, -6.0, 0.0));
        break;
    case 6: value[1] = value[0] + 1e-6; break;
    default: break;
    }
}

static void eigen_against_double(void **state)
{
    oracle_random r = oracle_seed(10);
    double worst_value = 0.0, worst_vector = 0.0, worst_rotation = 0.0;
    (void)state;
    for (uint32_t i = 0; i < 20000u; i++) {
        double value[3], turn[9], full[9], want[3], v[9], wide[9];
        float s[6], got[3], gv[9];
        spectrum(&r, i % 8u, value);
        const double size = pow(10.0, oracle_uniform(&r, -6.0, 6.0));
        for (int k = 0; k < 3; k++)
            value[k] *= size;
        oracle_rotation(&r, turn);
        make(value, turn, s, full);
        const double scale = fmax(largest(full), 1e-12);
        oracle_eigen(full, want, v);
        smr_eigen(s, got, gv);
        assert_true(got[0] >= got[1] && got[1] >= got[2]);
        oracle_widen(gv, wide, 9);
        worst_rotation = fmax(worst_rotation, oracle_not_rotation(wide));
        double av[9];
        oracle_product(full, wide, av);
        for (int k = 0; k < 9; k++)
            worst_vector = fmax(worst_vector, fabs(av[k] - wide[k] * (double)got[k % 3]) / scale);
        for (int k = 0; k < 3; k++)
            worst_value = fmax(worst_value, fabs((double)got[k] - want[k]) / scale);
    }
    assert_true(oracle_within("eigen: value", worst_value, 2e-6));
    assert_true(oracle_within("eigen: A V - V D", worst_vector, 4e-6));
    assert_true(oracle_within("eigen: V is a rotation", worst_rotation, 3e-6));
}

static void eigen_of_plain_matrices(void **state)
{
    static const float plain[][6] = {{0, 0, 0, 0, 0, 0}, {1, 0, 0, 1, 0, 1}, {1, 0, 0, 2, 0, 3}, {3, 0, 0, 2, 0, 1},
                                     {2, 0, 0, 3, 0, 1}, {1, 1, 1, 1, 1, 1}, {0, 1, 0, 0, 0, 0}, {0, 0, 0, 0, 1, 0}};
    (void)state;
    for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++) {
        float value[3], v[9];
        double wide[9];
        smr_eigen(plain[i], value, v);
        oracle_widen(v, wide, 9);
        assert_true(oracle_not_rotation(wide) < 1e-6);
        assert_true(value[0] >= value[1] && value[1] >= value[2]);
        const float trace = plain[i][0] + plain[i][3] + plain[i][5];
        assert_true(fabsf(value[0] + value[1] + value[2] - trace) < 1e-5f);
    }
}

/* From a start near the answer two sweeps are enough, and V stays a rotation. */
static void warm_start(void **state)
{
    oracle_random r = oracle_seed(11);
    double worst = 0.0, worst_rotation = 0.0;
    (void)state;
    for (uint32_t i = 0; i < 5000u; i++) {
        double value[3] = {oracle_uniform(&r, 5, 9), oracle_uniform(&r, 1, 4), oracle_uniform(&r, 0, 1)}, turn[9];
        double full[9], wide[9], small[9], axis[3] = {oracle_uniform(&r, -1, 1), 1, oracle_uniform(&r, -1, 1)};
        float s[6], d[6], v[9];
        oracle_rotation(&r, turn);
        make(value, turn, s, full);
        oracle_turn(axis, oracle_uniform(&r, -0.05, 0.05), small);
        oracle_product(turn, small, turn);
        for (int k = 0; k < 9; k++)
            v[k] = (float)turn[k];
        smr_congruence(s, v, d);
        smr_jacobi(d, v, 2);
        oracle_widen(v, wide, 9);
        worst_rotation = fmax(worst_rotation, oracle_not_rotation(wide));
        smr_congruence(s, v, d);
        worst =
            fmax(worst, fmax(fabs((double)d[SMR_XY]), fmax(fabs((double)d[SMR_XZ]), fabs((double)d[SMR_YZ]))) / 9.0);
    }
    assert_true(oracle_within("jacobi: off-diagonal after a warm start", worst, 1e-6));
    assert_true(oracle_within("jacobi: V after a warm start", worst_rotation, 3e-6));
}

static void pseudo_inverse(void **state)
{
    static const int full_at[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    oracle_random r = oracle_seed(12);
    double worst = 0.0;
    (void)state;
    for (uint32_t i = 0; i < 10000u; i++) {
        const uint32_t rank = i % 4u; /* 0..3 */
        double value[3], turn[9], full[9], p[9], inverse[9], t[9], project[9];
        float s[6], out[6];
        const double size = pow(10.0, oracle_uniform(&r, -3.0, 6.0));
        for (uint32_t k = 0; k < 3u; k++)
            value[k] = k < rank ? size * oracle_uniform(&r, 0.01, 1.0) : 0.0;
        if (rank > 0)
            value[0] = size;
        oracle_rotation(&r, turn);
        make(value, turn, s, full);
        smr_pseudo_inverse(s, 1.0e-3f, out);
        for (int k = 0; k < 9; k++)
            inverse[k] = (double)out[full_at[k]];
        oracle_product(inverse, full, p); /* must be the projection onto the first `rank` axes */
        double d[9] = {rank > 0, 0, 0, 0, rank > 1, 0, 0, 0, rank > 2};
        oracle_transpose(turn, t);
        oracle_product(turn, d, project);
        oracle_product(project, t, project);
        worst = fmax(worst, oracle_difference(p, project, 9));
    }
    assert_true(oracle_within("pseudo-inverse: S+ S - projection", worst, 1e-4));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eigen_against_double),
        cmocka_unit_test(eigen_of_plain_matrices),
        cmocka_unit_test(warm_start),
        cmocka_unit_test(pseudo_inverse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
