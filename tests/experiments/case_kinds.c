/* case_kinds.c: the kinds of runs that verdicts are judged by, fair, poor and hopeless ones, and those onto surfaces.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, origin[3] = {0, 0, 0};

static const struct bone {
    const char *name, *path;
    int right;
} bones[] = {
    /* the femurs first */
    {"m_right", "femurs/femur_m_right.ply", 1},
    {"2008", "femurs/femur_2008_0019_left_3k.ply", 0},
    {"2007", "femurs/femur_2007_5028_left_3k.ply", 0},
    {"vhm_left", "femurs/femur_vhm_left.ply", 0},
    {"hip_thigh", "hip_thigh_vhm/femur.ply", 1},
    {"hip_bone", "hip_thigh_vhm/hip_bone.ply", 1},
    {"hip_right", "ct_hips_surfaces/hip_bone_right.ply", 1},
};
enum { FEMURS = 5 };
static const char *data_path;

static host_mesh read_bone(const struct bone *bone, int mirror)
{
    return case_load(case_text("%s/%s", data_path, bone->path), mirror);
}

static int mirror_of(const struct bone *bone) { return bone->right ? HOST_MIRROR_X : HOST_MIRROR_NONE; }

static host_mesh *target_of(case_job *job) { return &job->data.body[0].target; }

static void replace(host_mesh *mesh, host_mesh by)
{
    host_mesh_free(mesh);
    *mesh = by;
}

/* Appends the other mesh and frees it. */
static void join(host_mesh *mesh, host_mesh other)
{
    if (host_mesh_append(mesh, &other) != 0)
        case_fail("out of memory");
    host_mesh_free(&other);
}

static void scale_about(host_mesh *mesh, const double m[9])
{
    double middle[3];
    case_middle(mesh, middle);
    case_apply(mesh, m, middle, middle);
}

/* The target, and the truth with it. */
static int change_target(case_job *job, const double m[9])
{
    case_body *const body = &job->data.body[0];
    double middle[3];
    case_middle(&body->truth, middle);
    case_apply(&body->target, m, middle, middle);
    case_apply(&body->truth, m, middle, middle);
    case_apply(&body->whole, m, middle, middle);
    return 1;
}

static int change_model(case_job *job, const double axis[3], double angle)
{
    double m[9];
    oracle_turn(axis, angle, m);
    scale_about(&job->data.body[0].model, m);
    return 1;
}

static void turn_over(host_mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        uint32_t *const v = mesh->triangles + 3u * (size_t)t, keep = v[1];
        v[1] = v[2];
        v[2] = keep;
    }
}

static int metres(case_job *job, oracle_random *r)
{
    static const double m[9] = {0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001};
    return (void)r, case_apply(target_of(job), m, origin, origin), 0;
}

static int inside_out(case_job *job, oracle_random *r) { return (void)r, turn_over(target_of(job)), 1; }

/* A hip bone for a femur and the other way round, at the same place. */
static int other_bone(case_job *job, oracle_random *r)
{
    const int femur = job->bone[0] != 'h' || strcmp(job->bone, "hip_thigh") == 0;
    const uint32_t i = femur ? FEMURS + oracle_below(r, 2) : oracle_below(r, FEMURS);
    host_mesh other = read_bone(&bones[i], HOST_MIRROR_NONE);
    double from[3], to[3];
    case_middle(&other, from);
    case_middle(target_of(job), to);
    case_apply(&other, identity, from, to);
    replace(target_of(job), other);
    return 0;
}

static int wrong_side(case_job *job, oracle_random *r)
{
    static const double m[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    (void)r;
    (void)change_target(job, m);
    turn_over(target_of(job));
    turn_over(&job->data.body[0].whole);
    return 0;
}

static int upside_down(case_job *job, oracle_random *r)
{
    const double angle = oracle_uniform(r, 0.0, acos(-1.0)), axis[3] = {cos(angle), sin(angle), 0.0};
    return change_model(job, axis, acos(-1.0));
}

static int twisted(case_job *job, oracle_random *r)
{
    static const double axis[3] = {0.0, 0.0, 1.0};
    return change_model(job, axis, oracle_uniform(r, 0.35, 1.0) * acos(-1.0));
}

static int scaled(case_job *job, oracle_random *r)
{
    const double s = oracle_below(r, 2) ? 1.6 : 1.0 / 1.6, m[9] = {s, 0, 0, 0, s, 0, 0, 0, s};
    return change_target(job, m);
}

static int stretched(case_job *job, oracle_random *r)
{
    const double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, oracle_uniform(r, 1.2, 1.5)};
    return change_target(job, m);
}

/* A long bone with the same end above and below, and none of a femur's upper end. */
static int tibia(case_job *job, oracle_random *r)
{
    const double wide = oracle_uniform(r, 0.8, 1.0), m[9] = {wide, 0, 0, 0, wide, 0, 0, 0, -0.85};
    const double same[9] = {wide, 0, 0, 0, wide, 0, 0, 0, 0.85};
    host_mesh *const lower = target_of(job);
    double middle[3];
    case_middle(lower, middle);
    case_keep_height(lower, -HUGE_VAL, middle[2]);
    host_mesh upper = case_copy(lower);
    case_apply(&upper, m, middle, middle);
    case_apply(lower, same, middle, middle);
    turn_over(&upper);
    join(lower, upper);
    return 0;
}

static int half_replaced(case_job *job, oracle_random *r)
{
    host_mesh own = case_copy(target_of(job));
    double middle[3];
    case_middle(&own, middle);
    (void)other_bone(job, r);
    host_mesh other = case_copy(target_of(job));
    case_keep_height(&own, middle[2], HUGE_VAL);
    case_keep_height(&other, -HUGE_VAL, middle[2]);
    join(&own, other);
    replace(target_of(job), own);
    return 0;
}

static int twin(case_job *job, oracle_random *r)
{
    host_mesh copy = case_copy(target_of(job));
    double d[3];
    case_direction(r, d);
    for (int c = 0; c < 3; c++)
        d[c] *= oracle_uniform(r, 25.0, 60.0);
    case_apply(&copy, identity, origin, d);
    join(target_of(job), copy);
    return 1;
}

/* The shaft alone, which slides. */
static int middle(case_job *job, oracle_random *r) { return (void)r, case_keep_shares(target_of(job), 0.3, 0.7), 1; }

static int sphere(case_job *job, oracle_random *r)
{
    static const float corner[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const uint32_t face[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                        {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    host_mesh ball = case_new_mesh(6, 8);
    const double radius = oracle_uniform(r, 30.0, 120.0);
    double to[3], p[3];
    memcpy(ball.xyz, corner, sizeof corner);
    memcpy(ball.triangles, face, sizeof face);
    for (int k = 0; k < 5; k++)
        replace(&ball, case_subdivide(&ball, NULL));
    case_middle(target_of(job), to);
    for (uint32_t i = 0; i < ball.n_vertices; i++) {
        case_get(&ball, i, p);
        const double length = case_length(p);
        for (int c = 0; c < 3; c++)
            p[c] = radius * p[c] / length + to[c];
        case_put(&ball, i, p);
    }
    replace(target_of(job), ball);
    return 0;
}

static int flat(case_job *job, oracle_random *r)
{
    const double m[9] = {1, 0, 0, 0, oracle_uniform(r, 0.02, 0.3), 0, 0, 0, 1};
    return scale_about(target_of(job), m), 0;
}

/* The triangles fly apart: each is its own, some millimetres off. */
static int soup(case_job *job, oracle_random *r)
{
    const host_mesh *const mesh = target_of(job);
    host_mesh apart = case_new_mesh(3u * mesh->n_triangles, mesh->n_triangles);
    const double size = oracle_uniform(r, 5.0, 15.0);
    double d[3] = {0.0, 0.0, 0.0}, p[3];
    for (uint32_t i = 0; i < apart.n_vertices; i++) {
        if (i % 3u == 0)
            case_direction(r, d);
        case_get(mesh, mesh->triangles[i], p);
        for (int c = 0; c < 3; c++)
            p[c] += size * d[c];
        case_put(&apart, i, p);
        apart.triangles[i] = i;
    }
    replace(target_of(job), apart);
    return 1;
}

/* Another person's femur as the target; there is no truth by vertex. */
static int other_person(case_job *job, oracle_random *r, double from, double to)
{
    case_body *const body = &job->data.body[0];
    uint32_t i = oracle_below(r, FEMURS);
    i = strcmp(bones[i].name, job->bone) == 0 ? (i + 1u) % FEMURS : i;
    replace(&body->whole, read_bone(&bones[i], mirror_of(&bones[i])));
    replace(&body->target, case_copy(&body->whole));
    host_mesh_free(&body->truth);
    case_keep_shares(&body->target, from, to);
    job->data.overlap = case_area(&body->target) / case_area(&body->whole);
    return 1;
}

static int person(case_job *job, oracle_random *r) { return other_person(job, r, 0.0, 1.0); }
static int person_top(case_job *job, oracle_random *r) { return other_person(job, r, 0.3, 1.0); }
static int person_low(case_job *job, oracle_random *r) { return other_person(job, r, 0.0, 0.5); }

/* Landmarks: six vertices of the model, and where they belong, some millimetres off. */
static int add_marks(case_job *job, oracle_random *r, double off, uint32_t swapped)
{
    host_landmarks *const set = case_alloc(2, sizeof *set);
    const case_body *const body = &job->data.body[0];
    char *path[2];
    double shift[3];
    for (int c = 0; c < 3; c++)
        shift[c] = oracle_uniform(r, -1.0, 1.0);
    for (uint32_t k = 0; k < 6u; k++) {
        const size_t from = oracle_below(r, body->model.n_vertices);
        for (uint32_t s = 0; s < 2u; s++)
            (void)snprintf(set[s].label[k], sizeof set[s].label[k], "m%u", (k + 3u * s * swapped) % 6u);
        for (uint32_t c = 0; c < 3u; c++) {
            set[0].xyz[k][c] = body->model.xyz[3u * from + c];
            set[1].xyz[k][c] = body->truth.xyz[3u * from + c] + (float)oracle_uniform(r, -2.0, 2.0) +
                               (float)(off * shift[c] / case_length(shift));
        }
    }
    for (uint32_t s = 0; s < 2u; s++) {
        set[s].n = 6;
        path[s] = case_text("%s/marks%u.csv", job->directory, s);
        case_write_marks(&set[s], path[s]);
    }
    job->words = case_text("--landmarks %s %s", path[0], path[1]);
    free(set);
    return 1;
}

static int marks(case_job *job, oracle_random *r) { return add_marks(job, r, 0.0, 0); }
static int marks_swapped(case_job *job, oracle_random *r) { return add_marks(job, r, 0.0, 1); }
static int marks_off(case_job *job, oracle_random *r) { return add_marks(job, r, 90.0, 0); }

#define VIEW(low, high) .part = CASE_PATCHES, .patches = 1, .share = {low, high}
#define MOVED(mm, deg) .shift = mm, .turn = deg

static const case_kind kinds[] = {
    {.name = "whole", .weight = 6},
    {.name = "whole near", .weight = 2, MOVED(3.0, 3.0)},
    {.name = "whole exact", .weight = 1, .noise = -1.0},
    {.name = "whole noise 1", .weight = 2, .noise = 1.0},
    {.name = "whole noise 2", .weight = 1, .noise = 2.0},
    {.name = "whole bend 10", .weight = 2, .deform = 10.0, .sigma = 100.0},
    {.name = "whole bend small", .weight = 1, .deform = 3.0, .sigma = 40.0},
    {.name = "whole outliers 5", .weight = 2, .outliers = 0.05},
    {.name = "whole outliers 20", .weight = 1, .outliers = 0.2},
    {.name = "side", .weight = 6, .part = CASE_SIDE},
    {.name = "side outliers 5", .weight = 2, .part = CASE_SIDE, .outliers = 0.05},
    {.name = "patches", .weight = 6, .part = CASE_PATCHES, .patches = 3, .share = {0.2, 0.4}},
    {.name = "end", .weight = 4, .part = CASE_END, .share = {0.38, 0.38}},
    {.name = "view", .weight = 8, VIEW(0.15, 0.9)},
    {.name = "view far", .weight = 4, VIEW(0.15, 0.9)},
    {.name = "person", .weight = 2, .change = person, .words = "--align rigid"},
    {.name = "person scaled", .weight = 2, .change = person, .words = "--align similarity"},
    {.name = "person top", .weight = 2, .change = person_top, .words = "--align rigid"},
    {.name = "person low", .weight = 1, .change = person_low, .words = "--align rigid"},
    {.name = "aligned", .weight = 2, MOVED(40.0, 30.0), .words = "--align rigid"},
    {.name = "aligned side", .weight = 1, .part = CASE_SIDE, MOVED(20.0, 15.0), .words = "--align rigid"},
    {.name = "marks", .weight = 1, MOVED(60.0, 60.0), .change = marks},
    {.name = "metres", .weight = 1, .change = metres},
    {.name = "metres scaled", .weight = 1, .change = metres, .words = "--align similarity"},
    {.name = "inside out", .weight = 1, .change = inside_out},
    {.name = "tibia", .weight = 1, .change = tibia, .words = "--align similarity"},
    {.name = "other bone", .weight = 1, .change = other_bone, .words = "--align similarity"},
    {.name = "other bone rigid", .weight = 1, .change = other_bone, .words = "--align rigid"},
    {.name = "other bone there", .weight = 1, .change = other_bone},
    {.name = "wrong side", .weight = 1, .change = wrong_side},
    {.name = "wrong side rigid", .weight = 1, .change = wrong_side, .words = "--align rigid"},
    {.name = "upside down", .weight = 1, .change = upside_down},
    {.name = "twisted", .weight = 1, .change = twisted},
    {.name = "scaled", .weight = 1, .change = scaled},
    {.name = "stretched", .weight = 1, .change = stretched},
    {.name = "half replaced", .weight = 1, .change = half_replaced},
    {.name = "twin", .weight = 1, .change = twin},
    {.name = "middle", .weight = 1, .change = middle},
    {.name = "sphere", .weight = 1, .change = sphere, .words = "--align similarity"},
    {.name = "flat", .weight = 1, .change = flat},
    {.name = "soup", .weight = 1, .change = soup},
    {.name = "noise 5", .weight = 1, .noise = 5.0},
    {.name = "outliers 50", .weight = 1, .outliers = 0.5},
    {.name = "far 60", .weight = 1, MOVED(60.0, 20.0)},
    {.name = "far 60 side", .weight = 1, .part = CASE_SIDE, MOVED(60.0, 20.0)},
    {.name = "turned 60", .weight = 1, .turn = 60.0},
    {.name = "tiny", .weight = 1, VIEW(0.02, 0.05)},
    {.name = "wild bend", .weight = 1, .deform = 20.0, .sigma = 30.0},
    {.name = "marks swapped", .weight = 1, .change = marks_swapped},
    {.name = "marks off", .weight = 1, .change = marks_off},
    {.name = NULL},
};

static void choose(double value, double *option) { *option = value < 0.0 ? 0.0 : value > 0.0 ? value : *option; }

static case_options options_of(const case_kind *kind, uint32_t seed, oracle_random *r)
{
    case_options o = case_defaults();
    o.seed = seed;
    o.part = kind->part;
    o.patches = kind->patches > 0 ? kind->patches + (kind->patches > 1 ? (int)(seed / 2u % 2u) : 0) : o.patches;
    if (kind->share[1] > 0.0)
        o.share = oracle_uniform(r, kind->share[0], kind->share[1]);
    choose(kind->shift, &o.shift_mm);
    choose(kind->turn, &o.turn_deg);
    choose(kind->noise, &o.noise_mm);
    choose(kind->outliers, &o.outliers);
    choose(kind->deform, &o.deform_mm);
    choose(kind->sigma, &o.sigma_mm);
    if (strcmp(kind->name, "view far") == 0) {
        o.shift_mm = oracle_uniform(r, 0.0, 15.0);
        o.turn_deg = oracle_uniform(r, 0.0, 10.0);
    }
    return o;
}

static int make_surfaces(case_job *job, const case_kind *kind, uint32_t seed, oracle_random *r)
{
    /* Small bones come more often, since a run of them takes less time. */
    static const unsigned char often[] = {4, 4, 4, 5, 5, 5, 1, 1, 2, 2, 0, 0, 3, 6};
    uint32_t i = often[oracle_below(r, sizeof often)];
    const case_options o = options_of(kind, seed, r);
    if (i >= FEMURS && (strncmp(kind->name, "person", 6) == 0 || strcmp(kind->name, "middle") == 0))
        i = seed / 2u % FEMURS;
    job->bone = bones[i].name;
    (void)case_add(&job->data, case_text("%s/%s", data_path, bones[i].path), mirror_of(&bones[i]));
    case_make(&job->data, &o);
    const int truth = kind->change == NULL || kind->change(job, r);
    const char *const name = job->data.body[0].name, *const place = job->directory;
    job->words = case_text("%s --model %s/model/%s.ply --target %s/target/%s.ply %s", job->words, place, name, place,
                           name, kind->words != NULL ? kind->words : "");
    return truth;
}

/* The kind of this name, or else of a slot, which counts weights through the table and goes on behind it. */
static const case_kind *find(const case_kind *table, const char *name, uint32_t *slot)
{
    for (; table->name != NULL; *slot -= (uint32_t)table++->weight)
        if (name != NULL ? strcmp(table->name, name) == 0 : *slot < (uint32_t)table->weight)
            return table;
    return NULL;
}

void case_job_make(uint32_t seed, const char *name, const char *data, const char *directory)
{
    case_job *const job = case_alloc(1, sizeof *job);
    oracle_random r = oracle_seed(20000u + seed);
    uint32_t all = 0, slot = 0;
    for (const case_kind *k = kinds; k->name != NULL; k++)
        all += (uint32_t)k->weight;
    for (const case_kind *k = case_image_kinds; k->name != NULL; k++)
        all += (uint32_t)k->weight;
    slot = (uint32_t)(((uint64_t)(seed / 2u) * 1009u) % all); /* both halves of the seeds have all kinds */
    data_path = data;
    job->directory = directory;
    job->words = "";
    case_directory(directory);
    const case_kind *const onto = find(kinds, name, &slot);
    const case_kind *const kind = onto != NULL ? onto : find(case_image_kinds, name, &slot);
    if (kind == NULL)
        case_fail("no such kind");
    const int truth = onto != NULL ? make_surfaces(job, kind, seed, &r) : case_image_make(job, kind, &r);
    case_write(&job->data, directory);
    (void)printf("kind=%s\nbone=%s\nhopeless=%d\nimage=%d\noverlap=%.3f\nwords=%s\n", kind->name, job->bone, !truth,
                 onto == NULL, job->data.overlap, job->words);
}
