/* surface_noise.c: measures the noise of a mesh along its normals, from how far vertices are from the mean of their
 * neighbours. On a smooth surface neighbours are off to the same side, by the curvature; independent noise makes them
 * be off to opposite sides, for each vertex is in its neighbours' means. So the covariance of a vertex' offset with
 * its neighbours' tells noise from shape, whatever the curvature. With six neighbours noise of variance 1 has offsets
 * of variance 7/6 and covariance -5/18. Shape counts as noise where its correlation is below SMR_SHAPE: relief of five
 * vertices a period or fewer. Bones and muscles from CT and MRI have 0.3 to 0.94, decimated ones, too. Offsets
 * beyond SMR_NOISE_LIMIT count as 0, so that a few spikes are no noise. The whole mesh, with bodies that are not the
 * model's, has one noise; a refit keeps it.
 * Bounds: SMR_RING_MOST triangles around each vertex, twice; vertices with more do not count.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"

#define SMR_NOISE_LIMIT 5.0f /* largest offset / (mean square root of offsets)^2; beyond are spikes */
#define SMR_SHAPE 0.2f       /* smallest correlation of neighbours' offsets that noise alone does not lower */
#define SMR_NOISE_SIZE (SMR_SHAPE * 7.0f / 6.0f + 5.0f / 18.0f) /* SMR_SHAPE * variance - covariance of unit noise */

void smr_offsets_find(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++) {
        const smr_vec p = smr_get3(s->xyz, v);
        const uint32_t n = smr_surface_ring(s, v);
        smr_vec sum = smr_v(0, 0, 0);
        float others = 0.0f, square = 0.0f; /* corners that are another vertex; mm^2: squared distances to them */
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t *t = smr_ring_triangle(s, v, i);
            for (uint32_t c = 0; c < 3u; c++) {
                const smr_vec to = smr_sub(smr_get3(s->xyz, t[c]), p); /* to v itself: 0 */
                sum = smr_add(sum, to);
                square += smr_dot(to, to);
                others += t[c] != v ? 1.0f : 0.0f;
            }
        }
        const float offset = others > 0.0f ? smr_dot(smr_get3(s->normal, v), sum) / others : 0.0f;
        s->work.middle[s->n_vertices + v] = smr_bulge(offset, square / smr_max(others, 1.0f));
        s->work.middle[v] = smr_surface_fan(s, v) ? 0.0f : offset;
        s->work.noise.size += SMR_SQRT(smr_abs(s->work.middle[v]));
        s->work.noise.n += others > 0.0f && !smr_surface_fan(s, v) ? 1.0f : 0.0f;
    }
}

/* Returns an offset, or 0 for that of a spike. */
static float offset_of(const smr_surface *s, uint32_t v, float most)
{
    return smr_abs(s->work.middle[v]) <= most ? s->work.middle[v] : 0.0f;
}

void smr_offsets_compare(smr_surface *s, uint32_t first, uint32_t last)
{
    smr_surface_noise *const noise = &s->work.noise;
    const float mean = noise->size / smr_max(noise->n, 1.0f), most = SMR_NOISE_LIMIT * mean * mean;
    for (uint32_t v = first; v < last; v++) {
        const uint32_t n = smr_surface_fan(s, v) ? 0u : smr_surface_ring(s, v);
        const float own = offset_of(s, v, most);
        float sum = 0.0f, others = 0.0f;
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t *t = smr_ring_triangle(s, v, i);
            for (uint32_t c = 0; c < 3u; c++) {
                sum += t[c] != v ? offset_of(s, t[c], most) : 0.0f;
                others += t[c] != v ? 1.0f : 0.0f;
            }
        }
        noise->square += own * own;
        noise->product += others > 0.0f ? own * sum / others : 0.0f;
    }
    const float noise2 = (SMR_SHAPE * noise->square - noise->product) / (SMR_NOISE_SIZE * smr_max(noise->n, 1.0f));
    s->noise_mm = SMR_SQRT(smr_positive(noise2));
}
