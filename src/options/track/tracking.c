/* tracking.c: follows targets that move. When the coarse-to-fine schedule is done the model stays at one radius,
 * elastic about the schedule's result (deformed/held_shape.c). Each target that is set calls for iterations until the
 * model rests, or track_iterations are spent; then there is nothing to do. The first forces tell whether a target has
 * jumped: its goals are farther than the model can follow. Where that is asked for the coarser radii are gone through
 * again. Where surfaces or landmarks are followed beside an image and go on without a new one, it is of the past: it
 * would hold back what it shows. What was found in it goes along with the others (forces/unseen_field.c).
 * Bounds: SMR_RADII_MAX; where tracking starts, two passes over the vertices; two where an image is left behind; with
 * track_ahead, one over vertices and triangles for new targets.
 * SPDX-License-Identifier: MIT */
#include "options/track/track.h"
#include "registration/convergence.h"
#include "registration/radius.h"

#define SMR_TRACK_REACH 12.0f    /* 1 / share of the radius that goals may be off in the mean */
#define SMR_TRACK_SOUGHT 0.5f    /* share of the search distance in an image that goals may be off in the mean */
#define SMR_TRACK_FEWER 0.8f     /* of the share of vertices with goals before: there are fewer */
#define SMR_TRACK_LOST 0.9f      /* the same in an image, where what is out of reach has no goal or a wrong, near one */
#define SMR_TRACK_NARROWING 0.5f /* of a target's iterations: so long search distances in an image fall */
#define SMR_TRACK_COARSE 24u     /* iterations at coarser radii, together, when a target has jumped */

#define SMR_TRACK_MOMENTUM 0.7f /* at most, when a target has jumped: more swings, for what is left falls fast there */
#define SMR_TRACK_STEADY 0.6f   /* at most for clouds beside an image: points draw faster than a surface does */
#define SMR_TRACK_GAIN 3.0f     /* factor on forces at coarser radii, at most */

/* With what the iteration that begins looks at. */
void smr_tracking_momentum(smr *s)
{
    const float asked = s->shared.config.motion.momentum;
    if (!s->pace.tracking)
        return;
    const int steady = s->forces.image.has_image && s->forces.surface.n_clouds_begun > 0u;
    const float most = s->pace.recovering > 0u ? SMR_TRACK_MOMENTUM : steady ? SMR_TRACK_STEADY : asked;
    s->pace.momentum = smr_min(asked, most);
}

static void go_to(smr *s, uint32_t radius)
{
    smr_radius_go(s, radius);
    s->pace.repairing = 0;
    s->shape.rest_pose_due = 0;
}

void smr_tracking_keep(smr_arena *a, smr *s)
{
    smr_pace *p = &s->pace;
    if (s->shared.config.track.mode == SMR_TRACK_OFF)
        return;
    smr_keep_words(a, &p->tracking, 1, 1);
    smr_keep_words(a, &p->recovering, 1, 2);
    smr_keep_words(a, &p->called, 1, smr_follows_images(&s->shared) ? SMR_CALLED_IMAGE : SMR_CALLED_SHOWN);
    smr_keep_words(a, &p->settled, 1, 1);
    smr_keep_words(a, &p->jumped, 1, 1);
    smr_keep_floats(a, &p->gain, 1, 1.0f, SMR_TRACK_GAIN);
    smr_keep_floats(a, &p->found, 1, 0.0f, 1.0f);
    if (smr_follows_images(&s->shared))
        smr_keep_words(a, &p->image_age, 1, SMR_IMAGE_PAST);
    smr_keep_require(a, p->tracking || !(p->recovering || p->called || p->settled || p->jumped || p->image_age));
}

int smr_tracking_legal(const smr *s)
{
    const smr_pace *p = &s->pace;
    const uint32_t at = smr_radius_after(s);
    return !p->done && (p->recovering == 1u ? p->radius < at : p->radius == at) &&
           p->radius_iteration <= s->shared.config.track.iterations + SMR_TRACK_COARSE;
}

/* Share of the vertices with a target that have a goal on it. */
static float share_found(const smr *s)
{
    const smr_force_totals *t = &s->forces.totals;
    return t->n_drawn > 0u ? (float)t->n_forces / (float)t->n_drawn : 0.0f;
}

void smr_tracking_start(smr *s)
{
    s->pace.tracking = s->pace.settled = 1;
    s->pace.jumped = s->pace.recovering = 0;
    s->pace.called = s->forces.unmeasured ? SMR_CALLED : 0u; /* set after the schedule's last forces */
    s->pace.found = share_found(s);
    s->pace.image_age = SMR_IMAGE_SEEN;
    smr_plastic_positions(&s->shape);
    smr_held_start(&s->shape);
    go_to(s, smr_radius_after(s));
}

void smr_tracking_end(smr *s)
{
    s->pace.tracking = s->pace.settled = s->pace.jumped = s->pace.recovering = s->pace.called = 0;
    s->pace.image_age = SMR_IMAGE_NEW;
    if (s->shape.held != NULL)
        s->shape.held->due = 0;
    s->pace.found = 0.0f;
}

/* Vertices that see nothing ask for no way of their own, and hold large clusters back. */
static float gain_of(const smr *s)
{
    const smr_force_totals *t = &s->forces.totals;
    if (s->pace.recovering != 1u || t->n_forces == 0u)
        return 1.0f;
    return smr_min((float)t->n_drawn / (float)t->n_forces, SMR_TRACK_GAIN);
}

/* A structure that moves in an image is sought as far as at the schedule's start, as far as the radius allows, and less
 * and less over the first half of the iterations. At coarser radii it is not known yet. */
float smr_tracking_progress(const smr *s)
{
    const float narrowing = SMR_TRACK_NARROWING * (float)s->shared.config.track.iterations;
    if (s->pace.recovering == 1u)
        return 0.0f;
    return smr_min((float)s->pace.radius_iteration / smr_max(narrowing, 1.0f), 1.0f);
}

/* Distances to what is touched are not known where structures have gone to. */
static void go_ahead(smr *s)
{
    if (s->shape.held_last != NULL && !s->shape.held->ahead)
        smr_contact_reset(&s->forces.contact);
    smr_held_ahead(&s->shape, !s->pace.jumped && !s->pace.recovering);
}

/* Share of the vertices with a target that have a goal without the image, too. What it showed goes along, but for the
 * rest of a view of a part. */
static float share_without_image(const smr *s)
{
    const smr_surface_goals *g = &s->forces.surface;
    uint32_t n_found = 0;
    for (uint32_t v = 0; v < s->pace.n_active; v++) {
        const int part = smr_overlap_lasting(g, smr_model_owner(s->shared.model, v));
        n_found += s->forces.found_last[v] == SMR_FOUND_GOAL && (!part || g->seen[v] > 0u);
    }
    const uint32_t n_drawn = s->forces.totals.n_drawn;
    return n_drawn > 0u ? smr_min((float)n_found / (float)n_drawn, 1.0f) : 0.0f;
}

/* The image was looked at, and what else is followed goes on: now the image is of the past. It stays so when the others
 * are taken away, until the next one comes. */
static void note_age(smr *s)
{
    const int others = s->forces.surface.n_goals > 0u || s->forces.landmarks.n > 0u;
    if (s->pace.called == SMR_CALLED_IMAGE) {
        s->pace.image_age = SMR_IMAGE_NEW;
    } else if (s->pace.called == SMR_CALLED_SHOWN && s->forces.image.has_image && others &&
               s->pace.image_age == SMR_IMAGE_SEEN) {
        s->pace.image_age = SMR_IMAGE_PAST;
        s->pace.found = share_without_image(s);
        smr_held_leave(&s->shape);
    }
}

/* Nothing is newer than the image that is followed, but something acts, or a cloud has grown: the search in the image
 * goes on where it is, and so does a way through coarser radii. */
static void go_on_looking(smr *s)
{
    const float narrow = SMR_TRACK_NARROWING * (float)s->shared.config.track.iterations;
    s->pace.called = s->pace.settled = 0;
    if (s->pace.recovering == 1u)
        return;
    s->pace.radius_iteration = smr_min_u32(s->pace.radius_iteration, (uint32_t)narrow);
}

void smr_tracking_begin(smr *s)
{
    if (!s->pace.tracking)
        return;
    s->shape.held->due = 1;
    s->reference.stale = 1;
    if (!s->pace.called)
        return;
    const int lost = s->pace.jumped && s->forces.totals.n_forces == 0u;
    if (s->pace.called == SMR_CALLED && s->forces.image.has_image && s->pace.image_age == SMR_IMAGE_SEEN && !lost) {
        go_on_looking(s);
        return;
    }
    note_age(s);
    if (s->pace.called >= SMR_CALLED_MOVED)
        go_ahead(s);
    s->pace.gain = 1.0f;
    s->pace.called = s->pace.settled = s->pace.jumped = s->pace.recovering = 0;
    if (s->pace.radius != smr_radius_after(s))
        go_to(s, smr_radius_after(s));
    s->pace.radius_iteration = 0;
}

/* Mean distance of goals that the model can follow, mm. In an image no goal is farther than the search goes. */
static float reach_mm(const smr *s)
{
    const float asked = s->shared.config.track.jump_mm, reach = s->pace.lists.radius / SMR_TRACK_REACH;
    if (asked > 0.0f)
        return asked;
    return s->forces.image.has_image ? smr_max(reach, SMR_TRACK_SOUGHT * s->pace.profile_mm) : reach;
}

/* In the first iteration on new targets. Of a partial view that jumps what is left of goals is nearer: then it counts,
 * too, that there are fewer. */
void smr_tracking_look(smr *s)
{
    const float mean = s->forces.totals.mean, reach = reach_mm(s);
    if (!s->pace.tracking || s->pace.recovering || s->pace.radius_iteration > 0u)
        return;
    const float enough = s->forces.image.has_image ? SMR_TRACK_LOST : SMR_TRACK_FEWER;
    const int fewer = share_found(s) < enough * s->pace.found;
    s->pace.jumped = s->forces.totals.n_forces == 0u || mean > (fewer ? 0.5f * reach : reach);
}

/* Coarse to fine, once more, as long as targets have goals. */
static void recover(smr *s)
{
    const uint32_t at = s->pace.radius, to = smr_radius_after(s), first = s->shared.config.schedule.radius_first;
    if (!s->pace.recovering) {
        s->pace.recovering = 1;
        go_to(s, first);
    } else if (s->pace.radius_iteration >= smr_max_u32(SMR_TRACK_COARSE / (to - first), 2u)) {
        s->pace.recovering = at + 1u < to ? 1u : 2u;
        go_to(s, at + 1u);
    }
}

void smr_tracking_next(smr *s)
{
    if (s->pace.image_age == SMR_IMAGE_NEW)
        s->pace.image_age = SMR_IMAGE_SEEN;
    const int coarser = smr_radius_after(s) > s->shared.config.schedule.radius_first &&
                        s->shared.config.track.mode == SMR_TRACK_RECOVER;
    const int found = s->pace.jumped && s->forces.totals.n_forces > 0u;
    if (s->pace.recovering == 1u || (s->pace.recovering == 0u && coarser && found)) {
        recover(s);
        s->pace.gain = gain_of(s);
        return;
    }
    s->pace.gain = 1.0f;
    s->pace.found = share_found(s);
    s->pace.settled = s->evolve.moved_mm * 1000.0f < s->shared.config.track.settle_um ||
                      s->pace.radius_iteration >= s->shared.config.track.iterations;
}
