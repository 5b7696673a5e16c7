/* smr phantom: the computed thigh as files: model, reference image, a patient's image, landmarks, the truth.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fixture_thigh.h"
#include "host_commands.h"
#include "host_file.h"
#include "host_mesh.h"
#include "host_output.h"
#include "host_port.h"

enum { MODEL = 0, PATIENT = 1 };

#define SMALL_MESH 1.6f /* times as long edges */
#define PICKED_MM 1.0f  /* how exactly a person clicks, in each coordinate */

static const char *const set_names[2] = {"model", "truth"};
static const char *const image_names[2] = {"mri_reference.mha", "mri_patient.mha"};
static const char *const landmark_names[2] = {"landmarks_reference.mrk.json", "landmarks_patient.mrk.json"};

typedef struct phantom {
    const host_options *options;
    host_port port;
    fixture_thigh thigh;
    fixture_pose pose[2];
    host_mesh mesh[2][FIXTURE_THIGH_PARTS];
    fixture_box box[2];
    uint8_t *voxels[2];
    float *scratch;       /* of all workers */
    size_t scratch_words; /* of one worker */
    int failed[FIXTURE_THIGH_PARTS];
} phantom;

static int make_mesh(phantom *ph, uint32_t part, float *scratch)
{
    host_mesh *const model = &ph->mesh[MODEL][part], *const truth = &ph->mesh[PATIENT][part];
    fixture_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.max_vertices = FIXTURE_THIGH_VERTICES;
    mesh.max_triangles = FIXTURE_THIGH_TRIANGLES;
    mesh.xyz = model->xyz = malloc(3u * sizeof *mesh.xyz * FIXTURE_THIGH_VERTICES);
    mesh.triangles = model->triangles = malloc(3u * sizeof *mesh.triangles * FIXTURE_THIGH_TRIANGLES);
    if (mesh.xyz == NULL || mesh.triangles == NULL ||
        !fixture_thigh_mesh(&ph->thigh, part, ph->options->small ? SMALL_MESH : 1.0f, &mesh, scratch))
        return -1;
    model->n_vertices = truth->n_vertices = mesh.n_vertices;
    model->n_triangles = truth->n_triangles = mesh.n_triangles;
    truth->xyz = malloc(3u * sizeof *truth->xyz * mesh.n_vertices);
    truth->triangles = malloc(3u * sizeof *truth->triangles * mesh.n_triangles);
    if (truth->xyz == NULL || truth->triangles == NULL)
        return -1;
    memcpy(truth->triangles, model->triangles, 3u * sizeof *truth->triangles * mesh.n_triangles);
    fixture_thigh_truth(&ph->pose[PATIENT], model->xyz, mesh.n_vertices, truth->xyz);
    return 0;
}

static void run_mesh(void *arg, uint32_t task, uint32_t worker)
{
    phantom *const ph = arg;
    ph->failed[task] = make_mesh(ph, task, ph->scratch + worker * ph->scratch_words);
}

/* Slices of both images, taken in turns. */
static void run_slice(void *arg, uint32_t task, uint32_t worker)
{
    phantom *const ph = arg;
    const uint32_t both = 2u * (ph->box[0].n[2] < ph->box[1].n[2] ? ph->box[0].n[2] : ph->box[1].n[2]);
    const uint32_t image = task < both ? task % 2u : (ph->box[0].n[2] < ph->box[1].n[2] ? 1u : 0u);
    const uint32_t z = task < both ? task / 2u : task - both / 2u;
    const fixture_box *const box = &ph->box[image];
    fixture_thigh_slice(&ph->thigh, &ph->pose[image], box, z, ph->voxels[image] + (size_t)z * box->n[0] * box->n[1],
                        ph->scratch + worker * ph->scratch_words);
}

static int alloc_scratch(phantom *ph, size_t words)
{
    free(ph->scratch);
    ph->scratch_words = words;
    ph->scratch = host_alloc(words * ph->port.port.n_workers * sizeof *ph->scratch);
    return ph->scratch != NULL ? 0 : -1;
}

static int make_meshes(phantom *ph, host_error *error)
{
    uint32_t i = 0;
    if (alloc_scratch(ph, FIXTURE_THIGH_SCRATCH) != 0)
        return host_fail(error, "phantom", "free memory");
    host_parallel(&ph->port.port, run_mesh, ph, FIXTURE_THIGH_PARTS);
    for (i = 0; i < FIXTURE_THIGH_PARTS; i++)
        if (ph->failed[i] != 0)
            return host_fail(error, ph->thigh.part[i].name, "free memory for its surface");
    return 0;
}

static void set_box(phantom *ph, int image)
{
    const float spacing[2][3] = {{1.0f, 1.0f, 3.0f}, {3.0f, 3.0f, 6.0f}};
    float low[3] = {0}, high[3] = {0};
    uint32_t i = 0, v = 0, k = 0;
    for (i = 0; i < FIXTURE_THIGH_PARTS; i++)
        for (v = 0; v < ph->mesh[image][i].n_vertices; v++)
            for (k = 0; k < 3; k++) {
                const float x = ph->mesh[image][i].xyz[3u * (size_t)v + k];
                low[k] = (i == 0 && v == 0) || x < low[k] ? x : low[k];
                high[k] = (i == 0 && v == 0) || x > high[k] ? x : high[k];
            }
    fixture_thigh_box(low, high, spacing[ph->options->small ? 1 : 0], &ph->box[image]);
}

static int make_images(phantom *ph, host_error *error)
{
    size_t words = 0;
    int i = 0;
    for (i = 0; i < 2; i++) {
        const uint32_t *const n = ph->box[i].n;
        set_box(ph, i);
        ph->voxels[i] = malloc((size_t)n[0] * n[1] * n[2]);
        if (ph->voxels[i] == NULL)
            return host_fail(error, "phantom", "free memory");
        if (FIXTURE_IMAGE_SCRATCH(n[0], n[1]) > words)
            words = FIXTURE_IMAGE_SCRATCH(n[0], n[1]);
    }
    if (alloc_scratch(ph, words) != 0)
        return host_fail(error, "phantom", "free memory");
    host_parallel(&ph->port.port, run_slice, ph, ph->box[0].n[2] + ph->box[1].n[2]);
    return 0;
}

static void put_image(const phantom *ph, int image, host_buffer *out)
{
    const fixture_box *const box = &ph->box[image];
    host_buffer_print(out,
                      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                      "CompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = %.9g %.9g %.9g\n"
                      "AnatomicalOrientation = LPS\nElementSpacing = %.9g %.9g %.9g\nDimSize = %u %u %u\n"
                      "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
                      (double)box->low[0], (double)box->low[1], (double)box->low[2], (double)box->spacing[0],
                      (double)box->spacing[1], (double)box->spacing[2], box->n[0], box->n[1], box->n[2]);
    host_buffer_add(out, ph->voxels[image], (size_t)box->n[0] * box->n[1] * box->n[2]);
}

/* The vertices that stand out; on the patient with a person's inexactness. */
static void put_landmarks(const phantom *ph, int image, host_buffer *out)
{
    uint32_t i = 0, k = 0;
    host_buffer_print(out, "{\n \"markups\": [\n  {\n   \"type\": \"Fiducial\",\n   \"coordinateSystem\": \"LPS\",\n"
                           "   \"coordinateUnits\": \"mm\",\n   \"controlPoints\": [\n");
    for (i = 0; i < FIXTURE_THIGH_LANDMARKS; i++) {
        const fixture_landmark *const mark = fixture_thigh_landmark(i);
        const host_mesh *const model = &ph->mesh[MODEL][mark->part];
        fixture_mesh mesh;
        float at[3];
        memset(&mesh, 0, sizeof mesh);
        mesh.xyz = model->xyz;
        mesh.n_vertices = model->n_vertices;
        memcpy(at, ph->mesh[image][mark->part].xyz + 3u * (size_t)fixture_thigh_pick(mark, &mesh), sizeof at);
        for (k = 0; image == PATIENT && k < 3; k++)
            at[k] += PICKED_MM * fixture_thigh_click(&ph->pose[PATIENT], 3u * i + k);
        host_buffer_print(out,
                          "    { \"id\": \"%u\", \"label\": \"%s\", \"description\": \"%s\", "
                          "\"position\": [%.3f, %.3f, %.3f] }%s\n",
                          i + 1u, mark->name, ph->thigh.part[mark->part].name, (double)at[0], (double)at[1],
                          (double)at[2], i + 1u < FIXTURE_THIGH_LANDMARKS ? "," : "");
    }
    host_buffer_print(out, "   ]\n  }\n ]\n}\n");
}

static int write_set(const phantom *ph, int set, host_output *output, host_error *error)
{
    host_buffer buffer;
    char name[SMR_NAME_BYTES + 16u];
    uint32_t i = 0;
    int result = 0;
    memset(&buffer, 0, sizeof buffer);
    for (i = 0; result == 0 && i < FIXTURE_THIGH_PARTS; i++) {
        (void)snprintf(name, sizeof name, "%s/%s.ply", set_names[set], ph->thigh.part[i].name);
        buffer.size = 0;
        host_mesh_write(&ph->mesh[set][i], HOST_FORMAT_PLY, &buffer);
        result = host_output_add(output, name, &buffer, error);
    }
    if (result == 0) {
        buffer.size = 0;
        put_image(ph, set, &buffer);
        result = host_output_add(output, image_names[set], &buffer, error);
    }
    if (result == 0) {
        buffer.size = 0;
        put_landmarks(ph, set, &buffer);
        result = host_output_add(output, landmark_names[set], &buffer, error);
    }
    host_buffer_free(&buffer);
    return result;
}

static int write_phantom(const phantom *ph, host_error *error)
{
    host_output *const output = host_output_begin(ph->options->out);
    if (output == NULL)
        return host_fail(error, "phantom", "free memory");
    if (write_set(ph, MODEL, output, error) == 0 && write_set(ph, PATIENT, output, error) == 0)
        return host_output_commit(output, error);
    host_output_abandon(output);
    return -1;
}

static void tell(const phantom *ph, double seconds)
{
    uint32_t i = 0, n = 0;
    for (i = 0; i < FIXTURE_THIGH_PARTS; i++)
        n += ph->mesh[MODEL][i].n_vertices;
    (void)printf("%s: %u structures, %u vertices; images of %u x %u x %u and %u x %u x %u voxels; %.3f s\n",
                 ph->options->out, FIXTURE_THIGH_PARTS, n, ph->box[0].n[0], ph->box[0].n[1], ph->box[0].n[2],
                 ph->box[1].n[0], ph->box[1].n[1], ph->box[1].n[2], seconds);
}

static void free_phantom(phantom *ph)
{
    uint32_t i = 0, set = 0;
    for (set = 0; set < 2; set++) {
        for (i = 0; i < FIXTURE_THIGH_PARTS; i++)
            host_mesh_free(&ph->mesh[set][i]);
        free(ph->voxels[set]);
    }
    free(ph->scratch);
    host_port_close(&ph->port);
    free(ph);
}

int host_phantom(const host_options *options, host_error *error)
{
    const double begin = host_seconds();
    phantom *const ph = calloc(1, sizeof *ph);
    int result = HOST_REFUSED;
    error->file = options->out;
    if (ph == NULL) {
        (void)host_fail(error, "phantom", "free memory");
        return HOST_REFUSED;
    }
    ph->options = options;
    fixture_thigh_init(&ph->thigh);
    fixture_thigh_pose(0, &ph->pose[MODEL]);
    fixture_thigh_pose(options->seed, &ph->pose[PATIENT]);
    if (host_output_check(options->out, error) == 0 && host_port_open(&ph->port, options->threads, error) == 0) {
        error->file = options->out;
        if (make_meshes(ph, error) == 0 && make_images(ph, error) == 0 && write_phantom(ph, error) == 0)
            result = HOST_DONE;
    }
    if (result == HOST_DONE && !options->quiet)
        tell(ph, host_seconds() - begin);
    free_phantom(ph);
    return result;
}
