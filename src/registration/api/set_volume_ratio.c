/* set_volume_ratio.c: sets the wanted volumes of structures, and reads the present ones.
 * Bounds: a pass over the structures; to read volumes, one over a structure's triangles and one over all vertices.
 * SPDX-License-Identifier: MIT */
#include "options/track/track.h"
#include "registration/api/setup.h"

smr_status smr_set_volume_ratio(smr *s, uint32_t structure, float ratio)
{
    SMR_TRY(smr_settable(s, SMR_HAS_CONTACT, smr_ready(s)));
    smr_kept_volume *kept = s->volumes.kept;
    const uint32_t n = s->shared.n_structures;
    if (kept == NULL)
        return SMR_E_ARENA;
    if ((structure != SMR_ALL && (structure >= n || !kept[structure].closed)) ||
        !(ratio >= SMR_VOLUME_RATIO_LEAST && ratio <= SMR_VOLUME_RATIO_MOST))
        return SMR_E_INPUT;
    for (uint32_t i = 0; i < n; i++)
        if (structure == SMR_ALL || structure == i)
            kept[i].ratio = ratio;
    smr_restart_forces(s, SMR_CHANGED);
    smr_changed(s, SMR_LOG_VOLUME_RATIO, structure, &ratio, 0);
    return SMR_OK;
}

smr_status smr_get_structure_volume(const smr *s, uint32_t structure, smr_structure_volume *volume)
{
    SMR_TRY(smr_readable(s, structure, volume));
    const smr_kept_volume *kept = s->volumes.kept;
    const smr_bulk bulk = smr_rest_volume(&s->shape, structure);
    smr_fit fit;
    memset(volume, 0, sizeof *volume);
    volume->closed = bulk.closed;
    if (!volume->closed)
        return SMR_OK;
    smr_start_fit(&s->shape, &fit, 0, s->shared.n);
    const float scale = smr_start_scale(&fit);
    const float rest = bulk.mm3 * (scale * scale * (smr_start_mirrored(&fit) ? -scale : scale));
    const float side = rest < 0.0f ? -1.0f : 1.0f;
    volume->rest_mm3 = side * rest;
    volume->present_mm3 = side * smr_enclosed_of(&s->shape, structure, s->shape.x);
    volume->ratio = rest * side > 0.0f ? volume->present_mm3 / volume->rest_mm3 : 0.0f;
    if (kept != NULL) {
        volume->asked_ratio = kept[structure].ratio;
        volume->asked_mm3 = kept[structure].ratio * volume->rest_mm3;
    }
    return SMR_OK;
}
