/* answers_run.c: registrations of which answers.c asks everything: a bone onto surfaces and clouds that show all of it,
 * a part, or more; drawn by landmarks, tracked, in time, with shapes of further subjects; and two structures of the
 * computed thigh in contact and in images.
 * SPDX-License-Identifier: MIT */
#include "answers.h"
#include "fixture_bone.h"
#include "fixture_volume.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static smr_mesh bone[2];        /* the model's, and a deformed one */
static const smr_model *model;  /* of the first */
static smr_structure thigh[2];  /* patella, vastus medialis */
static float *truth[2];         /* their places in the patient, a little off */
static smr_volume image[2];     /* of the model, and of the patient */
static const smr_model *imaged; /* both structures with profiles */

/* ---- inputs of all lines */

static void make_bones(void)
{
    for (int i = 0; i < 2; i++) {
        const fixture_grid grid =
            i == 0 ? fixture_grid_source(FIXTURE_CELL_SMALL) : fixture_grid_target(FIXTURE_CELL_SMALL);
        fixture_mesh m = {answers_room(12u * 1024u), answers_room(12u * 2048u), 1024, 2048, 0, 0};
        float *const words = answers_room(4u * 16384u);
        answers_need(i == 0 ? fixture_bone_source(&grid, &m, words, 16384)
                            : fixture_bone_target(&grid, 1.0f, &m, words, 16384),
                     "bone");
        bone[i] = (smr_mesh){m.xyz, m.triangles, m.n_vertices, m.n_triangles};
    }
}

static smr_volume draw(const fixture_thigh *all, const fixture_pose *pose, const fixture_box *box)
{
    unsigned char *const voxels = answers_room(48u * 48u * 48u);
    answers_need(box->n[0] <= 48u && box->n[1] <= 48u && box->n[0] * box->n[1] * box->n[2] <= 48u * 48u * 48u, "box");
    fixture_thigh_slices(all, pose, box, voxels, answers_room(sizeof(float[FIXTURE_IMAGE_SCRATCH(48, 48)])));
    return fixture_volume(box, voxels);
}

static void make_thigh(void)
{
    fixture_thigh *const all = answers_room(sizeof *all);
    fixture_mesh m[2];
    fixture_pair pair;
    for (uint32_t i = 0; i < 2u; i++) {
        m[i] = (fixture_mesh){answers_room(12u * 1024u), answers_room(12u * 2048u), 1024, 2048, 0, 0};
        truth[i] = answers_room(12u * 1024u);
    }
    answers_need(fixture_thigh_pair(all, m, truth, answers_room(sizeof(float[FIXTURE_THIGH_SCRATCH])), &pair), "thigh");
    for (uint32_t i = 0; i < 2u; i++) {
        thigh[i].name = pair.name[i];
        thigh[i].mesh = (smr_mesh){m[i].xyz, m[i].triangles, m[i].n_vertices, m[i].n_triangles};
        image[i] = draw(all, &pair.pose[i], &pair.box[i]);
    }
}

/* ---- registrations onto surfaces and clouds */

static smr_config settings(void)
{
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = 3000;
    config.basic.iterations = 5;
    config.basic.iterations_last = 8;
    return config;
}

static void end(smr *s, const smr_model *of, uint32_t most)
{
    smr_tick_report report = {0};
    for (uint32_t tick = 0; tick < most && !report.done; tick++)
        answers_need(smr_tick(s, 0, &report) == SMR_OK, "tick");
    answers_of(s, of, &report);
    answers_end();
}

static void onto_surface(const char *name, smr_config config, smr_mesh target)
{
    smr *const s = answers_init(model, &config);
    answers_begin(name);
    answers_need(smr_set_surface(s, SMR_ALL, answers_surface(&target)) == SMR_OK, name);
    end(s, model, 60);
}

static void surfaces(void)
{
    smr_config config = settings(), polar = config, bound = config, paper = smr_config_paper();
    onto_surface("whole", config, bone[1]);
    onto_surface("side", config, answers_cut(&bone[1], 1, 0.0f));
    onto_surface("end", config, answers_cut(&bone[1], 2, 250.0f));
    const smr_mesh half = answers_cut(&bone[1], 2, 150.0f);
    onto_surface("noisy half", config, answers_noisy(&half, 2.0f));
    onto_surface("mirrored", config, answers_moved(&bone[1], 0.0f, -1.0f, 0.0f));
    onto_surface("turned", config, answers_moved(&bone[1], 0.2f, 1.05f, 9.0f));
    const smr_mesh other = answers_moved(&bone[0], 0.3f, 0.6f, 90.0f);
    onto_surface("another body", config, answers_joined(&bone[1], &other));
    polar.basic.method = SMR_METHOD_POLAR;
    polar.basic.active_share = 0.7f;
    polar.schedule.active_first = 0.3f;
    polar.motion.normals = SMR_NORMALS_EXACT;
    polar.motion.fusing = SMR_FUSING_LIE;
    onto_surface("polar", polar, bone[1]);
    bound.motion.strain_most = 0.02f;
    bound.motion.plastic_every = 0;
    bound.forces.reject_deviations = 1.0f;
    bound.forces.reject_border = 1;
    bound.forces.use_box = 1;
    bound.forces.box_min[2] = 60.0f;
    for (uint32_t c = 0; c < 3u; c++)
        bound.forces.box_max[c] = 400.0f;
    bound.basic.slide = 0.5f;
    bound.basic.attraction = 0.2f;
    onto_surface("bound", bound, answers_cut(&bone[1], 2, 100.0f));
    paper.basic.iterations = 6;
    onto_surface("paper", paper, bone[1]);
    config.contact.volume = 1.0f;
    config.contact.smooth = 0.3f;
    config.partial.noise_mm = 0.5f;
    onto_surface("kept", config, answers_noisy(&bone[1], 3.0f));
}

static void onto_points(const char *name, const smr_points *points)
{
    const smr_config config = settings();
    smr *const s = answers_init(model, &config);
    answers_begin(name);
    answers_need(smr_set_points(s, SMR_ALL, points) == SMR_OK, name);
    end(s, model, 60);
}

static void clouds(void)
{
    static const struct {
        const char *name;
        int side, normals;
        uint32_t strays;
    } cloud[] = {
        {"cloud", 0, 1, 0}, {"cloud of a side", 1, 1, 0}, {"bare cloud of a side", 1, 0, 0}, {"strays", 0, 1, 60}};
    for (uint32_t i = 0; i < sizeof cloud / sizeof cloud[0]; i++) {
        const smr_mesh noise = answers_noisy(&bone[1], 1.5f), side = answers_cut(&noise, 1, 0.0f);
        onto_points(cloud[i].name, answers_points(cloud[i].side ? &side : &noise, cloud[i].normals, cloud[i].strays));
    }
}

/* Landmarks, one of them hard, beside a part of the target and alone. */
static void landmarks(void)
{
    const float *const p = bone[0].xyz;
    const smr_landmark mark[4] = {{0, 7, {0, 0, 0}, {p[21] + 3.0f, p[22] + 2.0f, p[23]}, 1.0f, 0},
                                  {0, SMR_NONE, {p[90], p[91], p[92]}, {p[90] - 2.0f, p[91], p[92] + 4.0f}, 1.0f, 1},
                                  {SMR_ALL, SMR_NONE, {p[0], p[1], p[2] + 9.0f}, {p[0], p[1], p[2] + 12.0f}, 0.5f, 0},
                                  {0, 400, {0, 0, 0}, {p[1200] + 5.0f, p[1201], p[1202] - 2.0f}, 20.0f, 0}};
    smr_config config = settings();
    config.partial.n_landmarks = 4;
    for (uint32_t beside = 0; beside < 2u; beside++) {
        smr *const s = answers_init(model, &config);
        const smr_mesh part = answers_cut(&bone[1], 2, 300.0f);
        answers_begin(beside ? "landmarks beside an end" : "landmarks");
        answers_need(smr_set_landmarks(s, mark, 4) == SMR_OK, "landmarks");
        answers_need(!beside || smr_set_surface(s, SMR_ALL, answers_surface(&part)) == SMR_OK, "landmarks' surface");
        end(s, model, 60);
    }
}

/* Targets that move, and at last jump: surfaces of a part, and clouds. */
static void tracked(void)
{
    smr_config config = settings();
    config.track.mode = SMR_TRACK_RECOVER;
    config.track.ahead = 0.5f;
    for (uint32_t cloud = 0; cloud < 2u; cloud++) {
        static const float turn[] = {0.0f, 0.02f, 0.04f, 0.12f}, shift[] = {0.0f, 1.0f, 2.0f, 30.0f};
        smr *const s = answers_init(model, &config);
        answers_begin(cloud ? "tracked cloud" : "tracked side");
        for (uint32_t i = 0; i < 4u; i++) {
            const smr_mesh at = answers_moved(&bone[1], turn[i], 1.0f, shift[i]), side = answers_cut(&at, 1, -9.0f);
            smr_tick_report report = {0};
            answers_need((cloud ? smr_set_points(s, SMR_ALL, answers_points(&at, 1, 20))
                                : smr_set_surface(s, SMR_ALL, answers_surface(&side))) == SMR_OK,
                         "tracked");
            for (uint32_t tick = 0; tick < (i == 0u ? 40u : 6u); tick++)
                answers_need(smr_tick(s, 0, &report) == SMR_OK, "tracking");
            answers_of(s, model, &report);
        }
        answers_end();
    }
}

/* Pinned at one end, thrown and drawn to goals. */
static void in_time(void)
{
    const uint32_t n = bone[0].n_vertices;
    const smr_mesh goal = answers_moved(&bone[0], 0.05f, 1.0f, 2.0f);
    smr_config config = settings();
    config.dynamics.mode = SMR_DYNAMICS_ON;
    config.dynamics.gravity[1] = -9810.0f;
    config.caller.goals = 1;
    smr *const s = answers_init(model, &config);
    float *const mass = answers_room(4u * (size_t)n), *const speed = answers_room(12u * (size_t)n);
    for (uint32_t i = 0; i < n; i++) {
        mass[i] = bone[0].xyz[3u * i + 2u] < 15.0f ? INFINITY : 0.5f + 0.25f * (float)(i % 5u);
        speed[3u * i] = mass[i] < 9.0f ? bone[0].xyz[3u * i + 2u] : 0.0f;
    }
    answers_begin("in time");
    answers_need(smr_set_motion(s, 0, mass, speed) == SMR_OK && smr_set_goals(s, 0, goal.xyz, NULL) == SMR_OK,
                 "motion");
    end(s, model, 3u * SMR_SWEEPS);
}

/* Shapes of two further subjects. */
static void subjects(void)
{
    const uint32_t n = bone[0].n_vertices;
    float *const xyz = answers_room(24u * (size_t)n);
    smr_structure one = {"bone", bone[0]};
    smr_prepare_config prepare = smr_prepare_config_default();
    const smr_config config = settings();
    fixture_bone_truth(0.6f, bone[0].xyz, n, xyz);
    fixture_bone_truth(1.6f, bone[0].xyz, n, xyz + 3u * n);
    prepare.also = &(smr_subjects){xyz, 2};
    const smr_model *const of = answers_model(&one, 1, &prepare);
    const smr_mesh part = answers_cut(&bone[1], 2, 200.0f);
    const smr_pose shifted = {{{1, 0, 0, 2}, {0, 1, 0, 0}, {0, 0, 1, -1}}};
    smr *const s = answers_init(of, &config);
    answers_begin("subjects");
    answers_need(smr_set_pose(s, &shifted) == SMR_OK, "pose");
    answers_need(smr_set_surface(s, SMR_ALL, answers_surface(&part)) == SMR_OK, "subjects");
    end(s, of, 60);
}

/* ---- the thigh's structures */

/* Onto their places in the patient as surfaces, in contact with each other and with a fixed one. */
static void in_contact(void)
{
    smr_config config = settings();
    smr_prepare_config prepare = smr_prepare_config_default();
    const smr_model *const of = answers_model(thigh, 2, &prepare);
    config.contact.share = 1.0f;
    config.contact.gap_mm = 0.5f;
    config.contact.n_fixed = 1;
    smr *const s = answers_init(of, &config);
    answers_begin("in contact");
    for (uint32_t i = 0; i < 2u; i++) {
        smr_mesh there = thigh[i].mesh;
        there.xyz = truth[i];
        there = answers_moved(&there, 0.0f, 1.0f, i == 0u ? 3.0f : -3.0f);
        answers_need(smr_set_surface(s, i, answers_surface(&there)) == SMR_OK, "contact surface");
        if (i == 0u)
            there = answers_moved(&there, 0.0f, 0.97f, 0.0f);
        answers_need(i > 0u || smr_set_fixed(s, 0, answers_surface(&there)) == SMR_OK, "fixed");
    }
    end(s, of, 60);
}

/* Rows of an image from `first` on, of the same memory. */
static smr_volume lower(const smr_volume *whole, uint32_t first)
{
    smr_volume part = *whole;
    part.voxels = (const unsigned char *)whole->voxels + (size_t)first * whole->size[0] * whole->size[1];
    part.size[2] -= first;
    part.origin[2] += (float)first * whole->spacing[2];
    return part;
}

static void into_images(void)
{
    static const char *const name[] = {"image", "image of a part", "image as in the paper", "tracked image"};
    const smr_volume part = lower(&image[1], image[1].size[2] / 3u);
    for (uint32_t k = 0; k < 4u; k++) {
        smr_config config = k == 2u ? smr_config_paper() : smr_config_default_image();
        config.basic.iterations = 4;
        config.basic.iterations_last = 8;
        config.track.mode = k == 3u ? SMR_TRACK_REPORT : SMR_TRACK_OFF;
        config.image.similarity = k == 1u ? SMR_SIMILARITY_NCC : config.image.similarity;
        smr *const s = answers_init(imaged, &config);
        answers_begin(name[k]);
        for (uint32_t i = 0; i < 2u; i++)
            answers_need(smr_set_positions(s, i, truth[i]) == SMR_OK, "start");
        answers_need(smr_set_volume(s, k == 1u ? &part : &image[1]) == SMR_OK, name[k]);
        for (uint32_t tick = 0; k == 3u && tick < 50u; tick++)
            answers_need(smr_tick(s, 0, NULL) == SMR_OK, "tick");
        answers_need(k < 3u || smr_set_volume(s, &image[0]) == SMR_OK, "next image");
        end(s, imaged, k == 3u ? 6u : 60u);
    }
}

/* An argument: without the lines that take half of the time, for emulated processors. */
int main(int argc, char **argv)
{
    smr_prepare_config prepare = smr_prepare_config_default();
    smr_structure one = {"bone", {NULL, NULL, 0, 0}};
    answers_need(smr_self_test() == 0u, "self test");
    make_bones();
    make_thigh();
    one.mesh = bone[0];
    answers_begin("models");
    prepare.n_radii = 3;
    prepare.radius_mm[0] = 110.0f;
    prepare.radius_mm[1] = 60.0f;
    prepare.radius_mm[2] = 5.0f; /* below the mean edge */
    model = answers_model(&one, 1, &prepare);
    answers_say("bone");
    prepare = smr_prepare_config_default();
    prepare.reference = &image[0];
    imaged = answers_model(thigh, 2, &prepare);
    answers_say("thigh");
    answers_keep();
    answers_end();
    (void)argv;
    surfaces();
    clouds();
    landmarks();
    tracked();
    in_time();
    subjects();
    in_contact();
    into_images();
    answers_calls(bone, argc < 2);
    return 0;
}
