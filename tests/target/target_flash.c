/* target_flash.c: on an emulated board: a model that the linker put into flash is registered onto a deformed bone, with
 * memory by the sizes in the model's header. Then again with budgets and a clock of whole milliseconds, as a SysTick of
 * 1 ms gives: no tick is later than the budget, 1 ms and one chunk.
 *
 * Prints what the table of boards needs (tests/target/boards.sh); ends with 0 when all holds. Under `-icount shift=0`
 * one instruction takes one nanosecond.
 * SPDX-License-Identifier: MIT */
#include "target_rig.h"
#include "bone_model.h"
#include "fixture_bone.h"

#define TARGET_INPUT static __attribute__((section(".arena"))) /* a device's target comes from outside */
#define TARGET_MOST FIXTURE_VERTICES(FIXTURE_CELL_SMALL)
#define TARGET_TICKS 30u
#define TARGET_COARSE_TICKS 300u
#define TARGET_COARSE_NS 1000000u
#define TARGET_PAINT 0xA5C3A5C3u

extern uint32_t smr_bss_end[], smr_stack_top[];

static _Alignas(SMR_ALIGN) unsigned char target_arena[SMR_ARENA_BYTES(bone_model_VERTICES, bone_model_TRIANGLES,
                                                                      bone_model_STRUCTURES, 1, 0, SMR_METHOD_RIGID)];
static _Alignas(SMR_ALIGN) unsigned char target_surface[SMR_SURFACE_BYTES(TARGET_MOST, 2u * TARGET_MOST)];
TARGET_INPUT float target_words[FIXTURE_SCRATCH_WORDS(FIXTURE_CELL_SMALL)];
TARGET_INPUT float target_xyz[3u * TARGET_MOST];
TARGET_INPUT uint32_t target_triangles[6u * TARGET_MOST];

/* The free stack, word by word up to this function's frame; then the deepest word that was written since. */
__attribute__((noinline)) static void target_paint(void)
{
    const uintptr_t end = (uintptr_t)__builtin_frame_address(0) - 256u;
    for (volatile uint32_t *word = smr_bss_end; (uintptr_t)word < end; word++)
        *word = TARGET_PAINT;
}

static uint64_t target_stack(void)
{
    const volatile uint32_t *word = smr_bss_end;
    while (*word == TARGET_PAINT)
        word++;
    return (uintptr_t)smr_stack_top - (uintptr_t)word;
}

static int target_mesh(smr_mesh *mesh)
{
    const fixture_grid grid = fixture_grid_target(FIXTURE_CELL_SMALL);
    fixture_mesh m = {target_xyz, target_triangles, TARGET_MOST, 2u * TARGET_MOST, 0, 0};
    const int made = fixture_bone_target(&grid, 1.0f, &m, target_words, sizeof target_words / sizeof target_words[0]);
    *mesh = (smr_mesh){m.xyz, m.triangles, m.n_vertices, m.n_triangles};
    return made;
}

static smr *target_begin(const smr_model *model, const smr_surface *surface, const smr_port *port)
{
    const smr_config config = smr_config_default();
    smr *s = NULL;
    return smr_init(model, &config, port, target_arena, sizeof target_arena, &s) == SMR_OK &&
                   smr_set_surface(s, SMR_ALL, surface) == SMR_OK
               ? s
               : NULL;
}

/* Whole iterations. */
static int target_whole(smr *s, target_clock *clock)
{
    uint64_t sum = 0, most = 0;
    for (uint32_t i = 0; i < TARGET_TICKS; i++) {
        smr_tick_report report;
        smr_status status;
        const uint64_t time = target_tick(s, clock, 0, &report, &status);
        sum += time;
        most = time > most ? time : most;
        if (status != SMR_OK)
            return 0;
    }
    target_line("mean ", sum / TARGET_TICKS);
    target_line("most ", most);
    target_line("state ", smr_state_hash(s));
    return 1;
}

static uint64_t target_coarse_now(void *clock) { return target_now(clock) / TARGET_COARSE_NS * TARGET_COARSE_NS; }

/* Budgets of 0.7 to 7 ms. Prints by how much ticks were longer, in ns. */
static int target_coarse(smr *s, target_clock *clock)
{
    uint64_t beyond = 0;
    target_forget(clock);
    for (uint32_t i = 0; i < TARGET_COARSE_TICKS; i++) {
        const uint64_t budget = 700000u + i % 8u * 900001u;
        smr_tick_report report;
        smr_status status;
        const uint64_t time = target_tick(s, clock, budget, &report, &status);
        beyond = time > budget + beyond ? time - budget : beyond;
        if (status < 0)
            return 0;
    }
    target_line("chunk ", clock->longest);
    target_line("beyond ", beyond);
    return target_ok("no tick is late", beyond <= TARGET_COARSE_NS + clock->longest);
}

int main(void);

int main(void)
{
    static target_clock clock;
    const smr_port coarse = {&clock, 1u, NULL, target_coarse_now};
    const smr_model *model = NULL;
    smr_surface *surface = NULL;
    smr_baremetal board;
    smr_mesh mesh;
    smr *s = NULL;
    clock.port = smr_baremetal_port(&board);
    if (!target_ok("self-test", smr_self_test() == 0u) || !target_ok("mesh", target_mesh(&mesh)))
        return 1;
    target_paint();
    if (!target_ok("model", smr_model_open(bone_model, bone_model_bytes, &model) == SMR_OK) ||
        !target_ok("surface", smr_surface_build(&mesh, target_surface, sizeof target_surface, &surface) == SMR_OK) ||
        !target_ok("start", (s = target_begin(model, surface, NULL)) != NULL) ||
        !target_ok("ticks", target_whole(s, &clock)) ||
        !target_ok("another start", (s = target_begin(model, surface, &coarse)) != NULL) ||
        !target_ok("a coarse clock", target_coarse(s, &clock)))
        return 1;
    target_line("stack ", target_stack());
    return 0;
}
