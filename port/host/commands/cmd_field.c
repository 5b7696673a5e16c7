/* cmd_field.c: smr field: a result's displacement field on a grid, for ITK and 3D Slicer.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "carry/carry_field.h"
#include "commands/commands.h"
#include "files/output_files.h"
#include "volumes/volume_write.h"

#define SPACING_MM 3.0f /* the default; vertices of the thigh are as far apart */
#define MARGIN_MM 20.0f

/* Which grid: another volume's, or one around the model or the result. */
static int choose_grid(const host_carried *c, const host_options *options, host_volume *grid, host_error *error)
{
    const float s = options->spacing > 0.0f ? options->spacing : SPACING_MM, spacing[3] = {s, s, s};
    float low[3] = {0}, high[3] = {0};
    if (options->like != NULL) {
        if (host_volume_read(options->like, grid, error) != 0)
            return -1;
        free(grid->voxels);
        grid->voxels = NULL;
        return 0;
    }
    host_carried_box(c, options->inverse, low, high);
    error->file = "--spacing";
    return host_volume_around(low, high, MARGIN_MM, spacing, grid) == 0
               ? 0
               : host_fail(error, "value", "one that gives at most 200 million voxels");
}

static int put_field(host_carried *c, const host_volume *grid, const host_options *options, int64_t *missed,
                     host_buffer *out, host_error *error)
{
    const size_t n = (size_t)grid->size[0] * grid->size[1] * grid->size[2];
    float *const field = malloc(3u * n * sizeof *field);
    error->file = options->like != NULL ? options->like : "field";
    *missed = field != NULL ? host_carried_field(c, grid, options->inverse, field, error)
                            : host_fail(error, "size", "free memory for %zu voxels", n);
    if (*missed >= 0)
        host_carried_field_file(grid, options->inverse, field, options->out, out);
    free(field);
    return *missed >= 0 ? 0 : -1;
}

static int write_field(host_carried *c, const host_volume *grid, const host_options *options, int64_t *missed,
                       host_error *error)
{
    host_output *output = NULL;
    host_buffer buffer;
    int result = 0;
    memset(&buffer, 0, sizeof buffer);
    result = put_field(c, grid, options, missed, &buffer, error);
    if (result == 0) {
        output = host_output_begin(NULL);
        if (output == NULL)
            result = host_fail(error, "output", "free memory");
    }
    if (result == 0)
        result = host_output_add(output, options->out, &buffer, error);
    host_buffer_free(&buffer);
    if (result == 0)
        return host_output_commit(output, error);
    host_output_abandon(output);
    return -1;
}

static void tell(const host_options *options, const host_volume *grid, int64_t missed)
{
    if (missed > 0)
        (void)fprintf(stderr,
                      "smr: at %" PRId64 " voxels the way back was not found within %g mm: the nearest is used\n",
                      missed, (double)HOST_CARRY_MISS);
    if (!options->quiet)
        (void)printf("%s: %u x %u x %u displacements, of points of the %s\n", options->out, grid->size[0],
                     grid->size[1], grid->size[2], options->inverse ? "result, to the model" : "model, to the result");
}

int host_field(const host_options *options, host_error *error)
{
    host_carried c;
    host_volume grid;
    int64_t missed = 0;
    int result = HOST_REFUSED;
    memset(&c, 0, sizeof c);
    memset(&grid, 0, sizeof grid);
    if (host_volume_can_write(options->out, error) == 0 &&
        host_carried_open(&c, options->result, options->threads, error) == 0 &&
        choose_grid(&c, options, &grid, error) == 0 && write_field(&c, &grid, options, &missed, error) == 0) {
        tell(options, &grid, missed);
        result = HOST_DONE;
    }
    if (result == HOST_REFUSED && error->file == c.path) /* the name goes with the map */
        error->file = options->result;
    host_volume_free(&grid);
    host_carried_close(&c);
    return result;
}
