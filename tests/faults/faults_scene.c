/* faults_scene.c: small registrations for a campaign of bit flips: two bodies that keep apart, a cloud, an image, a
 * target that is followed, and a body that swings.
 * SPDX-License-Identifier: MIT */
#include "faults_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "property/rig.h"

const char *const faults_kind_name[FAULTS_KINDS] = {"model", "arena", "surface", "cloud", "voxels"};
enum { MODEL, ARENA, SURFACE, CLOUD, VOXELS };

#define BALL_MM 20.0f
#define IMAGE_SIDE 28u
#define IMAGE_MM 2.2f

static int failed(const faults_scene *s, const char *what, int status)
{
    fprintf(stderr, "faults: %s: %s: %s\n", s->name, what, smr_status_name((smr_status)status));
    return 0;
}

static faults_block *add_block(faults_scene *s, uint32_t kind, size_t bytes)
{
    s->kind[s->n_blocks] = kind;
    s->block[s->n_blocks] = faults_alloc(bytes);
    return &s->block[s->n_blocks++];
}

/* A ball with three bumps, so that its pose is determined. */
static smr_mesh body(uint32_t rings, float shift, float larger)
{
    const float middle[3] = {0, 0, 0};
    smr_mesh mesh = rig_ball(BALL_MM, rings, 12, middle);
    float *xyz = rig_alloc(3u * mesh.n_vertices * sizeof *xyz);
    for (uint32_t v = 0; v < mesh.n_vertices; v++) {
        const float *p = mesh.xyz + 3u * (size_t)v;
        const float x = p[0] / BALL_MM, y = p[1] / BALL_MM, z = p[2] / BALL_MM;
        const float bump = 1.0f + 0.35f * x * x * x + 0.25f * y * z + 0.3f * z;
        for (uint32_t a = 0; a < 3u; a++)
            xyz[3u * v + a] = p[a] * bump * larger + (a == 0u ? shift : 0.0f);
    }
    mesh.xyz = xyz;
    return mesh;
}

static smr_volume image_of(faults_scene *s, float larger)
{
    faults_block *b = add_block(s, VOXELS, IMAGE_SIDE * IMAGE_SIDE * IMAGE_SIDE);
    const float low = -0.5f * IMAGE_MM * (float)(IMAGE_SIDE - 1u);
    smr_volume v = {.voxels = b->use,
                    .type = SMR_VOXEL_UINT8,
                    .size = {IMAGE_SIDE, IMAGE_SIDE, IMAGE_SIDE},
                    .origin = {low, low, low},
                    .spacing = {IMAGE_MM, IMAGE_MM, IMAGE_MM},
                    .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (uint32_t i = 0; i < IMAGE_SIDE * IMAGE_SIDE * IMAGE_SIDE; i++) {
        const uint32_t at[3] = {i % IMAGE_SIDE, i / IMAGE_SIDE % IMAGE_SIDE, i / IMAGE_SIDE / IMAGE_SIDE};
        float p[3], r2 = 0.0f;
        for (uint32_t a = 0; a < 3u; a++) {
            p[a] = (low + IMAGE_MM * (float)at[a]) / BALL_MM / larger;
            r2 += p[a] * p[a];
        }
        /* the body's radius in this direction, nearly: bumps at the surface, scaled */
        const float bump = 1.0f + 0.35f * p[0] * p[0] * p[0] + 0.25f * p[1] * p[2] + 0.3f * p[2];
        const float inside = 8.0f * (bump * bump - r2), share = inside > 1.0f ? 1.0f : inside < -1.0f ? -1.0f : inside;
        b->own[i] = (unsigned char)(120.0f + 100.0f * share);
    }
    return v;
}

static const smr_model *model_of(faults_scene *s, const smr_mesh *mesh, uint32_t n, const smr_volume *reference)
{
    smr_prepare_config c = rig_radii(reference == NULL ? 3 : 2, 25, 12, 2);
    smr_model_info info;
    const smr_model *made, *model = NULL;
    c.reference = reference;
    c.block_vertices = 64;
    made = rig_model(mesh, n, &c);
    (void)smr_model_get_info(made, &info);
    faults_block *b = &s->block[FAULTS_MODEL];
    *b = faults_alloc(info.bytes);
    memcpy(b->own, made, info.bytes);
    const int status = smr_model_open(b->use, info.bytes, &model);
    s->n_structures = n;
    s->n_vertices = info.n_vertices;
    return status == SMR_OK ? model : NULL;
}

static const smr_surface *surface_of(faults_scene *s, const smr_mesh *mesh)
{
    size_t bytes = 0;
    smr_surface *surface = NULL;
    if (smr_surface_bytes(mesh->n_vertices, mesh->n_triangles, &bytes) == SMR_OK &&
        smr_surface_build(mesh, add_block(s, SURFACE, bytes)->use, bytes, &surface) != SMR_OK)
        return NULL;
    return surface;
}

static const smr_points *cloud_of(faults_scene *s, const smr_mesh *mesh)
{
    size_t bytes = 0;
    smr_points *points = NULL;
    if (smr_points_bytes(mesh->n_vertices + 8u, &bytes) != SMR_OK ||
        smr_points_open(mesh->n_vertices + 8u, add_block(s, CLOUD, bytes)->use, bytes, &points) != SMR_OK ||
        smr_points_add(points, mesh->xyz, NULL, NULL, mesh->n_vertices) != SMR_OK)
        return NULL;
    return points;
}

static smr_config settings(uint32_t n_target_vertices)
{
    smr_config c = smr_config_default();
    c.basic.iterations = 2;
    c.basic.iterations_last = 5;
    c.basic.n_target_vertices = n_target_vertices;
    return c;
}

/* Starts a registration in a block. */
static int start(faults_scene *s, const smr_model *model, const smr_config *config)
{
    size_t bytes = 0;
    int status = model == NULL ? SMR_E_MODEL : smr_arena_bytes(model, config, &bytes);
    if (status == SMR_OK) {
        s->block[FAULTS_ARENA] = faults_alloc(bytes);
        status = smr_init(model, config, NULL, s->block[FAULTS_ARENA].use, bytes, &s->s);
    }
    return status == SMR_OK || failed(s, "start", status);
}

/* Two bodies onto their surfaces: contact, volumes, smoothing; one target is cut, so that a part is not visible. */
static int start_bodies(faults_scene *s)
{
    const smr_mesh part[2] = {body(9, -26, 1), body(8, 26, 1)}, goal[2] = {body(10, -27, 1.05f), body(9, 27, 1.03f)};
    const smr_model *model = model_of(s, part, 2, NULL);
    smr_mesh open = goal[1];
    open.n_triangles -= open.n_triangles / 10u;
    const smr_surface *a = surface_of(s, &goal[0]), *b = surface_of(s, &open);
    smr_config c = settings(goal[0].n_vertices + goal[1].n_vertices);
    c.contact.share = 1.0f;
    c.contact.volume = 0.3f;
    c.contact.smooth = 0.1f;
    return start(s, model, &c) && smr_set_surface(s->s, 0, a) == SMR_OK && smr_set_surface(s->s, 1, b) == SMR_OK;
}

/* A body onto a cloud of points. */
static int start_cloud(faults_scene *s)
{
    const smr_mesh part = body(10, 0, 1), goal = body(11, 1, 1.04f);
    const smr_model *model = model_of(s, &part, 1, NULL);
    const smr_points *points = cloud_of(s, &goal);
    const smr_config c = settings(goal.n_vertices + 8u);
    return start(s, model, &c) && smr_set_points(s->s, 0, points) == SMR_OK;
}

/* A body into an image. */
static int start_image(faults_scene *s)
{
    const smr_mesh part = body(9, 0, 1);
    const smr_volume reference = image_of(s, 1.0f);
    s->n_blocks = FAULTS_FIRST_INPUT;
    const smr_model *model = model_of(s, &part, 1, &reference);
    const smr_volume volume = image_of(s, 1.06f);
    smr_config c = smr_config_default_image();
    c.basic.iterations = 2;
    c.basic.iterations_last = 5;
    c.image.profile_mm = 6.0f;
    return start(s, model, &c) && smr_set_volume(s->s, &volume) == SMR_OK;
}

/* A body that follows a surface, with landmarks. */
static int start_track(faults_scene *s)
{
    const smr_mesh part = body(9, 0, 1), goal = body(10, 1, 1.04f);
    const smr_model *model = model_of(s, &part, 1, NULL);
    const smr_surface *surface = surface_of(s, &goal);
    smr_landmark landmark[2] = {{.vertex = 3, .weight = 1.0f}, {.vertex = 50, .hard = 1}};
    smr_config c = settings(goal.n_vertices);
    c.partial.n_landmarks = 2;
    c.track.mode = SMR_TRACK_RECOVER;
    c.track.ahead = 0.5f;
    for (uint32_t k = 0; k < 2u; k++)
        for (uint32_t a = 0; a < 3u; a++)
            landmark[k].place[a] = 1.04f * part.xyz[3u * landmark[k].vertex + a] + (a == 0u ? 1.0f : 0.0f);
    return start(s, model, &c) && smr_set_surface(s->s, 0, surface) == SMR_OK &&
           smr_set_landmarks(s->s, landmark, 2) == SMR_OK;
}

/* A body that is drawn onto a surface, and swings; clusters are polar, and goals have the caller's beside them. */
static int start_swing(faults_scene *s)
{
    const smr_mesh part = body(9, 0, 1), goal = body(10, 1, 1.0f);
    const smr_model *model = model_of(s, &part, 1, NULL);
    const smr_surface *surface = surface_of(s, &goal);
    smr_config c = settings(goal.n_vertices);
    c.basic.method = SMR_METHOD_POLAR;
    c.dynamics.mode = SMR_DYNAMICS_ON;
    return start(s, model, &c) && smr_set_surface(s->s, 0, surface) == SMR_OK;
}

int faults_positions(const faults_scene *s, float *xyz)
{
    uint32_t done = 0;
    for (uint32_t i = 0; i < s->n_structures; i++) {
        if (smr_get_positions(s->s, i, xyz + 3u * (size_t)done) != SMR_OK)
            return 0;
        done += s->size[i];
    }
    return 1;
}

static int keep(faults_scene *s, uint32_t tick)
{
    const faults_block *arena = &s->block[FAULTS_ARENA];
    s->tick[tick].arena = rig_alloc(arena->bytes);
    s->tick[tick].xyz = rig_alloc(3u * s->n_vertices * sizeof(float));
    memcpy(s->tick[tick].arena, arena->own, arena->bytes);
    return faults_positions(s, s->tick[tick].xyz);
}

int faults_finish(faults_scene *s, uint32_t from, smr_verdict *verdict)
{
    smr_tick_report report;
    for (uint32_t tick = from; tick < s->n_ticks; tick++) {
        s->at = tick;
        const int status = smr_tick(s->s, 0, &report);
        if (status < 0)
            return status;
    }
    s->at = s->n_ticks;
    const int checked = s->seal ? smr_scrub(s->s, 0) : SMR_OK;
    return checked < 0 ? checked : smr_get_verdict(s->s, SMR_ALL, verdict);
}

/* Runs a scene without a fault. */
static int run(faults_scene *s, int (*begin)(faults_scene *s))
{
    smr_tick_report report = {0};
    smr_verdict verdict;
    smr_structure_info info;
    s->n_blocks = FAULTS_FIRST_INPUT;
    s->kind[FAULTS_MODEL] = MODEL;
    s->kind[FAULTS_ARENA] = ARENA;
    if (!begin(s))
        return failed(s, "inputs", SMR_E_INPUT);
    for (uint32_t i = 0; i < s->n_structures; i++) {
        (void)smr_model_structure((const smr_model *)s->block[FAULTS_MODEL].use, i, &info);
        s->size[i] = info.n_vertices;
    }
    s->found = rig_alloc(3u * s->n_vertices * sizeof(float));
    for (uint32_t k = 0; k < s->n_blocks; k++) {
        faults_writable(&s->block[k], k == FAULTS_ARENA);
        s->clean[k] = rig_alloc(s->block[k].bytes);
        memcpy(s->clean[k], s->block[k].own, s->block[k].bytes);
    }
    int status = s->seal ? smr_set_scrub(s->s, SMR_SCRUB_INPUTS + SMR_SCRUB_STATE) : SMR_OK;
    status = status == SMR_OK && !keep(s, 0) ? SMR_E_STATE : status;
    while (status == SMR_OK && !report.done && s->n_ticks < FAULTS_TICKS) {
        status = smr_tick(s->s, 0, &report);
        s->n_ticks++;
        if (status == SMR_OK && !keep(s, s->n_ticks))
            status = SMR_E_STATE;
    }
    if (status == SMR_OK)
        status = faults_finish(s, s->n_ticks, &verdict);
    if (status != SMR_OK)
        return failed(s, "run", status);
    if (verdict.level != SMR_VERDICT_GOOD)
        fprintf(stderr, "faults: %s: verdict %u, reasons %u, probability %.2f\n", s->name, verdict.level,
                verdict.reasons, (double)verdict.probability);
    return verdict.level == SMR_VERDICT_GOOD;
}

void faults_clean(faults_scene scene[FAULTS_SCENES])
{
    for (uint32_t i = 0; i < FAULTS_SCENES; i++)
        for (uint32_t k = 0; k < scene[i].n_blocks; k++)
            memcpy(scene[i].block[k].own, scene[i].clean[k], scene[i].block[k].bytes);
}

int faults_scenes(faults_scene scene[FAULTS_SCENES], int seal)
{
    static const struct {
        const char *name;
        int (*begin)(faults_scene *s);
    } of[FAULTS_SCENES] = {{"bodies", start_bodies},
                           {"cloud", start_cloud},
                           {"image", start_image},
                           {"track", start_track},
                           {"swing", start_swing}};
    int good = 1;
    for (uint32_t i = 0; i < FAULTS_SCENES; i++) {
        scene[i].name = of[i].name;
        scene[i].seal = (uint32_t)seal;
        good &= run(&scene[i], of[i].begin);
    }
    return good;
}
