/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files written whole or not at all: a process that is killed while it writes leaves nothing. */
#include "scratch.h"

#include "io/store.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>

/* Whether files without a name can be had in a folder. */
static bool has_unnamed(const scratch *s) {
    int descriptor = open(s->folder, O_TMPFILE | O_WRONLY, 0600);
    if (descriptor >= 0) {
        close(descriptor);
    }
    return descriptor >= 0;
}

static void check_holds(const char *path, const char *text) {
    char *found = read_whole_file(path, NULL);
    assert_string_equal(found, text);
    free(found);
}

static void a_killed_writer_leaves_nothing(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "file", path);
    write_file(path, "old", 3);
    for (int signals = 0; signals < 3; signals++) {
        pid_t process = fork();
        assert_true(process >= 0);
        if (process == 0) {
            haft_store store;
            haft_status status = haft_store_open(&store, path, true, NULL);
            if (status == HAFT_OK && haft_store_write(&store, "half", 4, NULL) == HAFT_OK) {
                raise(signals == 0 ? SIGKILL : signals == 1 ? SIGTERM : SIGINT);
            }
            _exit(1);
        }
        int code = 0;
        assert_int_equal(waitpid(process, &code, 0), process);
        assert_true(WIFSIGNALED(code));
        check_holds(path, "old");
    }
    assert_int_equal(scratch_count(&s), has_unnamed(&s) ? 1 : 4);
    scratch_remove(&s);
}

static void a_file_comes_whole_or_not_at_all(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "file", path);
    haft_error error = {0};
    haft_store store;
    check_ok(haft_store_open(&store, path, false, &error), error);
    check_ok(haft_store_write(&store, "one", 3, &error), error);
    haft_store_abandon(&store);
    assert_int_equal(scratch_count(&s), 0);
    check_ok(haft_store_open(&store, path, false, &error), error);
    check_ok(haft_store_write(&store, "two", 3, &error), error);
    check_ok(haft_store_commit(&store, &error), error);
    check_holds(path, "two");
    assert_int_equal(haft_store_open(&store, path, false, &error), HAFT_ERROR_EXISTS);
    check_ok(haft_store_put(path, "three", 5, &error), error);
    check_holds(path, "three");
    assert_int_equal(unlink(path), 0);
    check_ok(haft_store_open(&store, path, false, &error), error);
    write_file(path, "other", 5); /* came meanwhile */
    assert_int_equal(haft_store_commit(&store, &error), HAFT_ERROR_EXISTS);
    check_holds(path, "other");
    assert_int_equal(scratch_count(&s), 1);
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_killed_writer_leaves_nothing),
        cmocka_unit_test(a_file_comes_whole_or_not_at_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
