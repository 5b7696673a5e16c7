/* case_persons.c: another person's femur, cut; parts of other lengths; the thigh seen from the front; random views.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_table.h"

/* The share of the mesh's height above a level, or below it. */
static host_mesh cut_height(const host_mesh *mesh, double from, double to)
{
    unsigned char *const keep = case_alloc(mesh->n_triangles, 1);
    double low = HUGE_VAL, high = -HUGE_VAL;
    host_mesh cut;
    uint32_t i = 0;
    for (i = 0; i < mesh->n_vertices; i++) {
        low = fmin(low, (double)mesh->xyz[3u * (size_t)i + 2u]);
        high = fmax(high, (double)mesh->xyz[3u * (size_t)i + 2u]);
    }
    for (i = 0; i < mesh->n_triangles; i++) {
        double p[3];
        case_centre(mesh, i, p);
        keep[i] = p[2] >= low + from * (high - low) && p[2] <= low + to * (high - low);
    }
    cut = case_cut(mesh, keep);
    free(keep);
    return cut;
}

static void centre_of(const float *xyz, uint32_t n, double out[3])
{
    uint32_t i = 0;
    out[0] = out[1] = out[2] = 0.0;
    for (i = 0; i < 3u * n; i++)
        out[i % 3u] += (double)xyz[i] / n;
}

/* The angle between the model and the result, degrees. */
static double turned(const host_mesh *model, const host_mesh *result)
{
    double a[9] = {0.0}, rotation[9], singular[3], from[3], to[3];
    uint32_t i = 0, k = 0;
    centre_of(model->xyz, model->n_vertices, from);
    centre_of(result->xyz, result->n_vertices, to);
    for (i = 0; i < model->n_vertices; i++)
        for (k = 0; k < 9u; k++)
            a[k] += ((double)result->xyz[3u * (size_t)i + k / 3u] - to[k / 3u]) *
                    ((double)model->xyz[3u * (size_t)i + k % 3u] - from[k % 3u]);
    oracle_polar(a, rotation, singular);
    return acos(fmax(-1.0, fmin(1.0, 0.5 * (rotation[0] + rotation[4] + rotation[8] - 1.0)))) * 180.0 / acos(-1.0);
}

/* Another person's bone onto the part of a bone between two heights. 0 when the data are not there. */
static int make_pair(case_data *data, const case_bone *model, const case_bone *target, double from, double to)
{
    const char *const paths[] = {experiment_data("%s", model->path), experiment_data("%s", target->path)};
    host_error error;
    memset(data, 0, sizeof *data);
    memset(&error, 0, sizeof error);
    if (paths[0] == NULL || paths[1] == NULL ||
        !case_add(data, paths[0], model->right ? HOST_MIRROR_X : HOST_MIRROR_NONE) ||
        host_mesh_read(paths[1], HOST_MESH_SURFACE, target->right ? HOST_MIRROR_X : HOST_MIRROR_NONE,
                       &data->body[0].whole, &error) != 0)
        return 0;
    data->body[0].target = cut_height(&data->body[0].whole, from, to);
    data->overlap = case_area(&data->body[0].target) / case_area(&data->body[0].whole);
    return 1;
}

/* The pose of the start as the report has it. */
static double start_scale(const case_run *run)
{
    const char *const text = case_text(run, "start_pose");
    double m[12] = {0.0}, det = 0.0;
    const char *at = text;
    int i = 0;
    for (i = 0; i < 12 && at != NULL; i++) {
        m[i] = atof(at);
        at = strstr(at, " + ");
        at = at != NULL ? at + 3 : NULL;
    }
    det =
        m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
    return i == 12 ? cbrt(det) : -1.0;
}

/* A line of pairs: what of the target is kept, and bounds of the surface error, mm. */
typedef struct pairs {
    const char *line;
    double from, to, mean, worst;
} pairs;

static void add_pair(case_score *score, const case_row *row, double worst, int wrong)
{
    score->rows++;
    score->held += row->status >= 0 && row->result.surface <= worst && !wrong;
    score->wrong_way += wrong != 0;
    score->mean += (row->result.surface - score->mean) / score->rows;
    score->worst = fmax(score->worst, row->result.surface);
}

static void run_pair(const case_bone *model, const case_bone *target, const pairs *p, case_score *score)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_run *const run = case_alloc(1, sizeof *run);
    char name[48], said[80], path[CASE_TEXT];
    if (make_pair(data, model, target, p->from, p->to)) {
        case_row row;
        host_mesh result;
        host_error error;
        double angle = 180.0;
        (void)snprintf(name, sizeof name, "%.10s-%.10s", model->name, target->name);
        row = case_run_data(p->line, name, 0, data, "--align rigid", run);
        (void)snprintf(path, sizeof path, "%.900s", case_out(data, &row));
        memset(&error, 0, sizeof error);
        if (host_mesh_read(path, HOST_MESH_POINTS_TOO, HOST_MIRROR_NONE, &result, &error) == 0) {
            angle = turned(&data->body[0].model, &result);
            host_mesh_free(&result);
        }
        (void)snprintf(said, sizeof said, "turned %.0f%s", angle, angle < 60.0 ? "" : " MISS wrong way");
        case_print_row(&row, -1.0, said);
        add_pair(score, &row, p->worst, !(angle < 60.0));
    }
    case_free(data);
    free(data);
    free(run);
}

/* Counts a miss for the mean, the worst and the wrong way round. */
static int run_pairs(const char *models, const char *targets, const pairs *p, case_score *score)
{
    int m = 0, t = 0, missed = 0;
    (void)snprintf(score->line, sizeof score->line, "%s", p->line);
    for (t = 0; t < CASE_FEMURS; t++)
        for (m = 0; case_named(targets, case_bones[t].name) && m < CASE_FEMURS; m++)
            if (m != t && case_named(models, case_bones[m].name))
                run_pair(&case_bones[m], &case_bones[t], p, score);
    if (score->rows == 0)
        return 0;
    missed = (score->mean > p->mean) + (score->worst > p->worst) + (score->wrong_way > 0);
    (void)printf("sum %-10s %3u runs: surface mean %.3f (at most %g) worst %.3f (at most %g), %u the wrong way: %s\n",
                 p->line, score->rows, score->mean, p->mean, score->worst, p->worst, score->wrong_way,
                 missed > 0 ? "MISS" : "ok");
    return missed;
}

int case_table_persons(const char *models, const char *targets, case_score *score)
{
    static const pairs lines[2] = {{"top70", 0.3, 1.0, 2.2, 3.5}, {"lower50", 0.0, 0.5, 3.5, 6.0}};
    memset(score, 0, 2u * sizeof *score);
    case_print_head();
    return run_pairs(models, targets, &lines[0], &score[0]) + run_pairs(models, targets, &lines[1], &score[1]);
}

static double height(const host_mesh *mesh)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    uint32_t i = 0;
    for (i = 0; i < mesh->n_vertices; i++) {
        low = fmin(low, (double)mesh->xyz[3u * (size_t)i + 2u]);
        high = fmax(high, (double)mesh->xyz[3u * (size_t)i + 2u]);
    }
    return high - low;
}

/* The upper part of one person's femur onto a longer or shorter upper part of another's. */
static int run_length(const case_bone *model, const case_bone *target, double of_model, double of_target)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_run *const run = case_alloc(1, sizeof *run);
    int missed = 1;
    if (make_pair(data, model, target, 1.0 - of_target, 1.0)) {
        const double ratio = height(&data->body[0].whole) / height(&data->body[0].model);
        host_mesh cut = cut_height(&data->body[0].model, 1.0 - of_model, 1.0);
        char name[48], said[80];
        double scale = 0.0;
        case_row row;
        host_mesh_free(&data->body[0].model);
        data->body[0].model = cut;
        (void)snprintf(name, sizeof name, "%.10s-%.10s", model->name, target->name);
        row = case_run_data("length", name, 0, data, "--align similarity", run);
        scale = start_scale(run);
        missed = !(fabs(scale / ratio - 1.0) <= 0.1);
        (void)snprintf(said, sizeof said, "%.0f%% onto %.0f%%: scale %.3f of the bones' %.3f: %s", 100.0 * of_model,
                       100.0 * of_target, scale / ratio, ratio, missed ? "MISS" : "ok");
        case_print_row(&row, -1.0, said);
    }
    case_free(data);
    free(data);
    free(run);
    return missed;
}

int case_table_lengths(const char *bones, case_score *score)
{
    static const double parts[][2] = {{0.5, 0.7}, {0.7, 0.4}};
    int m = 0, t = 0, k = 0;
    memset(score, 0, sizeof *score);
    (void)snprintf(score->line, sizeof score->line, "length");
    case_print_head();
    for (k = 0; k < 2; k++)
        for (t = 0; t < CASE_FEMURS; t++)
            for (m = 0; case_named(bones, case_bones[t].name) && m < CASE_FEMURS; m++)
                if (m == (t + 1) % CASE_FEMURS || m == t) {
                    score->rows++;
                    score->held += !run_length(&case_bones[m], &case_bones[t], parts[k][0], parts[k][1]);
                }
    if (score->rows > 0)
        (void)printf("sum %-10s %3u runs, %3u missed\n", score->line, score->rows, score->rows - score->held);
    return (int)(score->rows - score->held);
}

int case_table_thigh(uint32_t first, uint32_t last, case_score *score)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_run *const run = case_alloc(1, sizeof *run);
    const char *const thigh = experiment_data("hip_thigh_vhm");
    uint32_t seed = 0;
    int i = 0;
    memset(score, 0, sizeof *score);
    (void)snprintf(score->line, sizeof score->line, "thigh");
    case_print_head();
    for (seed = first; thigh != NULL && seed <= last; seed++) {
        experiment_command names = {{NULL}, 0};
        const case_options o = case_line("front", seed);
        case_row row;
        memset(data, 0, sizeof *data);
        experiment_add_surfaces(&names, thigh);
        for (i = 0; i < names.n; i++)
            (void)case_add(data, names.word[i], HOST_MIRROR_NONE);
        experiment_free(&names);
        case_make(data, &o);
        row = case_run_data("thigh", "24 structures", seed, data, "", run);
        add_pair(score, &row, 3.0, 0);
        case_print_row(&row, -1.0, row.status >= 0 && row.result.surface <= 3.0 ? "ok" : "MISS");
        case_free(data);
    }
    if (score->rows > 0)
        (void)printf("sum %-10s %3u runs, %3u missed: surface mean %.3f worst %.3f\n", score->line, score->rows,
                     score->rows - score->held, score->mean, score->worst);
    free(data);
    free(run);
    return (int)(score->rows - score->held);
}

/* A view of a seed: a patch of 15 to 90 % of the area, a start up to 15 mm and 10 degrees off. */
static case_options random_view(uint32_t seed)
{
    case_options o = case_defaults();
    oracle_random r = oracle_seed(9000u + seed);
    o.seed = seed;
    o.part = CASE_PATCHES;
    o.patches = 1;
    o.share = oracle_uniform(&r, 0.15, 0.9);
    o.shift_mm = oracle_uniform(&r, 0.0, 15.0);
    o.turn_deg = oracle_uniform(&r, 0.0, 10.0);
    return o;
}

static void count(case_views *n, double error, double start, int good)
{
    n->near += error < 1.0;
    n->near_good += error < 1.0 && good;
    n->farther += error > start;
    n->farther_good += error > start && good;
    n->far += error > 3.0;
    n->far_good += error > 3.0 && good;
}

static int print_counts(const case_views *n, const char *what, uint32_t runs)
{
    (void)printf("sum random %u runs by %s: %u farther than their start, %u of them called good; %u below 1 mm, %u of "
                 "them good; %u above 3 mm, %u of them called good\n",
                 runs, what, n->farther, n->farther_good, n->near, n->near_good, n->far, n->far_good);
    return (int)n->farther_good + (n->near_good < 0.6 * n->near);
}

int case_table_random(const char *bones, uint32_t first, uint32_t last, case_views *views)
{
    uint32_t seed = 0, n = 0;
    memset(views, 0, 2u * sizeof *views);
    case_print_head();
    for (seed = first; seed <= last; seed++) {
        const case_bone *const bone = &case_bones[seed % CASE_BONES];
        const case_options o = random_view(seed);
        case_row row;
        int good = 0, bad = 0;
        if (!case_named(bones, bone->name))
            continue;
        row = case_run_row("random", bone, &o);
        good = row.verdict[0] != '\0' ? strcmp(row.verdict, "good") == 0 : row.status == 0;
        bad = good && (row.result.vertex > row.start.vertex || row.result.surface > row.start.surface);
        n++;
        count(&views[0], row.result.vertex, row.start.vertex, good);
        count(&views[1], row.result.surface, row.start.surface, good);
        case_print_row(&row, -1.0, bad ? "MISS farther than its start" : "ok");
    }
    return print_counts(&views[0], "vertex", n) + print_counts(&views[1], "surface", n);
}
