/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patches with van der Waals forces: sparse caps against one Maugis sphere each, touching or not;
 * the rigid limit on a rough patch, which is the stress times the area in range; menisci beside. */
#include "rough_patch.h"

enum { SIDE = 80 };
static const double step = 5e-9, modulus = 85.6e9;
static const haft_vdw dry = {.energy = 0.1662, .stress = 0.1662 / 0.2276e-9, .range = 0.2276e-9};

static haft_maugis_table *table;

static int make_table(void **state) {
    (void)state;
    haft_error error = {0};
    return haft_maugis_table_create(&table, &error) == HAFT_OK ? 0 : -1;
}

static int drop_table(void **state) {
    (void)state;
    haft_maugis_table_destroy(&table);
    return 0;
}

static haft_contact_spec dry_spec(haft_asperity_model model) {
    return (haft_contact_spec){
        .asperities = model, .modulus = modulus, .has_vdw = true, .vdw = dry, .maugis = table};
}

/* Force and contact area of one sphere by the direct solution, in SI. */
static double sphere(double radius, double depth, haft_vdw_path path, double *area) {
    double w = dry.energy, e = modulus;
    double unit = cbrt(9 * M_PI * M_PI * w * w * radius / (16 * e * e));
    haft_maugis m;
    haft_error error = {0};
    check_ok(haft_maugis_solve(&m, dry.stress * cbrt(9 * radius / (2 * M_PI * w * e * e)),
                               depth / unit, path, &error),
             error);
    *area = M_PI * radius * unit * m.radius * m.radius;
    return M_PI * w * radius * m.force;
}

typedef struct cap {
    int row, column;
    double height, radius;
} cap;

static const cap caps[3] = {
    {20, 21, 9.3e-9, 150e-9}, {55, 24, 9.0e-9, 400e-9}, {40, 60, 8.6e-9, 90e-9}};

static void make_caps(double *z) {
    for (int i = 0; i < SIDE; i++) {
        for (int j = 0; j < SIDE; j++) {
            double best = -1e-6;
            for (int k = 0; k < 3; k++) {
                double x = (j - caps[k].column) * step, y = (i - caps[k].row) * step;
                best = fmax(best, caps[k].height - (x * x + y * y) / (2 * caps[k].radius));
            }
            z[i * SIDE + j] = best;
        }
    }
}

static void summits_are_maugis_spheres(void **state) {
    (void)state;
    static double z[MOST];
    make_caps(z);
    for (int path = 0; path < 2; path++) {
        haft_contact_spec spec = dry_spec(HAFT_ASPERITY_SUMMITS);
        spec.path = (haft_vdw_path)path;
        answer a;
        get_curve(&a, &spec, z, SIDE, SIDE, step, 8.9e-9, 9.7e-9);
        double nominal = SIDE * SIDE * step * step;
        int pulling = 0;
        for (int i = 0; i < LEVELS; i++) {
            double force = 0, contact = 0, scale = 0;
            int touching = 0;
            for (int k = 0; k < 3; k++) {
                double area, f = sphere(caps[k].radius, caps[k].height - a.distance[i],
                                        (haft_vdw_path)path, &area);
                force += f;
                scale += M_PI * dry.energy * caps[k].radius;
                contact += area;
                touching += area > 0;
            }
            check_near(a.force[i], force / nominal, 1e-8 * scale / nominal);
            check_near(a.contact[i], contact / nominal, 1e-7 * contact / nominal);
            check_near(a.number[i] * nominal, (double)touching, 1e-9);
            pulling += force < 0 && touching == 0;
        }
        assert_true(pulling > 2); /* distances at which none touches, yet all in all they pull */
    }
}

static void beyond_reach_there_is_nothing(void **state) {
    (void)state;
    static double z[MOST];
    make_caps(z);
    for (int model = HAFT_ASPERITY_SUMMITS; model <= HAFT_ASPERITY_FITTED; model++) {
        haft_contact_spec spec = dry_spec((haft_asperity_model)model);
        answer a;
        get_curve(&a, &spec, z, SIDE, SIDE, step, 9.7e-9, 12e-9);
        for (int i = 0; i < LEVELS; i++) {
            assert_true(a.force[i] == 0 && a.contact[i] == 0 && a.number[i] == 0);
        }
    }
}

/* The lowest distance of a curve changes nothing above it; of summits, nothing further above than
 * an apex can lie over its sample, which must be above the lowest distance less the reach. */
static void curves_do_not_depend_on_where_they_begin(void **state) {
    (void)state;
    static double z[MOST];
    make_patch(z, 70, 80, 3, 0x1p-60);
    for (int model = HAFT_ASPERITY_SUMMITS; model <= HAFT_ASPERITY_FITTED; model++) {
        haft_contact_spec spec = dry_spec((haft_asperity_model)model);
        answer low, high;
        get_curve(&low, &spec, z, 70, 80, step, 4e-9, 4e-9 + 2e-10 * (LEVELS - 1));
        get_curve(&high, &spec, z, 70, 80, step, 6e-9, 6e-9 + 2e-10 * (LEVELS - 1));
        for (int i = model == HAFT_ASPERITY_SUMMITS ? 4 : 0; i + 10 < LEVELS; i++) {
            check_near(low.distance[i + 10], high.distance[i], 1e-22);
            double scale = fabs(high.force[i]) + 1e3;
            double tolerance = model == HAFT_ASPERITY_FITTED ? 1e-9 : 1e-12; /* radii unbounded */
            check_near(low.force[i + 10], high.force[i], tolerance * scale);
        }
    }
}

/* A rigid body's attraction is the stress over the area in range, whatever the shapes; islands have
 * it exactly as long as none touches. */
static void rigid_islands_pull_with_their_area(void **state) {
    (void)state;
    static double z[MOST];
    make_patch(z, 70, 80, 5, 0x1p-60);
    double top = -INFINITY;
    for (int p = 0; p < 70 * 80; p++) {
        top = fmax(top, z[p]);
    }
    haft_contact_spec spec = dry_spec(HAFT_ASPERITY_ISLANDS);
    spec.modulus = 20 * modulus;
    spec.vdw.range = 3e-9; /* many islands in range, none touching */
    spec.vdw.energy = spec.vdw.stress * spec.vdw.range;
    answer a;
    get_curve(&a, &spec, z, 70, 80, step, top + 1.5e-9, top + 3.5e-9);
    for (int i = 0; i < LEVELS; i++) {
        int inside = 0;
        for (int p = 0; p < 70 * 80; p++) {
            inside += a.distance[i] - z[p] < spec.vdw.range;
        }
        check_near(a.force[i], -spec.vdw.stress * inside / (70.0 * 80), 1e-9 * spec.vdw.stress);
        assert_true(a.contact[i] == 0);
        assert_true(i > 3 || inside > 3);
    }
}

/* Islands of one, two and three points a little above the level, far apart: fitted, the third alone
 * counts, with the pull of its whole sphere; else each has at most the stress over its points. */
static void fitted_islands_pull_as_their_spheres(void **state) {
    (void)state;
    static double z[MOST];
    const double nominal = SIDE * SIDE * step * step, point = step * step, top = 9e-9;
    for (int p = 0; p < SIDE * SIDE; p++) {
        z[p] = -1e-6;
    }
    z[10 * SIDE + 10] = z[40 * SIDE + 10] = z[40 * SIDE + 11] = top;
    z[10 * SIDE + 50] = z[11 * SIDE + 51] = z[12 * SIDE + 51] = top;
    haft_contact_spec spec = dry_spec(HAFT_ASPERITY_FITTED), bounded = spec;
    bounded.asperities = HAFT_ASPERITY_ISLANDS;
    answer fitted, islands;
    double from = top + 0.3 * dry.range, to = top + 0.99 * dry.range;
    get_curve(&fitted, &spec, z, SIDE, SIDE, step, from, to);
    get_curve(&islands, &bounded, z, SIDE, SIDE, step, from, to);
    for (int i = 0; i < LEVELS; i++) {
        double depth = top - fitted.distance[i] + dry.range, area;
        double force = sphere(3 * point / (4 * M_PI * depth), 2 * depth - dry.range,
                              HAFT_VDW_SEPARATION, &area);
        check_near(fitted.force[i] * nominal, force, 1e-7 * fabs(force));
        check_near(fitted.contact[i] * nominal, fmin(area, 3 * point), 1e-6 * area);
        assert_true(islands.force[i] * nominal >= -6 * point * dry.stress * (1 + 1e-12));
    }
    assert_true(fitted.force[LEVELS - 1] * nominal < -10 * 3 * point * dry.stress); /* unbounded */
}

/* Islands on fine samples of sparse caps come to the spheres. */
static void fine_islands_come_to_the_spheres(void **state) {
    (void)state;
    static double z[MOST];
    const double fine = 0.4e-9, radius = 150e-9, top = 9.3e-9;
    for (int i = 0; i < SIDE; i++) {
        for (int j = 0; j < SIDE; j++) {
            double x = (j - 39.3) * fine, y = (i - 39.6) * fine;
            z[i * SIDE + j] = top - (x * x + y * y) / (2 * radius);
        }
    }
    haft_contact_spec spec = dry_spec(HAFT_ASPERITY_ISLANDS);
    answer a;
    get_curve(&a, &spec, z, SIDE, SIDE, fine, 8.8e-9, 9.3e-9);
    double nominal = SIDE * SIDE * fine * fine;
    for (int i = 0; i < LEVELS; i++) {
        double area, force = sphere(radius, top - a.distance[i], HAFT_VDW_SEPARATION, &area);
        check_near(a.force[i] * nominal, force, 0.03 * (M_PI * dry.energy * radius + fabs(force)));
        check_near(a.contact[i] * nominal, area, 0.03 * (area + 1e-17));
    }
}

/* As attraction vanishes a summit is Hertz's; menisci act on what the contact leaves. */
static void forces_add_up(void **state) {
    (void)state;
    static double z[MOST];
    make_patch(z, 70, 80, 7, 0x1p-60);
    haft_contact_spec hertz = {.asperities = HAFT_ASPERITY_SUMMITS, .modulus = modulus};
    haft_contact_spec faint = dry_spec(HAFT_ASPERITY_SUMMITS);
    faint.vdw.energy *= 1e-3;
    faint.vdw.range *= 1e-2;
    faint.vdw.stress = faint.vdw.energy / faint.vdw.range;
    answer a, b;
    get_curve(&a, &hertz, z, 70, 80, step, 3e-9, 6e-9);
    get_curve(&b, &faint, z, 70, 80, step, 3e-9, 6e-9);
    for (int i = 0; i < LEVELS; i++) {
        check_relative(b.force[i], a.force[i], 0.02);
        check_relative(b.contact[i], a.contact[i], 0.02);
    }
    haft_contact_spec both = dry_spec(HAFT_ASPERITY_SUMMITS), alone = both;
    both.has_capillary = true;
    both.pressure = -166e6;
    both.capillary_range = 0.86e-9;
    get_curve(&a, &both, z, 70, 80, step, 3e-9, 9e-9);
    get_curve(&b, &alone, z, 70, 80, step, 3e-9, 9e-9);
    for (int i = 0; i < LEVELS; i++) {
        double menisci = -166e6 * fmax(a.wet[i] - a.contact[i], 0);
        check_near(a.force[i], b.force[i] + menisci, 1e-9 * (fabs(menisci) + fabs(b.force[i])));
        assert_true(a.contact[i] == b.contact[i]);
    }
}

static void bad_specs_are_refused(void **state) {
    (void)state;
    static double z[MOST];
    make_caps(z);
    haft_contact_spec good = dry_spec(HAFT_ASPERITY_SUMMITS);
    answer a;
    haft_error error = {0};
#define TRY(spec) try_curve(&a, &spec, z, SIDE, SIDE, step, 8e-9, 9e-9, &error)
    check_ok(TRY(good), error);
    haft_contact_spec bad = good;
    bad.maugis = NULL;
    assert_int_equal(TRY(bad), HAFT_ERROR_ARGUMENT);
    bad = good;
    bad.vdw.range = -1e-9;
    assert_int_equal(TRY(bad), HAFT_ERROR_ARGUMENT);
    bad = good;
    bad.modulus = 1e3; /* lambda far above the table */
    assert_int_equal(TRY(bad), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "lambda"));
    assert_non_null(strstr(error.message, "0.0001 to 100"));
    bad.modulus = 1e20; /* far below */
    assert_int_equal(TRY(bad), HAFT_ERROR_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(summits_are_maugis_spheres),
        cmocka_unit_test(beyond_reach_there_is_nothing),
        cmocka_unit_test(curves_do_not_depend_on_where_they_begin),
        cmocka_unit_test(rigid_islands_pull_with_their_area),
        cmocka_unit_test(fitted_islands_pull_as_their_spheres),
        cmocka_unit_test(fine_islands_come_to_the_spheres),
        cmocka_unit_test(forces_add_up),
        cmocka_unit_test(bad_specs_are_refused),
    };
    return cmocka_run_group_tests(tests, make_table, drop_table);
}
