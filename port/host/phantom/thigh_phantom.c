/* thigh_phantom.c: computes the thigh phantom: meshes and images of the model and of a patient, and landmarks.
 * SPDX-License-Identifier: MIT */
#include "phantom/thigh_phantom.h"
#include <stdlib.h>
#include <string.h>
#include "base/system.h"

#define SMALL_MESH 1.6f /* factor of the edge lengths of a small phantom */
#define PICKED_MM 1.0f  /* largest error of a person's click, in each coordinate */

static int make_mesh(host_thigh *ph, uint32_t part, float *scratch)
{
    host_mesh *const model = &ph->mesh[HOST_THIGH_MODEL][part], *const truth = &ph->mesh[HOST_THIGH_PATIENT][part];
    fixture_mesh mesh = {0};
    mesh.max_vertices = FIXTURE_THIGH_VERTICES;
    mesh.max_triangles = FIXTURE_THIGH_TRIANGLES;
    mesh.xyz = model->xyz = malloc(3u * sizeof *mesh.xyz * FIXTURE_THIGH_VERTICES);
    mesh.triangles = model->triangles = malloc(3u * sizeof *mesh.triangles * FIXTURE_THIGH_TRIANGLES);
    if (mesh.xyz == NULL || mesh.triangles == NULL ||
        !fixture_thigh_mesh(&ph->thigh, part, ph->small ? SMALL_MESH : 1.0f, &mesh, scratch))
        return -1;
    model->n_vertices = truth->n_vertices = mesh.n_vertices;
    model->n_triangles = truth->n_triangles = mesh.n_triangles;
    truth->xyz = malloc(3u * sizeof *truth->xyz * mesh.n_vertices);
    truth->triangles = malloc(3u * sizeof *truth->triangles * mesh.n_triangles);
    if (truth->xyz == NULL || truth->triangles == NULL)
        return -1;
    memcpy(truth->triangles, model->triangles, 3u * sizeof *truth->triangles * mesh.n_triangles);
    fixture_thigh_truth(&ph->pose[HOST_THIGH_PATIENT], model->xyz, mesh.n_vertices, truth->xyz);
    return 0;
}

static void run_mesh(void *arg, uint32_t task, uint32_t worker)
{
    host_thigh *const ph = arg;
    ph->failed[task] = make_mesh(ph, task, ph->scratch + worker * ph->scratch_words);
}

/* Computes one slice; tasks alternate between the two images. */
static void run_slice(void *arg, uint32_t task, uint32_t worker)
{
    host_thigh *const ph = arg;
    const uint32_t both = 2u * (ph->box[0].n[2] < ph->box[1].n[2] ? ph->box[0].n[2] : ph->box[1].n[2]);
    const uint32_t image = task < both ? task % 2u : (ph->box[0].n[2] < ph->box[1].n[2] ? 1u : 0u);
    const uint32_t z = task < both ? task / 2u : task - both / 2u;
    const fixture_box *const box = &ph->box[image];
    fixture_thigh_slice(&ph->thigh, &ph->pose[image], box, z, ph->voxels[image] + (size_t)z * box->n[0] * box->n[1],
                        ph->scratch + worker * ph->scratch_words);
}

static int alloc_scratch(host_thigh *ph, size_t words)
{
    free(ph->scratch);
    ph->scratch_words = words;
    ph->scratch = host_alloc(words * ph->port->n_workers * sizeof *ph->scratch);
    return ph->scratch != NULL ? 0 : -1;
}

static int make_meshes(host_thigh *ph, host_error *error)
{
    if (alloc_scratch(ph, FIXTURE_THIGH_SCRATCH) != 0)
        return host_fail(error, "phantom", "free memory");
    host_parallel(ph->port, run_mesh, ph, FIXTURE_THIGH_PARTS);
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++)
        if (ph->failed[i] != 0)
            return host_fail(error, ph->thigh.part[i].name, "free memory for its surface");
    return 0;
}

static void set_box(host_thigh *ph, int image)
{
    const float spacing[2][3] = {{1.0f, 1.0f, 3.0f}, {3.0f, 3.0f, 6.0f}};
    float low[3] = {0}, high[3] = {0};
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++)
        for (uint32_t v = 0; v < ph->mesh[image][i].n_vertices; v++)
            for (uint32_t k = 0; k < 3; k++) {
                const float x = ph->mesh[image][i].xyz[3u * (size_t)v + k];
                low[k] = (i == 0 && v == 0) || x < low[k] ? x : low[k];
                high[k] = (i == 0 && v == 0) || x > high[k] ? x : high[k];
            }
    fixture_thigh_box(low, high, spacing[ph->small ? 1 : 0], &ph->box[image]);
}

static int make_images(host_thigh *ph, host_error *error)
{
    size_t words = 0;
    for (int i = 0; i < 2; i++) {
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
    host_parallel(ph->port, run_slice, ph, ph->box[0].n[2] + ph->box[1].n[2]);
    return 0;
}

int host_thigh_make(host_thigh *ph, const smr_port *port, uint32_t seed, uint32_t small, int images, host_error *error)
{
    ph->port = port;
    ph->small = small;
    fixture_thigh_init(&ph->thigh);
    fixture_thigh_pose(0, &ph->pose[HOST_THIGH_MODEL]);
    fixture_thigh_pose(seed, &ph->pose[HOST_THIGH_PATIENT]);
    return make_meshes(ph, error) == 0 && (!images || make_images(ph, error) == 0) ? 0 : -1;
}

/* Landmarks are prominent vertices; the patient's have the error of a person's click. */
const fixture_landmark *host_thigh_landmark(const host_thigh *ph, int set, uint32_t i, float at[3])
{
    const fixture_landmark *const mark = fixture_thigh_landmark(i);
    const host_mesh *const model = &ph->mesh[HOST_THIGH_MODEL][mark->part];
    fixture_mesh mesh = {0};
    mesh.xyz = model->xyz;
    mesh.n_vertices = model->n_vertices;
    memcpy(at, ph->mesh[set][mark->part].xyz + 3u * (size_t)fixture_thigh_pick(mark, &mesh), 3u * sizeof *at);
    for (uint32_t k = 0; set == HOST_THIGH_PATIENT && k < 3; k++)
        at[k] += PICKED_MM * fixture_thigh_click(&ph->pose[HOST_THIGH_PATIENT], 3u * i + k);
    return mark;
}

smr_volume host_thigh_image(const host_thigh *ph, int set)
{
    const fixture_box *const box = &ph->box[set];
    smr_volume view = {0};
    view.voxels = ph->voxels[set];
    view.type = SMR_VOXEL_UINT8;
    memcpy(view.size, box->n, sizeof view.size);
    memcpy(view.origin, box->low, sizeof view.origin);
    memcpy(view.spacing, box->spacing, sizeof view.spacing);
    for (int i = 0; i < 3; i++)
        view.direction[4 * i] = 1.0f;
    return view;
}

void host_thigh_free(host_thigh *ph)
{
    for (uint32_t set = 0; set < 2; set++) {
        for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++)
            host_mesh_free(&ph->mesh[set][i]);
        free(ph->voxels[set]);
    }
    free(ph->scratch);
    memset(ph, 0, sizeof *ph);
}
