/* cmd_carry.c: smr carry: points of the model's space to where a registration took them, and back.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "carry/carry_result.h"
#include "commands/commands.h"
#include "files/output_files.h"
#include "landmarks/points_file.h"

#define NAMED_MAX 5u /* points that were not found are named up to here */

static int write_points(const host_points *points, const char *path, host_error *error)
{
    host_output *const output = host_output_begin(NULL);
    host_buffer buffer;
    int result = 0;
    if (output == NULL)
        return host_fail(error, "output", "free memory");
    memset(&buffer, 0, sizeof buffer);
    host_points_write(points, path, &buffer);
    result = host_output_add(output, path, &buffer, error);
    host_buffer_free(&buffer);
    if (result == 0)
        return host_output_commit(output, error);
    host_output_abandon(output);
    return -1;
}

/* Names what was not found; the points stand where they come nearest. */
static void tell_missed(const host_points *points, const unsigned char *missed, int64_t n)
{
    uint32_t i = 0, told = 0;
    (void)fprintf(stderr, "smr: %" PRId64 " of %u points have no place before that leads to them within %g mm:", n,
                  points->n, (double)HOST_CARRY_MISS);
    for (i = 0; i < points->n && told < NAMED_MAX; i++)
        if (missed[i] && ++told > 0) {
            if (points->label != NULL && points->label[i][0] != '\0')
                (void)fprintf(stderr, " %s", points->label[i]);
            else
                (void)fprintf(stderr, " point %u", i);
        }
    (void)fprintf(stderr, "%s\n", n > (int64_t)told ? " ..." : "");
}

/* Where the model was mirrored, a frame would be, too, and none is written. */
static int carry_frames(host_carried *c, host_points *points, uint32_t inverse, host_error *error)
{
    if (c->shape.mirror != HOST_MIRROR_NONE)
        host_points_unorient(points);
    return points->orientation == NULL
               ? 0
               : host_carried_frames(c, inverse, points->xyz[0], points->n, points->orientation[0], error);
}

static int carry_points(host_carried *c, host_points *points, const host_options *options, host_error *error)
{
    unsigned char *const missed = calloc(points->n + 1u, 1);
    int64_t bad = 0;
    int result = HOST_REFUSED;
    error->file = options->points;
    if (missed == NULL)
        (void)host_fail(error, "points", "free memory");
    else if (carry_frames(c, points, options->inverse, error) == 0 &&
             (bad = host_carried_points(c, options->inverse, points->xyz[0], points->n, missed, error)) >= 0 &&
             write_points(points, options->out, error) == 0)
        result = bad > 0 ? HOST_LOOK : HOST_DONE;
    if (result == HOST_LOOK)
        tell_missed(points, missed, bad);
    if (result != HOST_REFUSED && !options->quiet)
        (void)printf("%s: %u points%s\n", options->out, points->n,
                     options->inverse ? ", from the result back to the model" : "");
    free(missed);
    return result;
}

int host_carry(const host_options *options, host_error *error)
{
    host_carried c;
    host_points points;
    int result = HOST_REFUSED;
    memset(&c, 0, sizeof c);
    memset(&points, 0, sizeof points);
    if (host_points_can_write(options->out, error) == 0 && host_points_read(options->points, &points, error) == 0 &&
        host_points_fit(&points, options->out, error) == 0 &&
        host_carried_open(&c, options->result, options->threads, error) == 0)
        result = carry_points(&c, &points, options, error);
    if (result == HOST_REFUSED && error->file == c.path) /* the name goes with the map */
        error->file = options->result;
    host_points_free(&points);
    host_carried_close(&c);
    return result;
}
