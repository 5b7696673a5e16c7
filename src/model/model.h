/* model.h: the bytes of a model (docs/SPEC.md has them as a table), and functions that read them. Numbers are
 * little-endian, floats stored as bits; an offset is in bytes from the model's start, a multiple of SMR_ALIGN.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MODEL_H
#define SMR_MODEL_H

#include "base/bytes.h"
#include "base/vec.h"

#define SMR_MODEL_MAGIC 0x31524d53u /* first word of a model: the letters "SMR1" */
#define SMR_MODEL_VERSION 3u        /* version of the bytes that this library writes and reads */
#define SMR_MODEL_HEAD 16u          /* number of bytes at the start that the checksum does not cover */
#define SMR_MASS_UNITS 16.0f        /* units in a mass of 1: masses are whole multiples of 1/16 */
#define SMR_MASS_MAX 64.0f          /* largest mass of a vertex; the mean is about 1 */

struct smr_model {
    uint32_t magic, version;
    uint32_t bytes, checksum; /* size of the model; CRC-32 of bytes 16 .. bytes - 1 */
    uint32_t n_vertices, n_triangles, n_structures, n_radii;
    uint32_t index_bytes;       /* 2 or 4: the width of indexes in cluster lists */
    uint32_t order;             /* SMR_ORDER_...: how the order L of the clusters was chosen */
    uint32_t centre[3];         /* float, mm: origin of rest positions */
    uint32_t edge_mm;           /* float, mm: mean length of mesh edges */
    uint32_t at_structures;     /* smr_stored_structure [n_structures]: names and sizes */
    uint32_t at_position;       /* uint32 [n_vertices]: stored vertex of each caller's vertex, structures in a row */
    uint32_t at_original;       /* uint32 [n_vertices]: caller's vertex of each stored vertex */
    uint32_t at_owner;          /* uint16 [n_vertices]: structure of each stored vertex */
    uint32_t at_rest;           /* float [n_vertices][3]: rest positions, mm from centre */
    uint32_t at_mass;           /* float [n_vertices]: mass of each stored vertex */
    uint32_t at_triangles;      /* uint32 [n_triangles][3]: stored vertices; structures in a row, each in tree order */
    uint32_t at_triangle_index; /* uint32 [n_triangles]: the caller's index of each triangle within its structure */
    uint32_t profile_samples;   /* samples of each profile; 0: no profiles */
    uint32_t profile_inward;    /* samples of a profile on the inner side of the vertex */
    uint32_t profile_step;      /* float, mm: distance between samples */
    uint32_t at_profiles;       /* uint8 [n_vertices][profile_samples]: profiles, see image/intensity_profile.h */
    uint32_t at_ranges;         /* float [n_vertices][2]: lowest value and range of a profile; range 0: no goals */
    uint32_t n_dihedrals, at_dihedrals; /* smr_stored_dihedral [n_dihedrals]: edges of two triangles */
    uint32_t at_radii;                  /* smr_stored_radius [n_radii]: where the cluster lists of a radius lie */
    uint32_t at_along; /* uint32 [n_vertices]: position of each stored vertex on the curve, ascending in a level */
    uint32_t n_levels, level_end[SMR_LEVELS_MAX]; /* stored vertices up to each level's end; zeros behind the last */
    uint32_t n_sections, at_sections; /* smr_stored_section [n_sections <= SMR_SECTIONS_MAX]; offset 0: no sections */
    uint32_t coarse_radii;    /* clusters of the first radii hold only the first coarse_vertices stored vertices */
    uint32_t coarse_vertices; /* 0 where clusters of all radii hold all vertices */
    uint32_t zero[4];
};

/* Entry of an added section. A library that does not know the kind skips an optional and refuses a required one. */
typedef struct smr_stored_section {
    uint32_t kind;      /* SMR_SECTION_..., not 0, each kind once */
    uint32_t flags;     /* SMR_SECTION_REQUIRED, or 0 for an optional section */
    uint32_t at, bytes; /* offset, behind the previous section; size in bytes */
} smr_stored_section;

/* Kind: shapes of several subjects, the model's own first: float [2 .. SMR_REFERENCES_MAX][n_vertices][3], mm: each
 * shape, after its similarity onto the model's own, minus the mean of all shapes. */
#define SMR_SECTION_REFERENCES 1u
/* Kind: how far the model's surface bulges out at each stored vertex beside its structure's mean (surface_relief.c),
 * int16 [n_vertices], in units of 1 / SMR_RELIEF_ONE, or SMR_RELIEF_NONE. */
#define SMR_SECTION_RELIEF 2u
#define SMR_RELIEF_ONE 32767.0f
#define SMR_RELIEF_NONE (-32768)
#define SMR_SECTIONS_MAX 64u    /* largest number of additional sections of a model */
#define SMR_SECTION_REQUIRED 1u /* flag of a section: a library that does not know the kind refuses the model */

/* A structure and its ranges of vertices and triangles, in the caller's indexes counted through all structures. */
typedef struct smr_stored_structure {
    char name[SMR_NAME_BYTES];
    uint32_t first_vertex, n_vertices, first_triangle, n_triangles;
} smr_stored_structure;

/* An edge of two triangles. first: one triangle; bend: the other (low 24 bits), code of the fold limit (high 8). */
typedef struct smr_stored_dihedral {
    uint32_t first, bend;
} smr_stored_dihedral;

#define SMR_DIHEDRAL_MASK 0xffffffu /* the bits of smr_stored_dihedral.bend that hold the second triangle */
#define SMR_DIHEDRAL_OPEN (-0.4f)   /* cosine: edges with limits above this were bent by at most 90 degrees at rest */
#define SMR_DIHEDRAL_UNIT 200.0f    /* codes per unit of cosine: cosine = code / 200 - 1 */

typedef struct smr_stored_radius {
    uint32_t radius;   /* float, mm: radius of the clusters */
    uint32_t reach;    /* float, mm: largest distance from a cluster's own vertex to a vertex of the cluster */
    uint32_t separate; /* 1: a cluster contains vertices of one structure only */
    uint32_t n_blocks;
    uint32_t largest;    /* vertices of the largest cluster; boundary vertices outside the radius count half */
    uint32_t smallest;   /* vertices of the smallest cluster */
    uint32_t mean;       /* float: mean number of vertices of a cluster */
    uint32_t n_indexes;  /* number of indexes in all zeta+ and zeta- */
    uint32_t at_blocks;  /* smr_stored_block [n_blocks + 1]: each block's start; the end of the last block */
    uint32_t at_entries; /* smr_entry16 or smr_entry32 [n_vertices]: the order L, block after block */
    uint32_t at_count;   /* uint16 or uint32 [n_vertices]: |zeta|, size of each stored vertex' cluster */
    uint32_t at_indexes; /* uint16 or uint32 [n_indexes]: zeta+ then zeta- of each entry, ascending */
    uint32_t active_min; /* fewest active vertices, in stored order, with which each cluster is large enough */
    uint32_t n_boundary, at_boundary; /* smr_stored_boundary [n_boundary]: pairs about a radius apart */
} smr_stored_radius;

/* Two vertices about a radius apart. Weight in each other's cluster: the lists' 1 or 0, plus share / 256 - 1/2. */
typedef struct smr_stored_boundary {
    uint32_t first, second; /* indexes of the two stored vertices */
    uint32_t share;         /* correction of the weight, plus 1/2, in units of 1/256: 0 .. SMR_BOUNDARY_UNITS */
} smr_stored_boundary;

#define SMR_BOUNDARY_UNITS 256 /* units of smr_stored_boundary.share in a weight of 1 */

/* A block of the order L, one range of the curve. first: its first entry in at_entries; first_index: in at_indexes. */
typedef struct smr_stored_block {
    uint32_t first, first_index;
} smr_stored_block;

/* An entry of L. parent: the parent's entry in the block, a root's own; n_plus, n_minus: lengths of zeta+ and zeta-. */
typedef struct smr_entry16 {
    uint16_t vertex, parent, n_plus, n_minus;
} smr_entry16;

typedef struct smr_entry32 {
    uint32_t vertex, parent, n_plus, n_minus;
} smr_entry32;

/* The cluster lists of one radius: numbers of smr_stored_radius in host byte order, pointers to the stored arrays. */
typedef struct smr_lists {
    const smr_stored_block *block;
    const void *entry, *count, *index;
    const smr_stored_boundary *boundary;
    uint32_t n, n_indexes, n_boundary, index_bytes, n_blocks, largest, smallest, active_min; /* n: vertices */
    uint32_t members; /* clusters hold only the first `members` stored vertices */
    float radius, reach;
} smr_lists;

static inline const void *smr_at(const smr_model *m, uint32_t stored_offset)
{
    return (const unsigned char *)m + smr_le32(stored_offset);
}

/* Returns 1 when m is aligned and its magic, version and counts are legal; smr_model_open() checks the rest. */
int smr_model_known(const smr_model *m);
smr_lists smr_model_lists(const smr_model *m, uint32_t radius);

/* Returns element i of a stored list of numbers that are `width` bytes wide, 2 or 4. */
static inline uint32_t smr_index_at(const void *list, uint32_t width, size_t i)
{
    return width == 2u ? smr_le16(((const uint16_t *)list)[i]) : smr_le32(((const uint32_t *)list)[i]);
}

/* Returns |zeta|, the number of vertices in the cluster of stored vertex v. */
static inline uint32_t smr_list_count(const smr_lists *l, uint32_t v)
{
    return smr_index_at(l->count, l->index_bytes, v);
}

/* Returns element i of the list of uint32 whose stored offset is `at`. */
static inline uint32_t smr_word_at(const smr_model *m, uint32_t at, uint32_t i)
{
    return smr_index_at(smr_at(m, at), 4, i);
}

/* Return the structure, the curve index (along) and the caller's index (original) of stored vertex v; position: the
 * stored index of the caller's vertex i. All but `along` are legal also after a fault in the model. */
uint32_t smr_model_owner(const smr_model *m, uint32_t v);
uint32_t smr_model_position(const smr_model *m, uint32_t i);
uint32_t smr_model_original(const smr_model *m, uint32_t v);
static inline uint32_t smr_model_along(const smr_model *m, uint32_t v) { return smr_word_at(m, m->at_along, v); }
static inline const smr_stored_structure *smr_model_record(const smr_model *m, uint32_t structure)
{
    return (const smr_stored_structure *)smr_at(m, m->at_structures) + structure;
}

static inline const smr_stored_radius *smr_model_radius(const smr_model *m, uint32_t radius)
{
    return (const smr_stored_radius *)smr_at(m, m->at_radii) + radius;
}

/* Returns 1 when each cluster of radius number i contains vertices of one structure only. */
static inline int smr_model_separate(const smr_model *m, uint32_t i) { return smr_model_radius(m, i)->separate != 0u; }

/* Returns the additional section of a kind, or NULL. */
const smr_stored_section *smr_model_section(const smr_model *m, uint32_t kind);

/* Returns the section of several subjects' shapes, or NULL. */
static inline const smr_stored_section *smr_model_references(const smr_model *m)
{
    return smr_model_section(m, SMR_SECTION_REFERENCES);
}

/* Returns the number of shapes in a section of references; 0 without one. */
static inline uint32_t smr_reference_count(const smr_model *m, const smr_stored_section *s)
{
    return s == NULL ? 0u : smr_le32(s->bytes) / (12u * smr_le32(m->n_vertices));
}

/* Returns the origin of rest positions, mm. */
static inline smr_vec smr_model_centre(const smr_model *m)
{
    return smr_v(smr_le_float(m->centre[0]), smr_le_float(m->centre[1]), smr_le_float(m->centre[2]));
}

#endif
