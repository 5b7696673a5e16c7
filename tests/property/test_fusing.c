/* test_fusing.c: a bar whose halves are driven to turn 90 degrees apart keeps the volume of each of its slices within
 * 5 % when clusters are fused by logarithms; the linear mean shrinks it. Two clusters half a quarter turn to either
 * side: the mean of their matrices halves volume, that of logarithms is a rotation. Inputs moved together give the
 * moved result.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "geometry/rotation/rotation.h"
#include "registration/registration.h"

#define AROUND 24u
#define RINGS 51u
#define VERTICES (AROUND * RINGS + 2u)
#define TRIANGLES (2u * AROUND * RINGS)
#define THICK 10.0f   /* mm, half the bar's width */
#define LENGTH 200.0f /* mm, along z */
#define EIGHTH 0.78539816f
#define ITERATIONS 30u

static float straight[3u * VERTICES], bent[3u * VERTICES];
static uint32_t triangles[TRIANGLES][3];

static void triangle(uint32_t *n, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t t[3] = {a, b, c};
    memcpy(triangles[(*n)++], t, sizeof t);
}

static smr_mesh make_bar(void)
{
    uint32_t n = 0;
    memset(straight, 0, sizeof straight);
    for (uint32_t k = 0; k < RINGS; k++)
        for (uint32_t i = 0; i < AROUND; i++) {
            float *p = straight + 3u * (k * AROUND + i);
            p[0] = THICK * cosf(8.0f * EIGHTH * (float)i / (float)AROUND);
            p[1] = THICK * sinf(8.0f * EIGHTH * (float)i / (float)AROUND);
            p[2] = LENGTH * ((float)k / (float)(RINGS - 1u) - 0.5f);
        }
    straight[3u * AROUND * RINGS + 2u] = -0.5f * LENGTH;
    straight[3u * AROUND * RINGS + 5u] = 0.5f * LENGTH;
    for (uint32_t k = 0; k + 1u < RINGS; k++)
        for (uint32_t i = 0; i < AROUND; i++) {
            const uint32_t a = k * AROUND + i, b = k * AROUND + (i + 1u) % AROUND;
            triangle(&n, a, b, b + AROUND);
            triangle(&n, a, b + AROUND, a + AROUND);
        }
    for (uint32_t i = 0; i < AROUND; i++) {
        const uint32_t next = (i + 1u) % AROUND, last = (RINGS - 1u) * AROUND;
        triangle(&n, next, i, AROUND * RINGS);
        triangle(&n, last + i, last + next, AROUND * RINGS + 1u);
    }
    return (smr_mesh){straight, &triangles[0][0], VERTICES, n};
}

/* Where the vertices of the bar go: the halves turn by an eighth of a turn to either side, and the `length` mm between
 * them follow a circle, so that the middle line keeps its length. */
static void bend(float length)
{
    const float radius = length / (2.0f * EIGHTH);
    for (uint32_t v = 0; v < VERTICES; v++) {
        const float *p = straight + 3u * v;
        const float along = fmaxf(-0.5f * length, fminf(0.5f * length, p[2])), beyond = p[2] - along;
        const float c = cosf(along / radius), s = sinf(along / radius), across = radius + p[1];
        const float to[3] = {p[0], c * across - radius - s * beyond, s * across + c * beyond};
        memcpy(bent + 3u * v, to, sizeof to);
    }
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Volume between rings k and k + 1, each closed by its middle, mm^3. */
static double slice(const float *xyz, uint32_t k)
{
    double middle[2][3] = {{0}}, sum = 0.0;
    for (uint32_t i = 0; i < 2u * AROUND; i++)
        for (uint32_t a = 0; a < 3u; a++)
            middle[i / AROUND][a] += (double)xyz[3u * (k * AROUND + i) + a] / AROUND;
    for (uint32_t i = 0; i < AROUND; i++) {
        double p[4][3];
        for (uint32_t c = 0; c < 4u; c++) /* i and the next one, below and above */
            for (uint32_t a = 0; a < 3u; a++)
                p[c][a] = (double)xyz[3u * ((k + c / 2u) * AROUND + (i + c % 2u) % AROUND) + a];
        sum += determinant(p[0], p[1], p[3]) + determinant(p[0], p[3], p[2]) + determinant(p[1], p[0], middle[0]) +
               determinant(p[2], p[3], middle[1]);
    }
    return sum / 6.0;
}

static smr_config springy(uint32_t method, uint32_t fusing)
{
    smr_config c = smr_config_default();
    c.basic.method = method;
    c.motion.fusing = fusing;
    c.caller.goals = 1;
    c.motion.plastic_every = 0;
    c.motion.plastic_um = c.motion.settle_um = c.motion.momentum = c.motion.momentum_last = 0.0f;
    c.motion.fold_guard = 0;
    c.basic.iterations = c.basic.iterations_last = ITERATIONS;
    return c;
}

/* Of the map p -> p + way(p), which is affine. fused: by logarithms, out of the sum w of two records. */
static float determinant_of(int fused, const uint32_t *w, const float inverse[2], float share)
{
    smr_vec column[4];
    for (uint32_t i = 0; i < 4u; i++) { /* the origin and the ends of the axes, far from the model's */
        float r_minus_i[9];
        smr_vec n = smr_v(0, 0, 1);
        const smr_vec p = smr_v(i == 1u ? 21.0f : 20.0f, i == 2u ? 51.0f : 50.0f, i == 3u ? 301.0f : 300.0f);
        const smr_vec t = smr_average_transform(w, inverse, share, r_minus_i); /* of no use where fused */
        const smr_vec linear = smr_add(smr_mul(r_minus_i, p), t);
        const smr_vec way = fused ? smr_twist_move(smr_average_twist(w, inverse, share), p, &n) : linear;
        column[i] = smr_add(p, way);
    }
    for (uint32_t i = 1; i < 4u; i++)
        column[i] = smr_sub(column[i], column[0]);
    return smr_dot(column[1], smr_cross(column[2], column[3]));
}

/* Largest changes of volume, shares: of a slice; around a vertex, as smr_get_local_volume() says; and by what the
 * clusters of a vertex come to in the mean, which is linear: the Jacobian of their blend. */
typedef struct changes {
    double slice, local, blend;
} changes;

static changes bar_changes(const smr_model *model, uint32_t method, uint32_t fusing)
{
    const smr_config config = springy(method, fusing);
    changes worst = {0.0, 0.0, 0.0};
    float ratio[VERTICES];
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, bent, NULL));
    (void)rig_run(s, ITERATIONS);
    const float *x = rig_positions(s, model), inverse[2] = {1.0f / s->sums.scale[0], 1.0f / s->sums.scale[1]};
    for (uint32_t v = 0; v < VERTICES; v++) {
        const uint32_t *w = s->sums.sum + SMR_WORDS * (size_t)v;
        const float d = determinant_of(fusing == SMR_FUSING_LIE, w, inverse, s->reference.share[v]);
        worst.blend = fmax(worst.blend, fabs((double)d - 1.0));
    }
    assert_int_equal(SMR_OK, smr_get_local_volume(s, 0, 40, ratio));
    for (uint32_t v = 0; v < VERTICES; v++)
        worst.local = fmax(worst.local, fabs((double)ratio[v] - 1.0));
    for (uint32_t k = 0; k + 1u < RINGS; k++)
        worst.slice = fmax(worst.slice, fabs(slice(x, k) / slice(straight, k) - 1.0));
    return worst;
}

/* Clusters of 40 mm. Goals lie on an arc of 40 mm, and of 80 mm. */
TEST(test_bar_keeps_its_volume)
{
    const smr_mesh bar = make_bar();
    const smr_prepare_config radii = rig_radii(1, 40, 0, 0);
    const smr_model *model = rig_model(&bar, 1, &radii);
    for (uint32_t k = 0; k < 4u; k++) {
        const uint32_t method = k < 2u ? SMR_METHOD_POLAR : SMR_METHOD_RIGID;
        bend(k % 2u ? 80.0f : 40.0f);
        const changes linear = bar_changes(model, method, SMR_FUSING_LINEAR);
        const changes lie = bar_changes(model, method, SMR_FUSING_LIE);
        if (getenv("SMR_TEST_SHOW") != NULL)
            print_message(
                "%s, arc of %d mm, linear and lie: slices %4.1f %% %4.1f %%, around vertices %4.1f %% %4.1f %%, "
                "blends %4.1f %% %4.2f %%\n",
                method ? "polar" : "rigid", k % 2u ? 80 : 40, 100.0 * linear.slice, 100.0 * lie.slice,
                100.0 * linear.local, 100.0 * lie.local, 100.0 * linear.blend, 100.0 * lie.blend);
        assert_true(linear.slice > (k % 2u ? 0.08 : 0.15) && linear.blend > (k % 2u ? 0.08 : 0.15));
        assert_true(linear.local > (k % 2u ? 0.07 : 0.12));
        /* the rigid method's turns, sines of the true ones, add to it */
        assert_true(lie.slice < (k == 2u ? 0.06 : 0.05) && lie.slice < 0.4 * linear.slice && lie.blend < 2.0e-3);
        assert_true(lie.local < linear.local); /* the outside of a bend stretches: bent ideally it is 0.12 there */
    }
}

/* Two clusters, an eighth of a turn to either side about an axis far from the origin, as records. */
TEST(test_two_clusters)
{
    const float scale[2] = {smr_fixed_scale(4.0f), smr_fixed_scale(4000.0f)};
    const float inverse[2] = {1.0f / scale[0], 1.0f / scale[1]};
    const smr_vec centre = smr_v(5, 20, 300);
    uint32_t linear[12] = {0}, fused[12] = {0};
    for (uint32_t k = 0; k < 2u; k++) {
        const smr_vec turn = smr_v(k == 0u ? EIGHTH : -EIGHTH, 0, 0);
        const smr_twist twist = smr_twist_about(turn, centre, smr_v(0, 0, 0));
        float t[12], log[6];
        smr_rodrigues(turn, t);
        smr_store(t + 9, smr_scale(smr_mul(t, centre), -1.0f));
        smr_store(log, twist.turn);
        smr_store(log + 3, twist.rate);
        for (uint32_t i = 0; i < 12u; i++)
            linear[i] += smr_fixed(t[i] * scale[i / 9u]);
        for (uint32_t i = 0; i < 6u; i++)
            fused[i] += smr_fixed(log[i] * scale[i / 3u]);
    }
    assert_true(fabsf(determinant_of(0, linear, inverse, 0.5f) - 0.5f) < 1.0e-3f);
    assert_true(fabsf(determinant_of(1, fused, inverse, 0.5f) - 1.0f) < 1.0e-3f);
}

/* Goals of one motion for all: every cluster turns alike, so both means are that motion, in full. */
TEST(test_one_motion)
{
    const smr_mesh bar = make_bar();
    const smr_prepare_config radii = rig_radii(1, 40, 0, 0);
    const smr_model *model = rig_model(&bar, 1, &radii);
    const float t[3] = {5, -20, 11};
    for (uint32_t k = 0; k < 4u; k++) {
        const smr_config config = springy(SMR_METHOD_POLAR, SMR_FUSING_LIE);
        float m[9];
        rig_rotation(2, 1, -0.5f, 10.0f + 50.0f * (float)k, m); /* up to 160 degrees */
        const smr_mesh goal = rig_moved(&bar, m, t);
        smr *s = rig_init(model, &config, NULL);
        assert_int_equal(SMR_OK, smr_set_goals(s, 0, goal.xyz, NULL));
        (void)rig_run(s, 2u * ITERATIONS);
        assert_true(rig_far(rig_positions(s, model), goal.xyz, bar.n_vertices) < 0.02f);
    }
}

/* How far from the moved result the result of moved inputs is, mm. */
static float moved_apart(const smr_mesh *bar, const smr_config *config)
{
    const smr_prepare_config radii = rig_radii(2, 60, 40, 0);
    const float t[3] = {120, -40, 310};
    float m[9];
    rig_rotation(1, -2, 0.5f, 110, m);
    const smr_mesh goal = {bent, bar->triangles, bar->n_vertices, bar->n_triangles};
    const smr_mesh bar2 = rig_moved(bar, m, t), goal2 = rig_moved(&goal, m, t);
    const smr_model *model = rig_model(bar, 1, &radii), *model2 = rig_model(&bar2, 1, &radii);
    smr *s = rig_init(model, config, NULL), *s2 = rig_init(model2, config, NULL);
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, goal.xyz, NULL));
    assert_int_equal(SMR_OK, smr_set_goals(s2, 0, goal2.xyz, NULL));
    (void)rig_run(s, ITERATIONS);
    (void)rig_run(s2, ITERATIONS);
    const smr_mesh result = {rig_positions(s, model), bar->triangles, bar->n_vertices, bar->n_triangles};
    return rig_far(rig_moved(&result, m, t).xyz, rig_positions(s2, model2), bar->n_vertices);
}

/* No worse than with the linear mean, whose 6 um come from rounding inputs of half a metre. */
TEST(test_moved_inputs)
{
    const smr_mesh bar = make_bar();
    bend(60.0f);
    for (uint32_t k = 0; k < 4u; k++) {
        smr_config config = springy(k & 1u, SMR_FUSING_LINEAR);
        config.motion.plastic_every = k >> 1;
        const float linear = moved_apart(&bar, &config);
        config.motion.fusing = SMR_FUSING_LIE;
        const float lie = moved_apart(&bar, &config);
        if (getenv("SMR_TEST_SHOW") != NULL)
            print_message("moved inputs: %.5f mm, linear %.5f\n", (double)lie, (double)linear);
        assert_true(lie < 0.01f && lie < 1.5f * linear + 2.0e-4f);
    }
}
