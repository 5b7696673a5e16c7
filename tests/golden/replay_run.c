/* replay_run.c: records a registration whose ticks a jittering clock cuts short, and replays its log anywhere.
 *
 * Hosted: replay_run record FILE [TICKS [big]]    writes the log of a run on two threads
 *         replay_run replay FILE [THREADS]        replays it; prints what the log holds and the first tick that differs
 * Bare metal (SMR_BAREMETAL): replays the file replay.log of the debugger's directory; the buffers go to .arena.
 * On success the last line is "replay-run N ticks agree, state HASH" and the exit status 0.
 *
 * The small model has 982 vertices, the big one 2,982. Two target surfaces alternate, often within an iteration. When
 * a schedule has ended, the next one starts from another pose.
 * SPDX-License-Identifier: MIT */
#include <smr.h>
#include "fixture_bone.h"
#include "print.h"

#ifdef SMR_BAREMETAL
#include "smr_semihost.h"
#define REPLAY_MEMORY static __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
#define REPLAY_VERTICES 1024u
#define REPLAY_WORKERS 1u
#else
#include "smr_pthread.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define REPLAY_MEMORY static _Alignas(SMR_ALIGN)
#define REPLAY_VERTICES 4096u
#define REPLAY_WORKERS 8u
#endif

#define REPLAY_TICKS_MAX 10000u
#define REPLAY_SCRATCH (6u * REPLAY_VERTICES << 10)

REPLAY_MEMORY unsigned char replay_arena[SMR_ARENA_BYTES(REPLAY_VERTICES, 2u * REPLAY_VERTICES, 1, REPLAY_WORKERS,
                                                         REPLAY_VERTICES, SMR_METHOD_POLAR)];
REPLAY_MEMORY unsigned char replay_scratch[REPLAY_SCRATCH];
REPLAY_MEMORY unsigned char replay_image[2u * REPLAY_VERTICES << 10];
REPLAY_MEMORY unsigned char replay_target[2][REPLAY_VERTICES << 8];
REPLAY_MEMORY float replay_words[16u * REPLAY_VERTICES];
REPLAY_MEMORY float replay_xyz[2][3u * REPLAY_VERTICES];
REPLAY_MEMORY uint32_t replay_triangles[2][6u * REPLAY_VERTICES];
REPLAY_MEMORY unsigned char replay_log[SMR_LOG_BYTES(REPLAY_TICKS_MAX, REPLAY_TICKS_MAX)];

static int replay_ok(const char *step, int status) { return print_ok("replay-run", step, status); }

static int replay_mesh(uint32_t cell, uint32_t which, float strength, smr_mesh *mesh)
{
    fixture_grid grid = which == 0u ? fixture_grid_source(cell) : fixture_grid_target(cell);
    fixture_mesh m = {replay_xyz[which], replay_triangles[which], REPLAY_VERTICES, 2u * REPLAY_VERTICES, 0, 0};
    const size_t words = sizeof replay_words / sizeof replay_words[0];
    const int made = which == 0u ? fixture_bone_source(&grid, &m, replay_words, words)
                                 : fixture_bone_target(&grid, strength, &m, replay_words, words);
    *mesh = (smr_mesh){m.xyz, m.triangles, m.n_vertices, m.n_triangles};
    return replay_ok("fixture", made ? SMR_OK : SMR_E_ARENA);
}

static int replay_set_up(uint32_t cell, const smr_model **model, const smr_surface **target)
{
    smr_structure structure = {"bone", {NULL, NULL, 0, 0}};
    smr_prepare_config config = smr_prepare_config_default();
    size_t bytes = 0;
    config.n_radii = 3;
    config.radius_mm[0] = 110.0f;
    config.radius_mm[1] = 60.0f;
    config.radius_mm[2] = 35.0f;
    if (!replay_mesh(cell, 0, 0.0f, &structure.mesh))
        return 0;
    for (uint32_t i = 0; i < 2u; i++) {
        smr_mesh mesh;
        smr_surface *surface = NULL;
        if (!replay_mesh(cell, 1, i == 0u ? 1.0f : 0.6f, &mesh) ||
            !replay_ok("target", smr_surface_build(&mesh, replay_target[i], sizeof replay_target[i], &surface)))
            return 0;
        target[i] = surface;
    }
    return replay_ok("prepare", smr_prepare(&structure, 1, &config, replay_scratch, sizeof replay_scratch, replay_image,
                                            sizeof replay_image, &bytes)) &&
           replay_ok("open", smr_model_open(replay_image, bytes, model));
}

/* The targets take turns: the replay gives them in the order in which they were set. */
typedef struct replay_turns {
    const smr_surface *target[2];
    uint32_t next;
} replay_turns;

static const void *replay_input(void *ctx, const smr_log_record *record)
{
    replay_turns *turns = ctx;
    return record->kind == SMR_LOG_SURFACE ? turns->target[turns->next++ % 2u] : NULL;
}

/* What a log holds. */
static int replay_figures(const unsigned char *log, size_t bytes, smr_log_info *info)
{
    smr_log_reader reader;
    smr_log_record r;
    uint32_t ticks = 0, partial = 0, iterations = 0, cut = 0, inputs = 0, within = 0, under_way = 0;
    if (!replay_ok("log", smr_log_open(log, bytes, &reader, info)))
        return 0;
    for (;;) {
        if (!replay_ok("log record", smr_log_next(&reader, &r)))
            return 0;
        if (r.kind == 0u || r.kind == SMR_LOG_FULL)
            break;
        if (r.kind == SMR_LOG_TICK) {
            ticks++;
            partial += !r.complete;
            iterations += r.complete;
            cut += r.complete && r.n_taken < info->n_vertices;
            under_way = !r.complete;
        } else {
            inputs++;
            within += under_way;
        }
    }
    print_number("log: ", bytes, 10, " bytes");
    print_number(", ", info->n_vertices, 10, " vertices");
    print_number(", ", ticks, 10, " ticks");
    print_number(", ", partial, 10, " of them partial");
    print_number(", ", iterations, 10, " iterations");
    print_number(", ", cut, 10, " of them cut");
    print_number(", ", inputs, 10, " inputs");
    print_number(", ", within, 10, " of them within an iteration\n");
    if (partial < 50u || cut < 10u || within < 10u) {
        print_text("replay-run error: the clock hardly cut or interrupted anything\n");
        return 0;
    }
    return 1;
}

static int replay_again(const unsigned char *log, size_t bytes, const smr_port *port, uint32_t n_workers)
{
    smr_log_info info;
    const smr_model *model = NULL;
    replay_turns turns = {{NULL, NULL}, 0};
    smr_config config;
    smr_replay replay;
    smr_replay_report report = {0};
    smr *s = NULL;
    if (!replay_figures(log, bytes, &info))
        return 1;
    config = info.config; /* smr_init checks it */
    config.basic.n_workers = n_workers;
    if (!replay_set_up(info.n_vertices < 1024u ? FIXTURE_CELL_SMALL : FIXTURE_CELL_DEMO, &model, turns.target) ||
        !replay_ok("init", smr_init(model, &config, port, replay_arena, sizeof replay_arena, &s)) ||
        !replay_ok("replay", smr_replay_start(s, log, bytes, replay_input, &turns, &replay)))
        return 1;
    for (;;) {
        if (!replay_ok("replayed tick", smr_replay_tick(&replay, &report)))
            return 1;
        if (report.ended)
            break;
        if (report.differs) {
            print_number("replay-run tick ", report.tick, 10, " differs\n");
            return 1;
        }
    }
    print_number("replay-run ", report.tick, 10, " ticks agree");
    print_number(", state ", smr_state_hash(s), 16, "\n");
    return 0;
}

#ifdef SMR_BAREMETAL

int main(void);

int main(void)
{
    const size_t bytes = smr_semihost_read_file("replay.log", replay_log, sizeof replay_log);
    return replay_again(replay_log, bytes, NULL, 1);
}

#else

/* A clock that is read often and runs unevenly; now and then something else takes the processor. */
typedef struct replay_clock {
    smr_port pool;
    uint32_t seed;
    uint64_t time;
} replay_clock;

static uint32_t replay_dice(uint32_t *seed, uint32_t n)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(*seed >> 8) * n >> 24);
}

static uint64_t replay_now(void *ctx)
{
    replay_clock *clock = ctx;
    clock->time += 2000u + replay_dice(&clock->seed, 20000) + (replay_dice(&clock->seed, 100) == 0u ? 400000u : 0u);
    return clock->time;
}

static void replay_parallel(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    replay_clock *clock = ctx;
    clock->pool.parallel(clock->pool.ctx, run, arg, n_tasks);
}

static smr_config replay_config(void)
{
    smr_config config = smr_config_default();
    config.basic.n_workers = 2;
    config.basic.n_target_vertices = 4096u;
    config.basic.method = SMR_METHOD_POLAR;
    config.basic.iterations = 12;
    config.basic.iterations_last = 15;
    return config;
}

static int replay_ticks(smr *s, uint32_t n, const smr_surface *const *target, uint32_t seed)
{
    smr_tick_report report = {0};
    uint64_t whole = 0; /* ns of an iteration; the first ones may take what they take */
    uint32_t turn = 1;
    if (!replay_ok("set log", smr_set_log(s, replay_log, sizeof replay_log)) ||
        !replay_ok("surface", smr_set_surface(s, SMR_ALL, target[0])))
        return 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t share = replay_dice(&seed, 6) == 0u ? 2u : 15u + replay_dice(&seed, 90); /* % of it */
        const smr_status status = smr_tick(s, i < 4u ? UINT64_MAX / 4u : whole / 100u * share, &report);
        if (status < 0)
            return replay_ok("tick", status);
        for (uint32_t phase = 0; i < 4u && phase < SMR_PHASES; phase++)
            whole = (phase == 0u ? 0u : whole) + report.details.phase_ns[phase];
        if (replay_dice(&seed, status == SMR_PARTIAL ? 6u : 30u) == 0u &&
            !replay_ok("surface", smr_set_surface(s, 0, target[turn++ % 2u])))
            return 0;
        if (report.done) {
            const smr_pose pose = {{{1, 0, 0, 0.01f * (float)i}, {0, 1, 0, 0}, {0, 0, 1, -0.005f * (float)i}}};
            if (!replay_ok("pose", smr_set_pose(s, &pose)))
                return 0;
        }
    }
    return 1;
}

static int replay_record(const char *path, uint32_t ticks, uint32_t cell)
{
    static _Alignas(SMR_ALIGN) unsigned char memory[16384];
    replay_clock clock = {{NULL, 2, NULL, NULL}, 11u, 0u};
    const smr_port port = {&clock, 2, replay_parallel, replay_now};
    const smr_surface *target[2];
    const smr_model *model = NULL;
    const smr_config config = replay_config();
    smr_pthread *pool = NULL;
    smr_log_state state = {0, 0, 0};
    smr *s = NULL;
    FILE *file = NULL;
    if (!replay_ok("pool", smr_pthread_create(&pool, memory, sizeof memory, 2)))
        return 1;
    clock.pool = smr_pthread_port(pool);
    const int good = replay_set_up(cell, &model, target) &&
                     replay_ok("init", smr_init(model, &config, &port, replay_arena, sizeof replay_arena, &s)) &&
                     replay_ticks(s, ticks, target, 3u) && replay_ok("get log", smr_get_log(s, &state));
    smr_pthread_destroy(pool);
    if (!good || (file = fopen(path, "wb")) == NULL)
        return 1;
    const size_t written = fwrite(replay_log, 1, state.bytes, file);
    if (fclose(file) != 0 || written != state.bytes)
        return 1;
    print_number("replay-run ", state.n_ticks, 10, " ticks recorded");
    print_number(", state ", smr_state_hash(s), 16, "\n");
    return 0;
}

static int replay_file(const char *path, uint32_t threads)
{
    static _Alignas(SMR_ALIGN) unsigned char memory[16384];
    FILE *file = fopen(path, "rb");
    smr_pthread *pool = NULL;
    if (file == NULL || !replay_ok("pool", smr_pthread_create(&pool, memory, sizeof memory, threads)))
        return 1;
    const size_t bytes = fread(replay_log, 1, sizeof replay_log, file);
    const smr_port port = smr_pthread_port(pool);
    (void)fclose(file);
    const int result = replay_again(replay_log, bytes, &port, threads);
    smr_pthread_destroy(pool);
    return result;
}

int main(int argc, char **argv)
{
    const unsigned long n = argc > 3 ? strtoul(argv[3], NULL, 10) : 0u;
    if (argc >= 3 && argc <= 5 && strcmp(argv[1], "record") == 0 && n <= REPLAY_TICKS_MAX)
        return replay_record(argv[2], n > 0u ? (uint32_t)n : 500u, argc > 4 ? FIXTURE_CELL_DEMO : FIXTURE_CELL_SMALL);
    if (argc >= 3 && argc <= 4 && strcmp(argv[1], "replay") == 0 && n <= REPLAY_WORKERS)
        return replay_file(argv[2], n > 0u ? (uint32_t)n : 1u);
    (void)fputs("usage: replay_run record FILE [TICKS [big]] | replay FILE [THREADS]\n", stderr);
    return 2;
}

#endif
