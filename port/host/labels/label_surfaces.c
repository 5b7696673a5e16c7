/* label_surfaces.c: makes the surfaces of a label map, a task for each label.
 * SPDX-License-Identifier: MIT */
#include "labels/label_surfaces.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "labels/surface_net.h"
#include "measure/surface_distances.h"

/* Cell (x, y, z) of a map of size (nx, ny, nz), 0 <= x <= nx and so on, lies between the voxels (x - 1, y - 1, z -
 * 1) and (x, y, z); beyond the map all is background. Its number is x + (nx + 1) (y + (ny + 1) z). */
typedef struct host_cells {
    uint32_t size[3];    /* of the map */
    size_t *first;       /* [n_labels + 1]: where a label's cells start; owned */
    uint32_t *cell;      /* numbers, ascending for each label; owned */
    unsigned char *mask; /* bit c: corner c has the label; owned */
    uint32_t n_labels;
} host_cells;

#define CELLS_MAX ((size_t)100u * 1000u * 1000u) /* of all labels; a map of noise has more */

typedef struct scan {
    const uint16_t *index;
    const uint16_t *empty; /* [size[0]] zeros: the rows beyond the map */
    size_t *at;            /* [n_labels + 1] by label: the count, or where its next cell goes */
    host_cells *cells;
} scan;

/* A cell whose corners differ: each of its labels gets it, or is counted. */
static void add_cell(const scan *s, const uint16_t corner[8], uint32_t cell)
{
    for (unsigned c = 0; c < 8u; c++) {
        unsigned mask = 0;
        for (unsigned k = 0; k < 8u; k++)
            mask |= (unsigned)(corner[k] == corner[c]) << k;
        if (corner[c] == 0 || (mask & ((1u << c) - 1u)) != 0) /* background, or done */
            continue;
        if (s->cells->cell != NULL) {
            s->cells->cell[s->at[corner[c]]] = cell;
            s->cells->mask[s->at[corner[c]]] = (unsigned char)mask;
        }
        s->at[corner[c]]++;
    }
}

static const uint16_t *line(const scan *s, uint32_t y, uint32_t z)
{
    const uint32_t *const size = s->cells->size;
    /* y and z are one too large; 0 stands for the row before the map */
    if (y == 0 || y > size[1] || z == 0 || z > size[2])
        return s->empty;
    return s->index + ((size_t)(z - 1u) * size[1] + (y - 1u)) * size[0];
}

static void scan_row(const scan *s, uint32_t y, uint32_t z)
{
    const uint32_t nx = s->cells->size[0];
    const uint16_t *const row[4] = {line(s, y, z), line(s, y + 1u, z), line(s, y, z + 1u), line(s, y + 1u, z + 1u)};
    const uint32_t first = (nx + 1u) * (y + (s->cells->size[1] + 1u) * z);
    uint16_t corner[8] = {0};
    for (uint32_t x = 0; x <= nx; x++) {
        unsigned differ = 0;
        for (uint32_t k = 0; k < 4u; k++) {
            corner[2u * k] = corner[2u * k + 1u];
            corner[2u * k + 1u] = x < nx ? row[k][x] : 0;
        }
        for (uint32_t k = 1; k < 8u; k++)
            differ |= (unsigned)(corner[k] ^ corner[0]);
        if (differ != 0)
            add_cell(s, corner, first + x);
    }
}

static void scan_all(const scan *s)
{
    for (uint32_t z = 0; z <= s->cells->size[2]; z++)
        for (uint32_t y = 0; y <= s->cells->size[1]; y++)
            scan_row(s, y, z);
}

/* Turns counts into the places where each label starts. Returns how many cells there are. */
static size_t place_labels(const scan *s)
{
    host_cells *const cells = s->cells;
    size_t all = 0;
    for (uint32_t i = 0; i < cells->n_labels; i++) {
        cells->first[i] = all;
        all += s->at[i + 1u];
        s->at[i + 1u] = cells->first[i];
    }
    cells->first[cells->n_labels] = all;
    return all;
}

static int list_cells(const scan *s, host_error *error)
{
    host_cells *const cells = s->cells;
    scan_all(s);
    size_t n = place_labels(s);
    if (n > CELLS_MAX)
        return host_fail(error, "labels",
                         "at most %zu million cells at the borders of labels, found %zu: is it a label map?",
                         CELLS_MAX / 1000000u, n);
    cells->mask = host_alloc(n);
    cells->cell = host_alloc(n * sizeof *cells->cell);
    if (cells->mask == NULL || cells->cell == NULL)
        return host_fail(error, "labels", "free memory");
    scan_all(s);
    return 0;
}

/* Finds the cells of the labels 1 to n_labels. index: [size[2]][size[1]][size[0]], 0 is background.
 * 0, or -1 with the error filled; host_cells_free in either case. */
static int host_cells_find(const uint16_t *index, const uint32_t size[3], uint32_t n_labels, host_cells *cells,
                           host_error *error)
{
    uint16_t *const empty = calloc(size[0], sizeof *empty);
    int result = -1;
    memset(cells, 0, sizeof *cells);
    memcpy(cells->size, size, sizeof cells->size);
    cells->n_labels = n_labels;
    cells->first = calloc((size_t)n_labels + 1u, sizeof *cells->first);
    const scan s = {index, empty, calloc((size_t)n_labels + 1u, sizeof *s.at), cells};
    if (empty == NULL || s.at == NULL || cells->first == NULL)
        (void)host_fail(error, "labels", "free memory");
    else
        result = list_cells(&s, error);
    free(s.at);
    free(empty);
    return result;
}

static void host_cells_free(host_cells *cells)
{
    free(cells->first);
    free(cells->cell);
    free(cells->mask);
    memset(cells, 0, sizeof *cells);
}

/* Steps between slices are as many vertices long as a slice is thicker than voxels are wide, and smoothing goes with
 * the square of that: passes are multiplied by it, up to this. */
#define UNEVEN_MOST 10.0
#define AXIS_MAX 16777216u /* voxels: floats count them up to here */

/* The labels of one layer, and where their surfaces go. */
typedef struct layer {
    const host_label_map *map;
    const host_cells *cells;
    host_label_surface *surface;
    uint32_t passes, most;
    double mm3; /* of a voxel; negative when the axes are left-handed */
} layer;

/* Millimetres along the map's axes become places in space. */
static void place_vertices(const host_volume *grid, const host_net *net, float *xyz)
{
    for (size_t v = 0; v < net->n_vertices; v++) {
        double index[3], at[3];
        for (unsigned k = 0; k < 3u; k++)
            index[k] = (double)net->xyz[3u * v + k] / (double)grid->spacing[k];
        host_volume_place(grid, index, at);
        for (unsigned k = 0; k < 3u; k++)
            xyz[3u * v + k] = (float)at[k];
    }
}

static void place_triangles(const host_net *net, int turned, uint32_t *triangles)
{
    for (uint32_t q = 0; q < net->n_quads; q++) {
        unsigned char corner[2][3];
        host_net_corners(net, q, corner);
        for (unsigned t = 0; t < 2u; t++)
            for (unsigned c = 0; c < 3u; c++)
                *triangles++ = net->quad[4u * (size_t)q + corner[t][turned ? 2u - c : c]];
    }
}

/* The net as a mesh. 0, or -1 when out of memory or when vertices lie outside what meshes may have. */
static int take_mesh(const layer *l, const host_net *net, host_mesh *mesh)
{
    mesh->xyz = host_alloc(3u * (size_t)net->n_vertices * sizeof *mesh->xyz);
    mesh->triangles = host_alloc(6u * (size_t)net->n_quads * sizeof *mesh->triangles);
    if (mesh->xyz == NULL || mesh->triangles == NULL)
        return -1;
    mesh->n_vertices = net->n_vertices;
    mesh->n_triangles = 2u * net->n_quads;
    place_vertices(&l->map->grid, net, mesh->xyz);
    place_triangles(net, l->mm3 < 0.0, mesh->triangles);
    for (size_t i = 0; i < 3u * (size_t)mesh->n_vertices; i++)
        if (!(fabsf(mesh->xyz[i]) <= SMR_COORD_MAX))
            return -1;
    return 0;
}

/* Volume inside, mm^3, and area, mm^2. */
static void measure(const host_mesh *mesh, double *volume, double *area)
{
    const float *const origin = mesh->xyz;
    double six = 0.0, twice = 0.0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *const corner = mesh->triangles + 3u * t;
        double p[3][3], n[3];
        for (unsigned i = 0; i < 3u; i++)
            for (unsigned k = 0; k < 3u; k++)
                p[i][k] = (double)mesh->xyz[3u * (size_t)corner[i] + k] -
                          (double)(i == 0 ? origin[k] : mesh->xyz[3u * (size_t)corner[0] + k]);
        for (unsigned k = 0; k < 3u; k++)
            n[k] = p[1][(k + 1u) % 3u] * p[2][(k + 2u) % 3u] - p[1][(k + 2u) % 3u] * p[2][(k + 1u) % 3u];
        six += p[0][0] * n[0] + p[0][1] * n[1] + p[0][2] * n[2];
        twice += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    *volume = six / 6.0;
    *area = twice / 2.0;
}

/* Fewer triangles, and what they are. 0, or -1 when out of memory. */
static int thin(host_label_surface *s, uint32_t most)
{
    host_folds folds;
    if (most == 0 || s->mesh.n_triangles <= most)
        return 0;
    if (host_surface_thin(&s->mesh, most) != 0)
        return -1;
    smr_mesh view = host_mesh_view(&s->mesh);
    if (host_count_folds(&view, NULL, &folds) != 0)
        return -1;
    s->folds = (uint32_t)folds.all;
    measure(&s->mesh, &s->volume, &s->area);
    return 0;
}

/* The surface of one label; nothing when it is in another layer. */
static void make_surface(void *arg, uint32_t task, uint32_t worker)
{
    const layer *const l = arg;
    const host_cells *const cells = l->cells;
    const float *const s = l->map->grid.spacing;
    const double box_mm3 = (double)s[0] * (double)s[1] * (double)s[2];
    const size_t first = cells->first[task], n = cells->first[task + 1u] - first;
    const double uneven = (double)(fmaxf(fmaxf(s[0], s[1]), s[2]) / fminf(fminf(s[0], s[1]), s[2]));
    const uint32_t passes = (uint32_t)((double)l->passes * fmin(uneven * uneven, UNEVEN_MOST));
    host_label_surface *const to = &l->surface[task];
    host_net net;
    (void)worker;
    if (n == 0)
        return;
    if (host_net_make(cells->cell + first, cells->mask + first, n, cells->size, s, &net) != 0) {
        to->failed = "free memory, and at most 4 million vertices in a structure: is it a label map?";
    } else {
        to->voxel_volume = (double)l->map->label[task].voxels * fabs(l->mm3);
        to->folds = host_net_smooth(&net, passes, (double)l->map->label[task].voxels * box_mm3);
        to->volume = host_net_volume(&net, &to->area) / box_mm3 * fabs(l->mm3);
        if (to->folds == UINT32_MAX || take_mesh(l, &net, &to->mesh) != 0 || thin(to, l->most) != 0)
            to->failed = "free memory, and surfaces within 100 m of the origin";
    }
    host_net_free(&net);
}

static int make_layer(const smr_port *port, layer *l, uint32_t number, host_error *error)
{
    const host_label_map *const map = l->map;
    host_cells cells;
    const int result =
        host_cells_find(map->index + number * host_label_voxels(map), map->grid.size, map->n_labels, &cells, error);
    l->cells = &cells;
    if (result == 0)
        host_parallel(port, make_surface, l, map->n_labels);
    host_cells_free(&cells);
    return result;
}

int host_label_surfaces_make(const smr_port *port, const host_label_map *map, uint32_t passes, uint32_t most,
                             host_label_surface *surface, host_error *error)
{
    layer l = {map, NULL, surface, passes, most, host_label_mm3(&map->grid)};
    memset(surface, 0, map->n_labels * sizeof *surface);
    for (uint32_t i = 0; i < 3u; i++)
        if (map->grid.size[i] > AXIS_MAX)
            return host_fail(error, "size", "at most %u voxels along an axis", AXIS_MAX);
    for (uint32_t i = 0; i < map->n_layers; i++)
        if (make_layer(port, &l, i, error) != 0)
            return -1;
    for (uint32_t i = 0; i < map->n_labels; i++)
        if (surface[i].failed != NULL)
            return host_fail(error, map->label[i].name, "%s", surface[i].failed);
    for (uint32_t i = 0; i < map->n_labels && most > 0; i++)
        if (surface[i].mesh.n_triangles > most)
            return host_fail(error, map->label[i].name, "a budget of at least %u triangles, it has parts or is thin",
                             surface[i].mesh.n_triangles);
    return 0;
}

void host_label_surfaces_free(host_label_surface *surface, uint32_t n)
{
    for (uint32_t i = 0; surface != NULL && i < n; i++)
        host_mesh_free(&surface[i].mesh);
    free(surface);
}
