/* carrying.c: a bone bends; a tumour beside it, a screw's axis and a plane's normal are carried along, and back. */
#include <smr.h>
#include <stdio.h>

enum { RINGS = 60, NV = 8 * RINGS };
static _Alignas(SMR_ALIGN) unsigned char memory[1 << 20];
static float rest[NV][3], now[NV][3];

/* Where the bend takes a place: what smr_get_positions() says of a registration. */
static void bend(const float *p, float *q)
{
    q[0] = p[0] + 0.001f * p[2] * p[2];
    q[1] = p[1] + 4.0f;
    q[2] = p[2] - 0.002f * p[0] * p[2];
}

int main(void)
{
    const float circle[8][2] = {{20, 0}, {14, 14}, {0, 20}, {-14, 14}, {-20, 0}, {-14, -14}, {0, -20}, {14, -14}};
    for (int i = 0; i < NV; i++) { /* a tube of 40 mm, 200 mm long */
        rest[i][0] = circle[i % 8][0];
        rest[i][1] = circle[i % 8][1];
        rest[i][2] = (float)(i / 8) * 200.0f / RINGS;
        bend(rest[i], now[i]);
    }
    const float tumour[3] = {8, 3, 90}, screw[3] = {0, 5, 150};
    float places[1 + SMR_FRAME_PLACES][3], carried[1 + SMR_FRAME_PLACES][3], back[3], normal[3] = {0, 0, 1};
    float jacobian[9];
    smr_pose pose;
    smr_carry *carry;
    smr_carry_fact fact;
    size_t bytes;
    for (int k = 0; k < 3; k++)
        places[0][k] = tumour[k];

    smr_status status = smr_frame_places(screw, 1, 10.0f, places[1]); /* half the screw's length */
    if (status == SMR_OK) status = smr_carry_bytes(NV, 1 + SMR_FRAME_PLACES, 1, &bytes);
    if (status == SMR_OK && bytes > sizeof memory) status = SMR_E_ARENA;
    if (status == SMR_OK) /* once, at rest */
        status = smr_carry_fit(rest[0], NV, places[0], 1 + SMR_FRAME_PLACES, NULL, memory, sizeof memory, &carry);
    if (status == SMR_OK) status = smr_carry_apply(carry, now[0], carried[0]); /* after each tick */
    if (status == SMR_OK) status = smr_frame_poses(places[1], carried[1], 1, &pose, jacobian);
    if (status == SMR_OK) status = smr_frame_normals(jacobian, normal, 1);
    if (status == SMR_OK) status = smr_carry_map(carry, now[0], 1, carried[0], 1, back, &fact);
    if (status != SMR_OK) {
        printf("%s\n", smr_status_name(status));
        return 1;
    }
    printf("tumour at %.2f %.2f %.2f mm, was at %.2f %.2f %.2f\n", (double)carried[0][0], (double)carried[0][1],
           (double)carried[0][2], (double)back[0], (double)back[1], (double)back[2]);
    printf("screw's axis %.3f %.3f %.3f, plane's normal %.3f %.3f %.3f\n", (double)pose.m[0][2], (double)pose.m[1][2],
           (double)pose.m[2][2], (double)normal[0], (double)normal[1], (double)normal[2]);
    return !(fact.miss_mm < 0.01f);
}
