/* case.h: registrations with a known truth: a model, a target made from it, the true place of every vertex and the
 * whole true surface; and how far a result is from them.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_H
#define CASE_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include "landmarks/landmarks.h"
#include "meshes/triangle_mesh.h"
#include "unit/oracle.h"

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
    double flex_deg;            /* turn of all bodies but the first about the VHM's right hip joint */
    int joined;                 /* 1: all bodies' targets are in the first one's file */
    double noise_mm;            /* standard deviation along the normals */
    int dense;                  /* how often the model's triangles are cut into four */
    double outliers;            /* share of the target's vertices that belong to stray triangles */
} case_options;

/* One structure. All meshes are owned. */
typedef struct case_body {
    char name[64];
    host_mesh model;     /* as it starts */
    host_mesh truth;     /* the same triangles, where the vertices belong; no vertices: unknown */
    host_mesh whole;     /* the whole true surface */
    host_mesh target;    /* what the registration is given; no vertices: an image is the target */
    unsigned char *seen; /* [model.n_vertices]: the true place lies on the visible part; owned, NULL: unknown */
} case_body;

typedef struct case_data {
    case_body body[CASE_BODIES];
    uint32_t n;
    host_mesh beside; /* what lies beside the first body and is deformed with it, into the same target; owned */
    double overlap;   /* share of the true surface's area that is visible */
} case_data;

/* How far a result is from the truth, mm. A direction's distance is a mean over area. */
typedef struct case_figures {
    double to, from; /* from the result to the true surface and back */
    double surface;  /* the larger of both */
    double vertex;   /* mean distance of the vertices to their true places; -1: no such vertex */
    double worst;    /* the largest of them */
    double unseen;   /* the same where the target has not the place */
    double shown;    /* the same where the target has it */
} case_figures;

static inline double case_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline double case_length(const double *a) { return sqrt(case_dot(a, a)); }

/* Vertex i in double precision, and back. */
static inline void case_get(const host_mesh *mesh, uint32_t i, double p[3])
{
    for (uint32_t c = 0; c < 3u; c++)
        p[c] = (double)mesh->xyz[3u * (size_t)i + c];
}
static inline void case_put(host_mesh *mesh, uint32_t i, const double p[3])
{
    for (uint32_t c = 0; c < 3u; c++)
        mesh->xyz[3u * (size_t)i + c] = (float)p[c];
}
static inline double case_apart(const double *a, const double *b)
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return case_length(d);
}
static inline double case_radians(double degrees) { return degrees * acos(-1.0) / 180.0; }

/* ---- case_mesh.c: memory and files, of which one that fails ends the program; meshes */

void *case_alloc(size_t n, size_t size);
/* A text as printf() would print it; it stays until the program ends. */
char *case_text(const char *format, ...) __attribute__((format(printf, 1, 2)));
_Noreturn void case_fail(const char *what);
void case_directory(const char *path);
host_mesh case_load(const char *path, int mirror);
void case_save(const host_mesh *mesh, const char *path);

/* Adds a body whose name is the file's. */
case_body *case_add(case_data *data, const char *path, int mirror);

/* Adds a file's surface to what lies beside the first body. */
void case_beside(case_data *data, const char *path, int mirror);

/* A triangle's normal times twice its area. */
void case_normal(const host_mesh *mesh, uint32_t triangle, double out[3]);
void case_centre(const host_mesh *mesh, uint32_t triangle, double out[3]);
double case_area(const host_mesh *mesh);
/* Unit normals of vertices: [n_vertices][3]; owned by the caller. */
double *case_vertex_normals(const host_mesh *mesh);

host_mesh case_new_mesh(uint32_t n_vertices, uint32_t n_triangles);
host_mesh case_copy(const host_mesh *mesh);
/* Keeps the triangles for which keep is not 0, and the vertices that they use; frees keep. */
void case_cut(host_mesh *mesh, unsigned char *keep);
/* Keeps triangles whose middles have z within low..high mm, or within those shares of the mesh's height. */
void case_keep_height(host_mesh *mesh, double low, double high);
void case_keep_shares(host_mesh *mesh, double from, double to);
double case_height(const host_mesh *mesh, double *low);
/* The mean of the vertices. */
void case_middle(const host_mesh *mesh, double out[3]);
/* The middle and half the size of the box around it. */
void case_box(const host_mesh *mesh, double middle[3], double half[3]);
/* x := m (x - about) + to. */
void case_apply(host_mesh *mesh, const double m[9], const double about[3], const double to[3]);

/* The number of the edge from each corner to the next, edge[3 * n_triangles]. Returns how many edges there are. */
uint32_t case_number_edges(const host_mesh *mesh, uint32_t *edge);
/* Every triangle in four, at the midpoints of its edges. With random numbers: at other points of the edges, and each
 * vertex moves within one of its triangles, so that the same surface has other vertices. */
host_mesh case_subdivide(const host_mesh *mesh, oracle_random *r);
/* The directions of the largest, middle and smallest spread over the vertices of all bodies' truths, as rows. */
void case_axes(const case_data *data, double axes[9]);

/* ---- case_make.c: deformation, visible part, spoiling, start */

case_options case_defaults(void);
/* Makes target and truth from the models, and moves the models to their start. */
void case_make(case_data *data, const case_options *options);
/* Deforms the models alone, so that the largest displacement is deform_mm, and moves them to their start. */
void case_displace(case_data *data, const case_options *options);
double case_random_normal(oracle_random *r); /* mean 0, deviation 1 */
void case_direction(oracle_random *r, double out[3]);
/* Keeps the triangles whose normals lie within an angle of the direction. */
void case_keep_facing(host_mesh *mesh, const double direction[3], double degrees);

/* ---- case_measure.c: a case as a directory, and how far a result is from its truth */

/* What qsort() puts in the order of values, equal ones in that of places. */
typedef struct case_ranked {
    double value;
    size_t at;
} case_ranked;

int case_by_value(const void *a, const void *b);

/* DIR/model, truth, whole, target: NAME.ply each; DIR/names.txt: names, and a digit for each vertex, 0: not seen. */
void case_write(const case_data *data, const char *directory);
void case_read(case_data *data, const char *directory);
/* Of positions xyz[body], [n_vertices][3]; NULL: of the models, and use[body] masks vertices whose triangles count. */
case_figures case_measure(const case_data *data, const float *const *xyz);
/* Area mean of the distance from one surface to another, mm. area may be NULL; use: NULL, or [n_vertices], 0 for
 * vertices whose triangles do not count. */
double case_surface_mean(const host_mesh *from, const host_mesh *to, const unsigned char *use, double *area);
/* Prints "name value" lines of a result: DIR of NAME.ply. */
void case_tell(const case_data *data, const char *result);

/* ---- case_kinds.c, case_changes.c, case_images.c: the runs that verdicts are judged by */

typedef struct case_picture case_picture;

typedef struct case_bone {
    const char *name, *path; /* below the data's directory */
    char sort;               /* f: femur, h: hip bone, p: patella, u: upper end of a femur */
    uint32_t half;           /* rules are fitted to runs of half 0 and held to those of half 1 */
    int right;               /* is mirrored, so that all models are left ones */
    int slow;                /* has many vertices and comes more seldom */
    const char *beside;      /* the neighbour's file, or NULL */
} case_bone;

/* A run that is to be made. */
typedef struct case_job {
    const char *bone;    /* its name */
    const case_bone *of; /* NULL for an image */
    uint32_t half;       /* of the bones or patients */
    const char *data_path, *directory;
    case_picture *image; /* NULL when the target is a surface */
    case_data data;      /* without targets for an image */
    const char *words;   /* of smr register */
} case_job;

/* Spoils a run. Returns 1 when there still is a truth, 0 when no result is right. */
typedef int case_change(case_job *job, oracle_random *r);

/* A kind of run. {0, 0} stands for a field's default, a negative number for 0; others are a range. */
typedef struct case_kind {
    const char *family, *name;
    int weight; /* how often it comes in its family */
    int part, patches;
    double share[2], shift[2], turn[2], noise[2], outliers[2], deform[2], sigma[2];
    case_change *change;
    const char *words;
    const char *sorts; /* of bones, as in case_bone; NULL: all */
} case_kind;

case_change case_metres, case_inside_out, case_other_bone, case_wrong_side, case_upside_down, case_twisted, case_scaled,
    case_scaled_little, case_stretched, case_tibia, case_half_replaced, case_twin, case_middle_part, case_sphere,
    case_flat, case_soup, case_person, case_person_top, case_person_low, case_person_mirrored, case_neighbour,
    case_points, case_few_points, case_stray_points, case_point_blob, case_same_mesh, case_uneven, case_marks,
    case_marks_swapped, case_marks_off;

/* A bone of that half and of those sorts, whose name is another one. */
const case_bone *case_choose_bone(uint32_t half, const char *sorts, const char *but, oracle_random *r);
extern const case_kind case_image_kinds[]; /* ends with a NULL name */
/* Makes the image run; 1 when there is a truth. A patient's files, computed once, lie in the directory's parent. */
int case_image_make(case_job *job, const case_kind *kind, oracle_random *r);
/* Prints what the run of a seed is and the words of its smr register; its files go to the directory. A name overrides
 * the kind that the seed gives. */
void case_job_make(uint32_t seed, const char *name, const char *data, const char *directory);

/* ---- case_points.c: registrations by the library itself, for what the command line cannot do */

typedef struct case_runner {
    void *scratch, *prepared, *arena; /* owned */
    const smr_model *model;
    smr *s;
} case_runner;

/* Prepares the bodies' models and begins a registration. reference: NULL, or the image that fits them. */
void case_runner_open(case_runner *runner, const case_data *data, const smr_volume *reference,
                      const smr_config *config);
void case_runner_free(case_runner *runner);
void case_check(smr_status status); /* ends the program unless SMR_OK */
/* n points evenly over a mesh' area, with isotropic noise; normal: of the triangles. Both [n][3]. */
void case_sample(const host_mesh *mesh, uint32_t n, double noise_mm, uint32_t seed, float *xyz, float *normal);

/* Moves shares of a mesh' points xyz[n][3]: strays to anywhere in its box and 20 mm around, a blob into a ball of 8 mm
 * radius 25 mm off. */
void case_spoil(const host_mesh *mesh, double strays, double blob, uint32_t seed, float *xyz, uint32_t n);

/* ---- case_marks.c and others: commands of case_tool */

void case_write_marks(const host_landmarks *marks, const char *path); /* as CSV, LPS */
void case_read_marks(const char *path, host_landmarks *marks);
void case_feed(char **word);
void case_cloud(char **word);
void case_follow(char **word);
void case_displaced(char **word);
void case_click(char **word);
void case_spread(char **word);
void case_depths(char **word);
void case_crop(char **word);
void case_rician(char **word);
void case_figure(char **word);

#endif
