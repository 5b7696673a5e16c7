/* bench_core.c: times of preparing, matching and registering the 24-structure model, or the fixture's bone where the
 * model's data is not beside the repository. Runs that are compared are interleaved. Prints `name number` lines
 * (medians); with a file name as argument it also writes name,p50,p99,max,repetitions there.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "../property/rig.h"
#include "../property/rig_data.h"
#include "baseline.h"
#include "smr_pthread.h"

#define REPETITIONS 25u
#define RADIUS_MM 30.0f

static FILE *csv;

static double seconds(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1.0e-9 * (double)t.tv_nsec;
}

static uint64_t nanoseconds(void *ctx)
{
    (void)ctx;
    return (uint64_t)(seconds() * 1.0e9);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double tell(const char *name, double *value, uint32_t n)
{
    qsort(value, n, sizeof *value, by_size);
    const double median = n % 2u ? value[n / 2u] : 0.5 * (value[n / 2u - 1u] + value[n / 2u]);
    const uint32_t p99 = (uint32_t)(0.99 * (double)(n - 1u) + 0.5);
    printf("%s %.5g\n", name, median);
    if (csv != NULL)
        fprintf(csv, "%s,%.5g,%.5g,%.5g,%u\n", name, median, value[p99], value[n - 1u], n);
    return median;
}

static void tell_one(const char *name, double value) { (void)tell(name, &value, 1); }

typedef struct bench_input {
    smr_mesh mesh[RIG_STRUCTURES_MAX], target[RIG_STRUCTURES_MAX];
    char name[RIG_STRUCTURES_MAX][SMR_NAME_BYTES], target_name[RIG_STRUCTURES_MAX][SMR_NAME_BYTES];
    const smr_surface *surface[RIG_STRUCTURES_MAX]; /* of each structure, or NULL */
    uint32_t n, n_vertices, n_target_vertices;
} bench_input;

static void read_input(bench_input *in)
{
    in->n = rig_folder("hip_thigh_vhm", in->mesh, in->name);
    const uint32_t n_targets = in->n > 0u ? rig_folder("hip_thigh_vhm_otherside", in->target, in->target_name) : 0u;
    for (uint32_t i = 0; i < in->n; i++) {
        in->n_vertices += in->mesh[i].n_vertices;
        for (uint32_t k = 0; k < n_targets; k++) {
            if (strcmp(in->name[i], in->target_name[k]) == 0) {
                in->surface[i] = rig_surface(&in->target[k]);
                in->n_target_vertices += in->target[k].n_vertices;
            }
        }
    }
    if (in->n == 0u) {
        fprintf(stderr, "bench_core: no ../shared/data/hip_thigh_vhm, measuring the fixture\n");
        rig_bone(4000u, 1.0f, &in->mesh[0], &in->target[0]);
        in->surface[0] = rig_surface(&in->target[0]);
        in->n = 1;
        in->n_vertices = in->mesh[0].n_vertices;
        in->n_target_vertices = in->target[0].n_vertices;
    }
}

static void bench_prepare(const bench_input *in, const smr_prepare_config *config)
{
    double time[5], list[5];
    size_t scratch = 0, bytes = 0;
    smr_prepare_config without = *config;
    smr_structure structure[RIG_STRUCTURES_MAX];
    memset(structure, 0, sizeof structure);
    for (uint32_t i = 0; i < in->n; i++)
        structure[i].mesh = in->mesh[i];
    (void)smr_prepare_bytes(structure, in->n, config, &scratch);
    void *memory = rig_alloc(scratch);
    (void)smr_prepare(structure, in->n, config, memory, scratch, NULL, 0, &bytes);
    void *image = rig_alloc(bytes);
    without.priority = 0;
    for (uint32_t i = 0; i < 5u; i++) {
        double before = seconds();
        if (smr_prepare(structure, in->n, config, memory, scratch, image, bytes, &bytes) != SMR_OK)
            abort();
        time[i] = seconds() - before;
        before = seconds();
        if (smr_prepare(structure, in->n, &without, memory, scratch, image, bytes, &bytes) != SMR_OK)
            abort();
        list[i] = time[i] - (seconds() - before);
    }
    (void)tell("prepare_s", time, 5);
    (void)tell("priority_s", list, 5);
}

static void set_targets(const bench_input *in, smr *s)
{
    for (uint32_t i = 0; i < in->n; i++)
        if (in->surface[i] != NULL && smr_set_surface(s, i, in->surface[i]) != SMR_OK)
            abort();
}

/* A registration that iterates for ever at one radius. elastic: x^r stays, so that nothing but matching is measured. */
static smr *endless(const bench_input *in, const smr_model *model, uint32_t method, int elastic, const smr_port *port)
{
    smr_config config = smr_config_default();
    config.basic.method = method;
    config.motion.settle_um = 0.0f;
    config.motion.plastic_um = elastic ? 0.0f : config.motion.plastic_um;
    config.motion.plastic_every = elastic ? 0u : config.motion.plastic_every;
    config.basic.iterations = config.basic.iterations_last = 100000;
    config.basic.n_workers = port->n_workers;
    config.basic.n_target_vertices = in->n_target_vertices;
    smr *s = rig_init(model, &config, port);
    set_targets(in, s);
    (void)rig_run(s, 3);
    return s;
}

/* Sums, matching and averaging of one tick, in ms. */
static double match_ms(smr *s)
{
    smr_tick_report r;
    (void)smr_tick(s, 0, &r);
    return 1.0e-6 * (double)(r.details.phase_ns[SMR_PHASE_SUMS] + r.details.phase_ns[SMR_PHASE_MATCH] +
                             r.details.phase_ns[SMR_PHASE_AVERAGE]);
}

static void bench_matching(const bench_input *in, const smr_model *model, const smr_prepare_config *radii)
{
    static double rigid[REPETITIONS], polar[REPETITIONS], direct[REPETITIONS], chain[REPETITIONS];
    const smr_port clock = {NULL, 1, NULL, nanoseconds};
    smr_prepare_config breadth = *radii;
    breadth.order = SMR_ORDER_BREADTH_FIRST;
    smr *s[2] = {endless(in, model, SMR_METHOD_RIGID, 1, &clock), endless(in, model, SMR_METHOD_POLAR, 1, &clock)};
    baseline plain = baseline_start(model), paper = baseline_start(rig_model(in->mesh, in->n, &breadth));
    for (uint32_t i = 0; i < REPETITIONS; i++) {
        rigid[i] = match_ms(s[0]);
        polar[i] = match_ms(s[1]);
        double before = seconds();
        baseline_match(&plain, 0);
        direct[i] = 1.0e3 * (seconds() - before);
        before = seconds();
        baseline_match(&paper, 1);
        chain[i] = 1.0e3 * (seconds() - before);
    }
    const double r = tell("match_rigid_ms", rigid, REPETITIONS), p = tell("match_polar_ms", polar, REPETITIONS);
    const double d = tell("match_direct_ms", direct, REPETITIONS), c = tell("match_chain_ms", chain, REPETITIONS);
    tell_one("match_polar_over_rigid", p / r);
    tell_one("match_direct_over_rigid", d / r);
    tell_one("match_chain_over_rigid", c / r);
}

static void bench_ticks(const bench_input *in, const smr_model *model)
{
    static double one[REPETITIONS], two[REPETITIONS], ratio[REPETITIONS];
    const smr_port plain = {NULL, 1, NULL, nanoseconds};
    const size_t bytes = smr_pthread_bytes(2);
    smr_pthread *pool = NULL;
    if (smr_pthread_create(&pool, rig_alloc(bytes), bytes, 2) != SMR_OK)
        abort();
    const smr_port threads = smr_pthread_port(pool);
    smr *s[2] = {endless(in, model, SMR_METHOD_RIGID, 0, &plain), endless(in, model, SMR_METHOD_RIGID, 0, &threads)};
    for (uint32_t i = 0; i < REPETITIONS; i++) {
        double before = seconds();
        (void)smr_tick(s[0], 0, NULL);
        one[i] = 1.0e3 * (seconds() - before);
        before = seconds();
        (void)smr_tick(s[1], 0, NULL);
        two[i] = 1.0e3 * (seconds() - before);
        ratio[i] = one[i] / two[i];
    }
    (void)tell("tick_ms", one, REPETITIONS);
    (void)tell("tick_2_threads_ms", two, REPETITIONS);
    (void)tell("speedup_2_threads", ratio, REPETITIONS);
    smr_pthread_destroy(pool);
}

static void bench_registration(const bench_input *in)
{
    double time[5];
    smr_tick_report report = {0};
    const smr_model *model = rig_model(in->mesh, in->n, NULL);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = in->n_target_vertices;
    smr *s = rig_init(model, &config, NULL);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    set_targets(in, s);
    for (uint32_t i = 0; i < 5u; i++) {
        const double before = seconds();
        (void)smr_set_pose(s, &same);
        report = rig_run(s, 100000);
        time[i] = seconds() - before;
    }
    (void)tell("registration_s", time, 5);
    tell_one("registration_iterations", (double)report.iteration);
}

static void bench_memory(const bench_input *in, const smr_model *model)
{
    smr_model_info info;
    size_t arena = 0;
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = in->n_target_vertices;
    (void)smr_model_get_info(model, &info);
    (void)smr_arena_bytes(model, &config, &arena);
    tell_one("vertices", (double)info.n_vertices);
    tell_one("indexes_per_cluster", (double)info.indexes_per_cluster[0]);
    tell_one("indexes_per_cluster_direct", (double)info.direct_per_cluster[0]);
    tell_one("bytes_per_vertex", (double)(arena + info.bytes) / (double)info.n_vertices);
    tell_one("bytes_per_vertex_arena", (double)arena / (double)info.n_vertices);
}

#define CARRIED 3000u

/* Points beside vertices, carried by the rest shape: bound once, after each tick, and back without being bound. */
static void bench_carry(const bench_input *in)
{
    float *rest = rig_alloc(3u * sizeof *rest * in->n_vertices), *points = rig_alloc(6u * sizeof *points * CARRIED);
    double time[3][REPETITIONS];
    size_t bytes = 0, at = 0;
    smr_carry *carry = NULL;
    for (uint32_t i = 0; i < in->n; at += 3u * (size_t)in->mesh[i++].n_vertices)
        memcpy(rest + at, in->mesh[i].xyz, 3u * sizeof *rest * in->mesh[i].n_vertices);
    for (uint32_t i = 0; i < 3u * CARRIED; i++)
        points[i] = rest[(i / 3u * 7919u % in->n_vertices) * 3u + i % 3u] + 3.0f;
    (void)smr_carry_bytes(in->n_vertices, CARRIED, 1, &bytes);
    void *memory = rig_alloc(bytes);
    for (uint32_t r = 0; r < REPETITIONS; r++) {
        const double start = seconds();
        (void)smr_carry_fit(rest, in->n_vertices, points, CARRIED, NULL, memory, bytes, &carry);
        const double fitted = seconds();
        (void)smr_carry_apply(carry, rest, points + 3u * CARRIED);
        const double applied = seconds();
        (void)smr_carry_map(carry, rest, 1, points, CARRIED / 100u, points + 3u * CARRIED, NULL);
        time[0][r] = 1.0e6 * (fitted - start) / (double)CARRIED;
        time[1][r] = 1.0e9 * (applied - fitted) / (double)CARRIED;
        time[2][r] = 1.0e6 * (seconds() - applied) / (double)(CARRIED / 100u);
    }
    (void)tell("carry_fit_us", time[0], REPETITIONS);
    (void)tell("carry_apply_ns", time[1], REPETITIONS);
    (void)tell("carry_inverse_us", time[2], REPETITIONS);
}

int main(int argc, char **argv)
{
    static bench_input in;
    if (argc > 1 && (csv = fopen(argv[1], "w")) == NULL) {
        fprintf(stderr, "bench_core: cannot write %s\n", argv[1]);
        return 2;
    }
    if (csv != NULL)
        fprintf(csv, "name,p50,p99,max,repetitions\n");
    read_input(&in);
    smr_prepare_config config = rig_radii(1, RADIUS_MM, 0, 0);
    config.separate_below_mm = 0.0f; /* structures share clusters */
    const smr_model *model = rig_model(in.mesh, in.n, &config);
    bench_memory(&in, model);
    bench_prepare(&in, &config);
    bench_matching(&in, model, &config);
    bench_ticks(&in, model);
    bench_registration(&in);
    bench_carry(&in);
    rig_free_all();
    return csv != NULL && fclose(csv) != 0;
}
