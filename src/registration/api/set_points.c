/* set_points.c: a cloud of points as a target, as it is set.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/points.h"
#include "registration/api/setup.h"

smr_status smr_set_points(smr *s, uint32_t structure, const smr_points *points)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!SMR_HAS_PARTIAL)
        return SMR_E_CONFIG;
    if (!smr_changeable(s) || (points != NULL && !smr_points_valid(points)))
        return SMR_E_STATE;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_POINTS, structure, points == NULL ? NULL : &points->surface);
    const smr_status status = smr_set_target(s, structure, points == NULL ? NULL : &points->surface);
    if (status == SMR_OK)
        smr_log_note(&s->log, SMR_LOG_POINTS, structure, points, 0);
    return status;
}
