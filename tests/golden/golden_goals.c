/* golden_goals.c: golden runs onto targets that move, grow, or are the caller's own goals, and points carried along.
 * SPDX-License-Identifier: MIT */
#include "golden.h"
#include <math.h>
#include <string.h>

/* The target turned about the z axis, by the tangent of half the angle, and shifted. */
static void golden_move(const smr_mesh *mesh, float t, float shift, float *xyz)
{
    const float c = (1.0f - t * t) / (1.0f + t * t), s = 2.0f * t / (1.0f + t * t);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        const float *const p = mesh->xyz + 3u * i;
        xyz[3u * i] = c * p[0] - s * p[1] + shift;
        xyz[3u * i + 1u] = s * p[0] + c * p[1];
        xyz[3u * i + 2u] = p[2];
    }
}

/* A target that moves, the same surface refitted in pieces, and at last jumps. */
int golden_track(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash)
{
    static const float turn[] = {0.0f, 0.02f, 0.05f, 0.15f}, shift[] = {0.0f, 1.0f, 3.0f, 28.0f};
    smr_config config = smr_config_default();
    smr_tick_report report = {0};
    smr_surface *target = NULL;
    smr *s = NULL;
    config.basic.n_workers = GOLDEN_WORKERS;
    config.basic.n_target_vertices = 1024;
    config.track.mode = SMR_TRACK_RECOVER;
    config.basic.iterations = 4;
    config.basic.iterations_last = 8;
    if (!golden_ok("moving", smr_surface_build(mesh, golden_target, sizeof golden_target, &target)) ||
        !golden_ok("track", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)))
        return 0;
    for (uint32_t i = 0; i < 4u; i++) {
        smr_status status = SMR_PARTIAL;
        golden_move(mesh, turn[i], shift[i], golden_words);
        if (!golden_ok("refit", smr_surface_refit(target, golden_words)))
            return 0;
        while (status == SMR_PARTIAL)
            status = smr_surface_step(target, 3, NULL, 0);
        if (!golden_ok("refitted", status) || !golden_ok("moved", smr_set_surface(s, SMR_ALL, target)))
            return 0;
        for (uint32_t tick = 0; tick < 30u; tick++)
            if (!golden_ok("tracking tick", smr_tick(s, 0, &report)))
                return 0;
    }
    *hash = smr_state_hash(s);
    return golden_ok("jump", report.details.tracking && report.details.jumped ? SMR_OK : SMR_E_STATE);
}

/* Onto a cloud of 600 points at most that grows by vertices of the target: in every other tick with normals, which are
 * about right. The first ones are forgotten. */
int golden_points(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash)
{
    smr_config config = smr_config_default();
    smr_points *points = NULL;
    smr *s = NULL;
    config.basic.n_workers = GOLDEN_WORKERS;
    config.basic.n_target_vertices = 600;
    config.basic.iterations = 4;
    if (!golden_ok("points", smr_points_open(600, golden_target, sizeof golden_target, &points)) ||
        !golden_ok("init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)))
        return 0;
    for (uint32_t tick = 0; tick < GOLDEN_TICKS; tick++) {
        const uint32_t n = mesh->n_vertices / GOLDEN_TICKS;
        const float *xyz = mesh->xyz + 3u * (size_t)(tick * n);
        if (!golden_ok("add", smr_points_add(points, xyz, tick % 2u ? xyz : NULL, NULL, n)) ||
            !golden_ok("set points", smr_set_points(s, SMR_ALL, points)) || !golden_ok("tick", smr_tick(s, 0, NULL)))
            return 0;
    }
    *hash = smr_state_hash(s);
    return 1;
}

/* Springs up to a plane, for the vertices of the lower half. */
static void golden_force(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    const float *plane = ctx;
    for (uint32_t i = 0; i < view->n; i++) {
        if (view->rest[3u * i + 2u] > *plane || view->vertex[i] % 3u != 0u)
            continue;
        way[3u * i + 2u] += 0.25f * (*plane - view->xyz[3u * i + 2u]) * view->normal[3u * i + 2u];
        weight[i] += 0.5f;
    }
}

/* Landmarks, one of them hard and one off the surface, goals for every other vertex, and a force, beside the target. */
int golden_drawn(const smr_model *model, const smr_mesh *mesh, const smr_surface *target, const smr_port *port,
                 uint64_t *hash)
{
    const float *p = mesh->xyz;
    const smr_landmark mark[3] = {{0, 7, {0, 0, 0}, {p[21] + 3.0f, p[22] + 2.0f, p[23]}, 1.0f, 0},
                                  {0, SMR_NONE, {p[90], p[91], p[92]}, {p[90] - 2.0f, p[91], p[92] + 4.0f}, 1.0f, 1},
                                  {SMR_ALL, SMR_NONE, {p[0], p[1], p[2] + 9.0f}, {p[0], p[1], p[2] + 12.0f}, 0.5f, 0}};
    smr_config config = smr_config_default();
    smr_tick_report report;
    float plane = 0.0f;
    smr *s = NULL;
    config.basic.n_workers = GOLDEN_WORKERS;
    config.basic.n_target_vertices = 1024;
    config.partial.n_landmarks = 3;
    config.caller.goals = 1;
    config.caller.force = SMR_CALLER_CHECKED;
    config.basic.iterations = 6;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) /* weights, with the target's own goals */
        golden_words[i] = i % 2u != 0u ? 0.25f : 0.0f;
    if (!golden_ok("drawn init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)) ||
        !golden_ok("drawn surface", smr_set_surface(s, SMR_ALL, target)) ||
        !golden_ok("landmarks", smr_set_landmarks(s, mark, 3)) ||
        !golden_ok("goals", smr_set_goals(s, 0, mesh->xyz, golden_words)) ||
        !golden_ok("force", smr_set_force(s, golden_force, &plane)))
        return 0;
    for (uint32_t tick = 0; tick < GOLDEN_TICKS; tick++)
        if (!golden_ok("drawn tick", smr_tick(s, 0, &report)))
            return 0;
    *hash = smr_state_hash(s);
    return 1;
}

/* The rest shape twisted: what lies above the middle is drawn to turn by 77 degrees. Clusters are fused by logarithms,
 * by both methods, elastic and plastic. */
int golden_fused(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash)
{
    *hash = 0;
    golden_move(mesh, 0.8f, 0.0f, golden_words);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        if (mesh->xyz[3u * i + 2u] < 0.0f)
            memcpy(golden_words + 3u * i, mesh->xyz + 3u * i, 3u * sizeof(float));
    for (uint32_t k = 0; k < 4u; k++) {
        smr_config config = smr_config_default();
        smr *s = NULL;
        config.basic.n_workers = GOLDEN_WORKERS;
        config.basic.method = k % 2u;
        config.motion.fusing = SMR_FUSING_LIE;
        config.motion.plastic_every = k / 2u;
        config.caller.goals = 1;
        config.basic.iterations = 4;
        if (!golden_ok("fused init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)) ||
            !golden_ok("fused goals", smr_set_goals(s, 0, golden_words, NULL)))
            return 0;
        for (uint32_t tick = 0; tick < 12u; tick++)
            if (!golden_ok("fused tick", smr_tick(s, 0, NULL)))
                return 0;
        *hash = *hash * 3u + smr_state_hash(s);
    }
    return 1;
}

/* Onto the target with a tenth more volume than at rest, and less from the middle on, smoothed. */
int golden_kept(const smr_model *model, const smr_surface *target, const smr_port *port, uint64_t *hash)
{
    smr_config config = smr_config_default();
    smr_structure_volume volume;
    smr *s = NULL;
    config.basic.n_workers = GOLDEN_WORKERS;
    config.basic.n_target_vertices = 1024;
    config.contact.volume = 1.0f;
    config.contact.smooth = 0.3f;
    config.basic.iterations = 8;
    if (!golden_ok("volume init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)) ||
        !golden_ok("volume surface", smr_set_surface(s, SMR_ALL, target)))
        return 0;
    for (uint32_t tick = 0; tick < GOLDEN_TICKS; tick++)
        if ((tick % 20u == 0u && !golden_ok("ratio", smr_set_volume_ratio(s, 0, tick == 0u ? 1.1f : 0.95f))) ||
            !golden_ok("volume tick", smr_tick(s, 0, NULL)))
            return 0;
    *hash = smr_state_hash(s);
    return golden_ok("volume", smr_get_structure_volume(s, 0, &volume)) &&
           golden_ok("ratio reached", volume.ratio > 0.94f && volume.ratio < 0.96f ? SMR_OK : SMR_E_STATE);
}

/* The bone swings in time, by both methods: pinned at one end, thrown, drawn to goals in between. */
int golden_dynamics(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash)
{
    const uint32_t n = mesh->n_vertices;
    float *const mass = golden_words, *const speed = mass + n, *const goal = speed + 3u * n;
    *hash = 0;
    golden_move(mesh, 0.05f, 2.0f, goal);
    for (uint32_t i = 0; i < n; i++) {
        mass[i] = mesh->xyz[3u * i + 2u] < 15.0f ? INFINITY : 0.5f + 0.25f * (float)(i % 5u);
        for (uint32_t c = 0; c < 3u; c++)
            speed[3u * i + c] = mass[i] < 9.0f && c == 0u ? mesh->xyz[3u * i + 2u] : 0.0f;
    }
    for (uint32_t k = 0; k < 2u; k++) {
        smr_config config = smr_config_default();
        smr *s = NULL;
        config.basic.n_workers = GOLDEN_WORKERS;
        config.basic.method = k;
        config.dynamics.mode = SMR_DYNAMICS_ON;
        config.dynamics.gravity[1] = -9810.0f;
        config.caller.goals = 1;
        if (!golden_ok("dynamics init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)) ||
            !golden_ok("motion", smr_set_motion(s, 0, mass, speed)))
            return 0;
        for (uint32_t tick = 0; tick < 5u * SMR_SWEEPS; tick++)
            if ((tick == 12u && !golden_ok("springs", smr_set_goals(s, 0, goal, NULL))) ||
                !golden_ok("dynamics tick", smr_tick(s, 0, NULL)))
                return 0;
        if (!golden_ok("speed", smr_get_velocities(s, 0, goal)))
            return 0;
        *hash = *hash * 3u + smr_state_hash(s) + golden_crc_words(goal, 3u * (size_t)n);
        golden_move(mesh, 0.05f, 2.0f, goal);
    }
    return 1;
}

/* Points beside the rest shape's vertices, carried to where s has the bone, and back. */
#define GOLDEN_CARRIED 192u
int golden_carry(const smr *s, const smr_mesh *rest, const smr_port *port, uint32_t *crc)
{
    static float xyz[2][3u * GOLDEN_CARRIED];
    smr_carry *carry = NULL;
    for (uint32_t i = 0; i < 3u * GOLDEN_CARRIED; i++)
        xyz[0][i] = rest->xyz[i] + (float)(i % 7u) * 2.5f - 7.5f;
    if (!golden_ok("now", smr_get_positions(s, 0, golden_words)) ||
        !golden_ok("carry fit", smr_carry_fit(rest->xyz, rest->n_vertices, xyz[0], GOLDEN_CARRIED, port, golden_scratch,
                                              sizeof golden_scratch, &carry)) ||
        !golden_ok("carry", smr_carry_apply(carry, golden_words, xyz[0])) ||
        !golden_ok("carry back", smr_carry_map(carry, golden_words, 1, xyz[0], GOLDEN_CARRIED, xyz[1], NULL)))
        return 0;
    *crc = golden_crc_words(xyz, sizeof xyz / sizeof(float));
    return 1;
}

/* Onto the target, but never into the fixed surface, which is where the model began. */
int golden_contact(const smr_model *model, const smr_surface *target, const smr_surface *fixed, const smr_port *port,
                   uint64_t *hash)
{
    smr_config config = smr_config_default();
    smr_tick_report report = {0};
    smr *s = NULL;
    config.basic.n_workers = GOLDEN_WORKERS;
    config.basic.n_target_vertices = 1024;
    config.contact.share = 1.0f;
    config.contact.gap_mm = 0.25f;
    config.contact.n_fixed = 2;
    config.basic.iterations = 6;
    config.basic.iterations_last = 16;
    if (!golden_ok("contact init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)) ||
        !golden_ok("contact surface", smr_set_surface(s, SMR_ALL, target)) ||
        !golden_ok("fixed", smr_set_fixed(s, 1, fixed)))
        return 0;
    while (!report.done)
        if (!golden_ok("contact tick", smr_tick(s, 0, &report)))
            return 0;
    *hash = smr_state_hash(s);
    return 1;
}
