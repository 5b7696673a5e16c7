/* case.h: registrations with a known truth: a model, a target made from it, the true place of every vertex and the
 * whole true surface; and how far a result is from them.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_H
#define CASE_H

#include <stddef.h>
#include <stdint.h>

#include "meshes/triangle_mesh.h"
#include "unit/oracle.h"

#define CASE_RESAMPLED_MM 0.03 /* resampling moves the surface by less in the mean */

enum { CASE_BODIES = 32, CASE_TEXT = 1024 };

/* What of the target's surface is there. */
enum {
    CASE_WHOLE = 0,
    CASE_SIDE,    /* triangles whose normals lie within side_deg of a direction across the long axis */
    CASE_PATCHES, /* all within a distance along the surface of `patches` places */
    CASE_END,     /* one end of the long axis: odd seeds keep the upper, even ones the lower */
    CASE_FRONT    /* triangles whose normals have a component towards -y */
};

typedef struct case_options {
    uint32_t seed;
    int part;                   /* CASE_... */
    double share;               /* of the area, for patches and an end */
    int patches;                /* their number */
    double side_deg;            /* degrees */
    double deform_mm, sigma_mm; /* mean displacement over the surface, and of the Gaussians */
    double shift_mm, turn_deg;  /* how far the model starts from the target */
    double noise_mm;            /* standard deviation */
    int noise_isotropic;        /* 1: along all axes; 0: along the normals */
    double outliers;            /* share of the target's vertices that belong to stray triangles */
    int spikes;                 /* 1: outliers are displaced vertices of the surface instead */
    double outlier_mm;          /* they lie within this distance of the surface */
    int density;                /* as in case_resample; -1: the least that keeps the surface where it is */
} case_options;

/* One structure. All meshes are owned. */
typedef struct case_body {
    char name[64];
    host_mesh model;     /* as it starts */
    host_mesh truth;     /* the same triangles, where the vertices belong */
    host_mesh whole;     /* the whole true surface */
    host_mesh target;    /* what the registration is given */
    unsigned char *seen; /* [model.n_vertices]: the true place lies on the visible part; owned */
    double resampling;   /* mm: mean distance between the target's surface, before it is cut or spoiled, and `whole` */
} case_body;

typedef struct case_data {
    case_body body[CASE_BODIES];
    uint32_t n;
    double overlap; /* share of the true surface's area that is visible */
} case_data;

/* How far a result is from the truth, mm. A direction's distance is a mean over area. */
typedef struct case_figures {
    double surface;      /* the larger of both directions */
    double to, from;     /* from the result to the true surface and back */
    double farthest;     /* the largest of both */
    double worst;        /* the largest `surface` of one structure */
    double vertex;       /* mean distance of the vertices to their true places */
    double seen, unseen; /* the same where the target has the place, and where not; -1: no such vertex */
    double share;        /* of vertices that the target has the place of */
} case_figures;

case_options case_defaults(void);

/* Reads a surface as another body of the case: its model, nothing else yet. 0 when it cannot be read. */
int case_add(case_data *data, const char *path, int mirror);

/* Makes target and truth from the models, and moves the models to their start. */
void case_make(case_data *data, const case_options *options);

/* DIR/model, truth, whole, target: NAME.ply each, and DIR/seen/NAME.txt. 0 when a file cannot be written or read. */
int case_write(const case_data *data, const char *directory);
int case_read(case_data *data, const char *directory);
void case_free(case_data *data);

/* The figures of positions in the order of the models' vertices: xyz[body] has [n_vertices][3]. */
case_figures case_measure(const case_data *data, const float *const *xyz);
case_figures case_measure_start(const case_data *data);

/* Of DIR/NAME.ply, or of a file where the case has one body. 0 when it cannot be read or has other vertices. */
int case_measure_files(const case_data *data, const char *result, case_figures *figures);

/* Area means of the distance from one surface to another, mm: centroids weigh 27/60 of a triangle, midpoints of edges
 * 8/60 and corners 3/60 each, exact for cubics. max may be NULL. */
double case_surface_mean(const host_mesh *from, const host_mesh *to, double *max, double *area);

/* ---- pieces that the rest is made of */

/* Memory that is there: the program ends when it is not. */
void *case_alloc(size_t n, size_t size);

double case_normal_random(oracle_random *r); /* mean 0, deviation 1 */
void case_direction(oracle_random *r, double out[3]);

/* A triangle's normal times twice its area. */
void case_triangle_normal(const host_mesh *mesh, uint32_t triangle, double out[3]);
double case_area(const host_mesh *mesh);
void case_centre(const host_mesh *mesh, uint32_t triangle, double out[3]);

/* Unit normals of vertices: [n_vertices][3]; owned by the caller. */
double *case_vertex_normals(const host_mesh *mesh);

host_mesh case_copy(const host_mesh *mesh);

/* The triangles for which keep is not 0, and the vertices that they use. */
host_mesh case_cut(const host_mesh *mesh, const unsigned char *keep);

/* Every triangle in four, at the midpoints of its edges. */
host_mesh case_subdivide(const host_mesh *mesh);

host_mesh case_new_mesh(uint32_t n_vertices, uint32_t n_triangles);

/* The number of the edge from each corner to the next, edge[3 * n_triangles]. Returns how many edges there are. */
uint32_t case_number_edges(const host_mesh *mesh, uint32_t *edge);

/* The same surface by other vertices, at random: one in each triangle, and `density` (0, 1, 2) on each edge. Where a
 * vertex was, a polygon of the new ones around it closes the surface. Vertices on a border leave a gap. */
host_mesh case_resample(const host_mesh *mesh, int density, oracle_random *r);

/* The directions of the largest, middle and smallest spread over the vertices of all n meshes, as rows. */
void case_axes(const host_mesh *const *mesh, uint32_t n, double axes[9]);

/* Which triangles of a whole target are visible: [n_triangles]; owned by the caller. */
unsigned char *case_visible(const host_mesh *mesh, const case_options *options, const double axes[9]);

/* Noise and outliers, from the options. */
void case_spoil(host_mesh *mesh, const host_mesh *whole, const case_options *options, oracle_random *r);

#endif
