/* restore_awaited_inputs.c: inputs that a restored registration waits for. Surfaces and the image belong to the caller,
 * so a save holds only checksums and which structures share a surface. Until all inputs are set again, ticks are
 * refused. An awaited input is not a new input: schedule, searches and log continue.
 * Bounds: structures squared; one pass over an input.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"

/* An awaited input. The list: each structure's surface, the image, each structure's goals by the caller, the caller's
 * force (checksum 1), the fixed surfaces. */
typedef struct awaited {
    uint32_t like;        /* the first structure with the surface of this structure; SMR_NONE: no surface */
    uint32_t checksum[2]; /* low and high word of the checksum; 0: nothing is awaited */
} awaited;

#define SMR_AWAITED_WORDS (sizeof(awaited) / sizeof(uint32_t))

static awaited *list_of(const smr *s) { return (awaited *)s->overlay.record; }

int smr_can_wait(const smr_shared *c)
{
    return (2u * (uint64_t)c->n_structures + 2u + c->config.contact.n_fixed) * SMR_AWAITED_WORDS <=
           (uint64_t)c->n * SMR_WORDS;
}

int smr_awaits_log(const smr_log *log) { return log->used > 0u && !log->full && log->memory == NULL; }

static void split(uint64_t sum, uint32_t half[2])
{
    half[0] = (uint32_t)(sum & 0xffffffffu);
    half[1] = (uint32_t)(sum >> 32);
}

static int is(const awaited *w, uint64_t sum) { return ((uint64_t)w->checksum[1] << 32 | w->checksum[0]) == sum; }

/* Begins the checksum of the present input of entry `at`. Returns 0 without one, and for a surface that an earlier
 * structure has, which *like names. */
static int begin_sum(const smr *s, uint32_t at, uint32_t *like, smr_input_sum *sum)
{
    const uint32_t n = s->shared.n_structures;
    const smr_target *target = s->forces.surface.target;
    const smr_goals *goals = s->forces.caller.goals;
    const smr_fixed_surface *fixed = s->forces.contact.fixed;
    *like = SMR_NONE;
    if (at < n && target[at].surface != NULL)
        for (*like = 0; target[*like].surface != target[at].surface;)
            ++*like;
    if (at < n    ? *like != at
        : at == n ? !s->forces.image.has_image
                  : at <= 2u * n && (goals == NULL || goals[at - n - 1u].xyz == NULL))
        return 0;
    if (at > 2u * n && (at == 2u * n + 1u || fixed[at - 2u * n - 2u].surface == NULL))
        return 0;
    *sum = at < n         ? smr_sum_of_target(target[at].surface)
           : at == n      ? smr_sum_of_volume(&s->forces.image.grid.volume)
           : at <= 2u * n ? smr_sum_of_goals(&goals[at - n - 1u], s->shape.structure[at - n - 1u].n_vertices)
                          : smr_sum_of_target(fixed[at - 2u * n - 2u].surface);
    return 1;
}

int smr_sum_inputs(const smr *s, smr_summing *j, uint32_t most)
{
    const uint32_t force = 2u * s->shared.n_structures + 1u;
    awaited *w = &list_of(s)[j->at];
    if (!j->begun) {
        *w = (awaited){SMR_NONE, {(uint32_t)(j->at == force && s->forces.caller.force != NULL), 0}};
        j->begun = (uint32_t)begin_sum(s, j->at, &w->like, &j->sum);
    }
    if (j->begun && !smr_sum_add(&j->sum, most))
        return 0;
    if (j->begun)
        split(j->sum.sum, w->checksum);
    j->begun = 0;
    return ++j->at > force + s->shared.config.contact.n_fixed;
}

/* Returns 1 when the saved entry of structure i agrees with the entries before. first: offset of the list. */
static int consistent(const smr_keeper *k, size_t first, const awaited *w, uint32_t i)
{
    const int known = (w->checksum[0] | w->checksum[1]) != 0u;
    uint32_t like;
    if (w->like == SMR_NONE || w->like >= i)
        return (w->like == i) == known && (w->like == i || w->like == SMR_NONE);
    memcpy(&like, k->from + first + (size_t)w->like * sizeof *w, sizeof like);
    return !known && smr_le32(like) == w->like;
}

/* Saves the checksum of entry `at` of the list; 0: the input is not set. */
static void keep_sum(smr_arena *a, smr *s, uint32_t at)
{
    awaited w = a->keeper->mode == SMR_KEEP_SAVE ? list_of(s)[at] : (awaited){SMR_NONE, {0, 0}};
    smr_keep_words(a, w.checksum, 2, UINT32_MAX);
    if (a->keeper->mode == SMR_KEEP_RESTORE)
        list_of(s)[at] = w;
    s->n_awaited += (w.checksum[0] | w.checksum[1]) != 0u;
}

/* Saves checksums of the caller's goals and force, where the configuration has room for them. */
static void keep_caller(smr_arena *a, smr *s)
{
    const uint32_t n = s->shared.n_structures;
    for (uint32_t i = 0; s->shared.config.caller.goals != 0u && i < n; i++)
        keep_sum(a, s, n + 1u + i);
    if (s->shared.config.caller.force != SMR_CALLER_OFF)
        keep_sum(a, s, 2u * n + 1u);
}

void smr_keep_inputs(smr_arena *a, smr *s)
{
    const smr_keeper *k = a->keeper;
    const size_t first = k->at;
    s->n_awaited = (uint32_t)smr_awaits_log(&s->log);
    for (uint32_t i = 0; i < s->shared.n_structures && !k->wrong; i++) {
        awaited w = k->mode == SMR_KEEP_SAVE ? list_of(s)[i] : (awaited){SMR_NONE, {0, 0}};
        smr_keep_words(a, &w.like, SMR_AWAITED_WORDS, UINT32_MAX);
        smr_keep_require(a, k->mode != SMR_KEEP_CHECK || k->wrong || consistent(k, first, &w, i));
        if (k->mode == SMR_KEEP_RESTORE)
            list_of(s)[i] = w;
        s->n_awaited += w.like != SMR_NONE;
    }
    const int has_image = s->forces.image.has_image != 0u;
    const uint32_t n = s->n_awaited;
    keep_sum(a, s, s->shared.n_structures);
    smr_keep_require(a, (s->n_awaited > n) == has_image);
    keep_caller(a, s);
    for (uint32_t i = 0; i < s->shared.config.contact.n_fixed; i++)
        keep_sum(a, s, 2u * s->shared.n_structures + 2u + i);
}

/* Returns 1 when structure i awaits this surface. Structures that shared a surface must share it again. */
static int waits_for(const smr *s, uint32_t i, const smr_surface *surface, uint64_t sum)
{
    const awaited *w = list_of(s);
    const smr_target *target = s->forces.surface.target;
    if (w[i].like == SMR_NONE || target[i].surface != NULL || !is(&w[w[i].like], sum))
        return 0;
    for (uint32_t k = 0; k < s->shared.n_structures; k++)
        if (target[k].surface != NULL && (w[k].like == w[i].like) != (target[k].surface == surface))
            return 0;
    return 1;
}

static smr_status await_surface(smr *s, uint32_t structure, const smr_surface *surface)
{
    smr_target *target = s->forces.surface.target;
    const uint32_t n = s->shared.n_structures, n_slots = smr_target_slots(&s->shared);
    uint32_t first = structure == SMR_ALL ? 0u : structure, n_goals, n_tasks;
    if (structure != SMR_ALL && structure >= n)
        return SMR_E_INPUT;
    const uint64_t sum = smr_target_checksum(surface);
    while (structure == SMR_ALL && first + 1u < n && !waits_for(s, first, surface, sum))
        first++;
    if (!waits_for(s, first, surface, sum))
        return SMR_E_INPUT;
    target[first].surface = surface;
    if (n_slots > 0u && smr_list_goals(&s->forces.surface, NULL, &n_goals, &n_tasks) > n_slots) {
        target[first].surface = NULL;
        return SMR_E_ARENA;
    }
    if (smr_is_points(surface))
        s->forces.surface.clouds = &smr_clouds;
    smr_note_target(&s->forces.surface, first, first + 1u);
    s->n_awaited--;
    for (uint32_t i = first + 1u; structure == SMR_ALL && i < n; i++) {
        if (!waits_for(s, i, surface, sum))
            continue;
        target[i].surface = surface;
        smr_note_like(&s->forces.surface, i, first);
        s->n_awaited--;
    }
    return SMR_OK;
}

smr_status smr_await_log(smr *s, void *memory, size_t bytes)
{
    unsigned char *log = memory;
    if (memory == NULL) {
        smr_log_end(&s->log);
    } else {
        if (bytes < s->log.used || bytes - s->log.used < SMR_LOG_FULL_BYTES)
            return SMR_E_ARENA;
        if (smr_log_get32(log + s->log.used - 4u) != s->log.crc)
            return SMR_E_LOG;
        s->log.memory = log;
        s->log.write = smr_log_write;
        s->log.bytes = bytes;
    }
    s->n_awaited--;
    if (s->n_awaited == 0u)
        smr_take_goals(&s->forces.surface);
    smr_guard_close(s);
    return SMR_OK;
}

/* Clears entry `at` of the list when its checksum is `sum`; E_INPUT for another checksum. */
static smr_status take(smr *s, uint32_t at, uint64_t sum)
{
    awaited *w = &list_of(s)[at];
    if ((w->checksum[0] | w->checksum[1]) == 0u || !is(w, sum))
        return SMR_E_INPUT;
    w->checksum[0] = w->checksum[1] = 0;
    s->n_awaited--;
    return SMR_OK;
}

static smr_status await_goals(smr *s, uint32_t structure, const smr_goals *goals)
{
    if (goals->xyz == NULL)
        return SMR_E_STATE;
    SMR_TRY(take(s, s->shared.n_structures + 1u + structure,
                 smr_goals_checksum(goals, s->shape.structure[structure].n_vertices)));
    s->forces.caller.calls = &smr_caller_all;
    s->forces.caller.goals[structure] = *goals;
    return SMR_OK;
}

static smr_status await_force(smr *s, const smr_caller_force *own)
{
    if (own->force == NULL)
        return SMR_E_STATE;
    SMR_TRY(take(s, 2u * s->shared.n_structures + 1u, 1u));
    s->forces.caller.calls = &smr_caller_all;
    s->forces.caller.force = own->force;
    s->forces.caller.ctx = own->ctx;
    return SMR_OK;
}

static smr_status await_fixed(smr *s, uint32_t index, const smr_surface *surface)
{
    SMR_TRY(take(s, 2u * s->shared.n_structures + 2u + index, smr_surface_checksum(surface)));
    s->forces.contact.fixed[index] =
        (smr_fixed_surface){surface, surface->n_vertices, surface->changes, smr_surface_guard(surface), 0};
    return SMR_OK;
}

static smr_status await_volume(smr *s, const smr_volume *volume)
{
    smr_grid grid;
    SMR_TRY(smr_grid_open(volume, &grid));
    SMR_TRY(take(s, s->shared.n_structures, smr_volume_checksum(volume)));
    if (SMR_HAS_IMAGE)
        smr_image_goals_see(&s->forces.image, &grid);
    return SMR_OK;
}

smr_status smr_await(smr *s, uint32_t kind, uint32_t number, const void *what)
{
    smr_status status;
    if (what == NULL)
        return SMR_E_STATE;
    switch (kind) {
    case SMR_LOG_GOALS: status = await_goals(s, number, what); break;
    case SMR_LOG_FORCE: status = await_force(s, what); break;
    case SMR_LOG_FIXED_SURFACE: status = await_fixed(s, number, what); break;
    case SMR_LOG_VOLUME: status = await_volume(s, what); break;
    default: status = await_surface(s, number, what); break;
    }
    if (s->n_awaited == 0u)
        smr_take_goals(&s->forces.surface);
    smr_guard_close(s);
    return status;
}
