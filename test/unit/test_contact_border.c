/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact curves where a beam is cut into patches: nothing is lost there, nothing counted twice. */
#include "rough_patch.h"

/* A paraboloid over a deep plane, its apex at (row, column) of a patch that begins at `first`. */
static void make_paraboloid(double *z, int rows, int columns, double row, double column) {
    for (int i = 0; i < rows; i++) {
        for (int j = 0; j < columns; j++) {
            double r2 =
                pow(i - row, 2) + 1.44 * pow(j - column, 2) + 0.3 * (i - row) * (j - column);
            z[i * columns + j] = fmax(8e-9 - 2e-11 * r2, -5e-8);
        }
    }
}

/* Where four patches meet, an apex belongs to exactly one of them, wherever it is. */
static void a_cut_keeps_every_summit_once(void **state) {
    (void)state;
    enum { N = 24 };
    static double z[N * N];
    haft_contact_spec spec = spec_of(HAFT_ASPERITY_SUMMITS);
    spec.has_capillary = false;
    answer whole, part;
    make_paraboloid(z, N, N, 11.3, 12.2);
    get_curve(&whole, &spec, z, N, N, 5e-9, 1e-9, 9e-9);
    for (uint64_t k = 0; k < 400; k++) {
        uint64_t words[4];
        haft_random_words((haft_random_key){3, HAFT_RANDOM_TEST}, k, 0, 0, words);
        double row = N - 2 + 3 * haft_random_uniform(words[0]);
        double column = N - 2 + 3 * haft_random_uniform(words[1]);
        double force = 0, number = 0;
        for (int corner = 0; corner < 4; corner++) {
            make_paraboloid(z, N, N, row - N * (corner & 1), column - N * (corner >> 1));
            get_curve(&part, &spec, z, N, N, 5e-9, 1e-9, 9e-9);
            force += part.force[0];
            number += part.number[0] / whole.number[0];
        }
        check_relative(force, whole.force[0], 1e-9);
        check_near(number, 1, 1e-12);
    }
}

static void wet_area_adds_up_over_a_cut(void **state) {
    (void)state;
    static double z[MOST];
    make_patch(z, 80, 96, 9, 0x1p-60);
    haft_contact_spec spec = spec_of(HAFT_ASPERITY_ISLANDS);
    answer whole, a, b;
    get_curve(&whole, &spec, z, 80, 96, 5e-9, -2e-9, 1e-8);
    get_curve(&a, &spec, z, 30, 96, 5e-9, -2e-9, 1e-8);
    get_curve(&b, &spec, z + 30 * 96, 50, 96, 5e-9, -2e-9, 1e-8);
    for (int k = 0; k < LEVELS; k++) {
        check_near((30 * a.wet[k] + 50 * b.wet[k]) / 80, whole.wet[k], 1e-15);
        check_near((30 * a.contact[k] + 50 * b.contact[k]) / 80, whole.contact[k], 1e-15);
    }
}

/* How many summits a cut through the middle of rough patches adds, relative to those on it. */
static double gain_of_a_cut(double shortest) {
    static double z[MOST];
    haft_contact_spec spec = spec_of(HAFT_ASPERITY_SUMMITS);
    double gained = 0, total = 0;
    for (uint64_t which = 0; which < 100; which++) {
        answer whole, a, b;
        make_waves(z, 80, 96, 100 + which, shortest, 0x1p-70);
        get_curve(&whole, &spec, z, 80, 96, 5e-9, 0, 1e-8);
        get_curve(&a, &spec, z, 40, 96, 5e-9, 0, 1e-8);
        get_curve(&b, &spec, z + 40 * 96, 40, 96, 5e-9, 0, 1e-8);
        total += whole.number[0];
        gained += 0.5 * (a.number[0] + b.number[0]) - whole.number[0];
    }
    double gain = gained / (total * 2 / 80); /* two rows in eighty are on the cut */
    print_message("shortest wave %4.1f steps: a cut gains %+.3f of the summits on it\n", shortest,
                  gain);
    return gain;
}

static void a_cut_through_roughness_becomes_fair(void **state) {
    (void)state;
    double coarse = gain_of_a_cut(5.7), finer = gain_of_a_cut(9), finest = gain_of_a_cut(14);
    /* Counting every highest point of a border instead gains about +1. */
    assert_true(fabs(coarse) < 0.4 && fabs(finer) < 0.15 && fabs(finest) < 0.06);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cut_keeps_every_summit_once),
        cmocka_unit_test(wet_area_adds_up_over_a_cut),
        cmocka_unit_test(a_cut_through_roughness_becomes_fair),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
