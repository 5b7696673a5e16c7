/* rig_motion.c: a model with mass in time.
 * SPDX-License-Identifier: MIT */
#include "property/rig_motion.h"
#include <stdio.h>
#include <stdlib.h>

static void expect_ok(smr_status status)
{
    if (status == SMR_OK)
        return;
    (void)fprintf(stderr, "rig: %s in motion\n", smr_status_name(status));
    abort();
}

rig_motion rig_motion_make(const smr_mesh *mesh, const smr_prepare_config *radii)
{
    rig_motion m = {.model = rig_model(mesh, 1, radii), .config = smr_config_default(), .n = mesh->n_vertices};
    m.config.dynamics.mode = SMR_DYNAMICS_ON;
    m.config.track.radius_mm = radii->radius_mm[0];
    m.mass = rig_alloc(m.n * sizeof *m.mass);
    m.speed = rig_alloc(3u * (size_t)m.n * sizeof *m.speed);
    for (uint32_t i = 0; i < m.n; i++)
        m.mass[i] = 1.0f;
    return m;
}

smr_mesh rig_plate(uint32_t n, float step)
{
    float *const x = rig_alloc(3u * (size_t)n * n * sizeof *x);
    const uint32_t n_triangles = 2u * (n - 1u) * (n - 1u);
    uint32_t *const t = rig_alloc(3u * (size_t)n_triangles * sizeof *t);
    for (uint32_t i = 0; i < n * n; i++) {
        x[3u * i] = step * ((float)(i % n) - 0.5f * (float)(n - 1u));
        x[3u * i + 1u] = step * ((float)(i / n) - 0.5f * (float)(n - 1u));
    }
    for (uint32_t k = 0; k < n_triangles; k++) {
        const uint32_t a = k / 2u / (n - 1u) * n + k / 2u % (n - 1u);
        t[3u * k] = k % 2u ? a + n + 1u : a;
        t[3u * k + 1u] = k % 2u ? a + n : a + 1u;
        t[3u * k + 2u] = k % 2u ? a + 1u : a + n;
    }
    return (smr_mesh){x, t, n * n, n_triangles};
}

void rig_throw(rig_motion *m, const smr_mesh *mesh, const float centre[3], float spin, float bend)
{
    for (uint32_t i = 0; i < m->n; i++) {
        const float *const p = mesh->xyz + 3u * (size_t)i;
        const float x = p[0] - centre[0], y = p[1] - centre[1], z = p[2] - centre[2];
        float *const v = m->speed + 3u * (size_t)i;
        const float on = m->mass[i] < 9.0f ? 1.0f : 0.0f;
        v[0] = on * (100.0f + spin * y + bend * (z * z / 4e4f - 0.333f));
        v[1] = on * spin * (0.5f * z - x);
        v[2] = on * -0.5f * spin * y;
    }
}

smr_energy rig_energy(const smr *s)
{
    smr_energy energy;
    expect_ok(smr_get_energy(s, &energy));
    return energy;
}

void rig_steps(smr *s, uint32_t n)
{
    for (uint32_t i = 0; i < n * SMR_SWEEPS; i++)
        expect_ok(smr_tick(s, 0, NULL));
}

uint32_t rig_falls(smr *s, uint32_t n, float more, double left[2])
{
    const double start = (double)rig_energy(s).kinetic_uj;
    left[0] = left[1] = 1.0;
    for (uint32_t i = 0; i < n; i++) {
        rig_steps(s, 1);
        const smr_energy now = rig_energy(s);
        left[1] = left[0];
        left[0] = ((double)now.kinetic_uj + (double)now.elastic_uj) / start;
        if (!(left[0] <= left[1] + (double)more))
            return i;
    }
    return n;
}
