/* surface.h: a target surface in the caller's memory, ready for closest-point search; signed distances; point clouds.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_H
#define SMR_SURFACE_H

#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/box_tree/box_tree.h"
#include "geometry/surface/mesh.h"

/* Sums over a mesh's vertices that tell its noise (surface_noise.c). */
typedef struct smr_surface_noise {
    float n, size;         /* number of vertices that count; sum of the sizes of their offsets, mm */
    float square, product; /* sums of squared offsets, and of offset times mean offset of the neighbours, mm^2 */
} smr_surface_noise;

/* Smoothing of a mesh's bulges (surface_relief.c). */
typedef struct smr_surface_smoothing {
    uint32_t pass;    /* number of complete passes over all vertices */
    float mean, size; /* 1/mm: mean bulge, and mean distance of bulges from the mean, by area; sums before */
} smr_surface_smoothing;

/* Progress of building or refitting a surface. */
typedef struct smr_surface_work {
    smr_mesh mesh;      /* the caller's mesh; in a refit only its positions are read */
    uint32_t stage, at; /* index of the current stage; number of items of that stage done so far */
    uint32_t refit;     /* 1: a refit, in which only positions are new; 0: a build */
    uint32_t refused;   /* 1: a stage has found illegal input */
    uint32_t *index;    /* [n][3] triangles of a cloud's copy: triangle k is point k; NULL: a mesh is built */
    const struct smr_surface *cloud; /* cloud of points, normals and weights that is copied */
    uint32_t changes;                /* change counter of the cloud when the build began */
    smr_box box;                     /* box around the vertices checked so far, mm */
    float area;                      /* sum of area[] of the vertices visited so far, mm^2 */
    smr_surface_noise noise;         /* sums from which noise_mm follows */
    smr_surface_smoothing smoothing; /* of bulges, from which relief[] follows */
    smr_order order;                 /* sort of the triangles into tree order */
    /* [n_triangles][3] centres of triangles, times 3, mm; later offsets of vertices from neighbours, mm, bulges, 1/mm,
     * and the bulges' gradients, 1/mm^2; at last relief[] in the first part and slope[] in the third */
    float *middle;
    uint32_t *key, *tmp; /* key [n_triangles], tmp [2 n_triangles]: scratch of sorts and union-find */
    uint32_t *start;     /* [n_vertices + 1] a triangle of each vertex, or SMR_NONE; earlier stages: scratch */
    uint32_t *around;    /* [at least 3 n_triangles] numbers of the triangles at each vertex, vertex after vertex */
    unsigned char *body; /* [n_triangles] SMR_BODY_...: connected component of each triangle; in around[] */
} smr_surface_work;

struct smr_surface {
    uint32_t magic; /* SMR_SURFACE_MAGIC; SMR_SURFACE_BUSY while the surface is built or refitted */
    uint32_t n_vertices;
    uint32_t open;       /* 1: an edge outside stray components has only one triangle, or the surface is a cloud */
    uint32_t n_used;     /* number of vertices with triangles outside stray components */
    uint32_t n_fragment; /* number of triangles in stray components, which registration ignores */
    uint32_t n_fragment_vertices;
    uint32_t n_bodies;     /* number of connected components with more than 1 / SMR_BODY_PART of all triangles */
    uint32_t capacity;     /* largest number of points of a cloud; 0: the surface is a mesh */
    uint32_t changes;      /* number of changes of a cloud's points, or of refits of a mesh */
    float noise_mm;        /* noise of a mesh's vertices along the normals when it was built, mm; 0 for a cloud */
    float area_mean;       /* mean of area[] over n_used vertices, mm^2; 1 for a cloud */
    smr_vec origin;        /* mm, whole numbers: centre of the bounding box, from which xyz[] counts */
    float *xyz;            /* [n_vertices][3] vertex positions, mm from origin, in the caller's order */
    float *normal;         /* [n_vertices][3] unit vertex normals */
    float *area;           /* [n_vertices] a third of the area of the adjacent triangles, mm^2; 0 in stray components */
    uint32_t *triangle;    /* [n_triangles][3] vertex indexes, in tree order */
    uint32_t *original;    /* [n_triangles] the caller's index of each triangle */
    unsigned char *border; /* [n_triangles] bit k: edge from corner k to k + 1 is on a border; bit 3 + k: corner k is */
    const float *slope;    /* [n_vertices][3] gradient of relief along the surface, 1/mm; NULL: none */
    const float *relief;   /* [n_vertices] -1..1: how far the mesh bulges out beside its mean, when built; NULL: none */
    smr_box_tree tree;     /* box tree over the triangles */
    smr_surface_work work;
};

uint32_t smr_surface_guard(const smr_surface *s); /* returns the checksum of a complete surface's pointers and counts */

/* Numbers of connected components. FRAGMENT: small, open, ignored; SMALL: other small ones; FIRST ..: large ones. */
enum { SMR_BODY_FRAGMENT = 0, SMR_BODY_SMALL = 1, SMR_BODY_FIRST = 2 };
#define SMR_BODY_PART 250u /* a component with over 1 / SMR_BODY_PART of all triangles gets its own number, below 256 */

#define SMR_SURFACE_MAGIC 0x736d7253u /* smr_surface.magic of a complete surface */
#define SMR_SURFACE_BUSY 0x736d7262u  /* smr_surface.magic of a surface that is being built or refitted */

/* Returns 1 for a cloud of points, which has no triangles. */
static inline int smr_is_cloud(const smr_surface *s) { return s->capacity > 0u; }

/* Returns 1 for a complete surface. */
static inline int smr_surface_valid(const smr_surface *s) { return s != NULL && s->magic == SMR_SURFACE_MAGIC; }

/* Returns the connected component, SMR_BODY_..., of a triangle. */
static inline uint32_t smr_surface_body_at(const smr_surface *s, uint32_t triangle)
{
    return s->work.body[smr_index(triangle, s->tree.n_triangles)];
}

/* Returns 1 for a vertex of a stray component. */
static inline int smr_surface_fragment(const smr_surface *s, uint32_t v)
{
    return s->n_fragment > 0u && s->work.start[v] != SMR_NONE &&
           smr_surface_body_at(s, s->work.start[v]) == SMR_BODY_FRAGMENT;
}

/* Returns the connected component, SMR_BODY_..., of a vertex: 0 without triangles, SMR_BODY_SMALL in clouds. */
static inline uint32_t smr_surface_body(const smr_surface *s, uint32_t v)
{
    return smr_is_cloud(s)                ? SMR_BODY_SMALL
           : s->work.start[v] != SMR_NONE ? smr_surface_body_at(s, s->work.start[v])
                                          : 0u;
}

/* Finds the closest acceptable triangle outside fragments and, unless use is NULL, components with use[component] 0.
 * known: bounds that the last search found; NULL: none. Returns as smr_tree_closest_but(). */
static inline int smr_surface_search_known(const smr_surface *s, const unsigned char *use, const smr_query *q,
                                           smr_hit *hit, smr_certainty *known)
{
    const smr_tree_mask mask = {s->work.body, use};
    return smr_tree_closest_but(&s->tree, use != NULL || s->n_fragment > 0u ? &mask : NULL, q, hit, known);
}

static inline void smr_surface_search(const smr_surface *s, const unsigned char *use, const smr_query *q, smr_hit *hit)
{
    (void)smr_surface_search_known(s, use, q, hit, NULL);
}

#define SMR_GROUP_POINTS 8u /* largest number of points in a group */

/* Searches as smr_tree_closest_but() does for each of n queries, 1 .. SMR_GROUP_POINTS, with points near each other. A
 * query without a triangle to try first gets that of the query before. */
void smr_closest_group(const smr_box_tree *f, const smr_tree_mask *mask, smr_query *q, uint32_t n, smr_hit *hit);

/* A stage of a build: does the items first .. last-1. These find stray components; a refit also runs the last one. */
typedef void smr_surface_stage(smr_surface *s, uint32_t first, uint32_t last);
smr_surface_stage smr_fragments_forget, smr_fragments_join, smr_fragments_sum, smr_bodies_number, smr_fragments_mark;
smr_surface_stage smr_fragments_release;
smr_surface_stage smr_offsets_find, smr_offsets_compare; /* surface_noise.c: these set noise_mm */
smr_surface_stage smr_bulges_smooth, smr_bulges_slope, smr_bulges_mean, smr_bulges_size; /* surface_relief.c */
smr_surface_stage smr_relief_set;

/* Returns a vertex' bulge, 1/mm. offset: of its ring's mean along the normal, mm; square: mean squared distance */
float smr_bulge(float offset, float square);

#define SMR_RING_MOST 16u /* triangles of the largest ring; a vertex with more, the middle of a fan, has some of them */

/* Returns 1 for the middle of a fan. */
static inline int smr_surface_fan(const smr_surface *s, uint32_t v)
{
    return s->work.start[v + 1u] - s->work.start[v] > SMR_RING_MOST;
}

/* Returns the number of triangles in the ring of a vertex. */
static inline uint32_t smr_surface_ring(const smr_surface *s, uint32_t v)
{
    return smr_min_u32(s->work.start[v + 1u] - s->work.start[v], SMR_RING_MOST);
}

/* Returns the three corners of triangle i of the ring of v. */
static inline const uint32_t *smr_ring_triangle(const smr_surface *s, uint32_t v, uint32_t i)
{
    return s->triangle + 3u * (size_t)s->work.around[s->work.start[v] + i];
}

/* Returns 1 when the triangle's point with these barycentric weights lies on a border, an edge of one triangle only. */
uint32_t smr_surface_on_border(const smr_surface *s, uint32_t triangle, const float weight[3]);

/* The position of a point relative to a surface. Distance and direction are continuous functions of the point. */
typedef struct smr_side {
    float mm;          /* signed distance to the surface, mm, negative inside */
    smr_vec out;       /* gradient of the distance, about unit length; 0 where opposite directions are equally short */
    uint32_t triangle; /* closest triangle, in tree order */
    float weight[3];   /* barycentric weights of the closest point */
} smr_side;

/* Finds the signed distance of q->point to the acceptable triangles within `most` mm. normal: [vertices][3] unit vertex
 * normals; pause: limits the work, NULL: no limit. Returns 0, with *side unchanged, when there is no such triangle or
 * the search stopped, with pause->kept. */
int smr_signed_distance(const smr_box_tree *f, const float *normal, const smr_query *q, float most, smr_pause *pause,
                        smr_side *side);

/* ---- surface_line.c ---- */

#define SMR_CROSSINGS 64u /* largest number of crossings of a line with one surface */

/* A crossing of a line with a surface. */
typedef struct smr_crossing {
    float at; /* the crossing's position on its line, mm */
    int turn; /* 1: into surface a; -1: out of a; 2: into b; -2: out of b */
} smr_crossing;

/* A line along an axis. */
typedef struct smr_ray {
    uint32_t u, v, w; /* the two axes across the line, and the axis along it */
    float pu, pv;     /* coordinates of the line on the axes u and v, mm */
} smr_ray;

typedef struct smr_line {
    smr_ray ray;
    uint32_t n;                            /* number of crossings found */
    smr_crossing list[2u * SMR_CROSSINGS]; /* [n] crossings, ascending */
} smr_line;

/* A part of an axis, mm; lo > hi: nothing. */
typedef struct smr_extent {
    float lo, hi;
} smr_extent;

static inline float smr_axis_of(smr_vec p, uint32_t axis) { return axis == 0u ? p.x : axis == 1u ? p.y : p.z; }
/* Adds crossings of the line with surface s, moved by `shift`, mm, to the line's list, as long as that has room: all up
 * to `most`, mm, and maybe others. weight: 1 for a, 2 for b. */
void smr_line_cross(const smr_surface *s, smr_line *l, smr_vec shift, float most, int weight);
/* Returns an extent around all crossings of surface s, moved by `shift`, mm, with the lines from `low` up to `high`. */
smr_extent smr_lines_extent(const smr_surface *s, const smr_ray *low, const smr_ray *high, smr_vec shift);
/* Returns the length, mm, of the line inside both surfaces. */
float smr_line_inside(const smr_line *l);
/* Returns 1 when the winding number of surface s around p (mm from its origin) is not 0, also near folds. */
int smr_surface_inside(const smr_surface *s, smr_vec p);

/* A cloud of points in the caller's memory. Points attract the model as target vertices do, with weights as areas. */
struct smr_points {
    uint32_t magic;      /* SMR_POINTS_MAGIC marks an open cloud */
    uint32_t next;       /* index that the next added point gets, < surface.capacity */
    uint32_t guard;      /* checksum of the addresses of slots and of the capacity */
    smr_surface surface; /* the first n_vertices slots hold xyz, normal (0: none) and, as area, the weight; origin 0 */
};

#define SMR_POINTS_MAGIC 0x736d7250u /* smr_points.magic of an open cloud */
#define SMR_WEIGHT_MAX 4.0f /* largest weight of a point, so that the sums of target-to-model forces fit 32 bits */

/* Returns 1 for points opened by smr_points_open(). */
static inline int smr_points_valid(const smr_points *p) { return p->magic == SMR_POINTS_MAGIC; }

#endif
