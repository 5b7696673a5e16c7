/* answers_calls.c: lines of calls beside registrations: starts, warps, carried points and frames, contact of surfaces,
 * searches, models of hardly regular meshes, a log and a save.
 * SPDX-License-Identifier: MIT */
#include "answers.h"

static void put_align(const smr_surface *from, const smr_surface *to, const smr_align_config *config)
{
    smr_align_report report;
    smr_pose pose;
    size_t bytes = 0;
    answers_need(smr_align_bytes(config, &bytes) == SMR_OK, "align bytes");
    if (!answers_put_status(smr_align(from, to, config, answers_room(bytes), bytes, &pose, &report)))
        return;
    answers_put(&pose, sizeof pose);
    answers_put(&report, sizeof report);
}

static void put_articulated(const smr_mesh *model, const smr_mesh *target)
{
    static const smr_pose here = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_surface *const a = answers_surface(model), *const b = answers_surface(target);
    float *const xyz = answers_room(12u * (size_t)model->n_vertices);
    uint32_t bent = 0;
    size_t bytes = 0;
    smr_job job;
    answers_need(smr_articulated_bytes(a, b, &bytes) == SMR_OK, "articulated bytes");
    answers_need(smr_articulated_begin(a, b, &here, NULL, answers_room(bytes), bytes, xyz, &bent, &job) == SMR_OK,
                 "articulated");
    (void)answers_put_status(smr_job_step(&job, 0, NULL, 0));
    answers_put(&bent, sizeof bent);
    answers_put(xyz, 12u * (size_t)model->n_vertices);
}

/* What lies above z = 215 turned about the y axis there, by the tangent of half the angle. */
static smr_mesh bent(const smr_mesh *mesh, float t)
{
    const smr_mesh m = answers_copy(mesh);
    const float c = (1.0f - t * t) / (1.0f + t * t), s = 2.0f * t / (1.0f + t * t);
    for (uint32_t v = 0; v < m.n_vertices; v++) {
        float *const p = (float *)(uintptr_t)m.xyz + 3u * v, x = p[0], z = p[2] - 215.0f;
        if (!(z > 0.0f))
            continue;
        p[0] = c * x + s * z;
        p[2] = 215.0f + c * z - s * x;
    }
    return m;
}

static void starts(const smr_mesh mesh[2])
{
    const smr_mesh away = answers_moved(&mesh[1], 0.7f, 1.1f, 40.0f), part = answers_cut(&away, 2, 200.0f),
                   side = answers_cut(&away, 1, 0.0f), knee = bent(&mesh[0], 0.4f), cut = answers_cut(&knee, 2, 60.0f);
    const smr_surface *const model = answers_surface(&mesh[0]), *const target = answers_surface(&away);
    smr_align_config config = smr_align_config_default();
    smr_pose pose;
    float rms;
    answers_begin("starts");
    config.samples = 300;
    config.iterations = 20;
    put_align(model, target, &config);
    answers_say("whole");
    config.scaled = 0;
    put_align(model, answers_surface(&part), &config);
    answers_say("end");
    put_align(model, answers_surface(&side), &config);
    answers_say("side");
    for (uint32_t scaled = 0; scaled < 2u; scaled++)
        if (answers_put_status(smr_align_landmarks(mesh[0].xyz, away.xyz, 9, scaled, &pose, &rms))) {
            answers_put(&pose, sizeof pose);
            answers_put(&rms, sizeof rms);
        }
    answers_say("landmarks");
    put_articulated(&mesh[0], &knee);
    put_articulated(&mesh[0], &cut);
    put_articulated(&mesh[0], &mesh[1]);
    answers_say("articulated");
    answers_end();
}

static void maps(const smr_mesh mesh[2])
{
    enum { LANDMARKS = 12, POINTS = 60 };
    const uint32_t n = mesh[0].n_vertices;
    const smr_mesh now = bent(&mesh[0], 0.1f);
    float *const points = answers_room(12u * POINTS), *const to = answers_room(12u * POINTS),
                 *const places = answers_room(12u * SMR_FRAME_PLACES * POINTS),
                 *const jacobians = answers_room(36u * POINTS);
    smr_carry_fact *const facts = answers_room(sizeof(smr_carry_fact[POINTS]));
    smr_pose *const poses = answers_room(sizeof(smr_pose[POINTS]));
    smr_carry *carry = NULL;
    smr_warp *warp = NULL;
    size_t bytes = 0;
    uint32_t kind;
    for (uint32_t i = 0; i < 3u * POINTS; i++)
        points[i] = mesh[0].xyz[3u * (i / 3u) * 7u + i % 3u] + (float)(i % 7u) * 2.5f - 7.5f;
    answers_begin("maps");
    for (uint32_t k = 1; k <= LANDMARKS; k += k < 5u ? 1u : 7u) { /* each kind of warp */
        answers_need(smr_warp_bytes(k, &bytes) == SMR_OK, "warp bytes");
        void *const memory = answers_room(bytes);
        for (uint32_t i = 0; i < 3u * POINTS; i++)
            to[i] = points[i];
        if (!answers_put_status(
                smr_warp_fit(points, now.xyz, k, k == LANDMARKS ? 3.0f : 0.0f, memory, bytes, &warp, &kind)))
            continue;
        answers_put(&kind, sizeof kind);
        (void)answers_put_status(smr_warp_apply(warp, to, POINTS));
        answers_put(to, 12u * POINTS);
    }
    answers_say("warps");
    answers_need(smr_carry_bytes(n, POINTS, 1, &bytes) == SMR_OK, "carry bytes");
    answers_need(smr_carry_fit(mesh[0].xyz, n, points, POINTS, NULL, answers_room(bytes), bytes, &carry) == SMR_OK,
                 "carry");
    (void)answers_put_status(smr_carry_apply(carry, now.xyz, to));
    answers_put(to, 12u * POINTS);
    answers_say("carried");
    for (uint32_t inverse = 0; inverse < 2u; inverse++) {
        (void)answers_put_status(smr_carry_map(carry, now.xyz, inverse, points, POINTS, to, facts));
        answers_put(to, 12u * POINTS);
        answers_put(facts, sizeof(smr_carry_fact[POINTS]));
    }
    answers_say("mapped");
    answers_need(smr_frame_places(points, POINTS / SMR_FRAME_PLACES, 4.0f, places) == SMR_OK, "frames");
    (void)answers_put_status(smr_carry_map(carry, now.xyz, 0, places, POINTS, to, NULL));
    (void)answers_put_status(smr_frame_poses(places, to, POINTS / SMR_FRAME_PLACES, poses, jacobians));
    answers_put(poses, sizeof(smr_pose[POINTS / SMR_FRAME_PLACES]));
    answers_put(jacobians, 36u * POINTS / SMR_FRAME_PLACES);
    (void)answers_put_status(smr_frame_normals(jacobians, points, POINTS / SMR_FRAME_PLACES));
    answers_put(points, 12u * POINTS / SMR_FRAME_PLACES);
    answers_say("frames");
    answers_end();
}

static void surfaces(const smr_mesh mesh[2])
{
    const smr_mesh beside = answers_moved(&mesh[0], 0.1f, 0.9f, 12.0f), open = answers_cut(&mesh[1], 0, 0.0f);
    const smr_surface *const a = answers_surface(&mesh[1]), *const b = answers_surface(&beside),
                             *const c = answers_surface(&open);
    const uint32_t n = mesh[0].n_vertices;
    float *const mm = answers_room(4u * (size_t)n);
    answers_begin("surfaces");
    for (uint32_t k = 0; k < 4u; k++) {
        smr_contact_report report;
        if (answers_put_status(smr_surface_contact(k == 1u ? b : a,
                                                   k == 1u   ? a
                                                   : k == 2u ? c
                                                             : b,
                                                   k == 3u ? 4.0f : 0.5f, &report)))
            answers_put(&report, sizeof report);
    }
    answers_say("contact");
    for (uint32_t k = 0; k < 2u; k++) {
        (void)answers_put_status(smr_surface_distances(k == 0u ? a : c, mesh[0].xyz, n, mm));
        answers_put(mm, 4u * (size_t)n);
    }
    answers_say("distances");
    answers_end();
}

/* Lone, doubled and flat parts, edges of three triangles; each way to prepare a model. */
static void models(const smr_mesh mesh[2])
{
    smr_mesh odd = answers_cut(&mesh[0], 2, 30.0f);
    uint32_t *const t = (uint32_t *)(uintptr_t)odd.triangles;
    for (uint32_t k = 0; k < 40u; k++) {
        t[3u * (13u * k)] = t[3u * (13u * k) + 1u];                    /* flat */
        t[3u * (13u * k + 5u) + 2u] = t[3u * (13u * k + 2u) + k % 3u]; /* of other neighbours */
    }
    const smr_structure parts[2] = {{"odd", odd}, {"whole", mesh[1]}};
    answers_begin("models of odd meshes");
    for (uint32_t k = 0; k < 5u; k++) {
        static const char *const name[] = {"default", "paper", "geodesic", "area", "radii"};
        smr_prepare_config config = k == 1u ? smr_prepare_config_paper() : smr_prepare_config_default();
        config.distance = k == 2u ? SMR_DISTANCE_GEODESIC : config.distance;
        config.order = k == 2u ? SMR_ORDER_BREADTH_FIRST : config.order;
        config.mass = k == 3u ? SMR_MASS_AREA : config.mass;
        config.ring = k != 3u;
        config.block_vertices = k == 4u ? 64u : 0u;
        config.n_radii = k == 4u ? 2u : config.n_radii;
        config.radius_mm[0] = k == 4u ? 70.0f : config.radius_mm[0];
        config.radius_mm[1] = k == 4u ? 20.0f : config.radius_mm[1];
        config.separate_below_mm = k == 4u ? 0.0f : config.separate_below_mm;
        (void)answers_model(parts, 2, &config);
        answers_say(name[k]);
    }
    answers_end();
}

/* A log of a tracked cloud that grows, and a save within. */
static void records(const smr_mesh mesh[2])
{
    enum { ROOM = 60000 };
    smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    const smr_structure one = {"bone", mesh[0]};
    unsigned char *const log = answers_room(ROOM), *const saved = answers_room(4u * ROOM);
    smr_log_state state;
    size_t bytes = 0;
    config.basic.n_target_vertices = 2000;
    config.track.mode = SMR_TRACK_RECOVER;
    answers_begin("records");
    const smr_model *const model = answers_model(&one, 1, &prepare);
    answers_say("model");
    smr *const s = answers_init(model, &config);
    smr_points *const points = answers_points(&mesh[1], 1, 0);
    answers_need(smr_set_log(s, log, ROOM) == SMR_OK && smr_set_points(s, SMR_ALL, points) == SMR_OK, "log");
    for (uint32_t tick = 0; tick < 12u; tick++) {
        answers_need(smr_points_add(points, mesh[1].xyz + 90u * tick, NULL, NULL, 30) == SMR_OK, "add");
        answers_need(smr_set_points(s, SMR_ALL, points) == SMR_OK && smr_tick(s, 0, NULL) == SMR_OK, "tick");
    }
    answers_need(smr_get_log(s, &state) == SMR_OK, "log");
    answers_put_bytes(log, state.bytes);
    answers_say("log");
    answers_need(smr_save_bytes(s, &bytes) == SMR_OK && bytes <= 4u * ROOM, "save bytes");
    answers_need(smr_save(s, saved, bytes) == SMR_OK, "save");
    answers_put_bytes(saved, bytes);
    answers_say("save");
    answers_end();
}

void answers_calls(const smr_mesh bone[2], int all)
{
    maps(bone);
    surfaces(bone);
    records(bone);
    if (!all)
        return;
    models(bone);
    starts(bone);
}
