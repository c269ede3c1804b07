/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Commands that never ask whether to stop are ended by SIGINT and SIGTERM as any program is. Each
 * is caught at work for certain: its standard output is a pipe that is full. */
#include "program.h"

#include <time.h>

/* Fills a pipe to its brim. */
static void open_full_pipe(int ends[2]) {
    char block[4096] = "";
    assert_int_equal(pipe2(ends, O_CLOEXEC), 0);
    assert_int_equal(fcntl(ends[1], F_SETFL, O_NONBLOCK), 0);
    while (write(ends[1], block, sizeof block) > 0 || write(ends[1], block, 1) > 0) {
    }
    assert_int_equal(errno, EAGAIN);
    assert_int_equal(fcntl(ends[1], F_SETFL, 0), 0);
}

/* Whether the process runs the program and sleeps, or has ended. */
static bool is_stuck(pid_t process, const char *program) {
    char path[64], target[4096] = "", state = ' ';
    snprintf(path, sizeof path, "/proc/%ld/exe", (long)process);
    ssize_t n = readlink(path, target, sizeof target - 1);
    snprintf(path, sizeof path, "/proc/%ld/stat", (long)process);
    FILE *stream = fopen(path, "r");
    bool known = stream != NULL && fscanf(stream, "%*d (%*[^)]) %c", &state) == 1;
    if (stream != NULL) {
        fclose(stream);
    }
    const char *name = strrchr(program, '/'), *own = n > 0 ? strrchr(target, '/') : NULL;
    return !known || state == 'Z' || (state == 'S' && own != NULL && strcmp(own, name) == 0);
}

/* Starts a program that cannot write to a standard stream, sends it the signal, and says how it
 * ended. */
static int signal_program(const char *program, const char *const *args, int blocked, int number) {
    int ends[2], state = 0;
    open_full_pipe(ends);
    pid_t process = fork();
    assert_true(process >= 0);
    if (process == 0) {
        char *argv[16] = {NULL};
        const char *const all[] = {program, args[0], args[1], args[2]};
        memcpy(argv, all, sizeof all);
        alarm(200);
        (void)!freopen("/dev/null", "w", blocked == STDOUT_FILENO ? stderr : stdout);
        if (dup2(ends[1], blocked) >= 0) {
            execv(program, argv);
        }
        _exit(127);
    }
    for (int still = 0; still < 5;) {
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
        still = is_stuck(process, program) ? still + 1 : 0;
    }
    char block[4096];
    assert_int_equal(kill(process, number), 0);
    close(ends[1]);
    while (read(ends[0], block, sizeof block) > 0) { /* what it says in the end goes through */
    }
    close(ends[0]);
    assert_int_equal(waitpid(process, &state, 0), process);
    return WIFEXITED(state) ? WEXITSTATUS(state) : 1000 + WTERMSIG(state);
}

static void who_does_not_ask_is_ended(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char map[400];
    snprintf(map, sizeof map, "%s/cases/afm-demo/surface.gsf", HAFT_SOURCE_DIR);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    const struct {
        const char *program, *args[4];
    } runs[] = {{HAFT, {"check", c.path}},
                {HAFT, {"info", c.path}},
                {HAFT, {"compare", c.path, c.path}},
                {HAFT_LAWS, {"info", c.path}},
                {HAFT_LAWS, {"inspect", map, "--output=/nowhere"}}};
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        for (int k = 0; k < 2; k++) {
            int number = k == 0 ? SIGINT : SIGTERM;
            int code = signal_program(runs[i].program, runs[i].args, STDOUT_FILENO, number);
            if (code != 1000 + number) {
                fail_msg("%s %s ended with %d", runs[i].program, runs[i].args[0], code);
            }
        }
    }
    case_remove(&c);
}

/* A merge is stopped at its first words, by the signal that it asks for; its parts are all kept. */
static void a_merge_that_is_stopped_can_be_given_again(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    must_run(HAFT, ARGS("run", "--quiet", "--shard=1/2", c.path));
    must_run(HAFT, ARGS("run", "--quiet", "--shard=2/2", c.path));
    for (int k = 0; k < 2; k++) {
        const char *const args[3] = {"merge", c.path};
        assert_int_equal(signal_program(HAFT, args, STDERR_FILENO, k == 0 ? SIGINT : SIGTERM), 130);
        assert_false(exists(&c, "out/results.h5"));
        assert_true(exists(&c, "out/parts/part-1of2-0-0"));
        assert_true(exists(&c, "out/parts/part-2of2-0-0"));
    }
    must_run(HAFT, ARGS("merge", "--quiet", c.path));
    assert_true(exists(&c, "out/results.h5"));
    assert_false(exists(&c, "out/parts"));
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_does_not_ask_is_ended),
        cmocka_unit_test(a_merge_that_is_stopped_can_be_given_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
