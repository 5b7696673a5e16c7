/* cmd_warp.c: smr warp: the image of the model, deformed as a registration deformed the model.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "carry/carry_volume.h"
#include "commands/commands.h"
#include "files/output_files.h"
#include "volumes/volume_write.h"

#define MARGIN_MM 10.0f

/* Another volume's grid, or one around the result with the image's voxels. */
static int choose_grid(const host_carried *c, const host_options *options, const host_volume *image, host_volume *grid,
                       host_error *error)
{
    const float s = options->spacing, given[3] = {s, s, s};
    float low[3] = {0}, high[3] = {0};
    if (options->like != NULL) {
        if (host_volume_read(options->like, grid, error) != 0)
            return -1;
        free(grid->voxels);
        grid->voxels = NULL;
        return 0;
    }
    host_carried_box(c, 1, low, high);
    error->file = s > 0.0f ? "--spacing" : options->volume;
    return host_volume_around(low, high, MARGIN_MM, s > 0.0f ? given : image->spacing, grid) == 0
               ? 0
               : host_fail(error, "value", "a spacing that gives at most 200 million voxels: --spacing MM");
}

static int write_volume(const host_volume *volume, const char *path, host_error *error)
{
    host_output *const output = host_output_begin(NULL);
    host_buffer buffer;
    int result = 0;
    if (output == NULL)
        return host_fail(error, "output", "free memory");
    memset(&buffer, 0, sizeof buffer);
    host_volume_write_header(volume, volume->type, 1, "", path, &buffer);
    host_volume_write_values(volume->voxels, volume->type, (size_t)volume->size[0] * volume->size[1] * volume->size[2],
                             &buffer);
    result = host_output_add(output, path, &buffer, error);
    host_buffer_free(&buffer);
    if (result == 0)
        return host_output_commit(output, error);
    host_output_abandon(output);
    return -1;
}

static int warp(host_carried *c, const host_options *options, const host_volume *image, host_volume *out,
                host_error *error)
{
    int64_t missed = 0;
    if (choose_grid(c, options, image, out, error) != 0)
        return -1;
    error->file = options->out;
    missed = host_carried_volume(c, image, out, error);
    if (missed < 0 || write_volume(out, options->out, error) != 0)
        return -1;
    if (missed > 0)
        (void)fprintf(stderr,
                      "smr: at %" PRId64 " places the way back was not found within %g mm: the nearest is used\n",
                      missed, (double)HOST_CARRY_MISS);
    if (!options->quiet)
        (void)printf("%s: %u x %u x %u voxels of %s\n", options->out, out->size[0], out->size[1], out->size[2],
                     options->volume);
    return 0;
}

int host_warp(const host_options *options, host_error *error)
{
    host_carried c;
    host_volume image, out;
    int result = HOST_REFUSED;
    memset(&c, 0, sizeof c);
    memset(&image, 0, sizeof image);
    memset(&out, 0, sizeof out);
    if (host_volume_can_write(options->out, error) == 0 &&
        host_carried_open(&c, options->result, options->threads, error) == 0 &&
        host_volume_read(options->volume, &image, error) == 0 && warp(&c, options, &image, &out, error) == 0)
        result = HOST_DONE;
    if (result == HOST_REFUSED && error->file == c.path) /* the name goes with the map */
        error->file = options->result;
    host_volume_free(&image);
    host_volume_free(&out);
    host_carried_close(&c);
    return result;
}
