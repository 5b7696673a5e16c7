/* config.c: the runtime configuration's defaults and ranges, from the table base/settings_config.def; beside it, what
 * relates to the model or to other fields.
 * SPDX-License-Identifier: MIT */
#include "base/settings.h"
#include "runtime/config/config.h"

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

static int radii_legal(const smr_config *c, uint32_t n_radii)
{
    return c->radius_first < n_radii && (c->radius_last == SMR_FINEST || c->radius_last < n_radii) &&
           c->radius_last >= c->radius_first;
}

smr_status smr_config_check(const smr_config *c, const smr_model *m)
{
    const int known = c->cookie == SMR_COOKIE('R', smr_config);
    return known && ranges_legal(c) && box_legal(c) && radii_legal(c, smr_le32(m->n_radii)) ? SMR_OK : SMR_E_CONFIG;
}
