/* cmd_bench.c: smr bench and smr phantom: the paper's figures, budgets; the computed thigh.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include "bench/bench_job.h"
#include "commands/commands.h"

int host_bench_run(const host_options *options, host_error *error)
{
    host_bench *const bench = calloc(1, sizeof *bench);
    error->file = "bench";
    if (bench == NULL) {
        (void)host_fail(error, "start", "free memory");
        return HOST_REFUSED;
    }
    int result = host_output_check(options->out, error);
    if (result == 0) {
        result = host_bench_load(bench, options, error);
        if (result == 0)
            result = options->figure1   ? host_bench_figure1(bench, error)
                     : options->figure2 ? host_bench_figure2(bench, error)
                                        : host_bench_soak(bench, error);
        host_bench_free(bench);
    }
    free(bench);
    return result == 0 ? HOST_DONE : HOST_REFUSED;
}

static const char *const set_names[2] = {"model", "truth"};
static const char *const image_names[2] = {"mri_reference.mha", "mri_patient.mha"};
static const char *const landmark_names[2] = {"landmarks_reference.mrk.json", "landmarks_patient.mrk.json"};

typedef struct phantom {
    const host_options *options;
    host_port port;
    host_thigh thigh;
} phantom;

static void put_image(const phantom *ph, int image, host_buffer *out)
{
    const fixture_box *const box = &ph->thigh.box[image];
    host_buffer_print(out,
                      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                      "CompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = %.9g %.9g %.9g\n"
                      "AnatomicalOrientation = LPS\nElementSpacing = %.9g %.9g %.9g\nDimSize = %u %u %u\n"
                      "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
                      (double)box->low[0], (double)box->low[1], (double)box->low[2], (double)box->spacing[0],
                      (double)box->spacing[1], (double)box->spacing[2], box->n[0], box->n[1], box->n[2]);
    host_buffer_add(out, ph->thigh.voxels[image], (size_t)box->n[0] * box->n[1] * box->n[2]);
}

static void put_landmarks(const phantom *ph, int image, host_buffer *out)
{
    host_buffer_print(out, "{\n \"markups\": [\n  {\n   \"type\": \"Fiducial\",\n   \"coordinateSystem\": \"LPS\",\n"
                           "   \"coordinateUnits\": \"mm\",\n   \"controlPoints\": [\n");
    for (uint32_t i = 0; i < FIXTURE_THIGH_LANDMARKS; i++) {
        float at[3];
        const fixture_landmark *const mark = host_thigh_landmark(&ph->thigh, image, i, at);
        host_buffer_print(
            out,
            "    { \"id\": \"%u\", \"label\": \"%s\", \"description\": \"%s\", \"position\": [%.3f, %.3f, %.3f] }%s\n",
            i + 1u, mark->name, ph->thigh.thigh.part[mark->part].name, (double)at[0], (double)at[1], (double)at[2],
            i + 1u < FIXTURE_THIGH_LANDMARKS ? "," : "");
    }
    host_buffer_print(out, "   ]\n  }\n ]\n}\n");
}

static int write_set(const phantom *ph, int set, host_output *output, host_error *error)
{
    host_buffer buffer = {0};
    char name[SMR_NAME_BYTES + 16u];
    int result = 0;
    for (uint32_t i = 0; result == 0 && i < FIXTURE_THIGH_PARTS; i++) {
        (void)snprintf(name, sizeof name, "%s/%s.ply", set_names[set], ph->thigh.thigh.part[i].name);
        host_mesh_write(&ph->thigh.mesh[set][i], HOST_FORMAT_PLY, &buffer);
        result = host_output_take(output, name, &buffer, 0, error);
    }
    put_image(ph, set, &buffer);
    result = host_output_take(output, image_names[set], &buffer, result, error);
    put_landmarks(ph, set, &buffer);
    return host_output_take(output, landmark_names[set], &buffer, result, error);
}

static int write_phantom(const phantom *ph, host_error *error)
{
    host_output *const output = host_output_begin(ph->options->out);
    int result = write_set(ph, HOST_THIGH_MODEL, output, error);
    if (result == 0)
        result = write_set(ph, HOST_THIGH_PATIENT, output, error);
    return host_output_end(output, result, error);
}

static void tell(const phantom *ph, double seconds)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++)
        n += ph->thigh.mesh[HOST_THIGH_MODEL][i].n_vertices;
    (void)printf("%s: %u structures, %u vertices; images of %u x %u x %u and %u x %u x %u voxels; %.3f s\n",
                 ph->options->out, FIXTURE_THIGH_PARTS, n, ph->thigh.box[0].n[0], ph->thigh.box[0].n[1],
                 ph->thigh.box[0].n[2], ph->thigh.box[1].n[0], ph->thigh.box[1].n[1], ph->thigh.box[1].n[2], seconds);
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
    if (host_output_check(options->out, error) == 0 && host_port_open(&ph->port, options->threads, error) == 0) {
        error->file = options->out;
        if (host_thigh_make(&ph->thigh, &ph->port.port, options->seed, options->small, 1, error) == 0 &&
            write_phantom(ph, error) == 0)
            result = HOST_DONE;
    }
    if (result == HOST_DONE && !options->quiet)
        tell(ph, host_seconds() - begin);
    host_thigh_free(&ph->thigh);
    host_port_close(&ph->port);
    free(ph);
    return result;
}
