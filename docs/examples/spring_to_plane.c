/* spring_to_plane.c: a force of the caller's own. Springs draw what of a ball lies below a plane up to it
 * and hold the rest.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <smr.h>
#include <stdio.h>
#include <stdlib.h>

enum { RINGS = 12, AROUND = 16, NV = RINGS * AROUND, NT = 2 * (RINGS - 1) * AROUND };
static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 22], prepared[1 << 20];
static float ball[NV][3];
static uint32_t triangles[NT][3];

/* For each vertex the way to its place at rest, or to the plane above that. */
static void spring(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    const float *plane = ctx; /* unit normal, and its distance from the origin, mm */
    for (uint32_t i = 0; i < view->n; i++) {
        const float *x = view->xyz + 3 * i, *r = view->rest + 3 * i;
        const float below = plane[3] - (plane[0] * r[0] + plane[1] * r[1] + plane[2] * r[2]);
        for (uint32_t c = 0; c < 3; c++) way[3 * i + c] += r[c] + (below > 0 ? below : 0) * plane[c] - x[c];
        weight[i] += 1;
    }
}

int main(void)
{
    for (int i = 0; i < NV; i++) { /* 50 mm, open at the poles */
        const double up = 3.14159 * (i / AROUND + 1) / (RINGS + 1), round = 6.28318 * (i % AROUND) / AROUND;
        ball[i][0] = (float)(50 * sin(up) * cos(round)), ball[i][1] = (float)(50 * sin(up) * sin(round));
        ball[i][2] = (float)(-50 * cos(up));
    }
    for (uint32_t k = 0; k < NT; k++) {
        const uint32_t a = k / 2, right = a / AROUND * AROUND + (a + 1) % AROUND;
        triangles[k][0] = k % 2 ? right + AROUND : a;
        triangles[k][1] = k % 2 ? a + AROUND : right;
        triangles[k][2] = k % 2 ? right : a + AROUND;
    }
    float plane[4] = {0, 0, 1, -30}, least = 0;
    const smr_structure shape = {"ball", {&ball[0][0], &triangles[0][0], NV, NT}};
    const smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    config.caller.force = SMR_CALLER_CHECKED; /* SMR_CALLER_ON when it has proved itself */
    size_t bytes = 0;
    const smr_model *model;
    smr *s;
    smr_tick_report report = {0};
    smr_status status = smr_prepare(&shape, 1, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &bytes);
    if (status == SMR_OK) status = smr_model_open(prepared, bytes, &model);
    if (status == SMR_OK) status = smr_arena_bytes(model, &config, &bytes);
    void *arena = aligned_alloc(SMR_ALIGN, (bytes + SMR_ALIGN - 1) / SMR_ALIGN * SMR_ALIGN);
    if (status == SMR_OK) status = smr_init(model, &config, NULL, arena, bytes, &s);
    if (status == SMR_OK) status = smr_set_force(s, spring, plane);
    while (status == SMR_OK && !report.done) status = smr_tick(s, 0, &report);
    if (status == SMR_OK) status = smr_get_positions(s, 0, &ball[0][0]);
    for (int i = 0; i < NV; i++) least = fminf(least, ball[i][2]);
    printf("%s: the lowest vertex is %.2f mm from the plane\n", smr_status_name(status), (double)fabsf(least + 30));
    free(arena);
    return status != SMR_OK || fabsf(least + 30) > 1;
}
