/* test_config.c: the defaults are legal, the stated limits are accepted, one step beyond them is refused.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "registration/config/config.h"

static const float none[3] = {0, 0, 0};

static const smr_model *small_model(void)
{
    const smr_mesh mesh = rig_ball(20, 3, 5, none);
    const smr_prepare_config radii = rig_radii(3, 25, 15, 8);
    return rig_model(&mesh, 1, &radii);
}

TEST(test_default)
{
    const smr_config c = smr_config_default(), again = smr_config_default();
    assert_int_equal(SMR_OK, smr_config_check(&c, small_model()));
    assert_memory_equal(&c, &again, sizeof c); /* padding, too: configurations can be compared and logged */
    assert_int_equal(1, c.basic.n_workers);
    assert_int_equal(0, c.basic.n_target_vertices);
    assert_int_equal(0, c.schedule.radius_first);
    assert_true(c.schedule.radius_last == SMR_FINEST);
    assert_int_equal(SMR_METHOD_RIGID, c.basic.method);
    assert_int_equal(SMR_NORMALS_CARRIED, c.motion.normals);
    assert_int_equal(sizeof c & 0xffffu, c.cookie & 0xffffu); /* a caller compiled with another header is noticed */
    assert_int_equal(SMR_VERSION_MAJOR, c.cookie >> 16 & 0xffu);
}

#define ACCEPT(field, value)                                                                                           \
    do {                                                                                                               \
        smr_config c_ = smr_config_default();                                                                          \
        c_.field = (value);                                                                                            \
        if (smr_config_check(&c_, model) != SMR_OK)                                                                    \
            fail_msg("refused: " #field " = " #value);                                                                 \
    } while (0)
#define REFUSE(field, value)                                                                                           \
    do {                                                                                                               \
        smr_config c_ = smr_config_default();                                                                          \
        c_.field = (value);                                                                                            \
        if (smr_config_check(&c_, model) != SMR_E_CONFIG)                                                              \
            fail_msg("accepted: " #field " = " #value);                                                                \
    } while (0)
#define LIMITS(field, lo, hi, below, above)                                                                            \
    do {                                                                                                               \
        ACCEPT(field, lo);                                                                                             \
        ACCEPT(field, hi);                                                                                             \
        REFUSE(field, below);                                                                                          \
        REFUSE(field, above);                                                                                          \
    } while (0)

TEST(test_limits)
{
    const smr_model *model = small_model();
    LIMITS(basic.n_workers, 1, SMR_WORKERS_MAX, 0, SMR_WORKERS_MAX + 1u);
    ACCEPT(basic.n_target_vertices, SMR_VERTICES_MAX);
    REFUSE(basic.n_target_vertices, SMR_VERTICES_MAX + 1u);
    LIMITS(forces.stiffness, 1.0e-6f, 1.0f, 0.0f, nextafterf(1.0f, 2.0f));
    LIMITS(basic.attraction, 0.0f, 1.0f, nextafterf(0.0f, -1.0f), nextafterf(1.0f, 2.0f));
    LIMITS(image.sideways, 0.0f, 1.0f, nextafterf(0.0f, -1.0f), nextafterf(1.0f, 2.0f));
    LIMITS(basic.slide, 0.0f, 1.0f, nextafterf(0.0f, -1.0f), nextafterf(1.0f, 2.0f));
    LIMITS(basic.even, 0.0f, 1.0f, nextafterf(0.0f, -1.0f), nextafterf(1.0f, 2.0f));
    LIMITS(basic.search_mm, 1.0e-6f, SMR_COORD_MAX, 0.0f, nextafterf(SMR_COORD_MAX, 1.0e9f));
    LIMITS(forces.search_radii, 1.0e-6f, 1.0e6f, 0.0f, nextafterf(1.0e6f, 1.0e9f));
    LIMITS(forces.normal_deg, 1.0e-6f, 180.0f, 0.0f, nextafterf(180.0f, 200.0f));
    ACCEPT(forces.reject_deviations, 0.0f);
    REFUSE(forces.reject_deviations, nextafterf(0.0f, -1.0f));
    ACCEPT(forces.reject_border, 1);
    REFUSE(forces.reject_border, 2);
    LIMITS(forces.node_budget, 8, 1000000, 7, 1000001);
    LIMITS(basic.method, SMR_METHOD_RIGID, SMR_METHOD_POLAR, UINT32_MAX, SMR_METHOD_POLAR + 1u);
    LIMITS(motion.relaxation, 1.0e-6f, 1.0f, 0.0f, nextafterf(1.0f, 2.0f));
    LIMITS(motion.momentum, 0.0f, 0.99f, nextafterf(0.0f, -1.0f), 1.0f);
    ACCEPT(motion.plastic_um, 0.0f);
    REFUSE(motion.plastic_um, nextafterf(0.0f, -1.0f));
    ACCEPT(motion.settle_um, 0.0f);
    REFUSE(motion.settle_um, nextafterf(0.0f, -1.0f));
    LIMITS(motion.plastic_every, 0, 1000, UINT32_MAX, 1001);
    LIMITS(motion.strain_most, 0.0f, 1000.0f, -0.1f, 1001.0f);
    LIMITS(image.rest, 0, 60, UINT32_MAX, 61);
    LIMITS(motion.fold_guard, 0, 1, UINT32_MAX, 2);
    LIMITS(motion.normals, SMR_NORMALS_CARRIED, SMR_NORMALS_EXACT, UINT32_MAX, SMR_NORMALS_EXACT + 1u);
    LIMITS(basic.active_share, 0.0f, 1.0f, nextafterf(0.0f, -1.0f), nextafterf(1.0f, 2.0f));
    LIMITS(schedule.active_first, 0.0f, 1.0f, nextafterf(0.0f, -1.0f), nextafterf(1.0f, 2.0f));
    LIMITS(schedule.active_enough, 0, 1000000, UINT32_MAX, 1000001);
    REFUSE(basic.active_share, NAN);
    LIMITS(schedule.radius_first, 0, 2, UINT32_MAX, 3);
    LIMITS(schedule.radius_last, 0, 2, SMR_FINEST - 1u, 3);
    LIMITS(basic.iterations, 1, 100000, 0, 100001);
    LIMITS(basic.iterations_last, 1, 100000, 0, 100001);
}

TEST(test_box)
{
    const smr_model *model = small_model();
    smr_config c = smr_config_default();
    c.forces.box_min[0] = 5; /* above the maximum, but not used */
    assert_int_equal(SMR_OK, smr_config_check(&c, model));
    c.forces.use_box = 1;
    assert_int_equal(SMR_E_CONFIG, smr_config_check(&c, model));
    c.forces.box_max[0] = 5; /* a flat box is legal */
    assert_int_equal(SMR_OK, smr_config_check(&c, model));
    c.forces.box_max[1] = SMR_COORD_MAX;
    c.forces.box_min[1] = -SMR_COORD_MAX;
    assert_int_equal(SMR_OK, smr_config_check(&c, model));
    c.forces.box_max[1] = NAN;
    assert_int_equal(SMR_E_CONFIG, smr_config_check(&c, model));
    c.forces.use_box = 2;
    assert_int_equal(SMR_E_CONFIG, smr_config_check(&c, model));
}

TEST(test_radii_in_order)
{
    const smr_model *model = small_model();
    for (uint32_t first = 0; first < 4u; first++) {
        for (uint32_t last = 0; last < 4u; last++) {
            smr_config c = smr_config_default();
            c.schedule.radius_first = first;
            c.schedule.radius_last = last;
            const int legal = first <= last && last < 3u;
            assert_int_equal(legal ? SMR_OK : SMR_E_CONFIG, smr_config_check(&c, model));
        }
    }
}
