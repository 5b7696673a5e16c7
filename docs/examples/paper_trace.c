/* The paper's own registration of a sheet onto a bent one, and its trace: a row for each iteration.
 * SPDX-License-Identifier: MIT */
#include <smr.h>
#include <stdio.h>

enum { N = 41, NV = N * N, NT = 2 * (N - 1) * (N - 1) };
static _Alignas(SMR_ALIGN) unsigned char scratch[4 << 20], prepared[1 << 20], memory[SMR_SURFACE_BYTES(NV, NT)];
static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(NV, NT, 1, 1, 0, SMR_METHOD_RIGID)];
static float flat[NV][3], bent[NV][3];
static uint32_t triangles[NT][3];

static void make_sheets(void)
{
    for (uint32_t i = 0; i < NV; i++) {
        flat[i][0] = bent[i][0] = 5.0f * (float)(i % N);
        flat[i][1] = bent[i][1] = 5.0f * (float)(i / N);
        bent[i][2] = 0.0005f * bent[i][0] * bent[i][0];
    }
    for (uint32_t k = 0; k < NT; k++) {
        const uint32_t a = k / 2 / (N - 1) * N + k / 2 % (N - 1);
        triangles[k][0] = k % 2 ? a + N + 1 : a;
        triangles[k][1] = k % 2 ? a + N : a + 1;
        triangles[k][2] = k % 2 ? a + 1 : a + N;
    }
}

int main(void)
{
    const smr_structure sheet = {"sheet", {&flat[0][0], &triangles[0][0], NV, NT}};
    const smr_mesh goal = {&bent[0][0], &triangles[0][0], NV, NT};
    const smr_prepare_config prepare = smr_prepare_config_paper(); /* one radius of 30 mm */
    const smr_config config = smr_config_paper();
    size_t bytes;
    const smr_model *model;
    smr_surface *target;
    smr *s;
    smr_tick_report report = {0};
    smr_verdict verdict;
    make_sheets();
    smr_status status = smr_prepare(&sheet, 1, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &bytes);
    if (status == SMR_OK) status = smr_model_open(prepared, bytes, &model);
    if (status == SMR_OK) status = smr_surface_build(&goal, memory, sizeof memory, &target);
    if (status == SMR_OK) status = smr_init(model, &config, NULL, arena, sizeof arena, &s);
    if (status == SMR_OK) status = smr_set_surface(s, SMR_ALL, target);
    printf("iteration,residual_mm,moved_max_mm,reference_updates,strain_share\n");
    while (status == SMR_OK && !report.done) {
        status = smr_tick(s, 0, &report);
        if (status == SMR_OK) status = smr_get_verdict(s, SMR_ALL, &verdict); /* changes no result */
        if (status == SMR_OK)
            printf("%u,%.4f,%.4f,%u,%.5f\n", report.iteration, (double)report.residual_mean_mm,
                   (double)report.displacement_max_mm, report.details.plastic_updates, (double)verdict.strain);
    }
    return status != SMR_OK || !(report.residual_mean_mm < 0.5f);
}
