/* case_images.c: kinds of runs into images: the small computed thigh of a patient, and what makes its image or its
 * landmarks poor or hopeless.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "case_kinds.h"
#include "files/file_read.h"

enum { PATIENTS = 20 };

const case_kind case_image_kinds[] = {
    {.name = "image", .weight = 8, .fair = 1},
    {.name = "image clicks 5", .weight = 2, .fair = 1, .change = case_change_clicks},
    {.name = "image clicks 15", .weight = 1, .fair = 1, .change = case_change_clicks_15},
    {.name = "image bright", .weight = 2, .fair = 1, .change = case_change_bright},
    {.name = "image grain", .weight = 2, .fair = 1, .change = case_change_grain},
    {.name = "image heavy grain", .weight = 1, .change = case_change_heavy},
    {.name = "image noise only", .weight = 1, .change = case_change_noise_only},
    {.name = "image half noise", .weight = 1, .change = case_change_half_noise},
    {.name = "image inverted", .weight = 1, .change = case_change_inverted},
    {.name = "image blank", .weight = 1, .change = case_change_blank},
    {.name = "image mirrored", .weight = 1, .change = case_change_mirrored},
    {.name = "image head down", .weight = 1, .change = case_change_head_down},
    {.name = "image cropped", .weight = 1, .change = case_change_cropped},
    {.name = "image shuffled", .weight = 1, .change = case_change_shuffled},
    {.name = "image swapped", .weight = 1, .change = case_change_image_swapped},
    {.name = "image marks off", .weight = 1, .change = case_change_image_off},
    {.name = "image other's marks", .weight = 1, .change = case_change_image_other},
    {.name = "image no marks", .weight = 1, .change = case_change_no_marks},
    {.name = NULL},
};

static size_t voxels_of(const case_picture *p) { return (size_t)p->size[0] * p->size[1] * p->size[2]; }

static unsigned char grey(double value) { return (unsigned char)(value < 0.0 ? 0.0 : value > 255.0 ? 255.0 : value); }

/* Grey values times gain, plus level, plus noise. */
static void regrade(case_picture *p, double gain, double level, double noise, oracle_random *r)
{
    size_t i = 0;
    for (i = 0; i < voxels_of(p); i++)
        p->voxels[i] = grey(gain * p->voxels[i] + level + (noise > 0.0 ? noise * case_normal_random(r) : 0.0));
}

int case_change_bright(case_job *job, oracle_random *r)
{
    regrade(job->picture, oracle_uniform(r, 0.7, 1.2), oracle_uniform(r, 0.0, 15.0), 0.0, r);
    return 1;
}

int case_change_grain(case_job *job, oracle_random *r)
{
    regrade(job->picture, 1.0, 0.0, oracle_uniform(r, 5.0, 15.0), r);
    return 1;
}

int case_change_heavy(case_job *job, oracle_random *r)
{
    regrade(job->picture, 0.5, 50.0, oracle_uniform(r, 50.0, 90.0), r);
    return 1;
}

int case_change_noise_only(case_job *job, oracle_random *r)
{
    regrade(job->picture, 0.0, oracle_uniform(r, 60.0, 130.0), oracle_uniform(r, 20.0, 60.0), r);
    return 1;
}

int case_change_half_noise(case_job *job, oracle_random *r)
{
    case_picture *const p = job->picture;
    const size_t half = voxels_of(p) / 2u;
    size_t i = 0;
    for (i = half; i < voxels_of(p); i++)
        p->voxels[i] = grey(100.0 + 50.0 * case_normal_random(r));
    return 1;
}

int case_change_inverted(case_job *job, oracle_random *r)
{
    regrade(job->picture, -1.0, 220.0, 0.0, r);
    return 1;
}

int case_change_blank(case_job *job, oracle_random *r)
{
    regrade(job->picture, 0.0, oracle_uniform(r, 0.0, 250.0), 0.0, r);
    return 1;
}

/* Reverses the order along an axis. */
static void reverse(case_picture *p, int axis)
{
    const size_t step = axis == 0 ? 1u : (size_t)p->size[0] * p->size[1], n = p->size[axis];
    size_t i = 0, k = 0;
    for (i = 0; i < voxels_of(p); i++) {
        k = i / step % n;
        if (2u * k < n - 1u) {
            const size_t other = i + (n - 1u - 2u * k) * step;
            const unsigned char keep = p->voxels[i];
            p->voxels[i] = p->voxels[other];
            p->voxels[other] = keep;
        }
    }
}

int case_change_mirrored(case_job *job, oracle_random *r)
{
    (void)r;
    reverse(job->picture, 0);
    return 1;
}

int case_change_head_down(case_job *job, oracle_random *r)
{
    (void)r;
    reverse(job->picture, 2);
    return 1;
}

/* Two thirds of the slices are air. */
int case_change_cropped(case_job *job, oracle_random *r)
{
    case_picture *const p = job->picture;
    const size_t slice = (size_t)p->size[0] * p->size[1], third = p->size[2] / 3u * slice;
    const size_t from = oracle_below(r, 3) * third;
    memset(p->voxels, 3, from);
    memset(p->voxels + from + third, 3, voxels_of(p) - from - third);
    return 1;
}

/* Blocks of slices change places. */
int case_change_shuffled(case_job *job, oracle_random *r)
{
    case_picture *const p = job->picture;
    const size_t block = (size_t)p->size[0] * p->size[1] * 8u;
    const uint32_t n = p->size[2] / 8u;
    unsigned char *const keep = case_alloc(block, 1);
    uint32_t i = 0;
    for (i = n; i > 1u; i--) {
        const uint32_t k = oracle_below(r, i);
        if (k == i - 1u)
            continue;
        memcpy(keep, p->voxels + (i - 1u) * block, block);
        memcpy(p->voxels + (i - 1u) * block, p->voxels + k * block, block);
        memcpy(p->voxels + k * block, keep, block);
    }
    free(keep);
    return 1;
}

static void click(case_picture *p, double mm, oracle_random *r)
{
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < p->marks.n; i++)
        for (c = 0; c < 3; c++)
            p->marks.xyz[i][c] += (float)oracle_uniform(r, -mm, mm);
}

int case_change_clicks(case_job *job, oracle_random *r)
{
    click(job->picture, 5.0, r);
    return 1;
}

int case_change_clicks_15(case_job *job, oracle_random *r)
{
    click(job->picture, 15.0, r);
    return 1;
}

/* The places of two, or of all, change. */
int case_change_image_swapped(case_job *job, oracle_random *r)
{
    host_landmarks *const m = &job->picture->marks;
    const uint32_t pairs = oracle_below(r, 2) ? m->n / 2u : 2u;
    uint32_t i = 0;
    for (i = 0; i < pairs; i++) {
        float keep[3];
        memcpy(keep, m->xyz[i], sizeof keep);
        memcpy(m->xyz[i], m->xyz[m->n - 1u - i], sizeof keep);
        memcpy(m->xyz[m->n - 1u - i], keep, sizeof keep);
    }
    return 1;
}

int case_change_image_off(case_job *job, oracle_random *r)
{
    host_landmarks *const m = &job->picture->marks;
    double d[3];
    uint32_t i = 0;
    int c = 0;
    case_direction(r, d);
    for (i = 0; i < m->n; i++)
        for (c = 0; c < 3; c++)
            m->xyz[i][c] += (float)(90.0 * d[c]);
    return 1;
}

static const char *need_patient(const char *directory, uint32_t patient)
{
    static char path[CASE_TEXT];
    experiment_command c = {{NULL}, 0};
    struct stat found;
    (void)snprintf(path, sizeof path, "%.900s/patient_%u", directory, patient);
    if (stat(path, &found) == 0)
        return path;
    experiment_add(&c, "phantom");
    experiment_add(&c, "--small");
    experiment_add(&c, "--quiet");
    experiment_add(&c, "--seed");
    experiment_add(&c, "%u", patient);
    experiment_add(&c, "-o");
    experiment_add(&c, "%s", path);
    return experiment_run(&c) == 0 ? path : NULL;
}

static int read_marks(const char *patient, host_landmarks *marks)
{
    char path[CASE_TEXT];
    host_error error;
    memset(&error, 0, sizeof error);
    (void)snprintf(path, sizeof path, "%.900s/landmarks_patient.mrk.json", patient);
    return host_landmarks_read(path, marks, &error) == 0;
}

int case_change_image_other(case_job *job, oracle_random *r)
{
    case_picture *const p = job->picture;
    const char *const other = need_patient(p->directory, (p->patient + oracle_below(r, PATIENTS - 1)) % PATIENTS + 1u);
    return other != NULL && read_marks(other, &p->marks);
}

int case_change_no_marks(case_job *job, oracle_random *r)
{
    (void)r;
    job->picture->marks.n = 0;
    return 1;
}

/* The voxels lie behind the header's last line. */
static unsigned char *find_voxels(const host_bytes *bytes, uint32_t size[3])
{
    static const char last[] = "ElementDataFile = LOCAL\n";
    char head[1024];
    const char *at = NULL;
    const size_t n = bytes->size < sizeof head - 1u ? bytes->size : sizeof head - 1u;
    memcpy(head, bytes->data, n);
    head[n] = '\0';
    at = strstr(head, "DimSize = ");
    if (at == NULL || sscanf(at, "DimSize = %u %u %u", &size[0], &size[1], &size[2]) != 3)
        return NULL;
    at = strstr(head, last);
    return at != NULL ? bytes->data + (at - head) + strlen(last) : NULL;
}

/* Changes the patient's image and writes it. */
static int write_picture(case_job *job, const case_kind *kind, oracle_random *r, const char *patient, const char *to)
{
    char path[CASE_TEXT];
    host_bytes bytes;
    host_error error;
    FILE *file = NULL;
    int good = 0;
    memset(&error, 0, sizeof error);
    (void)snprintf(path, sizeof path, "%.900s/mri_patient.mha", patient);
    if (host_file_read(path, NULL, &bytes, &error) != 0)
        return 0;
    job->picture->voxels = find_voxels(&bytes, job->picture->size);
    good = job->picture->voxels != NULL && (kind->change == NULL || kind->change(job, r));
    file = good ? fopen(to, "wb") : NULL;
    good = file != NULL && fwrite(bytes.data, 1, bytes.size, file) == bytes.size;
    good = (file == NULL || fclose(file) == 0) && good;
    host_file_free(&bytes);
    return good;
}

/* Where the patient's vertices are is the truth, and its surfaces are the whole truth. */
static int add_bodies(case_job *job, const char *patient)
{
    experiment_command names = {{NULL}, 0};
    char path[CASE_TEXT];
    int i = 0, good = 1;
    (void)snprintf(path, sizeof path, "%.900s/model", patient);
    experiment_add_surfaces(&names, path);
    for (i = 0; good && i < names.n; i++) {
        case_body *const body = &job->data.body[job->data.n];
        host_error error;
        memset(&error, 0, sizeof error);
        good = case_add(&job->data, names.word[i], HOST_MIRROR_NONE);
        (void)snprintf(path, sizeof path, "%.900s/truth/%.64s.ply", patient, body->name);
        good = good && host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, &body->truth, &error) == 0;
        if (!good)
            break;
        body->whole = case_copy(&body->truth);
        body->seen = case_alloc(body->model.n_vertices, 1);
        memset(body->seen, 1, body->model.n_vertices);
    }
    experiment_free(&names);
    job->data.overlap = 1.0;
    return good;
}

static int need_model(const char *directory, const char *patient, char path[CASE_TEXT])
{
    char surfaces[CASE_TEXT], reference[CASE_TEXT];
    struct stat found;
    (void)snprintf(path, CASE_TEXT, "%.900s/thigh.smr", directory);
    (void)snprintf(surfaces, sizeof surfaces, "%.900s/model", patient);
    (void)snprintf(reference, sizeof reference, "%.900s/mri_reference.mha", patient);
    return stat(path, &found) == 0 || experiment_build(surfaces, reference, path);
}

int case_image_make(case_job *job, const case_kind *kind, oracle_random *r, const char *directory)
{
    static case_picture picture;
    char model[CASE_TEXT], image[CASE_TEXT], marks[CASE_TEXT], patient[CASE_TEXT];
    const char *found = NULL;
    memset(&picture, 0, sizeof picture);
    job->picture = &picture;
    picture.patient = oracle_below(r, PATIENTS) + 1u;
    (void)snprintf(picture.directory, sizeof picture.directory, "%.900s", directory);
    (void)snprintf(job->bone, sizeof job->bone, "patient %u", picture.patient);
    found = need_patient(directory, picture.patient);
    (void)snprintf(patient, sizeof patient, "%.900s", found != NULL ? found : "");
    (void)snprintf(image, sizeof image, "%.900s/image.mha", directory);
    (void)snprintf(marks, sizeof marks, "%.900s/marks.csv", directory);
    if (found == NULL || !need_model(directory, patient, model) || !read_marks(patient, &picture.marks) ||
        !write_picture(job, kind, r, patient, image) || !add_bodies(job, patient))
        return 0;
    experiment_add(&job->words, "--model");
    experiment_add(&job->words, "%s", model);
    experiment_add(&job->words, "--target");
    experiment_add(&job->words, "%s", image);
    if (picture.marks.n > 0) {
        experiment_add(&job->words, "--landmarks");
        experiment_add(&job->words, "%.900s/landmarks_reference.mrk.json", patient);
        experiment_add(&job->words, "%s", marks);
    }
    return picture.marks.n == 0 || experiment_write_landmarks(marks, &picture.marks);
}
