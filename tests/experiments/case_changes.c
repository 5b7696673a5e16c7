/* case_changes.c: what makes a surface target poor or hopeless, and targets of another person.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_kinds.h"

static host_mesh *target_of(case_job *job) { return &job->data.body[0].target; }

static void middle_of(const host_mesh *mesh, double out[3])
{
    uint32_t i = 0;
    out[0] = out[1] = out[2] = 0.0;
    for (i = 0; i < 3u * mesh->n_vertices; i++)
        out[i % 3u] += (double)mesh->xyz[i] / mesh->n_vertices;
}

/* x := m (x - about) + to. */
static void apply(host_mesh *mesh, const double m[9], const double about[3], const double to[3])
{
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < mesh->n_vertices; i++) {
        float *const x = mesh->xyz + 3u * (size_t)i;
        double d[3];
        for (c = 0; c < 3; c++)
            d[c] = (double)x[c] - about[c];
        for (c = 0; c < 3; c++)
            x[c] = (float)(m[3 * c] * d[0] + m[3 * c + 1] * d[1] + m[3 * c + 2] * d[2] + to[c]);
    }
}

/* The target, and the truth with it. */
static void apply_to_target(case_job *job, const double m[9])
{
    case_body *const body = &job->data.body[0];
    double middle[3];
    middle_of(&body->truth, middle);
    apply(&body->target, m, middle, middle);
    apply(&body->truth, m, middle, middle);
    apply(&body->whole, m, middle, middle);
}

static void apply_to_model(case_job *job, const double m[9])
{
    double middle[3];
    middle_of(&job->data.body[0].model, middle);
    apply(&job->data.body[0].model, m, middle, middle);
}

static void turn_over(host_mesh *mesh)
{
    uint32_t t = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        uint32_t *const v = mesh->triangles + 3u * (size_t)t, keep = v[1];
        v[1] = v[2];
        v[2] = keep;
    }
}

int case_change_metres(case_job *job, oracle_random *r)
{
    const double m[9] = {0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001}, zero[3] = {0.0, 0.0, 0.0};
    (void)r;
    apply(target_of(job), m, zero, zero);
    return 0;
}

int case_change_inside_out(case_job *job, oracle_random *r)
{
    (void)r;
    turn_over(target_of(job));
    return 1;
}

/* A hip bone for a femur and the other way round, at the same place. */
int case_change_other_bone(case_job *job, oracle_random *r)
{
    static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int femur = job->bone[0] != 'h' || strcmp(job->bone, "hip_thigh") == 0;
    const case_bone *const bone =
        &case_bones[femur ? CASE_FEMURS + (int)oracle_below(r, 2) : (int)oracle_below(r, CASE_FEMURS)];
    const char *const path = experiment_data("%s", bone->path);
    case_body *const body = &job->data.body[0];
    double from[3], to[3];
    host_error error;
    host_mesh other;
    memset(&error, 0, sizeof error);
    if (path == NULL || host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &other, &error) != 0)
        return 0;
    middle_of(&other, from);
    middle_of(&body->target, to);
    apply(&other, unit, from, to);
    host_mesh_free(&body->target);
    body->target = other;
    return 0;
}

int case_change_wrong_side(case_job *job, oracle_random *r)
{
    static const double m[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    (void)r;
    apply_to_target(job, m);
    turn_over(target_of(job));
    turn_over(&job->data.body[0].whole);
    return 0;
}

int case_change_upside_down(case_job *job, oracle_random *r)
{
    const double angle = oracle_uniform(r, 0.0, acos(-1.0)), axis[3] = {cos(angle), sin(angle), 0.0};
    double m[9];
    oracle_turn(axis, acos(-1.0), m);
    apply_to_model(job, m);
    return 1;
}

int case_change_twisted(case_job *job, oracle_random *r)
{
    static const double axis[3] = {0.0, 0.0, 1.0};
    double m[9];
    oracle_turn(axis, oracle_uniform(r, 0.35, 1.0) * acos(-1.0), m);
    apply_to_model(job, m);
    return 1;
}

int case_change_scaled(case_job *job, oracle_random *r)
{
    const double s = oracle_below(r, 2) ? 1.6 : 1.0 / 1.6, m[9] = {s, 0, 0, 0, s, 0, 0, 0, s};
    apply_to_target(job, m);
    return 1;
}

int case_change_stretched(case_job *job, oracle_random *r)
{
    const double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, oracle_uniform(r, 1.2, 1.5)};
    apply_to_target(job, m);
    return 1;
}

/* Triangles whose middle lies above a height, or below. */
static void keep_height(host_mesh *mesh, double low, double high)
{
    unsigned char *const keep = case_alloc(mesh->n_triangles, 1);
    host_mesh cut;
    uint32_t t = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        double p[3];
        case_centre(mesh, t, p);
        keep[t] = p[2] >= low && p[2] <= high;
    }
    cut = case_cut(mesh, keep);
    host_mesh_free(mesh);
    *mesh = cut;
    free(keep);
}

/* A long bone with the same end above and below, and none of a femur's upper end. */
int case_change_tibia(case_job *job, oracle_random *r)
{
    const double wide = oracle_uniform(r, 0.8, 1.0), m[9] = {wide, 0, 0, 0, wide, 0, 0, 0, -0.85};
    const double same[9] = {wide, 0, 0, 0, wide, 0, 0, 0, 0.85};
    host_mesh *const lower = target_of(job);
    host_mesh upper;
    double middle[3];
    middle_of(lower, middle);
    keep_height(lower, -HUGE_VAL, middle[2]);
    upper = case_copy(lower);
    apply(&upper, m, middle, middle);
    apply(lower, same, middle, middle);
    turn_over(&upper);
    (void)host_mesh_append(lower, &upper);
    host_mesh_free(&upper);
    return 0;
}

int case_change_half(case_job *job, oracle_random *r)
{
    case_body *const body = &job->data.body[0];
    host_mesh own = case_copy(&body->target), other;
    double middle[3];
    middle_of(&own, middle);
    (void)case_change_other_bone(job, r);
    other = body->target;
    keep_height(&own, middle[2], HUGE_VAL);
    keep_height(&other, -HUGE_VAL, middle[2]);
    (void)host_mesh_append(&own, &other);
    host_mesh_free(&other);
    body->target = own;
    return 0;
}

int case_change_twin(case_job *job, oracle_random *r)
{
    static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, zero[3] = {0.0, 0.0, 0.0};
    host_mesh copy = case_copy(target_of(job));
    double d[3];
    int c = 0;
    case_direction(r, d);
    for (c = 0; c < 3; c++)
        d[c] *= oracle_uniform(r, 25.0, 60.0);
    apply(&copy, unit, zero, d);
    (void)host_mesh_append(target_of(job), &copy);
    host_mesh_free(&copy);
    return 1;
}

static void keep_shares(host_mesh *mesh, double from, double to)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    uint32_t i = 0;
    for (i = 2; i < 3u * mesh->n_vertices; i += 3u) {
        low = fmin(low, (double)mesh->xyz[i]);
        high = fmax(high, (double)mesh->xyz[i]);
    }
    keep_height(mesh, low + from * (high - low), low + to * (high - low));
}

/* The shaft alone, which slides. */
int case_change_middle(case_job *job, oracle_random *r)
{
    (void)r;
    keep_shares(target_of(job), 0.3, 0.7);
    return 1;
}

int case_change_sphere(case_job *job, oracle_random *r)
{
    static const float corner[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const uint32_t face[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                        {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    host_mesh ball = case_new_mesh(6, 8);
    const double radius = oracle_uniform(r, 30.0, 120.0);
    double to[3];
    uint32_t i = 0;
    int k = 0, c = 0;
    memcpy(ball.xyz, corner, sizeof corner);
    memcpy(ball.triangles, face, sizeof face);
    for (k = 0; k < 5; k++) {
        host_mesh fine = case_subdivide(&ball);
        host_mesh_free(&ball);
        ball = fine;
    }
    middle_of(target_of(job), to);
    for (i = 0; i < ball.n_vertices; i++) {
        float *const x = ball.xyz + 3u * (size_t)i;
        const double length = sqrt((double)(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]));
        for (c = 0; c < 3; c++)
            x[c] = (float)(radius * (double)x[c] / length + to[c]);
    }
    host_mesh_free(target_of(job));
    *target_of(job) = ball;
    return 0;
}

int case_change_flat(case_job *job, oracle_random *r)
{
    const double m[9] = {1, 0, 0, 0, oracle_uniform(r, 0.02, 0.3), 0, 0, 0, 1};
    double middle[3];
    middle_of(target_of(job), middle);
    apply(target_of(job), m, middle, middle);
    return 0;
}

/* The triangles fly apart: each is its own, some millimetres off. */
int case_change_soup(case_job *job, oracle_random *r)
{
    host_mesh *const mesh = target_of(job);
    host_mesh soup = case_new_mesh(3u * mesh->n_triangles, mesh->n_triangles);
    const double size = oracle_uniform(r, 5.0, 15.0);
    uint32_t i = 0;
    double d[3] = {0.0, 0.0, 0.0};
    int c = 0;
    for (i = 0; i < soup.n_vertices; i++) {
        if (i % 3u == 0)
            case_direction(r, d);
        for (c = 0; c < 3; c++)
            soup.xyz[3u * (size_t)i + (size_t)c] =
                mesh->xyz[3u * (size_t)mesh->triangles[i] + (size_t)c] + (float)(size * d[c]);
        soup.triangles[i] = i;
    }
    host_mesh_free(mesh);
    *mesh = soup;
    return 1;
}

/* Another person's femur as the target; there is no truth by vertex. */
static int change_person(case_job *job, oracle_random *r, double from, double to)
{
    case_body *const body = &job->data.body[0];
    const case_bone *bone = &case_bones[oracle_below(r, CASE_FEMURS)];
    const char *path = NULL;
    host_error error;
    if (strcmp(bone->name, job->bone) == 0)
        bone = &case_bones[(bone - case_bones + 1) % CASE_FEMURS];
    path = experiment_data("%s", bone->path);
    memset(&error, 0, sizeof error);
    host_mesh_free(&body->whole);
    host_mesh_free(&body->target);
    host_mesh_free(&body->truth);
    free(body->seen);
    body->seen = NULL;
    if (path == NULL || host_mesh_read(path, HOST_MESH_SURFACE, bone->right ? HOST_MIRROR_X : HOST_MIRROR_NONE,
                                       &body->whole, &error) != 0)
        return 0;
    body->target = case_copy(&body->whole);
    keep_shares(&body->target, from, to);
    job->data.overlap = case_area(&body->target) / case_area(&body->whole);
    return 1;
}

int case_change_person(case_job *job, oracle_random *r) { return change_person(job, r, 0.0, 1.0); }
int case_change_person_top(case_job *job, oracle_random *r) { return change_person(job, r, 0.3, 1.0); }
int case_change_person_low(case_job *job, oracle_random *r) { return change_person(job, r, 0.0, 0.5); }

/* Landmarks: six vertices of the model, and where they belong, some millimetres off. */
static void add_marks(case_job *job, oracle_random *r, double off, int swapped)
{
    host_landmarks *const set = case_alloc(2, sizeof *set);
    const case_body *const body = &job->data.body[0];
    const double shift[3] = {oracle_uniform(r, -1.0, 1.0), oracle_uniform(r, -1.0, 1.0), oracle_uniform(r, -1.0, 1.0)};
    const double length = sqrt(shift[0] * shift[0] + shift[1] * shift[1] + shift[2] * shift[2]);
    char path[2][CASE_TEXT];
    uint32_t k = 0, s = 0;
    int c = 0;
    set[0].n = set[1].n = 6;
    for (k = 0; k < 6u; k++) {
        const size_t from = oracle_below(r, body->model.n_vertices);
        for (s = 0; s < 2u; s++)
            (void)snprintf(set[s].label[k], sizeof set[s].label[k], "m%u", s == 1u && swapped ? (k + 3u) % 6u : k);
        for (c = 0; c < 3; c++) {
            set[0].xyz[k][c] = body->model.xyz[3u * from + (size_t)c];
            set[1].xyz[k][c] = body->truth.xyz[3u * from + (size_t)c] + (float)oracle_uniform(r, -2.0, 2.0) +
                               (float)(off * shift[c] / length);
        }
    }
    experiment_add(&job->words, "--landmarks");
    for (s = 0; s < 2u; s++) {
        (void)snprintf(path[s], sizeof path[s], "%s", experiment_scratch("marks%u.csv", s));
        (void)experiment_write_landmarks(path[s], &set[s]);
        experiment_add(&job->words, "%s", path[s]);
    }
    free(set);
}

int case_change_marks(case_job *job, oracle_random *r)
{
    add_marks(job, r, 0.0, 0);
    return 1;
}

int case_change_marks_swapped(case_job *job, oracle_random *r)
{
    add_marks(job, r, 0.0, 1);
    return 1;
}

int case_change_marks_off(case_job *job, oracle_random *r)
{
    add_marks(job, r, 90.0, 0);
    return 1;
}
