/* target_rig_scene.c: a bone onto a deformed one, or two structures of the computed thigh into a coarse image of a
 * patient.
 * SPDX-License-Identifier: MIT */
#include "target_rig.h"
#include "fixture_bone.h"
#include "fixture_volume.h"

#define TARGET_MEMORY static __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
#define TARGET_PARTS 2u
#define TARGET_POINTS 1024u /* of a structure */
#define TARGET_FACETS 2048u
#define TARGET_SIDE 48u /* voxels */
#define TARGET_VOXELS (TARGET_SIDE * TARGET_SIDE * TARGET_SIDE)
#define TARGET_TOP_MM 250.0f /* of 431: height above which an open target has nothing */

#define TARGET_ARENA                                                                                                   \
    (SMR_ARENA_BYTES(TARGET_PARTS * TARGET_POINTS, TARGET_PARTS * TARGET_FACETS, TARGET_PARTS, 1, TARGET_POINTS,       \
                     SMR_METHOD_POLAR) +                                                                               \
     SMR_ARENA_TRACK_BYTES(TARGET_PARTS * TARGET_POINTS, TARGET_PARTS) +                                               \
     SMR_ARENA_CONTACT_BYTES(TARGET_PARTS * TARGET_POINTS, TARGET_PARTS * TARGET_FACETS, TARGET_PARTS) +               \
     SMR_ARENA_SMOOTH_BYTES(TARGET_PARTS * TARGET_POINTS) + SMR_ARENA_VOLUME_BYTES(TARGET_PARTS))

TARGET_MEMORY unsigned char target_arena[2][(TARGET_ARENA + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN]; /* both aligned */
TARGET_MEMORY unsigned char target_scratch[6u << 20];
TARGET_MEMORY unsigned char target_image[3u << 20];
TARGET_MEMORY unsigned char target_surface[1u << 20];
TARGET_MEMORY float target_words[FIXTURE_THIGH_SCRATCH];
TARGET_MEMORY float target_xyz[TARGET_PARTS][3 * TARGET_POINTS];
TARGET_MEMORY uint32_t target_triangles[TARGET_PARTS][3 * TARGET_FACETS];
TARGET_MEMORY fixture_thigh target_thigh;
TARGET_MEMORY unsigned char target_voxels[2][TARGET_VOXELS];
TARGET_MEMORY float target_slice[FIXTURE_IMAGE_SCRATCH(TARGET_SIDE, TARGET_SIDE)];
TARGET_MEMORY float target_begin[TARGET_PARTS][3 * TARGET_POINTS]; /* where an image registration starts */

static fixture_mesh target_room(uint32_t i)
{
    return (fixture_mesh){target_xyz[i], target_triangles[i], TARGET_POINTS, TARGET_FACETS, 0, 0};
}

static smr_mesh target_mesh(const fixture_mesh *m)
{
    return (smr_mesh){m->xyz, m->triangles, m->n_vertices, m->n_triangles};
}

static int target_prepare(const smr_structure *part, uint32_t n, const smr_prepare_config *config, target_scene *scene)
{
    size_t bytes = 0;
    return smr_prepare(part, n, config, target_scratch, sizeof target_scratch, target_image, sizeof target_image,
                       &bytes) == SMR_OK &&
           smr_model_open(target_image, bytes, &scene->model) == SMR_OK;
}

/* Leaves out the triangles above: the vertices that only they have draw nothing. */
static void target_cut(fixture_mesh *m, float most_z)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *const t = m->triangles + 3u * (size_t)i;
        if (m->xyz[3u * (size_t)t[0] + 2u] > most_z || m->xyz[3u * (size_t)t[1] + 2u] > most_z ||
            m->xyz[3u * (size_t)t[2] + 2u] > most_z)
            continue;
        memmove(m->triangles + 3u * (size_t)kept++, t, 3u * sizeof *t);
    }
    m->n_triangles = kept;
}

static int target_bone(target_scene *scene)
{
    fixture_grid grid[2] = {fixture_grid_source(FIXTURE_CELL_SMALL), fixture_grid_target(FIXTURE_CELL_SMALL)};
    fixture_mesh m[2] = {target_room(0), target_room(1)};
    smr_structure structure = {"bone", {NULL, NULL, 0, 0}};
    smr_prepare_config config = smr_prepare_config_default();
    const size_t words = sizeof target_words / sizeof target_words[0];
    if (!fixture_bone_source(&grid[0], &m[0], target_words, words) ||
        !fixture_bone_target(&grid[1], 1.0f, &m[1], target_words, words))
        return 0;
    if (scene->what->part)
        target_cut(&m[1], TARGET_TOP_MM);
    structure.mesh = target_mesh(&m[0]);
    const smr_mesh goal = scene->goal = target_mesh(&m[1]);
    config.n_radii = 2;
    config.radius_mm[0] = 90.0f;
    config.radius_mm[1] = 45.0f;
    return target_prepare(&structure, 1, &config, scene) &&
           smr_surface_build(&goal, target_surface, sizeof target_surface, &scene->surface) == SMR_OK;
}

/* Image i of the two, of the same box each time: drawn once, for that takes longer than a registration. */
static int target_volume(uint32_t i, const fixture_pose *pose, const fixture_box *box, smr_volume *volume)
{
    static int drawn[2];
    if (box->n[0] > TARGET_SIDE || box->n[1] > TARGET_SIDE || box->n[0] * box->n[1] * box->n[2] > TARGET_VOXELS)
        return 0;
    if (!drawn[i])
        fixture_thigh_slices(&target_thigh, pose, box, target_voxels[i], target_slice);
    drawn[i] = 1;
    *volume = fixture_volume(box, target_voxels[i]);
    return 1;
}

static int target_thigh_in_image(target_scene *scene)
{
    smr_prepare_config config = smr_prepare_config_default();
    smr_structure part[TARGET_PARTS];
    fixture_mesh m[TARGET_PARTS] = {target_room(0), target_room(1)};
    fixture_pair pair;
    smr_volume reference;
    float *const begin[TARGET_PARTS] = {target_begin[0], target_begin[1]};
    if (!fixture_thigh_pair(&target_thigh, m, begin, target_words, &pair) ||
        !target_volume(0, &pair.pose[0], &pair.box[0], &reference) ||
        !target_volume(1, &pair.pose[1], &pair.box[1], &scene->volume))
        return 0;
    for (uint32_t i = 0; i < TARGET_PARTS; i++)
        part[i] = (smr_structure){pair.name[i], target_mesh(&m[i])};
    config.reference = &reference;
    return target_prepare(part, TARGET_PARTS, &config, scene);
}

int target_set_up(const target_case *what, target_scene *scene)
{
    memset(scene, 0, sizeof *scene);
    scene->what = what;
    return what->image ? target_thigh_in_image(scene) : target_bone(scene);
}

smr_config target_config(const target_scene *scene)
{
    smr_config config = scene->what->image ? smr_config_default_image() : smr_config_default();
    config.basic.method = scene->what->method;
    config.schedule.active_enough = 0;
    config.basic.iterations = 5;
    config.basic.iterations_last = 12;
    config.basic.n_target_vertices = scene->what->image ? 0u : TARGET_POINTS;
    if (scene->what->more) {
        config.contact.share = config.contact.volume = 1.0f;
        config.contact.smooth = 0.3f;
        config.motion.fusing = SMR_FUSING_LIE;
        config.contact.n_fixed = scene->what->image ? 0u : 1u;
    }
    if (scene->what->moves) {
        config.dynamics.mode = SMR_DYNAMICS_ON;
        config.dynamics.damping = 1.0f;
        config.dynamics.gravity[2] = -9810.0f;
        config.track.radius_mm = 45.0f;
    }
    return config;
}

int target_again(const target_scene *scene, smr *s)
{
    static const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (uint32_t i = 0; scene->what->image && i < TARGET_PARTS; i++)
        if (smr_set_positions(s, i, target_begin[i]) != SMR_OK)
            return 0;
    return scene->what->image || smr_set_pose(s, &same) == SMR_OK;
}

smr *target_start(const target_scene *scene, const smr_config *config, const smr_port *port, uint32_t arena)
{
    smr *s = NULL;
    if (smr_init(scene->model, config, port, target_arena[arena], sizeof target_arena[arena], &s) != SMR_OK ||
        !target_again(scene, s))
        return NULL;
    if ((scene->what->image ? smr_set_volume(s, &scene->volume) : smr_set_surface(s, SMR_ALL, scene->surface)) !=
        SMR_OK)
        return NULL;
    /* the bone's target is what it must keep out of, too: where it goes it touches it */
    if (config->contact.n_fixed > 0u && smr_set_fixed(s, 0, scene->surface) != SMR_OK)
        return NULL;
    return s;
}
