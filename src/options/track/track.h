/* track.h: capability: targets that move, after the coarse-to-fine schedule. In: what was set between ticks, what the
 * forces found. Out: the radius, x^r and search distances of the coming iteration; whether targets have jumped, and
 * whether the model rests.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TRACK_H
#define SMR_TRACK_H

#include "registration/registration.h"

#ifdef SMR_WITHOUT_TRACK
#define SMR_HAS_TRACK 0
#else
#define SMR_HAS_TRACK 1
#endif

/* smr_pace.called, and what has happened then: something acts upon the model; a goal may have moved; so may a surface,
 * cloud or landmarks, which show more than an image before them; there is another image. */
enum { SMR_CALLED = 1u, SMR_CALLED_MOVED = 2u, SMR_CALLED_SHOWN = 3u, SMR_CALLED_IMAGE = 4u };

/* 1: the schedule is done, and targets are followed. */
static inline int smr_tracks(const smr_pace *p) { return SMR_HAS_TRACK && p->tracking; }

void smr_tracking_start(smr *s);    /* the schedule is done: x is the shape from here on */
void smr_tracking_end(smr *s);      /* the schedule starts over */
void smr_tracking_begin(smr *s);    /* before an iteration */
void smr_tracking_momentum(smr *s); /* then, once it is known what it looks at */
void smr_tracking_look(smr *s);     /* the forces are complete */
void smr_tracking_next(smr *s);     /* after an iteration */

/* 0..1: how far the model is on its way to the targets that are followed, as search distances in an image go by it. */
float smr_tracking_progress(const smr *s);

/* What a save keeps of it. After that smr_tracking_legal() says whether what was kept while targets are followed can
 * be. */
void smr_tracking_keep(smr_arena *a, smr *s);
int smr_tracking_legal(const smr *s);

/* There is something to look at: SMR_CALLED... */
static inline void smr_tracking_call(smr *s, uint32_t called)
{
    if (smr_tracks(&s->pace))
        s->pace.called = smr_max_u32(s->pace.called, called);
}

#endif
