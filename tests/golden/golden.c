/* golden.c: registrations whose bits must be the same on every processor, compiler, thread count and task order.
 *
 * Prints one line: smr-hash <state after the rigid run> <after the polar run> <after an image run> <after a run onto
 * half of the target> <CRC-32 of the models without and with profiles, of the start pose's facts and of the expected
 * errors> <state after a run onto a cloud of points that grows> <CRC-32 of carried points, and of the way back>
 * <state after a run drawn by landmarks, goals and a force of the caller's beside the target> <state after an image
 * run as the paper has it> <checksums of saves in the middle of the polar and the image run, which went on from them
 * to the same state> <state after a target was followed that moved and jumped> <of states after runs that fuse clusters
 * by logarithms> <state after a run with volume preservation and smoothing> <of states and velocities after runs in
 * time>. Built without a capability, words that need it are "-"; the second line names what is left out, status 2.
 * Hosted: golden [threads N | workers N | reverse | shuffle | interleave | saves FILE | restores FILE]; without an
 * argument a plain loop. saves writes the saves as well, restores goes on from another processor's.
 * Bare metal (SMR_BAREMETAL): no argument; the buffers go to the section .arena.
 * SPDX-License-Identifier: MIT */
#include <smr.h>
#include <string.h>
#include "fixture_bone.h"
#include "golden.h"
#include "golden_save.h"
#include "print.h"

#ifdef SMR_BAREMETAL
#include "smr_baremetal.h"
#include "smr_semihost.h"
#else
#include "smr_pthread.h"
#include <stdio.h>
#include <stdlib.h>
#endif

#define GOLDEN_CELL FIXTURE_CELL_SMALL
#define GOLDEN_STOP 5u /* ticks before a run is interrupted */

/* Static, so the sizes are numbers; golden_sizes() checks that the queries agree. */
GOLDEN_MEMORY unsigned char golden_arena[GOLDEN_ARENA_BYTES];
GOLDEN_MEMORY unsigned char golden_scratch[GOLDEN_SCRATCH_BYTES];
GOLDEN_MEMORY unsigned char golden_image[GOLDEN_IMAGE_BYTES];
GOLDEN_MEMORY unsigned char golden_target[GOLDEN_SURFACE_BYTES];
static GOLDEN_MEMORY unsigned char golden_source[GOLDEN_SURFACE_BYTES];
GOLDEN_MEMORY float golden_words[GOLDEN_WORDS];
static GOLDEN_MEMORY unsigned char golden_save_memory[2u * SMR_SAVE_BYTES(1024, 2, 1024, 0, SMR_METHOD_POLAR)];
static GOLDEN_MEMORY unsigned char golden_other[SMR_ARENA_BYTES(1024, 2048, 2, 1, 1024, SMR_METHOD_POLAR)];
static golden_saves golden_saved = {golden_save_memory, sizeof golden_save_memory, 0, 0, 0};
static int golden_interrupts; /* 1: runs are saved and restored in the middle */
GOLDEN_MEMORY float golden_xyz[2][3 * 1024];
GOLDEN_MEMORY uint32_t golden_triangles[2][3 * 2048];

/* A byte more. CRC-32 (IEEE 802.3), bit by bit: independent of the library's own. */
static uint32_t golden_crc_byte(uint32_t crc, uint32_t byte)
{
    crc ^= byte;
    for (int bit = 0; bit < 8; bit++)
        crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
    return crc;
}

uint32_t golden_crc(const unsigned char *bytes, size_t n)
{
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < n; i++)
        crc = golden_crc_byte(crc, bytes[i]);
    return ~crc;
}

uint32_t golden_crc_words(const void *words, size_t n)
{
    uint32_t crc = 0xffffffffu, word;
    for (size_t i = 0; i < 4u * n; i++) {
        memcpy(&word, (const unsigned char *)words + i / 4u * 4u, sizeof word);
        crc = golden_crc_byte(crc, word >> 8u * (i % 4u) & 255u);
    }
    return ~crc;
}

/* 1: a run needs what this build leaves out. */
static int golden_left_out;

int golden_ok(const char *step, int status)
{
    golden_left_out |= status == SMR_E_CONFIG && smr_built_without()[0] != '\0';
    return golden_left_out ? 0 : print_ok("smr-hash", step, status);
}

/* Words that are not computed, for want of what they need. */
static uint32_t golden_missing;

/* The result of a run that gives words, a bit each: 1 when it succeeded, or needs what is left out. */
static int golden_part(uint32_t words, int result)
{
    if (!golden_left_out)
        return result;
    golden_left_out = 0;
    golden_missing |= words;
    return 1;
}

int golden_ticks(smr **s, const smr_model *model, const smr_surface *target, const smr_volume *volume,
                 smr_tick_report *report)
{
    const golden_inputs inputs = {model, target, volume, golden_other, sizeof golden_other};
    for (uint32_t tick = 0; tick < GOLDEN_TICKS; tick++)
        if ((tick == GOLDEN_STOP && golden_interrupts &&
             !golden_ok("interrupt", golden_interrupt(&golden_saved, &inputs, s))) ||
            !golden_ok("tick", smr_tick(*s, 0, report)))
            return 0;
    return 1;
}

/* Source and target meshes into golden_xyz and golden_triangles. */
static int golden_meshes(smr_mesh *mesh)
{
    for (int i = 0; i < 2; i++) {
        fixture_grid grid = i == 0 ? fixture_grid_source(GOLDEN_CELL) : fixture_grid_target(GOLDEN_CELL);
        fixture_mesh m = {golden_xyz[i], golden_triangles[i], 1024, 2048, 0, 0};
        const size_t words = sizeof golden_words / sizeof golden_words[0];
        int made = i == 0 ? fixture_bone_source(&grid, &m, golden_words, words)
                          : fixture_bone_target(&grid, 1.0f, &m, golden_words, words);
        if (!made)
            return golden_ok("fixture", SMR_E_ARENA);
        mesh[i].xyz = m.xyz;
        mesh[i].triangles = m.triangles;
        mesh[i].n_vertices = m.n_vertices;
        mesh[i].n_triangles = m.n_triangles;
    }
    for (uint32_t v = 16; v < mesh[1].n_vertices; v += 64u)
        golden_xyz[1][3u * v] += 12.0f; /* tips of the target */
    return 1;
}

static int golden_prepare(const smr_mesh *mesh, const smr_model **model, size_t *bytes)
{
    smr_structure structure = {"bone", {NULL, NULL, 0, 0}};
    smr_prepare_config config = smr_prepare_config_default();
    size_t need = 0;
    structure.mesh = *mesh;
    config.n_radii = 3;
    config.radius_mm[0] = 110.0f;
    config.radius_mm[1] = 60.0f;
    config.radius_mm[2] = 5.0f; /* below the mean edge */
    return golden_ok("prepare bytes", smr_prepare_bytes(&structure, 1, &config, &need)) &&
           golden_ok("scratch size", need <= sizeof golden_scratch ? SMR_OK : SMR_E_ARENA) &&
           golden_ok("prepare", smr_prepare(&structure, 1, &config, golden_scratch, sizeof golden_scratch, golden_image,
                                            sizeof golden_image, bytes)) &&
           golden_ok("open", smr_model_open(golden_image, *bytes, model));
}

/* One registration; *hash: of its state after GOLDEN_TICKS iterations. */
static int golden_run(const smr_model *model, const smr_surface *target, const smr_port *port, uint32_t method,
                      const smr_pose *pose, smr **state, uint64_t *hash)
{
    smr_config config = smr_config_default();
    smr_tick_report report;
    smr *s = NULL;
    config.basic.n_workers = GOLDEN_WORKERS;
    config.basic.n_target_vertices = 1024;
    config.basic.method = method;
    config.motion.normals = method == SMR_METHOD_POLAR ? SMR_NORMALS_EXACT : SMR_NORMALS_CARRIED;
    if (method == SMR_METHOD_POLAR) { /* with vertices ignored, fewer and fewer */
        config.schedule.active_first = 0.3f;
        config.basic.active_share = 0.8f;
    }
    config.basic.iterations = 12;
    config.basic.iterations_last = 40;
    if (!golden_ok("init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)) ||
        (pose != NULL && !golden_ok("pose", smr_set_pose(s, pose))) ||
        !golden_ok("surface", smr_set_surface(s, SMR_ALL, target)) || !golden_ticks(&s, model, target, NULL, &report))
        return 0;
    *state = s;
    *hash = smr_state_hash(s);
    return 1;
}

/* Onto a noisy target that shows half of the bone only, and what is said about each vertex. */
static int golden_half(const smr_model *model, smr_mesh half, const smr_port *port, uint64_t *hash, uint32_t *crc)
{
    smr_surface *target = NULL;
    smr_verdict verdict;
    smr *s = NULL;
    const size_t n = 1024;
    half.n_triangles /= 2u;
    for (uint32_t i = 0; i < 3u * half.n_vertices; i++) /* up to 4 mm */
        golden_words[i] = half.xyz[i] + 0.5f * (float)((int32_t)(i * 2654435761u >> 28) - 8);
    half.xyz = golden_words;
    if (!golden_ok("half", smr_surface_build(&half, golden_target, sizeof golden_target, &target)))
        return 0;
    memset(golden_words, 0, n * sizeof(float));
    if (!golden_run(model, target, port, SMR_METHOD_RIGID, NULL, &s, hash) ||
        !golden_ok("verdict", smr_get_verdict(s, SMR_ALL, &verdict)) ||
        !golden_ok("half is not all", verdict.level != SMR_VERDICT_GOOD ? SMR_OK : SMR_E_STATE) ||
        !golden_ok("errors", smr_get_expected_error(s, 0, golden_words)))
        return 0;
    *crc = golden_crc_words(golden_words, n);
    return 1;
}

/* The start pose, from a quarter turn away, so that it must be searched, and the checksum of what is said about it. */
static int golden_start(const smr_surface *source, const smr_surface *target, smr_pose *pose, uint32_t *crc)
{
    static const smr_pose quarter = {{{0, -1, 0, 30}, {1, 0, 0, 5}, {0, 0, 1, -9}}};
    smr_align_config align = smr_align_config_default();
    smr_align_report said;
    align.samples = 200;
    align.iterations = 10;
    align.given = &quarter;
    if (!golden_ok("align", smr_align(source, target, &align, golden_scratch, sizeof golden_scratch, pose, &said)) ||
        !golden_ok("align found", !said.given && said.n_alike == 1u ? SMR_OK : SMR_E_STATE))
        return 0;
    *crc = golden_crc_words(&said, sizeof said / 4u);
    return 1;
}

/* The line of all words, and what is left out. */
static int golden_print(const uint64_t *words, uint32_t n)
{
    print_text("smr-hash");
    for (uint32_t i = 0; i < n; i++) {
        print_text(" ");
        if (golden_missing >> i & 1u)
            print_text("-");
        else
            print_hex(words[i], i == 4u || i == 6u || i == 9u ? 8u : 16u);
    }
    print_text("\n");
    if (smr_built_without()[0] == '\0')
        return 0;
    print_text("built without ");
    print_text(smr_built_without());
    print_text("\n");
    return 2;
}

static int golden_main(const smr_port *port)
{
    smr_mesh mesh[2];
    const smr_model *model = NULL;
    smr_surface *source = NULL, *target = NULL;
    smr_pose pose;
    size_t image_bytes = 0;
    uint64_t rigid = 0, polar = 0, image[2] = {0, 0}, half = 0, points = 0, drawn = 0, again[2], track = 0, fused = 0,
             volume = 0, moves = 0, contact = 0;
    uint32_t crc = 0, crc_image = 0, crc_start = 0, crc_half = 0, crc_carry = 0;
    smr *s = NULL;
    if (!golden_ok("self test", smr_self_test() == 0u ? SMR_OK : SMR_E_STATE) || !golden_meshes(mesh) ||
        !golden_prepare(&mesh[0], &model, &image_bytes) ||
        !golden_ok("target", smr_surface_build(&mesh[1], golden_target, sizeof golden_target, &target)) ||
        !golden_ok("source", smr_surface_build(&mesh[0], golden_source, sizeof golden_source, &source)) ||
        !golden_start(source, target, &pose, &crc_start) ||
        !golden_run(model, target, port, SMR_METHOD_RIGID, NULL, &s, &rigid) ||
        !golden_run(model, target, port, SMR_METHOD_POLAR, &pose, &s, &polar) ||
        !golden_carry(s, &mesh[0], port, &crc_carry) ||
        !golden_part(1u << 7, golden_drawn(model, &mesh[0], target, port, &drawn)) ||
        !golden_part(1u << 14, golden_contact(model, target, source, port, &contact)) ||
        !golden_part(1u << 3 | 1u << 4, golden_half(model, mesh[1], port, &half, &crc_half)) ||
        !golden_part(1u << 5, golden_points(model, &mesh[1], port, &points)) ||
        !golden_part(1u << 10, golden_track(model, &mesh[1], port, &track)) ||
        !golden_part(1u << 11, golden_fused(model, &mesh[0], port, &fused)) ||
        !golden_ok("target again", smr_surface_build(&mesh[1], golden_target, sizeof golden_target, &target)) ||
        !golden_part(1u << 12, golden_kept(model, target, port, &volume)) ||
        !golden_part(1u << 13, golden_dynamics(model, &mesh[0], port, &moves)))
        return 1;
    golden_interrupts = 1;
    if (!golden_run(model, target, port, SMR_METHOD_POLAR, &pose, &s, &again[0]) ||
        !golden_ok("restored polar", again[0] == polar ? SMR_OK : SMR_E_STATE))
        return 1;
    golden_interrupts = 0;
    crc = golden_crc(golden_image, image_bytes);
    if (!golden_part(1u << 2 | 1u << 4 | 1u << 8 | 1u << 9, golden_images(port, image, &crc_image)))
        return 1;
    golden_interrupts = 1;
    if (!(golden_missing & 1u << 2) &&
        (!golden_images(port, again, &crc_image) ||
         !golden_ok("restored image", again[0] == image[0] && again[1] == image[1] ? SMR_OK : SMR_E_STATE)))
        return 1;
    golden_missing |= smr_built_without()[0] != '\0' ? 1u << 9 : 0u; /* a save keeps less */
    golden_missing |=
        strstr(smr_built_without(), "partial") != NULL ? 1u << 10 : 0u; /* a lost target counts as whole */
    const uint64_t words[] = {rigid,  polar,     image[0], half,     crc ^ crc_image ^ crc_start ^ crc_half,
                              points, crc_carry, drawn,    image[1], golden_saved.checksums,
                              track,  fused,     volume,   moves,    contact};
    return golden_print(words, (uint32_t)(sizeof words / sizeof words[0]));
}

#ifdef SMR_BAREMETAL

int main(void);

int main(void)
{
    smr_baremetal clock;
    smr_port port = smr_baremetal_port(&clock);
    return golden_main(&port);
}

#else

/* Schedulers that a correct library cannot notice. All run on one thread but claim many workers. */

static void golden_reverse(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    (void)ctx;
    for (uint32_t i = n_tasks; i > 0u; --i)
        run(arg, i - 1u, 0);
}

/* A full cycle over the tasks in scrambled order: linear congruence modulo a power of two. */
static void golden_shuffle(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    uint32_t *seed = (uint32_t *)ctx;
    uint32_t size = 1, at;
    while (size < n_tasks)
        size *= 2u;
    *seed = *seed * 1664525u + 1013904223u;
    at = *seed & (size - 1u);
    for (uint32_t i = 0; i < size; i++) {
        at = (at * 5u + 2u * (*seed >> 16) + 1u) & (size - 1u);
        if (at < n_tasks)
            run(arg, at, at * 7u % GOLDEN_WORKERS);
    }
}

/* Strides of three, each task on another worker than its neighbour. */
static void golden_interleave(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    (void)ctx;
    for (uint32_t first = 0; first < 3u; first++)
        for (uint32_t task = first; task < n_tasks; task += 3u)
            run(arg, task, task % GOLDEN_WORKERS);
}

static int golden_threads(uint32_t n)
{
    static _Alignas(SMR_ALIGN) unsigned char memory[16384];
    smr_pthread *pool = NULL;
    if (!golden_ok("pool", smr_pthread_create(&pool, memory, sizeof memory, n)))
        return 1;
    const smr_port port = smr_pthread_port(pool);
    const int result = golden_main(&port);
    smr_pthread_destroy(pool);
    return result;
}

/* Writes the saves, or reads another processor's. */
static int golden_file(const char *path, const char *mode)
{
    FILE *file = fopen(path, mode);
    size_t done = 0;
    if (file == NULL)
        return 0;
    if (mode[0] == 'w')
        done = fwrite(golden_save_memory, 1, golden_saved.used, file);
    else
        done = fread(golden_save_memory, 1, sizeof golden_save_memory, file);
    return fclose(file) == 0 && done > 0u;
}

int main(int argc, char **argv)
{
    uint32_t seed = 12345u;
    smr_port port = {NULL, GOLDEN_WORKERS, NULL, NULL};
    const char *mode = argc > 1 ? argv[1] : "";
    unsigned long n = argc > 2 ? strtoul(argv[2], NULL, 10) : 1u;
    port.ctx = &seed;
    if (strcmp(mode, "threads") == 0 && n >= 1u && n <= GOLDEN_WORKERS)
        return golden_threads((uint32_t)n);
    if (strcmp(mode, "workers") == 0 && n >= 1u && n <= GOLDEN_WORKERS) {
        port.n_workers = (uint32_t)n;
    } else if (strcmp(mode, "reverse") == 0) {
        port.parallel = golden_reverse;
    } else if (strcmp(mode, "shuffle") == 0) {
        port.parallel = golden_shuffle;
    } else if (strcmp(mode, "interleave") == 0) {
        port.parallel = golden_interleave;
    } else if (argc > 2 && strcmp(mode, "saves") == 0) {
        return golden_main(NULL) == 0 && golden_file(argv[2], "wb") ? 0 : 1;
    } else if (argc > 2 && strcmp(mode, "restores") == 0 && golden_file(argv[2], "rb")) {
        golden_saved.given = 1;
        return golden_main(NULL);
    } else if (argc > 1) {
        (void)fputs(
            "usage: golden [threads N | workers N | reverse | shuffle | interleave | saves FILE | restores FILE], "
            "N 1..8\n",
            stderr);
        return 2;
    } else {
        port.n_workers = 1;
    }
    return golden_main(argc > 1 ? &port : NULL);
}

#endif
