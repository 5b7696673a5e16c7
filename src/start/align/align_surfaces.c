/* align_surfaces.c: the start pose from two surfaces, without landmarks, and what is to be said about it.
 * Method: align_find.c finds good poses; the best one is refined over all pairs when both surfaces are explained as
 * wholes, else over the pairs that belong together. The pose as given is kept when it is about as good.
 * Bounds: those of align_find.c, and two refinements of config.basic.iterations rounds.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "start/align/align.h"

#define SMR_FAR_SHARE 0.75f       /* search limit over the larger spread */
#define SMR_EXPLAINED_SHARE 0.08f /* matching limit, when poses are compared, over the smaller spread */
#define SMR_WHOLE 0.9f            /* smallest matched share of each side in a pair of wholes */
#define SMR_WHOLE_WORSE 1.2f      /* largest ratio of costs: a refinement over all pairs to the one without outliers */
#define SMR_WHOLE_SLACK 0.02f     /* cost that is added to that limit */
#define SMR_GIVEN_WORSE 1.25f     /* the given pose is kept when its distance is larger by at most this factor */
#define SMR_OTHER_COS 0.866f  /* cosine of the rotation (30 degrees) from which on two poses are clearly different */
#define SMR_OTHER_SHIFT 0.15f /* the same for the distance, over the target's spread */
#define SMR_ALIKE_COST 1.1f   /* another pose matches as well up to this factor of the best pose's cost */
#define SMR_ALIKE_SLACK 0.01f /* cost that is added to that limit */
#define SMR_POSE_ROUNDING 1.0e-3f  /* tolerance of a given rotation's entries */
#define SMR_POSE_SCALE_MAX 1000.0f /* largest scale of a given pose; its inverse is the smallest */

smr_align_config smr_align_config_default(void)
{
    return (smr_align_config){
        .cookie = SMR_COOKIE('A', smr_align_config), .scaled = 1, .iterations = 60, .samples = 600};
}

static int is_legal(const smr_align_config *c)
{
    return c->cookie == SMR_COOKIE('A', smr_align_config) && c->scaled <= 1u && c->iterations >= 1u &&
           c->iterations <= 1000u && c->samples >= 16u && c->samples <= 100000u;
}

/* Returns 1 for a rotation with one scale and a translation within the limits. */
static int is_pose(const smr_pose *p)
{
    const float scale = smr_pose_scale(p);
    if (!(scale * SMR_POSE_SCALE_MAX >= 1.0f && scale <= SMR_POSE_SCALE_MAX) || smr_pose_mirrors(p))
        return 0;
    for (uint32_t i = 0; i < 3u; i++) {
        if (!smr_within(p->m[i][3], SMR_POSE_SCALE_MAX * SMR_COORD_MAX))
            return 0;
        for (uint32_t k = 0; k <= i; k++)
            if (!smr_within(smr_dot(smr_column(p, i), smr_column(p, k)) / (scale * scale) - (i == k ? 1.0f : 0.0f),
                            SMR_POSE_ROUNDING))
                return 0;
    }
    return 1;
}

static void layout(smr_arena *arena, uint32_t n, smr_align_work **work, smr_aligner *a)
{
    *work = smr_arena_take(arena, 1, sizeof **work);
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        a->side[side].point = smr_arena_take(arena, n, sizeof(smr_vec));
        a->side[side].normal = smr_arena_take(arena, n, sizeof(smr_vec));
        a->side[side].weight = smr_arena_take(arena, n, sizeof(float));
        a->side[side].pair = smr_arena_take(arena, n, sizeof(smr_pair));
    }
    a->order = smr_arena_take(arena, n, sizeof(uint32_t));
}

smr_status smr_align_bytes(const smr_align_config *config, size_t *bytes)
{
    smr_align_work *work;
    smr_aligner a;
    if (config == NULL || bytes == NULL)
        return SMR_E_NULL;
    if (!is_legal(config))
        return SMR_E_CONFIG;
    smr_arena arena = smr_arena_measure();
    layout(&arena, config->samples, &work, &a);
    *bytes = arena.used;
    return SMR_OK;
}

/* Describes both surfaces and sets the limits that follow from their sizes. */
static void prepare(smr_align_work *w, const smr_surface *model, const smr_surface *target, uint32_t samples)
{
    smr_aligner *a = &w->aligner;
    w->few = samples / 10u + 8u;
    w->some = samples / 3u + 8u;
    w->all = samples;
    smr_align_side_make(&a->side[SMR_MODEL], model, samples);
    smr_align_side_make(&a->side[SMR_TARGET], target, samples);
    const float spread = smr_max(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread);
    const float far = SMR_FAR_SHARE * spread + 1.0e-6f;
    a->far2 = far * far;
    a->limit = SMR_EXPLAINED_SHARE * smr_aligner_spread(a);
}

/* Refines the best pose. Returns 1 for a pair of wholes, for which all pairs count. Otherwise outliers are rejected;
 * without a scale the start is the rigid pose that fits the pairs of the scaled one. */
static int refine_best(smr_align_work *w, const smr_align_config *config, smr_pose *pose)
{
    smr_aligner *a = &w->aligner;
    const uint32_t scaled = config->scaled ? SMR_REFINE_SCALED : 0u;
    const smr_pose best = *pose;
    smr_pairs_find(a, pose, w->some);
    const float limit = smr_min(smr_pairs_limit(a), a->limit), cost = smr_pairs_cost(a);
    if (smr_pairs_share(a, SMR_MODEL, limit) > SMR_WHOLE && smr_pairs_share(a, SMR_TARGET, limit) > SMR_WHOLE) {
        (void)smr_align_refine(a, w->all, config->iterations, scaled, pose);
        smr_pairs_find(a, pose, w->some);
        if (!scaled || smr_pairs_cost(a) <= SMR_WHOLE_WORSE * cost + SMR_WHOLE_SLACK)
            return 1;
        *pose = best; /* the pose has spread unlike parts over each other */
    }
    if (!scaled)
        (void)smr_align_refine(a, w->some, 1, SMR_REFINE_TRIMMED, pose);
    (void)smr_align_refine(a, w->all, config->iterations, scaled | SMR_REFINE_TRIMMED, pose);
    return 0;
}

/* The rms distance of a pose over those shares of both surfaces, mm. */
static float rms_of(smr_aligner *a, const smr_pose *pose, uint32_t samples, const float share[SMR_SIDES])
{
    smr_pairs_find(a, pose, samples);
    return smr_pairs_rms(a, share);
}

static void compare_others(smr_align_work *w, const float share[SMR_SIDES], smr_align_report *r)
{
    const smr_pose_list *best = &w->best;
    r->n_alike = 1;
    for (uint32_t i = 1; i < best->n; i++) {
        if (!smr_pose_differs(&w->aligner, &best->pose[i], &best->pose[0], SMR_OTHER_COS, SMR_OTHER_SHIFT))
            continue;
        const float rms = rms_of(&w->aligner, &best->pose[i], w->some, share);
        if (r->second_rms_mm == 0.0f || rms < r->second_rms_mm)
            r->second_rms_mm = rms;
        r->n_alike += best->cost[i] <= SMR_ALIKE_COST * best->cost[0] + SMR_ALIKE_SLACK;
    }
}

/* Fills the report about *pose; *pose becomes the given pose when that is kept. */
static void report_pose(smr_align_work *w, int whole, int scaled, const smr_pose *given, smr_pose *pose,
                        smr_align_report *r)
{
    smr_aligner *a = &w->aligner;
    float share[SMR_SIDES] = {1.0f, 1.0f};
    memset(r, 0, sizeof *r);
    smr_pairs_find(a, pose, w->all);
    const float limit = smr_pairs_limit(a);
    r->model_share = smr_pairs_share(a, SMR_MODEL, limit);
    r->target_share = smr_pairs_share(a, SMR_TARGET, limit);
    if (!whole) {
        share[SMR_MODEL] = r->model_share;
        share[SMR_TARGET] = r->target_share;
    }
    r->rms_mm = smr_pairs_rms(a, share);
    const float rms_given = rms_of(a, given, w->all, share);
    if (rms_given <= SMR_GIVEN_WORSE * r->rms_mm) {
        r->given = 1;
        r->rms_mm = rms_given;
        *pose = *given;
    }
    r->scale = smr_pose_scale(pose);
    compare_others(w, share, r);
    const smr_pose mirrored = smr_align_find_mirrored(w, r->scale, scaled);
    r->mirrored_rms_mm = rms_of(a, &mirrored, w->some, share);
    r->model_inside_out = a->side[SMR_MODEL].outward < 0.0f;
    r->target_inside_out = a->side[SMR_TARGET].outward < 0.0f;
}

smr_status smr_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config, void *memory,
                     size_t bytes, smr_pose *pose, smr_align_report *report)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_arena arena;
    smr_align_work *work;
    smr_aligner parts;
    smr_align_report said;
    if (model == NULL || target == NULL || config == NULL || pose == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(model) || !smr_surface_valid(target))
        return SMR_E_STATE;
    if (!is_legal(config))
        return SMR_E_CONFIG;
    const smr_pose as_given = config->given == NULL ? identity : *config->given;
    if (!is_pose(&as_given))
        return SMR_E_INPUT;
    const smr_status status = smr_arena_start(&arena, memory, bytes);
    if (status != SMR_OK)
        return status;
    memset(&parts, 0, sizeof parts);
    layout(&arena, config->samples, &work, &parts);
    if (arena.used > bytes)
        return SMR_E_ARENA;
    work->aligner = parts;
    prepare(work, model, target, config->samples);
    smr_pose given = as_given, found;
    smr_pose_through(&given, smr_v(0, 0, 0), smr_sub(smr_pose_apply(&as_given, model->origin), target->origin));
    smr_align_find(work, &given); /* from here on in coordinates relative to the surfaces' origins */
    if (work->best.n == 0u)
        return SMR_E_INPUT;
    found = work->best.pose[0];
    const int whole = refine_best(work, config, &found);
    report_pose(work, whole, config->scaled != 0u, &given, &found, &said);
    smr_pose_through(&found, model->origin, smr_add(target->origin, smr_column(&found, 3)));
    *pose = said.given ? as_given : found;
    if (report != NULL)
        *report = said;
    return SMR_OK;
}
