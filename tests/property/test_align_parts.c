/* test_align_parts.c: start poses between parts of real bones of several people, when the data lie beside the
 * repository. A whole femur onto another person's without one end, the reverse, and parts of different lengths, in any
 * orientation: the right way up and on the right end, by the pose and the scale between the whole bones. One side of a
 * hip bone: a pose that is off becomes better, the true one as given stays. A mirrored femur is recognised. A bone so
 * deformed that no pose brings a fifth of it near is taken for a whole, not for a part.
 * Accuracy: 15 degrees, for one end alone has another twist than the whole; 20 mm at the end that the part has, of
 * bones that are up to 18 % longer or shorter; 10 % of the scale.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rig.h"
#include "rig_data.h"

#define DEGREES_MOST 15.0f
#define MM_MOST 20.0f
#define SCALE_MOST 0.1f
#define END_MM 60.0f /* length of a bone's end */

static const float nowhere[3] = {0, 0, 0};

/* The triangles with all corners where keep() says so, and their vertices. */
static smr_mesh part_of(const smr_mesh *m, int (*keep)(const smr_mesh *, const uint32_t *, float), float parameter)
{
    float *xyz = rig_alloc(12u * (size_t)m->n_vertices);
    uint32_t *t = rig_alloc(12u * (size_t)m->n_triangles), *number = rig_alloc(4u * (size_t)m->n_vertices);
    smr_mesh part = {xyz, t, 0, 0};
    for (uint32_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *from = m->triangles + 3u * (size_t)i;
        for (uint32_t k = 0; k < 3u && keep(m, from, parameter); k++) {
            if (number[from[k]] == 0u) {
                memcpy(xyz + 3u * (size_t)part.n_vertices, m->xyz + 3u * (size_t)from[k], 12u);
                number[from[k]] = ++part.n_vertices;
            }
            t[3u * (size_t)part.n_triangles + k] = number[from[k]] - 1u;
            part.n_triangles += k == 2u;
        }
    }
    return part;
}

static void heights(const smr_mesh *m, float *lo, float *hi)
{
    *lo = 1e9f;
    *hi = -1e9f;
    for (uint32_t v = 0; v < m->n_vertices; v++) {
        *lo = fminf(*lo, m->xyz[3u * (size_t)v + 2u]);
        *hi = fmaxf(*hi, m->xyz[3u * (size_t)v + 2u]);
    }
}

/* The upper share of a bone; the lower one where it is negative. */
static int upper(const smr_mesh *m, const uint32_t *t, float share)
{
    static const float *of;
    static float lo, hi;
    if (of != m->xyz)
        heights(m, &lo, &hi);
    of = m->xyz;
    for (uint32_t k = 0; k < 3u; k++) {
        const float z = m->xyz[3u * (size_t)t[k] + 2u];
        if (share > 0.0f ? z < hi - share * (hi - lo) : z > lo - share * (hi - lo))
            return 0;
    }
    return 1;
}

/* Triangles that look forward, to -y, within an angle of this cosine. */
static int forward(const smr_mesh *m, const uint32_t *t, float cosine)
{
    const float *a = m->xyz + 3u * (size_t)t[0], *b = m->xyz + 3u * (size_t)t[1], *c = m->xyz + 3u * (size_t)t[2];
    const float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return -n[1] > cosine * sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static void put(const smr_pose *p, const float *x, float out[3])
{
    for (uint32_t r = 0; r < 3u; r++)
        out[r] = p->m[r][0] * x[0] + p->m[r][1] * x[1] + p->m[r][2] * x[2] + p->m[r][3];
}

static float scale_of(const smr_pose *p)
{
    return sqrtf(p->m[0][0] * p->m[0][0] + p->m[1][0] * p->m[1][0] + p->m[2][0] * p->m[2][0]);
}

static float degrees_between(const smr_pose *p, const smr_pose *q)
{
    float trace = 0.0f;
    for (uint32_t i = 0; i < 9u; i++)
        trace += p->m[i / 3u][i % 3u] * q->m[i / 3u][i % 3u];
    return acosf(fminf(fmaxf((trace / (scale_of(p) * scale_of(q)) - 1.0f) * 0.5f, -1.0f), 1.0f)) * 57.29578f;
}

/* Mean distance between where two poses put the model's upper (1) or lower end. */
static float apart_at_end(const smr_mesh *m, int top, const smr_pose *p, const smr_pose *q)
{
    float lo, hi, sum = 0.0f, n = 0.0f;
    heights(m, &lo, &hi);
    for (uint32_t v = 0; v < m->n_vertices; v++) {
        const float *x = m->xyz + 3u * (size_t)v;
        float a[3], b[3];
        if (top ? x[2] < hi - END_MM : x[2] > lo + END_MM)
            continue;
        put(p, x, a);
        put(q, x, b);
        sum += rig_far(a, b, 1);
        n += 1.0f;
    }
    return sum / n;
}

/* The model, turned by a random rotation first, onto the target: the pose without that rotation. */
static smr_pose aligned(const smr_mesh *model, const smr_mesh *target, int scaled, uint32_t *seed,
                        const smr_pose *given, smr_align_report *report)
{
    smr_align_config config = smr_align_config_default();
    float m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    smr_pose found, pose;
    size_t bytes = 0;
    config.scaled = (uint32_t)scaled;
    config.given = given;
    if (seed != NULL) {
        float axis[3];
        rig_within(seed, -1, 1, axis);
        rig_rotation(axis[0], axis[1], axis[2], (float)rig_random(seed, 181u), m);
    }
    const smr_mesh turned = rig_moved(model, m, nowhere);
    assert_int_equal(SMR_OK, smr_align_bytes(&config, &bytes));
    assert_int_equal(
        SMR_OK, smr_align(rig_surface(&turned), rig_surface(target), &config, rig_alloc(bytes), bytes, &found, report));
    for (uint32_t r = 0; r < 3u; r++) {
        for (uint32_t c = 0; c < 3u; c++)
            pose.m[r][c] = found.m[r][0] * m[c] + found.m[r][1] * m[3u + c] + found.m[r][2] * m[6u + c];
        pose.m[r][3] = found.m[r][3];
    }
    return pose;
}

#define PEOPLE 5u

/* A left femur of each person; 0 without the data. The last two are one person's, meshed differently. */
static int femurs(smr_mesh bone[PEOPLE])
{
    static const float across[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const char *const names[PEOPLE] = {"femur_m_right", "femur_2008_0019_left_3k", "femur_2007_5028_left_3k",
                                              "femur_vhm_left", "femur"};
    smr_mesh mesh[RIG_STRUCTURES_MAX];
    char name[RIG_STRUCTURES_MAX][SMR_NAME_BYTES];
    uint32_t found = 0;
    for (uint32_t folder = 0; folder < 2u; folder++) {
        const uint32_t n = rig_folder(folder == 0u ? "femurs" : "hip_thigh_vhm", mesh, name);
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t k = 0; k < PEOPLE; k++)
                if (strcmp(name[i], names[k]) == 0) {
                    bone[k] = k == 0u || k == 4u ? rig_moved(&mesh[i], across, nowhere) : mesh[i];
                    found++;
                }
    }
    return found == PEOPLE;
}

/* A pair of bones: what share of each is there (below 0: of the lower end), with or without a scale. */
typedef struct pair {
    float model, target;
    int scaled;
} pair;

static void check_pair(const smr_mesh *a, const smr_mesh *b, const pair *p, const smr_pose *whole, uint32_t *seed)
{
    const smr_mesh model = fabsf(p->model) < 1.0f ? part_of(a, upper, p->model) : *a;
    const smr_mesh target = fabsf(p->target) < 1.0f ? part_of(b, upper, p->target) : *b;
    smr_align_report report;
    const smr_pose pose = aligned(&model, &target, p->scaled, seed, NULL, &report);
    const int top = p->model > 0.0f && p->target > 0.0f;
    const float degrees = degrees_between(&pose, whole), mm = apart_at_end(a, top, &pose, whole);
    const float scale = logf(scale_of(&pose) / scale_of(whole));
    if (getenv("SMR_TEST_SHOW") != NULL)
        printf("%5.2f onto %5.2f: %4.1f degrees, %4.1f mm at the end, scale %+.3f, rms %.1f mm, mirrored %.1f mm\n",
               (double)p->model, (double)p->target, (double)degrees, (double)mm, (double)scale, (double)report.rms_mm,
               (double)report.mirrored_rms_mm);
    assert_true(degrees <= DEGREES_MOST && mm <= MM_MOST && report.n_alike == 1u);
    assert_true(!p->scaled || fabsf(scale) <= SCALE_MOST);
}

TEST(test_femurs)
{
    static const pair kinds[] = {{1, 0.7f, 0},   {-1, -0.5f, 0},  {0.7f, 1, 0},
                                 {-0.5f, -1, 0}, {0.7f, 0.5f, 1}, {-0.6f, -0.8f, 1}};
    smr_mesh bone[PEOPLE];
    uint32_t seed = 5;
    if (!femurs(bone))
        skip();
    for (uint32_t i = 0; i < rig_times(PEOPLE); i++)
        for (uint32_t k = 0; k < 2u; k++) { /* ten of the twenty pairs */
            const smr_mesh *a = &bone[i], *b = &bone[(i + 1u + 2u * k) % PEOPLE];
            smr_align_report report;
            const smr_pose whole = aligned(a, b, 1, &seed, NULL, &report);
            assert_true(report.model_share > 0.95f && report.target_share > 0.95f);
            assert_true(report.mirrored_rms_mm > 1.7f * report.rms_mm);
            for (size_t n = 0; n < sizeof kinds / sizeof kinds[0]; n++)
                check_pair(a, b, &kinds[n], &whole, &seed);
        }
}

/* Femurs of the two sides. */
TEST(test_other_side)
{
    static const float across[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    smr_mesh bone[PEOPLE];
    uint32_t seed = 6;
    if (!femurs(bone))
        skip();
    for (uint32_t i = 0; i + 1u < PEOPLE; i++) {
        const smr_mesh other = rig_moved(&bone[i + 1u], across, nowhere);
        smr_align_report report;
        (void)aligned(&bone[i], &other, 1, &seed, NULL, &report);
        assert_true(report.mirrored_rms_mm < 0.7f * report.rms_mm);
    }
}

TEST(test_deformed_whole)
{
    smr_mesh model, target;
    smr_align_report report;
    rig_bone(6000u, 1.5f, &model, &target);
    (void)aligned(&model, &target, 1, NULL, NULL, &report);
    assert_true(report.model_share > 0.98f && report.target_share > 0.98f);
}

static float mean_apart(const smr_mesh *m, const smr_pose *p)
{
    float sum = 0.0f;
    for (uint32_t v = 0; v < m->n_vertices; v++) {
        float at[3];
        put(p, m->xyz + 3u * (size_t)v, at);
        sum += rig_far(at, m->xyz + 3u * (size_t)v, 1);
    }
    return sum / (float)m->n_vertices;
}

static void check_side(const smr_mesh *bone, uint32_t *seed)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_mesh seen = part_of(bone, forward, 0.2f);
    smr_align_report report;
    smr_pose pose = aligned(bone, &seen, 0, NULL, NULL, &report);
    assert_int_equal(report.given, 1);
    assert_memory_equal(&pose, &identity, sizeof pose);
    for (uint32_t i = 0; i < rig_times(4u); i++) {
        smr_pose off = identity;
        float m[9];
        float axis[3];
        rig_within(seed, -4, 4, axis);
        rig_rotation(axis[0], axis[1], 1.5f, 8.0f + 4.0f * (float)i, m);
        for (uint32_t k = 0; k < 9u; k++)
            off.m[k / 3u][k % 3u] = m[k];
        off.m[i % 3u][3] = 8.0f + 5.0f * (float)i;
        pose = aligned(bone, &seen, 0, NULL, &off, &report);
        assert_true(mean_apart(bone, &pose) < 0.1f * mean_apart(bone, &off));
        assert_true(report.target_share > 0.9f && report.model_share < 0.7f);
    }
}

TEST(test_one_side)
{
    smr_mesh mesh[RIG_STRUCTURES_MAX];
    char name[RIG_STRUCTURES_MAX][SMR_NAME_BYTES];
    uint32_t seed = 7, found = 0;
    for (uint32_t folder = 0; folder < 2u; folder++) {
        const uint32_t n = rig_folder(folder == 0u ? "hip_thigh_vhm" : "ct_hips_surfaces", mesh, name);
        for (uint32_t i = 0; i < n; i++)
            if (strncmp(name[i], "hip_bone", 8) == 0) {
                check_side(&mesh[i], &seed);
                found++;
            }
    }
    if (found == 0u)
        skip();
}
