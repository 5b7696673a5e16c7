/* smr_pthread.c: fork-join over persistent threads; one atomic counter of a loop hands out the tasks.
 *
 * `ticket` holds the loop's number, the first task not yet handed out, and the number of such tasks. A worker takes a
 * task by compare-and-swap of the whole word. A worker that the system has suspended can therefore neither take a task
 * of a loop it does not know nor hold up a loop that the others have finished: the caller waits only for tasks that
 * have begun. Workers with even numbers take the first task, others the last one, so a worker gets the same part of a
 * model in loop after loop, which stays in its processor's caches.
 *
 * A task may call a loop of its own, one such loop at a time. Workers without a task of the outer loop, and the outer
 * loop's caller while it waits, then help.
 *
 * Idle workers spin for a short time, because the loops of one tick follow each other closely, and then sleep. They
 * do not spin when there are more workers than processors. Where other processes have the processors, a worker that is
 * woken comes too late: after each wake in vain twice as many loops wake nobody, so that threads cost next to nothing.
 * SPDX-License-Identifier: MIT */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE 1 /* sched_getaffinity: the processors this process may use */
#elif !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif

#include "smr_pthread.h"
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define SMR_PTHREAD_SPIN_NS 320000u  /* from this idle spin on, ns, a success does not double it */
#define SMR_PTHREAD_SPIN_LEAST 5000u /* from this idle spin on a failure does not halve it */
#define SMR_PTHREAD_VAIN_MOST 6u     /* after this number of wakes in vain, 2^this loops wake nobody */
#define SMR_PTHREAD_BITS 20u         /* bits of a ticket for the first task, and for the number of tasks left */
#define SMR_PTHREAD_MASK ((1u << SMR_PTHREAD_BITS) - 1u)
#define SMR_PTHREAD_SPIN_LOOKS 64u /* readings of the word between two of the clock */

typedef struct smr_pthread_worker {
    pthread_t thread;
    smr_pthread *pool;
    uint32_t index;
    uint32_t spin_ns; /* longest idle spin, ns */
} smr_pthread_worker;

typedef struct smr_pthread_loop {
    /* Written by every worker; alone on its cache line. */
    _Alignas(SMR_ALIGN) _Atomic uint64_t ticket;     /* loop number, first task, number of tasks not handed out */
    _Alignas(SMR_ALIGN) _Atomic uint32_t unfinished; /* tasks of this loop that have not returned */

    /* The loop's description, written by the caller before it publishes the ticket. Atomic because a
     * late worker may read it at that very time; its compare-and-swap then fails. */
    _Alignas(SMR_ALIGN) _Atomic(smr_task) run;
    _Atomic(void *) arg;
    _Atomic uint32_t offset; /* number of the loop's task 0 */
    _Atomic uint32_t busy;   /* 0: free; 1: a loop runs; 2: and `caller` is its caller */
} smr_pthread_loop;

struct smr_pthread {
    smr_pthread_loop loop[2];  /* a loop; a loop that one of its tasks calls */
    _Atomic(pthread_t) caller; /* thread that called loop[0] */

    _Atomic uint32_t sleepers;      /* workers inside pthread_cond_wait */
    _Atomic uint32_t in_vain;       /* number of wakes since a woken worker last found a task */
    _Atomic uint32_t caller_sleeps; /* number of callers that wait on `finished` */
    _Atomic uint32_t stop;

    pthread_mutex_t mutex;
    pthread_cond_t work;     /* a loop was published, or stop */
    pthread_cond_t finished; /* the last task returned, or a task's loop was published */

    uint32_t n_workers;
    uint32_t n_started;
    uint32_t spin; /* 0: sleep at once */
    uint32_t rest; /* number of loops that wake nobody, counted by the caller */
    smr_pthread_worker workers[];
};

/* Monotonic nanoseconds; the ctx is not used. */
static uint64_t smr_pthread_now(void *ctx)
{
    struct timespec t;
    (void)ctx;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static void smr_pthread_pause(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __asm__ __volatile__("pause");
#elif defined(__aarch64__)
    __asm__ __volatile__("yield");
#endif
}

static uint32_t smr_pthread_processors(void)
{
    long n = 0;
#if defined(__linux__)
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        n = CPU_COUNT(&set);
#endif
    if (n <= 0)
        n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 ? (uint32_t)n : 1u;
}

/* Takes and runs tasks of a loop until none is left to hand out. Returns 1 unless there was none. */
static uint32_t smr_pthread_work(smr_pthread *p, smr_pthread_loop *l, uint32_t worker)
{
    uint32_t some = 0;
    uint64_t ticket = atomic_load_explicit(&l->ticket, memory_order_acquire);
    while ((ticket & SMR_PTHREAD_MASK) != 0u) {
        const uint32_t left = (uint32_t)ticket & SMR_PTHREAD_MASK;
        const uint32_t first = (uint32_t)(ticket >> SMR_PTHREAD_BITS) & SMR_PTHREAD_MASK;
        const uint64_t at_front = worker % 2u == 0u ? (uint64_t)1 << SMR_PTHREAD_BITS : 0u;
        smr_task run = atomic_load_explicit(&l->run, memory_order_relaxed);
        void *arg = atomic_load_explicit(&l->arg, memory_order_relaxed);
        uint32_t offset = atomic_load_explicit(&l->offset, memory_order_relaxed);

        /* Success means this loop was still open, so run, arg and offset are its own: the caller
         * cannot describe the next loop before the task taken here has returned. */
        if (atomic_compare_exchange_weak_explicit(&l->ticket, &ticket, ticket + at_front - 1u, memory_order_acq_rel,
                                                  memory_order_acquire)) {
            some = 1;
            run(arg, offset + (at_front != 0u ? first : first + left - 1u), worker);
            /* Sequentially consistent, as caller_sleeps: one of the two sides sees the other. */
            if (atomic_fetch_sub(&l->unfinished, 1u) == 1u && atomic_load(&p->caller_sleeps) != 0u) {
                (void)pthread_mutex_lock(&p->mutex);
                (void)pthread_cond_broadcast(&p->finished);
                (void)pthread_mutex_unlock(&p->mutex);
            }
            ticket = atomic_load_explicit(&l->ticket, memory_order_acquire);
        }
    }
    return some;
}

static int smr_pthread_has_tasks(smr_pthread_loop *l) { return (atomic_load(&l->ticket) & SMR_PTHREAD_MASK) != 0u; }

static int smr_pthread_has_work(smr_pthread *p, smr_pthread_loop *l)
{
    (void)l;
    return smr_pthread_has_tasks(&p->loop[0]) || smr_pthread_has_tasks(&p->loop[1]) || atomic_load(&p->stop) != 0u;
}

/* Returns 1 when the caller of a loop need not wait: all tasks have returned, or it can help a task's loop. */
static int smr_pthread_goes_on(smr_pthread *p, smr_pthread_loop *l)
{
    return atomic_load(&l->unfinished) == 0u || (l == &p->loop[0] && smr_pthread_has_tasks(&p->loop[1]));
}

/* Polls `ready` for at most *ns, which a success doubles and a failure halves. Returns its last answer. */
static int smr_pthread_spin(smr_pthread *p, int (*ready)(smr_pthread *, smr_pthread_loop *), smr_pthread_loop *l,
                            uint32_t *ns)
{
    if (ready(p, l))
        return 1;
    if (p->spin == 0u)
        return 0;
    const uint64_t begin = smr_pthread_now(NULL);
    do {
        for (uint32_t look = 0; look < SMR_PTHREAD_SPIN_LOOKS; look++) {
            if (ready(p, l)) {
                *ns = *ns < SMR_PTHREAD_SPIN_NS ? 2u * *ns : *ns;
                return 1;
            }
            smr_pthread_pause();
        }
    } while (smr_pthread_now(NULL) - begin < *ns);
    *ns = *ns > SMR_PTHREAD_SPIN_LEAST ? *ns / 2u : *ns;
    return ready(p, l);
}

/* Notes whether a worker, woken or not, has found a task. */
static void smr_pthread_note(smr_pthread *p, uint32_t woken, uint32_t some)
{
    if (some != 0u)
        atomic_store_explicit(&p->in_vain, 0u, memory_order_relaxed);
    else if (woken != 0u)
        (void)atomic_fetch_add_explicit(&p->in_vain, 1u, memory_order_relaxed);
}

static void *smr_pthread_main(void *arg)
{
    smr_pthread_worker *self = arg;
    smr_pthread *p = self->pool;
    while (atomic_load(&p->stop) == 0u) {
        uint32_t woken = 0;
        if (!smr_pthread_spin(p, smr_pthread_has_work, NULL, &self->spin_ns)) {
            (void)pthread_mutex_lock(&p->mutex);
            (void)atomic_fetch_add(&p->sleepers, 1u);
            while (!smr_pthread_has_work(p, NULL))
                (void)pthread_cond_wait(&p->work, &p->mutex);
            (void)atomic_fetch_sub(&p->sleepers, 1u);
            (void)pthread_mutex_unlock(&p->mutex);
            woken = 1;
        }
        const uint32_t helped = smr_pthread_work(p, &p->loop[1], self->index);
        smr_pthread_note(p, woken, smr_pthread_work(p, &p->loop[0], self->index) | helped);
    }
    return NULL;
}

/* Wakes as many sleepers as there are tasks for them, unless wakes have been in vain. For a task's loop that includes
 * the outer loop's caller. */
static void smr_pthread_wake(smr_pthread *p, const smr_pthread_loop *l, uint32_t n_tasks)
{
    const uint32_t n = atomic_load(&p->sleepers), vain = atomic_load_explicit(&p->in_vain, memory_order_relaxed);
    const uint32_t callers = l == &p->loop[1] ? atomic_load(&p->caller_sleeps) : 0u;
    if (n + callers == 0u)
        return;
    if (p->rest > 0u) {
        p->rest--;
        return;
    }
    p->rest = vain == 0u ? 0u : 1u << (vain < SMR_PTHREAD_VAIN_MOST ? vain : SMR_PTHREAD_VAIN_MOST);
    (void)pthread_mutex_lock(&p->mutex);
    if (callers > 0u)
        (void)pthread_cond_broadcast(&p->finished);
    if (n_tasks - 1u >= n)
        (void)pthread_cond_broadcast(&p->work);
    else
        for (uint32_t i = 1; i < n_tasks; i++)
            (void)pthread_cond_signal(&p->work);
    (void)pthread_mutex_unlock(&p->mutex);
}

/* Waits until every task that was handed out has returned. The outer loop's caller helps a task's loop. */
static void smr_pthread_join_tasks(smr_pthread *p, smr_pthread_loop *l, uint32_t worker)
{
    while (atomic_load(&l->unfinished) != 0u) {
        uint32_t woken = 0;
        if (!smr_pthread_spin(p, smr_pthread_goes_on, l, &p->workers[worker].spin_ns)) {
            (void)pthread_mutex_lock(&p->mutex);
            (void)atomic_fetch_add(&p->caller_sleeps, 1u);
            while (!smr_pthread_goes_on(p, l))
                (void)pthread_cond_wait(&p->finished, &p->mutex);
            (void)atomic_fetch_sub(&p->caller_sleeps, 1u);
            (void)pthread_mutex_unlock(&p->mutex);
            woken = atomic_load(&l->unfinished) != 0u;
        }
        if (l == &p->loop[0])
            smr_pthread_note(p, woken, smr_pthread_work(p, &p->loop[1], worker));
    }
}

/* Returns the number of the pool's worker that this thread is; n_workers: none. */
static uint32_t smr_pthread_self(smr_pthread *p)
{
    const pthread_t self = pthread_self();
    if (pthread_equal(self, atomic_load(&p->caller)))
        return 0;
    for (uint32_t i = 1; i <= p->n_started; i++)
        if (pthread_equal(self, p->workers[i].thread))
            return i;
    return p->n_workers;
}

/* Returns the loop that a thread may use, and its worker; NULL: it loops alone. */
static smr_pthread_loop *smr_pthread_enter(smr_pthread *p, uint32_t *worker)
{
    uint32_t busy = 0;
    *worker = 0;
    if (atomic_compare_exchange_strong(&p->loop[0].busy, &busy, 1u)) {
        atomic_store(&p->caller, pthread_self());
        atomic_store(&p->loop[0].busy, 2u);
        return &p->loop[0];
    }
    *worker = busy == 2u ? smr_pthread_self(p) : p->n_workers;
    return *worker < p->n_workers && atomic_exchange(&p->loop[1].busy, 1u) == 0u ? &p->loop[1] : NULL;
}

static void smr_pthread_parallel(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    smr_pthread *p = ctx;
    uint32_t worker = 0;
    smr_pthread_loop *const l = p->n_workers == 1u || n_tasks < 2u ? NULL : smr_pthread_enter(p, &worker);
    if (l == NULL) {
        for (uint32_t task = 0; task < n_tasks; task++)
            run(arg, task, 0);
        return;
    }
    for (uint32_t done = 0, n; done < n_tasks; done += n) {
        n = n_tasks - done < SMR_PTHREAD_MASK ? n_tasks - done : SMR_PTHREAD_MASK;
        atomic_store_explicit(&l->run, run, memory_order_relaxed);
        atomic_store_explicit(&l->arg, arg, memory_order_relaxed);
        atomic_store_explicit(&l->offset, done, memory_order_relaxed);
        atomic_store_explicit(&l->unfinished, n, memory_order_relaxed);
        const uint64_t loop = (atomic_load_explicit(&l->ticket, memory_order_relaxed) >> 2u * SMR_PTHREAD_BITS) + 1u;
        atomic_store(&l->ticket, loop << 2u * SMR_PTHREAD_BITS | n);
        smr_pthread_wake(p, l, n);
        (void)smr_pthread_work(p, l, worker);
        smr_pthread_join_tasks(p, l, worker);
    }
    atomic_store(&l->busy, 0u);
}

size_t smr_pthread_bytes(uint32_t n_workers)
{
    if (n_workers < 1u || n_workers > SMR_WORKERS_MAX)
        return 0;
    const size_t bytes = sizeof(smr_pthread) + (size_t)n_workers * sizeof(smr_pthread_worker);
    return (bytes + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
}

static int smr_pthread_sync_init(smr_pthread *p)
{
    if (pthread_mutex_init(&p->mutex, NULL) != 0)
        return 0;
    if (pthread_cond_init(&p->work, NULL) != 0) {
        (void)pthread_mutex_destroy(&p->mutex);
        return 0;
    }
    if (pthread_cond_init(&p->finished, NULL) != 0) {
        (void)pthread_cond_destroy(&p->work);
        (void)pthread_mutex_destroy(&p->mutex);
        return 0;
    }
    return 1;
}

smr_status smr_pthread_create(smr_pthread **pool, void *memory, size_t bytes, uint32_t n_workers)
{
    smr_pthread *p = (smr_pthread *)memory;
    if (pool == NULL || memory == NULL)
        return SMR_E_NULL;
    if (smr_pthread_bytes(n_workers) == 0u)
        return SMR_E_CONFIG;
    if ((uintptr_t)memory % SMR_ALIGN != 0u)
        return SMR_E_ALIGN;
    if (bytes < smr_pthread_bytes(n_workers))
        return SMR_E_ARENA;
    memset(memory, 0, smr_pthread_bytes(n_workers));
    p->n_workers = n_workers;
    p->spin = n_workers <= smr_pthread_processors() ? 1u : 0u;
    if (!smr_pthread_sync_init(p))
        return SMR_E_STATE;
    p->workers[0].spin_ns = SMR_PTHREAD_SPIN_NS;
    for (uint32_t i = 1; i < n_workers; i++) {
        smr_pthread_worker *w = &p->workers[i];
        w->spin_ns = SMR_PTHREAD_SPIN_NS;
        w->pool = p;
        w->index = i;
        if (pthread_create(&w->thread, NULL, smr_pthread_main, w) != 0) {
            smr_pthread_destroy(p);
            return SMR_E_STATE;
        }
        p->n_started = i;
    }
    *pool = p;
    return SMR_OK;
}

smr_port smr_pthread_port(smr_pthread *pool)
{
    smr_port port = {NULL, 1u, NULL, NULL};
    if (pool != NULL) {
        port.ctx = pool;
        port.n_workers = pool->n_workers;
        port.parallel = smr_pthread_parallel;
        port.now_ns = smr_pthread_now;
    }
    return port;
}

void smr_pthread_destroy(smr_pthread *pool)
{
    if (pool == NULL)
        return;
    (void)pthread_mutex_lock(&pool->mutex);
    atomic_store(&pool->stop, 1u);
    (void)pthread_cond_broadcast(&pool->work);
    (void)pthread_mutex_unlock(&pool->mutex);
    for (uint32_t i = 1; i <= pool->n_started; i++)
        (void)pthread_join(pool->workers[i].thread, NULL);
    (void)pthread_cond_destroy(&pool->finished);
    (void)pthread_cond_destroy(&pool->work);
    (void)pthread_mutex_destroy(&pool->mutex);
}
