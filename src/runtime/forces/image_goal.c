/* image_goal.c: goals in the target image (paper 2.1): the intensity profile of the reference is sought along the normal
 * within one distance, an edge like the reference's own within another; both goals are averaged by their
 * confidence. There the image may tell, too, that the profile fits better a little to the side (image/surface_step.c). Search
 * distances fall linearly with the schedule.
 * Bounds: SMR_LINE_MAX + 4 SMR_PROFILE_MAX samples a vertex, and SMR_LINE_MAX offsets of SMR_PROFILE_MAX multiply-adds.
 * SPDX-License-Identifier: MIT */
#include "runtime/forces/image_goal.h"

#include "image/intensity_profile.h"
#include "image/surface_step.h"
#include "runtime/record/log.h"

#define SMR_LONG 16.0f /* samples: beyond such a search distance every SMR_HOP-th sample tells as much */
#define SMR_HOP 2u
#define SMR_NEARER 0.005f    /* score lost per mm of search distance at its ends */
#define SMR_NOISE 0.1f       /* of a structure's mean profile range: contrast below is none */
#define SMR_SIDE_VOXELS 0.5f /* how far to the side the image is looked at, in mean voxels, */
#define SMR_SIDE_SHARE 0.25f /* or, when that is farther, as a share of the search distance */

/* What contrast counts as none: a share of what the structure's profiles have in the mean. */
static float noise_of(const smr_model *m, const smr_part *part)
{
    const uint32_t *ranges = smr_at(m, m->at_ranges);
    float sum = 0.0f, count = 0.0f;
    for (uint32_t i = 0; i < part->n_vertices; i++) {
        const size_t v = smr_model_position(m, part->first_vertex + i);
        const float range = smr_le_float(ranges[2u * v + 1u]);
        sum += range;
        count += range > 0.0f ? 1.0f : 0.0f;
    }
    return count > 0.0f ? SMR_NOISE * (sum / count) : 0.0f;
}

smr_status smr_set_volume(smr *s, const smr_volume *volume)
{
    smr_grid grid;
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s) || (volume != NULL && smr_le32(s->model->profile_samples) == 0u))
        return SMR_E_STATE;
    if (volume != NULL) {
        smr_status status = smr_grid_open(volume, &grid);
        if (status != SMR_OK)
            return status;
        s->grid = grid;
        for (uint32_t k = 0; k < s->n_parts; k++) {
            s->part[k].noise = noise_of(s->model, &s->part[k]);
            s->part[k].gain = 1.0f; /* until there were goals */
            s->part[k].lighter = 0.0f;
        }
    }
    if (volume == NULL && !s->has_grid)
        return SMR_OK;
    s->has_grid = volume != NULL;
    smr_abandon_iteration(s);
    smr_schedule_start(s);
    smr_log_volume(s, volume);
    return SMR_OK;
}

/* A vertex' reference profile as it is compared: every sample, or every second one where the search is long. */
typedef struct reference_profile {
    float low, range, step_mm;
    uint32_t n, inward;  /* samples, and those before the vertex */
    uint32_t hop, first; /* of the stored ones every hop-th from the first on */
} reference_profile;

/* How far a vertex' profile is sought. */
static float sought_mm(const smr *s, uint32_t v)
{
    return smr_max(s->profile_mm, s->part[smr_model_owner(s->model, v)].wide_mm);
}

/* Without its samples. profile_mm: how far it is sought. */
static reference_profile reference_shape(const smr *s, uint32_t v, float profile_mm)
{
    const smr_model *m = s->model;
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

static void take_samples(const smr *s, uint32_t v, const reference_profile *r, uint8_t *value)
{
    const smr_model *m = s->model;
    const uint8_t *stored = (const uint8_t *)smr_at(m, m->at_profiles) + (size_t)v * smr_le32(m->profile_samples);
    for (uint32_t k = 0; k < r->n; k++)
        value[k] = stored[r->first + k * r->hop];
}

static int varies(const float *line, uint32_t n)
{
    uint32_t k = 1;
    while (k < n && !(line[k] < line[0]) && !(line[k] > line[0]))
        k++;
    return k < n;
}

/* The line through the volume on which a vertex' goal is sought. */
typedef struct search_line {
    smr_vec start, step;        /* world mm */
    uint32_t reach, edge_reach; /* samples to either side in which profile and edge are sought */
    uint32_t before, n;         /* samples before the vertex, and all of them; 0: nothing is sought */
} search_line;

static search_line line_of(const smr *s, uint32_t v, const reference_profile *r, float profile_mm)
{
    const smr_vec normal = smr_load(smr_at3(s->normal, v));
    const uint32_t room = (SMR_LINE_MAX - SMR_PROFILE_MAX) / 2u;
    search_line l;
    l.reach = smr_min_u32((uint32_t)(profile_mm / r->step_mm + 0.5f), room);
    l.edge_reach = smr_min_u32((uint32_t)(s->gradient_mm / r->step_mm + 0.5f), room);
    l.before = smr_max_u32(l.reach + r->inward, l.edge_reach + 2u);
    l.n = l.before + smr_max_u32(l.reach + r->n - r->inward, l.edge_reach + 3u);
    if (!(r->range > 0.0f) || smr_dot(normal, normal) < 0.5f || l.n > SMR_LINE_MAX || l.reach + l.edge_reach == 0u)
        l.n = 0;
    l.step = smr_scale(normal, r->step_mm);
    const smr_vec at = smr_add(smr_load(smr_at3(s->x, v)), s->origin);
    l.start = smr_sub(at, smr_scale(l.step, (float)l.before));
    return l;
}

void smr_image_ahead(const smr *s, uint32_t v)
{
    const float profile_mm = sought_mm(s, v);
    const reference_profile r = reference_shape(s, v, profile_mm);
    const search_line l = line_of(s, v, &r, profile_mm);
    if (l.n > 0u)
        smr_grid_ahead(&s->grid, l.start, l.step, l.n);
}

/* The image where a profile was found, `offset` samples along the normal, and as much of the profile: as many samples as in
 * a long search, fewer than 8 are halved, too. */
typedef struct sight {
    smr_profile reference; /* n is 0 where it is not all inside */
    uint32_t hop;
    float first; /* place on the line */
    uint8_t value[SMR_PROFILE_MAX];
    float found[SMR_PROFILE_MAX];
} sight;

static void look_at(const reference_profile *r, const uint8_t *value, const search_line *l, const float *line,
                    const unsigned char *inside, float offset, sight *g)
{
    g->hop = SMR_HOP / r->hop;
    g->first = (float)(l->before - r->inward) + offset;
    g->reference = (smr_profile){g->value, r->low, r->range, 0};
    if (!(g->first >= 0.0f && g->first + (float)r->n < (float)l->n))
        return;
    const uint32_t whole = (uint32_t)g->first, n = smr_ceil_div(r->n, g->hop);
    const float part = g->first - (float)whole;
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t at = whole + k * g->hop;
        if (!inside[at] || !inside[at + 1u])
            return;
        g->found[k] = line[at] + part * (line[at + 1u] - line[at]);
        g->value[k] = value[k * g->hop];
    }
    g->reference.n = n;
}

/* How the image compares with the profile, for smr.contrast and smr.lighter. */
static void compare(const sight *g, float noise, uint8_t *contrast, uint8_t *lighter)
{
    const uint32_t n = g->reference.n;
    float more = 0.0f;
    for (uint32_t k = 0; k < n; k++)
        more += g->found[k] - g->reference.low - (float)g->value[k] * (g->reference.range * (1.0f / 255.0f));
    const float steps = more / ((float)n * noise);
    if (!smr_within(steps, 1.0e6f)) /* no image's value */
        return;
    *contrast = (uint8_t)smr_min(smr_contrast(&g->reference, g->found) * (float)SMR_CONTRAST_ONE + 0.5f, 255.0f);
    *lighter = (uint8_t)(smr_clamp(steps, -127.0f, 127.0f) + (float)SMR_LIGHTER_NONE + 0.5f);
}

/* The way across the normal from there. */
static smr_vec side_way(const smr *s, uint32_t v, const search_line *l, const sight *g)
{
    const float *const spacing = s->grid.volume.spacing, voxel = (spacing[0] + spacing[1] + spacing[2]) * (1.0f / 3.0f);
    const smr_part *const owner = &s->part[smr_model_owner(s->model, v)];
    if (!(s->config.sideways > 0.0f))
        return smr_v(0, 0, 0);
    const smr_place place = {&g->reference,
                             smr_add(l->start, smr_scale(l->step, g->first)),
                             smr_scale(l->step, (float)g->hop),
                             smr_load(smr_at3(s->normal, v)),
                             g->found,
                             owner->gain,
                             owner->noise,
                             smr_max(SMR_SIDE_VOXELS * voxel, SMR_SIDE_SHARE * s->profile_mm)};
    return smr_scale(smr_sideways(&s->grid, &place), s->config.sideways);
}

int smr_image_goal(const smr *s, uint32_t v, smr_vec *way, uint8_t *contrast, uint8_t *lighter)
{
    const float profile_mm = sought_mm(s, v);
    const reference_profile r = reference_shape(s, v, profile_mm);
    const search_line l = line_of(s, v, &r, profile_mm);
    float line[SMR_LINE_MAX];
    unsigned char inside[SMR_LINE_MAX];
    uint8_t value[SMR_PROFILE_MAX];
    if (l.n == 0u)
        return SMR_UNSEEN;
    take_samples(s, v, &r, value);
    const int whole = smr_grid_line(&s->grid, l.start, l.step, l.n, line, inside) == l.n;
    smr_peak match = {0, 0}, edge = {0, 0};
    const uint32_t first = l.before - l.reach - r.inward;
    const smr_part *const owner = &s->part[smr_model_owner(s->model, v)];
    const smr_profile as_light = {value, r.low + owner->lighter, r.range, r.n}; /* as the image is */
    const smr_likeness how = {s->config.similarity, owner->noise, SMR_NEARER * profile_mm};
    if (l.reach > 0u)
        match = smr_profile_match(&as_light, line + first, inside + first, r.n + 2u * l.reach, &how);
    if (l.edge_reach > 0u)
        edge = smr_profile_edge(&as_light, r.inward, line, inside, l.n, l.before, l.edge_reach);
    const float total = match.confidence + edge.confidence;
    if (!(smr_min(total, 1.0f) > s->config.confidence))
        return whole && varies(line, l.n) ? SMR_NO_GOAL : SMR_UNSEEN;
    const float offset =
        (match.confidence * (match.at - (float)l.reach) + edge.confidence * (edge.at - (float)l.before)) / total;
    *way = smr_scale(l.step, offset);
    sight g;
    look_at(&r, value, &l, line, inside, offset, &g);
    if (g.reference.n > 0u) {
        compare(&g, owner->noise, contrast, lighter);
        *way = smr_add(*way, side_way(s, v, &l, &g));
    }
    return SMR_GOAL;
}
