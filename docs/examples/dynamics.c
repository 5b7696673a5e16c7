/* dynamics.c: a rod of 200 mm hangs from one end, is thrown sideways, and swings for two seconds; once a tenth of a
 * second it prints where its centre is and its energies.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <smr.h>
#include <stdio.h>

enum { RINGS = 21, AROUND = 8, NV = RINGS * AROUND, NT = 2 * (RINGS - 1) * AROUND };
static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 22], prepared[1 << 20];
static _Alignas(SMR_ALIGN) unsigned char
    arena[SMR_ARENA_BYTES(NV, NT, 1, 1, 0, SMR_METHOD_RIGID) + SMR_ARENA_DYNAMICS_BYTES(NV, 1)];
static float rod[NV][3], mass[NV], velocity[NV][3];
static uint32_t triangles[NT][3];

int main(void)
{
    for (int i = 0; i < NV; i++) { /* 10 mm thick; 200 g; its upper end is held */
        const double round = 6.28318 * (i % AROUND) / AROUND;
        rod[i][0] = (float)(5 * cos(round)), rod[i][1] = (float)(5 * sin(round));
        rod[i][2] = -10.0f * (float)(i / AROUND);
        mass[i] = i / AROUND == 0 ? INFINITY : 200.0f / (NV - AROUND);
        velocity[i][0] = i / AROUND == 0 ? 0 : -2.0f * rod[i][2]; /* mm/s */
    }
    for (uint32_t k = 0; k < NT; k++) {
        const uint32_t a = k / 2, right = a / AROUND * AROUND + (a + 1) % AROUND;
        triangles[k][0] = k % 2 ? right + AROUND : a;
        triangles[k][1] = k % 2 ? a + AROUND : right;
        triangles[k][2] = k % 2 ? right : a + AROUND;
    }
    const smr_structure shape = {"rod", {&rod[0][0], &triangles[0][0], NV, NT}};
    smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    const smr_model *model;
    size_t bytes;
    smr *s;
    smr_tick_report report = {0};
    smr_energy e;
    prepare.n_radii = 1;
    prepare.radius_mm[0] = 60; /* soft: the rod bends where it is held */
    config.dynamics.mode = SMR_DYNAMICS_ON;
    config.dynamics.step_ms = 5;
    config.dynamics.gravity[2] = -9810;
    smr_status status = smr_prepare(&shape, 1, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &bytes);
    if (status == SMR_OK) status = smr_model_open(prepared, bytes, &model);
    if (status == SMR_OK) status = smr_init(model, &config, NULL, arena, sizeof arena, &s);
    if (status == SMR_OK) status = smr_set_motion(s, 0, mass, &velocity[0][0]);
    while (status == SMR_OK && report.iteration < 400 * SMR_SWEEPS) {
        status = smr_tick(s, 0, &report);
        if (status != SMR_OK || report.iteration % (20 * SMR_SWEEPS) != 0) continue;
        status = smr_get_energy(s, &e);
        printf("%.1f s: centre at %.1f, %.1f, %.1f mm, kinetic %.0f uJ, elastic %.0f, height %.0f\n", 0.005 * e.steps,
               (double)e.centre[0], (double)e.centre[1], (double)e.centre[2], (double)e.kinetic_uj,
               (double)e.elastic_uj, (double)e.gravity_uj);
    }
    return status != SMR_OK;
}
