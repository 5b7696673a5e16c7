/* target_jobs.c: on an emulated board: calls in pieces. No piece takes longer than a bound, and the pieces give what
 * the whole call gives.
 *
 * Under `-icount shift=0` one instruction takes one nanosecond of the board's time. Prints the longest pieces; ends
 * with 0 when all holds.
 * SPDX-License-Identifier: MIT */
#include "base/job.h"
#include "target_rig.h"

#define TARGET_PIECE_NS 110000u /* the longest piece of any call */
#define TARGET_CARRIED 16u      /* bound points */

#define TARGET_JOB_MEMORY static __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
TARGET_JOB_MEMORY unsigned char target_goal[1u << 20], target_job_scratch[1u << 19];
TARGET_JOB_MEMORY float target_result[2][3u * 1024u];
TARGET_JOB_MEMORY float target_rest[3u * 1024u];

/* What the calls read. Each writes to target_result[0]. */
typedef struct target_inputs {
    smr *s;
    const smr_surface *goal;
    const smr_surface *moved; /* the goal elsewhere */
    uint32_t n;               /* vertices of the model */
} target_inputs;

static smr_status target_verdict(const target_inputs *in, smr_job *job)
{
    return smr_verdict_begin(in->s, SMR_ALL, (smr_verdict *)(void *)target_result[0], job);
}
static smr_status target_expected(const target_inputs *in, smr_job *job)
{
    return smr_expected_begin(in->s, 0, target_result[0], NULL, NULL, job);
}
static smr_status target_volumes(const target_inputs *in, smr_job *job)
{
    return smr_local_volume_begin(in->s, 0, 0, target_result[0], job);
}
static smr_status target_contact(const target_inputs *in, smr_job *job)
{
    return smr_surface_contact_begin(in->goal, in->moved, 0.5f, (smr_contact_report *)(void *)target_result[0], job);
}
static smr_status target_align(const target_inputs *in, smr_job *job)
{
    smr_align_config config = smr_align_config_default();
    config.samples = 40;
    return smr_align_begin(in->goal, in->moved, &config, target_job_scratch, sizeof target_job_scratch,
                           (smr_pose *)(void *)target_result[0], NULL, job);
}
static smr_status target_bind(const target_inputs *in, smr_job *job)
{
    static smr_carry *carry;
    return smr_carry_fit_begin(target_rest, in->n, target_rest, TARGET_CARRIED, NULL, target_job_scratch,
                               sizeof target_job_scratch, &carry, job);
}

typedef struct target_call {
    const char *name;
    smr_status (*begin)(const target_inputs *in, smr_job *job);
} target_call;

/* Runs a call whole and in pieces. Returns 1 when both give the same and each piece is short. */
static int target_compare(const target_call *call, const target_inputs *in, target_clock *clock)
{
    static smr_job job;
    const smr_job_head *const head = (const smr_job_head *)(void *)&job;
    smr_status status = SMR_PARTIAL;
    uint64_t longest = 0, sum = 0;
    uint32_t pieces = 0, worst = 0;
    memset(target_result, 0, sizeof target_result);
    if (call->begin(in, &job) != SMR_OK || smr_job_step(&job, 0, NULL, 0) != SMR_OK)
        return 0;
    memcpy(target_result[1], target_result[0], sizeof target_result[0]);
    memset(target_result[0], 0, sizeof target_result[0]);
    if (call->begin(in, &job) != SMR_OK)
        return 0;
    for (; status == SMR_PARTIAL; pieces++) {
        const uint32_t stage = head->stage;
        const uint64_t begin = target_now(clock);
        status = smr_job_step(&job, 1, NULL, 0);
        const uint64_t time = target_now(clock) - begin;
        worst = time > longest ? stage : worst;
        longest = time > longest ? time : longest;
        sum += time;
    }
    target_text(call->name);
    target_line(": pieces                 ", pieces);
    target_line("  instructions:           ", sum);
    target_line("  longest piece:          ", longest);
    target_line("  in stage:               ", worst);
    return status == SMR_OK && longest <= TARGET_PIECE_NS &&
           memcmp(target_result[0], target_result[1], sizeof target_result[0]) == 0;
}

static int target_judge(const target_scene *scene, target_clock *clock)
{
    static const target_call calls[] = {{"verdict", target_verdict},      {"expected errors", target_expected},
                                        {"local volume", target_volumes}, {"contact", target_contact},
                                        {"alignment", target_align},      {"carried points", target_bind}};
    const smr_config config = target_config(scene);
    target_inputs in = {target_start(scene, &config, NULL, 0), scene->surface, NULL, 0};
    smr_surface *moved;
    smr_model_info info;
    int good = in.s != NULL;
    for (uint32_t i = 0; i < 12u && good; i++)
        good = smr_tick(in.s, 0, NULL) == SMR_OK;
    good = good && smr_model_get_info(scene->model, &info) == SMR_OK &&
           smr_model_mesh(scene->model, 0, target_rest, NULL) == SMR_OK;
    in.n = info.n_vertices;
    for (uint32_t i = 0; i < 3u * scene->goal.n_vertices; i++)
        target_result[0][i] = scene->goal.xyz[i] + (i % 3u == 0u ? 4.0f : 0.0f);
    const smr_mesh mesh = {target_result[0], scene->goal.triangles, scene->goal.n_vertices, scene->goal.n_triangles};
    good = good && smr_surface_build(&mesh, target_goal, sizeof target_goal, &moved) == SMR_OK;
    in.moved = moved;
    for (uint32_t i = 0; i < sizeof calls / sizeof calls[0] && good; i++)
        good = target_ok(calls[i].name, target_compare(&calls[i], &in, clock));
    return good;
}

int main(void);

int main(void)
{
    static target_scene scene;
    static target_clock clock;
    smr_baremetal board;
    clock.port = smr_baremetal_port(&board);
    return target_ok("scene", target_set_up(&target_cases[0], &scene)) && target_judge(&scene, &clock) ? 0 : 1;
}
