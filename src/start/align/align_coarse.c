/* align_coarse.c: the cost of a pose between samples of both surfaces. The squared distance of a pair has full
 * weight across the target's surface and less weight along it, since samples are not opposite each other; differing
 * normals add to it. Without normals it has full weight. Each sample takes its best partner.
 * Bounds: SMR_COARSE squared pairs.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"

#define SMR_ALONG 0.3f /* weight of the squared distance along the surface */
/* limit of distances over the smaller spread: a little more than the spacing of samples */
#define SMR_COARSE_LIMIT 0.15f

void smr_coarse_take(smr_coarse *c, const smr_aligner *a)
{
    c->faced = a->side[SMR_TARGET].bare || a->side[SMR_MODEL].bare ? 0.0f : 1.0f;
    c->limit = SMR_COARSE_LIMIT * smr_aligner_spread(a);
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        float all = 1.0e-6f;
        for (uint32_t k = 0; k < SMR_COARSE; k++) {
            const uint32_t i = smr_sample(&a->side[side], k, SMR_COARSE);
            float v[6];
            smr_store(v, a->side[side].point[i]);
            smr_store(v + 3, a->side[side].normal[i]);
            for (uint32_t j = 0; j < 6u; j++)
                c->x[side][j][k] = v[j];
            c->weight[side][k] = a->side[side].weight[i];
            all += c->weight[side][k];
        }
        for (uint32_t k = 0; k < SMR_COARSE; k++)
            c->weight[side][k] /= all;
    }
}

smr_vec smr_coarse_point(const smr_coarse *c, uint32_t side, uint32_t i, const smr_pose *pose)
{
    const smr_vec p = smr_v(c->x[side][0][i], c->x[side][1][i], c->x[side][2][i]);
    return side == SMR_MODEL ? smr_pose_turn(pose, p) : p;
}

/* Pairs one moved sample of the model with all samples of the target. best[]: smallest cost of each target sample so
 * far. Returns the model sample's cost. Written in lanes for vectorisation. */
static float pair_with_all(const smr_coarse *c, const float p[6], float best[SMR_COARSE])
{
    const float(*t)[SMR_COARSE] = c->x[SMR_TARGET];
    const float bend = c->limit * c->limit, faced = c->faced, blind = 1.0f - faced;
    float lane[SMR_COARSE_LANES], least = FLT_MAX;
    for (uint32_t k = 0; k < SMR_COARSE_LANES; k++)
        lane[k] = FLT_MAX;
    for (uint32_t base = 0; base < SMR_COARSE; base += SMR_COARSE_LANES)
        for (uint32_t k = 0; k < SMR_COARSE_LANES; k++) {
            const uint32_t i = base + k;
            const float x = p[0] - t[0][i], y = p[1] - t[1][i], z = p[2] - t[2][i];
            const float across = x * t[3][i] + y * t[4][i] + z * t[5][i];
            const float cosine = p[3] * t[3][i] + p[4] * t[4][i] + p[5] * t[5][i];
            const float d2 = x * x + y * y + z * z;
            const float cost = SMR_ALONG * d2 + (1.0f - SMR_ALONG) * across * across + bend * (faced - cosine) +
                               blind * (1.0f - SMR_ALONG) * d2;
            lane[k] = cost < lane[k] ? cost : lane[k];
            best[i] = cost < best[i] ? cost : best[i];
        }
    for (uint32_t k = 0; k < SMR_COARSE_LANES; k++)
        least = smr_min(least, lane[k]);
    return least;
}

float smr_coarse_cost(const smr_coarse *c, const smr_pose *pose)
{
    const float(*m)[SMR_COARSE] = c->x[SMR_MODEL];
    const float most = c->limit * c->limit, unit = 1.0f / smr_pose_scale(pose);
    float best[SMR_COARSE], sum[SMR_SIDES] = {0.0f, 0.0f};
    for (uint32_t i = 0; i < SMR_COARSE; i++)
        best[i] = most;
    for (uint32_t i = 0; i < SMR_COARSE; i++) {
        float p[6];
        smr_store(p, smr_pose_apply(pose, smr_v(m[0][i], m[1][i], m[2][i])));
        smr_store(p + 3, smr_scale(smr_pose_turn(pose, smr_v(m[3][i], m[4][i], m[5][i])), unit));
        sum[SMR_MODEL] += c->weight[SMR_MODEL][i] * smr_min(pair_with_all(c, p, best), most);
    }
    for (uint32_t i = 0; i < SMR_COARSE; i++)
        sum[SMR_TARGET] += c->weight[SMR_TARGET][i] * best[i];
    return smr_cost_of_sides(sum[SMR_MODEL] / most, sum[SMR_TARGET] / most);
}
