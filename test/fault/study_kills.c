/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A storm of 1000 kills, each at a drawn time of a run, a resumption, a merge or a report: what is
 * gone on with afterwards ends in the same bits as what was never disturbed.
 * Usage: fault-kills [COUNT [FIRST]]      so many kills, from the draw of that number on */
#include "same_bits.h"

#include <time.h>

enum { KILLS = 1000, COMMANDS = 4 };

static size_t kills = KILLS;
static uint64_t first;

/* Narrow patches and coarse curves, so that the laws do not take all of the time. */
static const edit few[] = {{"realizations: 2", "realizations: 4"},
                           {"evidence: [0]", "evidence: [1, 2]"},
                           {"step: 0.2 nm", "step: 1 nm"},
                           {"width: 3 um", "width: 1 um"},
                           {NULL, NULL}};

static const char *const made[] = {"out/results.h5",  "out/laws.h5",         "out/laws.csv",
                                   "out/summary.csv", "out/convergence.csv", "out/resolved.yaml"};

static void nap(double seconds) {
    nanosleep(
        &(struct timespec){.tv_sec = (time_t)seconds, .tv_nsec = (long)(fmod(seconds, 1) * 1e9)},
        NULL);
}

/* A number in (0, 1), the same for the same kill. */
static double draw(uint64_t kill, uint64_t use) {
    uint64_t w[4];
    haft_random_words((haft_random_key){23, HAFT_RANDOM_TEST}, kill, use, 0, w);
    return haft_random_uniform(w[0]);
}

/* Runs a command and kills it after some seconds; @return whether that was before its end. */
static bool kill_during(const char *const *args, double after) {
    child c = start_program(HAFT, args, 0);
    nap(after);
    kill(c.pid, SIGKILL);
    ran r = end_program(c);
    bool killed = r.code == 1000 + SIGKILL;
    if (!killed && r.code != 0) {
        fail_msg("%s ended with %d: %s", args[0], r.code, r.err);
    }
    ran_free(&r);
    return killed;
}

static void check_same(const case_folder *whole, const case_folder *c) {
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) {
        check_same_bytes(whole, c, made[i]);
    }
}

static void empty(const case_folder *c) {
    char path[400];
    nftw(path_in(c, "out", path), remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

/* How long a command takes, to draw times from. */
static double time_of(const char *const *args) {
    double begin = haft_clock_seconds();
    must_run(HAFT, args);
    return haft_clock_seconds() - begin;
}

/* Goes on until the results are there, whatever the kill left. */
static void finish(const case_folder *c) {
    ran r = run_program(HAFT, ARGS("run", "--quiet", c->path));
    if (r.code == 5) {
        ran_free(&r);
        r = run_program(HAFT, ARGS("resume", "--quiet", c->path));
    }
    if (r.code != 0) {
        fail_msg("ended with %d: %s", r.code, r.err);
    }
    ran_free(&r);
}

/* What the k-th kill finds: for a resumption what another kill left, for a merge the shards. */
static const char *const *prepare(uint64_t k, int command, const case_folder *c, double lasts,
                                  size_t *killed) {
    static const char *args[5];
    static const char *const names[COMMANDS] = {"run", "resume", "merge", "report"};
    const char *const plain[] = {names[command], "--quiet", c->path, NULL};
    memcpy(args, plain, sizeof plain);
    if (command < 3) {
        empty(c);
    }
    if (command == 1) {
        *killed += kill_during(ARGS("run", "--quiet", c->path), (0.3 + 0.7 * draw(k, 2)) * lasts);
        if (!exists(c, "out/parts/part-0-0")) { /* it came too early or too late */
            const char *const anew[] = {"run", "--quiet", "--force", c->path, NULL};
            memcpy(args, anew, sizeof anew);
        }
    } else if (command == 2) {
        must_run(HAFT, ARGS("run", "--quiet", "--shard=1/2", c->path));
        must_run(HAFT, ARGS("run", "--quiet", "--shard=2/2", c->path));
    }
    return args;
}

/* After a kill and what goes on from it: the results, and no other file than these. */
static void check_after(int command, const case_folder *whole, const case_folder *c) {
    finish(c);
    check_same(whole, c);
    if (command < 3) {
        char *names = listing(whole), *others = listing(c);
        assert_string_equal(names, others); /* nothing half-written, no lock, no part */
        free(names);
        free(others);
    }
}

static void a_thousand_kills(void **state) {
    (void)state;
    size_t killed[COMMANDS] = {0}, tried[COMMANDS] = {0}, all = 0;
    case_folder whole = case_create(few), c = case_create(few);
    double lasts[COMMANDS];
    lasts[0] = time_of(ARGS("run", "--quiet", whole.path));
    lasts[1] = lasts[0] / 2; /* a half is done */
    must_run(HAFT, ARGS("run", "--quiet", "--shard=1/2", c.path));
    must_run(HAFT, ARGS("run", "--quiet", "--shard=2/2", c.path));
    lasts[2] = time_of(ARGS("merge", "--quiet", c.path));
    check_same(&whole, &c);
    lasts[3] = time_of(ARGS("report", "--quiet", c.path));
    for (uint64_t k = first; all < kills; k++) {
        double share = draw(k, 0); /* few reports, whose figures take their time */
        int command = share < 0.4 ? 0 : share < 0.8 ? 1 : share < 0.97 ? 2 : 3;
        const char *const *args = prepare(k, command, &c, lasts[0], &killed[0]);
        tried[command]++;
        killed[command] += kill_during(args, draw(k, 1) * lasts[command]);
        check_after(command, &whole, &c);
        if (all / 50 < (killed[0] + killed[1] + killed[2] + killed[3]) / 50) {
            printf("%zu kills\n", all + 1);
            fflush(stdout);
        }
        all = killed[0] + killed[1] + killed[2] + killed[3];
    }
    must_run(HAFT, ARGS("report", "--quiet", c.path));
    for (int i = 0; i < COMMANDS; i++) {
        static const char *const names[COMMANDS] = {"run", "resume", "merge", "report"};
        printf("%s: %zu times begun, it takes %.2f s\n", names[i], tried[i], lasts[i]);
    }
    printf("kills before the end: %zu of run, %zu of resume, %zu of merge, %zu of report\n",
           killed[0], killed[1], killed[2], killed[3]);
    case_remove(&whole);
    case_remove(&c);
}

int main(int count, char **words) {
    kills = count > 1 ? strtoul(words[1], NULL, 10) : KILLS;
    first = count > 2 ? strtoul(words[2], NULL, 10) : 0;
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_thousand_kills)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
