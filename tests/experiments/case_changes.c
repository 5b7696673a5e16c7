/* case_changes.c: what spoils the target or the start of a run onto a surface, or makes it another body's.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, origin[3] = {0, 0, 0};

/* The femurs, hip bones and patellas in two halves: a rule that is fitted to one half has not seen the other. */
static const case_bone bones[] = {
    {"m_right", "femurs/femur_m_right.ply", 'f', 0, 1, 1, NULL},
    {"2008", "femurs/femur_2008_0019_left_3k.ply", 'f', 0, 0, 1, NULL},
    {"person_femur", "thigh_person/truth/femur.ply", 'f', 0, 1, 0, "thigh_person/truth/hip_bone.ply"},
    {"hip_bone", "hip_thigh_vhm/hip_bone.ply", 'h', 0, 1, 0, "hip_thigh_vhm/femur.ply"},
    {"person_hip", "thigh_person/truth/hip_bone.ply", 'h', 0, 1, 0, "thigh_person/truth/femur.ply"},
    {"patella", "hip_thigh_vhm/patella.ply", 'p', 0, 1, 0, "hip_thigh_vhm/femur.ply"},
    {"hip_thigh", "hip_thigh_vhm/femur.ply", 'f', 1, 1, 0, "hip_thigh_vhm/hip_bone.ply"},
    {"2007", "femurs/femur_2007_5028_left_3k.ply", 'f', 1, 0, 1, NULL},
    {"upper_right", "ct_hips_surfaces/femur_proximal_right.ply", 'u', 1, 1, 0, "ct_hips_surfaces/hip_bone_right.ply"},
    {"upper_left", "ct_hips_surfaces/femur_proximal_left.ply", 'u', 1, 0, 0, "ct_hips_surfaces/hip_bone_left.ply"},
    {"hip_right", "ct_hips_surfaces/hip_bone_right.ply", 'h', 1, 1, 1, "ct_hips_surfaces/femur_proximal_right.ply"},
    {"hip_left", "ct_hips_surfaces/hip_bone_left.ply", 'h', 1, 0, 1, "ct_hips_surfaces/femur_proximal_left.ply"},
    {"person_patella", "thigh_person/truth/patella.ply", 'p', 1, 1, 0, "thigh_person/truth/femur.ply"},
    {NULL, NULL, 0, 0, 0, 0, NULL},
};

const case_bone *case_choose_bone(uint32_t half, const char *sorts, const char *but, oracle_random *r)
{
    const case_bone *fit[16];
    uint32_t n = 0;
    for (const case_bone *b = bones; b->name != NULL; b++)
        if (b->half == half && strchr(sorts, b->sort) != NULL && strcmp(b->name, but) != 0)
            fit[n++] = b;
    if (n == 0)
        case_fail("no such bone");
    return fit[oracle_below(r, n)];
}

/* Reads a bone; right ones are mirrored if `left`. */
static host_mesh read_bone(const case_job *job, const case_bone *bone, int left)
{
    return case_load(case_text("%s/%s", job->data_path, bone->path),
                     left && bone->right ? HOST_MIRROR_X : HOST_MIRROR_NONE);
}

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

/* A target that is not the model's body: no vertex has a true place, and the target is the whole true surface. */
static int other_body(case_job *job)
{
    case_body *const body = &job->data.body[0];
    host_mesh_free(&body->truth);
    replace(&body->whole, case_copy(&body->target));
    return 0;
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

int case_metres(case_job *job, oracle_random *r)
{
    static const double m[9] = {0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001};
    return (void)r, case_apply(target_of(job), m, origin, origin), 0;
}

int case_inside_out(case_job *job, oracle_random *r) { return (void)r, turn_over(target_of(job)), 1; }

/* A bone of another sort, at the same place. */
static void put_other_bone(case_job *job, oracle_random *r)
{
    const char *const others = job->of->sort == 'h' ? "f" : job->of->sort == 'p' ? "fh" : "hp";
    host_mesh other = read_bone(job, case_choose_bone(job->half, others, "", r), 0);
    double from[3], to[3];
    case_middle(&other, from);
    case_middle(target_of(job), to);
    case_apply(&other, identity, from, to);
    replace(target_of(job), other);
}

int case_other_bone(case_job *job, oracle_random *r) { return put_other_bone(job, r), other_body(job); }

int case_wrong_side(case_job *job, oracle_random *r)
{
    static const double m[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    (void)r;
    (void)change_target(job, m);
    turn_over(target_of(job));
    return other_body(job);
}

int case_upside_down(case_job *job, oracle_random *r)
{
    const double angle = oracle_uniform(r, 0.0, acos(-1.0)), axis[3] = {cos(angle), sin(angle), 0.0};
    return change_model(job, axis, acos(-1.0));
}

int case_twisted(case_job *job, oracle_random *r)
{
    static const double axis[3] = {0.0, 0.0, 1.0};
    return change_model(job, axis, oracle_uniform(r, 0.35, 1.0) * acos(-1.0));
}

static int scale_by(case_job *job, oracle_random *r, double low, double high)
{
    const double by = oracle_uniform(r, low, high), s = oracle_below(r, 2) ? by : 1.0 / by;
    const double m[9] = {s, 0, 0, 0, s, 0, 0, 0, s};
    return change_target(job, m);
}

int case_scaled(case_job *job, oracle_random *r) { return scale_by(job, r, 1.3, 1.8); }
int case_scaled_little(case_job *job, oracle_random *r) { return scale_by(job, r, 1.0, 1.25); }

int case_stretched(case_job *job, oracle_random *r)
{
    const double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, oracle_uniform(r, 1.05, 1.5)};
    return change_target(job, m);
}

/* A long bone with the same end above and below, and none of a femur's upper end. */
int case_tibia(case_job *job, oracle_random *r)
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
    return other_body(job);
}

/* The lower half is hidden, and half of another bone lies in its place. */
int case_half_replaced(case_job *job, oracle_random *r)
{
    host_mesh own = case_copy(target_of(job));
    double middle[3];
    case_middle(&own, middle);
    put_other_bone(job, r);
    host_mesh other = case_copy(target_of(job));
    case_keep_height(&own, middle[2], HUGE_VAL);
    case_keep_height(&other, -HUGE_VAL, middle[2]);
    join(&own, other);
    replace(target_of(job), own);
    return 1;
}

int case_twin(case_job *job, oracle_random *r)
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
int case_middle_part(case_job *job, oracle_random *r) { return (void)r, case_keep_shares(target_of(job), 0.3, 0.7), 1; }

int case_sphere(case_job *job, oracle_random *r)
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
    return other_body(job);
}

int case_flat(case_job *job, oracle_random *r)
{
    const double m[9] = {1, 0, 0, 0, oracle_uniform(r, 0.02, 0.3), 0, 0, 0, 1};
    scale_about(target_of(job), m);
    return other_body(job);
}

/* The triangles fly apart: each is its own, some millimetres off. */
int case_soup(case_job *job, oracle_random *r)
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

/* Another person's bone as the target; there is no truth by vertex. */
static int other_person(case_job *job, oracle_random *r, double from, double to)
{
    case_body *const body = &job->data.body[0];
    const char sort[2] = {job->of->sort, '\0'};
    replace(&body->whole, read_bone(job, case_choose_bone(job->half, sort, job->bone, r), 1));
    replace(&body->target, case_copy(&body->whole));
    host_mesh_free(&body->truth);
    case_keep_shares(&body->target, from, to);
    job->data.overlap = case_area(&body->target) / case_area(&body->whole);
    return 1;
}

int case_person(case_job *job, oracle_random *r) { return other_person(job, r, 0.0, 1.0); }
int case_person_top(case_job *job, oracle_random *r) { return other_person(job, r, 0.3, 1.0); }
int case_person_low(case_job *job, oracle_random *r) { return other_person(job, r, 0.0, 0.5); }

int case_person_mirrored(case_job *job, oracle_random *r)
{
    static const double m[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    (void)other_person(job, r, 0.0, 1.0);
    scale_about(target_of(job), m);
    turn_over(target_of(job));
    return other_body(job);
}

/* Another bone beside, its box some millimetres from the target's. */
int case_neighbour(case_job *job, oracle_random *r)
{
    host_mesh other = read_bone(job, case_choose_bone(job->half, "fhp", "", r), 1);
    double from[3], to[3], half[2][3];
    const double gap = oracle_uniform(r, 1.0, 15.0), side = oracle_below(r, 2) ? 1.0 : -1.0;
    const uint32_t axis = oracle_below(r, 2);
    case_box(target_of(job), to, half[0]);
    case_box(&other, from, half[1]);
    to[axis] += side * (half[0][axis] + half[1][axis] + gap);
    case_apply(&other, identity, from, to);
    join(target_of(job), other);
    return 1;
}

/* Points instead of a surface. */
static int cloud_of(case_job *job, oracle_random *r, double least, double most, double strays, double blob)
{
    const uint32_t n = (uint32_t)(least * pow(most / least, oracle_uniform(r, 0.0, 1.0))),
                   seed = oracle_below(r, 1000u);
    host_mesh cloud = case_new_mesh(n, 0);
    float *const normal = case_alloc(3u * (size_t)n, sizeof *normal);
    case_sample(target_of(job), n, 0.3, seed, cloud.xyz, normal);
    case_spoil(target_of(job), strays, blob, seed, cloud.xyz, n);
    replace(target_of(job), cloud);
    free(normal);
    return 1;
}

int case_points(case_job *job, oracle_random *r) { return cloud_of(job, r, 500.0, 5000.0, 0.0, 0.0); }
int case_few_points(case_job *job, oracle_random *r) { return cloud_of(job, r, 40.0, 500.0, 0.0, 0.0); }
int case_stray_points(case_job *job, oracle_random *r)
{
    return cloud_of(job, r, 500.0, 3000.0, oracle_uniform(r, 0.0, 0.3), 0.0);
}
int case_point_blob(case_job *job, oracle_random *r)
{
    return cloud_of(job, r, 500.0, 3000.0, 0.0, oracle_uniform(r, 0.03, 0.2));
}

/* The target with the model's own triangles, and with a quarter of the usual edge length in its upper half. */
int case_same_mesh(case_job *job, oracle_random *r)
{
    return (void)r, replace(target_of(job), case_copy(&job->data.body[0].truth)), 1;
}

int case_uneven(case_job *job, oracle_random *r)
{
    host_mesh lower = case_copy(target_of(job));
    const double at = oracle_uniform(r, 0.3, 0.7);
    case_keep_shares(&lower, -1.0, at);
    case_keep_shares(target_of(job), at, 2.0);
    for (int k = 0; k < 2; k++)
        replace(target_of(job), case_subdivide(target_of(job), NULL));
    join(target_of(job), lower);
    return 1;
}

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

int case_marks(case_job *job, oracle_random *r) { return add_marks(job, r, 0.0, 0); }
int case_marks_swapped(case_job *job, oracle_random *r) { return add_marks(job, r, 0.0, 1); }
int case_marks_off(case_job *job, oracle_random *r) { return add_marks(job, r, 90.0, 0); }
