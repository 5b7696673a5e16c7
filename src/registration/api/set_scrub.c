/* set_scrub.c: checks of borrowed inputs by checksum, a slice in each tick, and of the whole arena between calls.
 * Bounds: SMR_SLICE_VERTEX bytes a vertex in a tick, one pass over an input when it is set; with SMR_SCRUB_STATE one
 * pass over the arena when a call begins, and one when it ends.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"
#include "registration/measure_job.h"

#define SMR_SLICE 4096u      /* bytes between two readings of the clock */
#define SMR_SLICE_VERTEX 64u /* bytes for each vertex of the model that a tick checks */
#define SMR_SLICE_SHARE 32u  /* budget of a tick / time of its slice */

/* Memory that must not change while it is in use. */
typedef struct input {
    const unsigned char *at; /* NULL: no such input */
    size_t bytes;
    uint32_t *sum; /* the memory's checksum when the input was set */
} input;

enum { INPUT_MODEL = 0, INPUT_VOXELS, INPUT_MASK, INPUT_TARGETS };

static uint32_t n_inputs(const smr *s)
{
    const uint32_t n_fixed = s->forces.contact.fixed != NULL ? s->shared.config.contact.n_fixed : 0u;
    return INPUT_TARGETS + s->forces.surface.n_goals + n_fixed;
}

static input image_of(smr *s, int mask)
{
    const smr_volume *v = &s->forces.image.grid.volume;
    const size_t n = (size_t)v->size[0] * v->size[1] * v->size[2];
    const size_t bytes = v->type <= SMR_VOXEL_INT8 ? 1u : v->type <= SMR_VOXEL_INT16 ? 2u : 4u;
    if (!smr_image_on(&s->forces.image))
        return (input){NULL, 0, NULL};
    return mask ? (input){v->mask, n, &s->scrub.mask} : (input){v->voxels, n * bytes, &s->scrub.voxels};
}

/* Returns the memory of a surface, or of the points to which a cloud belongs. */
static input surface_of(const smr_surface *surface, uint32_t *sum)
{
    input i = {(const unsigned char *)surface, 0, sum};
    if (surface == NULL)
        return i;
    if (smr_is_points(surface)) {
        i.at -= offsetof(smr_points, surface);
        (void)smr_points_bytes(surface->capacity, &i.bytes);
    } else {
        (void)smr_surface_bytes(surface->n_vertices, surface->tree.n_triangles, &i.bytes);
    }
    return i;
}

static input input_of(smr *s, uint32_t number)
{
    smr_surface_goals *g = &s->forces.surface;
    if (number == INPUT_MODEL)
        return (input){(const unsigned char *)s->shared.model, smr_le32(s->shared.model->bytes), &s->scrub.model};
    if (number < INPUT_TARGETS)
        return image_of(s, number == INPUT_MASK);
    number -= INPUT_TARGETS;
    if (number < g->n_goals)
        return surface_of(g->goal[number].surface, &g->target[g->goal[number].structure].body);
    smr_fixed_surface *fixed = &s->forces.contact.fixed[number - g->n_goals];
    return surface_of(fixed->surface, &fixed->body);
}

/* Adds the next slice of an input to *sum. Returns the number of bytes done. */
static size_t add_slice(const input *i, size_t at, uint32_t *sum)
{
    const size_t left = i->at == NULL ? 0u : i->bytes - at, n = left < SMR_SLICE ? left : SMR_SLICE;
    if (n > 0u)
        *sum = smr_byte_sum(*sum, i->at + at, n);
    return at + n;
}

static void learn_one(const input *i)
{
    uint32_t sum = 0;
    for (size_t at = 0; i->at != NULL && at < i->bytes;)
        at = add_slice(i, at, &sum);
    if (i->sum != NULL)
        *i->sum = sum;
}

/* Stores the checksum of a structure's target, which other structures may share. */
static void learn_target(smr_surface_goals *g, uint32_t structure, uint32_t first, uint32_t last)
{
    smr_target *const t = &g->target[structure];
    for (uint32_t k = 0; k < g->shared->n_structures; k++) {
        const smr_target *other = &g->target[k];
        if (other->surface == t->surface && other->changes == t->changes && (k < first || k >= last || k < structure)) {
            t->body = other->body;
            return;
        }
    }
    const input i = surface_of(t->surface, &t->body);
    learn_one(&i);
}

static void learn(smr *s, uint32_t kind, uint32_t number)
{
    smr_surface_goals *g = &s->forces.surface;
    const int targets = kind == SMR_LOG_SURFACE || kind == SMR_LOG_POINTS;
    const uint32_t first = number == SMR_ALL ? 0u : number,
                   last = number == SMR_ALL ? s->shared.n_structures : first + 1u;
    for (uint32_t i = first; targets && i < last; i++)
        learn_target(g, i, first, last);
    for (uint32_t mask = 0; kind == SMR_LOG_VOLUME && mask < 2u; mask++) {
        const input i = image_of(s, mask != 0u);
        learn_one(&i);
    }
    if (kind == SMR_LOG_FIXED_SURFACE) {
        const input i = surface_of(s->forces.contact.fixed[number].surface, &s->forces.contact.fixed[number].body);
        learn_one(&i);
    }
    s->scrub.input = 0;
    s->scrub.at = 0;
    s->scrub.sum = 0;
    smr_scrub_again(s);
}

/* Returns 1 when the model's numbers of vertices, which positions are read by, fit each other. */
static int numbers_fit(const smr_model *m)
{
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < smr_le32(m->n_vertices); i++)
        wrong |= smr_model_original(m, smr_model_position(m, i)) ^ i;
    return wrong == 0u;
}

/* Checks a slice. Returns 0 when the input has changed. */
static int check_slice(smr *s)
{
    smr_scrubbing *c = &s->scrub;
    const input i = input_of(s, c->input);
    if (c->left == 0u || c->left == SMR_SCRUB_ALL) /* an input that is half checked does not count */
        c->left = n_inputs(s) + (c->at > 0u);
    c->at = add_slice(&i, c->at, &c->sum);
    if (i.at != NULL && c->at < i.bytes)
        return 1;
    const int same = i.at == NULL || c->sum == *i.sum;
    if (!same)
        c->damaged = c->input != INPUT_MODEL || numbers_fit(s->shared.model) ? 1u : 2u;
    c->sum = 0;
    c->at = 0;
    c->left--;
    c->checked |= c->left == 0u;
    c->input = c->input + 1u < n_inputs(s) ? c->input + 1u : 0u;
    return same;
}

static uint64_t now(const smr *s) { return s->port.now_ns == NULL ? 0u : s->port.now_ns(s->port.ctx); }

/* Checks `most` bytes, or as much as the time allows, but at least one slice. Errors: E_DAMAGED. */
static smr_status check(smr *s, uint64_t most, uint64_t ns)
{
    const uint64_t begin = now(s);
    uint64_t done = 0;
    int sound;
    do {
        sound = check_slice(s);
        done += SMR_SLICE;
    } while (sound && s->scrub.left > 0u && done < most && (ns == 0u || now(s) - begin < ns));
    if (!sound)
        smr_guard_close(s); /* otherwise the call that checks does so when it ends */
    return sound ? SMR_OK : SMR_E_DAMAGED;
}

static smr_status slice(smr *s, uint64_t budget_ns)
{
    if (!(s->scrub.what & SMR_SCRUB_INPUTS))
        return SMR_OK;
    return check(s, (uint64_t)SMR_SLICE_VERTEX * s->shared.n, budget_ns / SMR_SLICE_SHARE);
}

/* Returns the checksum of the arena behind the struct, without memory of sums that no iteration is using. */
static uint32_t seal(const smr *s)
{
    const int free = s->step == 0u && s->next_task == 0u && s->n_awaited == 0u;
    const unsigned char *from =
        free ? (const unsigned char *)s->overlay.tally : (const unsigned char *)s->overlay.record;
    const unsigned char *end = (const unsigned char *)s + s->arena_bytes;
    return s->scrub.what & SMR_SCRUB_STATE ? smr_byte_sum(0, from, (size_t)(end - from)) : 0u;
}

static const smr_scrub_calls scrub_calls = {slice, learn, seal};

/* ---- smr_set_scrub() as a job ---- */

typedef struct starting {
    smr_measuring job;
    uint32_t what, damaged; /* argument; as in smr_scrubbing */
    uint32_t input, k;      /* input that is summed now; structure whose target has a sum already */
    uint32_t sum;           /* checksum of the bytes so far */
    size_t at;              /* bytes done */
} starting;

static smr *s_of(void *job) { return ((starting *)job)->job.s; }
static uint32_t on(const void *job) { return ((const starting *)job)->what & SMR_SCRUB_INPUTS; }

/* Compares the model with the checksum that smr_model_open() compared, a piece at a time. */
static void check_model(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    starting *j = job;
    const smr_model *m = j->job.s->shared.model;
    const size_t left = smr_le32(m->bytes) - SMR_MODEL_HEAD - j->at, n = left < SMR_SLICE ? left : SMR_SLICE;
    j->sum = smr_crc32(j->sum, (const unsigned char *)m + SMR_MODEL_HEAD + j->at, n);
    j->at += n;
    if (n < left) {
        smr_job_again(&j->job.head);
        return;
    }
    if (j->sum != smr_le32(m->checksum))
        j->damaged = numbers_fit(m) ? 1u : 2u;
    j->at = j->sum = 0;
}

static void sum_inputs(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    starting *j = job;
    const input i = input_of(j->job.s, j->input);
    j->at = add_slice(&i, j->at, &j->sum);
    if (i.at == NULL || j->at >= i.bytes) {
        if (i.sum != NULL)
            *i.sum = j->sum;
        j->at = j->sum = 0;
        j->input++;
    }
    if (j->input < n_inputs(j->job.s))
        smr_job_again(&j->job.head);
}

/* Copies a target's checksum to structure k, which shares the target with a structure that has it. */
static void share_sum(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    starting *j = job;
    smr_surface_goals *g = &j->job.s->forces.surface;
    for (uint32_t i = 0; i < g->n_goals; i++)
        if (g->goal[i].surface == g->target[j->k].surface)
            g->target[j->k].body = g->target[g->goal[i].structure].body;
    if (++j->k < g->shared->n_structures)
        smr_job_again(&j->job.head);
}

static void turn_on(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    const starting *j = job;
    smr_scrubbing *c = &s_of(job)->scrub;
    c->calls = j->what != 0u ? &scrub_calls : NULL;
    c->what = j->what;
    c->damaged = j->damaged;
    if (on(job))
        smr_scrub_again(s_of(job));
    if (j->damaged)
        ((starting *)job)->job.head.status = SMR_E_DAMAGED;
}

static const smr_stage stages[] = {
    /* the first three come back for each piece */
    {on, check_model, NULL, NULL},
    {on, sum_inputs, NULL, NULL},
    {on, share_sum, NULL, NULL},
    {NULL, turn_on, NULL, NULL},
};

static int unchanged(void *job, int enter)
{
    starting *j = job;
    if (!smr_hold_guard(&j->job, enter, smr_ready(j->job.s)))
        return 0;
    if (!enter)
        smr_guard_close(j->job.s);
    return 1;
}

smr_status smr_set_scrub_begin(smr *s, uint32_t what, smr_job *job)
{
    starting *const j = (starting *)(void *)job;
    SMR_TRY(job == NULL ? SMR_E_NULL : smr_settable(s, 1, smr_ready(s)));
    SMR_TRY(smr_inputs_valid(&s->forces));
    if (what > SMR_SCRUB_INPUTS + SMR_SCRUB_STATE)
        return SMR_E_INPUT;
    memset(&s->scrub, 0, sizeof s->scrub);
    memset(j, 0, sizeof *j);
    j->job = smr_measure_begin(s, stages, sizeof stages / sizeof stages[0]);
    j->job.head.guard = unchanged;
    j->what = what;
    return SMR_OK;
}

smr_status smr_set_scrub(smr *s, uint32_t what)
{
    smr_job job;
    return smr_job_whole(smr_set_scrub_begin(s, what, &job), &job, &smr_alone);
}

smr_status smr_scrub(smr *s, uint64_t budget_ns)
{
    SMR_TRY(smr_settable(s, 1, smr_ready(s) && (s->scrub.what & SMR_SCRUB_INPUTS)));
    SMR_TRY(smr_inputs_valid(&s->forces));
    s->scrub.left = budget_ns == 0u ? SMR_SCRUB_ALL : s->scrub.left;
    SMR_TRY(check(s, UINT64_MAX, budget_ns));
    smr_guard_close(s);
    return s->scrub.left == 0u ? SMR_OK : SMR_PARTIAL;
}
