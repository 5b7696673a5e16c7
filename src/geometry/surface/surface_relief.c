/* surface_relief.c: measures the relief of a mesh: where it bulges out or in more than on average, so that
 * registration can lead ridges onto ridges and hollows into hollows. A vertex bulges by twice the mean curvature, from
 * the height of its neighbours' mean below its tangent plane (M. Desbrun et al., "Implicit fairing of irregular meshes
 * using diffusion and curvature flow", SIGGRAPH 1999). Bulges are diffused over the mesh as far as a Gaussian of
 * 1.15 % of the square root of the area reaches, so that meshes of any density and size compare. Their deviation d from
 * the mean becomes d / (|d| + half the mean of |d|): it says where ridges are and not how sharp, which differs
 * from person to person.
 * Diffusion: rounds of Runge-Kutta-Legendre steps, n passes of which reach as far as n (n + 1) / 2 plain ones
 * (C. Meyer, D. Balsara, T. Aslam, "A stabilized Runge-Kutta-Legendre method", J. Comput. Phys. 257, 2014).
 * Bounds: SMR_RELIEF_ROUNDS rounds of at most 30 passes; SMR_RING_MOST triangles around each vertex in each.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"

#define SMR_RELIEF_ROUNDS 4u     /* with fewer, passes leave traces of fine waves */
#define SMR_RELIEF_TIME 2.86e-5f /* diffusion of a round for each triangle, in replacements by the neighbours' mean */
#define SMR_RELIEF_HALF 0.5f     /* deviation from the mean bulge, in mean deviations, at which relief is 1/2 */
#define SMR_RELIEF_ROUND 0.25f   /* mean deviation / mean bulge of a ball; bones and muscles have 0.35 and more */
#define SMR_RELIEF_FLAT 0.1f     /* mean deviation * root of the area of a flat surface */
#define SMR_BULGE_MOST 0.667f    /* largest bulge * length of edges: creases and spikes of the mesh are no shape */

float smr_bulge(float offset, float square)
{
    const float most = SMR_BULGE_MOST / smr_max(SMR_SQRT(square), 1.0e-6f); /* compilers divide before they test */
    return smr_clamp(-4.0f * offset / smr_max(square, 1.0e-12f), -most, most);
}

/* Returns the number of passes of a round. *share: of the way to the neighbours' mean that the first pass goes. */
static uint32_t passes_of(const smr_surface *s, float *share)
{
    const float time = SMR_RELIEF_TIME * (float)s->tree.n_triangles;
    uint32_t n = 1;
    while ((float)(n * (n + 1u)) < 4.0f * time)
        n++;
    *share = 2.0f * time / (float)(n * (n + 1u));
    return n;
}

/* Returns the mean of bulge[] over the ring of v; bulge[v] in the middle of a fan or without triangles. Who is read
 * also reads, or never changes: but for fans the weights are symmetric, and no wave grows. */
static float ring_mean(const smr_surface *s, uint32_t v, const float *bulge)
{
    const uint32_t n = smr_surface_fan(s, v) ? 0u : smr_surface_ring(s, v);
    float sum = 0.0f; /* over corners, of which v is one in each triangle */
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t *t = smr_ring_triangle(s, v, i);
        sum += bulge[t[0]] + bulge[t[1]] + bulge[t[2]];
    }
    return n > 0u ? (sum - (float)n * bulge[v]) / (2.0f * smr_max((float)n, 1.0f)) : bulge[v];
}

/* Passes take turns: one reads the second half of work.middle and writes the first, the next one the other way. */
void smr_bulges_smooth(smr_surface *s, uint32_t first, uint32_t last)
{
    uint32_t *const pass = &s->work.smoothing.pass;
    float share, *const half[2] = {s->work.middle, s->work.middle + s->n_vertices};
    const uint32_t n = passes_of(s, &share), k = *pass % n + 1u;
    const float *const from = half[1u - *pass % 2u];
    float *const to = half[*pass % 2u];
    const float more = (float)(2u * k - 1u) / (float)k;
    if (s->work.index != NULL || s->noise_mm > 0.0f)
        return; /* there will be no relief */
    for (uint32_t v = first; v < last; v++)
        to[v] = more * from[v] + (1.0f - more) * to[v] + more * share * (ring_mean(s, v, from) - from[v]);
    if (last < s->n_vertices)
        return;
    *pass += 1u;
    if (*pass < SMR_RELIEF_ROUNDS * n)
        s->work.at = 0; /* the stage begins again */
}

/* Returns the smoothed bulge of a vertex, which lies in the second half of work.middle. */
static float bulge_of(const smr_surface *s, uint32_t v) { return s->work.middle[s->n_vertices + v]; }

void smr_bulges_mean(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++)
        s->work.smoothing.mean += s->area[v] * bulge_of(s, v);
    if (last == s->n_vertices)
        s->work.smoothing.mean /= smr_max(s->work.area, 1.0e-20f);
}

void smr_bulges_size(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++)
        s->work.smoothing.size += s->area[v] * smr_abs(bulge_of(s, v) - s->work.smoothing.mean);
    if (last == s->n_vertices)
        s->work.smoothing.size /= smr_max(s->work.area, 1.0e-20f);
}

/* Writes the gradient of the smoothed bulges at each vertex: the mean over its ring, by area. */
void smr_bulges_slope(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++) {
        const uint32_t n = smr_surface_ring(s, v);
        smr_vec sum = smr_v(0, 0, 0);
        float area = 0.0f;
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t *t = smr_ring_triangle(s, v, i);
            const smr_vec a = smr_get3(s->xyz, t[0]), u = smr_sub(smr_get3(s->xyz, t[1]), a);
            const smr_vec b = smr_sub(smr_get3(s->xyz, t[2]), a), m = smr_cross(u, b);
            const float size = smr_length(m), per = 1.0f / smr_max(size, 1.0e-12f);
            const smr_vec across = smr_add(smr_scale(smr_cross(b, m), bulge_of(s, t[1]) - bulge_of(s, t[0])),
                                           smr_scale(smr_cross(m, u), bulge_of(s, t[2]) - bulge_of(s, t[0])));
            sum = smr_add(sum, smr_scale(across, per)); /* gradient times twice the area */
            area += size;
        }
        smr_put3(s->work.middle + 2u * (size_t)s->n_vertices, v, smr_scale(sum, 1.0f / smr_max(area, 1.0e-12f)));
    }
}

/* Returns 0 for a cloud, several bodies, of which the mean is none's, a noisy mesh, and one like a ball or a plane. */
static int has_relief(const smr_surface *s)
{
    const smr_surface_smoothing *const w = &s->work.smoothing;
    const float flat2 = SMR_RELIEF_FLAT * SMR_RELIEF_FLAT;
    return s->work.index == NULL && s->n_bodies == 1u && !(s->noise_mm > 0.0f) &&
           w->size > SMR_RELIEF_ROUND * smr_abs(w->mean) && w->size * w->size * s->work.area > flat2;
}

void smr_relief_set(smr_surface *s, uint32_t first, uint32_t last)
{
    const int has = has_relief(s);
    for (uint32_t v = first; v < last && has; v++) {
        const float d = bulge_of(s, v) - s->work.smoothing.mean;
        const float half = SMR_RELIEF_HALF * s->work.smoothing.size, all = smr_max(smr_abs(d) + half, 1.0e-20f);
        float *const slope = s->work.middle + 2u * (size_t)s->n_vertices;
        smr_put3(slope, v, smr_scale(smr_get3(slope, v), half / (all * all)));
        s->work.middle[v] = d / smr_max(smr_abs(d) + SMR_RELIEF_HALF * s->work.smoothing.size, 1.0e-20f);
    }
    s->slope = has ? s->work.middle + 2u * (size_t)s->n_vertices : NULL;
    s->relief = has ? s->work.middle : NULL;
}
