/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws that are no laws: a number that is NaN, infinite or so large that it overflows, in one field
 * of one site's law. The path must end by itself, with an enumerated reason or a refusal, and keep
 * what it followed before it met the bad law. */
#include "haft/solve.h"
#include "single_spring.h"

#include <time.h>
#include <unistd.h>

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
enum { SITES = 30 };

static void make_laws(haft_law *law) {
    for (size_t r = 0; r < SITES; r++) {
        double z[2];
        haft_random_normals((haft_random_key){5, HAFT_RANDOM_TEST}, 0, r, 0, 2, z);
        haft_law_vector v = {3.6e-3 * exp(0.3 * z[0]), 1e6 * exp(0.25 * z[0] + 0.1 * z[1]), 11e-9,
                             8.2e-9};
        assert_int_equal(haft_law_morse(&law[r], &v, 5e6), HAFT_LAW_SOUND);
    }
}

static const struct {
    const char *name;
    size_t offset;
} FIELD[] = {
    {"f_max", offsetof(haft_law, f_max)},
    {"d_max", offsetof(haft_law, d_max)},
    {"a_left", offsetof(haft_law, a_left)},
    {"a_right", offsetof(haft_law, a_right)},
    {"wall_distance", offsetof(haft_law, wall_distance)},
    {"wall_force", offsetof(haft_law, wall_force)},
    {"wall_slope", offsetof(haft_law, wall_slope)},
    {"wall_potential", offsetof(haft_law, wall_potential)},
};
enum { FIELDS = sizeof FIELD / sizeof *FIELD };

static haft_model *make_beam(void) {
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 100e-6, 20e-6, 60e-6, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
    assert_int_equal(haft_model_get(model)->sites, SITES);
    return model;
}

/* Follows with one field of one law put to `value`. */
static haft_path *inject(const haft_model *model, size_t site, size_t field, double value) {
    haft_law law[SITES];
    make_laws(law);
    memcpy((char *)&law[site] + FIELD[field].offset, &value, sizeof value);
    haft_programme programme = {200e-6, 0.01, INFINITY};
    haft_error error = {0};
    haft_path *path = NULL;
    haft_status status = haft_solve_path(&path, model, law, &programme, NULL, &error);
    if (status != HAFT_OK) {
        assert_int_equal(status, HAFT_ERROR_ARGUMENT);
        assert_true(strlen(error.message) > 0);
        assert_null(path);
        return NULL;
    }
    assert_non_null(path);
    assert_true(path->outcome < HAFT_OUTCOMES);
    return path;
}

static void check_kept(const haft_path *path) {
    for (size_t i = 0; i < path->points; i++) {
        const haft_path_point *p = &path->point[i];
        assert_true(isfinite(p->load) && isfinite(p->deflection) && isfinite(p->internal_energy));
        assert_true(isfinite(p->contact_energy) && isfinite(p->work) && isfinite(p->dissipated));
    }
    for (size_t j = 0; j < path->jumps; j++) {
        assert_true(isfinite(path->jump[j].load) && isfinite(path->jump[j].dissipated));
    }
}

static void a_bad_number_ends_the_path_or_is_refused(void **state) {
    (void)state;
    static const double bad[] = {NAN, INFINITY, 1e300};
    haft_model *model = make_beam();
    int refused = 0;
    for (size_t f = 0; f < FIELDS; f++) {
        for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
            clock_t start = clock();
            alarm(60);
            haft_path *path = inject(model, 18, f, bad[b]);
            alarm(0);
            double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
            print_message("  %-14s %5g: %s, %.2f s\n", FIELD[f].name, bad[b],
                          path == NULL ? "refused" : haft_outcome_name(path->outcome), seconds);
            if (path == NULL) {
                refused++;
                continue;
            }
            /* a law that is not finite where it is felt is named as that */
            if (!isfinite(bad[b]) && f < 4) {
                assert_int_equal(path->outcome, HAFT_OUTCOME_NOT_FINITE);
            }
            check_kept(path);
            haft_path_destroy(&path);
        }
    }
    assert_true(refused > 0);
    haft_model_destroy(&model);
}

/* A spring pressed past its wall, the wall's numbers bad: what was followed before stays. */
static void a_bad_wall_is_met_only_when_it_is_reached(void **state) {
    (void)state;
    static const double bad[] = {NAN, INFINITY, 1e300};
    const double gap = 100e-9, area = 1e-12;
    haft_law good[SITES];
    make_laws(good);
    double k = 0.05 * area * good[0].f_max * good[0].a_right;
    haft_model *model = single_spring(k, gap, area);
    haft_error error = {0};
    for (size_t f = 5; f < FIELDS; f++) {
        for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
            haft_law law = good[0];
            memcpy((char *)&law + FIELD[f].offset, &bad[b], sizeof bad[b]);
            haft_programme programme = {-1, 0.01, 20 * area * 5e6};
            haft_path *path = NULL;
            alarm(60);
            haft_status status = haft_solve_path(&path, model, &law, &programme, NULL, &error);
            alarm(0);
            if (status != HAFT_OK) {
                assert_int_equal(status, HAFT_ERROR_ARGUMENT);
                continue;
            }
            print_message("  %-14s %5g: %s, %zu points, %zu jumps, load %g\n", FIELD[f].name,
                          bad[b], haft_outcome_name(path->outcome), path->points, path->jumps,
                          path->point[path->points - 1].load);
            assert_true(path->outcome != HAFT_OUTCOME_STUCK && path->outcome != HAFT_OUTCOME_FREE);
            if (!isfinite(bad[b])) {
                assert_int_equal(path->outcome, HAFT_OUTCOME_NOT_FINITE);
            }
            assert_true(path->points > 10);
            check_kept(path);
            haft_path_destroy(&path);
        }
    }
    haft_model_destroy(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bad_number_ends_the_path_or_is_refused),
        cmocka_unit_test(a_bad_wall_is_met_only_when_it_is_reached),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
