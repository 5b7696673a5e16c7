/* track_page.c: keeps frames for the page. Which ones is known from the start: evenly spread, as many as there is room
 * for; so nothing is kept in vain.
 * SPDX-License-Identifier: MIT */
#include "html/track_page.h"

#include <stdlib.h>
#include <string.h>

#include "html/page_thin.h"

#define FRAMES_MOST 121u
#define VERTICES_MOST 40000u /* of the model, in a frame */
#define MODEL_MOST 5000000u  /* bytes of all positions of the model */
#define TRIANGLE_BYTES_MOST 1500000u
#define TARGET_MOST 2000000u /* bytes of all positions of targets */
#define POINT_BYTES 6u
#define ROWS_MOST 10000u
#define TRIES 200u

struct host_track_page {
    host_track_shown shown;
    host_page_mesh *thin; /* [n_parts]; owned, as are the following */
    uint32_t *frame, *n_kept, *triangles, *n_triangle, *n_target;
    float *model_xyz, *target_xyz, *room; /* room: a structure's positions */
    host_track_row *row;
    size_t target_n, target_room;       /* points */
    uint32_t whole_frames, added, next; /* next: of the frames that are shown */
    int showing;                        /* 1: the frame that was added last is shown */
};

static void free_thin(host_track_page *page)
{
    uint32_t i = 0;
    for (i = 0; i < page->shown.model->n_parts; i++)
        host_page_mesh_free(&page->thin[i]);
}

/* Thins all structures. Returns 1 when they fit, 0 when not, -1 when out of memory. */
static int thin_with(host_track_page *page, float cell_mm)
{
    const host_model *const model = page->shown.model;
    size_t vertices = 0, bytes = 0;
    uint32_t i = 0;
    free_thin(page);
    for (i = 0; i < model->n_parts; i++) {
        if (host_page_thin(&model->part[i].mesh, cell_mm, &page->thin[i]) != 0)
            return -1;
        vertices += page->thin[i].n_vertices;
        bytes += host_page_mesh_bytes(page->thin[i].n_vertices, page->thin[i].n_triangles, 0);
    }
    page->shown.cell_mm = cell_mm;
    page->shown.n_vertices = (uint32_t)vertices;
    return vertices <= VERTICES_MOST && bytes <= TRIANGLE_BYTES_MOST;
}

static int thin_model(host_track_page *page)
{
    const host_model *const model = page->shown.model;
    int fits = thin_with(page, 0.0f);
    float cell = 0.0f;
    uint32_t i = 0;
    for (i = 0; i < model->n_parts; i++) {
        const float edge = host_page_edge(&model->part[i].mesh);
        cell = edge > cell ? edge : cell;
    }
    cell = cell > 1e-3f ? cell : 1e-3f;
    for (i = 0; fits == 0 && i < TRIES; i++, cell *= 1.2f)
        fits = thin_with(page, cell);
    return fits == 1 ? 0 : -1;
}

/* The triangles and counts of all structures in arrays of their own. */
static int list_triangles(host_track_page *page)
{
    const uint32_t n = page->shown.model->n_parts;
    size_t all = 0;
    uint32_t i = 0;
    for (i = 0; i < n; i++)
        all += page->thin[i].n_triangles;
    page->triangles = malloc((3u * all + 1u) * sizeof *page->triangles);
    page->n_kept = malloc((n + 1u) * sizeof *page->n_kept);
    page->n_triangle = malloc((n + 1u) * sizeof *page->n_triangle);
    if (page->triangles == NULL || page->n_kept == NULL || page->n_triangle == NULL)
        return -1;
    for (i = 0, all = 0; i < n; all += page->thin[i++].n_triangles) {
        page->n_kept[i] = page->thin[i].n_vertices;
        page->n_triangle[i] = page->thin[i].n_triangles;
        memcpy(page->triangles + 3u * all, page->thin[i].triangles,
               3u * (size_t)page->n_triangle[i] * sizeof *page->triangles);
    }
    return 0;
}

/* First and last frame, and between them what there is room for. */
static int choose_frames(host_track_page *page)
{
    const uint32_t n = page->whole_frames;
    const uint32_t fit = MODEL_MOST / (POINT_BYTES * (page->shown.n_vertices + 1u));
    uint32_t most = fit < FRAMES_MOST ? fit : FRAMES_MOST, i = 0;
    most = most < n ? most : n;
    page->frame = malloc(((size_t)most + 1u) * sizeof *page->frame);
    page->n_target = calloc((size_t)most + 1u, sizeof *page->n_target);
    page->model_xyz = malloc(((size_t)most * page->shown.n_vertices + 1u) * 3u * sizeof *page->model_xyz);
    if (page->frame == NULL || page->n_target == NULL || page->model_xyz == NULL)
        return -1;
    for (i = 0; i < most; i++)
        page->frame[i] = most == 1u ? 0 : (uint32_t)(((uint64_t)i * (n - 1u) + (most - 1u) / 2u) / (most - 1u));
    page->shown.n_frames = most;
    page->shown.target_most = TARGET_MOST / (POINT_BYTES * most);
    return 0;
}

host_track_page *host_track_page_begin(const host_model *model, uint32_t n_frames)
{
    host_track_page *const page = calloc(1, sizeof *page);
    size_t most = 0;
    uint32_t i = 0;
    if (page == NULL)
        return NULL;
    page->shown.model = model;
    page->whole_frames = n_frames;
    page->thin = calloc((size_t)model->n_parts + 1u, sizeof *page->thin);
    for (i = 0; i < model->n_parts; i++)
        most = model->part[i].mesh.n_vertices > most ? model->part[i].mesh.n_vertices : most;
    page->room = malloc((most + 1u) * 3u * sizeof *page->room);
    page->row = calloc(n_frames < ROWS_MOST ? n_frames : ROWS_MOST, sizeof *page->row);
    if (page->thin != NULL && page->room != NULL && page->row != NULL && thin_model(page) == 0 &&
        list_triangles(page) == 0 && choose_frames(page) == 0)
        return page;
    host_track_page_free(page);
    return NULL;
}

void host_track_page_free(host_track_page *page)
{
    if (page == NULL)
        return;
    if (page->thin != NULL)
        free_thin(page);
    free(page->thin);
    free(page->frame);
    free(page->n_kept);
    free(page->triangles);
    free(page->n_triangle);
    free(page->n_target);
    free(page->model_xyz);
    free(page->target_xyz);
    free(page->room);
    free(page->row);
    free(page);
}

/* Of very many frames a row stands for several: for the worst of them. */
static void add_row(host_track_page *page, const host_track_row *row)
{
    host_track_shown *const s = &page->shown;
    const uint32_t n = page->whole_frames < ROWS_MOST ? page->whole_frames : ROWS_MOST;
    host_track_row *const at = &page->row[(uint64_t)row->number * n / page->whole_frames];
    const int new = at == page->row + s->n_rows;
    s->levels[row->level]++;
    s->settled += row->settled != 0;
    s->jumped += row->jumped != 0;
    s->n_rows += new ? 1u : 0u;
    if (new || row->level > at->level || (row->level == at->level && row->residual_mm > at->residual_mm))
        *at = *row;
}

int host_track_page_add(host_track_page *page, const host_track_row *row, const smr *s)
{
    const uint32_t n = page->shown.n_vertices;
    float *to = page->model_xyz + 3u * (size_t)page->next * n;
    uint32_t i = 0, k = 0;
    add_row(page, row);
    page->showing = page->next < page->shown.n_frames && page->frame[page->next] == page->added++;
    if (!page->showing)
        return 0;
    page->next++;
    for (i = 0; i < page->shown.model->n_parts; i++) {
        const host_page_mesh *const thin = &page->thin[i];
        if (smr_get_positions(s, i, page->room) != SMR_OK)
            return -1;
        for (k = 0; k < thin->n_vertices; k++, to += 3)
            memcpy(to, page->room + 3u * (size_t)thin->keep[k], 3u * sizeof *to);
    }
    return 0;
}

int host_track_page_target(host_track_page *page, const host_mesh *mesh, uint32_t n)
{
    const uint32_t most = page->shown.target_most / (n > 0 ? n : 1u);
    const uint32_t count = mesh->n_vertices < most ? mesh->n_vertices : most;
    uint32_t i = 0;
    if (!page->showing)
        return 0;
    if (page->target_n + count > page->target_room) {
        const size_t room = 2u * page->target_room + count;
        float *const grown = realloc(page->target_xyz, (room + 1u) * 3u * sizeof *grown);
        if (grown == NULL)
            return -1;
        page->target_xyz = grown;
        page->target_room = room;
    }
    for (i = 0; i < count; i++) /* evenly spread over the file */
        memcpy(page->target_xyz + 3u * page->target_n++,
               mesh->xyz + 3u * (size_t)((uint64_t)i * mesh->n_vertices / count), 3u * sizeof(float));
    page->n_target[page->next - 1u] += count;
    return 0;
}

host_track_shown host_track_page_shown(const host_track_page *page)
{
    host_track_shown s = page->shown;
    s.frame = page->frame;
    s.n_frames = page->next;
    s.model_xyz = page->model_xyz;
    s.n_kept = page->n_kept;
    s.triangles = page->triangles;
    s.n_triangle = page->n_triangle;
    s.target_xyz = page->target_xyz;
    s.n_target = page->n_target;
    s.row = page->row;
    return s;
}
