/* tracking.c: tracks moving targets. After the schedule the model stays at one radius, elastic about the schedule's
 * result. Each new target starts iterations, until the model rests or track_iterations are spent. The first forces
 * decide whether the target has jumped: goals are farther than the model can follow. Then, if configured, the coarser
 * radii are used again. When surfaces or landmarks change beside an old image, the occluded vertices' field carries its
 * findings along.
 * Bounds: SMR_RADII_MAX; two passes over the vertices when an image becomes outdated; with
 * track.ahead, one over vertices and triangles for new targets.
 * SPDX-License-Identifier: MIT */
#include "options/track/track.h"
#include "registration/schedule_radius.h"

#define SMR_TRACK_REACH 12.0f    /* cluster radius / mean distance of goals above which targets have jumped */
#define SMR_TRACK_SOUGHT 0.5f    /* mean distance of goals / image search distance above which targets jumped */
#define SMR_TRACK_FEWER 0.8f     /* share of vertices with goals / last share below which half the distance is a jump */
#define SMR_TRACK_LOST 0.9f      /* SMR_TRACK_FEWER with an image, where vertices may find wrong goals nearby */
#define SMR_TRACK_NARROWING 0.5f /* number of first iterations in which image searches narrow / track.iterations */
#define SMR_TRACK_NARROW 0.3f    /* progress of image searches at new targets: carried structures are not far off */
#define SMR_TRACK_COARSE 24u     /* number of iterations at all coarser radii together after a jump */
#define SMR_TRACK_STILL 0.2f     /* displacement / (stiffness * typical residual) below which the model rests */
#define SMR_TRACK_MOMENTUM 0.7f  /* largest momentum at radii after a jump: with more the model oscillates */
#define SMR_TRACK_STEADY 0.6f    /* largest momentum with clouds and an image: points attract faster than a surface */
#define SMR_TRACK_CALM 0.4f  /* largest momentum with clouds alone after the first iterations: noise causes swings */
#define SMR_TRACK_SET_OFF 2u /* number of first iterations for new targets that use the configured momentum */
#define SMR_TRACK_GAIN 3.0f  /* largest factor on forces at the coarser radii after a jump */

void smr_tracking_momentum(smr *s)
{
    float most = 1.0f;
    if (!s->schedule.tracking)
        return;
    if (s->schedule.recovering > 0u)
        most = SMR_TRACK_MOMENTUM;
    else if (s->forces.surface.n_clouds_at_begin > 0u && s->forces.image.has_image)
        most = SMR_TRACK_STEADY;
    else if (s->forces.surface.n_clouds_at_begin > 0u && s->schedule.radius_iteration >= SMR_TRACK_SET_OFF)
        most = SMR_TRACK_CALM;
    s->schedule.momentum = smr_min(s->shared.config.motion.momentum, most);
}

/* Starts iterations at the cluster radius with the index `radius`. */
static void go_to(smr *s, uint32_t radius)
{
    smr_radius_go(s, radius);
    s->schedule.repairing = 0;
    s->shape.rest_pose_due = 0;
}

void smr_tracking_keep(smr_arena *a, smr *s)
{
    smr_schedule *p = &s->schedule;
    if (s->shared.config.track.mode == SMR_TRACK_OFF)
        return;
    smr_keep_words(a, &p->tracking, 1, 1);
    smr_keep_words(a, &p->recovering, 1, 2);
    smr_keep_words(a, &p->changed, 1, smr_follows_images(&s->shared) ? SMR_CHANGED_IMAGE : SMR_CHANGED_SHOWN);
    smr_keep_words(a, &p->settled, 1, 1);
    smr_keep_words(a, &p->jumped, 1, 1);
    smr_keep_floats(a, &p->gain, 1, 1.0f, SMR_TRACK_GAIN);
    smr_keep_floats(a, &p->found, 1, 0.0f, 1.0f);
    smr_keep_floats(a, &p->noise_mm, 1, 0.0f, SMR_KEPT_MM);
    if (smr_follows_images(&s->shared))
        smr_keep_words(a, &p->image_age, 1, SMR_IMAGE_PAST);
    smr_keep_require(a, p->tracking || !(p->recovering || p->changed || p->settled || p->jumped || p->image_age));
}

int smr_tracking_legal(const smr *s)
{
    const smr_schedule *p = &s->schedule;
    const uint32_t at = smr_radius_after(s);
    return !p->done && (p->recovering == 1u ? p->radius < at : p->radius == at) &&
           p->radius_iteration <= s->shared.config.track.iterations + SMR_TRACK_COARSE;
}

/* Returns (vertices with a goal) / (vertices with a target) in the last complete forces, 0..1. */
static float share_found(const smr *s)
{
    const smr_force_totals *t = &s->forces.totals;
    return t->n_with_target > 0u ? (float)t->n_forces / (float)t->n_with_target : 0.0f;
}

int smr_tracking_ahead(const smr *s)
{
    return s->shared.config.track.mode != SMR_TRACK_OFF && smr_ending_of(s, s->schedule.radius_iteration + 1u).done;
}

void smr_tracking_start(smr *s)
{
    s->schedule.tracking = 1;
    s->schedule.settled = !s->volumes.pending;
    s->schedule.jumped = s->schedule.recovering = 0;
    s->schedule.changed = s->forces.unmeasured ? SMR_CHANGED : 0u; /* a target may be newer than the last forces */
    s->schedule.found = share_found(s);
    s->schedule.noise_mm = smr_residual_typical(&s->forces.surface);
    s->schedule.image_age = SMR_IMAGE_CURRENT;
    go_to(s, smr_radius_after(s));
}

void smr_tracking_end(smr *s)
{
    s->schedule.tracking = s->schedule.settled = s->schedule.jumped = s->schedule.recovering = s->schedule.changed = 0;
    s->schedule.image_age = SMR_IMAGE_NEW;
    if (s->shape.track_rest != NULL)
        s->shape.track_rest->due = 0;
    s->schedule.found = s->schedule.noise_mm = 0.0f;
}

/* Returns the factor on forces: above 1 at coarser radii, where vertices without a goal slow down large clusters. */
static float gain_of(const smr *s)
{
    const smr_force_totals *t = &s->forces.totals;
    if (s->schedule.recovering != 1u || t->n_forces == 0u)
        return 1.0f;
    return smr_min((float)t->n_with_target / (float)t->n_forces, SMR_TRACK_GAIN);
}

float smr_tracking_progress(const smr *s)
{
    const float narrowing = SMR_TRACK_NARROWING * (float)s->shared.config.track.iterations;
    const float share = smr_min((float)s->schedule.radius_iteration / smr_max(narrowing, 1.0f), 1.0f);
    return s->schedule.recovering == 1u ? 0.0f : 1.0f - (1.0f - SMR_TRACK_NARROW) * (1.0f - share);
}

/* Returns the share of vertices with a target that have a goal, but not from an image that completes a partial view. */
static float share_without_image(const smr *s)
{
    const smr_surface_goals *g = &s->forces.surface;
    uint32_t n_found = 0;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const int part = SMR_HAS_PARTIAL && smr_visibility_always_partial(g, smr_model_owner(s->shared.model, v));
        n_found += s->forces.found_last[v] == SMR_FOUND_GOAL && (!part || g->visibility[v] > 0u);
    }
    const uint32_t n_with_target = s->forces.totals.n_with_target;
    return n_with_target > 0u ? smr_min((float)n_found / (float)n_with_target, 1.0f) : 0.0f;
}

/* Updates schedule.image_age. A used image is outdated once a surface or landmarks change, until the next image. */
static void note_age(smr *s)
{
    const int others = s->forces.surface.n_goals > 0u || s->forces.landmarks.n > 0u;
    if (s->schedule.changed == SMR_CHANGED_IMAGE) {
        s->schedule.image_age = SMR_IMAGE_NEW;
    } else if (s->schedule.changed == SMR_CHANGED_SHOWN && s->forces.image.has_image && others &&
               s->schedule.image_age == SMR_IMAGE_CURRENT) {
        s->schedule.image_age = SMR_IMAGE_PAST;
        s->schedule.found = share_without_image(s);
        smr_track_rest_keep_image(&s->shape);
    }
}

/* Continues the search in the image with present goals: only inputs that move no goal have changed. */
static void resume_image_search(smr *s)
{
    const float narrow = SMR_TRACK_NARROWING * (float)s->shared.config.track.iterations;
    s->schedule.changed = s->schedule.settled = 0;
    if (s->schedule.recovering != 1u)
        s->schedule.radius_iteration = smr_min_u32(s->schedule.radius_iteration, (uint32_t)narrow);
}

void smr_tracking_begin(smr *s)
{
    if (!s->schedule.tracking)
        return;
    s->shape.track_rest->due = 1;
    s->reference.stale = 1;
    if (!s->schedule.changed)
        return;
    const int lost = s->schedule.jumped && s->forces.totals.n_forces == 0u;
    if (s->schedule.changed == SMR_CHANGED && s->forces.image.has_image && s->schedule.image_age == SMR_IMAGE_CURRENT &&
        !lost) {
        resume_image_search(s);
        return;
    }
    note_age(s);
    if (s->schedule.changed >= SMR_CHANGED_MOVED && s->shape.track_pose_last != NULL) {
        if (SMR_HAS_CONTACT && !s->shape.track_rest->predicted)
            smr_contact_reset(&s->forces.contact, 0, 1);
        smr_certainties_clear(&s->forces.surface); /* forgets certain closest triangles: the prediction moves x */
        smr_track_rest_predict(&s->shape, !s->schedule.jumped && !s->schedule.recovering);
    }
    s->schedule.gain = 1.0f;
    s->schedule.changed = s->schedule.settled = s->schedule.jumped = s->schedule.recovering = 0;
    if (s->schedule.radius != smr_radius_after(s))
        go_to(s, smr_radius_after(s));
    s->schedule.radius_iteration = 0;
}

/* Returns the mean distance of goals above which targets jumped, mm. Image goals lie within the search distance. */
static float reach_mm(const smr *s)
{
    const float configured = s->shared.config.track.jump_mm, reach = s->schedule.lists.radius / SMR_TRACK_REACH;
    if (configured > 0.0f)
        return configured;
    return s->forces.image.has_image ? smr_max(reach, SMR_TRACK_SOUGHT * s->schedule.profile_mm) : reach;
}

/* Sets schedule.jumped in the first iteration with new targets. If a partial view jumps, goals are fewer and nearer. */
void smr_tracking_find_jump(smr *s)
{
    /* a cloud's goals leave out large residuals, so that goal_mean alone is small after a jump */
    const float more = smr_residual_typical(&s->forces.surface) - s->schedule.noise_mm;
    const float mean = smr_max(s->forces.totals.goal_mean, more), reach = reach_mm(s);
    if (s->schedule.recovering || s->schedule.radius_iteration > 0u)
        return;
    const float enough = s->forces.image.has_image ? SMR_TRACK_LOST : SMR_TRACK_FEWER;
    const int fewer = share_found(s) < enough * s->schedule.found;
    s->schedule.jumped = s->forces.totals.n_forces == 0u || mean > (fewer ? 0.5f * reach : reach);
}

/* Goes to the first radius after a jump, and after enough iterations to the next radius, until tracking's radius. */
static void recover(smr *s)
{
    const uint32_t at = s->schedule.radius, to = smr_radius_after(s), first = s->shared.config.schedule.radius_first;
    if (!s->schedule.recovering) {
        s->schedule.recovering = 1;
        go_to(s, first);
    } else if (s->schedule.radius_iteration >= smr_max_u32(SMR_TRACK_COARSE / (to - first), 2u)) {
        s->schedule.recovering = at + 1u < to ? 1u : 2u;
        go_to(s, at + 1u);
    }
}

void smr_tracking_next(smr *s)
{
    if (s->schedule.image_age == SMR_IMAGE_NEW)
        s->schedule.image_age = SMR_IMAGE_CURRENT;
    const int coarser = smr_radius_after(s) > s->shared.config.schedule.radius_first &&
                        s->shared.config.track.mode == SMR_TRACK_RECOVER;
    const int found = s->schedule.jumped && s->forces.totals.n_forces > 0u;
    if (s->schedule.recovering == 1u || (s->schedule.recovering == 0u && coarser && found)) {
        recover(s);
        s->schedule.gain = gain_of(s);
        return;
    }
    s->schedule.gain = 1.0f;
    s->schedule.found = share_found(s);
    const float typical = smr_residual_typical(&s->forces.surface), stiffness = s->shared.config.forces.stiffness;
    const float noise_mm = s->shared.config.track.settle_um > 0.0f ? SMR_TRACK_STILL * stiffness * typical : 0.0f;
    const float rest_mm = smr_max(s->shared.config.track.settle_um * 1.0e-3f, noise_mm);
    s->schedule.noise_mm = typical;
    s->schedule.settled = (s->evolve.moved_mm < rest_mm && !s->volumes.pending) ||
                          s->schedule.radius_iteration >= s->shared.config.track.iterations;
}
