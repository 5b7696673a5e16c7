/* test_experiment_landmarks.c: tracked points alone, beside a surface and in an image with one half wiped out: how far
 * vertices end from their true places.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_kinds.h"
#include "case_run.h"
#include "files/file_read.h"
#include "property/rig.h"

enum { POINTS = 40 };

/* One model with a known deformation, its landmarks, and what came of it. */
typedef struct tracked {
    case_data *data;
    const smr_model *model;
    smr_landmark mark[SMR_LANDMARKS_MAX];
    uint32_t n;
    double vertex, surface, farthest; /* mm: from true places in the mean, the surface's larger mean, a hard point's */
    double expected;                  /* mm: what was said about `vertex` */
    smr_verdict verdict;
} tracked;

static double apart(const float *a, const float *b)
{
    double sum = 0.0;
    for (int c = 0; c < 3; c++)
        sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return sqrt(sum);
}

/* Triangles whose middles are spread over the surface: each is the one farthest from those before. */
static void spread(const host_mesh *mesh, uint32_t n, uint32_t *triangle)
{
    double *const least = case_alloc(mesh->n_triangles, sizeof *least);
    uint32_t t = 0, k = 0;
    for (t = 0; t < mesh->n_triangles; t++)
        least[t] = HUGE_VAL;
    triangle[0] = 0;
    for (k = 1; k < n; k++) {
        double from[3];
        uint32_t best = 0;
        case_centre(mesh, triangle[k - 1u], from);
        for (t = 0; t < mesh->n_triangles; t++) {
            double to[3], d = 0.0;
            int c = 0;
            case_centre(mesh, t, to);
            for (c = 0; c < 3; c++)
                d += (to[c] - from[c]) * (to[c] - from[c]);
            least[t] = fmin(least[t], d);
            best = least[t] > least[best] ? t : best;
        }
        triangle[k] = best;
    }
    free(least);
}

/* Points in the middle of triangles, or in every second one's corner, with noise. */
static void mark(tracked *t, uint32_t n, double noise_mm, uint32_t hard, uint32_t seed)
{
    const case_body *const body = &t->data->body[0];
    oracle_random r = oracle_seed(100u + seed);
    uint32_t triangle[SMR_LANDMARKS_MAX], k = 0;
    int c = 0;
    spread(&body->model, n, triangle);
    for (k = 0; k < n; k++) {
        smr_landmark *const l = &t->mark[k];
        double from[3], to[3];
        case_centre(&body->model, triangle[k], from);
        case_centre(&body->truth, triangle[k], to);
        memset(l, 0, sizeof *l);
        l->vertex = k % 2u != 0 ? SMR_NONE : body->model.triangles[3u * (size_t)triangle[k]];
        l->weight = 1.0f;
        l->hard = hard;
        for (c = 0; c < 3; c++) {
            const size_t at = 3u * (size_t)l->vertex + (size_t)c;
            l->rest[c] = (float)from[c];
            l->place[c] =
                (k % 2u != 0 ? (float)to[c] : body->truth.xyz[at]) + (float)(noise_mm * case_normal_random(&r));
        }
    }
    t->n = n;
}

static void run(tracked *t, const smr_surface *surface)
{
    const host_mesh *const mesh = &t->data->body[0].model;
    smr_config config = smr_config_default();
    float *const mm = case_alloc(mesh->n_vertices, sizeof *mm), at[SMR_LANDMARKS_MAX][3];
    const float *xyz[1];
    case_figures f;
    uint32_t i = 0;
    config.partial.n_landmarks = SMR_LANDMARKS_MAX;
    config.basic.n_target_vertices = surface != NULL ? t->data->body[0].target.n_vertices : 0u;
    smr *const s = rig_init(t->model, &config, NULL);
    EXPERIMENT_NEED(smr_set_surface(s, SMR_ALL, surface) == SMR_OK);
    EXPERIMENT_NEED(smr_set_landmarks(s, t->mark, t->n) == SMR_OK);
    EXPERIMENT_NEED(rig_run(s, 1000).done);
    EXPERIMENT_NEED(smr_get_landmarks(s, at[0]) == SMR_OK && smr_get_verdict(s, SMR_ALL, &t->verdict) == SMR_OK &&
                    smr_get_expected_error(s, 0, mm) == SMR_OK);
    xyz[0] = rig_positions(s, t->model);
    f = case_measure(t->data, xyz);
    t->vertex = f.vertex;
    t->surface = f.surface;
    t->farthest = t->expected = 0.0;
    for (i = 0; i < t->n; i++)
        t->farthest = fmax(t->farthest, apart(at[i], t->mark[i].place));
    for (i = 0; i < mesh->n_vertices; i++)
        t->expected += (double)mm[i] / mesh->n_vertices;
    free(mm);
}

/* A femur, deformed, turned and shifted away from the truth. */
static tracked make(const char *name, uint32_t seed, int part)
{
    case_options o = case_defaults();
    const smr_prepare_config prepare = smr_prepare_config_default();
    tracked t;
    memset(&t, 0, sizeof t);
    o.seed = seed;
    o.part = part;
    t.data = case_alloc(1, sizeof *t.data);
    EXPERIMENT_NEED(case_add(t.data, experiment_data("%s", name), HOST_MIRROR_NONE));
    case_make(t.data, &o);
    const smr_mesh view = host_mesh_view(&t.data->body[0].model);
    t.model = rig_model(&view, 1, &prepare);
    return t;
}

static void drop(tracked *t)
{
    case_free(t->data);
    free(t->data);
    rig_free_all();
}

static void need_data(void)
{
    if (experiment_data("femurs") == NULL)
        skip();
}

static const char *const femurs[] = {"femurs/femur_2008_0019_left_3k.ply", "femurs/femur_2007_5028_left_3k.ply",
                                     "femurs/femur_vhm_left.ply", "femurs/femur_m_right.ply"};

/* How many of them, of two seeds each, and how many seeds. */
static uint32_t how_many(void) { return experiment_full() ? 4u : 1u; }
static uint32_t how_often(void) { return experiment_full() ? 2u : 1u; }

static void tell(const char *what, const tracked *t)
{
    (void)printf("%-46s vertices %.3f mm (expected %.3f)  surface %.3f  farthest landmark %.4f  verdict %u\n", what,
                 t->vertex, t->expected, t->surface, t->farthest, t->verdict.level);
}

/* 40 tracked points alone, from 8 mm and 8 degrees off, with a known bend of 5 mm. */
static void points_alone(void **state)
{
    (void)state;
    need_data();
    for (uint32_t k = 0; k < how_many(); k++)
        for (uint32_t seed = 1; seed <= how_often(); seed++) {
            tracked t = make(femurs[k], seed, CASE_WHOLE);
            mark(&t, POINTS, 0.0, 0, seed);
            run(&t, NULL);
            tell(femurs[k], &t);
            experiment_bound("40 points alone, vertices", t.vertex, 0.3);
            experiment_bound("what was expected of them", fabs(t.expected - t.vertex), 0.5);
            mark(&t, POINTS, 0.0, 1, seed);
            run(&t, NULL);
            tell("  hard", &t);
            experiment_bound("a hard point", t.farthest, 0.05);
            experiment_bound("hard points, vertices", t.vertex, 0.3);
            if (experiment_full()) {
                mark(&t, POINTS, 0.5, 0, seed);
                run(&t, NULL);
                tell("  with noise of 0.5 mm along each axis", &t);
                experiment_bound("noisy points, vertices", t.vertex, 1.0);
            }
            drop(&t);
        }
    EXPERIMENT_END();
}

/* A surface tells little of what runs along itself; twelve points do. */
static void points_beside_a_surface(void **state)
{
    (void)state;
    need_data();
    if (!experiment_full())
        skip();
    for (uint32_t k = 0; k < how_many() / 2u; k++) {
        tracked t = make(femurs[k], 2, CASE_WHOLE);
        const smr_mesh view = host_mesh_view(&t.data->body[0].target);
        const smr_surface *const surface = rig_surface(&view);
        double without = 0.0, near = 0.0;
        mark(&t, 0, 0.0, 0, 1);
        run(&t, surface);
        tell(femurs[k], &t);
        without = t.vertex;
        near = t.surface;
        mark(&t, 12, 0.0, 1, 1);
        run(&t, surface);
        tell("  with 12 hard points", &t);
        experiment_bound("12 points beside a surface, vertices", t.vertex, 0.6 * without);
        experiment_bound("the surface itself", t.surface, near + 0.05);
        experiment_bound("a hard point", t.farthest, 0.05);
        drop(&t);
    }
    EXPERIMENT_END();
}

/* Where the lower half of the patient's image begins, in slices and mm. */
typedef struct cut {
    size_t slice, first_voxel;
    double z;
} cut;

static cut wipe(const char *from, const char *to)
{
    cut c = {0, 0, 0.0};
    unsigned size[3] = {0, 0, 0};
    double offset[3], spacing[3];
    host_bytes bytes;
    host_error error;
    char head[1024];
    memset(&error, 0, sizeof error);
    EXPERIMENT_NEED(host_file_read(from, NULL, &bytes, &error) == 0 && bytes.size > sizeof head);
    memcpy(head, bytes.data, sizeof head - 1u);
    head[sizeof head - 1u] = '\0';
    const char *const last = strstr(head, "ElementDataFile = LOCAL\n");
    EXPERIMENT_NEED(sscanf(strstr(head, "DimSize"), "DimSize = %u %u %u", &size[0], &size[1], &size[2]) == 3);
    EXPERIMENT_NEED(sscanf(strstr(head, "Offset"), "Offset = %lf %lf %lf", &offset[0], &offset[1], &offset[2]) == 3);
    EXPERIMENT_NEED(sscanf(strstr(head, "ElementSpacing"), "ElementSpacing = %lf %lf %lf", &spacing[0], &spacing[1],
                           &spacing[2]) == 3 &&
                    last != NULL);
    c.first_voxel = (size_t)(last - head) + strlen("ElementDataFile = LOCAL\n");
    c.slice = size[2] / 2u;
    c.z = offset[2] + spacing[2] * ((double)c.slice - 0.5);
    memset(bytes.data + c.first_voxel, 40, c.slice * size[0] * size[1]);
    FILE *const file = fopen(to, "wb");
    EXPERIMENT_NEED(file != NULL && fwrite(bytes.data, 1, bytes.size, file) == bytes.size && fclose(file) == 0);
    host_file_free(&bytes);
    return c;
}

/* Six true places below the cut, spread over all structures: each the one farthest from those before. */
static void track(const case_data *data, const cut *c, const char *model, const char *now)
{
    host_landmarks *const at = case_alloc(2, sizeof *at);
    uint32_t n = 0, i = 0, k = 0, m = 0;
    for (n = 0; n < 7u; n++) {
        double best = -1.0;
        uint32_t body = 0, vertex = 0;
        for (i = 0; i < data->n; i++)
            for (k = 0; k < data->body[i].truth.n_vertices; k++) {
                const float *const p = data->body[i].truth.xyz + 3u * (size_t)k;
                double least = HUGE_VAL;
                for (m = 0; m < n; m++)
                    least = fmin(least, apart(p, at[1].xyz[m]));
                if ((double)p[2] > c->z - 10.0 || !(least > best))
                    continue;
                best = least;
                body = i;
                vertex = k;
            }
        memcpy(at[0].xyz[n], data->body[body].model.xyz + 3u * (size_t)vertex, sizeof at[0].xyz[n]);
        memcpy(at[1].xyz[n], data->body[body].truth.xyz + 3u * (size_t)vertex, sizeof at[1].xyz[n]);
        (void)snprintf(at[0].label[n], HOST_LABEL_BYTES, "t%u", n);
        (void)snprintf(at[1].label[n], HOST_LABEL_BYTES, "t%u", n);
    }
    for (i = 0; i < 2; i++) { /* the first one only began */
        memmove(at[i].xyz[0], at[i].xyz[1], 6u * sizeof at[i].xyz[0]);
        at[i].n = 6;
        EXPERIMENT_NEED(experiment_write_landmarks(i == 0 ? model : now, &at[i]));
    }
    free(at);
}

/* The start's landmarks without those in the wiped half, as `words` name them. */
static void start_above(case_job *job, const cut *c, const char *base)
{
    host_landmarks *const all = case_alloc(2, sizeof *all);
    host_error error;
    int w = 0;
    uint32_t i = 0, k = 0, n = 0;
    memset(&error, 0, sizeof error);
    while (w < job->words.n && strcmp(job->words.word[w], "--landmarks") != 0)
        w++;
    EXPERIMENT_NEED(w + 2 < job->words.n && host_landmarks_read(job->words.word[w + 1], &all[0], &error) == 0);
    all[1] = job->picture->marks;
    for (i = 0; i < all[0].n; i++)
        for (k = 0; k < job->picture->marks.n; k++) {
            if (strcmp(all[0].label[i], job->picture->marks.label[k]) != 0 ||
                (double)job->picture->marks.xyz[k][2] < c->z)
                continue;
            memcpy(all[0].xyz[n], all[0].xyz[i], sizeof all[0].xyz[n]);
            memcpy(all[1].xyz[n], job->picture->marks.xyz[k], sizeof all[1].xyz[n]);
            n++;
        }
    for (i = 0; i < 2; i++) {
        char path[CASE_TEXT];
        all[i].n = n;
        for (k = 0; k < n; k++)
            (void)snprintf(all[i].label[k], HOST_LABEL_BYTES, "s%u", k);
        (void)snprintf(path, sizeof path, "%.900s/start_%u.csv", base, i);
        EXPERIMENT_NEED(experiment_write_landmarks(path, &all[i]));
        free(job->words.word[w + 1 + (int)i]);
        job->words.word[w + 1 + (int)i] = strdup(path);
    }
    experiment_add(&job->words, "--align");
    experiment_add(&job->words, "rigid");
    free(all);
}

/* Mean error of the vertices whose true place is in the wiped half. */
static double wiped_error(const case_data *data, const cut *c, const char *out)
{
    double sum = 0.0, n = 0.0;
    for (uint32_t i = 0; i < data->n; i++) {
        const host_mesh *const truth = &data->body[i].truth;
        host_mesh result;
        host_error error;
        char path[CASE_TEXT];
        memset(&error, 0, sizeof error);
        (void)snprintf(path, sizeof path, "%.900s/%s.ply", out, data->body[i].name);
        EXPERIMENT_NEED(host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &result, &error) == 0 &&
                        result.n_vertices == truth->n_vertices);
        for (uint32_t k = 0; k < truth->n_vertices; k++) {
            const float *const p = truth->xyz + 3u * (size_t)k;
            if ((double)p[2] > c->z)
                continue;
            sum += apart(p, result.xyz + 3u * (size_t)k);
            n += 1.0;
        }
        host_mesh_free(&result);
    }
    return sum / n;
}

/* The lower half of the image says nothing; six tracked points there do. All runs start from the landmarks above. */
static void points_in_a_wiped_half(void **state)
{
    static const char *const names[] = {"without", "with", "hard"};
    const case_kind plain = {.name = "plain", .fair = 1};
    static case_job job;
    double off[3];
    (void)state;
    if (!experiment_full() || experiment_data("femurs") == NULL)
        skip();
    oracle_random r = oracle_seed(4);
    const char *const directory = experiment_scratch("wiped");
    EXPERIMENT_NEED(experiment_directory(directory) && case_image_make(&job, &plain, &r, directory));
    char base[CASE_TEXT];
    (void)snprintf(base, sizeof base, "%.800s", directory);
    char half[CASE_TEXT], from[CASE_TEXT], to[CASE_TEXT], out[CASE_TEXT], image[CASE_TEXT];
    (void)snprintf(image, sizeof image, "%.900s/image.mha", base);
    (void)snprintf(half, sizeof half, "%.900s/half.mha", base);
    (void)snprintf(from, sizeof from, "%.900s/from.csv", base);
    (void)snprintf(to, sizeof to, "%.900s/to.csv", base);
    const cut c = wipe(image, half);
    track(&job.data, &c, from, to);
    start_above(&job, &c, base);
    for (int i = 0; i < 3; i++) {
        experiment_command words = {{NULL}, 0};
        case_run said;
        for (int w = 0; w < job.words.n; w++)
            experiment_add(&words, "%s", strcmp(job.words.word[w], image) == 0 ? half : job.words.word[w]);
        if (i > 0) {
            experiment_add(&words, "--landmark-goals");
            experiment_add(&words, "%s", from);
            experiment_add(&words, "%s", to);
        }
        if (i == 2) {
            experiment_add(&words, "--landmark-weight");
            experiment_add(&words, "hard");
        }
        (void)snprintf(out, sizeof out, "%.900s/%s", base, names[i]);
        case_register(&words, out, &said);
        EXPERIMENT_NEED(said.status != 2);
        off[i] = wiped_error(&job.data, &c, out);
        (void)printf("%-8s error in the wiped half %.3f mm, landmarks %.3f mm off\n", names[i], off[i],
                     case_number(&said, "landmark_goals.residual_max_mm"));
        if (i == 2)
            experiment_bound("a hard point in an image", case_number(&said, "landmark_goals.residual_max_mm"), 0.1);
    }
    experiment_bound("error with six points", off[1], 0.5 * off[0]);
    experiment_bound("error with six hard points", off[2], 0.5 * off[0]);
    case_job_free(&job);
    EXPERIMENT_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(points_alone), cmocka_unit_test(points_beside_a_surface),
                                       cmocka_unit_test(points_in_a_wiped_half)};
    return cmocka_run_group_tests_name("experiment: landmarks", tests, NULL, NULL);
}
