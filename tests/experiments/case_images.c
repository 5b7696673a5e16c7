/* case_images.c: kinds of runs into images: the small computed thigh of a patient, and what makes its image or its
 * landmarks poor or hopeless.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "case.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "files/file_read.h"

enum { PATIENTS = 20 };

/* The image of a run, and the landmarks in it. */
struct case_picture {
    unsigned char *voxels; /* [size[2]][size[1]][size[0]] */
    uint32_t size[3], patient;
    size_t n; /* voxels */
    host_landmarks marks;
};

static unsigned char grey(double value) { return (unsigned char)(value < 0.0 ? 0.0 : value > 255.0 ? 255.0 : value); }

/* Grey values times gain, plus level, plus noise. */
static int regrade(case_job *job, double gain, double level, double noise, oracle_random *r)
{
    case_picture *const p = job->image;
    for (size_t i = 0; i < p->n; i++)
        p->voxels[i] = grey(gain * p->voxels[i] + level + (noise > 0.0 ? noise * case_random_normal(r) : 0.0));
    return 1;
}

static int bright(case_job *job, oracle_random *r)
{
    const double level = oracle_uniform(r, 0.0, 15.0), gain = oracle_uniform(r, 0.7, 1.2);
    return regrade(job, gain, level, 0.0, r);
}

static int grain(case_job *job, oracle_random *r) { return regrade(job, 1.0, 0.0, oracle_uniform(r, 5.0, 15.0), r); }
static int heavy(case_job *job, oracle_random *r) { return regrade(job, 0.5, 50.0, oracle_uniform(r, 50.0, 90.0), r); }
static int inverted(case_job *job, oracle_random *r) { return regrade(job, -1.0, 220.0, 0.0, r); }
static int blank(case_job *job, oracle_random *r) { return regrade(job, 0.0, oracle_uniform(r, 0.0, 250.0), 0.0, r); }

static int noise_only(case_job *job, oracle_random *r)
{
    const double noise = oracle_uniform(r, 20.0, 60.0), level = oracle_uniform(r, 60.0, 130.0);
    return regrade(job, 0.0, level, noise, r);
}

static int half_noise(case_job *job, oracle_random *r)
{
    for (size_t i = job->image->n / 2u; i < job->image->n; i++)
        job->image->voxels[i] = grey(100.0 + 50.0 * case_random_normal(r));
    return 1;
}

/* The lower half of the slices says nothing. */
static int wiped(case_job *job, oracle_random *r)
{
    const case_picture *const p = job->image;
    (void)r;
    memset(p->voxels, 40, (size_t)p->size[0] * p->size[1] * (p->size[2] / 2u));
    return 1;
}

/* Reverses the order along an axis. */
static int reverse(case_picture *p, int axis)
{
    const size_t step = axis == 0 ? 1u : (size_t)p->size[0] * p->size[1], n = p->size[axis];
    for (size_t i = 0; i < p->n; i++) {
        const size_t k = i / step % n;
        if (2u * k < n - 1u) {
            const size_t other = i + (n - 1u - 2u * k) * step;
            const unsigned char keep = p->voxels[i];
            p->voxels[i] = p->voxels[other];
            p->voxels[other] = keep;
        }
    }
    return 1;
}

static int mirrored(case_job *job, oracle_random *r) { return (void)r, reverse(job->image, 0); }
static int head_down(case_job *job, oracle_random *r) { return (void)r, reverse(job->image, 2); }

/* Two thirds of the slices are air. */
static int cropped(case_job *job, oracle_random *r)
{
    const case_picture *const p = job->image;
    const size_t third = p->size[2] / 3u * ((size_t)p->size[0] * p->size[1]), from = oracle_below(r, 3) * third;
    memset(p->voxels, 3, from);
    memset(p->voxels + from + third, 3, p->n - from - third);
    return 1;
}

/* Blocks of slices change places. */
static int shuffled(case_job *job, oracle_random *r)
{
    const case_picture *const p = job->image;
    const size_t block = (size_t)p->size[0] * p->size[1] * 8u;
    unsigned char *const keep = case_alloc(block, 1);
    for (uint32_t i = p->size[2] / 8u; i > 1u; i--) {
        const uint32_t k = oracle_below(r, i);
        memcpy(keep, p->voxels + (i - 1u) * block, block);
        memmove(p->voxels + (i - 1u) * block, p->voxels + k * block, block);
        memcpy(p->voxels + k * block, keep, block);
    }
    free(keep);
    return 1;
}

static int click(case_job *job, double mm, oracle_random *r)
{
    host_landmarks *const m = &job->image->marks;
    for (uint32_t i = 0; i < 3u * m->n; i++)
        m->xyz[i / 3u][i % 3u] += (float)oracle_uniform(r, -mm, mm);
    return 1;
}

static int clicks_5(case_job *job, oracle_random *r) { return click(job, 5.0, r); }
static int clicks_15(case_job *job, oracle_random *r) { return click(job, 15.0, r); }

/* The places of two pairs, or of all, change. */
static int swapped(case_job *job, oracle_random *r)
{
    host_landmarks *const m = &job->image->marks;
    const uint32_t pairs = oracle_below(r, 2) ? m->n / 2u : 2u;
    for (uint32_t i = 0; i < pairs; i++) {
        float keep[3];
        memcpy(keep, m->xyz[i], sizeof keep);
        memcpy(m->xyz[i], m->xyz[m->n - 1u - i], sizeof keep);
        memcpy(m->xyz[m->n - 1u - i], keep, sizeof keep);
    }
    return 1;
}

static int marks_off(case_job *job, oracle_random *r)
{
    host_landmarks *const m = &job->image->marks;
    double d[3];
    case_direction(r, d);
    for (uint32_t i = 0; i < 3u * m->n; i++)
        m->xyz[i / 3u][i % 3u] += (float)(90.0 * d[i % 3u]);
    return 1;
}

static int no_marks(case_job *job, oracle_random *r) { return (void)r, job->image->marks.n = 0, 1; }

/* Runs smr with these words unless their result is there. */
static void need(const char *result, const char *words)
{
    struct stat found;
    const char *const program = getenv("SMR"), *const command =
                                                   case_text("'%s' %s -o '%s' >/dev/null 2>&1",
                                                             program != NULL ? program : "build/smr", words, result);
    if (stat(result, &found) != 0 && system(command) != 0)
        case_fail(command);
}

/* A patient's directory, beside the job's, and the landmarks in it. */
static const char *find_patient(const case_job *job, uint32_t patient)
{
    const char *const path = case_text("%s/../patient_%u", job->directory, patient);
    need(path, case_text("phantom --small --quiet --seed %u", patient));
    case_read_marks(case_text("%s/landmarks_patient.mrk.json", path), &job->image->marks);
    return path;
}

static int others_marks(case_job *job, oracle_random *r)
{
    (void)find_patient(job, (job->image->patient + oracle_below(r, PATIENTS - 1)) % PATIENTS + 1u);
    return 1;
}

const case_kind case_image_kinds[] = {
    {.family = "image", .name = "image", .weight = 8},
    {.family = "image", .name = "image clicks 5", .weight = 2, .change = clicks_5},
    {.family = "image", .name = "image clicks 15", .weight = 1, .change = clicks_15},
    {.family = "image", .name = "image bright", .weight = 2, .change = bright},
    {.family = "image", .name = "image grain", .weight = 2, .change = grain},
    {.family = "image poor", .name = "image heavy grain", .weight = 1, .change = heavy},
    {.family = "image poor", .name = "image noise only", .weight = 1, .change = noise_only},
    {.family = "image poor", .name = "image half noise", .weight = 1, .change = half_noise},
    {.family = "image poor", .name = "image inverted", .weight = 1, .change = inverted},
    {.family = "image poor", .name = "image blank", .weight = 1, .change = blank},
    {.family = "image poor", .name = "image mirrored", .weight = 1, .change = mirrored},
    {.family = "image poor", .name = "image head down", .weight = 1, .change = head_down},
    {.family = "image poor", .name = "image cropped", .weight = 1, .change = cropped},
    {.family = "image poor", .name = "image shuffled", .weight = 1, .change = shuffled},
    {.family = "image poor", .name = "image swapped", .weight = 1, .change = swapped},
    {.family = "image poor", .name = "image marks off", .weight = 1, .change = marks_off},
    {.family = "image poor", .name = "image other's marks", .weight = 1, .change = others_marks},
    {.family = "image poor", .name = "image no marks", .weight = 1, .change = no_marks},
    {.family = "image poor",
     .name = "image wiped",
     .weight = 0,
     .change = wiped}, /* for tracked points: no seed gives it */
    {.name = NULL},
};

/* Changes the patient's image and writes it. The voxels lie behind the header's last line. Returns the height in mm
 * below which a wiped image says nothing. */
static double write_picture(case_job *job, const case_kind *kind, oracle_random *r, const char *patient, int *truth)
{
    static const char last[] = "ElementDataFile = LOCAL\n";
    case_picture *const p = job->image;
    const char *path = case_text("%s/mri_patient.mha", patient);
    char head[1024] = "";
    double offset[3] = {0}, spacing[3] = {0};
    host_bytes bytes;
    host_error error = {0};
    if (host_file_read(path, NULL, &bytes, &error) != 0 || bytes.size < sizeof head)
        case_fail(path);
    memcpy(head, bytes.data, sizeof head - 1u);
    const char *const size = strstr(head, "DimSize = "), *const end = strstr(head, last),
                      *const low = strstr(head, "Offset = "), *const step = strstr(head, "ElementSpacing = ");
    if (size == NULL || end == NULL || low == NULL || step == NULL ||
        sscanf(size, "DimSize = %u %u %u", &p->size[0], &p->size[1], &p->size[2]) != 3 ||
        sscanf(low, "Offset = %lf %lf %lf", &offset[0], &offset[1], &offset[2]) != 3 ||
        sscanf(step, "ElementSpacing = %lf %lf %lf", &spacing[0], &spacing[1], &spacing[2]) != 3)
        case_fail(path);
    p->voxels = bytes.data + (end - head) + strlen(last);
    p->n = (size_t)p->size[0] * p->size[1] * p->size[2];
    *truth = kind->change == NULL || kind->change(job, r);
    path = case_text("%s/image.mha", job->directory);
    FILE *const file = fopen(path, "wb");
    if (file == NULL || fwrite(bytes.data, 1, bytes.size, file) != bytes.size || fclose(file) != 0)
        case_fail(path);
    host_file_free(&bytes);
    return offset[2] + spacing[2] * (p->size[2] / 2u - 0.5);
}

/* Where the patient's vertices are is the truth, and its surfaces are the whole truth; seen is what lies above z mm. */
static void add_bodies(case_job *job, const char *patient, double z)
{
    FILE *const list = popen(case_text("ls '%s/model'", patient), "r");
    char name[CASE_TEXT];
    while (list != NULL && fgets(name, sizeof name, list) != NULL) {
        double p[3];
        name[strcspn(name, "\n")] = '\0';
        case_body *const body = case_add(&job->data, case_text("%s/model/%s", patient, name), HOST_MIRROR_NONE);
        body->truth = case_load(case_text("%s/truth/%s", patient, name), HOST_MIRROR_NONE);
        body->whole = case_copy(&body->truth);
        body->seen = case_alloc(body->model.n_vertices, 1);
        for (uint32_t i = 0; i < body->truth.n_vertices; i++) {
            case_get(&body->truth, i, p);
            body->seen[i] = p[2] > z;
        }
    }
    if (list == NULL || pclose(list) != 0 || job->data.n == 0)
        case_fail(patient);
    job->data.overlap = 1.0;
}

int case_image_make(case_job *job, const case_kind *kind, oracle_random *r)
{
    static case_picture picture;
    const char *const model = case_text("%s/../thigh.smr", job->directory);
    int truth = 0;
    job->image = &picture;
    picture.patient = PATIENTS / 2u * job->half + oracle_below(r, PATIENTS / 2u) + 1u;
    job->bone = case_text("patient_%u", picture.patient);
    const char *const patient = find_patient(job, picture.patient);
    need(model, case_text("build --model '%s'/model/*.ply --reference '%s/mri_reference.mha'", patient, patient));
    const double z = write_picture(job, kind, r, patient, &truth);
    add_bodies(job, patient, kind->change == wiped ? z - 10.0 : -HUGE_VAL);
    (void)printf("half=%.3f\n", z);
    job->words = case_text("--model %s --target %s/image.mha", model, job->directory);
    if (picture.marks.n > 0) {
        const char *const marks = case_text("%s/marks.csv", job->directory);
        case_write_marks(&picture.marks, marks);
        job->words = case_text("%s --landmarks %s/landmarks_reference.mrk.json %s", job->words, patient, marks);
    }
    return truth;
}
