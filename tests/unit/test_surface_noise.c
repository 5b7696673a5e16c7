/* test_surface_noise.c: noise of a mesh's vertices is measured whatever the shape, and shape is no noise.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "geometry/surface/surface.h"
#include "log/record/log_format.h"
#include "unit_mesh.h"

static float noise_of(const unit_mesh *m)
{
    smr_surface *s = unit_surface(m);
    const float noise = s->noise_mm;
    rig_free(s);
    return noise;
}

/* Moves vertices along their direction from the origin by up to `most` mm, every `step`-th one. */
static void shake(unit_mesh *m, float most, uint32_t step, uint32_t seed)
{
    oracle_random r = oracle_seed(seed);
    for (uint32_t v = 0; v < m->nv; v += step) {
        const smr_vec p = smr_get3(m->xyz, v);
        smr_put3(m->xyz, v, smr_add(p, smr_scale(smr_unit(p), oracle_uniformf(&r, -most, most))));
    }
}

TEST(shape_is_no_noise)
{
    unit_mesh all[] = {unit_sphere(1, 40, 0), unit_sphere(4, 40, 0), unit_sphere(5, 15, 0), unit_grid(9, 7, 3)};
    for (uint32_t i = 0; i < 4u; i++) {
        const float flat = noise_of(&all[i]);
        for (uint32_t v = 0; v < all[i].nv; v++) /* bulges, and an edge in the middle */
            all[i].xyz[3u * v + 2u] += 3.0f * sinf(0.1f * all[i].xyz[3u * v]) + 0.5f * fabsf(all[i].xyz[3u * v + 1u]);
        const float bent = noise_of(&all[i]);
        assert_true(flat < 1.0e-3f && bent < 1.0e-3f); /* rounding: far below what is smoothed */
        unit_mesh_free(&all[i]);
    }
}

/* Noise far below the curvature's offsets of 0.25 mm is not seen; it is never told larger than it is. */
TEST(noise_is_measured)
{
    for (uint32_t k = 0; k < 6u; k++) {
        unit_mesh ball = unit_sphere(4, 40, 0);
        const float most = 0.5f * (float)(k + 1u);
        shake(&ball, most, 1, k);
        const float noise = noise_of(&ball), true_noise = most / sqrtf(3.0f);
        assert_true(noise < 1.1f * true_noise && (k == 0u || noise > (k == 1u ? 0.5f : 0.8f) * true_noise));
        unit_mesh_free(&ball);
    }
}

/* A few spikes are no noise, whatever their height. */
TEST(spikes_do_not_count)
{
    for (float most = 30; most < 5000; most *= 10) {
        unit_mesh ball = unit_sphere(4, 40, 0);
        shake(&ball, most, 97, 1);
        assert_true(noise_of(&ball) < 1.0e-3f);
        unit_mesh_free(&ball);
    }
}

/* Triangles that name a vertex twice or thrice are legal, and show nothing of its neighbours. */
TEST(points_and_lines_hide_no_noise)
{
    unit_mesh ball = unit_sphere(4, 40, 0);
    shake(&ball, 1, 1, 5);
    const float noise = noise_of(&ball);
    unit_mesh more = unit_mesh_new(ball.nv, ball.nt + ball.nv);
    memcpy(more.xyz, ball.xyz, 3u * ball.nv * sizeof *ball.xyz);
    memcpy(more.triangles, ball.triangles, 3u * ball.nt * sizeof *ball.triangles);
    for (uint32_t i = 0; i < 3u * ball.nv; i++)
        more.triangles[3u * ball.nt + i] = i / 3u;
    assert_true(fabsf(noise_of(&more) - noise) < 1.0e-3f * noise);
    unit_mesh_free(&more);
    unit_mesh_free(&ball);
}

/* There is memory for an offset and a bulge of each vertex, however few triangles there are. */
TEST(few_triangles)
{
    unit_mesh ball = unit_sphere(4, 40, 0);
    shake(&ball, 1, 1, 5);
    ball.nt = ball.nv / 3u;
    assert_true(noise_of(&ball) > 0.05f);
    for (ball.nt = 1; ball.nt < 20u; ball.nt++)
        assert_true(noise_of(&ball) >= 0.0f);
    unit_mesh_free(&ball);
}

/* In slices of any size the same is measured. */
TEST(slices)
{
    unit_mesh ball = unit_sphere(4, 40, 0);
    size_t bytes;
    shake(&ball, 1, 1, 5);
    const smr_mesh mesh = unit_view(&ball);
    const float whole = noise_of(&ball);
    assert_int_equal(SMR_OK, smr_surface_bytes(ball.nv, ball.nt, &bytes));
    unsigned char *memory = rig_alloc(bytes);
    for (uint32_t units = 1; units < 60u; units += 7u) {
        smr_surface *s;
        assert_int_equal(SMR_OK, smr_surface_begin(&mesh, memory, bytes, &s));
        while (smr_surface_step(s, units, NULL, 0) == SMR_PARTIAL)
            continue;
        assert_true(s->noise_mm == whole);
    }
    rig_free(memory);
    unit_mesh_free(&ball);
}

/* A refit keeps what the build has measured, of which the checksum tells. */
TEST(refits_keep_it)
{
    unit_mesh ball = unit_sphere(4, 40, 0);
    shake(&ball, 1, 1, 5);
    smr_surface *s = unit_surface(&ball);
    const float before = s->noise_mm;
    assert_true(before > 0.4f);
    shake(&ball, 5, 1, 6);
    assert_int_equal(SMR_OK, smr_surface_refit(s, ball.xyz));
    assert_int_equal(SMR_OK, smr_surface_step(s, 0, NULL, 0));
    assert_true(s->noise_mm == before);
    const uint64_t checksum = smr_target_checksum(s);
    s->noise_mm = 0.0f;
    assert_true(smr_target_checksum(s) != checksum);
    rig_free(s);
    unit_mesh_free(&ball);
}
