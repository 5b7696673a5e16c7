/* cluster_reference.c: for each new reference shape x^r, each cluster's centre c^r, mass M and covariance C^r or
 * inverse inertia tensor (paper 2.3). x^r is rounded to powers of two of a millimetre, and moments are summed as
 * wrapping integers. About the cluster's own vertex the moments fit and are exact, however far the cluster lies from
 * the origin. Second moments have a coarse step, about a thousandth of the cluster's size; the centre has a fine step.
 * In dynamics weights differ more: the moments about stored vertex 0 are rounded, not the positions.
 * Bounds: four passes over the vertices, one over the lists.
 * SPDX-License-Identifier: MIT */
#include "geometry/linear_solve/eigen_jacobi.h"
#include "registration/match/cluster_match.h"

#define SMR_FINE_SHARE (1.0f / 1024.0f) /* smallest fine step, as a share of the coarse step */
#define SMR_PART_BITS 10u         /* in dynamics positions are rounded to a coarse or fine step / 2^SMR_PART_BITS */
#define SMR_INERTIA_FLOOR 1.0e-4f /* inertia about an axis without torque, at most, / largest inertia of a cluster */
#define SMR_COARSE_MOST (1 << 15) /* largest number of coarse steps between members of a cluster, by step_for() */
#define SMR_FINE_MOST (1 << 30)   /* largest number of fine steps between members of a cluster */

void smr_reference_layout(smr_arena *a, smr_reference *r, const smr_shared *shared)
{
    const size_t n = shared->n;
    /* centre, spread, cluster_mass and share follow from x^r, so a save leaves them out and sets `missing` */
    r->centre = smr_slot_scratch(a, r->centre, n, 3u * sizeof(float));
    r->spread = smr_slot_scratch(a, r->spread, n, 6u * sizeof(float));
    r->cluster_mass = smr_slot_scratch(a, r->cluster_mass, n, sizeof(float));
    r->share = smr_slot_scratch(a, r->share, n, sizeof(float));
    smr_keep_words(a, &r->stale, 1, 1);
    smr_keep_words(a, &r->strained, 1, 1);
}

uint32_t smr_reference_tasks(const void *arg) { return ((const smr_reference *)arg)->shared->n_tasks; }
uint32_t smr_reference_record_tasks(const void *arg) { return smr_match_tasks(((const smr_reference *)arg)->schedule); }

uint32_t smr_reference_cluster_tasks(const void *r)
{
    return smr_ceil_div(((const smr_reference *)r)->shared->n, SMR_MATCH_CHUNK);
}

/* Stores the largest squared distance, mm^2, of x^r from the posed rest shape over a chunk of vertices. */
void smr_reference_reach(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_reference *r = arg;
    float off2 = 0.0f;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(r->shared, task); v++)
        off2 = smr_max(off2, smr_distance2(smr_rest_posed(r->shape, v), smr_get3(r->shape->x_ref, v)));
    r->tally[task].reference.deviation2 = off2;
}

/* Returns a bound on distances of members to a cluster's vertex in x^r, mm: the distance at rest, scaled by the rest
 * pose, plus the distances of both vertices from the rest shape in its pose. */
static float reach_bound(const smr_reference *r)
{
    float off2 = 0.0f;
    for (uint32_t t = 0; t < r->shared->n_tasks; t++)
        off2 = smr_max(off2, r->tally[t].reference.deviation2);
    const float scale = smr_length(smr_column(&r->shape->rest_pose, 0));
    return 1.01f * (r->schedule->lists.reach * scale + 2.0f * SMR_SQRT(off2)) + 1.0e-3f;
}

/* Returns the smallest power of two k, 2^-20..2^40 mm, with mass * (reach / k)^power <= 2^30, in equal time for all. */
static float step_for(float mass, float reach, int power)
{
    float k = 1.0f / 1048576.0f;
    for (int i = 0; i < 60; i++) {
        const float steps = reach / k;
        k *= mass * (power == 2 ? steps * steps : steps) <= 1073741824.0f ? 1.0f : 2.0f;
    }
    return k;
}

void smr_reference_begin(smr_reference *r)
{
    const float reach = reach_bound(r);
    float mass = (float)r->schedule->lists.largest * r->shared->mass_max * r->shared->mass_unit;
    if (r->shared->mass_sum > 0.0f)
        mass = smr_min(mass, r->shared->mass_sum * r->shared->mass_unit);
    r->coarse = step_for(mass, reach, 2);
    r->fine = smr_max(step_for(mass, reach, 1), r->coarse * SMR_FINE_SHARE);
    r->per_coarse = 1.0f / r->coarse; /* exact, because the step is a power of two */
    r->per_fine = 1.0f / r->fine;
    r->sums->words = SMR_WORDS;
}

/* Returns x, limited to +-10^18, rounded to the nearest whole number. */
static inline int64_t nearest(float x)
{
    const float v = smr_clamp(x, -1.0e18f, 1.0e18f);
    return (int64_t)(v + smr_half_like(v));
}

/* Writes x in whole steps of 1 / inverse mm, modulo 2^32. Only differences within a cluster must fit. */
static void steps_of(const float *x, float inverse, uint32_t out[3])
{
    for (uint32_t a = 0; a < 3u; a++)
        out[a] = (uint32_t)(uint64_t)nearest(x[a] * inverse);
}

/* The same, as a function of its own where few vertices need it. */
SMR_SHARED static void few_steps_of(const float *x, float inverse, uint32_t out[3]) { steps_of(x, inverse, out); }

/* Writes x in units of 2^-SMR_PART_BITS / inverse mm, modulo 2^64. */
SMR_SHARED static void parts_of(const float *x, float inverse, uint64_t out[3])
{
    for (uint32_t a = 0; a < 3u; a++)
        out[a] = (uint64_t)nearest(x[a] * inverse * (float)(1u << SMR_PART_BITS));
}

/* Returns p / 2^bits, rounded to nearest. */
static uint32_t whole(uint64_t p, uint32_t bits) { return (uint32_t)((p + ((uint64_t)1 << (bits - 1u))) >> bits); }

/* Writes the origin of moments in coarse steps, modulo 2^32: x^r of stored vertex 0 in dynamics, where moments about a
 * far origin would have large rounding errors; otherwise the origin of x^r. */
static void origin_of(const smr_reference *r, uint32_t out[3])
{
    out[0] = out[1] = out[2] = 0;
    if (r->shared->mass != NULL)
        few_steps_of(smr_at3(r->shape->x_ref, 0), r->per_coarse, out);
}

/* Writes the moments of a vertex of mass m in dynamics. A pinned vertex may weigh as much as its cluster, so rounding
 * its position would not average out: each moment is rounded once, to a unit of 2^-30 of the sum. Moments are needed
 * modulo 2^32, so 64 bits may wrap. */
static void record_parts(const smr_reference *r, uint32_t v, uint64_t m, uint32_t *w)
{
    uint64_t q[3], f[3];
    uint32_t origin[3];
    origin_of(r, origin);
    parts_of(smr_at3(r->shape->x_ref, v), r->per_coarse, q);
    parts_of(smr_at3(r->shape->x_ref, v), r->per_fine, f);
    for (uint32_t a = 0; a < 3u; a++)
        q[a] -= (uint64_t)(int64_t)smr_signed(origin[a]) << SMR_PART_BITS;
    for (uint32_t a = 0, i = 4; a < 3u; a++) {
        w[1u + a] = whole(m * q[a], SMR_PART_BITS);
        w[10u + a] = whole(m * f[a], SMR_PART_BITS);
        for (uint32_t b = a; b < 3u; b++, i++)
            w[i] = whole(m * q[a] * q[b], 2u * SMR_PART_BITS);
    }
}

/* Writes the moments of a vertex of mass m with its position in whole steps. */
static void record_steps(const smr_reference *r, uint32_t v, uint32_t m, uint32_t *w)
{
    uint32_t q[3], f[3];
    steps_of(smr_at3(r->shape->x_ref, v), r->per_coarse, q);
    steps_of(smr_at3(r->shape->x_ref, v), r->per_fine, f);
    for (uint32_t a = 0, i = 4; a < 3u; a++) {
        w[1u + a] = m * q[a];
        w[10u + a] = m * f[a];
        for (uint32_t b = a; b < 3u; b++, i++)
            w[i] = m * q[a] * q[b];
    }
}

void smr_reference_record(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_reference *r = arg;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_MATCH_CHUNK, r->schedule->n_active);
    for (uint32_t v = task * SMR_MATCH_CHUNK; v < last; v++) {
        uint32_t *w = r->sums->record + SMR_WORDS * (size_t)v;
        const uint32_t m = (uint32_t)(smr_mass(r->shared, v) * r->shared->mass_unit);
        if (r->shared->mass != NULL)
            record_parts(r, v, m, w);
        else
            record_steps(r, v, m, w);
        w[0] = m;
        w[13] = SMR_BOUNDARY_UNITS; /* one member in boundary units; the sum over a cluster is the number of members */
        w[14] = w[15] = 0;
    }
}

/* Returns a - b in steps, cut off at +-most, which members of a cluster do not exceed unless the model is forged. */
static int64_t steps_apart(uint32_t a, uint32_t b, int32_t most)
{
    const int32_t d = smr_signed(a - b);
    return d > most ? most : (d < -most ? -most : d);
}

/* Adds moments about the cluster's vertex `to`, which are small integers there. Word 14 sums fractions of mass. */
void smr_reference_add(smr_reference *r, uint32_t to, uint32_t from, int32_t share)
{
    uint32_t *w = r->sums->sum + SMR_WORDS * (size_t)to, origin[3], q[3], f[3], there[3], fine[3], first[3];
    const int64_t m = (int64_t)(smr_mass(r->shared, from) * r->shared->mass_unit) * share;
    int64_t d[3];
    origin_of(r, origin);
    few_steps_of(smr_at3(r->shape->x_ref, from), r->per_coarse, q);
    few_steps_of(smr_at3(r->shape->x_ref, from), r->per_fine, f);
    few_steps_of(smr_at3(r->shape->x_ref, to), r->per_coarse, there);
    few_steps_of(smr_at3(r->shape->x_ref, to), r->per_fine, fine);
    for (uint32_t a = 0; a < 3u; a++) {
        there[a] -= origin[a];
        d[a] = steps_apart(q[a] - origin[a], there[a], SMR_COARSE_MOST);
        first[a] = smr_boundary_part(m * d[a]);
        w[1u + a] += first[a];
        w[10u + a] += smr_boundary_part(m * steps_apart(f[a], fine[a], SMR_FINE_MOST));
    }
    for (uint32_t a = 0, i = 4; a < 3u; a++)
        for (uint32_t b = a; b < 3u; b++, i++)
            w[i] += smr_boundary_part(m * d[a] * d[b]) + there[a] * first[b] + there[b] * first[a];
    w[13] += (uint32_t)share;
    w[14] += (uint32_t)m;
}

/* Writes the pseudo-inverse of the inertia tensor of covariance c, also defined for lines and points. */
static void invert_inertia(const float c[6], float out[6])
{
    const float trace = c[SMR_XX] + c[SMR_YY] + c[SMR_ZZ];
    if (!(trace > 0.0f)) { /* a single vertex, as all clusters of the last radius onto surfaces */
        memset(out, 0, 6u * sizeof *out);
        return;
    }
    const float inertia[6] = {trace - c[SMR_XX], -c[SMR_XY], -c[SMR_XZ],
                              trace - c[SMR_YY], -c[SMR_YZ], trace - c[SMR_ZZ]};
    smr_pseudo_inverse(inertia, SMR_INERTIA_FLOOR, out);
}

void smr_reference_cluster(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_reference *r = arg;
    const float k = r->coarse, unit = 1.0f / r->shared->mass_unit;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_MATCH_CHUNK, r->shared->n);
    uint32_t origin[3];
    origin_of(r, origin);
    for (uint32_t v = task * SMR_MATCH_CHUNK; v < last; v++) {
        const uint32_t *w = r->sums->sum + SMR_WORDS * (size_t)v;
        const float *x = smr_at3(r->shape->x_ref, v);
        uint32_t q[3], f[3];
        r->share[v] = w[13] > 0u ? (float)SMR_BOUNDARY_UNITS / (float)w[13] : 0.0f;
        if (!smr_active(r->schedule, v))
            continue;
        steps_of(x, r->per_coarse, q);
        steps_of(x, r->per_fine, f);
        for (uint32_t a = 0; a < 3u; a++)
            q[a] -= origin[a];
        /* from here on moments are about the cluster's own vertex */
        const float mass = smr_max(smr_unfix(w[0], unit) + smr_unfix(w[14], unit / (float)SMR_BOUNDARY_UNITS), unit);
        float d[3], c[6];
        for (uint32_t a = 0; a < 3u; a++)
            d[a] = smr_unfix(w[1u + a] - w[0] * q[a], k * unit) / mass;
        for (uint32_t a = 0, i = 0; a < 3u; a++)
            for (uint32_t b = a; b < 3u; b++, i++)
                c[i] = smr_unfix(w[4u + i] - q[a] * w[1u + b] - q[b] * w[1u + a] + w[0] * q[a] * q[b], k * k * unit) -
                       mass * d[a] * d[b];
        for (uint32_t a = 0; a < 3u; a++)
            smr_at3(r->centre, v)[a] =
                (float)nearest(x[a] / r->fine) * r->fine + smr_unfix(w[10u + a] - w[0] * f[a], r->fine * unit) / mass;
        r->cluster_mass[v] = mass;
        if (r->shared->config.basic.method == SMR_METHOD_RIGID)
            invert_inertia(c, r->spread + 6u * (size_t)v);
        else
            memcpy(r->spread + 6u * (size_t)v, c, sizeof c);
    }
}

void smr_reference_end(smr_reference *r)
{
    r->stale = r->missing = 0;
    r->sums->words = smr_method_words(r->shared);
}
