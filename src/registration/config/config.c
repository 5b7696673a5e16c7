/* config.c: defaults and ranges of the configuration, from the table of settings; checks against the model.
 * SPDX-License-Identifier: MIT */
#include "base/settings.h"
#include "registration/config/config.h"

#define SMR_PAPER_ITERATIONS 120u /* iterations of a radius, as in the paper's figures; the paper gives no number */

smr_config smr_config_default(void)
{
    smr_config config, *const c = &config;
    memset(c, 0, sizeof *c);
    c->cookie = SMR_COOKIE('R', smr_config);
#define SMR_GROUP(title)
#define SMR_SETTING(...) SMR_ROW_DEFAULT(__VA_ARGS__)
#include "base/settings_config.def"
    return config;
}

smr_config smr_config_default_image(void)
{
    smr_config config = smr_config_default(), *const c = &config;
#define SMR_GROUP(title)
#define SMR_SETTING(...) SMR_ROW_IMAGE(__VA_ARGS__)
#include "base/settings_config.def"
    return config;
}

smr_config smr_config_paper(void)
{
    smr_config config = smr_config_default_image(), *const c = &config;
    /* the paper's section 3, geometric registration: source vertices are projected onto the target at any distance */
    c->basic.search_mm = SMR_COORD_MAX;
    c->forces.search_radii = 1.0e6f;
    c->forces.normal_deg = 180.0f;
    c->forces.curvature = 0.0f;
    c->partial.coverage = SMR_COVERAGE_WHOLE;
    c->basic.attraction = c->basic.even = 0.0f;
    c->basic.slide = 1.0f;
    /* the paper's section 3, iconic registration: goals by profiles and edges in an image */
    c->forces.stiffness = 0.8f;
    c->image.similarity = SMR_SIMILARITY_NCC;
    c->image.profile_mm = 10.0f;
    c->image.gradient_mm = 5.0f;
    c->image.profile_end_mm = c->image.gradient_end_mm = 0.0f;
    c->image.profile_radii = 1.0e6f;
    c->image.confidence = c->image.sideways = c->image.fill = c->image.nearer = 0.0f;
    c->image.edge = SMR_EDGE_STEEPEST;
    c->image.blend = SMR_BLEND_PLAIN;
    c->image.fade = c->image.rest = 0;
    /* the paper's 2.3, evolution: x = x~; section 3, plasticity: x^r is set to x only at rest */
    c->motion.relaxation = 1.0f;
    c->motion.momentum = c->motion.momentum_last = 0.0f;
    c->motion.plastic_um = 50.0f;
    c->motion.plastic_by = SMR_PLASTIC_MEAN;
    c->motion.plastic_every = 0;
    c->motion.strain_most = 0.0f;
    c->motion.settle_um = 0.0f;
    c->motion.fold_guard = 0;
    c->motion.normals = SMR_NORMALS_EXACT;
    c->motion.turn_deg = 20.0f;
    c->basic.iterations = c->basic.iterations_last = SMR_PAPER_ITERATIONS;
    c->schedule.active_first = 0.2f;
    c->basic.active_share = 1.0f;
    c->schedule.active_enough = 0;
#ifdef SMR_WITHOUT_IMAGE
    config.image = smr_config_default().image;
#endif
    return config;
}

static const smr_range ranges[] = {
#define SMR_GROUP(title)
#define SMR_SETTING(...) SMR_ROW_RANGE(smr_config, __VA_ARGS__)
#include "base/settings_config.def"
};

/* Returns 1 when fields agree with each other and with the model's radii. Dynamics excludes tracking, contact, volume
 * preservation and smoothing, and a last radius whose clusters do not hold all vertices. */
static int fields_agree(const smr_config *c, const smr_model *m)
{
    const uint32_t n_radii = smr_le32(m->n_radii);
    const uint32_t first = c->schedule.radius_first, last = c->schedule.radius_last;
    const int alone = c->track.mode == SMR_TRACK_OFF && !(c->contact.volume > 0.0f) && !(c->contact.smooth > 0.0f) &&
                      !(c->contact.share > 0.0f) && last >= smr_le32(m->coarse_radii);
    int agree = first < n_radii && (last == SMR_FINEST || last < n_radii) && last >= first &&
                (!c->dynamics.mode || alone) && smr_all_within(c->dynamics.gravity, 3, SMR_GRAVITY_MAX);
    for (uint32_t i = 0; c->forces.use_box && i < 3u; i++)
        agree &= c->forces.box_min[i] >= -SMR_COORD_MAX && c->forces.box_max[i] <= SMR_COORD_MAX &&
                 c->forces.box_min[i] <= c->forces.box_max[i];
    return agree;
}

void smr_config_settle(smr_config *c)
{
    if (c->basic.attract)
        return;
    c->basic.attract = 1;
    c->basic.n_target_vertices = 0;
}

const char *smr_built_without(void)
{
    static const char words[] = ""
#ifdef SMR_WITHOUT_IMAGE
                                " image"
#endif
#ifdef SMR_WITHOUT_PARTIAL
                                " partial"
#endif
#ifdef SMR_WITHOUT_TRACK
                                " track"
#endif
#ifdef SMR_WITHOUT_CONTACT
                                " contact"
#endif
#ifdef SMR_WITHOUT_DYNAMICS
                                " dynamics"
#endif
#ifdef SMR_WITHOUT_REFERENCES
                                " references"
#endif
        ;
    return words[0] == ' ' ? words + 1 : words;
}

#define SMR_DIFFERS(group) (memcmp(&own.group, &standard.group, sizeof own.group) != 0)

/* Coverage `whole` needs no capability: a build without partial targets takes all targets as whole. */
int smr_config_left_out(const smr_config *c)
{
    const smr_config standard = smr_config_default();
    smr_config own = *c;
    int differs = 0;
    if (own.partial.coverage == SMR_COVERAGE_WHOLE)
        own.partial.coverage = standard.partial.coverage;
#ifdef SMR_WITHOUT_IMAGE
    differs |= SMR_DIFFERS(image);
#endif
#ifdef SMR_WITHOUT_PARTIAL
    differs |= SMR_DIFFERS(partial);
#endif
#ifdef SMR_WITHOUT_TRACK
    differs |= SMR_DIFFERS(track);
#endif
#ifdef SMR_WITHOUT_CONTACT
    differs |= SMR_DIFFERS(contact);
#endif
#ifdef SMR_WITHOUT_DYNAMICS
    differs |= SMR_DIFFERS(dynamics);
#endif
#ifdef SMR_WITHOUT_REFERENCES
    differs |= SMR_DIFFERS(references);
#endif
    return differs;
}

smr_status smr_config_check(const smr_config *c, const smr_model *m)
{
    const int legal = c->cookie == SMR_COOKIE('R', smr_config) &&
                      smr_ranges_legal(c, ranges, sizeof ranges / sizeof ranges[0]) && !smr_config_left_out(c) &&
                      fields_agree(c, m);
#ifdef SMR_WITHOUT_REFERENCES
    if (smr_model_references(m) != NULL)
        return SMR_E_CONFIG;
#endif
    return legal ? SMR_OK : SMR_E_CONFIG;
}
