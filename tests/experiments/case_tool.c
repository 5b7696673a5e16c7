/* case_tool.c: makes cases with a known truth and other inputs of experiments, and measures results.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "case_tool make [NAME=VALUE...] DIR [x:]FILE...       model, target, truth, whole, seen in DIR; x: mirrored\n"
    "    seed part (whole side patches end front) share patches noise outliers deform sigma shift turn dense; "
    "view=SEED: a patch of any size, seen from any start; beside=FILE: in the first target, too;\n"
    "    flex=DEG: all but the first turn about the hip joint; joined=1: one target file\n"
    "case_tool pair DIR [x:]MODEL [x:]TARGET A B C D [TRUTH]   another's surface: shares A-B of the model, C-D of the "
    "target; TRUTH: where the model's vertices belong\n"
    "case_tool kind SEED DATA DIR [NAME]                  a run that verdicts are judged by\n"
    "case_tool measure DIR RESULT                         how far a result of the case is from its truth\n"
    "case_tool cloud DIR OUT N NOISE STRAYS BLOB SEED     points on the case's target, with shares of outliers\n"
    "case_tool displaced | spread | click | depths | noisy | crop | rician    inputs of single experiments\n"
    "case_tool apart A B | size FILE... | vertices FILE   figures of surfaces\n"
    "case_tool feed | follow                              registrations that the command line cannot do\n"
    "Figures are lines \"name value\", in mm.\n";

static const char *const parts[] = {"whole", "side", "patches", "end", "front"};

static void add(case_data *data, const char *word)
{
    const int mirrored = strncmp(word, "x:", 2) == 0;
    (void)case_add(data, mirrored ? word + 2 : word, mirrored ? HOST_MIRROR_X : HOST_MIRROR_NONE);
}

/* A patch of 15 to 90 % of the area, a start up to 15 mm and 10 degrees off. */
static void set_view(case_options *o, uint32_t seed)
{
    oracle_random r = oracle_seed(9000u + seed);
    o->seed = seed;
    o->part = CASE_PATCHES;
    o->patches = 1;
    o->share = oracle_uniform(&r, 0.15, 0.9);
    o->shift_mm = oracle_uniform(&r, 0.0, 15.0);
    o->turn_deg = oracle_uniform(&r, 0.0, 10.0);
}

static const struct {
    const char *name;
    size_t at;
} numbers[] = {{"share", offsetof(case_options, share)},       {"noise", offsetof(case_options, noise_mm)},
               {"outliers", offsetof(case_options, outliers)}, {"deform", offsetof(case_options, deform_mm)},
               {"sigma", offsetof(case_options, sigma_mm)},    {"shift", offsetof(case_options, shift_mm)},
               {"turn", offsetof(case_options, turn_deg)},     {"flex", offsetof(case_options, flex_deg)}};

static void set_option(case_options *o, const char *word)
{
    const size_t n = strcspn(word, "=");
    const double value = atof(word + n + 1);
    for (int i = 0; strncmp(word, "part", n) == 0 && i < 5; i++)
        o->part = strcmp(word + n + 1, parts[i]) == 0 ? i : o->part;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (strncmp(word, numbers[i].name, n) == 0)
            memcpy((char *)o + numbers[i].at, &value, sizeof value);
    if (strncmp(word, "seed", n) == 0)
        o->seed = (uint32_t)value;
    else if (strncmp(word, "dense", n) == 0)
        o->dense = (int)value;
    else if (strncmp(word, "view", n) == 0)
        set_view(o, (uint32_t)value);
    else if (strncmp(word, "joined", n) == 0)
        o->joined = (int)value;
    else if (strncmp(word, "patches", n) == 0)
        o->patches = (int)value;
}

static void do_make(char **word)
{
    case_options o = case_defaults();
    case_data *const data = case_alloc(1, sizeof *data);
    int i = 0;
    for (; word[i] != NULL && strchr(word[i], '=') != NULL; i++)
        if (strncmp(word[i], "beside=", 7) == 0)
            case_beside(data, word[i] + 7, HOST_MIRROR_NONE);
        else
            set_option(&o, word[i]);
    for (int k = i + 1; word[k] != NULL; k++)
        add(data, word[k]);
    case_make(data, &o);
    case_write(data, word[i]);
    (void)printf("overlap %.4f\n", data->overlap);
}

/* Where the vertices belong, and which of them lie in these shares of the whole surface's height. */
static void add_truth(case_body *body, const char *path, double from, double to)
{
    double low = 0.0;
    const double height = case_height(&body->whole, &low);
    body->truth = case_load(path, HOST_MIRROR_NONE);
    body->seen = case_alloc(body->truth.n_vertices, 1);
    for (uint32_t i = 0; i < body->truth.n_vertices; i++) {
        const double share = ((double)body->truth.xyz[3u * (size_t)i + 2u] - low) / height;
        body->seen[i] = share >= from && share <= to;
    }
}

static void do_pair(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    double low = 0.0;
    add(data, word[1]);
    add(data, word[2]);
    case_body *const body = &data->body[0];
    body->whole = data->body[1].model;
    body->target = case_copy(&body->whole);
    data->n = 1;
    (void)printf("ratio %.4f\n", case_height(&body->whole, &low) / case_height(&body->model, &low));
    if (atof(word[3]) > 0.0)
        case_keep_shares(&body->model, atof(word[3]), atof(word[4]));
    case_keep_shares(&body->target, atof(word[5]), atof(word[6]));
    if (word[7] != NULL)
        add_truth(body, word[7], atof(word[5]), atof(word[6]));
    case_write(data, word[0]);
}

static void do_kind(char **word) { case_job_make((uint32_t)atoi(word[0]), word[3], word[1], word[2]); }

static void do_measure(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_read(data, word[0]);
    case_tell(data, word[1]);
}

/* A B: mean distance between vertices of the same index. */
static void do_apart(char **word)
{
    double sum = 0.0, p[3], q[3];
    const host_mesh a = case_load(word[0], HOST_MIRROR_NONE), b = case_load(word[1], HOST_MIRROR_NONE);
    if (a.n_vertices != b.n_vertices)
        case_fail("other numbers of vertices");
    for (uint32_t i = 0; i < a.n_vertices; i++) {
        case_get(&a, i, p);
        case_get(&b, i, q);
        sum += case_apart(p, q);
    }
    (void)printf("sum %.6f\nvertices %u\n", sum, a.n_vertices);
}

/* FILE...: a line for each: name, volume in mm3, area in mm2. */
static void do_size(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    for (int i = 0; word[i] != NULL; i++) {
        const case_body *const body = case_add(data, word[i], HOST_MIRROR_NONE);
        double volume = 0.0, origin[3], p[3], normal[3];
        case_get(&body->model, 0, origin);
        for (uint32_t t = 0; t < body->model.n_triangles; t++) {
            case_normal(&body->model, t, normal);
            case_get(&body->model, body->model.triangles[3u * (size_t)t], p);
            volume += (case_dot(p, normal) - case_dot(origin, normal)) / 6.0;
        }
        (void)printf("%s %.9g %.9g\n", body->name, volume, case_area(&body->model));
    }
}

/* FILE: a line "x y z" for each vertex. */
static void do_vertices(char **word)
{
    const host_mesh mesh = case_load(word[0], HOST_MIRROR_NONE);
    for (uint32_t i = 0; i < mesh.n_vertices; i++) {
        const float *const p = mesh.xyz + 3u * (size_t)i;
        (void)printf("%.9g %.9g %.9g\n", (double)p[0], (double)p[1], (double)p[2]);
    }
}

/* DIR MM SEED FILE...: the surfaces with noise of this deviation along each axis. */
static void do_noisy(char **word)
{
    oracle_random r = oracle_seed((uint32_t)atoi(word[2]));
    case_directory(word[0]);
    for (int i = 3; word[i] != NULL; i++) {
        host_mesh mesh = case_load(word[i], HOST_MIRROR_NONE);
        for (uint32_t k = 0; k < 3u * mesh.n_vertices; k++)
            mesh.xyz[k] += (float)(atof(word[1]) * case_random_normal(&r));
        case_save(&mesh, case_text("%s/%s", word[0], strrchr(word[i], '/') + 1));
        host_mesh_free(&mesh);
    }
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        int least; /* words */
        void (*run)(char **word);
    } all[] = {{"make", 2, do_make},         {"pair", 7, do_pair},       {"kind", 3, do_kind},
               {"measure", 2, do_measure},   {"apart", 2, do_apart},     {"size", 1, do_size},
               {"vertices", 1, do_vertices}, {"noisy", 4, do_noisy},     {"displaced", 4, case_displaced},
               {"spread", 7, case_spread},   {"click", 4, case_click},   {"depths", 4, case_depths},
               {"feed", 7, case_feed},       {"cloud", 7, case_cloud},   {"follow", 1, case_follow},
               {"crop", 7, case_crop},       {"rician", 4, case_rician}, {"figure", 4, case_figure}};
    for (size_t i = 0; argc > 1 && i < sizeof all / sizeof all[0]; i++)
        if (strcmp(argv[1], all[i].name) == 0 && argc - 2 >= all[i].least) {
            all[i].run(argv + 2);
            return 0;
        }
    (void)fputs(usage, stderr);
    return 2;
}
