/* target_calls.c: on an emulated board: what each call that depends on the model's size takes, in instructions: calls
 * that pass over arrays or visit points, by their elements; of calls in pieces, of ticks and of surfaces the longest
 * piece.
 *
 * Under `-icount shift=0` an instruction takes a nanosecond of the board's time. Reads source.smr and target.smr from
 * the emulator's folder. Prints rows "kind; call; element; number of elements; instructions;
 * stage or step of the longest piece".
 * SPDX-License-Identifier: MIT */
#include "base/job.h"
#include "target_rig.h"
#include "smr_semihost.h"

#define TARGET_ENDLESS (UINT64_MAX / 4u) /* a budget that never ends, but the clock is read */
#define TARGET_MANY 25000u               /* vertices at most */
#define TARGET_TICKS 3u
#define TARGET_FEW 64u /* points of calls that search for each */
#define TARGET_MARKS 8u
#define TARGET_WARPED 24u

#define TARGET_STORE static __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
TARGET_STORE unsigned char target_file[2][16u << 20];
TARGET_STORE unsigned char target_memory[80u << 20]; /* handed out piece by piece */
TARGET_STORE float target_xyz[3][3u * TARGET_MANY];  /* the target; its moved copy; the model */
TARGET_STORE uint32_t target_triangles[2][6u * TARGET_MANY];
TARGET_STORE float target_out[15u * TARGET_MANY];

TARGET_STORE smr_pose target_poses[TARGET_MANY];

static target_clock target_time;
static struct {
    const smr_model *model, *of;
    smr_mesh goal, rest;
    smr_surface *surface, *moved, *bent, *cloud_surface;
    smr_points *points;
    smr_carry *carry;
    smr_warp *warp;
    smr *s;
    size_t used, saved_bytes;
    void *saved;
    smr_job job;
    smr_landmark mark[TARGET_MARKS];
    uint32_t is_bent, is_tracked;
} in;

static void *target_take(size_t bytes)
{
    void *at = target_memory + in.used;
    in.used += (bytes + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    return in.used <= sizeof target_memory ? at : NULL;
}

enum { TARGET_RESTS, TARGET_MOVES, TARGET_TRACKS };

static smr_config target_calls_config(uint32_t mode)
{
    const int moves = mode == TARGET_MOVES;
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = moves ? 0u : 2u * TARGET_MANY;
    if (mode == TARGET_TRACKS) { /* after one iteration */
        config.track.mode = SMR_TRACK_RECOVER;
        config.basic.iterations_last = 1;
        config.schedule.radius_first = config.schedule.radius_last = 1;
    }
    config.partial.n_landmarks = TARGET_MARKS;
    config.contact.n_fixed = 1;
    config.contact.share = config.contact.volume = moves ? 0.0f : 1.0f;
    config.caller.goals = 1;
    config.dynamics.mode = moves ? SMR_DYNAMICS_ON : SMR_DYNAMICS_OFF;
    if (moves)
        config.basic.attraction = 0.0f;
    return config;
}

static smr_status target_init(uint32_t mode)
{
    const smr_port port = {&target_time, 1u, NULL, target_now};
    const smr_config config = target_calls_config(mode);
    size_t bytes = 0;
    (void)smr_arena_bytes(in.model, &config, &bytes);
    return smr_init_begin(in.model, &config, &port, target_take(bytes), bytes, &in.s, &in.job);
}

/* ---- calls that run whole ---- */

#define TARGET_CALL(name, call)                                                                                        \
    static smr_status target_##name(void) { return call; }

TARGET_CALL(open, smr_model_open_begin(in.of, sizeof target_file[0], &in.of, &in.job))
TARGET_CALL(mesh, smr_model_mesh(in.model, 0, target_xyz[2], target_triangles[1]))
TARGET_CALL(start_one, target_init(TARGET_RESTS))
TARGET_CALL(surface, smr_set_surface(in.s, SMR_ALL, in.surface))
TARGET_CALL(fixed, smr_set_fixed(in.s, 0, in.moved))
TARGET_CALL(set_pose, smr_set_pose_begin(in.s, &target_poses[0], &in.job))
TARGET_CALL(positions, smr_set_positions_begin(in.s, 0, target_xyz[2], &in.job))
TARGET_CALL(marks, smr_set_landmarks(in.s, in.mark, TARGET_MARKS))
TARGET_CALL(goals, smr_set_goals(in.s, 0, target_xyz[2], NULL))
TARGET_CALL(ratio, smr_set_volume_ratio(in.s, 0, 1.0f))
TARGET_CALL(get, smr_get_positions(in.s, 0, target_out))
TARGET_CALL(normals, smr_get_normals(in.s, 0, target_out))
TARGET_CALL(visible, smr_get_visible(in.s, 0, (unsigned char *)(void *)target_out))
TARGET_CALL(report, smr_get_structure_report(in.s, 0, (smr_structure_report *)(void *)target_out))
TARGET_CALL(volume, smr_get_structure_volume(in.s, 0, (smr_structure_volume *)(void *)target_out))
TARGET_CALL(pose_of, smr_get_pose(in.s, 0, &target_poses[1], target_out))
TARGET_CALL(hash, smr_state_hash(in.s) != 0u ? SMR_OK : SMR_E_STATE)
static smr_status target_weights(void)
{
    uint32_t n;
    return smr_get_reference_weights(in.s, target_out, &n);
}
TARGET_CALL(get_marks, smr_get_landmarks(in.s, target_out))
TARGET_CALL(save_bytes, smr_save_bytes(in.s, &in.saved_bytes))
static smr_status target_save(void)
{
    in.saved = target_take(in.saved_bytes);
    return smr_save_begin(in.s, in.saved, in.saved_bytes, &in.job);
}
static smr_status target_restore(void)
{
    const smr_port port = {&target_time, 1u, NULL, target_now};
    const smr_config config = target_calls_config(0);
    const size_t before = in.used;
    size_t bytes = 0;
    static smr *s;
    const smr_status status = smr_arena_bytes(in.model, &config, &bytes);
    void *const arena = target_take(bytes);
    in.used = before;
    return status == SMR_OK && arena != NULL
               ? smr_restore_begin(in.model, NULL, &port, in.saved, in.saved_bytes, arena, bytes, &s, &in.job)
               : SMR_E_ARENA;
}
TARGET_CALL(scrub_on, smr_set_scrub_begin(in.s, SMR_SCRUB_INPUTS, &in.job))
static smr_status target_closest(void)
{
    smr_closest hit;
    return smr_surface_closest(in.surface, target_xyz[2], NULL, 0.0f, 1000.0f, &hit);
}
TARGET_CALL(distances, smr_surface_distances(in.surface, target_xyz[2], in.rest.n_vertices, target_out))
static smr_status target_points_open(void)
{
    size_t bytes = 0;
    const smr_status status = smr_points_bytes(in.goal.n_vertices, &bytes);
    return status != SMR_OK ? status : smr_points_open(in.goal.n_vertices, target_take(bytes), bytes, &in.points);
}
TARGET_CALL(points_add, smr_points_add(in.points, target_xyz[0], NULL, NULL, in.goal.n_vertices))
TARGET_CALL(weigh, smr_points_weigh(in.points, 0, 0.5f))
TARGET_CALL(clear, smr_points_clear(in.points))
TARGET_CALL(set_points, smr_set_points(in.s, SMR_ALL, in.points))
TARGET_CALL(apply, smr_carry_apply(in.carry, target_xyz[2], target_out))
TARGET_CALL(map, smr_carry_map(in.carry, target_xyz[2], 0, target_xyz[2], TARGET_FEW, target_out, NULL))
TARGET_CALL(inverse, smr_carry_map(in.carry, target_xyz[2], 1, target_xyz[2], TARGET_FEW, target_out, NULL))
TARGET_CALL(places, smr_frame_places(target_xyz[2], in.rest.n_vertices, 1.0f, target_out))
TARGET_CALL(frames, smr_frame_poses(target_out, target_out, in.rest.n_vertices, target_poses, NULL))
static smr_status target_warp_fit(void)
{
    uint32_t kind;
    size_t bytes = 0;
    (void)smr_warp_bytes(TARGET_WARPED, &bytes);
    return smr_warp_fit(target_xyz[2], target_xyz[0], TARGET_WARPED, 0.1f, target_take(bytes), bytes, &in.warp, &kind);
}
TARGET_CALL(warp, smr_warp_apply(in.warp, target_xyz[1], in.goal.n_vertices))
TARGET_CALL(moves, target_init(TARGET_MOVES))
static smr_status target_tracks(void)
{
    const smr_status status = smr_job_whole(target_init(TARGET_TRACKS), &in.job, NULL);
    return status == SMR_OK ? target_surface() : status;
}
TARGET_CALL(motion, smr_set_motion(in.s, 0, NULL, target_xyz[2]))
TARGET_CALL(velocities, smr_get_velocities(in.s, 0, target_out))
TARGET_CALL(energy, smr_get_energy(in.s, (smr_energy *)(void *)target_out))
static smr_status target_prepare(void)
{
    const smr_structure one = {"bone", in.rest};
    smr_prepare_config config = smr_prepare_config_default();
    size_t scratch = 0, bytes = 0;
    in.used = 0;
    const smr_status status = smr_prepare_bytes(&one, 1, &config, &scratch);
    void *const memory = target_take(scratch);
    return status == SMR_OK && memory != NULL
               ? smr_prepare(&one, 1, &config, memory, scratch, target_file[1], sizeof target_file[1], &bytes)
               : SMR_E_ARENA;
}

/* ---- calls in pieces ---- */

static smr_status target_build(void)
{
    size_t bytes = 0;
    const smr_status status = smr_surface_bytes(in.goal.n_vertices, in.goal.n_triangles, &bytes);
    return status != SMR_OK ? status : smr_surface_begin(&in.goal, target_take(bytes), bytes, &in.surface);
}
static smr_status target_build_of(const float *xyz, smr_surface **surface)
{
    size_t bytes = 0;
    const smr_mesh mesh = {xyz, target_triangles[0], in.goal.n_vertices, in.goal.n_triangles};
    const smr_status status = smr_surface_bytes(mesh.n_vertices, mesh.n_triangles, &bytes);
    return status != SMR_OK ? status : smr_surface_build(&mesh, target_take(bytes), bytes, surface);
}
TARGET_CALL(build_moved, target_build_of(target_xyz[1], &in.moved))
TARGET_CALL(refit, smr_surface_refit(in.surface, target_xyz[0]))
static smr_status target_copy_points(void)
{
    size_t bytes = 0;
    (void)smr_points_surface_bytes(in.goal.n_vertices, &bytes);
    return smr_points_surface_begin(in.points, target_take(bytes), bytes, &in.cloud_surface);
}
TARGET_CALL(verdict, smr_verdict_begin(in.s, SMR_ALL, (smr_verdict *)(void *)target_out, &in.job))
TARGET_CALL(expected, smr_expected_begin(in.s, 0, target_out, NULL, NULL, &in.job))
TARGET_CALL(local, smr_local_volume_begin(in.s, 0, 0, target_out, &in.job))
static smr_status target_contact(void)
{
    return smr_surface_contact_begin(in.surface, in.moved, 0.5f, (smr_contact_report *)(void *)target_out, &in.job);
}
static smr_status target_align(void)
{
    const smr_align_config config = smr_align_config_default();
    size_t bytes = 0;
    (void)smr_align_bytes(&config, &bytes);
    return smr_align_begin(in.surface, in.moved, &config, target_take(bytes), bytes, &target_poses[1], NULL, &in.job);
}
static smr_status target_bend(void)
{
    size_t bytes = 0;
    (void)smr_articulated_bytes(in.surface, in.bent, &bytes);
    return smr_articulated_begin(in.surface, in.bent, &target_poses[0], NULL, target_take(bytes), bytes, target_out,
                                 &in.is_bent, &in.job);
}
static smr_status target_bind(void)
{
    size_t bytes = 0;
    (void)smr_carry_bytes(in.rest.n_vertices, TARGET_FEW, 1, &bytes);
    return smr_carry_fit_begin(target_xyz[2], in.rest.n_vertices, target_xyz[0], TARGET_FEW, NULL, target_take(bytes),
                               bytes, &in.carry, &in.job);
}

/* ---- the table ---- */

enum { TARGET_WHOLE, TARGET_JOB, TARGET_SURFACE, TARGET_CLOUD, TARGET_TICK, TARGET_SCRUB };
enum { TARGET_ONE, TARGET_VERTEX, TARGET_GOAL_VERTEX, TARGET_POINT, TARGET_MARK };

static const struct {
    const char *name;
    smr_status (*run)(void); /* a whole call, or the begin of one in pieces */
    uint32_t kind, per;
} target_calls[] = {
    {"smr_model_open_begin", target_open, TARGET_JOB, TARGET_GOAL_VERTEX},
    {"smr_model_mesh", target_mesh, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_surface_begin", target_build, TARGET_SURFACE, TARGET_GOAL_VERTEX},
    {"smr_surface_build", target_build_moved, TARGET_WHOLE, TARGET_GOAL_VERTEX},
    {"smr_surface_refit", target_refit, TARGET_SURFACE, TARGET_GOAL_VERTEX},
    {"smr_surface_closest", target_closest, TARGET_WHOLE, TARGET_ONE},
    {"smr_surface_distances", target_distances, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_init_begin", target_start_one, TARGET_JOB, TARGET_VERTEX},
    {"smr_set_surface", target_surface, TARGET_WHOLE, TARGET_GOAL_VERTEX},
    {"smr_set_fixed", target_fixed, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_set_pose_begin", target_set_pose, TARGET_JOB, TARGET_VERTEX},
    {"smr_set_positions_begin", target_positions, TARGET_JOB, TARGET_VERTEX},
    {"smr_set_landmarks", target_marks, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_set_volume_ratio", target_ratio, TARGET_WHOLE, TARGET_ONE},
    {"smr_tick", NULL, TARGET_TICK, TARGET_VERTEX},
    {"smr_get_positions", target_get, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_normals", target_normals, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_visible", target_visible, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_structure_report", target_report, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_structure_volume", target_volume, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_pose", target_pose_of, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_reference_weights", target_weights, TARGET_WHOLE, TARGET_ONE},
    {"smr_get_landmarks", target_get_marks, TARGET_WHOLE, TARGET_MARK},
    {"smr_state_hash", target_hash, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_verdict_begin", target_verdict, TARGET_JOB, TARGET_VERTEX},
    {"smr_local_volume_begin", target_local, TARGET_JOB, TARGET_VERTEX},
    {"smr_expected_begin", target_expected, TARGET_JOB, TARGET_VERTEX}, /* a verdict just before would leave them */
    {"smr_save_bytes", target_save_bytes, TARGET_WHOLE, TARGET_ONE},
    {"smr_save_begin", target_save, TARGET_JOB, TARGET_VERTEX},
    {"smr_restore_begin", target_restore, TARGET_JOB, TARGET_VERTEX},
    {"smr_set_goals", target_goals, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_set_scrub_begin", target_scrub_on, TARGET_JOB, TARGET_VERTEX},
    {"smr_scrub", NULL, TARGET_SCRUB, TARGET_VERTEX},
    {"smr_align_begin", target_align, TARGET_JOB, TARGET_VERTEX},
    {"smr_articulated_begin", target_bend, TARGET_JOB, TARGET_GOAL_VERTEX},
    {"smr_surface_contact_begin", target_contact, TARGET_JOB, TARGET_VERTEX},
    {"smr_points_open", target_points_open, TARGET_WHOLE, TARGET_GOAL_VERTEX},
    {"smr_points_add", target_points_add, TARGET_WHOLE, TARGET_GOAL_VERTEX},
    {"smr_points_weigh", target_weigh, TARGET_WHOLE, TARGET_ONE},
    {"smr_points_surface_begin", target_copy_points, TARGET_CLOUD, TARGET_GOAL_VERTEX},
    {"smr_set_points", target_set_points, TARGET_WHOLE, TARGET_GOAL_VERTEX},
    {"smr_points_clear", target_clear, TARGET_WHOLE, TARGET_GOAL_VERTEX},
    {"smr_carry_fit_begin", target_bind, TARGET_JOB, TARGET_VERTEX},
    {"smr_carry_apply", target_apply, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_carry_map", target_map, TARGET_WHOLE, TARGET_POINT},
    {"smr_carry_map, inverse", target_inverse, TARGET_WHOLE, TARGET_POINT},
    {"smr_frame_places", target_places, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_frame_poses", target_frames, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_warp_fit, 24 pairs", target_warp_fit, TARGET_WHOLE, TARGET_ONE},
    {"smr_warp_apply", target_warp, TARGET_WHOLE, TARGET_GOAL_VERTEX},
    {"smr_init, tracking", target_tracks, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_tick, tracking", NULL, TARGET_TICK, TARGET_VERTEX}, /* the schedule's last iteration and tracking's first */
    {"smr_init_begin, dynamics", target_moves, TARGET_JOB, TARGET_VERTEX},
    {"smr_set_motion", target_motion, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_velocities", target_velocities, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_get_energy", target_energy, TARGET_WHOLE, TARGET_VERTEX},
    {"smr_prepare", target_prepare, TARGET_WHOLE, TARGET_VERTEX},
};

/* The next piece of a call. */
static smr_status target_piece(uint32_t kind)
{
    static uint32_t ticks;
    smr_tick_report report;
    switch (kind) {
    case TARGET_JOB: return smr_job_step(&in.job, 1, NULL, 0);
    case TARGET_SURFACE: return smr_surface_step(in.surface, 1, NULL, 0);
    case TARGET_CLOUD: return smr_surface_step(in.cloud_surface, 1, NULL, 0);
    case TARGET_SCRUB: return smr_scrub(in.s, 1);
    default: break;
    }
    const smr_status status = smr_tick(in.s, 1, &report); /* one chunk, and checks before and after */
    ticks += status == SMR_OK ? 1u : 0u;
    in.is_tracked |= report.details.tracking;
    return status < 0 || (status == SMR_OK && ticks % TARGET_TICKS == 0u) ? status : SMR_PARTIAL;
}

/* The stage of a job, or the step of a tick, that runs next. */
static uint32_t target_place(uint32_t kind)
{
    const void *const job = &in.job;
    return kind == TARGET_JOB ? ((const smr_job_head *)job)->stage : kind == TARGET_TICK ? in.s->step : 0u;
}

static smr_status target_measure(uint32_t i, uint64_t *longest, uint32_t *place)
{
    smr_status status = SMR_PARTIAL;
    uint64_t begin = target_now(&target_time);
    if (target_calls[i].run != NULL)
        status = target_calls[i].run();
    *longest = target_now(&target_time) - begin;
    if (target_calls[i].kind == TARGET_WHOLE || status < 0)
        return status;
    for (status = SMR_PARTIAL; status == SMR_PARTIAL;) {
        const uint32_t next = target_place(target_calls[i].kind);
        begin = target_now(&target_time);
        status = target_piece(target_calls[i].kind);
        const uint64_t time = target_now(&target_time) - begin;
        *place = time > *longest ? next : *place;
        *longest = time > *longest ? time : *longest;
    }
    return status;
}

static int target_row(uint32_t i)
{
    static const char *const names[] = {"call", "vertex", "target's vertex", "point", "landmark"};
    const uint32_t counts[] = {1, in.rest.n_vertices, in.goal.n_vertices, TARGET_FEW, TARGET_MARKS};
    uint64_t time = 0;
    uint32_t place = 0;
    const smr_status status = target_measure(i, &time, &place);
    target_text(target_calls[i].kind == TARGET_WHOLE ? "whole; " : "piece; ");
    target_text(target_calls[i].name);
    target_text("; ");
    target_text(names[target_calls[i].per]);
    target_text("; ");
    target_number(counts[target_calls[i].per]);
    target_text("; ");
    target_number(time);
    target_line("; ", place);
    return target_ok(smr_status_name(status), status == SMR_OK);
}

static int target_load(const char *name, unsigned char *memory, const smr_model **model, smr_mesh *mesh)
{
    smr_model_info info;
    const size_t bytes = smr_semihost_read_file(name, memory, sizeof target_file[0]);
    if (!target_ok(name, bytes > 0u && smr_model_open(memory, bytes, model) == SMR_OK &&
                             smr_model_get_info(*model, &info) == SMR_OK && info.n_vertices <= TARGET_MANY))
        return 0;
    mesh->n_vertices = info.n_vertices;
    mesh->n_triangles = info.n_triangles;
    return 1;
}

static int target_begin(void)
{
    if (!target_load("source.smr", target_file[0], &in.model, &in.rest) ||
        !target_load("target.smr", target_file[1], &in.of, &in.goal) ||
        !target_ok("mesh", smr_model_mesh(in.of, 0, target_xyz[0], target_triangles[0]) == SMR_OK))
        return 0;
    in.goal.xyz = target_xyz[0];
    in.goal.triangles = target_triangles[0];
    in.rest.xyz = target_xyz[2];
    in.rest.triangles = target_triangles[1];
    for (uint32_t i = 0; i < 3u * in.goal.n_vertices; i++) {
        static const float aside[3] = {4.0f, 0.0f, 0.0f}, leans[3] = {0.8f, 0.0f, -0.4f}; /* the bone's upper half */
        target_xyz[1][i] = target_xyz[0][i] + aside[i % 3u];
        target_out[i] = target_xyz[0][i] + leans[i % 3u] * smr_positive(target_xyz[0][i - i % 3u + 2u] - 215.0f);
    }
    for (uint32_t i = 0; i < 3u; i++)
        target_poses[0].m[i][i] = 1.0f;
    for (uint32_t i = 0; i < TARGET_MARKS; i++) {
        in.mark[i] = (smr_landmark){.structure = 0, .vertex = SMR_NONE, .weight = 1.0f};
        memcpy(in.mark[i].rest, target_xyz[0] + 300u * i, sizeof in.mark[i].rest);
        memcpy(in.mark[i].place, target_xyz[0] + 300u * i, sizeof in.mark[i].place);
    }
    return target_ok("bent", target_build_of(target_out, &in.bent) == SMR_OK);
}

int main(void);

int main(void)
{
    smr_baremetal board;
    target_time.port = smr_baremetal_port(&board);
    int good = target_begin();
    for (uint32_t i = 0; i < sizeof target_calls / sizeof target_calls[0] && good; i++)
        good = target_row(i);
    return good && in.is_bent > 0u && in.is_tracked > 0u ? 0 : 1;
}
