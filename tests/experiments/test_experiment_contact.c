/* test_experiment_contact.c: structures that keep apart: the thigh onto its patient's surfaces and into another
 * person's image, with the force off and on; a femur around a computed stem.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case.h"
#include "case_run.h"
#include "experiment.h"
#include "measure/surface_distances.h"

/* Figures of a run; -1 where the report has none. */
typedef struct figures {
    double deepest, volume, mean, folds, tick_ms;
    int status;
} figures;

static double larger(double a, double b) { return a > b ? a : b; }

static figures run(experiment_command *c, const char *out)
{
    case_run result;
    figures f;
    case_register(c, experiment_scratch("%s", out), &result);
    f.status = result.status;
    f.deepest = case_number(&result, "contact.deepest_mm");
    f.volume = case_number(&result, "contact.volume_mm3");
    f.mean = larger(case_number(&result, "distance_mm.model_to_target.mean"),
                    case_number(&result, "distance_mm.target_to_model.mean"));
    f.folds = case_number(&result, "folds");
    f.tick_ms = case_number(&result, "tick_ms.median");
    (void)printf("%-16s deepest %6.2f mm  overlap %8.0f mm3  mean %.3f mm  tick %.1f ms\n", out, f.deepest, f.volume,
                 f.mean, f.tick_ms);
    return f;
}

static void add_all(experiment_command *c, const char *const *words)
{
    for (; *words != NULL; words++)
        experiment_add(c, "%s", *words);
}

/* The thigh onto the patient's surfaces, or into the person's image. */
static figures thigh(int image, int on)
{
    const char *const model = experiment_data("hip_thigh_vhm"),
                      *const reference = experiment_data("thigh_patient/mri_reference.mha"),
                      *const marks = experiment_data("thigh_patient/landmarks_reference.mrk.json");
    const char *const who = image ? "person" : "patient";
    const char *const to = experiment_data("thigh_%s/landmarks_%s.mrk.json", who, who),
                      *const truth = experiment_data("thigh_%s/truth", who),
                      *const picture = experiment_data("thigh_person/mri_person.mha");
    experiment_command c = {{NULL}, 0};
    if (model == NULL || reference == NULL || marks == NULL || to == NULL || truth == NULL || picture == NULL)
        skip();
    experiment_add(&c, "--model");
    experiment_add_surfaces(&c, model);
    experiment_add(&c, "--target");
    if (!image)
        experiment_add_surfaces(&c, truth);
    else
        add_all(&c, (const char *const[]){picture, "--reference", reference, "--truth", truth, NULL});
    add_all(&c, (const char *const[]){"--landmarks", marks, to, on ? "--contact" : NULL, NULL});
    return run(&c, image ? (on ? "image_on" : "image_off") : (on ? "surfaces_on" : "surfaces_off"));
}

static void parts(int image, double deepest, double farther)
{
    const figures off = thigh(image, 0), on = thigh(image, 1);
    experiment_bound("deepest, of that without", on.deepest / off.deepest, deepest);
    experiment_bound("overlap, of that without", on.volume / off.volume, 0.2);
    experiment_bound("mean distance, more", on.mean - off.mean, farther);
    experiment_bound("folds", on.folds, off.folds + 10.0);
    experiment_bound("it is measured", -on.deepest, 0.0);
    EXPERIMENT_END();
}

static void parts_a_thigh_on_surfaces(void **state)
{
    (void)state;
    parts(0, 0.2, 0.10);
}

static void parts_a_thigh_in_an_image(void **state)
{
    (void)state;
    if (!experiment_full())
        skip();
    parts(1, 0.2, 0.15);
}

/* A cylinder with round ends along the shaft of a femur, as an STL: so far out that it reaches through the wall by
 * `through` mm. The femurs stand along z. */
static int write_stem(const host_mesh *femur, double through, const char *path)
{
    enum { ROUND = 32, LONG = 60 };
    static double at[LONG + 1][ROUND][3];
    double lo = 1e9, hi = -1e9, centre[2] = {0, 0}, line[2][3], least = 1e9;
    FILE *file = NULL;
    for (uint32_t i = 0; i < femur->n_vertices; i++) {
        lo = fmin(lo, (double)femur->xyz[3u * i + 2u]);
        hi = fmax(hi, (double)femur->xyz[3u * i + 2u]);
    }
    for (int end = 0; end < 2; end++) { /* centres of two slices of the shaft */
        const double z = lo + (0.45 + 0.2 * end) * (hi - lo);
        double n = 0.0;
        centre[0] = centre[1] = 0.0;
        for (uint32_t i = 0; i < femur->n_vertices; i++)
            if (fabs((double)femur->xyz[3u * i + 2u] - z) < 8.0) {
                centre[0] += (double)femur->xyz[3u * i];
                centre[1] += (double)femur->xyz[3u * i + 1u];
                n += 1.0;
            }
        line[end][0] = centre[0] / n;
        line[end][1] = centre[1] / n;
        line[end][2] = z;
    }
    for (uint32_t i = 0; i < femur->n_vertices; i++) { /* the nearest wall */
        const double t = ((double)femur->xyz[3u * i + 2u] - line[0][2]) / (line[1][2] - line[0][2]);
        const double x = (double)femur->xyz[3u * i] - line[0][0] - t * (line[1][0] - line[0][0]);
        const double y = (double)femur->xyz[3u * i + 1u] - line[0][1] - t * (line[1][1] - line[0][1]);
        if (t >= 0.0 && t <= 1.0)
            least = fmin(least, sqrt(x * x + y * y));
    }
    for (int k = 0; k <= LONG; k++)
        for (int i = 0; i < ROUND; i++) {
            const double t = (double)k / LONG, u = 6.283185307 * i / ROUND;
            const double r = (least + through) * sqrt(fmax(0.0, 1.0 - pow(2.0 * t - 1.0, 16)));
            at[k][i][0] = line[0][0] + t * (line[1][0] - line[0][0]) + r * cos(u);
            at[k][i][1] = line[0][1] + t * (line[1][1] - line[0][1]) + r * sin(u);
            at[k][i][2] = line[0][2] + t * (line[1][2] - line[0][2]);
        }
    file = fopen(path, "w");
    if (file == NULL)
        return 0;
    (void)fputs("solid stem\n", file);
    for (int k = 0; k < LONG; k++)
        for (int i = 0; i < 2 * ROUND; i++) {
            const double *const a = at[k][i / 2], *const b = at[k][(i / 2 + 1) % ROUND], *const c = at[k + 1][i / 2],
                                *const d = at[k + 1][(i / 2 + 1) % ROUND];
            const double *const corner[3] = {i % 2 ? b : a, i % 2 ? d : b, c};
            if ((k == 0 && i % 2 == 0) || (k == LONG - 1 && i % 2 == 1))
                continue; /* the ends are points */
            (void)fputs("facet normal 0 0 0\nouter loop\n", file);
            for (int j = 0; j < 3; j++)
                (void)fprintf(file, "vertex %.6f %.6f %.6f\n", corner[j][0], corner[j][1], corner[j][2]);
            (void)fputs("endloop\nendfacet\n", file);
        }
    (void)fputs("endsolid\n", file);
    return fclose(file) == 0;
}

static host_mesh read_surface(const char *path, void **memory, smr_surface **surface)
{
    host_mesh mesh;
    host_error error;
    memset(&error, 0, sizeof error);
    EXPERIMENT_NEED(host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &mesh, &error) == 0);
    const smr_mesh view = host_mesh_view(&mesh);
    *surface = host_surface_make(&view, memory);
    EXPERIMENT_NEED(*surface != NULL);
    return mesh;
}

/* How far a stem cuts a bone's surface: points of the bone inside the stem, points of the stem outside the bone. */
static double cut_by(const char *bone, const char *stem)
{
    void *memory[2] = {NULL, NULL};
    smr_surface *surface[2] = {NULL, NULL};
    smr_contact_report report = {-1, -1, 0, 0};
    smr_closest hit;
    host_mesh mesh[2];
    mesh[0] = read_surface(bone, &memory[0], &surface[0]);
    mesh[1] = read_surface(stem, &memory[1], &surface[1]);
    EXPERIMENT_NEED(smr_surface_contact(surface[0], surface[1], 0.5f, &report) == SMR_OK);
    double most = (double)report.a_in_b_mm;
    for (uint32_t i = 0; i < mesh[1].n_vertices; i++) {
        const float *const p = mesh[1].xyz + 3u * i;
        EXPERIMENT_NEED(smr_surface_closest(surface[0], p, NULL, 0, 1000.0f, &hit) == SMR_OK);
        double out = 0.0;
        for (uint32_t c = 0; c < 3u; c++)
            out += ((double)p[c] - (double)hit.point[c]) * (double)hit.normal[c];
        most = out > 0.0 ? larger(most, (double)hit.distance) : most;
    }
    for (int i = 0; i < 2; i++) {
        host_mesh_free(&mesh[i]);
        free(memory[i]);
    }
    return most;
}

static void keeps_a_femur_off_a_stem(void **state)
{
    const char *const model = experiment_data("femurs/femur_2007_5028_left_3k.ply"),
                      *const target = experiment_data("femurs/femur_2008_0019_left_3k.ply");
    const char *const stem = experiment_scratch("stem.stl");
    host_mesh femur;
    host_error error;
    figures f[2];
    (void)state;
    if (model == NULL || target == NULL)
        skip();
    memset(&error, 0, sizeof error);
    EXPERIMENT_NEED(host_mesh_read(target, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &femur, &error) == 0);
    EXPERIMENT_NEED(write_stem(&femur, 1.5, stem));
    host_mesh_free(&femur);
    for (int on = 0; on < 2; on++) {
        experiment_command c = {{NULL}, 0};
        add_all(&c, (const char *const[]){"--model", model, "--target", target, "--align", "similarity", NULL});
        add_all(&c, (const char *const[]){on ? "--contact-with" : NULL, stem, NULL});
        f[on] = run(&c, on ? "stem_on" : "stem_off");
        f[on].deepest = cut_by(experiment_scratch("%s/femur_2007_5028_left_3k.ply", on ? "stem_on" : "stem_off"), stem);
    }
    (void)printf("stem: cuts the wall by %.2f mm without, %.2f with\n", f[0].deepest, f[1].deepest);
    experiment_bound("without it cuts the wall", 0.7, f[0].deepest);
    experiment_bound("the stem stays inside", f[1].deepest, 0.3);
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(parts_a_thigh_on_surfaces),
                                       cmocka_unit_test(parts_a_thigh_in_an_image),
                                       cmocka_unit_test(keeps_a_femur_off_a_stem)};
    return cmocka_run_group_tests_name("experiment contact", tests, NULL, NULL);
}
