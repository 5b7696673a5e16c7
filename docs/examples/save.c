/* save.c: a registration is saved half way, goes on in another arena, and comes to the same bits.
 * SPDX-License-Identifier: MIT */
#include <smr.h>
#include <stdio.h>

enum { N = 21, NV = N * N, NT = 2 * (N - 1) * (N - 1) }; /* a sheet of 100 x 100 mm */
static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 20], prepared[1 << 18], memory[SMR_SURFACE_BYTES(NV, NT)];
#define ARENA SMR_ARENA_BYTES(NV, NT, 1, 1, NV, SMR_METHOD_RIGID)
static _Alignas(SMR_ALIGN) unsigned char arena[ARENA], another[ARENA];
static unsigned char saved[SMR_SAVE_BYTES(NV, 1, NV, 0, SMR_METHOD_RIGID)];
static float flat[NV][3], bent[NV][3];
static uint32_t triangles[NT][3];

static void make_sheet(void)
{
    for (uint32_t i = 0; i < NV; i++) {
        flat[i][0] = bent[i][0] = 5.0f * (float)(i % N);
        flat[i][1] = bent[i][1] = 5.0f * (float)(i / N);
        bent[i][2] = 0.002f * bent[i][0] * bent[i][0];
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
    const smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    smr_tick_report report = {0}, again = {0};
    const smr_model *model;
    smr_surface *target;
    size_t bytes;
    smr *s, *restored;
    make_sheet();
    config.basic.n_target_vertices = NV;
    smr_status status = smr_prepare(&sheet, 1, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &bytes);
    if (status == SMR_OK) status = smr_model_open(prepared, bytes, &model);
    if (status == SMR_OK) status = smr_surface_build(&goal, memory, sizeof memory, &target);
    if (status == SMR_OK) status = smr_init(model, &config, NULL, arena, sizeof arena, &s);
    if (status == SMR_OK) status = smr_set_surface(s, SMR_ALL, target);
    for (uint32_t tick = 0; status == SMR_OK && tick < 10; tick++) status = smr_tick(s, 0, &report);
    if (status == SMR_OK) status = smr_save(s, saved, sizeof saved); /* write smr_save_bytes() of it to a file */

    /* perhaps tomorrow, on another machine */
    if (status == SMR_OK)
        status = smr_restore(model, NULL, NULL, saved, sizeof saved, another, sizeof another, &restored);
    if (status == SMR_OK) status = smr_set_surface(restored, SMR_ALL, target); /* the same one again */
    while (status == SMR_OK && !again.done) status = smr_tick(restored, 0, &again);

    while (status == SMR_OK && !report.done) status = smr_tick(s, 0, &report);
    printf("%s: %u and %u iterations, %s\n", smr_status_name(status), report.iteration, again.iteration,
           again.state_hash == report.state_hash ? "the same bits" : "other bits");
    return status != SMR_OK || again.state_hash != report.state_hash;
}
