/* test_carry_thigh.c: points under the surfaces of the computed thigh, whose true places are known, carried by true
 * surfaces: what is left is the map's own error. And a bound point costs little.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "fixture_thigh.h"
#include "unit/unit_mesh.h"

#define PARTS 8u /* enough neighbours */
#define COARSE 1.6f
#define MOST (PARTS * FIXTURE_THIGH_VERTICES)
#define EVERY 7u /* vertices from point to point */

typedef struct thigh {
    fixture_thigh anatomy;
    fixture_pose pose;
    float rest[3u * MOST], normal[3u * MOST], now[3u * MOST];
    float scratch[FIXTURE_THIGH_SCRATCH];
    uint32_t triangles[3u * FIXTURE_THIGH_TRIANGLES];
    float points[3u * MOST], truth[3u * MOST], out[3u * MOST];
    uint32_t n;
} thigh;

/* Sums of triangles' area vectors at their corners. */
static void add_normals(const fixture_mesh *m, float *normal)
{
    for (uint32_t t = 0; t < m->n_triangles; t++) {
        const uint32_t *v = m->triangles + 3u * t;
        float a[3], b[3];
        for (uint32_t k = 0; k < 3u; k++) {
            a[k] = m->xyz[3u * v[1] + k] - m->xyz[3u * v[0] + k];
            b[k] = m->xyz[3u * v[2] + k] - m->xyz[3u * v[0] + k];
        }
        for (uint32_t corner = 0; corner < 3u; corner++)
            for (uint32_t k = 0; k < 3u; k++)
                normal[3u * v[corner] + k] += a[(k + 1u) % 3u] * b[(k + 2u) % 3u] - a[(k + 2u) % 3u] * b[(k + 1u) % 3u];
    }
}

static int make_thigh(void **state)
{
    thigh *t = calloc(1, sizeof *t);
    if (t == NULL)
        return -1;
    fixture_thigh_init(&t->anatomy);
    fixture_thigh_pose(1, &t->pose);
    for (uint32_t part = 0; part < PARTS; part++) {
        fixture_mesh m = {t->rest + 3u * t->n, t->triangles, FIXTURE_THIGH_VERTICES, FIXTURE_THIGH_TRIANGLES, 0, 0};
        if (!fixture_thigh_mesh(&t->anatomy, part, COARSE, &m, t->scratch))
            return -1;
        add_normals(&m, t->normal + 3u * t->n);
        t->n += m.n_vertices;
    }
    fixture_thigh_truth(&t->pose, t->rest, t->n, t->now);
    *state = t;
    return 0;
}

static int free_thigh(void **state)
{
    free(*state);
    return 0;
}

/* Points this far under the surface. Returns how many. */
static uint32_t points_under(thigh *t, float depth)
{
    uint32_t n = 0;
    for (uint32_t v = 0; v < t->n; v += EVERY) {
        const float *d = t->normal + 3u * v;
        const float length = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (uint32_t k = 0; k < 3u && length > 0.0f; k++)
            t->points[3u * n + k] = t->rest[3u * v + k] - depth * d[k] / length;
        n += length > 0.0f;
    }
    fixture_thigh_truth(&t->pose, t->points, n, t->truth);
    return n;
}

static void errors(const thigh *t, uint32_t n, double *mean, double *share_above, double limit)
{
    *mean = *share_above = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double d2 = 0.0;
        for (uint32_t k = 0; k < 3u; k++)
            d2 += pow((double)t->out[3u * i + k] - (double)t->truth[3u * i + k], 2);
        *mean += sqrt(d2) / (double)n;
        *share_above += sqrt(d2) > limit ? 1.0 / (double)n : 0.0;
    }
}

static void check_depth(thigh *t, float depth, double limit, double most_above)
{
    const uint32_t n = points_under(t, depth);
    double mean, above;
    size_t bytes = 0;
    smr_carry *carry = NULL;
    assert_int_equal(smr_carry_bytes(t->n, n, 1, &bytes), SMR_OK);
    void *memory = rig_rough(bytes);
    assert_int_equal(smr_carry_fit(t->rest, t->n, t->points, n, NULL, memory, bytes, &carry), SMR_OK);
    assert_int_equal(smr_carry_apply(carry, t->now, t->out), SMR_OK);
    errors(t, n, &mean, &above, limit);
    assert_true(oracle_within("carry: mean error under the thigh's surfaces", mean, 0.5 * limit));
    assert_true(oracle_within("carry: share of points farther off", above, most_above));
    smr_carry_fact *facts = rig_rough(n * sizeof *facts);
    memcpy(t->truth, t->out, 3u * n * sizeof *t->out);
    const uint32_t some = n < 200u ? n : 200u;
    assert_int_equal(smr_carry_map(carry, t->now, 1, t->truth, some, t->out, facts), SMR_OK);
    memcpy(t->truth, t->points, 3u * n * sizeof *t->out);
    errors(t, some, &mean, &above, 0.01);
    assert_true(oracle_within("carry: share not led back to 0.01 mm", above, 0.0));
    rig_free(facts);
    rig_free(memory);
}

TEST(four_millimetres_under) { check_depth(*state, 4.0f, 0.4, 0.03); }

TEST(fifteen_millimetres_under) { check_depth(*state, 15.0f, 1.0, 0.05); }

int main(void) { return suite_run(make_thigh, free_thigh); }
