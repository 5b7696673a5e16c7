/* config.c: the runtime configuration's defaults and ranges.
 * SPDX-License-Identifier: MIT */
#include "runtime/state.h"

smr_config smr_config_default(void)
{
    smr_config c;
    memset(&c, 0, sizeof c);
    c.cookie = SMR_COOKIE('R', smr_config);
    c.n_workers = 1;
    c.stiffness = 0.8f;
    c.attraction = 0.5f;
    c.slide = 0.0f;
    c.even = 0.5f;
    c.search_mm = 60.0f;
    c.search_radii = 1.5f;
    c.normal_deg = 75.0f;
    c.node_budget = 512;
    c.profile_mm = 10.0f;
    c.profile_radii = 0.5f;
    c.gradient_mm = 5.0f;
    c.similarity = SMR_SIMILARITY_CONCORDANCE;
    c.sideways = 0.5f;
    c.confidence = 0.3f;
    c.fill = 1.0f;
    c.method = SMR_METHOD_RIGID;
    c.relaxation = 1.0f;
    c.fold_guard = 1;
    c.momentum = 0.8f;
    c.momentum_last = 0.0f;
    c.plastic_um = 50.0f;
    c.settle_um = 1.0f;
    c.plastic_every = 1;
    c.radius_last = SMR_FINEST;
    c.active_share = 1.0f;
    c.active_first = 1.0f;
    c.active_enough = 30;
    c.iterations = 9;
    c.iterations_last = 60;
    return c;
}

/* Image forces are noisy and reach far: a reference shape that follows now and then, and more iterations. */
smr_config smr_config_default_image(void)
{
    smr_config c = smr_config_default();
    c.profile_mm = 30.0f;
    c.profile_end_mm = 2.0f;
    c.gradient_mm = 5.0f;
    c.gradient_end_mm = 2.0f;
    c.momentum = 0.7f;
    c.momentum_last = 0.6f;
    c.plastic_every = 5;
    c.iterations = 20;
    c.iterations_last = 40;
    return c;
}

static int between(float v, float lo, float hi) { return v >= lo && v <= hi; }

smr_status smr_config_check(const smr_config *c, const smr_model *m)
{
    const uint32_t n_radii = smr_le32(m->n_radii);
    if (c->cookie != SMR_COOKIE('R', smr_config) || c->n_workers < 1u || c->n_workers > SMR_WORKERS_MAX ||
        c->n_target_vertices > SMR_VERTICES_MAX)
        return SMR_E_CONFIG;
    if (!between(c->stiffness, FLT_MIN, 1.0f) || !between(c->attraction, 0.0f, 1.0f) ||
        !between(c->slide, 0.0f, 1.0f) || !between(c->even, 0.0f, 1.0f) ||
        !between(c->search_mm, FLT_MIN, SMR_COORD_MAX) || !between(c->search_radii, FLT_MIN, 1.0e6f) ||
        !between(c->normal_deg, FLT_MIN, 180.0f) || !between(c->reject_deviations, 0.0f, 1.0e6f) ||
        c->reject_border > 1u || c->use_box > 1u || c->node_budget < 8u || c->node_budget > 1000000u)
        return SMR_E_CONFIG;
    for (uint32_t i = 0; c->use_box && i < 3u; i++)
        if (!smr_within(c->box_min[i], SMR_COORD_MAX) || !smr_within(c->box_max[i], SMR_COORD_MAX) ||
            c->box_min[i] > c->box_max[i])
            return SMR_E_CONFIG;
    if (!between(c->profile_mm, 0.0f, 60.0f) || !between(c->profile_end_mm, 0.0f, 60.0f) ||
        !between(c->profile_radii, FLT_MIN, 1.0e6f) || !between(c->gradient_mm, 0.0f, 60.0f) ||
        !between(c->gradient_end_mm, 0.0f, 60.0f) || c->similarity > SMR_SIMILARITY_CONCORDANCE ||
        !between(c->sideways, 0.0f, 1.0f) || !between(c->confidence, 0.0f, 1.0f) || !between(c->fill, 0.0f, 1.0f))
        return SMR_E_CONFIG;
    if (c->method > SMR_METHOD_POLAR || !between(c->relaxation, FLT_MIN, 1.0f) || !between(c->momentum, 0.0f, 0.99f) ||
        !between(c->momentum_last, 0.0f, 0.99f) || !between(c->plastic_um, 0.0f, 1.0e8f) ||
        !between(c->settle_um, 0.0f, 1.0e8f) || c->plastic_every > 1000u || c->fold_guard > 1u ||
        c->normals > SMR_NORMALS_EXACT)
        return SMR_E_CONFIG;
    if (!between(c->active_share, 0.0f, 1.0f) || !between(c->active_first, 0.0f, 1.0f) || c->active_enough > 1000000u)
        return SMR_E_CONFIG;
    if (c->radius_first >= n_radii || (c->radius_last != SMR_FINEST && c->radius_last >= n_radii) ||
        c->radius_last < c->radius_first || c->iterations < 1u || c->iterations > 100000u || c->iterations_last < 1u ||
        c->iterations_last > 100000u)
        return SMR_E_CONFIG;
    return SMR_OK;
}
