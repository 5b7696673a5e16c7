/* contact.c: two rings that overlap, structures of one model, are parted and kept out of a third one, which is fixed. */
#include <math.h>
#include <smr.h>
#include <stdio.h>

enum { N = 32, M = 12, NV = N * M, NT = 2 * NV };
static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 22], prepared[1 << 21], memory[3][SMR_SURFACE_BYTES(NV, NT)];
static _Alignas(SMR_ALIGN) unsigned char arena[1 << 21]; /* smr_arena_bytes() says how much */
static float ring[3][NV][3];                             /* the third is fixed */
static uint32_t triangles[NT][3];

static void make(float x, float y, float xyz[NV][3])
{
    for (uint32_t i = 0; i < NV; i++) { /* 20 mm around, 8 mm thick */
        const uint32_t a = i / M, b = i % M, up = (a + 1) % N * M, right = (b + 1) % M;
        const double u = 6.2831853 * a / N, v = 6.2831853 * b / M, r = 20 + 8 * cos(v);
        xyz[i][0] = x + (float)(r * cos(u)), xyz[i][1] = y + (float)(r * sin(u)), xyz[i][2] = (float)(8 * sin(v));
        const uint32_t two[6] = {i, up + b, up + right, i, up + right, a * M + right};
        for (uint32_t k = 0; k < 6; k++) triangles[2 * i + k / 3][k % 3] = two[k];
    }
}

static float deepest(uint32_t i, uint32_t k) /* of one ring in another, mm */
{
    const smr_mesh a = {ring[i][0], triangles[0], NV, NT}, b = {ring[k][0], triangles[0], NV, NT};
    smr_contact_report report = {INFINITY, 0, 0, 0};
    smr_surface *one, *other;
    if (smr_surface_build(&a, memory[0], sizeof memory[0], &one) == SMR_OK &&
        smr_surface_build(&b, memory[1], sizeof memory[1], &other) == SMR_OK)
        (void)smr_surface_contact(one, other, 0.5f, &report);
    return report.deepest_mm;
}

int main(void)
{
    make(0, 0, ring[0]), make(52, 0, ring[1]), make(26, 46, ring[2]);
    const float before[2] = {deepest(0, 1), deepest(0, 2)};
    const smr_mesh fixed = {ring[2][0], triangles[0], NV, NT};
    const smr_structure rings[2] = {{"left", {ring[0][0], triangles[0], NV, NT}},
                                    {"right", {ring[1][0], triangles[0], NV, NT}}};
    const smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    config.contact.share = 1, config.contact.n_fixed = 1; /* targets, if there are any, are set as usual */
    size_t bytes;
    const smr_model *model;
    smr_surface *wall;
    smr *s;
    smr_tick_report report = {0};
    smr_status status = smr_prepare(rings, 2, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &bytes);
    if (status == SMR_OK) status = smr_model_open(prepared, bytes, &model);
    if (status == SMR_OK) status = smr_surface_build(&fixed, memory[2], sizeof memory[2], &wall);
    if (status == SMR_OK) status = smr_init(model, &config, NULL, arena, sizeof arena, &s);
    if (status == SMR_OK) status = smr_set_fixed(s, 0, wall);
    while (status == SMR_OK && !report.done) status = smr_tick(s, 0, &report);
    for (uint32_t i = 0; status == SMR_OK && i < 2; i++) status = smr_get_positions(s, i, ring[i][0]);
    printf("%s: overlaps of %.2f and %.2f mm became %.2f and %.2f mm\n", smr_status_name(status), (double)before[0],
           (double)before[1], (double)deepest(0, 1), (double)deepest(0, 2));
    return status != SMR_OK || deepest(0, 1) > 0.3f * before[0] || deepest(0, 2) > 0.3f * before[1];
}
