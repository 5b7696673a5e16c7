/* track_frames.c: the frames of a tracking run: their files, points that go along, and how good each is.
 * SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700

#include "track/track_frames.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "files/file_names.h"
#include "measure/surface_distances.h"
#include "volumes/voxel_volume.h"

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
    for (uint32_t i = 0; i < model->n_parts && strcmp(t->file + n, extension) == 0; i++)
        if (strncmp(t->file, model->part[i].name, n) == 0 && model->part[i].name[n] == '\0')
            return host_fail(error, "name", "no structure 'points' beside %s, which the frames have", t->file);
    return 0;
}

static int fit(host_track_points *t, const float *at, const smr_port *port, const host_model *model, host_error *error)
{
    const uint32_t n = t->points.n, vertices = model->info.n_vertices;
    smr_status status = SMR_E_ARENA;
    size_t bytes = 0;
    if (smr_carry_bytes(vertices, n, port->n_workers, &bytes) == SMR_OK)
        t->memory = host_alloc(bytes);
    if (t->memory != NULL)
        status = smr_carry_fit(at, vertices, t->points.xyz[0], n, port, t->memory, bytes, &t->carry);
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
    int result = -1;
    if (t->points.n == 0)
        return 0;
    error->file = t->path;
    t->now = malloc(room);
    if (rest == NULL || t->now == NULL)
        (void)host_fail(error, "points", "free memory");
    else
        result = check_names(t, model, format, error);
    for (uint32_t i = 0; result == 0 && i < model->n_parts; at += 3u * (size_t)model->part[i++].mesh.n_vertices)
        if (smr_model_mesh(model->model, i, rest + at, NULL) != SMR_OK)
            result = host_fail(error, "points", "a model that can carry them");
    for (uint32_t i = 0; mirror != HOST_MIRROR_NONE && i < t->points.n; i++)
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
    if (t->points.n == 0)
        return 0;
    for (uint32_t i = 0; status == SMR_OK && i < model->n_parts; at += 3u * (size_t)model->part[i++].mesh.n_vertices)
        status = smr_get_positions(s, i, t->now + at);
    if (status == SMR_OK)
        status = smr_carry_apply(t->carry, t->now, t->points.xyz[0]);
    error->file = t->path;
    return status == SMR_OK ? 0 : host_fail(error, "points", "a model that carries them (%s)", smr_status_name(status));
}

void host_track_points_columns(const host_track_points *t, host_buffer *out)
{
    for (uint32_t i = 0; i < t->points.n && t->points.n <= HOST_POINT_COLUMNS; i++)
        for (uint32_t k = 0; k < 3; k++) {
            host_buffer_add(out, ",", 1);
            host_points_put_name(&t->points, i, k == 0 ? "_x" : k == 1 ? "_y" : "_z", out);
        }
}

void host_track_points_row(const host_track_points *t, host_buffer *out)
{
    for (uint32_t i = 0; i < t->points.n && t->points.n <= HOST_POINT_COLUMNS; i++)
        host_buffer_print(out, ",%.4f,%.4f,%.4f", (double)t->points.xyz[i][0], (double)t->points.xyz[i][1],
                          (double)t->points.xyz[i][2]);
}

int host_track_points_add(const host_track_points *t, const char *frame, host_output *output, host_error *error)
{
    char name[SMR_NAME_BYTES + 32u];
    host_buffer buffer = {0};
    if (t->points.n == 0)
        return 0;
    (void)snprintf(name, sizeof name, "%s/%s", frame, t->file);
    host_points_write(&t->points, t->file, &buffer);
    return host_output_take(output, name, &buffer, 0, error);
}

void host_track_points_free(host_track_points *t)
{
    host_points_free(&t->points);
    free(t->now);
    free(t->memory);
    memset(t, 0, sizeof *t);
}

/* Surfaces and clouds. */
static int is_target(const struct dirent *entry)
{
    static const char *const kinds[] = {".ply", ".stl", ".obj", ".vtk", ".csv"};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (entry->d_name[0] != '.' && host_has_extension(entry->d_name, kinds[i]))
            return 1;
    return 0;
}

static int list_directory(const char *path, host_frame *frame, host_error *error)
{
    struct dirent **list = NULL;
    const int n = scandir(path, &list, is_target, alphasort);
    int good = n > 0;
    frame->files.path = n > 0 ? calloc((size_t)n, sizeof(char *)) : NULL;
    for (int i = 0; i < n; i++) {
        if (frame->files.path != NULL)
            frame->files.path[frame->files.n++] = host_path_in(path, list[i]->d_name);
        good = good && frame->files.path != NULL && frame->files.path[i] != NULL;
        free(list[i]);
    }
    free(list);
    if (n < 0)
        return host_fail(error, "frame", "a directory that can be read (%s)", strerror(errno));
    if (n > (int)SMR_STRUCTURES_MAX)
        return host_fail(error, "frame", "at most %u files", SMR_STRUCTURES_MAX);
    return good ? 0
                : host_fail(error, "frame", n > 0 ? "free memory" : "a surface or a cloud, or more, in the directory");
}

static int list_file(const char *path, host_frame *frame, host_error *error)
{
    frame->files.path = calloc(1, sizeof(char *));
    if (frame->files.path != NULL)
        frame->files.path[frame->files.n++] = strdup(path);
    return frame->files.path != NULL && frame->files.path[0] != NULL ? 0 : host_fail(error, "frame", "free memory");
}

/* The frame's name is a directory's: the last part of the path, without slashes at its end and a file's extension. */
static int name_frame(const char *path, int directory, host_frame *frame, host_error *error)
{
    char text[1024];
    size_t n = strlen(path);
    while (directory && n > 1u && path[n - 1u] == '/')
        n--;
    (void)snprintf(text, sizeof text, "%.*s%s", (int)(n < 1000u ? n : 1000u), path, directory ? ".ply" : "");
    n = host_base_name(text, frame->name, sizeof frame->name);
    if (n >= sizeof frame->name || n == 0u || strcmp(frame->name, ".") == 0 || strcmp(frame->name, "..") == 0)
        return host_fail(error, "name", "a name of 1 to %u bytes, which names the frame", SMR_NAME_BYTES - 1u);
    return 0;
}

int host_frames_list(const host_files *paths, host_frames *frames, host_error *error)
{
    frames->frame = calloc(paths->n, sizeof *frames->frame);
    if (frames->frame == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < paths->n; i++) {
        host_frame *const frame = &frames->frame[frames->n++];
        struct stat found;
        error->file = paths->path[i];
        if (stat(paths->path[i], &found) != 0)
            return host_fail(error, "frame", "a file or a directory (%s)", strerror(errno));
        if (name_frame(paths->path[i], S_ISDIR(found.st_mode), frame, error) != 0 ||
            (S_ISDIR(found.st_mode) ? list_directory(paths->path[i], frame, error)
                                    : list_file(paths->path[i], frame, error)) != 0)
            return -1;
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(frames->frame[k].name, frame->name) == 0)
                return host_fail(error, "name", "frames with names that differ, '%s' is there twice", frame->name);
    }
    return 0;
}

void host_frames_free(host_frames *frames)
{
    for (uint32_t i = 0; i < frames->n; i++) {
        for (uint32_t k = 0; k < frames->frame[i].files.n; k++)
            free((void *)(uintptr_t)frames->frame[i].files.path[k]); /* a text that this file made */
        free(frames->frame[i].files.path);
    }
    free(frames->frame);
    memset(frames, 0, sizeof *frames);
}

int host_frame_load(const host_frame *frame, const smr_port *port, int mirror, host_load **loads, host_error *error)
{
    *loads = calloc(frame->files.n, sizeof **loads);
    if (*loads == NULL)
        return host_fail(error, "frame", "free memory");
    for (uint32_t i = 0; i < frame->files.n; i++)
        (*loads)[i] = (host_load){.path = frame->files.path[i], .need = HOST_MESH_CLOUD, .mirror = mirror};
    return host_load_all(port, *loads, frame->files.n, error);
}

void host_frame_unload(const host_frame *frame, host_load *loads)
{
    for (uint32_t i = 0; loads != NULL && i < frame->files.n; i++)
        host_mesh_free(&loads[i].mesh);
    free(loads);
}

int host_frame_is_image(const host_frame *f) { return f->files.n == 1u && host_is_volume_path(f->files.path[0]); }

uint32_t host_frame_part(const host_frame *frame, uint32_t i, const host_model *model)
{
    char name[SMR_NAME_BYTES];
    if (frame->files.n == 1u)
        return SMR_ALL;
    if (host_base_name(frame->files.path[i], name, sizeof name) >= sizeof name)
        return HOST_NO_PART;
    for (uint32_t k = 0; k < model->n_parts; k++)
        if (strcmp(model->part[k].name, name) == 0)
            return k;
    return HOST_NO_PART;
}

smr_status host_frame_set_target(smr *s, uint32_t part, const host_mesh *mesh, void **memory)
{
    const smr_mesh view = host_mesh_view(mesh);
    const smr_surface *surface = NULL;
    const smr_points *points = NULL;
    if (mesh->n_triangles == 0)
        points = host_points_make(mesh, memory);
    else
        surface = host_surface_make(&view, memory);
    if (points == NULL && surface == NULL)
        return SMR_E_ARENA;
    return points != NULL ? smr_set_points(s, part, points) : smr_set_surface(s, part, surface);
}

static void lower(smr_verdict *verdict)
{
    if (verdict->level == SMR_VERDICT_GOOD)
        verdict->level = SMR_VERDICT_LOOK;
}

/* Those without triangles are carried. */
static smr_status judge_structures(smr *s, const host_model *model, smr_verdict *verdict, host_track_doubts *doubts)
{
    smr_status status = SMR_OK;
    for (uint32_t i = 0; status == SMR_OK && i < model->n_parts; i++) {
        smr_verdict one;
        if (model->part[i].mesh.n_triangles == 0)
            continue;
        status = smr_get_verdict(s, i, &one);
        if (status != SMR_OK || one.level == SMR_VERDICT_GOOD)
            continue;
        lower(verdict);
        verdict->reasons |= one.reasons;
        doubts->frames[i]++;
    }
    return status;
}

smr_status host_track_judge(smr *s, const host_model *images, int settled, smr_verdict *out, host_track_doubts *doubts)
{
    const smr_status status = smr_get_verdict(s, SMR_ALL, out);
    if (status != SMR_OK || images == NULL)
        return status;
    if (!settled)
        lower(out);
    return judge_structures(s, images, out, doubts);
}

void host_track_note(host_track_verdict *verdict, const host_frame_report *report)
{
    verdict->last = *report;
    if (verdict->worst.name == NULL || report->verdict.level > verdict->worst.verdict.level)
        verdict->worst = *report;
    verdict->n[report->verdict.level]++;
}

/* Reasons go after a colon, then after semicolons. */
static const char *between(uint32_t *n) { return (*n)++ == 0 ? ": " : "; "; }

static void print_reasons(const host_frame_report *frame)
{
    uint32_t n = 0;
    for (uint32_t bit = 1; bit != 0 && bit <= frame->verdict.reasons; bit <<= 1)
        if ((frame->verdict.reasons & bit) != 0)
            (void)printf("%s%s", between(&n), smr_reason_text(bit));
    if (frame->overlap_mm > 0.0f)
        (void)printf("%s" HOST_OVERLAP_TEXT, between(&n), (double)frame->overlap_mm);
    if (frame->last.details.jumped)
        (void)printf("%sthe target jumped", between(&n));
    if (!frame->last.details.settled)
        (void)printf("%sit did not settle within %u ticks", between(&n), frame->ticks);
}

static void print_frame(const host_frame_report *frame)
{
    static const char *const words[] = {"good", "look at the result", "failed"};
    const uint32_t level = frame->verdict.level;
    (void)printf("%s: %s", frame->name, words[level]);
    if (level != SMR_VERDICT_GOOD)
        print_reasons(frame);
    (void)printf(" (probability %.2f", (double)frame->verdict.probability);
    if (frame->verdict.expected_error_mm >= 0.0f && level != SMR_VERDICT_FAILED)
        (void)printf(", expected error %.2f mm", (double)frame->verdict.expected_error_mm);
    (void)printf(")\n");
}

void host_track_print_verdict(const host_track_verdict *verdict)
{
    (void)printf("verdict of the last frame, ");
    print_frame(&verdict->last);
    if (verdict->worst.verdict.level == verdict->last.verdict.level)
        return;
    (void)printf("verdict of the worst frame, ");
    print_frame(&verdict->worst);
}

void host_track_print_doubts(const host_track_doubts *doubts, const host_model *model)
{
    const char *before = "not good in themselves, and in how many frames: ";
    for (uint32_t i = 0; i < model->n_parts; i++)
        if (doubts->frames[i] > 0) {
            (void)printf("%s%s %u", before, model->part[i].name, doubts->frames[i]);
            before = ", ";
        }
    if (before[0] == ',')
        (void)printf("\n");
}
