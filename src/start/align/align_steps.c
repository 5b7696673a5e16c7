/* align_steps.c: the start pose from two surfaces, without landmarks, and a report on it.
 * Method: coarse searches at scale 1, at a smaller and a larger scale and, where the spreads differ, at their ratio,
 * which is right for whole surfaces; refinements of the results and of the given pose, longer ones of the best. Short
 * ones pair samples with discs, longer ones first with discs, then with closest points. The best pose is refined by
 * all pairs when nearly all samples of both surfaces match, or when neither matches alone and all then come near, at
 * about the same cost; else without outliers. The given pose is kept when it is about as good.
 * Bounds: 4 coarse searches, at most 49 refinements of SMR_ROUNDS_FIRST rounds, 40 of SMR_ROUNDS_SHORT, 4 of
 * SMR_ROUNDS, 2 of config.iterations; for the mirror image 1 search, 8 of SMR_ROUNDS_SHORT, 1 of SMR_ROUNDS.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"

#define SMR_ROUNDS_FIRST 4u       /* number of rounds of the first refinement, after which the best poses go on */
#define SMR_NEARER 16u            /* largest number of poses that go on */
#define SMR_ROUNDS_SHORT 6u       /* largest number of rounds of a short refinement */
#define SMR_ROUNDS 16u            /* largest number of rounds of a longer refinement */
#define SMR_ROUNDS_DISCS 4u       /* number of first rounds of a longer refinement that pair with discs */
#define SMR_ROUNDS_WHOLE 6u       /* the same of a refinement of wholes by all pairs */
#define SMR_RANGE 1.5f            /* search range / limit of outliers of the round before */
#define SMR_RANGE_COST 1.01f      /* search range of costs / distance beyond which a sample does not match */
#define SMR_FINALISTS 4u          /* largest number of poses that get a longer refinement */
#define SMR_OF_SCALE 8u           /* number of poses kept from a search at another scale or for the mirror image */
#define SMR_LARGER 1.136f         /* scale of a further search, as is its inverse: a part's spread gives no scale */
#define SMR_SAME_SIZE 0.03f       /* largest |ratio of the spreads - 1| without a search at this ratio */
#define SMR_ALIKE_COS 0.95f       /* smallest cosine of the rotation between two similar poses (18 degrees) */
#define SMR_ALIKE_SHIFT 0.1f      /* largest distance between two similar poses / spread of the target */
#define SMR_ALIKE_SCALE 1.04f     /* largest ratio of the scales of two similar poses */
#define SMR_CHEAPER 0.98f         /* a pose replaces a similar one if its cost / the similar one's cost is lower */
#define SMR_FAR_SHARE 0.75f       /* search range of closest points / larger spread of both surfaces */
#define SMR_EXPLAINED_SHARE 0.08f /* distance beyond which samples do not match / smaller spread */
#define SMR_WHOLE 0.9f            /* share of matching samples above which, on both sides, surfaces are wholes */
#define SMR_WHOLE_TRIED 0.6f      /* share above which they may be wholes that are strongly deformed */
#define SMR_WHOLE_MET 0.96f       /* share above which they are, within the limit after a refinement by all pairs */
#define SMR_WHOLE_REACH 2.5f      /* largest such limit / distance beyond which samples do not match */
#define SMR_WHOLE_WORSE 1.2f      /* largest cost after a refinement by all pairs / cost before, for wholes */
#define SMR_WHOLE_SLACK 0.02f     /* cost added to SMR_WHOLE_WORSE times the cost before */
#define SMR_GIVEN_WORSE 1.25f     /* largest rms distance / rms of the found pose with which the given pose is kept */
#define SMR_OTHER_COS 0.866f      /* cosine of the rotation (30 degrees) below which two poses clearly differ */
#define SMR_OTHER_SHIFT 0.15f     /* distance / target's spread above which two poses clearly differ */
#define SMR_ALIKE_COST 1.1f       /* largest cost / cost of the best pose with which a pose counts as equally good */
#define SMR_MIRROR_STEPS 3u       /* number of steps for the mirror image, which parts with a neighbour skip */
#define SMR_ALIKE_SLACK 0.01f     /* cost added to SMR_ALIKE_COST times the best pose's cost */

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

void smr_align_insert(const smr_aligner *a, const smr_pose *pose, float cost, smr_pose_list *into)
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

/* ---- requests of the steps ---- */

float smr_align_range2(const smr_align_work *w, const smr_refined *r)
{
    const float cost = SMR_RANGE_COST * w->aligner.limit, limit = SMR_RANGE * r->limit;
    if (w->last)
        return w->into != NULL ? cost * cost : FLT_MAX;
    return r->round > 0u && (w->how & SMR_REFINE_TRIMMED) ? limit * limit : FLT_MAX;
}

static void start_search(smr_align_work *w, float scale, uint32_t n_shifts, int mirrored, uint32_t most)
{
    w->search = (smr_coarse_search){.scale = scale, .n_shifts = n_shifts, .mirrored = mirrored};
    w->n_tried = SMR_CUBE * SMR_TURNS * n_shifts;
    smr_list_start(&w->found, most);
}

static void refine(smr_align_work *w, const smr_pose_list *from, uint32_t samples, uint32_t rounds, uint32_t how,
                   smr_pose_list *into)
{
    w->disc_rounds = 0;
    w->from = from;
    w->into = into;
    w->aligner.used = samples;
    w->rounds = rounds;
    w->how = how;
    w->first = 0;
}

/* Sets the number of first rounds that pair with discs. Clouds, whose points stand for no area, have none, and few
 * samples make none that are fine enough. */
static void use_discs(smr_align_work *w, uint32_t rounds)
{
    const smr_align_side *side = w->aligner.side;
    const int cloud = smr_is_cloud(side[SMR_MODEL].surface) || smr_is_cloud(side[SMR_TARGET].surface);
    w->disc_rounds = cloud || w->all < SMR_DISCS ? 0u : rounds;
}

/* Starts the refinement of one pose, or with rounds 0 the search of its pairs. */
static void refine_one(smr_align_work *w, const smr_pose *pose, uint32_t samples, uint32_t rounds, uint32_t how)
{
    smr_list_start(&w->one, 1);
    smr_list_insert(&w->one, pose, 0.0f);
    refine(w, &w->one, samples, rounds, how, NULL);
}

/* Requests the pairs of one pose and their measures. */
static void find_pairs(smr_align_work *w, const smr_pose *pose, uint32_t samples, uint32_t of)
{
    refine_one(w, pose, samples, 0, 0);
    w->of = of;
}

static const smr_measure *measured(const smr_align_work *w) { return &w->group[0].measure; }
static int has_neighbour(const smr_align_work *w) { return w->jointed != NULL && w->jointed->neighbour != NULL; }

/* Starts the search of rotations about the joint of a part. */
static void start_turns(smr_align_work *w)
{
    start_search(w, smr_pose_scale(&w->given), 1, 0, SMR_LIST_MOST);
    w->search.jointed = 1;
    w->search.given = w->given;
    w->search.joint = w->jointed->at;
    w->n_tried = SMR_JOINT_STEPS * SMR_JOINT_STEPS * SMR_JOINT_STEPS;
}

/* ---- the steps of the call; each returns 1 when it requests work, whose result the next step
 * takes, and -1 when no pose was found ---- */

/* Sets numbers of samples, search range and matching distance, and searches at the model's size. */
static int find_poses(smr_align_work *w)
{
    smr_aligner *a = &w->aligner;
    const float far = SMR_FAR_SHARE * smr_max(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread) + 1.0e-6f;
    if (a->side[SMR_TARGET].kept == 0u)
        return -1;
    a->far2 = far * far;
    a->limit = SMR_EXPLAINED_SHARE * smr_aligner_spread(a);
    smr_coarse_take(&w->coarse, a);
    smr_coarse_sort(&w->coarse);
    if (a->side[SMR_TARGET].mask != NULL)
        start_turns(w);
    else
        start_search(w, 1.0f, SMR_SHIFTS, 0, SMR_LIST_MOST);
    smr_list_insert(&w->found, &w->given, 0.0f);
    smr_list_start(&w->nearer, SMR_NEARER);
    refine(w, &w->found, w->few, SMR_ROUNDS_FIRST, SMR_REFINE_TRIMMED, &w->nearer);
    use_discs(w, SMR_NONE);
    return 1;
}

static int refine_nearer(smr_align_work *w)
{
    smr_list_start(&w->shorter, SMR_FINALISTS);
    refine(w, &w->nearer, w->few, SMR_ROUNDS_SHORT - SMR_ROUNDS_FIRST, SMR_REFINE_TRIMMED, &w->shorter);
    use_discs(w, SMR_NONE);
    return 1;
}

/* Searches poses at another scale, which is then free: that distinguishes bones of two sizes. */
static int try_scale(smr_align_work *w, float scale, uint32_t how)
{
    if (w->aligner.side[SMR_TARGET].mask != NULL)
        return 0;
    start_search(w, scale, SMR_SHIFTS_LONG, 0, SMR_OF_SCALE);
    refine(w, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_SCALED | how, &w->shorter);
    use_discs(w, SMR_NONE);
    return 1;
}

static int try_smaller(smr_align_work *w) { return try_scale(w, 1.0f / SMR_LARGER, SMR_REFINE_TRIMMED); }
static int try_larger(smr_align_work *w) { return try_scale(w, SMR_LARGER, SMR_REFINE_TRIMMED); }

static int try_ratio(smr_align_work *w)
{
    const smr_align_side *side = w->aligner.side;
    const float ratio = side[SMR_TARGET].spread / smr_max(side[SMR_MODEL].spread, 1.0e-6f);
    const int differs = !smr_within(ratio - 1.0f, SMR_SAME_SIZE) && ratio > 0.2f && ratio < 5.0f;
    return differs ? try_scale(w, ratio, 0) : 0;
}

static int refine_finalists(smr_align_work *w)
{
    smr_list_start(&w->best, SMR_FINALISTS);
    refine(w, &w->shorter, w->some, SMR_ROUNDS, SMR_REFINE_SCALED | SMR_REFINE_TRIMMED, &w->best);
    use_discs(w, SMR_ROUNDS_DISCS);
    return 1;
}

/* Of poses that match a part alike, puts the one first that keeps the joint with the neighbour best. */
static void prefer_joint(smr_pose_list *best, const smr_pose *given, smr_vec joint)
{
    const float most = SMR_ALIKE_COST * best->cost[0] + SMR_ALIKE_SLACK;
    const smr_vec at = smr_pose_apply(given, joint);
    uint32_t first = 0;
    for (uint32_t i = 1; i < best->n; i++)
        if (best->cost[i] <= most && smr_length(smr_sub(smr_pose_apply(&best->pose[i], joint), at)) <
                                         smr_length(smr_sub(smr_pose_apply(&best->pose[first], joint), at)))
            first = i;
    const smr_pose chosen = best->pose[first];
    best->pose[first] = best->pose[0];
    best->pose[0] = chosen;
}

static int measure_best(smr_align_work *w)
{
    if (w->best.n == 0u)
        return -1;
    if (has_neighbour(w))
        prefer_joint(&w->best, &w->given, w->jointed->at);
    find_pairs(w, &w->best.pose[0], w->some, SMR_MEASURE_RANKS | SMR_MEASURE_SUMS | SMR_MEASURE_CAPPED);
    return 1;
}

/* Refines the best pose by all pairs if both surfaces may be wholes. Where only one matches, it is a part. */
static int refine_whole(smr_align_work *w)
{
    const smr_measure *m = measured(w);
    const float model = smr_measure_share(m, SMR_MODEL), target = smr_measure_share(m, SMR_TARGET);
    w->cost = smr_measure_cost(&w->aligner, m);
    w->least = smr_min(model, target);
    w->whole = w->least > SMR_WHOLE ||
               (w->least > SMR_WHOLE_TRIED && smr_max(model, target) < SMR_WHOLE_MET && w->n_parts == 0u);
    if (w->whole) {
        refine_one(w, &w->best.pose[0], w->all, w->iterations, w->scaled);
        use_discs(w, smr_min_u32(SMR_ROUNDS_WHOLE, w->iterations / 2u));
    }
    return w->whole;
}

static int measure_whole(smr_align_work *w)
{
    if (w->whole)
        find_pairs(w, &w->one.pose[0], w->some, SMR_MEASURE_RANKS | SMR_MEASURE_SUMS);
    return w->whole;
}

/* Without wholes, or where a refinement by all pairs has matched unlike parts, so that the cost has grown or samples
 * are left: outliers are rejected. Without a scale the refinement starts from the rigid pose that fits the scaled
 * pose's pairs. */
static int fit_part(smr_align_work *w)
{
    const smr_measure *m = measured(w);
    const float least = smr_min(smr_measure_share(m, SMR_MODEL), smr_measure_share(m, SMR_TARGET));
    const float limit = smr_measure_limit(&w->aligner, m);
    if (w->whole && (w->scaled || w->least <= SMR_WHOLE))
        w->whole = (w->least > SMR_WHOLE || (least > SMR_WHOLE_MET && limit <= SMR_WHOLE_REACH * w->aligner.limit)) &&
                   smr_measure_cost(&w->aligner, m) <= SMR_WHOLE_WORSE * w->cost + SMR_WHOLE_SLACK;
    if (w->whole)
        return 0;
    w->one.pose[0] = w->best.pose[0];
    if (!w->scaled)
        refine_one(w, &w->best.pose[0], w->some, 1, SMR_REFINE_TRIMMED);
    return !w->scaled;
}

static int refine_part(smr_align_work *w)
{
    if (!w->whole)
        refine_one(w, &w->one.pose[0], w->all, w->iterations, w->scaled | SMR_REFINE_TRIMMED);
    return !w->whole;
}

static int measure_result(smr_align_work *w)
{
    w->result = w->one.pose[0];
    find_pairs(w, &w->result, w->all, SMR_MEASURE_RANKS | SMR_MEASURE_SUMS);
    return 1;
}

static int report_result(smr_align_work *w)
{
    smr_align_report *r = &w->said;
    r->model_share = smr_measure_share(measured(w), SMR_MODEL);
    r->target_share = smr_measure_share(measured(w), SMR_TARGET);
    w->share[SMR_MODEL] = w->whole ? 1.0f : r->model_share;
    w->share[SMR_TARGET] = w->whole ? 1.0f : r->target_share;
    w->parts = w->share;
    return SMR_ALIGN_MEASURE;
}

static int measure_given(smr_align_work *w)
{
    w->said.rms_mm = smr_measure_rms(measured(w));
    find_pairs(w, &w->given, w->all, SMR_MEASURE_RANKS | SMR_MEASURE_SUMS);
    return 1;
}

/* The result becomes the given pose if that is about as good. */
static int report_given(smr_align_work *w)
{
    smr_align_report *r = &w->said;
    const float rms = smr_measure_rms(measured(w));
    if (rms <= SMR_GIVEN_WORSE * r->rms_mm) {
        r->given = 1;
        r->rms_mm = rms;
        w->result = w->given;
    }
    r->scale = smr_pose_scale(&w->result);
    r->n_alike = 1;
    return 0;
}

/* Returns a pose between coordinates relative to the surfaces' origins as one between those of the files. */
static smr_pose between_files(const smr_align_work *w, const smr_pose *pose)
{
    const smr_vec from = w->aligner.side[SMR_MODEL].surface->origin, to = w->aligner.side[SMR_TARGET].surface->origin;
    smr_pose p = *pose;
    smr_pose_through(&p, from, smr_add(to, smr_column(pose, 3)));
    return p;
}

/* Returns the pose without its scale where none is asked for. The image of the model's centre stays. */
static smr_pose as_asked(const smr_align_work *w, const smr_pose *pose)
{
    const smr_vec centre = w->aligner.side[SMR_MODEL].centre, at = smr_pose_apply(pose, centre);
    const float per = 1.0f / smr_pose_scale(pose);
    smr_pose p = *pose;
    for (uint32_t i = 0; i < 9u; i++)
        p.m[i / 3u][i % 3u] *= per;
    smr_pose_through(&p, centre, at);
    return w->scaled ? *pose : p;
}

/* Finds the next pose that clearly differs from the best one. */
static int find_other(smr_align_work *w)
{
    const smr_pose_list *best = &w->best;
    do
        w->other++;
    while (w->other < best->n &&
           !pose_differs(&w->aligner, &best->pose[w->other], &best->pose[0], SMR_OTHER_COS, SMR_OTHER_SHIFT));
    if (w->other < best->n)
        find_pairs(w, &best->pose[w->other], w->some, SMR_MEASURE_RANKS | SMR_MEASURE_SUMS);
    return w->other < best->n;
}

/* Reports the number of poses that match as well as the best, and the least rms of clearly different poses, mm. */
static int compare_other(smr_align_work *w)
{
    smr_align_report *r = &w->said;
    if (w->other >= w->best.n) {
        w->at += has_neighbour(w) ? SMR_MIRROR_STEPS : 0u;
        return 0;
    }
    const float rms = smr_measure_rms(measured(w));
    const smr_pose other = as_asked(w, &w->best.pose[w->other]);
    r->other[r->n_other++] = between_files(w, &other);
    if (r->second_rms_mm == 0.0f || rms < r->second_rms_mm)
        r->second_rms_mm = rms;
    r->n_alike += w->best.cost[w->other] <= SMR_ALIKE_COST * w->best.cost[0] + SMR_ALIKE_SLACK;
    w->at -= 2u; /* back to find_other() */
    return 0;
}

/* Searches the model's mirror image near the result's scale. */
static int try_mirrored(smr_align_work *w)
{
    start_search(w, w->said.scale, SMR_SHIFTS_LONG, 1, SMR_OF_SCALE);
    smr_list_start(&w->shorter, 1);
    refine(w, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_TRIMMED | w->scaled, &w->shorter);
    use_discs(w, SMR_NONE);
    return 1;
}

static int refine_mirrored(smr_align_work *w)
{
    const smr_pose *pose = w->shorter.n > 0u ? &w->shorter.pose[0] : &w->found.pose[0];
    refine_one(w, pose, w->some, SMR_ROUNDS, SMR_REFINE_TRIMMED | w->scaled);
    use_discs(w, SMR_ROUNDS_DISCS);
    return 1;
}

static int measure_mirrored(smr_align_work *w)
{
    const smr_pose mirrored = w->one.pose[0];
    find_pairs(w, &mirrored, w->some, SMR_MEASURE_RANKS | SMR_MEASURE_SUMS);
    return 1;
}

static int finish(smr_align_work *w)
{
    w->said.mirrored_rms_mm = has_neighbour(w) ? 0.0f : smr_measure_rms(measured(w));
    w->said.model_inside_out = w->aligner.side[SMR_MODEL].outward < 0.0f;
    w->said.target_inside_out = w->aligner.side[SMR_TARGET].outward < 0.0f;
    w->result = between_files(w, &w->result);
    *w->pose = w->said.given ? w->as_given : w->result;
    if (w->report != NULL)
        *w->report = w->said;
    return 0;
}

static int (*const steps[])(smr_align_work *w) = {
    find_poses,   refine_nearer, try_smaller,   try_larger,   try_ratio,       refine_finalists, measure_best,
    refine_whole, measure_whole, fit_part,      refine_part,  measure_result,  report_result,    measure_given,
    report_given, find_other,    compare_other, try_mirrored, refine_mirrored, measure_mirrored, finish,
};

int smr_align_step(smr_align_work *w)
{
    return w->at < sizeof steps / sizeof steps[0] ? steps[w->at++](w) : SMR_ALIGN_END;
}
