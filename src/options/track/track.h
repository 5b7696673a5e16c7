/* track.h: capability: targets that move, after the coarse-to-fine schedule. In: inputs set between ticks, totals of
 * the forces. Out: radius, x^r and search distances of the coming iteration; whether targets have jumped, and whether
 * the model rests.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TRACK_H
#define SMR_TRACK_H

#include "registration/registration.h"

#ifdef SMR_WITHOUT_TRACK
#define SMR_HAS_TRACK 0
#else
#define SMR_HAS_TRACK 1
#endif

/* Values of schedule.changed: an acting input was set; a goal may have moved; a surface, cloud or landmarks, newer than
 * the image, may have moved; there is a new image. */
enum { SMR_CHANGED = 1u, SMR_CHANGED_MOVED = 2u, SMR_CHANGED_SHOWN = 3u, SMR_CHANGED_IMAGE = 4u };

/* Returns 1 when targets are tracked, which starts when the schedule is done. */
static inline int smr_tracks(const smr_schedule *p) { return SMR_HAS_TRACK && p->tracking; }

int smr_tracking_ahead(const smr *s); /* returns 1 when tracking starts with the end of the current iteration */
void smr_tracking_start(smr *s); /* when the schedule is done: starts tracking; x^r and its rest shape are x already */
void smr_tracking_end(smr *s);   /* when the schedule starts over: ends tracking */
void smr_tracking_begin(smr *s); /* before an iteration: restarts iterations when inputs have changed */
void smr_tracking_momentum(smr *s);  /* when targets are known: sets the iteration's momentum */
void smr_tracking_find_jump(smr *s); /* when forces are complete: sets schedule.jumped, 1 after a jump of targets */
void smr_tracking_next(smr *s);      /* after an iteration: sets the next radius after a jump, or `settled` */

/* Returns how far search distances in an image have fallen for the present targets, 0..1: 0 at coarser radii, rising to
 * 1, the smallest distance, in the first half of the iterations at tracking's radius. */
float smr_tracking_progress(const smr *s);

void smr_tracking_keep(smr_arena *a, smr *s); /* saves or restores schedule's tracking fields */
int smr_tracking_legal(const smr *s);         /* returns 1 when restored radius and iteration are possible */

/* Notes that an input was set while targets are tracked. changed: SMR_CHANGED_...; the highest one is kept. */
static inline void smr_tracking_changed(smr *s, uint32_t changed)
{
    if (smr_tracks(&s->schedule))
        s->schedule.changed = smr_max_u32(s->schedule.changed, changed);
}

#endif
