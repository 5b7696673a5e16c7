/* test_settings.c: the tables of settings cover both configurations word by word, their defaults are legal and set,
 * and each range is what the checks accept, to the last bit at its ends.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <float.h>
#include <math.h>
#include <string.h>
#include "registration/config/config.h"

/* The fields follow each other without a gap behind the cookie, in the table's order: nothing is forgotten or twice. */
static void covers(const smr_setting *s, uint32_t n, size_t size)
{
    uint64_t numbers[2] = {0, 0};
    size_t at = sizeof(uint32_t), fields = 0;
    for (uint32_t i = 0; i < n; i++) {
        assert_true(s[i].name != NULL && s[i].name[0] != '\0' && s[i].unit != NULL && s[i].text != NULL);
        if (s[i].kind == SMR_SETTING_GROUP)
            continue;
        assert_int_equal(at, s[i].offset);
        assert_true(s[i].bytes > 0u && s[i].bytes % 4u == 0u && strlen(s[i].text) > 4u);
        const int logged = strcmp(s[i].name, "attract") != 0;
        assert_true(s[i].number < 128u && (s[i].number > 0u) == logged);
        assert_true(!logged || (numbers[s[i].number / 64u] >> s[i].number % 64u & 1u) == 0u);
        numbers[s[i].number / 64u] |= (uint64_t)1 << s[i].number % 64u;
        at += s[i].bytes;
        fields++;
    }
    assert_int_equal(size, at);
    assert_true(fields > 10u);
}

TEST(test_every_word)
{
    uint32_t n = 0;
    const smr_setting *s = smr_config_settings(&n);
    covers(s, n, sizeof(smr_config));
    s = smr_prepare_settings(&n);
    covers(s, n, sizeof(smr_prepare_config));
    assert_ptr_equal(s, smr_prepare_settings(NULL));
    assert_non_null(smr_config_settings(NULL));
}

/* Logs of version 1 have 45 words; the numbers up to 44 are their places, and none may ever change. */
TEST(test_numbers)
{
    static const struct {
        const char *name;
        uint32_t number;
    } frozen[] = {
        {"n_workers", 1},       {"n_target_vertices", 2},
        {"stiffness", 3},       {"attraction", 4},
        {"slide", 5},           {"even", 6},
        {"search_mm", 7},       {"search_radii", 8},
        {"normal_deg", 9},      {"reject_deviations", 10},
        {"reject_border", 11},  {"use_box", 12},
        {"box_min", 13},        {"box_max", 16},
        {"node_budget", 19},    {"profile_mm", 20},
        {"profile_end_mm", 21}, {"profile_radii", 22},
        {"gradient_mm", 23},    {"gradient_end_mm", 24},
        {"similarity", 25},     {"sideways", 26},
        {"confidence", 27},     {"fill", 28},
        {"method", 29},         {"relaxation", 30},
        {"momentum", 31},       {"momentum_last", 32},
        {"plastic_um", 33},     {"settle_um", 34},
        {"plastic_every", 35},  {"fold_guard", 36},
        {"normals", 37},        {"active_share", 38},
        {"active_first", 39},   {"active_enough", 40},
        {"radius_first", 41},   {"radius_last", 42},
        {"iterations", 43},     {"iterations_last", 44},
    };
    uint32_t n = 0;
    const smr_setting *s = smr_config_settings(&n);
    for (size_t k = 0; k < sizeof frozen / sizeof frozen[0]; k++) {
        uint32_t found = 0;
        for (uint32_t i = 0; i < n; i++) {
            found += s[i].kind != SMR_SETTING_GROUP && s[i].number == frozen[k].number &&
                     strcmp(s[i].name, frozen[k].name) == 0;
        }
        assert_int_equal(1, found);
    }
}

static double as_stored(const smr_setting *s, double value)
{
    return s->kind == SMR_SETTING_NUMBER ? (double)(float)value : value;
}

static double value_at(const void *config, const smr_setting *s)
{
    uint32_t whole;
    float number;
    memcpy(&whole, (const unsigned char *)config + s->offset, sizeof whole);
    memcpy(&number, (const unsigned char *)config + s->offset, sizeof number);
    return s->kind == SMR_SETTING_NUMBER ? (double)number : (double)whole;
}

TEST(test_defaults)
{
    const smr_config config = smr_config_default(), image = smr_config_default_image();
    const smr_prepare_config prepare = smr_prepare_config_default();
    uint32_t n = 0;
    const smr_setting *s = smr_config_settings(&n);
    for (uint32_t i = 0; i < n; i++)
        if (s[i].kind != SMR_SETTING_GROUP) {
            assert_true(value_at(&config, &s[i]) == as_stored(&s[i], s[i].value));
            assert_true(value_at(&image, &s[i]) == as_stored(&s[i], s[i].image));
        }
    s = smr_prepare_settings(&n);
    for (uint32_t i = 0; i < n; i++)
        if (s[i].kind != SMR_SETTING_GROUP && s[i].kind != SMR_SETTING_POINTER)
            assert_true(value_at(&prepare, &s[i]) == as_stored(&s[i], s[i].value));
    assert_true(image.image.profile_mm == 30.0f && image.basic.iterations_last == 40u &&
                config.motion.plastic_every == 1u);
}

/* ---------------------------------------------------------------- ranges */

static const smr_model *model; /* of all radii that there can be */
static smr_structure sheet;

static int accepts(int prepares, const smr_setting *s, double value)
{
    union {
        smr_config run;
        smr_prepare_config prepare;
        unsigned char byte[1024];
    } c;
    const uint32_t whole = s->kind == SMR_SETTING_NUMBER ? 0u : (uint32_t)value;
    const float number = (float)value;
    size_t bytes;
    memset(&c, 0, sizeof c);
    if (prepares)
        c.prepare = smr_prepare_config_default();
    else
        c.run = smr_config_default();
    memcpy(c.byte + s->offset, s->kind == SMR_SETTING_NUMBER ? (const void *)&number : (const void *)&whole, 4);
    if (s->kind == SMR_SETTING_NUMBER && s->bytes > 4u) { /* an array: what makes its first element count */
        c.run.forces.use_box = prepares ? c.run.forces.use_box : 1u;
        c.prepare.n_radii = prepares ? 1u : c.prepare.n_radii;
        if (strcmp(s->name, "box_min") == 0)
            c.run.forces.box_max[0] = SMR_COORD_MAX;
        else if (strcmp(s->name, "box_max") == 0)
            c.run.forces.box_min[0] = -SMR_COORD_MAX;
    }
    if (prepares && strcmp(s->name, "n_radii") == 0)
        for (uint32_t i = 0; i < SMR_RADII_MAX; i++)
            c.prepare.radius_mm[i] = 10.0f;
    const smr_status status =
        prepares ? smr_prepare_bytes(&sheet, 1, &c.prepare, &bytes) : smr_config_check(&c.run, model);
    assert_true(status == SMR_OK || status == SMR_E_CONFIG);
    return status == SMR_OK;
}

static int accepts_float(int prepares, const smr_setting *s, float value)
{
    return accepts(prepares, s, (double)value);
}

static void check_range(int prepares, const smr_setting *s)
{
    if (s->kind == SMR_SETTING_NUMBER) {
        const float low = (float)s->low, high = (float)s->high;
        const int good = accepts_float(prepares, s, s->open ? nextafterf(low + FLT_MIN, 2.0f) : low) &&
                         accepts_float(prepares, s, high) && !accepts_float(prepares, s, nextafterf(high, INFINITY)) &&
                         accepts_float(prepares, s, low) == !s->open &&
                         !accepts_float(prepares, s, nextafterf(low, -INFINITY)) && !accepts_float(prepares, s, NAN) &&
                         !accepts_float(prepares, s, INFINITY) &&
                         (!s->open || !accepts_float(prepares, s, FLT_MIN / 2.0f));
        if (!good)
            fail_msg("%s: not the range that the table says", s->name);
    } else {
        const int good = accepts(prepares, s, s->low) && accepts(prepares, s, s->high) &&
                         !accepts(prepares, s, s->high + 1.0) &&
                         accepts(prepares, s, 0.0) == (s->low <= 0.0 || s->or_zero) &&
                         (s->low < 2.0 || !accepts(prepares, s, s->low - 1.0)) &&
                         accepts(prepares, s, 4294967295.0) == (strcmp(s->name, "radius_last") == 0);
        if (!good)
            fail_msg("%s: not the range that the table says", s->name);
    }
}

TEST(test_ranges)
{
    static const float none[3] = {0, 0, 0};
    smr_prepare_config radii = smr_prepare_config_default();
    const smr_mesh ball = rig_ball(20, 3, 5, none);
    uint32_t n = 0;
    radii.n_radii = SMR_RADII_MAX;
    for (uint32_t i = 0; i < SMR_RADII_MAX; i++)
        radii.radius_mm[i] = 40.0f - 2.0f * (float)i;
    model = rig_model(&ball, 1, &radii);
    sheet.mesh = ball;
    const smr_setting *s = smr_config_settings(&n);
    for (uint32_t i = 0; i < n; i++)
        if (s[i].kind != SMR_SETTING_GROUP)
            check_range(0, &s[i]);
    s = smr_prepare_settings(&n);
    for (uint32_t i = 0; i < n; i++)
        if (s[i].kind != SMR_SETTING_GROUP && s[i].kind != SMR_SETTING_POINTER)
            check_range(1, &s[i]);
}
