/* verdict_references.c: how far a structure's shape is from the convex blends of a model's several subjects, compared
 * with how far the subjects are from each other. Shapes are compared after the best similarity onto the model's own.
 * Method: sums of products of differences from the mean shape; weights that minimise the squared distance, moved from
 * shape to shape in pairs (sequential minimal optimisation).
 * Bounds: a pass over the vertices with SMR_REFERENCES_MAX^2 / 2 products; SMR_SWEEPS_OF_PAIRS sweeps over the pairs.
 * SPDX-License-Identifier: MIT */
#include "options/references/references.h"
#include "verdict/verdict_measures.h"

#define SMR_SWEEPS_OF_PAIRS 24u
#define SMR_SCALE_LEAST2 1.0e-12f              /* smaller squared scales count as this */
#define SMR_PRODUCTS (SMR_REFERENCES_MAX + 1u) /* rows of the matrix of products: the shapes, then the result */

/* Returns the sums of products [SMR_PRODUCTS][SMR_PRODUCTS], mm^2, in the memory of records. */
static float *products(const smr_judgement *j) { return (float *)j->s->overlay.record; }

uint32_t smr_blend_tasks(const void *job)
{
    const smr_judgement *j = job;
    const size_t room = SMR_JUDGE_WORDS * (size_t)j->s->shared.n;
    return j->verdict != NULL && smr_blends(&j->s->shape) && room >= SMR_PRODUCTS * SMR_PRODUCTS
               ? smr_ceil_div(smr_judged(j)->n_vertices, SMR_JUDGE_PIECE)
               : 0u;
}

/* Returns the squared distance between shapes a and b, summed over the vertices, mm^2. */
static float apart2(const float *p, uint32_t a, uint32_t b)
{
    return p[a * SMR_PRODUCTS + a] + p[b * SMR_PRODUCTS + b] - 2.0f * p[a * SMR_PRODUCTS + b];
}

/* Returns the smallest squared distance of the result, row n, from a convex blend of the n shapes, mm^2. */
static float nearest2(const float *p, uint32_t n)
{
    float weight[SMR_REFERENCES_MAX], slope[SMR_REFERENCES_MAX], off2 = p[n * SMR_PRODUCTS + n];
    for (uint32_t i = 0; i < n; i++)
        weight[i] = 1.0f / (float)n;
    for (uint32_t round = 0; round <= SMR_SWEEPS_OF_PAIRS; round++)
        for (uint32_t i = 0; i < n; i++) {
            slope[i] = -p[i * SMR_PRODUCTS + n];
            for (uint32_t k = 0; k < n; k++)
                slope[i] += weight[k] * p[i * SMR_PRODUCTS + k];
            for (uint32_t k = 0; k < i && round < SMR_SWEEPS_OF_PAIRS; k++) {
                const float bend = apart2(p, i, k);
                const float want = bend > 0.0f ? (slope[k] - slope[i]) / bend : 0.0f;
                const float more = smr_clamp(want, -weight[i], weight[k]);
                weight[i] += more;
                weight[k] -= more;
                for (uint32_t l = 0; l <= i; l++)
                    slope[l] += more * (p[l * SMR_PRODUCTS + i] - p[l * SMR_PRODUCTS + k]);
            }
        }
    for (uint32_t i = 0; i < n; i++)
        off2 += weight[i] * (slope[i] - p[i * SMR_PRODUCTS + n]);
    return smr_max(off2, 0.0f);
}

/* Adds the ratio of the result's distance from the blends to the root mean square distance of two shapes. */
static void take_blend(smr_judgement *j, uint32_t n)
{
    const float *const p = products(j);
    float sum = 0.0f;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < i; k++)
            sum += apart2(p, i, k);
    sum /= 0.5f * (float)(n * (n - 1u));
    if (sum > 0.0f)
        smr_mean_add(&j->e.strange, SMR_SQRT(nearest2(p, n) / sum), (float)smr_judged(j)->n_vertices);
}

void smr_blend_measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr *s = j->s;
    const uint32_t n = s->shared.n_references;
    const smr_piece piece = smr_judged_vertices(j, task);
    const smr_vec column = smr_column(&j->rest, 0), shift = smr_v(j->rest.m[0][3], j->rest.m[1][3], j->rest.m[2][3]);
    const float per = 1.0f / smr_max(smr_dot(column, column), SMR_SCALE_LEAST2);
    smr_vec d[SMR_PRODUCTS];
    if (task == 0u)
        memset(products(j), 0, SMR_PRODUCTS * SMR_PRODUCTS * sizeof(float));
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_vertex(j, i);
        for (uint32_t k = 0; k < n; k++) {
            const uint32_t *at = s->shape.references->difference + 3u * ((size_t)k * s->shared.n + v);
            d[k] = smr_v(smr_le_float(at[0]), smr_le_float(at[1]), smr_le_float(at[2]));
        }
        const smr_vec now = smr_scale(smr_pose_turn_back(&j->rest, smr_sub(smr_get3(s->shape.x, v), shift)), per);
        d[n] = smr_add(d[0], smr_sub(now, smr_rest(&s->shared, v)));
        for (uint32_t a = 0; a <= n; a++)
            for (uint32_t b = 0; b <= n; b++)
                products(j)[a * SMR_PRODUCTS + b] += smr_dot(d[a], d[b]);
    }
    if (piece.last == smr_judged(j)->n_vertices)
        take_blend(j, n);
}
