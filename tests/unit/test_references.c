/* test_references.c: models with shapes of several subjects: the weights of a known mixture are found, what a target
 * does not show ends nearer to the truth, one shape changes no bit, and hostile sections are refused.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "log/record/log_format.h"
#include "registration/registration.h"
#include "unit_exercise.h"

enum { SHAPES = 4 };

static smr_mesh bone;
static smr_box box; /* around the bone */
static float *also; /* [SHAPES - 1][vertices][3] */
static smr_subjects subjects;

/* Vertex v of shape k: the bone, bowed, tapered, or twisted. */
static smr_vec shaped(uint32_t k, uint32_t v)
{
    const smr_vec p = smr_load(bone.xyz + 3u * (size_t)v);
    const float t = 2.0f * (p.z - box.lo.z) / (box.hi.z - box.lo.z) - 1.0f, turn = 0.3f * t;
    switch (k) {
    case 1: return smr_v(p.x + 5.0f * t * t, p.y, p.z);
    case 2: return smr_v(p.x * (1.0f + 0.25f * t), p.y * (1.0f + 0.25f * t), p.z);
    case 3:
        return smr_v(cosf(turn) * p.x - sinf(turn) * p.y, sinf(turn) * p.x + cosf(turn) * p.y + 2.0f * t * t * t, p.z);
    default: return p;
    }
}

/* The weighted mean of the shapes as a mesh, cut: the upper part of its triangles alone. */
static smr_mesh mixture(const float weight[SHAPES], int cut)
{
    const uint32_t nv = bone.n_vertices;
    float *xyz = rig_alloc(3u * (size_t)nv * sizeof *xyz), middle = 0.0f;
    uint32_t *triangles = rig_alloc(3u * (size_t)bone.n_triangles * sizeof *triangles), nt = 0;
    for (uint32_t v = 0; v < nv; v++) {
        smr_vec sum = smr_v(0, 0, 0);
        for (uint32_t k = 0; k < SHAPES; k++)
            sum = smr_add(sum, smr_scale(shaped(k, v), weight[k]));
        smr_store(xyz + 3u * (size_t)v, sum);
        middle += sum.z / (float)nv;
    }
    for (uint32_t i = 0; i < bone.n_triangles; i++) {
        const uint32_t *t = bone.triangles + 3u * (size_t)i;
        if (!cut || (xyz[3u * t[0] + 2u] > middle && xyz[3u * t[1] + 2u] > middle && xyz[3u * t[2] + 2u] > middle))
            memcpy(triangles + 3u * (size_t)nt++, t, 3u * sizeof *t);
    }
    return (smr_mesh){xyz, triangles, nv, nt};
}

/* The shapes beside the bone itself are turned, larger and elsewhere. */
static void make_shapes(void)
{
    const float size[3] = {1.0f, 1.3f, 0.8f};
    float m[9];
    rig_bone(10000, 0.0f, &bone, NULL);
    box = smr_box_of(bone.xyz, bone.n_vertices);
    also = rig_alloc(3u * (size_t)(SHAPES - 1) * bone.n_vertices * sizeof *also);
    rig_rotation(1, 2, 3, 50, m);
    for (uint32_t k = 1; k < SHAPES; k++)
        for (uint32_t v = 0; v < bone.n_vertices; v++) {
            const smr_vec p = smr_scale(shaped(k, v), size[k - 1u]);
            float *to = also + 3u * ((size_t)(k - 1u) * bone.n_vertices + v);
            for (uint32_t i = 0; i < 3u; i++)
                to[i] = m[3u * i] * p.x + m[3u * i + 1u] * p.y + m[3u * i + 2u] * p.z + 20.0f * (float)k;
        }
    subjects = (smr_subjects){also, SHAPES - 1};
}

static const smr_model *model_of(const smr_subjects *with)
{
    smr_prepare_config c = smr_prepare_config_default();
    c.also = with;
    return rig_model(&bone, 1, &c);
}

static smr_config config_of(const smr_mesh *target, float prior)
{
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = target->n_vertices;
    c.references.prior = prior;
    return c;
}

static smr *begin(const smr_model *model, const smr_config *config, const smr_surface *target)
{
    const smr_pose up = {{{1, 0, 0, 1}, {0, 1, 0, -2}, {0, 0, 1, 1.5f}}};
    smr *s = rig_init(model, config, NULL);
    assert_int_equal(SMR_OK, smr_set_pose(s, &up));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, target));
    return s;
}

/* Mean distance of the vertices that the target does not show from their true places, mm. */
static float unseen(const smr *s, const smr_model *model, const smr_mesh *truth, const smr_mesh *target)
{
    const float *x = rig_positions(s, model);
    uint8_t *shown = rig_alloc(truth->n_vertices);
    float sum = 0.0f, n = 0.0f;
    for (uint32_t i = 0; i < 3u * target->n_triangles; i++)
        shown[target->triangles[i]] = 1;
    for (uint32_t v = 0; v < truth->n_vertices; v++)
        if (!shown[v]) {
            sum += smr_length(smr_sub(smr_load(x + 3u * (size_t)v), smr_load(truth->xyz + 3u * (size_t)v)));
            n += 1.0f;
        }
    return sum / n;
}

static void weights_of(const smr *s, float weight[SMR_REFERENCES_MAX])
{
    uint32_t n = 0;
    float sum = 0.0f;
    assert_int_equal(SMR_OK, smr_get_reference_weights(s, weight, &n));
    assert_int_equal(SHAPES, n);
    for (uint32_t i = 0; i < n; i++) {
        assert_true(weight[i] >= -1.0e-6f && weight[i] <= 1.0f);
        sum += weight[i];
    }
    assert_true(fabsf(sum - 1.0f) < 1.0e-5f);
}

/* Of each shape alone and of a mixture the upper part is shown: a weak prior finds the weights, and the rest ends
 * nearer to its true place than with the model's own shape alone. */
TEST(test_mixtures)
{
    static const float truth[][SHAPES] = {{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {0.1f, 0.1f, 0.6f, 0.2f}};
    float sum_alone = 0.0f, sum_blend = 0.0f;
    make_shapes();
    const smr_model *own = model_of(NULL), *all = model_of(&subjects);
    for (uint32_t k = 0; k < rig_times(sizeof truth / sizeof truth[0]); k++) {
        float weight[SMR_REFERENCES_MAX], most = 0.0f;
        const smr_mesh body = mixture(truth[k], 0), part = mixture(truth[k], 1);
        const smr_surface *target = rig_surface(&part);
        const smr_config weak = config_of(&part, 0.1f), usual = config_of(&part, 300.0f);
        smr *s = begin(all, &weak, target), *alone = begin(own, &usual, target), *blend = begin(all, &usual, target);
        weights_of(s, weight);
        assert_true(fabsf(weight[1] - 0.25f) < 1.0e-6f);
        (void)rig_run(s, 1000);
        (void)rig_run(alone, 1000);
        (void)rig_run(blend, 1000);
        weights_of(s, weight);
        for (uint32_t i = 0; i < SHAPES; i++)
            most = fmaxf(most, fabsf(weight[i] - truth[k][i]));
        assert_true(most < 0.2f);
        const float left = unseen(alone, own, &body, &part);
        assert_true(unseen(s, all, &body, &part) < 0.25f * left);
        sum_alone += left;
        sum_blend += unseen(blend, all, &body, &part);
    }
    assert_true(sum_blend < 0.7f * sum_alone || rig_times(4) < 4u); /* the mean over all */
}

/* A shape among the subjects lies near their blends; a ball does not, and the verdict tells. One subject alone says
 * nothing. */
TEST(test_unlike_all_subjects)
{
    static const float truth[SHAPES] = {0.1f, 0.1f, 0.6f, 0.2f}, middle[3] = {0, 0, 0};
    make_shapes();
    for (uint32_t k = 0; k < 4u; k++) {
        const smr_mesh body = k < 2u ? mixture(truth, 0) : rig_ball(40, 20, 30, middle);
        const smr_config usual = config_of(&body, 300.0f);
        smr *s = begin(model_of(k % 2u ? &subjects : NULL), &usual, rig_surface(&body));
        smr_verdict v;
        (void)rig_run(s, 1000);
        assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &v));
        const int unlike = (v.reasons & SMR_REASON_SUBJECTS) != 0u;
        if (k % 2u ? v.subjects_ratio > (k == 1u ? 0.3f : 9.0f) || v.subjects_ratio < (k == 1u ? 0.0f : 1.4f)
                   : v.subjects_ratio >= 0.0f)
            fail_msg("case %u: %g times as far as from subject to subject", k, (double)v.subjects_ratio);
        assert_int_equal(k == 3u, unlike);
    }
}

/* A result with the shape of a subject lies among the blends, however small the subjects are. */
TEST(test_small_subject)
{
    static const float small[9] = {0.02f, 0, 0, 0, 0.02f, 0, 0, 0, 0.02f}, none[3] = {0, 0, 0};
    smr_verdict v;
    make_shapes();
    bone = rig_moved(&bone, small, none);
    for (uint32_t i = 0; i < 3u * (SHAPES - 1u) * bone.n_vertices; i++)
        also[i] *= small[0];
    const smr_config usual = config_of(&bone, 300.0f);
    smr *s = rig_init(model_of(&subjects), &usual, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&bone)));
    (void)rig_run(s, 1);
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &v));
    assert_true(v.subjects_ratio >= 0.0f && v.subjects_ratio < 0.02f);
}

/* On a whole target, and without further shapes, each bit is as without references. The arena is exact. */
TEST(test_not_used)
{
    static const float truth[SHAPES] = {0, 0, 1, 0};
    make_shapes();
    const smr_subjects none = {NULL, 0};
    const smr_model *own = model_of(NULL), *all = model_of(&subjects), *alone = model_of(&none);
    smr_model_info info, plain;
    float weight[SMR_REFERENCES_MAX];
    uint32_t n;
    size_t least, more;
    const smr_mesh body = mixture(truth, 0);
    const smr_config c = config_of(&body, 100.0f);
    smr *s[3] = {begin(own, &c, rig_surface(&body)), begin(all, &c, rig_surface(&body)), NULL};
    assert_int_equal(SMR_OK, smr_model_get_info(all, &info));
    assert_int_equal(SMR_OK, smr_model_get_info(own, &plain));
    assert_int_equal(SHAPES, info.n_references);
    assert_int_equal(1, plain.n_references);
    assert_memory_equal(own, alone, plain.bytes);
    for (uint32_t k = 0; k < 2u; k++)
        (void)rig_run(s[k], 1000);
    assert_true(smr_state_hash(s[0]) == smr_state_hash(s[1]));
    assert_int_equal(SMR_OK, smr_get_reference_weights(s[0], weight, &n));
    assert_true(n == 1u && weight[0] == 1.0f);
    assert_int_equal(SMR_E_NULL, smr_get_reference_weights(s[0], NULL, &n));
    assert_int_equal(SMR_E_NULL, smr_get_reference_weights(NULL, weight, &n));
    assert_int_equal(SMR_OK, smr_arena_bytes(own, &c, &least));
    assert_int_equal(SMR_OK, smr_arena_bytes(all, &c, &more));
    assert_true(more > least && more <= least + SMR_ARENA_REFERENCES_BYTES(SHAPES));
    unsigned char *arena = rig_rough(more);
    assert_int_equal(SMR_E_ARENA, smr_init(all, &c, NULL, arena, more - 1u, &s[2]));
    assert_int_equal(SMR_OK, smr_init(all, &c, NULL, arena, more, &s[2]));
}

/* While a target is tracked, the weights that registration found stay, and so does what the target does not show. */
TEST(test_tracked)
{
    static const float truth[2][SHAPES] = {{0, 1, 0, 0}, {0, 0, 1, 0}};
    float weight[2][SMR_REFERENCES_MAX];
    make_shapes();
    const smr_mesh part = mixture(truth[0], 1), other = mixture(truth[1], 1);
    smr_config c = config_of(&part, 0.1f);
    c.track.mode = SMR_TRACK_REPORT;
    smr *s = begin(model_of(&subjects), &c, rig_surface(&part));
    (void)rig_run(s, 400);
    assert_true(s->schedule.tracking);
    weights_of(s, weight[0]);
    const float *const before = rig_positions(s, s->shared.model);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&part)));
    (void)rig_run(s, 20);
    assert_true(rig_far(before, rig_positions(s, s->shared.model), bone.n_vertices) < 0.5f);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&other)));
    (void)rig_run(s, 20);
    weights_of(s, weight[1]);
    assert_memory_equal(weight[0], weight[1], SHAPES * sizeof(float));
}

static const void *give(void *target, const smr_log_record *record)
{
    return record->kind == SMR_LOG_SURFACE ? target : NULL;
}

/* Interrupted by a save, cut by a clock, and from its log: the same bits, and the same weights. */
TEST(test_save_and_replay)
{
    static const float truth[SHAPES] = {0, 0.5f, 0.5f, 0};
    static unsigned char log[1u << 15];
    make_shapes();
    const smr_model *all = model_of(&subjects);
    const smr_mesh part = mixture(truth, 1);
    smr_surface *target = rig_surface(&part);
    const smr_config c = config_of(&part, 3.0f);
    float weight[2][SMR_REFERENCES_MAX];
    smr_log_state at;
    smr_replay replay;
    smr_replay_report report = {0};
    rig_clock clock;
    const smr_port slow = rig_clock_port(&clock, RIG_CLOCK_STEADY, 20000);
    smr *s = rig_init(all, &c, &slow), *again = begin(all, &c, target);
    const smr_pose turned = {{{1, 0, 0, 1}, {0, 1, 0, -2}, {0, 0, 1, 1.5f}}};
    assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
    assert_int_equal(SMR_OK, smr_set_pose(s, &turned));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, target));
    for (uint32_t k = 0; k < 60u; k++)
        assert_true(smr_tick(s, 3000000, NULL) >= SMR_OK);
    (void)rig_run(s, 1000);
    assert_int_equal(SMR_OK, smr_get_log(s, &at));
    smr *twin = rig_init(all, &c, NULL);
    assert_int_equal(SMR_OK, smr_replay_start(twin, log, at.bytes, give, target, &replay));
    while (!report.ended)
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
    assert_true(report.differs == 0u && smr_state_hash(twin) == smr_state_hash(s));
    weights_of(s, weight[0]);
    weights_of(twin, weight[1]);
    assert_memory_equal(weight[0], weight[1], SHAPES * sizeof(float));
    (void)rig_run(again, 30);
    smr *restored = rig_restored(again, all, &c);
    assert_non_null(restored);
    weights_of(again, weight[0]);
    weights_of(restored, weight[1]);
    assert_memory_equal(weight[0], weight[1], SHAPES * sizeof(float));
    assert_int_equal(SMR_OK, smr_set_surface(restored, 0, target));
    (void)rig_run(again, 1000);
    (void)rig_run(restored, 1000);
    assert_true(smr_state_hash(again) == smr_state_hash(restored));
}

/* Sections that are not shapes of the model's vertices are refused; any that is opened can be used. */
TEST(test_hostile_sections)
{
    static const float values[] = {NAN, INFINITY, -INFINITY, 8.1e5f, -8.1e5f};
    make_shapes();
    smr_model_info info;
    const smr_model *all = model_of(&subjects), *opened;
    assert_int_equal(SMR_OK, smr_model_get_info(all, &info));
    unsigned char *bytes = rig_rough(info.bytes);
    memcpy(bytes, all, info.bytes);
    smr_model *head = (smr_model *)(void *)bytes;
    smr_stored_section *section = (smr_stored_section *)(void *)(bytes + smr_le32(head->at_sections));
    uint32_t *first = (uint32_t *)(void *)(bytes + smr_le32(section->at)), size = smr_le32(section->bytes);
    assert_int_equal(SHAPES * 12u * bone.n_vertices, size);
    const uint32_t sizes[] = {0, 12u * bone.n_vertices, size - 4u, size + 4u, 17u * 12u * bone.n_vertices};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        section->bytes = smr_le32(sizes[k]);
        unit_repair(bytes, info.bytes);
        assert_int_equal(SMR_E_MODEL, smr_model_open(bytes, info.bytes, &opened));
    }
    section->bytes = smr_le32(size);
    for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
        uint32_t *const word = first + (k % 2u == 0u ? 0u : size / 4u - 1u), was = *word;
        *word = smr_le32(smr_float_bits(values[k]));
        unit_repair(bytes, info.bytes);
        assert_int_equal(SMR_E_MODEL, smr_model_open(bytes, info.bytes, &opened));
        *word = was;
    }
    const smr_mesh part = mixture((const float[SHAPES]){1, 0, 0, 0}, 1);
    const smr_config c = config_of(&part, 0.01f);
    for (uint32_t k = 0, seed = 3; k < size / 4u; k++) /* legal, and no shape of anything */
        first[k] = smr_le32(smr_float_bits(rig_between(&seed, -8.0e5f, 8.0e5f)));
    unit_repair(bytes, info.bytes);
    assert_int_equal(SMR_OK, smr_model_open(bytes, info.bytes, &opened));
    smr *s = begin(opened, &c, rig_surface(&part));
    (void)rig_run(s, 100);
    assert_true(rig_finite(rig_positions(s, opened), bone.n_vertices));
}

/* What smr_prepare() refuses. */
TEST(test_refused_shapes)
{
    make_shapes();
    smr_prepare_config c = smr_prepare_config_default();
    const smr_structure one = {"bone", bone};
    size_t scratch, size;
    c.n_radii = 1;
    c.radius_mm[0] = 40.0f;
    c.also = &subjects;
    assert_int_equal(SMR_OK, smr_prepare_bytes(&one, 1, &c, &scratch));
    void *memory = rig_alloc(scratch);
    assert_int_equal(SMR_OK, smr_prepare(&one, 1, &c, memory, scratch, NULL, 0, &size));
    subjects.n = SMR_REFERENCES_MAX;
    assert_int_equal(SMR_E_INPUT, smr_prepare(&one, 1, &c, memory, scratch, NULL, 0, &size));
    subjects.n = SHAPES - 1;
    also[7] = NAN;
    assert_int_equal(SMR_E_INPUT, smr_prepare(&one, 1, &c, memory, scratch, NULL, 0, &size));
    subjects.xyz = NULL;
    assert_int_equal(SMR_E_NULL, smr_prepare(&one, 1, &c, memory, scratch, NULL, 0, &size));
}
