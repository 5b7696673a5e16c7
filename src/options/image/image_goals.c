/* image_goals.c: goals in the target image (paper 2.1). The reference intensity profile is searched for along the
 * normal within one distance, an edge similar to the reference's edge within another. Both goals are averaged by
 * confidence. A tangential shift may improve the match. Search distances fall linearly with the schedule.
 * Bounds: SMR_LINE_MAX (in noise 8 SMR_LINE_MAX) + 4 SMR_PROFILE_MAX samples a vertex; SMR_LINE_MAX offsets of
 * SMR_PROFILE_MAX multiply-adds.
 * SPDX-License-Identifier: MIT */
#include "options/image/image.h"
#include "image/intensity_profile.h"
#include "image/tangential_shift.h"

#define SMR_LONG 16.0f       /* search distance, in samples, above which only every SMR_HOP-th profile sample is used */
#define SMR_HOP 2u           /* distance, in samples, of the samples used in a long search */
#define SMR_NOISE 0.1f       /* noise level / mean range of a structure's profiles */
#define SMR_SUM_PIECE 1024u  /* vertices in a piece of sums over profiles */
#define SMR_NOISY 1.0f       /* noise of the image / mean noise level of structures above which samples are averaged */
#define SMR_NOISY_EDGE 2.0f  /* the same ratio, from which on the confidence of edges falls, down to a half */
#define SMR_SIDE_VOXELS 0.5f /* largest shift along the surface / mean voxel size */
#define SMR_REST 0.2f        /* largest motion since the last search of a vertex that rests / step of profiles */
#define SMR_SIDE_SHARE 0.19f /* largest shift / search distance of profiles; the larger largest shift holds */
#define SMR_SIDE_NOISY 2.0f  /* largest factor on both in noise, which hides slopes between near lines */

/* Returns 1 when vertices may keep the goals of earlier searches. */
static int rests_used(const smr_shared *shared)
{
    return shared->config.image.rest > 0u && shared->model->profile_samples != 0u;
}

void smr_image_goals_layout(smr_arena *a, smr_image_goals *g, const smr_shared *shared)
{
    g->structure = smr_slot_scratch(a, g->structure, shared->n_structures, sizeof *g->structure);
    const uint32_t n = smr_le32(shared->model->profile_samples) > 0u ? shared->n : 0u; /* without profiles no image */
    g->contrast = smr_slot_bytes(a, g->contrast, n, UINT8_MAX);
    g->contrast_next = smr_slot_scratch(a, g->contrast_next, n, 1);
    g->brighter = smr_slot_bytes(a, g->brighter, n, UINT8_MAX);
    g->brighter_next = smr_slot_scratch(a, g->brighter_next, n, 1);
    const uint32_t n_rest = rests_used(shared) ? n : 0u;
    g->searched = smr_slot_bytes(a, g->searched, n_rest, UINT8_MAX);
    g->last = smr_slot_floats(a, g->last, 6u * (size_t)n_rest, 2.0f * SMR_KEPT_MM);
    smr_keep_words(a, &g->has_image, 1, smr_le32(shared->model->profile_samples) > 0u);
    /* only idle and matched are saved; the next iteration or smr_image_goals_derive() recomputes the others */
    for (uint32_t k = 0; smr_keeps(a) && k < shared->n_structures; k++) {
        smr_image_structure none = {0}, *s = g->structure == NULL ? &none : &g->structure[k];
        smr_keep_words(a, &s->idle, 1, 1);
        smr_keep_floats(a, &s->matched, 1, -1.0f, 1.0f);
    }
}

void smr_image_goals_reset(smr_image_goals *g, uint32_t part, uint32_t parts)
{
    const smr_piece p = smr_part(g->shared->n, part, parts);
    for (uint32_t v = p.first; v < p.last && g->shared->model->profile_samples != 0u; v++) {
        g->contrast[v] = g->contrast_next[v] = 0;
        g->brighter[v] = g->brighter_next[v] = SMR_BRIGHTER_NONE;
    }
    if (rests_used(g->shared)) {
        memset(g->searched + p.first, 0, p.last - p.first);
        memset(g->last + 6u * (size_t)p.first, 0, 6u * (size_t)(p.last - p.first) * sizeof *g->last);
    }
    for (uint32_t k = 0; k < g->shared->n_structures; k++)
        g->structure[k].idle = 0;
    g->n_invisible = 0;
}

void smr_image_keep_found(smr_image_goals *g, smr_piece p)
{
    g->n_invisible = p.first == 0u ? 0u : g->n_invisible;
    for (uint32_t v = p.first; v < p.last; v++) {
        if (v < g->schedule->n_active) {
            g->contrast[v] = g->contrast_next[v];
            g->brighter[v] = g->brighter_next[v];
        }
        g->n_invisible += g->brighter[v] == SMR_BRIGHTER_HIDDEN;
    }
}

void smr_image_forget(smr_image_goals *g, uint32_t v)
{
    if (g->shared->model->profile_samples == 0u)
        return;
    g->contrast_next[v] = 0;
    g->brighter_next[v] = SMR_BRIGHTER_NONE;
}

void smr_image_keep(smr_image_goals *g, uint32_t v)
{
    g->contrast_next[v] = g->contrast[v];
    g->brighter_next[v] = g->brighter[v];
}

int smr_image_goals_sum(smr_image_goals *g, smr_image_summing *j)
{
    const smr_model *m = g->shared->model;
    const smr_shape_structure *one = &g->shape->structure[j->k];
    const uint32_t *ranges = smr_at(m, m->at_ranges);
    g->n_invisible = j->k == 0u && j->at == 0u ? 0u : g->n_invisible;
    for (uint32_t end = smr_min_u32(j->at + SMR_SUM_PIECE, one->n_vertices); j->at < end; j->at++) {
        const size_t v = smr_model_position(m, one->first_vertex + j->at);
        const float range = smr_le_float(ranges[2u * v + 1u]);
        j->sum += range;
        j->count += range > 0.0f ? 1.0f : 0.0f;
        g->n_invisible += g->brighter[v] == SMR_BRIGHTER_HIDDEN;
    }
    if (j->at < one->n_vertices)
        return 0;
    const float noise = g->structure[j->k].noise = j->count > 0.0f ? SMR_NOISE * (j->sum / j->count) : 0.0f;
    j->noise += noise;
    j->noisy += noise > 0.0f ? 1.0f : 0.0f;
    j->sum = j->count = 0.0f;
    j->at = 0;
    g->noise_level = j->noise / smr_max(j->noisy, 1.0f);
    return ++j->k == g->shared->n_structures;
}

/* Returns the number of tasks, a structure each. */
uint32_t smr_fill_tasks(const void *arg)
{
    const smr_image_goals *g = arg;
    return g->has_image ? g->shared->n_structures : 0u;
}

void smr_fill_sum(void *arg, uint32_t structure, uint32_t worker)
{
    ((const smr_image_goals *)arg)->calls->fill_sum(arg, structure, worker);
}

/* The reference profile of a vertex as it is compared: all samples, or every second one in a long search. */
typedef struct reference_profile {
    float low, range, step_mm;
    uint32_t n, inward;  /* number of used samples; number of them inward of the vertex */
    uint32_t hop, first; /* stored samples first, first + hop, ... are used */
} reference_profile;

int smr_image_seeks(const smr_image_goals *g, uint32_t structure)
{
    const smr_schedule *p = g->schedule;
    const float far = smr_max(smr_max(p->profile_mm, g->structure[structure].wide_mm), p->gradient_mm);
    return far >= 0.5f * smr_le_float(g->shared->model->profile_step);
}

/* Returns the distance, mm, within which the profile of vertex v is searched for. */
static float sought_mm(const smr_image_goals *g, uint32_t v)
{
    return smr_max(g->schedule->profile_mm, g->structure[smr_model_owner(g->shared->model, v)].wide_mm);
}

/* Returns the profile of v as it is compared in a search within profile_mm, mm, but without its samples. */
static reference_profile reference_shape(const smr_image_goals *g, uint32_t v, float profile_mm)
{
    const smr_model *m = g->shared->model;
    const uint32_t n = smr_le32(m->profile_samples), inward = smr_le32(m->profile_inward);
    const float step = smr_le_float(m->profile_step);
    const uint32_t *ranges = (const uint32_t *)smr_at(m, m->at_ranges) + 2u * (size_t)v;
    reference_profile r;
    r.hop = profile_mm > SMR_LONG * step && n >= 4u * SMR_HOP ? SMR_HOP : 1u;
    r.first = inward % r.hop;
    r.n = smr_ceil_div(n - r.first, r.hop);
    r.inward = inward / r.hop;
    r.step_mm = step * (float)r.hop;
    r.low = smr_le_float(ranges[0]);
    r.range = smr_le_float(ranges[1]);
    return r;
}

static int varies(const float *line, uint32_t n)
{
    uint32_t k = 1;
    while (k < n && !(line[k] < line[0]) && !(line[k] > line[0]))
        k++;
    return k < n;
}

/* The line of image samples along which a vertex' goal is searched for. */
typedef struct search_line {
    smr_vec start, step;        /* position of the first sample; vector from sample to sample, world mm */
    uint32_t reach, edge_reach; /* search range of the profile; of the edge: samples to either side */
    uint32_t before, n;         /* number of samples before the vertex; of all samples, 0: no search */
} search_line;

static search_line line_of(const smr_image_goals *g, uint32_t v, const reference_profile *r, float profile_mm)
{
    const smr_vec normal = smr_get3(g->shape->normal, v);
    const uint32_t room = (SMR_LINE_MAX - SMR_PROFILE_MAX) / 2u;
    search_line l;
    l.reach = (uint32_t)smr_min(profile_mm / r->step_mm + 0.5f, (float)room); /* step_mm may be 0 */
    l.edge_reach = (uint32_t)smr_min(g->schedule->gradient_mm / r->step_mm + 0.5f, (float)room);
    l.before = smr_max_u32(l.reach + r->inward, l.edge_reach + 2u);
    l.n = l.before + smr_max_u32(l.reach + r->n - r->inward, l.edge_reach + 3u);
    if (!(r->range > 0.0f) || smr_dot(normal, normal) < 0.5f || l.n > SMR_LINE_MAX || l.reach + l.edge_reach == 0u)
        l.n = 0;
    l.step = smr_scale(normal, r->step_mm);
    const smr_vec at = smr_add(smr_get3(g->shape->x, v), g->shape->origin);
    l.start = smr_sub(at, smr_scale(l.step, (float)l.before));
    return l;
}

int smr_image_shows(const smr_image_goals *g, uint32_t v)
{
    float line[SMR_PROFILE_MAX];
    unsigned char inside[SMR_PROFILE_MAX];
    const reference_profile r = reference_shape(g, v, 0.0f);
    const smr_vec step = smr_scale(smr_get3(g->shape->normal, v), r.step_mm);
    const smr_vec at = smr_add(smr_get3(g->shape->x, v), g->shape->origin);
    const smr_vec first = smr_sub(at, smr_scale(step, (float)r.inward));
    return r.range > 0.0f && smr_grid_line(&g->grid, first, step, r.n, line, inside) == r.n;
}

/* Returns 1 when the last search for v found a goal, at most image.rest iterations ago, which v has kept since, and v
 * has hardly moved from the position then[at]; 0 in tracking, which a slow motion would lag behind. */
static int keeps(const smr_image_goals *g, uint32_t v, const float *then, uint32_t at)
{
    const uint32_t rest = g->schedule->tracking ? 0u : g->shared->config.image.rest;
    if (rest == 0u || g->found[v] != SMR_FOUND_GOAL || g->contrast[v] == 0u ||
        !smr_image_seeks(g, smr_model_owner(g->shared->model, v)))
        return 0;
    const uint32_t age = (g->schedule->iteration - __atomic_load_n(&g->searched[v], __ATOMIC_RELAXED)) & UINT8_MAX;
    const smr_vec moved = smr_sub(smr_get3(g->shape->x, v), smr_get3(then, at));
    const float far = SMR_REST * smr_le_float(g->shared->model->profile_step);
    return age > 0u && age <= rest && smr_dot(moved, moved) <= far * far;
}

static int rests(const smr_image_goals *g, uint32_t v) { return keeps(g, v, g->last, 2u * v); }

/* Prefetches the voxels that the search of v reads, unless v seems to rest: another worker may be writing `last`. */
static void ahead(const smr_image_goals *g, uint32_t v)
{
    if (keeps(g, v, g->shape->x_next, v))
        return;
    const float profile_mm = sought_mm(g, v);
    const reference_profile r = reference_shape(g, v, profile_mm);
    const search_line l = line_of(g, v, &r, profile_mm);
    if (l.n > 0u)
        smr_grid_ahead(&g->grid, l.start, l.step, l.n);
}

/* The image at a goal, and the samples of the reference profile that are compared with it: every SMR_HOP-th one. */
typedef struct image_sample {
    smr_profile reference; /* compared samples; n is 0 when one lies outside the image */
    uint32_t hop;
    float first; /* position of the first compared sample on the search line, in samples */
    uint8_t value[SMR_PROFILE_MAX];
    float found[SMR_PROFILE_MAX];
    smr_centred both; /* reference and image, each less its mean */
} image_sample;

/* Writes image and profile at a goal to *sample. offset: goal minus vertex along the normal, in samples. */
static void sample_at(const reference_profile *r, const uint8_t *value, const search_line *l, const float *line,
                      const unsigned char *inside, float offset, image_sample *sample)
{
    sample->hop = SMR_HOP / r->hop;
    sample->first = (float)(l->before - r->inward) + offset;
    sample->reference = (smr_profile){sample->value, r->low, r->range, 0};
    if (!(sample->first >= 0.0f && sample->first + (float)r->n < (float)l->n))
        return;
    const uint32_t whole = (uint32_t)sample->first, n = smr_ceil_div(r->n, sample->hop);
    const float part = sample->first - (float)whole;
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t at = whole + k * sample->hop;
        if (!inside[at] || !inside[at + 1u])
            return;
        sample->found[k] = line[at] + part * (line[at + 1u] - line[at]);
        sample->value[k] = value[k * sample->hop];
    }
    sample->reference.n = n;
    smr_centre(&sample->reference, sample->found, &sample->both);
}

/* Stores contrast (image / profile) and brightness ((image - profile) / noise) at the goal of v as bytes. */
static void compare(smr_image_goals *g, uint32_t v, const image_sample *sample, float noise)
{
    const smr_profile *const reference = &sample->reference;
    float more = 0.0f;
    for (uint32_t k = 0; k < reference->n; k++)
        more += sample->found[k] - reference->low - (float)sample->value[k] * (reference->range * (1.0f / 255.0f));
    const float steps = more / ((float)reference->n * noise);
    if (!smr_within(steps, 1.0e6f)) /* NaN, or too large for an image */
        return;
    const float contrast = smr_contrast(&sample->both, reference->n) * (float)SMR_CONTRAST_ONE;
    g->contrast_next[v] = (uint8_t)smr_min(contrast + 0.5f, 255.0f);
    g->brighter_next[v] = (uint8_t)(smr_clamp(steps, -127.0f, 127.0f) + (float)SMR_BRIGHTER_NONE + 0.5f);
}

/* Returns the shift of v along the surface, mm, after which image and profile match better at the goal. */
static smr_vec tangential_displacement(const smr_image_goals *g, uint32_t v, const search_line *l,
                                       const image_sample *sample)
{
    const float *const spacing = g->grid.volume.spacing, voxel = (spacing[0] + spacing[1] + spacing[2]) * (1.0f / 3.0f);
    const smr_image_structure *const owner = &g->structure[smr_model_owner(g->shared->model, v)];
    if (!(g->shared->config.image.sideways > 0.0f))
        return smr_v(0, 0, 0);
    const float reach = smr_clamp(smr_image_noise(g), 1.0f, SMR_SIDE_NOISY) *
                        smr_max(SMR_SIDE_VOXELS * voxel, SMR_SIDE_SHARE * g->schedule->profile_mm);
    const smr_vec at = smr_add(l->start, smr_scale(l->step, sample->first)), normal = smr_get3(g->shape->normal, v);
    const smr_vec step = smr_scale(l->step, (float)sample->hop);
    const smr_place place = {&sample->reference, at, step, normal, &sample->both, owner->gain, owner->noise, reach};
    return smr_scale(smr_tangential_shift(&g->grid, &place), g->shared->config.image.sideways);
}

/* Returns the goal by the edge search and its confidence, which is 1 when goals are averaged without weights. */
static smr_peak edge_of(const smr_config *c, const smr_profile *reference, const reference_profile *r,
                        const search_line *l, const float *line, const unsigned char *inside)
{
    smr_peak edge = {0, 0};
    if (l->edge_reach == 0u)
        return edge;
    if (c->image.edge == SMR_EDGE_STEEPEST)
        return smr_steepest(line, inside, l->n, l->before, l->edge_reach);
    edge = smr_profile_edge(reference, r->inward, line, inside, l->n, l->before, l->edge_reach);
    if (c->image.blend == SMR_BLEND_PLAIN && edge.confidence > 0.0f)
        edge.confidence = 1.0f;
    return edge;
}

/* Marks v as a vertex that the image does not show. Returns SMR_INVISIBLE. */
static int hidden(smr_image_goals *g, uint32_t v)
{
    g->brighter_next[v] = SMR_BRIGHTER_HIDDEN;
    return SMR_INVISIBLE;
}

/* Searches the image for the goal of v, as smr_image_calls.goal says. */
static int search(smr_image_goals *g, uint32_t v, smr_vec *displacement)
{
    const smr_config *const c = &g->shared->config;
    const float profile_mm = sought_mm(g, v);
    const reference_profile r = reference_shape(g, v, profile_mm);
    const search_line l = line_of(g, v, &r, profile_mm);
    float line[SMR_LINE_MAX];
    unsigned char inside[SMR_LINE_MAX];
    uint8_t value[SMR_PROFILE_MAX];
    if (l.n == 0u)
        return r.range > 0.0f || l.reach + l.edge_reach == 0u ? SMR_UNDECIDED : hidden(g, v);
    const smr_model *const m = g->shared->model;
    const uint8_t *stored = (const uint8_t *)smr_at(m, m->at_profiles) + (size_t)v * smr_le32(m->profile_samples);
    for (uint32_t k = 0; k < r.n; k++)
        value[k] = stored[r.first + k * r.hop];
    smr_peak match = {0, 0};
    const uint32_t first = l.before - l.reach - r.inward;
    const smr_image_structure *const owner = &g->structure[smr_model_owner(g->shared->model, v)];
    const float noise = smr_image_noise(g);
    const int few = (float)v * smr_image_more(g) >= (float)g->schedule->n_active;
    const uint32_t n_inside = noise > SMR_NOISY
                                  ? smr_grid_thick_line(&g->grid, noise, few, l.start, l.step, l.n, line, inside)
                                  : smr_grid_line(&g->grid, l.start, l.step, l.n, line, inside);
    const int whole = n_inside == l.n;
    /* the reference profile plus the mean difference of brightness between image and profiles */
    const smr_profile as_bright = {value, r.low + owner->brighter, r.range, r.n};
    const smr_similarity how = {c->image.similarity, owner->noise, c->image.nearer * profile_mm,
                                c->image.blend == SMR_BLEND_PLAIN};
    if (l.reach > 0u)
        match = smr_profile_match(&as_bright, line + first, whole ? NULL : inside + first, r.n + 2u * l.reach, &how);
    smr_peak edge = edge_of(c, &as_bright, &r, &l, line, whole ? NULL : inside);
    if (noise > SMR_NOISY_EDGE)
        edge.confidence *= smr_max(SMR_NOISY_EDGE / noise, 0.5f);
    const float total = match.confidence + edge.confidence;
    if (!(smr_min(total, 1.0f) > c->image.confidence))
        return whole && varies(line, l.n) ? SMR_NO_GOAL : smr_image_shows(g, v) ? SMR_UNDECIDED : hidden(g, v);
    const float offset =
        (match.confidence * (match.at - (float)l.reach) + edge.confidence * (edge.at - (float)l.before)) / total;
    *displacement = smr_scale(l.step, offset);
    image_sample sample;
    sample_at(&r, value, &l, line, inside, offset, &sample);
    if (sample.reference.n > 0u) {
        compare(g, v, &sample, owner->noise);
        *displacement = smr_add(*displacement, tangential_displacement(g, v, &l, &sample));
    }
    if (noise > SMR_NOISY) /* the goal's mean with the present place, weighted by how sure the goal is */
        *displacement = smr_scale(*displacement, smr_min(total, 1.0f));
    return SMR_GOAL;
}

/* A vertex that rests has the goal of its last search, less its own motion since then along its normal: a motion along
 * the surface would hardly change the tangential displacement, of which each search finds a part. */
static int image_goal(smr_image_goals *g, uint32_t v, smr_vec *displacement)
{
    const smr_vec x = smr_get3(g->shape->x, v), normal = smr_get3(g->shape->normal, v);
    if (rests(g, v)) {
        const smr_vec moved = smr_sub(x, smr_get3(g->last, 2u * v));
        smr_image_keep(g, v);
        *displacement = smr_sub(smr_get3(g->last, 2u * v + 1u), smr_scale(normal, smr_dot(normal, moved)));
        return SMR_GOAL;
    }
    const int found = search(g, v, displacement);
    if (g->shared->config.image.rest == 0u || found != SMR_GOAL)
        return found;
    __atomic_store_n(&g->searched[v], (uint8_t)(g->schedule->iteration & UINT8_MAX), __ATOMIC_RELAXED);
    smr_put3(g->last, 2u * v, x);
    smr_put3(g->last, 2u * v + 1u, *displacement);
    return found;
}

void smr_image_goals_see(smr_image_goals *g, const smr_grid *image)
{
    static const smr_image_calls all = {image_goal, rests, ahead, smr_fill_structure, smr_fill_displacement};
    g->calls = &all;
    g->grid = *image;
    g->noise = smr_grid_noise(image);
}

void smr_image_goals_open(smr_image_goals *g, const smr_grid *image)
{
    g->has_image = image != NULL;
    if (image == NULL)
        return;
    smr_image_goals_see(g, image);
    smr_image_summing sums = {.k = 0};
    while (!smr_image_goals_sum(g, &sums))
        ;
    for (uint32_t k = 0; k < g->shared->n_structures; k++) {
        g->structure[k].gain = 1.0f; /* equal contrast until goals are found */
        g->structure[k].brighter = 0.0f;
    }
}
