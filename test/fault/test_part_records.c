/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records of parts whose checksums are right and whose paths are not: they are refused. */
#include "scratch.h"

#include "haft/io.h"

enum { BEAMS = 4 };

static const char LAWS[] = "0123456789abcdef0123456789abcdef";

typedef struct record {
    haft_path path;
    haft_path_point point[3];
    haft_jump jump[1];
    haft_summary summary;
} record;

static void make_sound(record *r) {
    *r = (record){.path = {.points = 3, .jumps = 1, .turn = 1}};
    r->path.point = r->point;
    r->path.jump = r->jump;
    r->point[0].jump = r->point[1].jump = -1;
}

/* Appends one record, reads it back. */
static haft_status there_and_back(const record *r, haft_error *error) {
    scratch s = scratch_create();
    char folder[400];
    scratch_path(&s, "parts", folder);
    haft_case *c = NULL;
    haft_part *part = NULL;
    haft_parts *parts = NULL;
    haft_path *back = NULL;
    haft_summary summary;
    check_ok(haft_case_read(&c, HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", error), *error);
    c->realizations = BEAMS;
    check_ok(haft_parts_hold(&parts, folder, 0, 0, error), *error);
    check_ok(haft_part_create(&part, folder, 0, 0, 0, c, LAWS, error), *error);
    check_ok(haft_part_append(part, 2, &r->path, 0, &r->summary, NULL, error), *error);
    check_ok(haft_part_close(&part, error), *error);
    check_ok(haft_parts_scan(parts, c, LAWS, NULL, NULL, error), *error);
    assert_true(haft_parts_has(parts, 2));
    haft_status status = haft_parts_read(&back, &summary, NULL, parts, 2, 0, error);
    assert_int_equal(status == HAFT_OK, back != NULL);
    haft_path_destroy(&back);
    haft_error own = {0};
    check_ok(haft_parts_clear(parts, &own), own);
    haft_parts_release(&parts);
    haft_case_destroy(&c);
    scratch_remove(&s);
    return status;
}

static void records_that_contradict_themselves_are_refused(void **state) {
    (void)state;
    haft_error error = {0};
    record r;
    make_sound(&r);
    check_ok(there_and_back(&r, &error), error);
    for (int i = 0; i < 5; i++) {
        make_sound(&r);
        r.point[2].jump = i == 0 ? 1 : i == 1 ? -2 : 0;
        r.path.turn = i == 2 ? 3 : 1;
        r.summary.outcome = i == 3 ? HAFT_OUTCOMES : i == 4 ? -1 : 0;
        assert_int_equal(there_and_back(&r, &error), HAFT_ERROR_INPUT);
        assert_non_null(strstr(error.message, "part-0-0: byte "));
        assert_non_null(strstr(error.message, "haft run --force"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(records_that_contradict_themselves_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
