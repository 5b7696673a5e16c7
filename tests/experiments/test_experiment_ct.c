/* test_experiment_ct.c: registration into a real CT. The model is the right hip's six structures with the CT as
 * reference; the target is the mirrored CT, whose right side is the left hip. The start is a rigid fit of six
 * landmarks that one rule finds on either side; the truth is the mirrored surface of the left side.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "experiment.h"

enum { LANDMARKS = 6, EXTREME = 10 };

static const char *const structures[] = {"femur_proximal",  "gluteus_maximus", "gluteus_medius",
                                         "gluteus_minimus", "hip_bone",        "iliopsoas"};
enum { STRUCTURES = sizeof structures / sizeof structures[0] };

/* The rule: the mean of the EXTREME vertices that lie farthest in a direction, for a right side in LPS (left of the
 * body is +x, its back +y, its head +z). The field of view cuts the bones below, so no direction points down. */
typedef struct rule {
    const char *label, *structure;
    float direction[3];
} rule;

static const rule rules[LANDMARKS] = {
    {"iliac crest", "hip_bone", {0, 0, 1}},
    {"anterior iliac spine", "hip_bone", {-0.5f, -1, 0.5f}},
    {"posterior iliac spine", "hip_bone", {0, 1, 0.3f}},
    {"symphysis", "hip_bone", {1, -1, -0.5f}},
    {"greater trochanter", "femur_proximal", {-1, 0.5f, 0.3f}},
    {"femoral head", "femur_proximal", {1, 0, 0.5f}},
};

static int find_mark(const rule *by, const host_mesh *mesh, float at[3])
{
    unsigned char *const taken = test_calloc(mesh->n_vertices, 1);
    double sum[3] = {0.0, 0.0, 0.0};
    uint32_t i = 0, k = 0;
    int c = 0;
    for (k = 0; k < EXTREME; k++) {
        float most = -HUGE_VALF;
        uint32_t best = 0;
        for (i = 0; i < mesh->n_vertices; i++) {
            const float *const p = mesh->xyz + 3u * (size_t)i;
            const float d = p[0] * by->direction[0] + p[1] * by->direction[1] + p[2] * by->direction[2];
            if (!taken[i] && d > most) {
                most = d;
                best = i;
            }
        }
        taken[best] = 1;
        for (c = 0; c < 3; c++)
            sum[c] += (double)mesh->xyz[3u * (size_t)best + (size_t)c];
    }
    for (c = 0; c < 3; c++)
        at[c] = (float)(sum[c] / EXTREME);
    test_free(taken);
    return mesh->n_vertices >= EXTREME;
}

/* Landmarks of the right side, or of the left side seen in a mirror; the latter are written in the CT's own frame. */
static void write_marks(const char *side, int mirror, const char *path)
{
    host_landmarks *const set = test_calloc(1, sizeof *set);
    uint32_t k = 0;
    for (k = 0; k < LANDMARKS; k++) {
        const char *const file = experiment_data("ct_hips_surfaces/%s_%s.ply", rules[k].structure, side);
        host_mesh mesh;
        host_error error;
        EXPERIMENT_NEED(file != NULL && host_mesh_read(file, HOST_MESH_SURFACE, mirror, &mesh, &error) == 0);
        EXPERIMENT_NEED(find_mark(&rules[k], &mesh, set->xyz[k]));
        if (mirror != HOST_MIRROR_NONE)
            set->xyz[k][mirror] = -set->xyz[k][mirror];
        (void)snprintf(set->label[k], sizeof set->label[k], "%s", rules[k].label);
        host_mesh_free(&mesh);
    }
    set->n = LANDMARKS;
    EXPERIMENT_NEED(experiment_write_landmarks(path, set));
    test_free(set);
}

static void copy_file(const char *from, const char *to)
{
    FILE *const in = fopen(from, "rb"), *const out = fopen(to, "wb");
    char part[65536];
    size_t n = 0;
    EXPERIMENT_NEED(in != NULL && out != NULL);
    while ((n = fread(part, 1, sizeof part, in)) > 0)
        EXPERIMENT_NEED(fwrite(part, 1, n, out) == n);
    (void)fclose(in);
    EXPERIMENT_NEED(fclose(out) == 0);
}

/* A directory with the left side's surfaces under the right side's names; --mirror-target mirrors them with the CT. */
static const char *make_truth(void)
{
    const char *const directory = experiment_scratch("truth");
    size_t i = 0;
    EXPERIMENT_NEED(experiment_directory(directory));
    for (i = 0; i < STRUCTURES; i++)
        copy_file(experiment_data("ct_hips_surfaces/%s_left.ply", structures[i]),
                  experiment_scratch("truth/%s_right.ply", structures[i]));
    return directory;
}

static experiment_result run(const char *const *more)
{
    char from[1024], to[1024], truth[1024], image[1024];
    experiment_command c = {{NULL}, 0};
    size_t i = 0;
    (void)snprintf(from, sizeof from, "%s", experiment_scratch("right.csv"));
    (void)snprintf(to, sizeof to, "%s", experiment_scratch("left.csv"));
    (void)snprintf(truth, sizeof truth, "%s", make_truth());
    (void)snprintf(image, sizeof image, "%s", experiment_data("volumes/ct_hips.mha"));
    write_marks("right", HOST_MIRROR_NONE, from);
    write_marks("left", HOST_MIRROR_X, to);
    const char *const words[] = {
        "--reference", image,         "--target", image, "--mirror-target", "x",     "--truth",
        truth,         "--landmarks", from,       to,    "--align",         "rigid", "--model"};
    for (i = 0; i < sizeof words / sizeof words[0]; i++)
        experiment_add(&c, "%s", words[i]);
    for (i = 0; i < STRUCTURES; i++)
        experiment_add(&c, "%s", experiment_data("ct_hips_surfaces/%s_right.ply", structures[i]));
    for (i = 0; more[i] != NULL; i++)
        experiment_add(&c, "%s", more[i]);
    return experiment_register(&c, experiment_scratch("hip"));
}

/* The right verdict is "look": muscle on muscle looks alike in CT, so profiles fit hardly better than beside their
 * places (likeness 0.83, below 0.85), and tendons end some millimetres off. That is said of the gluteus medius and
 * minimus, the two that are farthest off, and not of the hip bone, which CT shows and which is found to 0.6 mm. */
static void judge(const experiment_result *r)
{
    uint32_t i = 0, found = 0;
    assert_int_equal(r->status, 3);
    for (i = 0; i < r->n_structures; i++) {
        const experiment_structure *const s = &r->structure[i];
        if (strcmp(s->name, "hip_bone_right") == 0)
            assert_string_equal(s->verdict, "good");
        else if (strcmp(s->name, "gluteus_medius_right") == 0 || strcmp(s->name, "gluteus_minimus_right") == 0)
            assert_string_equal(s->verdict, "look");
        else
            continue;
        found++;
    }
    assert_int_equal(found, 3);
}

static void finds_the_mirrored_side(void **state)
{
    static const char *const no_force[] = {"--search",          "0,0", "--gradient", "0,0", "--iterations", "1",
                                           "--iterations-last", "1",   NULL};
    static const char *const nothing[] = {NULL};
    uint32_t i = 0;
    (void)state;
    if (experiment_data("ct_hips_surfaces") == NULL || experiment_data("volumes/ct_hips.mha") == NULL)
        skip();
    (void)printf("right hip into the mirrored CT\n");
    const experiment_result start = run(no_force), r = run(nothing);
    experiment_print_head();
    experiment_print("start", &start);
    experiment_print("result", &r);
    assert_string_equal(r.start, "landmarks rigid");
    judge(&r);
    assert_int_equal(r.n_structures, STRUCTURES);
    for (i = 0; i < r.n_structures; i++) {
        char what[120];
        (void)snprintf(what, sizeof what, "%.40s, mean to the mirrored left (start %.2f)", r.structure[i].name,
                       start.structure[i].to_truth);
        experiment_bound(what, r.structure[i].to_truth, 2.0);
        (void)printf("       %-60s %8.3f (start %.2f)\n", "from it", r.structure[i].to_model,
                     start.structure[i].to_model);
    }
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_mirrored_side),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
