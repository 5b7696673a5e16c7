/* track_points.c: binds points to the model once, carries them after each frame, and writes where they are.
 * SPDX-License-Identifier: MIT */
#include "track/track_points.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "files/file_kind.h"
#include "files/file_names.h"

int host_track_points_read(host_track_points *t, const char *path, host_error *error)
{
    memset(t, 0, sizeof *t);
    if (host_points_read(path, &t->points, error) != 0)
        return -1;
    host_points_unorient(&t->points);
    t->path = path;
    t->file = "points.csv";
    if (host_file_kind(path) == HOST_KIND_SURFACE)
        t->file = "points.ply";
    else if (host_has_extension(path, ".json"))
        t->file = "points.mrk.json";
    else if (host_has_extension(path, ".fcsv"))
        t->file = "points.fcsv";
    return 0;
}

/* A structure's surface must not have the same name. */
static int check_names(const host_track_points *t, const host_model *model, int format, host_error *error)
{
    const char *const extension = host_format_extension(format);
    const size_t n = strlen("points");
    uint32_t i = 0;
    for (i = 0; i < model->n_parts && strcmp(t->file + n, extension) == 0; i++)
        if (strncmp(t->file, model->part[i].name, n) == 0 && model->part[i].name[n] == '\0')
            return host_fail(error, "name", "no structure 'points' beside %s, which the frames have", t->file);
    return 0;
}

static int fit(host_track_points *t, const float *rest, const smr_port *port, const host_model *model,
               host_error *error)
{
    const uint32_t n = t->points.n, vertices = model->info.n_vertices;
    smr_status status = SMR_E_ARENA;
    size_t bytes = 0;
    if (smr_carry_bytes(vertices, n, port->n_workers, &bytes) == SMR_OK)
        t->memory = host_alloc(bytes);
    if (t->memory != NULL)
        status = smr_carry_fit(rest, vertices, t->points.xyz[0], n, port, t->memory, bytes, &t->carry);
    if (status == SMR_E_INPUT)
        return host_fail(error, "points", "coordinates within +-%.0f mm", (double)SMR_COORD_MAX);
    return status == SMR_OK ? 0 : host_fail(error, "points", "free memory (%s)", smr_status_name(status));
}

int host_track_points_bind(host_track_points *t, const host_model *model, int mirror, int format, const smr_port *port,
                           host_error *error)
{
    const size_t room = 3u * sizeof(float) * model->info.n_vertices;
    float *const rest = t->points.n > 0 ? malloc(room) : NULL;
    size_t at = 0;
    uint32_t i = 0;
    int result = -1;
    if (t->points.n == 0)
        return 0;
    error->file = t->path;
    t->now = malloc(room);
    if (rest == NULL || t->now == NULL)
        (void)host_fail(error, "points", "free memory");
    else
        result = check_names(t, model, format, error);
    for (i = 0; result == 0 && i < model->n_parts; at += 3u * (size_t)model->part[i++].mesh.n_vertices)
        if (smr_model_mesh(model->model, i, rest + at, NULL) != SMR_OK)
            result = host_fail(error, "points", "a model that can carry them");
    for (i = 0; mirror != HOST_MIRROR_NONE && i < t->points.n; i++)
        t->points.xyz[i][mirror] = 0.0f - t->points.xyz[i][mirror];
    if (result == 0)
        result = fit(t, rest, port, model, error);
    free(rest);
    return result;
}

int host_track_points_carry(host_track_points *t, const smr *s, const host_model *model, host_error *error)
{
    smr_status status = SMR_OK;
    size_t at = 0;
    uint32_t i = 0;
    if (t->points.n == 0)
        return 0;
    for (i = 0; status == SMR_OK && i < model->n_parts; at += 3u * (size_t)model->part[i++].mesh.n_vertices)
        status = smr_get_positions(s, i, t->now + at);
    if (status == SMR_OK)
        status = smr_carry_apply(t->carry, t->now, t->points.xyz[0]);
    error->file = t->path;
    return status == SMR_OK ? 0 : host_fail(error, "points", "a model that carries them (%s)", smr_status_name(status));
}

void host_track_points_columns(const host_track_points *t, host_buffer *out)
{
    uint32_t i = 0, k = 0;
    for (i = 0; i < t->points.n && t->points.n <= HOST_POINT_COLUMNS; i++)
        for (k = 0; k < 3; k++) {
            host_buffer_add(out, ",", 1);
            host_points_put_name(&t->points, i, k == 0 ? "_x" : k == 1 ? "_y" : "_z", out);
        }
}

void host_track_points_row(const host_track_points *t, host_buffer *out)
{
    uint32_t i = 0;
    for (i = 0; i < t->points.n && t->points.n <= HOST_POINT_COLUMNS; i++)
        host_buffer_print(out, ",%.4f,%.4f,%.4f", (double)t->points.xyz[i][0], (double)t->points.xyz[i][1],
                          (double)t->points.xyz[i][2]);
}

int host_track_points_add(const host_track_points *t, const char *frame, host_output *output, host_error *error)
{
    char name[SMR_NAME_BYTES + 32u];
    host_buffer buffer;
    int result = 0;
    if (t->points.n == 0)
        return 0;
    memset(&buffer, 0, sizeof buffer);
    (void)snprintf(name, sizeof name, "%s/%s", frame, t->file);
    host_points_write(&t->points, t->file, &buffer);
    result = host_output_add(output, name, &buffer, error);
    host_buffer_free(&buffer);
    return result;
}

void host_track_points_free(host_track_points *t)
{
    host_points_free(&t->points);
    free(t->now);
    free(t->memory);
    memset(t, 0, sizeof *t);
}
