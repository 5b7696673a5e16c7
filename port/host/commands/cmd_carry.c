/* cmd_carry.c: smr carry, field and warp: points, displacement fields and images by the map of a result.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "carry/carry_volume.h"
#include "cohort/report_head.h"
#include "commands/commands.h"
#include "files/output_files.h"
#include "landmarks/landmarks.h"

#define ERRORS_MAX 100u /* points whose expected errors are printed */
#define NAMED_MAX 5u    /* points that were not found are named up to here */

/* Says what the result's report thinks of it, where there is one and it is not good. */
static void tell_verdict(const char *directory)
{
    char *const path = host_report_beside(directory, HOST_REPORT_NAME);
    host_bytes bytes = {0};
    host_report_head head;
    host_error error = {0};
    if (path != NULL && host_report_there(path) && host_report_bytes(path, &bytes, &error) == 0 &&
        host_report_parse(bytes.data, bytes.size, &head, &error) == 0) {
        const host_verdict *const v = &head.verdict;
        if (v->level != HOST_VERDICT_GOOD)
            (void)fprintf(stderr, "smr: the verdict on %s is %s%s%s\n", directory, host_verdict_name(v->level),
                          v->n_reasons > 0 ? ": " : "", v->n_reasons > 0 ? v->reason[0] : "");
        host_report_free(&head);
    }
    host_file_free(&bytes);
    free(path);
}

/* Closes the result. The error's name goes with the map: the result's directory takes its place. */
static int finish(host_carried *c, const host_options *options, int result, host_error *error)
{
    if (result != HOST_REFUSED)
        tell_verdict(options->result);
    if (result == HOST_REFUSED && error->file == c->path)
        error->file = options->result;
    host_carried_close(c);
    return result;
}

static int write_points(const host_points *points, const char *path, host_error *error)
{
    host_buffer buffer = {0};
    host_points_write(points, path, &buffer);
    return host_output_file(NULL, path, &buffer, 0, error);
}

/* Names what was not found; the points stand where they come nearest. */
static void tell_missed(const host_points *points, const unsigned char *missed, int64_t n)
{
    uint32_t told = 0;
    (void)fprintf(stderr, "smr: %" PRId64 " of %u points have no place before that leads to them within %g mm:", n,
                  points->n, (double)HOST_CARRY_MISS);
    for (uint32_t i = 0; i < points->n && told < NAMED_MAX; i++)
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

/* The expected errors of the points before they are carried; NULL: out of memory. */
static double *find_errors(const host_carried *c, const host_points *points, uint32_t inverse)
{
    double *const errors = malloc((2u * (size_t)points->n + 1u) * sizeof *errors);
    for (uint32_t i = 0; errors != NULL && i < points->n; i++)
        host_carried_error(c, inverse, points->xyz[i], errors + 2u * (size_t)i);
    return errors;
}

static void tell_errors(const host_points *points, const double *errors)
{
    for (uint32_t i = 0; i < points->n; i++) {
        const double across = errors[2u * (size_t)i], along = errors[2u * (size_t)i + 1u];
        const char *const label = points->label != NULL ? points->label[i] : "";
        if (across >= 0.0)
            (void)printf("  %u %s: expected error %.2f mm, across the surface %.2f, along it %.2f\n", i, label,
                         sqrt(across * across + along * along), across, along);
    }
}

static int carry_points(host_carried *c, host_points *points, const host_options *options, host_error *error)
{
    unsigned char *const missed = calloc(points->n + 1u, 1);
    double *const errors = points->n <= ERRORS_MAX ? find_errors(c, points, options->inverse) : NULL;
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
    if (result != HOST_REFUSED && !options->quiet && errors != NULL)
        tell_errors(points, errors);
    free(errors);
    free(missed);
    return result;
}

int host_carry(const host_options *options, host_error *error)
{
    host_carried c = {0};
    host_points points = {0};
    int result = HOST_REFUSED;
    if (host_points_can_write(options->out, error) == 0 && host_points_read(options->points, &points, error) == 0 &&
        host_points_fit(&points, options->out, error) == 0 &&
        host_carried_open(&c, options->result, options->threads, error) == 0)
        result = carry_points(&c, &points, options, error);
    host_points_free(&points);
    return finish(&c, options, result, error);
}

#define FIELD_MARGIN_MM 20.0f
#define WARP_MARGIN_MM 10.0f
#define SPACING_MM 3.0f /* the default; vertices of the thigh are as far apart */

/* Another volume's grid, or one around the model or the result. file and expected: of the error when it is too fine. */
static int choose_grid(const host_carried *c, const host_options *options, float margin_mm, const float spacing[3],
                       const char *file, const char *expected, host_volume *grid, host_error *error)
{
    float low[3] = {0}, high[3] = {0};
    if (options->like != NULL)
        return host_volume_read_grid(options->like, grid, error);
    host_carried_box(c, options->command == HOST_WARP || options->inverse, low, high);
    error->file = file;
    return host_volume_around(low, high, margin_mm, spacing, grid) == 0 ? 0 : host_fail(error, "value", "%s", expected);
}

/* What is said of a field. */
typedef struct field_facts {
    int64_t missed; /* voxels for which the way back was not found */
    uint64_t folds; /* cells that fold */
} field_facts;

static int put_field(host_carried *c, const host_volume *grid, const host_options *options, field_facts *facts,
                     host_buffer *out, host_error *error)
{
    const size_t n = (size_t)grid->size[0] * grid->size[1] * grid->size[2];
    float *const field = malloc(3u * n * sizeof *field);
    error->file = options->like != NULL ? options->like : "field";
    facts->missed = field != NULL ? host_carried_field(c, grid, options->inverse, field, error)
                                  : host_fail(error, "size", "free memory for %zu voxels", n);
    if (facts->missed >= 0) {
        facts->folds = host_field_folds(grid, field, c->shape.mirror != HOST_MIRROR_NONE);
        host_carried_field_file(grid, options->inverse, field, options->out, out);
    }
    free(field);
    return facts->missed >= 0 ? 0 : -1;
}

static int write_field(host_carried *c, const host_volume *grid, const host_options *options, field_facts *facts,
                       host_error *error)
{
    host_buffer buffer = {0};
    const int result = put_field(c, grid, options, facts, &buffer, error);
    return host_output_file(NULL, options->out, &buffer, result, error);
}

static void tell(const host_options *options, const host_volume *grid, const field_facts *facts)
{
    if (facts->missed > 0)
        (void)fprintf(stderr,
                      "smr: at %" PRId64 " voxels the way back was not found within %g mm: the nearest is used\n",
                      facts->missed, (double)HOST_CARRY_MISS);
    if (facts->folds > 0)
        (void)fprintf(stderr,
                      "smr: %" PRIu64 " cells of the grid fold: a transform by this field has no inverse there\n",
                      facts->folds);
    if (!options->quiet)
        (void)printf("%s: %u x %u x %u displacements, of points of the %s; %" PRIu64 " cells fold\n", options->out,
                     grid->size[0], grid->size[1], grid->size[2],
                     options->inverse ? "result, to the model" : "model, to the result", facts->folds);
}

int host_field(const host_options *options, host_error *error)
{
    host_carried c = {0};
    host_volume grid = {0};
    const float s = options->spacing > 0.0f ? options->spacing : SPACING_MM, spacing[3] = {s, s, s};
    field_facts facts = {0, 0};
    int result = HOST_REFUSED;
    if (host_volume_can_write(options->out, error) == 0 &&
        host_carried_open(&c, options->result, options->threads, error) == 0 &&
        choose_grid(&c, options, FIELD_MARGIN_MM, spacing, "--spacing", "one that gives at most 200 million voxels",
                    &grid, error) == 0 &&
        write_field(&c, &grid, options, &facts, error) == 0) {
        tell(options, &grid, &facts);
        result = HOST_DONE;
    }
    host_volume_free(&grid);
    return finish(&c, options, result, error);
}

static int write_volume(const host_volume *volume, const char *path, host_error *error)
{
    host_buffer buffer = {0};
    host_volume_write_header(volume, volume->type, 1, "", path, &buffer);
    host_volume_write_values(volume->voxels, volume->type, (size_t)volume->size[0] * volume->size[1] * volume->size[2],
                             &buffer);
    return host_output_file(NULL, path, &buffer, 0, error);
}

static int warp(host_carried *c, const host_options *options, const host_volume *v, host_volume *out, host_error *error)
{
    const float s = options->spacing, given[3] = {s, s, s};
    if (choose_grid(c, options, WARP_MARGIN_MM, s > 0.0f ? given : v->spacing, s > 0.0f ? "--spacing" : options->volume,
                    "a spacing that gives at most 200 million voxels: --spacing MM", out, error) != 0)
        return -1;
    error->file = options->out;
    int64_t missed = host_carried_volume(c, v, out, error);
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
    host_carried c = {0};
    host_volume image = {0}, out = {0};
    int result = HOST_REFUSED;
    if (host_volume_can_write(options->out, error) == 0 &&
        host_carried_open(&c, options->result, options->threads, error) == 0 &&
        host_volume_read(options->volume, &image, error) == 0 && warp(&c, options, &image, &out, error) == 0)
        result = HOST_DONE;
    host_volume_free(&image);
    host_volume_free(&out);
    return finish(&c, options, result, error);
}
