/* twin_tool.c: the registrations of python_calls.py by the C interface: what both print must be the same.
 * usage: twin_tool DIR N_VERTICES N_TRIANGLES VOXELS     reads what python_calls.py wrote in DIR
 * SPDX-License-Identifier: MIT */
#include <smr_pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROOM = 1 << 26, FRAMES = 5, MARKS = 6, CARRIED = 9 };
static _Alignas(SMR_ALIGN) unsigned char memory[ROOM]; /* handed out in pieces that never come back */
static size_t taken;
static uint32_t nv, nt, voxels;
static const float *rest, *now, *frames, *points;
static const uint32_t *triangles;
static smr_port port;

static void *take(size_t bytes)
{
    unsigned char *const at = memory + taken;
    taken += (bytes + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    if (taken > ROOM)
        exit(3);
    return at;
}

static void need(smr_status status)
{
    if (status < 0) {
        (void)printf("twin_tool: %s\n", smr_status_name(status));
        exit(1);
    }
}

static const void *load(const char *dir, const char *name, size_t bytes)
{
    char path[4096];
    void *const to = take(bytes);
    (void)snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *const file = fopen(path, "rb");
    if (file == NULL || fread(to, 1, bytes, file) != bytes)
        exit(2);
    (void)fclose(file);
    return to;
}

static void show(const char *name, const float *value, int n)
{
    (void)printf("%s", name);
    for (int i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &value[i], sizeof bits);
        (void)printf(" %08x", bits);
    }
    (void)printf("\n");
}

static smr_surface *surface_of(const float *xyz)
{
    const smr_mesh mesh = {xyz, triangles, nv, nt};
    smr_surface *surface;
    size_t bytes;
    need(smr_surface_bytes(nv, nt, &bytes));
    need(smr_surface_build(&mesh, take(bytes), bytes, &surface));
    return surface;
}

static const smr_model *model_of(const smr_volume *reference)
{
    const smr_structure structure = {"bone", {rest, triangles, nv, nt}};
    smr_prepare_config config = smr_prepare_config_default();
    const smr_model *model;
    size_t scratch_bytes, bytes;
    config.reference = reference;
    need(smr_prepare_bytes(&structure, 1, &config, &scratch_bytes));
    void *const scratch = take(scratch_bytes);
    need(smr_prepare(&structure, 1, &config, scratch, scratch_bytes, NULL, 0, &bytes));
    void *const at = take(bytes);
    need(smr_prepare(&structure, 1, &config, scratch, scratch_bytes, at, bytes, &bytes));
    need(smr_model_open(at, bytes, &model));
    return model;
}

static smr *begin(const smr_model *model, const smr_config *config)
{
    size_t bytes;
    smr *s;
    need(smr_arena_bytes(model, config, &bytes));
    need(smr_init(model, config, &port, take(bytes), bytes, &s));
    return s;
}

static void run(smr *s, uint32_t most)
{
    smr_tick_report report = {0};
    for (uint32_t i = 0; i < most && !report.done && !report.details.settled; i++)
        need(smr_tick(s, 0, &report));
}

static void end(const char *name, smr *s)
{
    smr_verdict verdict;
    (void)printf("%s %016llx\n", name, (unsigned long long)smr_state_hash(s));
    need(smr_get_verdict(s, SMR_ALL, &verdict));
    (void)printf("%s.verdict %u %u", name, verdict.level, verdict.reasons);
    show("", &verdict.probability, 22); /* all figures behind it are floats, too */
}

static void surfaces(const smr_model *model)
{
    smr_config config = smr_config_default();
    smr_surface *const target = surface_of(now);
    config.basic.n_target_vertices = nv;
    smr *s = begin(model, &config);
    need(smr_set_surface(s, SMR_ALL, target));
    run(s, 1000000);
    end("surface", s);
    config.basic.method = SMR_METHOD_POLAR;
    config.basic.search_mm = 25.0f;
    s = begin(model, &config);
    need(smr_set_surface(s, SMR_ALL, target));
    run(s, 12);
    end("polar", s);
}

static void aligned(void)
{
    const smr_align_config config = smr_align_config_default();
    smr_align_report report;
    smr_pose pose;
    size_t bytes;
    need(smr_align_bytes(&config, &bytes));
    need(smr_align(surface_of(rest), surface_of(now), &config, take(bytes), bytes, &pose, &report));
    show("align", &pose.m[0][0], 12);
}

static void clouds(const smr_model *model)
{
    smr_config config = smr_config_default();
    smr_points *cloud;
    size_t bytes;
    need(smr_points_bytes(nv, &bytes));
    need(smr_points_open(nv, take(bytes), bytes, &cloud));
    need(smr_points_add(cloud, now, NULL, NULL, nv / 2));
    config.basic.n_target_vertices = nv;
    smr *const s = begin(model, &config);
    need(smr_set_points(s, SMR_ALL, cloud));
    run(s, 1000000);
    end("points", s);
}

static void marks(const smr_model *model)
{
    smr_config config = smr_config_default();
    smr_landmark mark[MARKS];
    memset(mark, 0, sizeof mark);
    config.partial.n_landmarks = MARKS;
    for (uint32_t i = 0; i < MARKS; i++) {
        mark[i].vertex = i * (nv / MARKS);
        mark[i].weight = 2.0f;
        mark[i].hard = i % 2;
        memcpy(mark[i].place, now + 3 * mark[i].vertex, sizeof mark[i].place);
    }
    smr *const s = begin(model, &config);
    need(smr_set_landmarks(s, mark, MARKS));
    run(s, 1000000);
    end("landmarks", s);
}

static smr_volume volume_of(const void *at)
{
    const smr_volume volume = {
        at, NULL, SMR_VOXEL_UINT8, {voxels, voxels, voxels}, {-45, -45, -70}, {3, 3, 4}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    return volume;
}

static void images(const char *dir)
{
    const size_t bytes = (size_t)voxels * voxels * voxels;
    const smr_volume reference = volume_of(load(dir, "reference.u8", bytes));
    const smr_volume target = volume_of(load(dir, "image.u8", bytes));
    const smr_config config = smr_config_default_image();
    smr *const s = begin(model_of(&reference), &config);
    need(smr_set_volume(s, &target));
    run(s, 1000000);
    end("image", s);
}

static void tracked(const smr_model *model)
{
    smr_config config = smr_config_default();
    smr_surface *const target = surface_of(frames);
    config.basic.n_target_vertices = nv;
    config.track.mode = SMR_TRACK_RECOVER;
    smr *const s = begin(model, &config);
    for (uint32_t i = 0; i < FRAMES; i++) {
        if (i > 0) {
            need(smr_surface_refit(target, frames + 3u * (size_t)nv * i));
            need(smr_surface_step(target, 0, NULL, 0));
        }
        need(smr_set_surface(s, SMR_ALL, target));
        run(s, i > 0 ? 30 : 1000000);
        (void)printf("track.%u %016llx\n", i, (unsigned long long)smr_state_hash(s));
    }
}

static void carried(void)
{
    float xyz[3 * CARRIED], facts[2 * CARRIED];
    smr_carry *carry;
    size_t bytes;
    need(smr_carry_bytes(nv, CARRIED, 1, &bytes));
    need(smr_carry_fit(rest, nv, points, CARRIED, NULL, take(bytes), bytes, &carry));
    need(smr_carry_apply(carry, now, xyz));
    show("carry", xyz, 3 * CARRIED);
    need(smr_carry_map(carry, now, 1, points, CARRIED, xyz, (smr_carry_fact *)(void *)facts));
    show("back", xyz, 3 * CARRIED);
    show("facts", facts, 2 * CARRIED);
}

int main(int argc, char **argv)
{
    smr_pthread *pool;
    if (argc != 5)
        return 2;
    nv = (uint32_t)atoi(argv[2]);
    nt = (uint32_t)atoi(argv[3]);
    voxels = (uint32_t)atoi(argv[4]);
    rest = load(argv[1], "rest.f32", 12u * (size_t)nv);
    now = load(argv[1], "now.f32", 12u * (size_t)nv);
    frames = load(argv[1], "frames.f32", 12u * (size_t)nv * FRAMES);
    points = load(argv[1], "points.f32", 12u * CARRIED);
    triangles = load(argv[1], "triangles.u32", 12u * (size_t)nt);
    const size_t bytes = smr_pthread_bytes(1);
    need(smr_pthread_create(&pool, take(bytes), bytes, 1));
    port = smr_pthread_port(pool);
    const smr_model *const model = model_of(NULL);
    surfaces(model);
    aligned();
    clouds(model);
    marks(model);
    images(argv[1]);
    tracked(model);
    carried();
    smr_pthread_destroy(pool);
    return 0;
}
