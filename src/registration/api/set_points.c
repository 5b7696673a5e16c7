/* set_points.c: sets a cloud of points as the target of a structure.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/points.h"
#include "registration/api/setup.h"

smr_status smr_set_points(smr *s, uint32_t structure, const smr_points *points)
{
    const smr_surface *surface = points == NULL ? NULL : &points->surface;
    smr_status status = smr_settable(s, SMR_HAS_PARTIAL, points == NULL || smr_points_valid(points));
    if (status != SMR_OK)
        return status;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_POINTS, structure, surface);
    status = smr_set_target(s, structure, surface);
    if (status == SMR_OK)
        smr_log_note(&s->log, SMR_LOG_POINTS, structure, points, 0);
    return status;
}
