/* align_surfaces.c: the start pose from two surfaces, without landmarks, and a report on it.
 * Method: coarse searches at scale 1, at a smaller and a larger scale and, where the spreads differ, at their ratio,
 * which is right for whole surfaces; short refinements of the results and of the given pose, longer ones of the best.
 * The best pose is refined by all pairs when nearly all samples of both surfaces match, else without outliers. The
 * given pose is kept when it is about as good.
 * Bounds: 4 coarse searches, at most 48 refinements of SMR_ROUNDS_SHORT rounds, 4 of SMR_ROUNDS, 2 of
 * config.iterations; for the mirror image 1 search, 8 refinements of SMR_ROUNDS_SHORT rounds, 1 of SMR_ROUNDS.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "start/align/align.h"

#define SMR_ROUNDS_SHORT 6u        /* largest number of rounds of a short refinement */
#define SMR_ROUNDS 16u             /* largest number of rounds of a longer refinement */
#define SMR_FINALISTS 4u           /* largest number of poses that get a longer refinement */
#define SMR_OF_SCALE 8u            /* number of poses kept from a search at another scale or for the mirror image */
#define SMR_LARGER 1.136f          /* scale of a further search, as is its inverse: a part's spread gives no scale */
#define SMR_SAME_SIZE 0.03f        /* largest |ratio of the spreads - 1| without a search at this ratio */
#define SMR_ALIKE_COS 0.95f        /* smallest cosine of the rotation between two similar poses (18 degrees) */
#define SMR_ALIKE_SHIFT 0.1f       /* largest distance between two similar poses / spread of the target */
#define SMR_ALIKE_SCALE 1.04f      /* largest ratio of the scales of two similar poses */
#define SMR_CHEAPER 0.98f          /* a pose replaces a similar one if its cost / the similar one's cost is lower */
#define SMR_FAR_SHARE 0.75f        /* search range of closest points / larger spread of both surfaces */
#define SMR_EXPLAINED_SHARE 0.08f  /* distance beyond which samples do not match / smaller spread */
#define SMR_WHOLE 0.9f             /* share of matching samples above which, on both sides, surfaces are wholes */
#define SMR_WHOLE_WORSE 1.2f       /* largest cost after a refinement by all pairs / cost before, for wholes */
#define SMR_WHOLE_SLACK 0.02f      /* cost added to SMR_WHOLE_WORSE times the cost before */
#define SMR_GIVEN_WORSE 1.25f      /* largest rms distance / rms of the found pose with which the given pose is kept */
#define SMR_OTHER_COS 0.866f       /* cosine of the rotation (30 degrees) below which two poses clearly differ */
#define SMR_OTHER_SHIFT 0.15f      /* distance / target's spread above which two poses clearly differ */
#define SMR_ALIKE_COST 1.1f        /* largest cost / cost of the best pose with which a pose counts as equally good */
#define SMR_ALIKE_SLACK 0.01f      /* cost added to SMR_ALIKE_COST times the best pose's cost */
#define SMR_POSE_ROUNDING 1.0e-3f  /* largest |R^T R - I| in an entry of the given pose's rotation R */
#define SMR_POSE_SCALE_MAX 1000.0f /* largest scale of the given pose; the smallest is 1 / this */

/* Working state of smr_align(), in the caller's memory. */
typedef struct align_work {
    smr_aligner aligner;
    smr_coarse coarse;
    smr_pose_list found, shorter; /* lists of poses that a stage reads and writes */
    smr_pose_list best;           /* poses after the longer refinement, cheapest first */
    uint32_t few, some, all;      /* samples of each side in short, longer, last refinements */
} align_work;

/* Returns the distance of two poses, mm: of images of the model's centre, or of preimages of the target's, if less. */
static float shift_between(const smr_aligner *a, const smr_pose *p, const smr_pose *q)
{
    const smr_vec model = a->side[SMR_MODEL].centre, target = a->side[SMR_TARGET].centre;
    const smr_pose p_back = smr_pose_invert(p), q_back = smr_pose_invert(q);
    const float forth = smr_length(smr_sub(smr_pose_apply(p, model), smr_pose_apply(q, model)));
    const float back = smr_length(smr_sub(smr_pose_apply(&p_back, target), smr_pose_apply(&q_back, target)));
    return smr_min(forth, back * smr_pose_scale(p));
}

/* Returns 1 when the rotation between two poses has a lower cosine or their distance exceeds `shift` target spreads. */
static int pose_differs(const smr_aligner *a, const smr_pose *p, const smr_pose *q, float cosine, float shift)
{
    float trace = 0.0f;
    for (uint32_t i = 0; i < 9u; i++)
        trace += p->m[i / 3u][i % 3u] * q->m[i / 3u][i % 3u];
    trace /= smr_pose_scale(p) * smr_pose_scale(q); /* 1 + 2 cos(angle of the rotation between p and q) */
    return trace < 1.0f + 2.0f * cosine || shift_between(a, p, q) > shift * a->side[SMR_TARGET].spread;
}

/* Inserts a pose into a list, unless the list has a similar one. A similar pose that costs clearly more is replaced. */
static void insert_or_replace(const smr_aligner *a, const smr_pose *pose, float cost, smr_pose_list *into)
{
    for (uint32_t i = 0; i < into->n; i++) {
        const float ratio = smr_pose_scale(pose) / smr_pose_scale(&into->pose[i]);
        if (ratio > SMR_ALIKE_SCALE || ratio * SMR_ALIKE_SCALE < 1.0f ||
            pose_differs(a, pose, &into->pose[i], SMR_ALIKE_COS, SMR_ALIKE_SHIFT))
            continue;
        if (cost >= SMR_CHEAPER * into->cost[i])
            return;
        smr_list_remove(into, i);
        break;
    }
    smr_list_insert(into, pose, cost);
}

/* Adds refined copies of `from`'s poses to `into`, without failed ones, one of similar ones. how: SMR_REFINE_... */
static void refine_list(smr_aligner *a, const smr_pose_list *from, uint32_t samples, uint32_t rounds, uint32_t how,
                        smr_pose_list *into)
{
    for (uint32_t i = 0; i < from->n; i++) {
        smr_pose pose = from->pose[i];
        if (!smr_align_refine(a, samples, rounds, how, &pose))
            continue;
        smr_pairs_find(a, &pose, samples);
        insert_or_replace(a, &pose, smr_pairs_cost(a), into);
    }
}

/* Searches poses at this scale, refines the best with a free scale, and adds them to w->shorter. how: SMR_REFINE_... */
static void try_scale(align_work *w, float scale, uint32_t how)
{
    smr_list_start(&w->found, SMR_OF_SCALE);
    smr_align_search(&w->aligner, &w->coarse, scale, SMR_SHIFTS_LONG, 0, &w->found);
    refine_list(&w->aligner, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_SCALED | how, &w->shorter);
}

/* Fills w->best with poses whose scale is fitted, which distinguishes bones of two sizes. `given` is tried, too. */
static void find_poses(align_work *w, const smr_pose *given)
{
    smr_aligner *a = &w->aligner;
    const float ratio = a->side[SMR_TARGET].spread / smr_max(a->side[SMR_MODEL].spread, 1.0e-6f);
    smr_coarse_take(&w->coarse, a);
    smr_list_start(&w->found, SMR_LIST_MOST);
    smr_align_search(a, &w->coarse, 1.0f, SMR_SHIFTS, 0, &w->found);
    smr_list_insert(&w->found, given, 0.0f);
    smr_list_start(&w->shorter, SMR_FINALISTS);
    refine_list(a, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_TRIMMED, &w->shorter);
    try_scale(w, 1.0f / SMR_LARGER, SMR_REFINE_TRIMMED);
    try_scale(w, SMR_LARGER, SMR_REFINE_TRIMMED);
    if (!smr_within(ratio - 1.0f, SMR_SAME_SIZE) && ratio > 0.2f && ratio < 5.0f)
        try_scale(w, ratio, 0);
    smr_list_start(&w->best, SMR_FINALISTS);
    refine_list(a, &w->shorter, w->some, SMR_ROUNDS, SMR_REFINE_SCALED | SMR_REFINE_TRIMMED, &w->best);
}

/* Returns the best pose of the model's mirror image near this scale. w->coarse must be filled (find_poses). */
static smr_pose find_mirrored(align_work *w, float scale, int scaled)
{
    const uint32_t how = SMR_REFINE_TRIMMED | (scaled ? SMR_REFINE_SCALED : 0u);
    smr_list_start(&w->found, SMR_OF_SCALE);
    smr_align_search(&w->aligner, &w->coarse, scale, SMR_SHIFTS_LONG, 1, &w->found);
    smr_pose pose = w->found.pose[0];
    smr_list_start(&w->shorter, 1);
    refine_list(&w->aligner, &w->found, w->few, SMR_ROUNDS_SHORT, how, &w->shorter);
    if (w->shorter.n > 0u)
        pose = w->shorter.pose[0];
    (void)smr_align_refine(&w->aligner, w->some, SMR_ROUNDS, how, &pose);
    return pose;
}

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

/* Returns 1 when *p is a rotation with one scale for all axes and a translation, all within the limits. */
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

static void layout(smr_arena *arena, uint32_t n, align_work **work, smr_aligner *a)
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
    align_work *work;
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

/* Takes samples of both surfaces, and sets numbers of samples, search range and matching distance in *w. */
static void prepare(align_work *w, const smr_surface *model, const smr_surface *target, uint32_t samples)
{
    smr_aligner *a = &w->aligner;
    w->few = samples / 10u + 8u;
    w->some = samples / 3u + 8u;
    w->all = samples;
    smr_align_side_make(&a->side[SMR_MODEL], model, samples);
    smr_align_side_make(&a->side[SMR_TARGET], target, samples);
    const float far = SMR_FAR_SHARE * smr_max(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread) + 1.0e-6f;
    a->far2 = far * far;
    a->limit = SMR_EXPLAINED_SHARE * smr_aligner_spread(a);
}

/* Refines *pose. Returns 1 when both surfaces are wholes and all pairs count. Otherwise outliers are rejected, and
 * without a scale the refinement starts from the rigid pose that fits the scaled pose's pairs. */
static int refine_best(align_work *w, const smr_align_config *config, smr_pose *pose)
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
        *pose = best; /* the cost has grown: the refinement has matched unlike parts */
    }
    if (!scaled)
        (void)smr_align_refine(a, w->some, 1, SMR_REFINE_TRIMMED, pose);
    (void)smr_align_refine(a, w->all, config->iterations, scaled | SMR_REFINE_TRIMMED, pose);
    return 0;
}

/* Returns the root mean square distance of the nearest share[side], 0..1, of each side's samples under a pose, mm. */
static float rms_of(smr_aligner *a, const smr_pose *pose, uint32_t samples, const float share[SMR_SIDES])
{
    smr_pairs_find(a, pose, samples);
    return smr_pairs_rms(a, share);
}

/* Writes to *r the number of poses that match as well as the best, and the least rms of clearly different poses, mm. */
static void compare_others(align_work *w, const float share[SMR_SIDES], smr_align_report *r)
{
    const smr_pose_list *best = &w->best;
    r->n_alike = 1;
    for (uint32_t i = 1; i < best->n; i++) {
        if (!pose_differs(&w->aligner, &best->pose[i], &best->pose[0], SMR_OTHER_COS, SMR_OTHER_SHIFT))
            continue;
        const float rms = rms_of(&w->aligner, &best->pose[i], w->some, share);
        if (r->second_rms_mm == 0.0f || rms < r->second_rms_mm)
            r->second_rms_mm = rms;
        r->n_alike += best->cost[i] <= SMR_ALIKE_COST * best->cost[0] + SMR_ALIKE_SLACK;
    }
}

/* Fills the report on *pose. *pose becomes the given pose if that is about as good. both: 1: both are wholes. */
static void report_pose(align_work *w, int both, int scaled, const smr_pose *given, smr_pose *pose, smr_align_report *r)
{
    smr_aligner *a = &w->aligner;
    memset(r, 0, sizeof *r);
    smr_pairs_find(a, pose, w->all);
    const float limit = smr_pairs_limit(a);
    r->model_share = smr_pairs_share(a, SMR_MODEL, limit);
    r->target_share = smr_pairs_share(a, SMR_TARGET, limit);
    const float share[SMR_SIDES] = {both ? 1.0f : r->model_share, both ? 1.0f : r->target_share};
    r->rms_mm = smr_pairs_rms(a, share);
    const float rms_given = rms_of(a, given, w->all, share);
    if (rms_given <= SMR_GIVEN_WORSE * r->rms_mm) {
        r->given = 1;
        r->rms_mm = rms_given;
        *pose = *given;
    }
    r->scale = smr_pose_scale(pose);
    compare_others(w, share, r);
    const smr_pose mirrored = find_mirrored(w, r->scale, scaled);
    r->mirrored_rms_mm = rms_of(a, &mirrored, w->some, share);
    r->model_inside_out = a->side[SMR_MODEL].outward < 0.0f;
    r->target_inside_out = a->side[SMR_TARGET].outward < 0.0f;
}

smr_status smr_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config, void *memory,
                     size_t bytes, smr_pose *pose, smr_align_report *report)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_arena arena;
    align_work *work;
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
    SMR_TRY(smr_arena_start(&arena, memory, bytes));
    memset(&parts, 0, sizeof parts);
    layout(&arena, config->samples, &work, &parts);
    if (arena.used > bytes)
        return SMR_E_ARENA;
    work->aligner = parts;
    prepare(work, model, target, config->samples);
    smr_pose given = as_given, found;
    smr_pose_through(&given, smr_v(0, 0, 0), smr_sub(smr_pose_apply(&as_given, model->origin), target->origin));
    find_poses(work, &given); /* `given`, `found` and w->best are relative to surface origins */
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
