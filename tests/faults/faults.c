/* faults.c: a campaign of single bit flips between ticks, in process: model, arena, target surfaces, clouds, voxels.
 *
 * A scene is registered once without a fault; the arena is copied after each tick. A flip goes back to a copy, changes
 * one bit of one block, and ticks on to the end. Counted: crashes (among them reads and writes that leave the blocks:
 * pages without access lie around each, and inputs can only be read), runs without end, writes beside the arena, flips
 * that a call reported, and results more than 1 mm off that the verdict calls good.
 * usage: faults [N [SEED [bare|seal [FIRST [V]]]]]      V: a line for each flip that counts as bad
 * Status 1: a crash, a run without end, a write beside; with seal also a wrong result called good.
 * SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include <setjmp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "faults_scene.h"

enum { SAME, NEAR, OFF, TOLD, WRONG, CRASH, ENDLESS, BESIDE, RESULTS };
static const char *const result_name[RESULTS] = {"same", "near", "off", "told", "wrong", "crash", "endless", "beside"};

#define MOST_MM 1.0f    /* a result farther from that without a fault is wrong */
#define LIMIT_US 500000 /* processor time of a flip, some hundred times what one without a fault takes */

typedef struct counts {
    uint64_t of[FAULTS_SCENES][FAULTS_KINDS][RESULTS];
    uint64_t done;                          /* flips done or given up: where a new process goes on */
    uint64_t in_tick, readable, unreadable; /* crashes in the next tick; told flips with and without positions */
} counts;

static sigjmp_buf back;

static void leap(int number) { siglongjmp(back, number); }

static void catch_all(void)
{
    static unsigned char stack[1 << 16];
    const int caught[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPROF};
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    struct sigaction act = {.sa_handler = leap, .sa_flags = SA_ONSTACK | SA_NODEFER};
    (void)sigaltstack(&other, NULL);
    for (size_t i = 0; i < sizeof caught / sizeof caught[0]; i++)
        (void)sigaction(caught[i], &act, NULL);
}

static void set_timer(long us)
{
    const struct itimerval timer = {{0, 0}, {us / 1000000, us % 1000000}};
    (void)setitimer(ITIMER_PROF, &timer, NULL);
}

/* A number that looks random: splitmix64. */
static uint64_t draw(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

typedef struct flip {
    uint32_t scene, block, tick;
    size_t byte;
    uint32_t bit;
} flip;

static flip flip_of(const faults_scene *scenes, uint64_t seed, uint64_t i)
{
    uint64_t state = seed * 0x632be59bd9b4e019u + i * 0x9e3779b97f4a7c15u;
    flip f;
    (void)draw(&state);
    f.scene = (uint32_t)(draw(&state) % FAULTS_SCENES);
    const faults_scene *s = &scenes[f.scene];
    const uint32_t block = (uint32_t)(draw(&state) % 8u); /* half in the arena, an eighth at least in each other */
    f.block = block < 4u ? FAULTS_ARENA : (uint32_t)(draw(&state) % s->n_blocks);
    f.tick = (uint32_t)(draw(&state) % s->n_ticks);
    const size_t bytes = s->block[f.block].bytes;
    const size_t head = block == 0u && bytes > FAULTS_HEAD ? FAULTS_HEAD : bytes; /* a share in structs with pointers */
    f.byte = (size_t)(draw(&state) % head);
    f.bit = (uint32_t)(draw(&state) % 8u);
    return f;
}

/* The last complete positions are those of the copy, unless the flip hit them. */
static int readable(faults_scene *s, const flip *f)
{
    if (!faults_positions(s, s->found))
        return 0;
    const float *then = s->tick[f->tick].xyz;
    for (uint32_t i = 0; i < 3u * s->n_vertices; i++)
        if (memcmp(&then[i], &s->found[i], sizeof *then) != 0 && f->block != FAULTS_ARENA && f->block != FAULTS_MODEL)
            return 0;
    return 1;
}

static int judge(faults_scene *s, const flip *f, counts *c)
{
    smr_verdict verdict;
    const int status = faults_finish(s, f->tick, &verdict);
    if (status < 0 || !faults_positions(s, s->found)) {
        if (readable(s, f))
            c->readable++;
        else
            c->unreadable++;
        return TOLD;
    }
    const float *truth = s->tick[s->n_ticks].xyz;
    float far2 = 0.0f;
    int same = 1;
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        float d2 = 0.0f;
        for (uint32_t a = 0; a < 3u; a++) {
            const float d = s->found[3u * i + a] - truth[3u * i + a];
            same &= d == 0.0f;
            d2 += d * d;
        }
        far2 = d2 <= far2 ? far2 : d2; /* keeps NaN */
    }
    if (same)
        return SAME;
    if (far2 <= MOST_MM * MOST_MM)
        return NEAR;
    return verdict.level == SMR_VERDICT_GOOD ? WRONG : OFF;
}

/* Does one flip, and undoes it. */
static int try(faults_scene *s, const flip *f, counts *c)
{
    const faults_block *b = &s->block[f->block], *arena = &s->block[FAULTS_ARENA];
    volatile int result = CRASH;
    memcpy(arena->own, s->tick[f->tick].arena, arena->bytes);
    b->own[f->byte] ^= (unsigned char)(1u << f->bit);
    s->at = f->tick;
    const int number = sigsetjmp(back, 1);
    if (number == 0) {
        set_timer(LIMIT_US);
        result = judge(s, f, c);
    } else {
        result = number == SIGPROF ? ENDLESS : CRASH;
        c->in_tick += s->at == f->tick;
    }
    set_timer(0);
    if (f->block != FAULTS_ARENA)
        b->own[f->byte] ^= (unsigned char)(1u << f->bit);
    if (!faults_frame_intact(arena)) {
        faults_frame_mend(arena);
        result = BESIDE;
    }
    return result;
}

/* Does the flips from c->done to last - 1, or to the first after which this process' own memory may be damaged. */
static void work(faults_scene *scenes, uint64_t seed, uint64_t last, int loud, counts *c)
{
    catch_all();
    faults_clean(scenes);
    int sound = 1;
    for (uint64_t i = c->done; i < last && sound; i++) {
        const flip f = flip_of(scenes, seed, i);
        faults_scene *s = &scenes[f.scene];
        c->done = i + 1u; /* should the process end, the next one goes on behind this flip */
        const int result = try(s, &f, c);
        c->of[f.scene][s->kind[f.block]][result]++;
        sound = result < CRASH;
        if (loud && result >= WRONG)
            printf("%llu: %s: %s byte %zu bit %u after tick %u: %s in tick %u\n", (unsigned long long)i, s->name,
                   faults_kind_name[s->kind[f.block]], f.byte, f.bit, f.tick, result_name[result], s->at);
    }
    (void)fflush(stdout);
    _exit(0);
}

static uint64_t total(const counts *c, int result)
{
    uint64_t sum = 0;
    for (uint32_t k = 0; k < FAULTS_SCENES * FAULTS_KINDS; k++)
        sum += c->of[k / FAULTS_KINDS][k % FAULTS_KINDS][result];
    return sum;
}

static void table(const faults_scene *scenes, const counts *c)
{
    printf("%-10s %-8s", "scene", "flips in");
    for (int r = 0; r < RESULTS; r++)
        printf(" %8s", result_name[r]);
    for (uint32_t k = 0; k < FAULTS_SCENES * FAULTS_KINDS; k++) {
        const uint64_t *row = c->of[k / FAULTS_KINDS][k % FAULTS_KINDS];
        uint64_t all = 0;
        for (int r = 0; r < RESULTS; r++)
            all += row[r];
        if (all == 0u)
            continue;
        printf("\n%-10s %-8s", scenes[k / FAULTS_KINDS].name, faults_kind_name[k % FAULTS_KINDS]);
        for (int r = 0; r < RESULTS; r++)
            printf(" %8llu", (unsigned long long)row[r]);
    }
    printf("\n%-19s", "all");
    for (int r = 0; r < RESULTS; r++)
        printf(" %8llu", (unsigned long long)total(c, r));
    printf("\n%llu of the crashes in the next tick; told: %llu with, %llu without the last positions\n",
           (unsigned long long)c->in_tick, (unsigned long long)c->readable, (unsigned long long)c->unreadable);
}

int main(int argc, char **argv)
{
    static faults_scene scenes[FAULTS_SCENES];
    const uint64_t n = argc > 1 ? strtoull(argv[1], NULL, 10) : 2000u,
                   seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1u;
    const int seal = argc > 3 && strcmp(argv[3], "seal") == 0, loud = argc > 5;
    counts *c = mmap(NULL, sizeof *c, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (c == MAP_FAILED || !faults_scenes(scenes, seal))
        return 2;
    c->done = argc > 4 ? strtoull(argv[4], NULL, 10) : 0u;
    const uint64_t last = c->done + n;
    while (c->done < last) {
        (void)fflush(stdout);
        const uint64_t before = c->done;
        const pid_t child = fork();
        if (child == 0)
            work(scenes, seed, last, loud, c);
        int status = 0;
        if (child < 0 || waitpid(child, &status, 0) != child)
            return 2;
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) { /* a flip ended the whole process */
            const flip f = flip_of(scenes, seed, c->done - 1u);
            c->of[f.scene][scenes[f.scene].kind[f.block]][CRASH]++;
        }
        if (c->done == before)
            return 2;
    }
    table(scenes, c);
    const uint64_t bad = total(c, CRASH) + total(c, ENDLESS) + total(c, BESIDE) + (seal ? total(c, WRONG) : 0u);
    return bad > 0u;
}
