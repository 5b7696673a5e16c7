/* config.c: the runtime configuration's defaults and ranges, from the table base/settings_config.def; beside it, what
 * relates to the model or to other fields.
 * SPDX-License-Identifier: MIT */
#include "base/settings.h"
#include "registration/config/config.h"

#define SMR_PAPER_ITERATIONS 120u /* the paper does not say: as many as bring its own figures */

smr_config smr_config_default(void)
{
    smr_config config, *const c = &config;
    memset(c, 0, sizeof *c);
    c->cookie = SMR_COOKIE('R', smr_config);
#define SMR_GROUP(title)
#define SMR_SETTING SMR_ROW_DEFAULT
#include "base/settings_config.def"
    return config;
}

smr_config smr_config_default_image(void)
{
    smr_config config = smr_config_default(), *const c = &config;
#define SMR_GROUP(title)
#define SMR_SETTING SMR_ROW_IMAGE
#include "base/settings_config.def"
    return config;
}

smr_config smr_config_paper(void)
{
    smr_config config = smr_config_default_image(), *const c = &config;
    /* 3, geometric registration: source vertices are projected onto the target, whatever lies between */
    c->search_mm = SMR_COORD_MAX;
    c->search_radii = 1.0e6f;
    c->normal_deg = 180.0f;
    c->coverage = SMR_COVERAGE_WHOLE;
    c->attraction = c->even = 0.0f;
    c->slide = 1.0f;
    /* 3, iconic registration */
    c->stiffness = 0.8f;
    c->similarity = SMR_SIMILARITY_NCC;
    c->profile_mm = 10.0f;
    c->gradient_mm = 5.0f;
    c->profile_end_mm = c->gradient_end_mm = 0.0f;
    c->profile_radii = 1.0e6f;
    c->confidence = c->sideways = c->fill = c->nearer = 0.0f;
    c->edge = SMR_EDGE_STEEPEST;
    c->blend = SMR_BLEND_PLAIN;
    c->fade = 0;
    /* 2.3, evolution: x = x~; 3, plasticity: at rest only */
    c->relaxation = 1.0f;
    c->momentum = c->momentum_last = 0.0f;
    c->plastic_um = 50.0f;
    c->plastic_by = SMR_PLASTIC_MEAN;
    c->plastic_every = 0;
    c->settle_um = 0.0f;
    c->fold_guard = 0;
    c->normals = SMR_NORMALS_EXACT;
    c->turn_deg = 20.0f;
    c->iterations = c->iterations_last = SMR_PAPER_ITERATIONS;
    c->active_first = 0.2f;
    c->active_share = 1.0f;
    c->active_enough = 0;
    return config;
}

static int ranges_legal(const smr_config *c)
{
    int legal = 1;
#define SMR_GROUP(title)
#define SMR_SETTING SMR_ROW_LEGAL
#include "base/settings_config.def"
    return legal;
}

/* The box counts only where it is used. */
static int box_legal(const smr_config *c)
{
    int legal = 1;
    for (uint32_t i = 0; c->use_box && i < 3u; i++)
        legal &= smr_within(c->box_min[i], SMR_COORD_MAX) && smr_within(c->box_max[i], SMR_COORD_MAX) &&
                 c->box_min[i] <= c->box_max[i];
    return legal;
}

/* Moving targets are followed by relaxation or in time, not both; volumes and smoothness are kept by relaxation. */
static int dynamics_legal(const smr_config *c)
{
    const int alone = c->track == SMR_TRACK_OFF && !(c->volume > 0.0f) && !(c->smooth > 0.0f) && !(c->contact > 0.0f);
    int legal = !c->dynamics || alone;
    for (uint32_t i = 0; i < 3u; i++)
        legal &= smr_within(c->gravity[i], SMR_GRAVITY_MAX);
    return legal;
}

static int radii_legal(const smr_config *c, uint32_t n_radii)
{
    return c->radius_first < n_radii && (c->radius_last == SMR_FINEST || c->radius_last < n_radii) &&
           c->radius_last >= c->radius_first;
}

smr_status smr_config_check(const smr_config *c, const smr_model *m)
{
    const int known = c->cookie == SMR_COOKIE('R', smr_config);
    return known && ranges_legal(c) && box_legal(c) && dynamics_legal(c) && radii_legal(c, smr_le32(m->n_radii))
               ? SMR_OK
               : SMR_E_CONFIG;
}
