/* track_frames.c: lists and reads the frames of a moving target, sets what they show.
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
#include "measure/point_targets.h"
#include "measure/surface_distances.h"
#include "volumes/voxel_volume.h"

/* Surfaces and clouds. */
static int is_target(const struct dirent *entry)
{
    static const char *const kinds[] = {".ply", ".stl", ".obj", ".vtk", ".csv"};
    size_t i = 0;
    for (i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (entry->d_name[0] != '.' && host_has_extension(entry->d_name, kinds[i]))
            return 1;
    return 0;
}

static const char *joined(const char *directory, const char *name)
{
    const size_t n = strlen(directory) + strlen(name) + 2u;
    char *const text = malloc(n);
    if (text != NULL)
        (void)snprintf(text, n, "%s/%s", directory, name);
    return text;
}

static int list_directory(const char *path, host_frame *frame, host_error *error)
{
    struct dirent **list = NULL;
    const int n = scandir(path, &list, is_target, alphasort);
    int i = 0, good = n > 0;
    frame->files.path = n > 0 ? calloc((size_t)n, sizeof(char *)) : NULL;
    for (i = 0; i < n; i++) {
        if (frame->files.path != NULL)
            frame->files.path[frame->files.n++] = joined(path, list[i]->d_name);
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
    uint32_t i = 0, k = 0;
    frames->frame = calloc(paths->n, sizeof *frames->frame);
    if (frames->frame == NULL)
        return host_fail(error, "start", "free memory");
    for (i = 0; i < paths->n; i++) {
        host_frame *const frame = &frames->frame[frames->n++];
        struct stat found;
        error->file = paths->path[i];
        if (stat(paths->path[i], &found) != 0)
            return host_fail(error, "frame", "a file or a directory (%s)", strerror(errno));
        if (name_frame(paths->path[i], S_ISDIR(found.st_mode), frame, error) != 0 ||
            (S_ISDIR(found.st_mode) ? list_directory(paths->path[i], frame, error)
                                    : list_file(paths->path[i], frame, error)) != 0)
            return -1;
        for (k = 0; k < i; k++)
            if (strcmp(frames->frame[k].name, frame->name) == 0)
                return host_fail(error, "name", "frames with names that differ, '%s' is there twice", frame->name);
    }
    return 0;
}

void host_frames_free(host_frames *frames)
{
    uint32_t i = 0, k = 0;
    for (i = 0; i < frames->n; i++) {
        union { /* texts that this file made */
            const char *text;
            void *memory;
        } one;
        for (k = 0; k < frames->frame[i].files.n; k++) {
            one.text = frames->frame[i].files.path[k];
            free(one.memory);
        }
        free(frames->frame[i].files.path);
    }
    free(frames->frame);
    memset(frames, 0, sizeof *frames);
}

int host_frame_load(const host_frame *frame, const smr_port *port, int mirror, host_load **loads, host_error *error)
{
    uint32_t i = 0;
    *loads = calloc(frame->files.n, sizeof **loads);
    if (*loads == NULL)
        return host_fail(error, "frame", "free memory");
    for (i = 0; i < frame->files.n; i++) {
        (*loads)[i].path = frame->files.path[i];
        (*loads)[i].need = HOST_MESH_CLOUD;
        (*loads)[i].mirror = mirror;
    }
    return host_load_all(port, *loads, frame->files.n, error);
}

void host_frame_unload(const host_frame *frame, host_load *loads)
{
    uint32_t i = 0;
    for (i = 0; loads != NULL && i < frame->files.n; i++)
        host_mesh_free(&loads[i].mesh);
    free(loads);
}

int host_frame_is_image(const host_frame *frame)
{
    return frame->files.n == 1u && host_is_volume_path(frame->files.path[0]);
}

uint32_t host_frame_part(const host_frame *frame, uint32_t i, const host_model *model)
{
    char name[SMR_NAME_BYTES];
    uint32_t k = 0;
    if (frame->files.n == 1u)
        return SMR_ALL;
    if (host_base_name(frame->files.path[i], name, sizeof name) >= sizeof name)
        return HOST_NO_PART;
    for (k = 0; k < model->n_parts; k++)
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
