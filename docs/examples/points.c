/* points.c: points of a patient arrive 20 at a time, as a hand digitises them, and the model follows. They lie on a
 * part of it only; the rest goes with what they show. */
#include <smr.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 21, NV = N * N, NT = 2 * (N - 1) * (N - 1), MOST = 600, EACH = 20 }; /* a sheet of 100 x 100 mm */
static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 20], prepared[1 << 18], memory[SMR_POINTS_BYTES(MOST)];
static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(NV, NT, 1, 1, MOST, SMR_METHOD_RIGID)];
static float sheet[NV][3], result[NV][3];
static uint32_t triangles[NT][3];

static float height(float x, float y) { return 4.0f + 0.001f * (x * x - y * y); } /* of the patient's, mm */

static float any(float most) { return most * (float)rand() / (float)RAND_MAX; }

int main(void)
{
    for (uint32_t i = 0; i < NV; i++) {
        sheet[i][0] = 5.0f * (float)(i % N), sheet[i][1] = 5.0f * (float)(i / N);
    }
    for (uint32_t k = 0; k < NT; k++) { /* cell a: triangles a, a+1, a+N and a+N+1, a+N, a+1 */
        const uint32_t a = k / 2 / (N - 1) * N + k / 2 % (N - 1);
        triangles[k][0] = k % 2 ? a + N + 1 : a;
        triangles[k][1] = k % 2 ? a + N : a + 1;
        triangles[k][2] = k % 2 ? a + 1 : a + N;
    }
    const smr_structure structure = {"sheet", {&sheet[0][0], &triangles[0][0], NV, NT}};
    const smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = MOST; /* room for the cloud */
    size_t bytes;
    const smr_model *model;
    smr_points *points;
    smr *s;
    smr_tick_report report = {0};
    smr_status status = smr_prepare(&structure, 1, &prepare, scratch, sizeof scratch, prepared, sizeof prepared, &bytes);
    if (status == SMR_OK) status = smr_model_open(prepared, bytes, &model);
    if (status == SMR_OK) status = smr_points_open(MOST, memory, sizeof memory, &points);
    if (status == SMR_OK) status = smr_init(model, &config, NULL, arena, sizeof arena, &s);
    for (int tick = 0; status == SMR_OK && !report.done; tick++) {
        float xyz[EACH][3];
        for (int i = 0; i < EACH; i++) { /* 60 of 100 mm are seen; noise of up to 0.3 mm */
            xyz[i][0] = any(60.0f), xyz[i][1] = any(100.0f);
            xyz[i][2] = height(xyz[i][0], xyz[i][1]) + any(0.6f) - 0.3f;
        }
        if (tick < MOST / EACH) status = smr_points_add(points, &xyz[0][0], NULL, NULL, EACH);
        if (status == SMR_OK) status = smr_set_points(s, SMR_ALL, points); /* after each change */
        if (status == SMR_OK) status = smr_tick(s, 0, &report);
    }
    if (status == SMR_OK) status = smr_get_positions(s, 0, &result[0][0]);
    float off = 0.0f;
    for (uint32_t i = 0; i < NV; i++) {
        const float d = result[i][2] - height(result[i][0], result[i][1]);
        off += (d < 0.0f ? -d : d) / NV;
    }
    printf("%s: %u iterations, %.2f mm off\n", smr_status_name(status), report.iteration, (double)off);
    return status != SMR_OK;
}
