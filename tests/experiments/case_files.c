/* case_files.c: a case as a directory of files.
 * SPDX-License-Identifier: MIT */
#include "case.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "experiment.h"

static const char *const folders[] = {"model", "truth", "whole", "target"};

static host_mesh *mesh_of(case_body *body, int folder)
{
    host_mesh *const all[] = {&body->model, &body->truth, &body->whole, &body->target};
    return all[folder];
}

static int write_mesh(const host_mesh *mesh, const char *path)
{
    host_buffer buffer;
    FILE *const file = fopen(path, "wb");
    int good = file != NULL;
    memset(&buffer, 0, sizeof buffer);
    host_mesh_write(mesh, HOST_FORMAT_PLY, &buffer);
    good = good && !buffer.failed && fwrite(buffer.data, 1, buffer.size, file) == buffer.size;
    good = (file == NULL || fclose(file) == 0) && good;
    host_buffer_free(&buffer);
    return good;
}

/* One line of 0 and 1. */
static int write_seen(const case_body *body, const char *path)
{
    FILE *const file = fopen(path, "w");
    uint32_t i = 0;
    for (i = 0; file != NULL && body->seen != NULL && i < body->model.n_vertices; i++)
        (void)fputc('0' + body->seen[i], file);
    return file != NULL && fclose(file) == 0;
}

static int read_seen(case_body *body, const char *path)
{
    FILE *const file = fopen(path, "r");
    uint32_t i = 0;
    body->seen = case_alloc(body->model.n_vertices, 1);
    for (i = 0; file != NULL && i < body->model.n_vertices; i++)
        body->seen[i] = fgetc(file) == '1';
    return file != NULL && fclose(file) == 0;
}

int case_write(const case_data *data, const char *directory)
{
    char path[CASE_TEXT];
    uint32_t i = 0;
    int k = 0, good = experiment_directory(directory);
    for (k = 0; k < 5; k++) {
        (void)snprintf(path, sizeof path, "%.900s/%s", directory, k < 4 ? folders[k] : "seen");
        good = good && experiment_directory(path);
    }
    for (i = 0; i < data->n; i++) {
        case_body body = data->body[i];
        for (k = 0; k < 4; k++) {
            (void)snprintf(path, sizeof path, "%.900s/%s/%.64s.ply", directory, folders[k], body.name);
            good = good && (mesh_of(&body, k)->n_vertices == 0 || write_mesh(mesh_of(&body, k), path));
        }
        (void)snprintf(path, sizeof path, "%.900s/seen/%.64s.txt", directory, body.name);
        good = good && write_seen(&body, path);
    }
    return good;
}

static int read_body(case_data *data, const char *directory, const char *model)
{
    case_body *const body = &data->body[data->n];
    char path[CASE_TEXT];
    int k = 0, good = case_add(data, model, HOST_MIRROR_NONE);
    for (k = 1; good && k < 4; k++) {
        host_error error;
        memset(&error, 0, sizeof error);
        (void)snprintf(path, sizeof path, "%.900s/%s/%.64s.ply", directory, folders[k], body->name);
        good = host_mesh_read(path, HOST_MESH_POINTS_TOO, HOST_MIRROR_NONE, mesh_of(body, k), &error) == 0;
        if (!good)
            host_error_print(&error);
    }
    (void)snprintf(path, sizeof path, "%.900s/seen/%.64s.txt", directory, body->name);
    return good && read_seen(body, path);
}

int case_read(case_data *data, const char *directory)
{
    experiment_command names = {{NULL}, 0};
    char path[CASE_TEXT];
    int i = 0, good = 1;
    memset(data, 0, sizeof *data);
    (void)snprintf(path, sizeof path, "%.900s/model", directory);
    experiment_add_surfaces(&names, path);
    for (i = 0; good && i < names.n; i++)
        good = read_body(data, directory, names.word[i]);
    good = good && names.n > 0;
    experiment_free(&names);
    return good;
}

void case_free(case_data *data)
{
    uint32_t i = 0;
    int k = 0;
    for (i = 0; i < data->n; i++) {
        for (k = 0; k < 4; k++)
            host_mesh_free(mesh_of(&data->body[i], k));
        free(data->body[i].seen);
    }
    memset(data, 0, sizeof *data);
}
