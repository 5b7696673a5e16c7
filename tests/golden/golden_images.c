/* golden_images.c: golden runs into an image: two structures of the computed thigh.
 * SPDX-License-Identifier: MIT */
#include "fixture_volume.h"
#include "golden.h"

/* Two structures of the computed thigh in a coarse image, and a patient's. */
#define GOLDEN_PARTS 2u
#define GOLDEN_VOXELS (48u * 48u * 48u)
static GOLDEN_MEMORY unsigned char golden_voxels[2][GOLDEN_VOXELS];
static GOLDEN_MEMORY fixture_thigh golden_thigh;
static GOLDEN_MEMORY float golden_thigh_words[FIXTURE_THIGH_SCRATCH];
static GOLDEN_MEMORY float golden_slice[FIXTURE_IMAGE_SCRATCH(48, 48)];
static GOLDEN_MEMORY float golden_start[GOLDEN_PARTS][3 * 1024];
static smr_structure golden_part[GOLDEN_PARTS];
static smr_volume golden_volumes[2]; /* the model's image and the patient's; drawn once, for that takes longest */

static int golden_volume(const fixture_pose *pose, const fixture_box *box, unsigned char *voxels, smr_volume *volume)
{
    if (box->n[0] > 48u || box->n[1] > 48u || box->n[0] * box->n[1] * box->n[2] > GOLDEN_VOXELS)
        return golden_ok("volume", SMR_E_ARENA);
    fixture_thigh_slices(&golden_thigh, pose, box, voxels, golden_slice);
    *volume = fixture_volume(box, voxels);
    return 1;
}

/* Meshes and both images; golden_start is 4 mm beside the truth. */
static int golden_draw(void)
{
    fixture_mesh m[GOLDEN_PARTS];
    fixture_pair pair;
    float *const start[GOLDEN_PARTS] = {golden_start[0], golden_start[1]};
    for (uint32_t i = 0; i < GOLDEN_PARTS; i++)
        m[i] = (fixture_mesh){golden_xyz[i], golden_triangles[i], 1024, 2048, 0, 0};
    if (!fixture_thigh_pair(&golden_thigh, m, start, golden_thigh_words, &pair))
        return golden_ok("thigh", SMR_E_ARENA);
    for (uint32_t i = 0; i < GOLDEN_PARTS; i++) {
        golden_part[i].name = pair.name[i];
        golden_part[i].mesh = (smr_mesh){m[i].xyz, m[i].triangles, m[i].n_vertices, m[i].n_triangles};
    }
    return golden_volume(&pair.pose[0], &pair.box[0], golden_voxels[0], &golden_volumes[0]) &&
           golden_volume(&pair.pose[1], &pair.box[1], golden_voxels[1], &golden_volumes[1]);
}

/* The model with profiles, in golden_image. */
static int golden_image_model(smr_prepare_config config, const smr_model **model, size_t *bytes)
{
    size_t need = 0;
    config.reference = &golden_volumes[0];
    return golden_ok("image bytes", smr_prepare_bytes(golden_part, GOLDEN_PARTS, &config, &need)) &&
           golden_ok("image scratch", need <= sizeof golden_scratch ? SMR_OK : SMR_E_ARENA) &&
           golden_ok("image prepare", smr_prepare(golden_part, GOLDEN_PARTS, &config, golden_scratch,
                                                  sizeof golden_scratch, golden_image, sizeof golden_image, bytes)) &&
           golden_ok("image open", smr_model_open(golden_image, *bytes, model));
}

/* From beside the truth back onto the patient's image. */
static int golden_image_run(const smr_port *port, smr_prepare_config prepare, smr_config config, uint64_t *hash,
                            uint32_t *crc)
{
    const smr_model *model = NULL;
    smr_tick_report report;
    smr *s = NULL;
    size_t bytes = 0;
    config.basic.n_workers = GOLDEN_WORKERS;
    if (!golden_image_model(prepare, &model, &bytes) ||
        !golden_ok("image init", smr_init(model, &config, port, golden_arena, sizeof golden_arena, &s)))
        return 0;
    for (uint32_t i = 0; i < GOLDEN_PARTS; i++)
        if (!golden_ok("image start", smr_set_positions(s, i, golden_start[i])))
            return 0;
    if (!golden_ok("image volume", smr_set_volume(s, &golden_volumes[1])) ||
        !golden_ticks(&s, model, NULL, &golden_volumes[1], &report))
        return 0;
    *hash = smr_state_hash(s);
    *crc = golden_crc(golden_image, bytes);
    return golden_ok("image forces", report.done && report.n_forces > 100u && report.details.plastic_updates > 1u
                                         ? SMR_OK
                                         : SMR_E_STATE);
}

int golden_images(const smr_port *port, uint64_t hash[2], uint32_t *crc)
{
    smr_config config = smr_config_default(), paper = smr_config_paper();
    uint32_t unused;
    config.motion.plastic_every = 3;
    config.basic.iterations = 4;
    config.basic.iterations_last = config.schedule.active_enough = 6;
    paper.basic.iterations_last = 12;
    paper.motion.plastic_um = 200.0f; /* so that x^r follows */
    return (golden_volumes[1].voxels != NULL || golden_draw()) &&
           golden_image_run(port, smr_prepare_config_default(), config, &hash[0], crc) &&
           golden_image_run(port, smr_prepare_config_paper(), paper, &hash[1], &unused);
}
