/* test_smr_pthread.c: every task runs once, no two workers share a number, creation at its limits, many short loops.
 * SPDX-License-Identifier: MIT */
#include "../suite.h"
#include <stdatomic.h>
#include <string.h>
#include "smr_pthread.h"

#define TEST_TASKS 300u

static _Alignas(SMR_ALIGN) unsigned char test_memory[16384];

typedef struct test_loop {
    _Atomic uint32_t hits[TEST_TASKS];
    _Atomic uint32_t busy[SMR_WORKERS_MAX];
    _Atomic uint32_t wrong;
    uint32_t n_workers;
    uint32_t plain[TEST_TASKS]; /* written without atomics: visible to the caller after the loop */
} test_loop;

static void test_task(void *arg, uint32_t task, uint32_t worker)
{
    test_loop *loop = arg;
    if (worker >= loop->n_workers || atomic_fetch_add(&loop->busy[worker], 1u) != 0u)
        atomic_fetch_add(&loop->wrong, 1u);
    loop->plain[task] = task + 1u;
    atomic_fetch_add(&loop->hits[task], 1u);
    atomic_fetch_sub(&loop->busy[worker], 1u);
}

static void run_loop(const smr_port *port, uint32_t n_tasks)
{
    test_loop loop;
    memset(&loop, 0, sizeof loop);
    loop.n_workers = port->n_workers;
    port->parallel(port->ctx, test_task, &loop, n_tasks);
    assert_int_equal(0, atomic_load(&loop.wrong));
    for (uint32_t t = 0; t < TEST_TASKS; t++) {
        assert_int_equal(t < n_tasks ? 1 : 0, atomic_load(&loop.hits[t]));
        assert_int_equal(t < n_tasks ? t + 1 : 0, loop.plain[t]);
    }
}

TEST(test_each_task_once)
{
    static const uint32_t counts[] = {1, 2, 3, 4, 8, 64};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
        smr_pthread *pool = NULL;
        assert_int_equal(SMR_OK, smr_pthread_create(&pool, test_memory, sizeof test_memory, counts[c]));
        smr_port port = smr_pthread_port(pool);
        assert_int_equal(counts[c], port.n_workers);
        for (uint32_t n = 0; n <= TEST_TASKS; n += n < 10 ? 1 : 29)
            run_loop(&port, n);
        for (uint32_t i = 0; i < 300u; i++)
            run_loop(&port, 1 + i % 9);
        smr_pthread_destroy(pool);
    }
}

static void outer_task(void *port, uint32_t task, uint32_t worker)
{
    (void)task;
    (void)worker;
    run_loop(port, 9);
}

/* Tasks may have loops of their own. */
TEST(test_loop_in_a_loop)
{
    smr_pthread *pool = NULL;
    assert_int_equal(SMR_OK, smr_pthread_create(&pool, test_memory, sizeof test_memory, 4));
    smr_port port = smr_pthread_port(pool);
    for (uint32_t i = 0; i < 100u; i++)
        port.parallel(port.ctx, outer_task, &port, 5);
    run_loop(&port, TEST_TASKS);
    smr_pthread_destroy(pool);
}

typedef struct meeting {
    smr_port port;
    uint32_t at; /* outer task whose loop meets */
    _Atomic uint32_t here, met;
} meeting;

/* Waits for the other task of the loop, for 50 ms. */
static void meet(void *arg, uint32_t task, uint32_t worker)
{
    meeting *m = arg;
    const uint64_t begin = m->port.now_ns(m->port.ctx);
    (void)task;
    (void)worker;
    atomic_fetch_add(&m->here, 1u);
    while (atomic_load(&m->here) < 2u && m->port.now_ns(m->port.ctx) - begin < 50000000u)
        continue;
    atomic_fetch_add(&m->met, atomic_load(&m->here) == 2u);
    while (atomic_load(&m->met) == 1u && m->port.now_ns(m->port.ctx) - begin < 50000000u)
        continue;
}

static void meet_in_one(void *arg, uint32_t task, uint32_t worker)
{
    meeting *m = arg;
    (void)worker;
    if (task == m->at)
        m->port.parallel(m->port.ctx, meet, m, 2);
}

/* A worker without a task, and the caller, help a task's loop. */
TEST(test_help)
{
    smr_pthread *pool = NULL;
    assert_int_equal(SMR_OK, smr_pthread_create(&pool, test_memory, sizeof test_memory, 2));
    for (uint32_t at = 0; at < 2u; at++) {
        meeting m = {.port = smr_pthread_port(pool), .at = at};
        for (uint32_t i = 0; i < 200u && atomic_load(&m.met) < 2u; i++) { /* not each loop wakes workers */
            atomic_store(&m.here, 0u);
            atomic_store(&m.met, 0u);
            m.port.parallel(m.port.ctx, meet_in_one, &m, 2);
        }
        assert_int_equal(2, atomic_load(&m.met));
    }
    smr_pthread_destroy(pool);
}

TEST(test_clock_goes_forward)
{
    smr_pthread *pool = NULL;
    assert_int_equal(SMR_OK, smr_pthread_create(&pool, test_memory, sizeof test_memory, 2));
    smr_port port = smr_pthread_port(pool);
    uint64_t last = port.now_ns(port.ctx);
    for (int i = 0; i < 1000; i++) {
        uint64_t now = port.now_ns(port.ctx);
        assert_true(now >= last);
        last = now;
    }
    smr_pthread_destroy(pool);
}

TEST(test_edges)
{
    smr_pthread *pool = NULL;
    size_t bytes = smr_pthread_bytes(3);
    smr_port port = smr_pthread_port(NULL);
    assert_int_equal(1, port.n_workers);
    assert_null(port.parallel);
    assert_null(port.now_ns);
    assert_int_equal(0, smr_pthread_bytes(0));
    assert_int_equal(0, smr_pthread_bytes(SMR_WORKERS_MAX + 1));
    assert_true(bytes > 0 && bytes % SMR_ALIGN == 0);
    assert_int_equal(SMR_E_NULL, smr_pthread_create(NULL, test_memory, bytes, 3));
    assert_int_equal(SMR_E_NULL, smr_pthread_create(&pool, NULL, bytes, 3));
    assert_int_equal(SMR_E_CONFIG, smr_pthread_create(&pool, test_memory, bytes, 0));
    assert_int_equal(SMR_E_CONFIG, smr_pthread_create(&pool, test_memory, bytes, SMR_WORKERS_MAX + 1));
    assert_int_equal(SMR_E_ALIGN, smr_pthread_create(&pool, test_memory + 8, bytes, 3));
    assert_int_equal(SMR_E_ARENA, smr_pthread_create(&pool, test_memory, bytes - 1, 3));
    assert_null(pool);
    assert_int_equal(SMR_OK, smr_pthread_create(&pool, test_memory, bytes, 3));
    smr_pthread_destroy(pool);
    smr_pthread_destroy(NULL);
}
