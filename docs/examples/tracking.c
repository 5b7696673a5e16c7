/* tracking.c: a bent sheet that turns, thirty times a second: registered once, then followed. */
#include <smr.h>
#include <stdio.h>

enum { N = 21, NV = N * N, NT = 2 * (N - 1) * (N - 1) };
static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 20], prepared[1 << 18], memory[SMR_SURFACE_BYTES(NV, NT)];
static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(NV, NT, 1, 1, NV, SMR_METHOD_RIGID) + SMR_ARENA_TRACK_BYTES(NV, 1)];
static float flat[NV][3], seen[NV][3];
static uint32_t triangles[NT][3];

/* What the camera sees in this frame: the sheet, bent, turned by t = tan(angle / 2) and shifted. */
static void see(unsigned frame)
{
    const float t = 0.004f * (float)frame, c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
    for (int i = 0; i < NV; i++) {
        const float x = flat[i][0], z = 0.002f * x * x;
        seen[i][0] = c * x - s * z, seen[i][1] = flat[i][1] + 0.2f * (float)frame, seen[i][2] = s * x + c * z;
    }
}

int main(void)
{
    for (int i = 0; i < NV; i++)
        flat[i][0] = 5.0f * (float)(i % N), flat[i][1] = 5.0f * (float)(i / N);
    for (uint32_t k = 0; k < NT; k++) {
        const uint32_t a = k / 2 / (N - 1) * N + k / 2 % (N - 1);
        triangles[k][0] = k % 2 ? a + N + 1 : a;
        triangles[k][1] = k % 2 ? a + N : a + 1;
        triangles[k][2] = k % 2 ? a + 1 : a + N;
    }
    const smr_structure sheet = {"sheet", {&flat[0][0], &triangles[0][0], NV, NT}};
    const smr_mesh goal = {&seen[0][0], &triangles[0][0], NV, NT};
    const smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = NV;
    config.track.mode = SMR_TRACK_RECOVER; /* follow, and look for what jumped */
    size_t bytes;
    const smr_model *model;
    smr_surface *target;
    smr *s;
    smr_tick_report report = {0};
    see(0);
    if (smr_prepare(&sheet, 1, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &bytes) != SMR_OK ||
        smr_model_open(prepared, bytes, &model) != SMR_OK || smr_init(model, &config, NULL, arena, sizeof arena, &s) != SMR_OK ||
        smr_surface_build(&goal, memory, sizeof memory, &target) != SMR_OK || smr_set_surface(s, SMR_ALL, target) != SMR_OK)
        return 1;
    while (!report.details.settled) /* the first frame: coarse to fine */
        if (smr_tick(s, 0, &report) != SMR_OK) return 1;
    for (unsigned frame = 1; frame <= 60; frame++) {
        see(frame); /* new positions of the same triangles */
        if (smr_surface_refit(target, &seen[0][0]) != SMR_OK || smr_surface_step(target, 0, NULL, 0) != SMR_OK ||
            smr_set_surface(s, SMR_ALL, target) != SMR_OK) return 1;
        for (int tick = 0; tick < 8 && (tick == 0 || !report.details.settled); tick++)
            if (smr_tick(s, 0, &report) != SMR_OK) return 1;
    }
    printf("%.3f mm from the target, jumped %u\n", (double)report.residual_mean_mm, report.details.jumped);
    return report.details.jumped != 0 || report.residual_mean_mm > 0.5f;
}
