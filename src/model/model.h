/* model.h: the bytes of a model (docs/SPEC.md has the same as a table), and views of them.
 * Numbers are little-endian, floats their bits, offsets bytes from the model's start and multiples of SMR_ALIGN.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MODEL_H
#define SMR_MODEL_H

#include "base/bytes.h"
#include "base/vec.h"

#define SMR_MODEL_MAGIC 0x31524d53u /* "SMR1" */
#define SMR_MODEL_VERSION 3u        /* version of the bytes that this library writes and reads */
#define SMR_MODEL_HEAD 16u          /* number of bytes at the start that the checksum does not cover */
#define SMR_MASS_UNITS 16.0f        /* masses are whole multiples of 1/16 */
#define SMR_MASS_MAX 64.0f          /* largest mass */

struct smr_model {
    uint32_t magic, version;
    uint32_t bytes, checksum; /* size of the model; CRC-32 of bytes 16 .. bytes - 1 */
    uint32_t n_vertices, n_triangles, n_structures, n_radii;
    uint32_t index_bytes;       /* 2 or 4: the width of indexes in cluster lists */
    uint32_t order;             /* SMR_ORDER_... */
    uint32_t centre[3];         /* float, mm: origin of rest positions */
    uint32_t edge_mm;           /* float, mm: mean edge length */
    uint32_t at_structures;     /* smr_stored_structure [n_structures] */
    uint32_t at_position;       /* uint32 [n_vertices]: caller's vertex (all structures in a row) -> stored vertex */
    uint32_t at_original;       /* uint32 [n_vertices]: stored vertex -> caller's vertex */
    uint32_t at_owner;          /* uint16 [n_vertices]: structure of each stored vertex */
    uint32_t at_rest;           /* float [n_vertices][3]: rest positions, mm from centre */
    uint32_t at_mass;           /* float [n_vertices]: masses */
    uint32_t at_triangles;      /* uint32 [n_triangles][3]: stored vertices; structures in a row, each in tree order */
    uint32_t at_triangle_index; /* uint32 [n_triangles]: the caller's index of each triangle within its structure */
    uint32_t profile_samples;   /* samples of each profile; 0: no profiles */
    uint32_t profile_inward;    /* samples of a profile on the inner side of the vertex */
    uint32_t profile_step;      /* float, mm: distance between samples */
    uint32_t at_profiles;       /* uint8 [n_vertices][profile_samples], see image/intensity_profile.h */
    uint32_t at_ranges;         /* float [n_vertices][2]: low and range of each profile; range 0: never a goal */
    uint32_t n_dihedrals, at_dihedrals; /* smr_stored_dihedral [n_dihedrals] */
    uint32_t at_radii;                  /* smr_stored_radius [n_radii] */
    uint32_t at_along; /* uint32 [n_vertices]: stored vertex -> position on the curve, ascending in a level */
    uint32_t n_levels, level_end[SMR_LEVELS_MAX]; /* stored vertices in a level and all levels before it; then zeros */
    uint32_t n_sections, at_sections; /* smr_stored_section [n_sections <= SMR_SECTIONS_MAX]; at 0 without any */
    uint32_t zero[6];
};

/* A further section. A library that does not know the kind skips an optional section and refuses a required one. */
typedef struct smr_stored_section {
    uint32_t kind;      /* SMR_SECTION_..., not 0, each kind once; no kind is defined yet */
    uint32_t flags;     /* SMR_SECTION_REQUIRED or 0 */
    uint32_t at, bytes; /* offset, behind the section before; size */
} smr_stored_section;

#define SMR_SECTIONS_MAX 64u    /* most further sections of a model */
#define SMR_SECTION_REQUIRED 1u /* flag of a section: a library that does not know the kind refuses the model */

/* A structure. Vertices and triangles are numbered as the caller does, all structures in a row. */
typedef struct smr_stored_structure {
    char name[SMR_NAME_BYTES];
    uint32_t first_vertex, n_vertices, first_triangle, n_triangles;
} smr_stored_structure;

/* An edge of two triangles. bend: low 24 bits: second triangle; high 8: code of the cosine below which it is folded. */
typedef struct smr_stored_dihedral {
    uint32_t first, bend;
} smr_stored_dihedral;

#define SMR_DIHEDRAL_MASK 0xffffffu /* the bits of smr_stored_dihedral.bend that hold the second triangle */
#define SMR_DIHEDRAL_OPEN (-0.4f)   /* limits above this belong to edges of at most a right angle at rest */
#define SMR_DIHEDRAL_UNIT 200.0f    /* cosine = code / 200 - 1 */

/* Returns the cosine between the normals of the two triangles below which the edge counts as folded. */
static inline float smr_dihedral_limit(uint32_t bend) { return (float)(bend >> 24) / SMR_DIHEDRAL_UNIT - 1.0f; }

typedef struct smr_stored_radius {
    uint32_t radius;   /* float, mm */
    uint32_t reach;    /* float, mm: largest distance from a cluster's own vertex to a vertex of the cluster */
    uint32_t separate; /* 1: a cluster contains vertices of one structure only */
    uint32_t n_blocks;
    uint32_t largest;    /* vertices of the largest cluster; boundary vertices outside the radius count half */
    uint32_t smallest;   /* vertices of the smallest cluster */
    uint32_t mean;       /* float: mean number of vertices of a cluster */
    uint32_t n_indexes;  /* number of indexes in all lists */
    uint32_t at_blocks;  /* smr_stored_block [n_blocks + 1] */
    uint32_t at_entries; /* smr_entry16 or smr_entry32 [n_vertices]: the order L, block after block */
    uint32_t at_count;   /* uint16 or uint32 [n_vertices]: |zeta|, size of each stored vertex' cluster */
    uint32_t at_indexes; /* uint16 or uint32 [n_indexes]: zeta+ then zeta- of each entry, ascending */
    uint32_t active_min; /* fewest active vertices, in stored order, with which each cluster is large enough */
    uint32_t n_boundary, at_boundary; /* smr_stored_boundary [n_boundary] */
} smr_stored_radius;

/* Vertices a radius apart. Weight in each other's cluster: the lists' 1 or 0 plus share / SMR_BOUNDARY_UNITS - 1/2. */
typedef struct smr_stored_boundary {
    uint32_t first, second; /* stored vertices */
    uint32_t share;         /* 0 .. SMR_BOUNDARY_UNITS */
} smr_stored_boundary;

#define SMR_BOUNDARY_UNITS 256 /* smr_stored_boundary.share of weight 1 */

/* A block of the order L, one range of the curve: its first entry in at_entries, and its first index in at_indexes. */
typedef struct smr_stored_block {
    uint32_t first, first_index;
} smr_stored_block;

/* An entry of L: stored vertex; its parent's number in the block, its own for a root; lengths of zeta+ and zeta-. */
typedef struct smr_entry16 {
    uint16_t vertex, parent, n_plus, n_minus;
} smr_entry16;

typedef struct smr_entry32 {
    uint32_t vertex, parent, n_plus, n_minus;
} smr_entry32;

/* The lists of one radius; numbers are those of smr_stored_radius in host byte order, arrays are as stored. */
typedef struct smr_lists {
    const smr_stored_block *block;
    const void *entry, *count, *index;
    const smr_stored_boundary *boundary;
    uint32_t n_boundary, index_bytes, n_blocks, largest, smallest, active_min;
    float radius, reach;
} smr_lists;

static inline const void *smr_at(const smr_model *m, uint32_t stored_offset)
{
    return (const unsigned char *)m + smr_le32(stored_offset);
}

/* 1: m is aligned and begins as a model does. Reads 16 bytes of what is no model; smr_model_open() checks all bytes. */
int smr_model_known(const smr_model *m);
smr_lists smr_model_lists(const smr_model *m, uint32_t radius);

/* Returns number i of a stored list of numbers that are `width` bytes wide, 2 or 4. */
static inline uint32_t smr_index_at(const void *list, uint32_t width, size_t i)
{
    return width == 2u ? smr_le16(((const uint16_t *)list)[i]) : smr_le32(((const uint32_t *)list)[i]);
}

/* Returns |zeta| of a stored vertex. */
static inline uint32_t smr_list_count(const smr_lists *l, uint32_t v)
{
    return smr_index_at(l->count, l->index_bytes, v);
}

/* Returns number i of the list of uint32 at a stored offset. */
static inline uint32_t smr_word_at(const smr_model *m, uint32_t at, uint32_t i)
{
    return smr_index_at(smr_at(m, at), 4, i);
}

/* Return structure, curve position and caller's vertex of stored vertex v, and the stored vertex of the caller's i. */
static inline uint32_t smr_model_owner(const smr_model *m, uint32_t v)
{
    return smr_index_at(smr_at(m, m->at_owner), 2, v);
}
static inline uint32_t smr_model_along(const smr_model *m, uint32_t v) { return smr_word_at(m, m->at_along, v); }
static inline uint32_t smr_model_position(const smr_model *m, uint32_t i) { return smr_word_at(m, m->at_position, i); }
static inline uint32_t smr_model_original(const smr_model *m, uint32_t v) { return smr_word_at(m, m->at_original, v); }

static inline const smr_stored_structure *smr_model_record(const smr_model *m, uint32_t structure)
{
    return (const smr_stored_structure *)smr_at(m, m->at_structures) + structure;
}

static inline const smr_stored_radius *smr_model_radius(const smr_model *m, uint32_t radius)
{
    return (const smr_stored_radius *)smr_at(m, m->at_radii) + radius;
}

/* Returns 1 when clusters of the radius contain vertices of one structure only. */
static inline int smr_model_separate(const smr_model *m, uint32_t i) { return smr_model_radius(m, i)->separate != 0u; }

/* Returns the origin of rest positions, mm. */
static inline smr_vec smr_model_centre(const smr_model *m)
{
    return smr_v(smr_le_float(m->centre[0]), smr_le_float(m->centre[1]), smr_le_float(m->centre[2]));
}

#endif
