/* rig.c: set-up that unit tests, property tests and benchmarks share.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "property/rig.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fixture_bone.h"

/* ---- memory */

#define RIG_BLOCKS 65536u
static void *rig_block[RIG_BLOCKS];
static uint32_t rig_n_blocks;

static void give_up(const char *what, int status)
{
    fprintf(stderr, "rig: %s failed with %d\n", what, status);
    abort();
}

/* Of exactly the size asked for: the address sanitiser sees the first byte beyond it. */
static void *block(size_t bytes, int fill)
{
    void *p = NULL;
    if (rig_n_blocks == RIG_BLOCKS || posix_memalign(&p, SMR_ALIGN, bytes > 0u ? bytes : 1u) != 0)
        give_up("memory", 0);
    memset(p, fill, bytes);
    rig_block[rig_n_blocks++] = p;
    return p;
}

void *rig_alloc(size_t bytes) { return block(bytes, 0); }
void *rig_rough(size_t bytes) { return block(bytes, 0xa5); }

void rig_free(void *memory)
{
    for (uint32_t i = rig_n_blocks; i > 0u; i--)
        if (rig_block[i - 1u] == memory) {
            rig_block[i - 1u] = rig_block[--rig_n_blocks];
            free(memory);
            return;
        }
}

void rig_free_all(void)
{
    while (rig_n_blocks > 0u)
        free(rig_block[--rig_n_blocks]);
}

/* ---- meshes */

static smr_mesh as_mesh(const fixture_mesh *m)
{
    smr_mesh mesh = {m->xyz, m->triangles, m->n_vertices, m->n_triangles};
    return mesh;
}

void rig_bone(uint32_t cell_um, float strength, smr_mesh *source, smr_mesh *target)
{
    const uint32_t nv = FIXTURE_VERTICES(FIXTURE_CELL_TARGET(cell_um)) + 64u, nt = 2u * nv;
    const size_t words = FIXTURE_SCRATCH_WORDS(FIXTURE_CELL_TARGET(cell_um)) + 1024u;
    float *scratch = rig_alloc(words * sizeof *scratch);
    fixture_mesh m[2];
    fixture_grid a = fixture_grid_source(cell_um), b = fixture_grid_target(cell_um);
    for (int i = 0; i < 2; i++)
        m[i] = (fixture_mesh){rig_alloc(nv * 3u * sizeof(float)), rig_alloc(nt * 3u * sizeof(uint32_t)), nv, nt, 0, 0};
    if (!fixture_bone_source(&a, &m[0], scratch, words) || !fixture_bone_target(&b, strength, &m[1], scratch, words))
        give_up("fixture", 0);
    if (source != NULL)
        *source = as_mesh(&m[0]);
    if (target != NULL)
        *target = as_mesh(&m[1]);
}

smr_mesh rig_ball(float radius, uint32_t rings, uint32_t around, const float centre[3])
{
    const uint32_t n = rings * around + 2u, nt = 2u * rings * around;
    float *xyz = rig_alloc(n * 3u * sizeof *xyz);
    uint32_t *t = rig_alloc(nt * 3u * sizeof *t), k = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t ring = i / around, step = i % around;
        const double polar =
            i < n - 2u ? 3.14159265358979 * (ring + 1.0) / (rings + 1.0) : (i == n - 2u ? 0.0 : 3.14159265358979);
        const double turn = 6.28318530717959 * (step + 0.5 * (ring % 2u)) / around;
        xyz[3u * i] = centre[0] + radius * (float)(sin(polar) * cos(turn));
        xyz[3u * i + 1u] = centre[1] + radius * (float)(sin(polar) * sin(turn));
        xyz[3u * i + 2u] = centre[2] + radius * (float)cos(polar);
    }
    for (uint32_t i = 0; i < around; i++) {
        const uint32_t next = (i + 1u) % around, last = (rings - 1u) * around;
        const uint32_t cap[6] = {n - 2u, i, next, n - 1u, last + next, last + i};
        memcpy(t + k, cap, sizeof cap);
        k += 6u;
        for (uint32_t r = 0; r + 1u < rings; r++) {
            const uint32_t a = r * around + i, b = r * around + next;
            const uint32_t quad[6] = {a, a + around, b, b, a + around, b + around};
            memcpy(t + k, quad, sizeof quad);
            k += 6u;
        }
    }
    return (smr_mesh){xyz, t, n, nt};
}

smr_mesh rig_moved(const smr_mesh *mesh, const float m[9], const float t[3])
{
    float *xyz = rig_alloc(mesh->n_vertices * 3u * sizeof *xyz);
    uint32_t *triangles = rig_alloc(mesh->n_triangles * 3u * sizeof *triangles);
    const float det =
        m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        const float *p = mesh->xyz + 3u * (size_t)i;
        for (uint32_t r = 0; r < 3u; r++) {
            xyz[3u * (size_t)i + r] = (float)((double)m[3u * r] * (double)p[0] + (double)m[3u * r + 1u] * (double)p[1] +
                                              (double)m[3u * r + 2u] * (double)p[2] + (double)t[r]);
        }
    }
    for (size_t i = 0; i < 3u * (size_t)mesh->n_triangles; i++) {
        const size_t corner = i % 3u;
        triangles[i] = mesh->triangles[det < 0.0f && corner > 0u ? i / 3u * 3u + (3u - corner) : i];
    }
    return (smr_mesh){xyz, triangles, mesh->n_vertices, mesh->n_triangles};
}

/* ---- models, targets, registrations */

smr_prepare_config rig_radii(uint32_t n, float r0, float r1, float r2)
{
    smr_prepare_config config = smr_prepare_config_default();
    config.n_radii = n;
    config.radius_mm[0] = r0;
    config.radius_mm[1] = r1;
    config.radius_mm[2] = r2;
    return config;
}

const smr_model *rig_model(const smr_mesh *mesh, uint32_t n_structures, const smr_prepare_config *config)
{
    const smr_prepare_config standard = smr_prepare_config_default();
    smr_structure *structure = rig_alloc(n_structures * sizeof *structure);
    const smr_model *model = NULL;
    size_t scratch = 0, bytes = 0;
    config = config == NULL ? &standard : config;
    for (uint32_t i = 0; i < n_structures; i++)
        structure[i].mesh = mesh[i];
    int status = smr_prepare_bytes(structure, n_structures, config, &scratch);
    void *memory = rig_alloc(scratch);
    if (status == SMR_OK)
        status = smr_prepare(structure, n_structures, config, memory, scratch, NULL, 0, &bytes);
    void *image = rig_alloc(bytes);
    if (status == SMR_OK)
        status = smr_prepare(structure, n_structures, config, memory, scratch, image, bytes, &bytes);
    if (status == SMR_OK)
        status = smr_model_open(image, bytes, &model);
    if (status != SMR_OK)
        give_up("model", status);
    rig_free(memory); /* large, and not needed any more */
    return model;
}

smr_volume rig_cube(uint32_t side, float spacing, float **voxels)
{
    smr_volume volume;
    *voxels = rig_alloc((size_t)side * side * side * sizeof **voxels);
    memset(&volume, 0, sizeof volume);
    volume.voxels = *voxels;
    volume.type = SMR_VOXEL_FLOAT;
    for (uint32_t a = 0; a < 3u; a++) {
        volume.size[a] = side;
        volume.spacing[a] = spacing;
        volume.origin[a] = -0.5f * spacing * (float)(side - 1u);
        volume.direction[4u * a] = 1.0f;
    }
    return volume;
}

smr_surface *rig_surface(const smr_mesh *mesh)
{
    size_t bytes = 0;
    smr_surface *surface = NULL;
    int status = smr_surface_bytes(mesh->n_vertices, mesh->n_triangles, &bytes);
    if (status == SMR_OK)
        status = smr_surface_build(mesh, rig_alloc(bytes), bytes, &surface);
    if (status != SMR_OK)
        give_up("surface", status);
    return surface;
}

smr *rig_init(const smr_model *model, const smr_config *config, const smr_port *port)
{
    size_t bytes = 0;
    smr *s = NULL;
    int status = smr_arena_bytes(model, config, &bytes);
    if (status == SMR_OK)
        status = smr_init(model, config, port, rig_alloc(bytes), bytes, &s);
    if (status != SMR_OK)
        give_up("init", status);
    return s;
}

smr_tick_report rig_run(smr *s, uint32_t n)
{
    smr_tick_report report;
    memset(&report, 0, sizeof report);
    for (uint32_t i = 0; i < n && !report.done; i++) {
        const int status = smr_tick(s, 0, &report);
        if (status != SMR_OK)
            give_up("tick", status);
    }
    return report;
}

smr *rig_restored(const smr *s, const smr_model *model, const smr_config *config)
{
    size_t bytes = 0, room = 0;
    smr *copy = NULL;
    if (smr_save_bytes(s, &bytes) != SMR_OK || smr_arena_bytes(model, config, &room) != SMR_OK)
        return NULL;
    void *saved = rig_alloc(bytes), *arena = rig_alloc(room);
    memset(arena, 0xb5, room);
    if (smr_save(s, saved, bytes) != SMR_OK)
        return NULL;
    return smr_restore(model, NULL, NULL, saved, bytes, arena, room, &copy) == SMR_OK ? copy : NULL;
}

uint32_t rig_replays(const smr *s, const void *log, smr_log_input input, void *ctx, smr *twin, uint32_t *partial)
{
    smr_log_state wrote;
    smr_replay replay;
    smr_replay_report report = {0};
    uint32_t count = 0;
    if (smr_get_log(s, &wrote) != SMR_OK || wrote.full ||
        smr_replay_start(twin, log, wrote.bytes, input, ctx, &replay) != SMR_OK)
        return 0;
    while (!report.ended) {
        if (smr_replay_tick(&replay, &report) != SMR_OK || report.differs)
            return 0;
        count += !report.ended && !report.record.complete;
    }
    if (partial != NULL)
        *partial = count;
    return report.tick == wrote.n_ticks ? report.tick : 0u;
}

float *rig_positions(const smr *s, const smr_model *model)
{
    smr_model_info info;
    smr_structure_info part;
    size_t at = 0;
    (void)smr_model_get_info(model, &info);
    float *xyz = rig_alloc(info.n_vertices * 3u * sizeof *xyz);
    for (uint32_t i = 0; i < info.n_structures; i++) {
        (void)smr_model_structure(model, i, &part);
        const int status = smr_get_positions(s, i, xyz + 3u * at);
        if (status != SMR_OK)
            give_up("positions", status);
        at += part.n_vertices;
    }
    return xyz;
}

float rig_far(const float *a, const float *b, uint32_t n)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double d2 = 0.0;
        for (uint32_t k = 0; k < 3u; k++) {
            const double d = (double)a[3u * (size_t)i + k] - (double)b[3u * (size_t)i + k];
            d2 += d * d;
        }
        largest = d2 > largest || isnan(d2) ? d2 : largest;
    }
    return (float)sqrt(largest);
}

int rig_finite(const float *xyz, uint32_t n)
{
    for (size_t i = 0; i < 3u * (size_t)n; i++)
        if (!isfinite(xyz[i]))
            return 0;
    return 1;
}

/* ---- ports */

typedef struct rig_loop {
    uint32_t scheduler, n_workers, seed;
} rig_loop;

static void reverse(void *ctx, smr_task run, void *arg, uint32_t n)
{
    const rig_loop *loop = ctx;
    for (uint32_t i = n; i > 0u; i--)
        run(arg, i - 1u, i % loop->n_workers);
}

/* A full cycle over the tasks in scrambled order: linear congruence modulo a power of two. */
static void shuffle(void *ctx, smr_task run, void *arg, uint32_t n)
{
    rig_loop *loop = ctx;
    uint32_t size = 1;
    while (size < n)
        size *= 2u;
    uint32_t at = rig_random(&loop->seed, size);
    const uint32_t add = 2u * rig_random(&loop->seed, size) + 1u;
    for (uint32_t i = 0; i < size; i++) {
        at = (at * 5u + add) & (size - 1u);
        if (at < n)
            run(arg, at, rig_random(&loop->seed, loop->n_workers));
    }
}

static void interleave(void *ctx, smr_task run, void *arg, uint32_t n)
{
    const rig_loop *loop = ctx;
    for (uint32_t first = 0; first < 3u; first++)
        for (uint32_t i = first; i < n; i += 3u)
            run(arg, i, i % loop->n_workers);
}

smr_port rig_port(uint32_t scheduler, uint32_t n_workers)
{
    rig_loop *loop = rig_alloc(sizeof *loop);
    smr_port port = {loop, n_workers, NULL, NULL};
    loop->scheduler = scheduler;
    loop->n_workers = n_workers;
    loop->seed = 7u + n_workers;
    port.parallel = scheduler == RIG_REVERSE      ? reverse
                    : scheduler == RIG_SHUFFLE    ? shuffle
                    : scheduler == RIG_INTERLEAVE ? interleave
                                                  : NULL;
    return port;
}

static uint64_t read_clock(void *ctx)
{
    rig_clock *c = ctx;
    c->readings++;
    switch (c->kind) {
    case RIG_CLOCK_STEADY: c->time += c->step_ns; break;
    case RIG_CLOCK_JUMPING: /* long stops, as when a thread is not scheduled */
        c->time += c->readings % 5u == 0u ? 1000u * c->step_ns : c->step_ns;
        break;
    case RIG_CLOCK_BACKWARDS: c->time -= c->step_ns; break;
    case RIG_CLOCK_COARSE: /* shows every 10 ms only */ c->time += c->step_ns; return c->time / 10000000u * 10000000u;
    default: break;
    }
    return c->time;
}

smr_port rig_clock_port(rig_clock *clock, uint32_t kind, uint64_t step_ns)
{
    smr_port port = {clock, 1, NULL, read_clock};
    *clock = (rig_clock){kind, (uint64_t)1 << 50, step_ns, 0};
    return port;
}

/* ---- numbers */

uint32_t rig_random(uint32_t *seed, uint32_t n)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)(*seed >> 4) * n) >> 28);
}

float rig_between(uint32_t *seed, float lo, float hi)
{
    return lo + (hi - lo) * ((float)rig_random(seed, 1u << 20) / (float)(1u << 20));
}

void rig_within(uint32_t *seed, float lo, float hi, float p[3])
{
    for (uint32_t c = 0; c < 3u; c++)
        p[c] = rig_between(seed, lo, hi);
}

void rig_rotation(float x, float y, float z, float degrees, float m[9])
{
    const double a = (double)degrees * 3.14159265358979323846 / 180.0, c = cos(a), s = sin(a);
    const double l = sqrt((double)x * (double)x + (double)y * (double)y + (double)z * (double)z);
    const double u[3] = {(double)x / l, (double)y / l, (double)z / l};
    const double skew[9] = {0, -u[2], u[1], u[2], 0, -u[0], -u[1], u[0], 0};
    for (uint32_t i = 0; i < 9u; i++)
        m[i] = (float)((i % 4u == 0u ? c : 0.0) + s * skew[i] + (1.0 - c) * u[i / 3u] * u[i % 3u]);
}

/* gcc before 14 defines names for what it instruments, clang has features. */
#ifdef __has_feature
#define RIG_SLOW (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RIG_SLOW 1
#else
#define RIG_SLOW 0
#endif

uint32_t rig_times(uint32_t n)
{
    const char *again = getenv("SMR_AGAIN");
    return !RIG_SLOW && (again == NULL || again[0] != '1') ? n : n < 20u ? 1u : n / 10u;
}

uint64_t rig_jitter_read(void *jitter)
{
    rig_jitter *c = jitter;
    c->time += 200u + rig_random(&c->seed, 3000) + (rig_random(&c->seed, 40) == 0u ? 60000u : 0u);
    return c->time;
}
