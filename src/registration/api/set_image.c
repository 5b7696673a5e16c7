/* set_image.c: sets the target image.
 * Bounds: those of a start of the schedule.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"

smr_status smr_set_volume(smr *s, const smr_volume *volume)
{
    smr_grid grid;
    if (s == NULL)
        return SMR_E_NULL;
    if (!SMR_HAS_IMAGE)
        return SMR_E_CONFIG;
    if (!smr_changeable(s) || (volume != NULL && smr_le32(s->shared.model->profile_samples) == 0u))
        return SMR_E_STATE;
    const smr_status status = volume == NULL ? SMR_OK : smr_grid_open(volume, &grid);
    if (status != SMR_OK)
        return status;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_VOLUME, 0, volume);
    if (volume == NULL && !s->forces.image.has_image)
        return SMR_OK;
    const int follows = smr_tracks(&s->schedule) && volume != NULL && s->forces.image.has_image;
    if (follows && !SMR_HAS_PARTIAL)
        return SMR_E_CONFIG; /* vertices without an image goal would need the field of occluded vertices */
    smr_image_goals_open(&s->forces.image, volume == NULL ? NULL : &grid);
    smr_abandon_iteration(s);
    if (follows)
        smr_restart_forces(s, SMR_CHANGED_IMAGE);
    else
        smr_schedule_start(s);
    smr_log_note(&s->log, SMR_LOG_VOLUME, 0, volume, 0);
    return SMR_OK;
}
