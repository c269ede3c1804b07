/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact curves: published figures, refusals, symmetries, and a plain reckoning, distance
 * by distance, that the fast one must equal. */
#include "rough_patch.h"

static void capillary_gives_the_published_figures(void **state) {
    (void)state;
    haft_capillary_spec spec = {
        .humidity = 0.85, .temperature = 300, .surface_energy = 0.072, .molar_volume = 0.018e-3};
    haft_capillary c;
    haft_error error = {0};
    check_ok(haft_capillary_from_spec(&c, &spec, &error), error);
    /* With the printed 0.53 nm, which is 0.5196 rounded up, this would be 6.52 nm. */
    check_relative(c.range, -2 * 0.53e-9 / log(0.85), 0.025);
    check_relative(c.range, 6.394e-9, 1e-4);
    check_near(c.pressure, -22.5e6, 0.1e6);
    check_relative(c.kelvin_radius * c.pressure, 0.072, 1e-14);
    spec.contact_angle_1 = M_PI / 3;
    double range = c.range;
    check_ok(haft_capillary_from_spec(&c, &spec, &error), error);
    check_relative(c.range, 0.75 * range, 1e-14);
    spec.contact_angle_2 = M_PI / 3;
    check_ok(haft_capillary_from_spec(&c, &spec, &error), error);
    check_relative(c.range, 0.5 * range, 1e-14);
}

static void capillary_refuses_what_has_no_menisci(void **state) {
    (void)state;
    const haft_capillary_spec good = {0.85, 300, 0.072, 18e-6, 0, 0};
    static const double bad[6][3] = {{0, 1, NAN},  {0, -1, INFINITY},     {0, -1, NAN},
                                     {0, -1, NAN}, {-0.1, M_PI / 2, NAN}, {-0.1, 2, NAN}};
    for (int field = 0; field < 6; field++) {
        for (int k = 0; k < 3; k++) {
            haft_capillary_spec spec = good;
            double *const fields[6] = {&spec.humidity,        &spec.temperature,
                                       &spec.surface_energy,  &spec.molar_volume,
                                       &spec.contact_angle_1, &spec.contact_angle_2};
            *fields[field] = bad[field][k];
            haft_capillary c;
            haft_error error = {0};
            assert_int_equal(haft_capillary_from_spec(&c, &spec, &error), HAFT_ERROR_INPUT);
            assert_true(strlen(error.message) > 20);
        }
    }
}

static void modulus_of_two_bodies(void **state) {
    (void)state;
    check_relative(haft_contact_modulus(163e9, 0, 163e9, 0), 81.5e9, 1e-14);
    check_relative(haft_contact_modulus(100e9, 0.5, INFINITY, 0.3), 100e9 / 0.75, 1e-14);
}

static void bad_arguments_are_refused(void **state) {
    (void)state;
    static double z[MOST];
    make_patch(z, 20, 30, 1, 0x1p-60);
    haft_error error = {0};
    haft_contact_work *work = NULL;
    assert_int_equal(haft_contact_work_create(&work, 2, 30, &error), HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_contact_work_create(&work, SIZE_MAX / 2, 30, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_null(work);
    check_ok(haft_contact_work_create(&work, 20, 30, &error), error);
    double d[6] = {0, 1e-9, 2e-9, 3e-9, 4e-9, 5e-9}, f[6];
    haft_curve curve = {.n = 6, .distance = d, .force = f};
    haft_contact_spec spec = wet_spec;
#define TRY(rows, columns, step)                                                                   \
    haft_contact_curve(work, &spec, z, rows, columns, step, &curve, &error)
    check_ok(TRY(20, 30, 5e-9), error);
    assert_int_equal(TRY(21, 30, 5e-9), HAFT_ERROR_ARGUMENT);
    assert_int_equal(TRY(20, 2, 5e-9), HAFT_ERROR_ARGUMENT);
    assert_int_equal(TRY(20, 30, 0), HAFT_ERROR_ARGUMENT);
    d[3] = 3.01e-9;
    assert_int_equal(TRY(20, 30, 5e-9), HAFT_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "distance 3"));
    d[3] = NAN;
    assert_int_equal(TRY(20, 30, 5e-9), HAFT_ERROR_ARGUMENT);
    d[3] = 3e-9;
    d[5] = -5e-9;
    assert_int_equal(TRY(20, 30, 5e-9), HAFT_ERROR_ARGUMENT);
    d[5] = 5e-9;
    curve.n = 1;
    assert_int_equal(TRY(20, 30, 5e-9), HAFT_ERROR_ARGUMENT);
    curve.n = 6;
    spec.pressure = 1;
    assert_int_equal(TRY(20, 30, 5e-9), HAFT_ERROR_ARGUMENT);
    spec = wet_spec;
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int k = 0; k < 3; k++) {
        double good = z[7 * 30 + 11];
        z[7 * 30 + 11] = bad[k];
        assert_int_equal(TRY(20, 30, 5e-9), HAFT_ERROR_INPUT);
        assert_non_null(strstr(error.message, "row 7"));
        z[7 * 30 + 11] = good;
    }
    check_ok(TRY(20, 30, 5e-9), error);
#undef TRY
    haft_contact_work_destroy(&work);
    haft_contact_work_destroy(NULL);
}

/* ---- the plain reckoning -----------------------------------------------------------------------
 */

typedef struct sums {
    double push, area, number;
} sums;

/* Islands of so many points or more by flood fill. */
static sums flood(const double *z, int rows, int columns, double step, double d, int least) {
    static int stack[MOST], seen[MOST];
    memset(seen, 0, sizeof seen);
    sums s = {0};
    for (int start = 0; start < rows * columns; start++) {
        if (seen[start] || !(z[start] > d)) {
            continue;
        }
        int top = 0, count = 0;
        double volume = 0;
        stack[top++] = start;
        seen[start] = 1;
        while (top > 0) {
            int p = stack[--top], i = p / columns, j = p % columns;
            count++;
            volume += (z[p] - d) * step * step;
            for (int q = 0; q < 9; q++) {
                int a = i + q / 3 - 1, b = j + q % 3 - 1, o = a * columns + b;
                if (a >= 0 && a < rows && b >= 0 && b < columns && !seen[o] && z[o] > d) {
                    seen[o] = 1;
                    stack[top++] = o;
                }
            }
        }
        if (count < least) {
            continue;
        }
        double area = count * step * step;
        double depth = 2 * volume / area, radius = area * area / (4 * M_PI * volume);
        s.push += sqrt(radius) * pow(depth, 1.5);
        s.area += M_PI * radius * depth;
        s.number++;
    }
    return s;
}

static bool is_summit(const double *z, int rows, int columns, int i, int j) {
    for (int a = i - 1; a <= i + 1; a++) {
        for (int b = j - 1; b <= j + 1; b++) {
            int o = a * columns + b, p = i * columns + j;
            if (a >= 0 && a < rows && b >= 0 && b < columns &&
                (z[o] > z[p] || (z[o] == z[p] && o < p))) {
                return false;
            }
        }
    }
    return true;
}

/* The quadratic c0 + c1 x + c2 y + c3 x^2 + c4 xy + c5 y^2 about a sample, from Lagrange's
 * parabolas through three points an axis: at -1, 0, 1, or at a border at 0 and the two steps
 * inwards. */
static void lagrange(int side, double value[3], double slope[3], double bend[3], int at[3]) {
    for (int k = 0; k < 3; k++) {
        at[k] = side == 0 ? k - 1 : k * side;
    }
    for (int k = 0; k < 3; k++) {
        double a = at[(k + 1) % 3], b = at[(k + 2) % 3], scale = (at[k] - a) * (at[k] - b);
        value[k] = a * b / scale;
        slope[k] = -(a + b) / scale;
        bend[k] = 2 / scale;
    }
}

/* Summits one by one, after the rules in words. */
static sums search(const double *z, int rows, int columns, double step, double d, double lowest) {
    sums s = {0};
    for (int i = 0; i < rows; i++) {
        for (int j = 0; j < columns; j++) {
            if (!(z[i * columns + j] > lowest) || !is_summit(z, rows, columns, i, j)) {
                continue;
            }
            int si = i == 0          ? 1
                     : i == rows - 1 ? -1
                                     : 0,
                sj = j == 0             ? 1
                     : j == columns - 1 ? -1
                                        : 0;
            double vi[3], di[3], ddi[3], vj[3], dj[3], ddj[3], gx = 0, gy = 0, xx = 0, yy = 0,
                                                               xy = 0;
            int ai[3], aj[3];
            lagrange(si, vi, di, ddi, ai);
            lagrange(sj, vj, dj, ddj, aj);
            for (int k = 0; k < 3; k++) {
                for (int l = 0; l < 3; l++) {
                    double h = z[(i + ai[k]) * columns + j + aj[l]] - z[i * columns + j];
                    gx += vi[k] * dj[l] * h, gy += di[k] * vj[l] * h;
                    xx += vi[k] * ddj[l] * h, yy += ddi[k] * vj[l] * h, xy += di[k] * dj[l] * h;
                }
            }
            double det = xx * yy - xy * xy;
            double x = -(yy * gx - xy * gy) / det, y = -(xx * gy - xy * gx) / det;
            if (!(xx < 0 && det > 0) || fabs(x) > 1 || fabs(y) > 1) {
                x = xx < 0 ? -gx / xx : 0;
                y = yy < 0 ? -gy / yy : 0;
            }
            bool beyond = (si != 0 && (xx != 0 || yy != 0) && (yy >= 0 || si * y < -0.5)) ||
                          (sj != 0 && (xx != 0 || yy != 0) && (xx >= 0 || sj * x < -0.5));
            double depth = z[i * columns + j] + (gx * x + gy * y) / 2 - d;
            double flat = 1e3 * step * hypot(rows, columns);
            double radius = fmin(xx + yy < 0 ? -2 * step * step / (xx + yy) : flat, flat);
            if (depth > 0 && !beyond) {
                s.push += sqrt(radius) * pow(depth, 1.5);
                s.area += M_PI * radius * depth;
                s.number++;
            }
        }
    }
    return s;
}

static void check_against_plain(const double *z, int rows, int columns, haft_asperity_model model) {
    const double step = 5e-9, nominal = rows * columns * step * step;
    haft_contact_spec spec = spec_of(model);
    answer a;
    get_curve(&a, &spec, z, (size_t)rows, (size_t)columns, step, -0x1p-29, 23 * 0x1p-31);
    for (int k = 0; k < LEVELS; k++) {
        double d = a.distance[k];
        sums s = model == HAFT_ASPERITY_SUMMITS
                     ? search(z, rows, columns, step, d, a.distance[0])
                     : flood(z, rows, columns, step, d, model == HAFT_ASPERITY_FITTED ? 3 : 1);
        int wet = 0;
        for (int p = 0; p < rows * columns; p++) {
            wet += z[p] > d - spec.capillary_range;
        }
        double share = wet / (double)(rows * columns), contact = s.area / nominal;
        assert_true(a.wet[k] == share);
        check_near(a.number[k] * nominal, s.number, 1e-9);
        check_near(a.contact[k], contact, 1e-11 * contact);
        double push = 4.0 / 3 * spec.modulus * s.push / nominal;
        double pull = spec.pressure * fmax(share - contact, 0);
        check_near(a.force[k], push + pull, 1e-11 * (push - pull));
    }
    assert_true(a.number[LEVELS / 2] > 0);
}

static void curves_equal_the_plain_reckoning(void **state) {
    (void)state;
    static double z[MOST];
    static const double quanta[] = {0x1p-60, 0x1p-33, 0x1p-31}; /* none, some and many ties */
    for (uint64_t which = 0; which < 12; which++) {
        int rows = which == 11 ? 3 : 70, columns = 96 - (int)which;
        make_patch(z, (size_t)rows, (size_t)columns, which, quanta[which % 3]);
        check_against_plain(z, rows, columns, HAFT_ASPERITY_ISLANDS);
        check_against_plain(z, rows, columns, HAFT_ASPERITY_FITTED);
        check_against_plain(z, rows, columns, HAFT_ASPERITY_SUMMITS);
    }
}

/* Heights on the distances, and a bit above and below, on grids as uneven as is allowed. */
static void heights_on_a_distance_are_told_exactly(void **state) {
    (void)state;
    static double z[3 * 3 * LEVELS];
    haft_contact_spec spec = spec_of(HAFT_ASPERITY_ISLANDS);
    spec.capillary_range = 0;
    haft_contact_work *work = NULL;
    haft_error error = {0};
    check_ok(haft_contact_work_create(&work, 3 * LEVELS, 3, &error), error);
    for (int grid = 1; grid < 200; grid++) {
        answer a;
        a.curve = (haft_curve){LEVELS, a.distance, a.force, a.contact, a.wet, a.number};
        for (int k = 0; k < LEVELS; k++) {
            double uneven = k == 0 || k == LEVELS - 1 ? 0 : 9e-7 * sin(grid * k);
            double d = -1.7e-9 + 0.13e-12 * grid * (k + uneven);
            a.distance[k] = d;
            for (int p = 0; p < 9; p++) {
                z[9 * k + p] = p % 3 == 0 ? d : nextafter(d, p % 3 == 1 ? 1 : -1);
            }
        }
        check_ok(haft_contact_curve(work, &spec, z, 3 * LEVELS, 3, 5e-9, &a.curve, &error), error);
        for (int k = 0; k < LEVELS; k++) { /* all on the higher levels, and 3 of 9 on this one */
            assert_true(a.wet[k] == (9.0 * (LEVELS - 1 - k) + 3) / (9.0 * LEVELS));
            check_near(a.contact[k], 0.5 * a.wet[k], 1e-15);
        }
    }
    haft_contact_work_destroy(&work);
}

/* ---- symmetries --------------------------------------------------------------------------------
 */

static void check_same(const answer *a, const answer *b, double force, double density) {
    for (int k = 0; k < LEVELS; k++) {
        double size = fabs(a->force[k]) - wet_spec.pressure * a->wet[k];
        assert_true(a->wet[k] == b->wet[k]);
        check_near(b->force[k], a->force[k], force * size);
        check_near(b->contact[k], a->contact[k], force * a->contact[k]);
        check_near(b->number[k] * density, a->number[k], 1e-12 * a->number[k]);
    }
}

static void curves_know_no_direction(void **state) {
    (void)state;
    static double z[MOST], turned[MOST];
    const int rows = 80, columns = 96;
    make_patch(z, rows, columns, 5, 0x1p-70);
    for (int model = HAFT_ASPERITY_SUMMITS; model <= HAFT_ASPERITY_FITTED; model++) {
        haft_contact_spec spec = spec_of(model);
        answer a, b;
        get_curve(&a, &spec, z, rows, columns, 5e-9, -2e-9, 1e-8);
        for (int way = 1; way < 8; way++) { /* bits: mirror rows, mirror columns, transpose */
            for (int i = 0; i < rows; i++) {
                for (int j = 0; j < columns; j++) {
                    int u = way & 1 ? rows - 1 - i : i, v = way & 2 ? columns - 1 - j : j;
                    turned[way & 4 ? v * rows + u : u * columns + v] = z[i * columns + j];
                }
            }
            get_curve(&b, &spec, turned, way & 4 ? columns : rows, way & 4 ? rows : columns, 5e-9,
                      -2e-9, 1e-8);
            check_same(&a, &b, 1e-9, 1);
        }
    }
}

static void curves_shift_and_scale(void **state) {
    (void)state;
    static double z[MOST], other[MOST];
    const int rows = 64, columns = 70;
    make_patch(z, rows, columns, 6, 0x1p-55);
    for (int model = HAFT_ASPERITY_SUMMITS; model <= HAFT_ASPERITY_FITTED; model++) {
        haft_contact_spec spec = spec_of(model);
        answer a, b;
        const double low = -0x1p-29, high = 19 * 0x1p-31; /* 23 steps of 2^-31, exact */
        get_curve(&a, &spec, z, rows, columns, 5e-9, low, high);
        for (int p = 0; p < rows * columns; p++) {
            other[p] = z[p] + 0x1p-26;
        }
        get_curve(&b, &spec, other, rows, columns, 5e-9, low + 0x1p-26, high + 0x1p-26);
        check_same(&a, &b, 1e-10, 1);
        for (int p = 0; p < rows * columns; p++) {
            other[p] = 2 * z[p];
        }
        haft_contact_spec twice = spec;
        twice.capillary_range *= 2;
        get_curve(&b, &twice, other, rows, columns, 1e-8, 2 * low, 2 * high);
        check_same(&a, &b, 1e-13, 4);
        twice = spec;
        twice.modulus *= 2;
        twice.pressure *= 2;
        get_curve(&b, &twice, z, rows, columns, 5e-9, low, high);
        for (int k = 0; k < LEVELS; k++) {
            check_near(b.force[k], 2 * a.force[k], 1e-13 * fabs(a.force[k]));
        }
    }
}

static void without_water_it_only_pushes(void **state) {
    (void)state;
    static double z[MOST];
    make_patch(z, 60, 60, 8, 0x1p-60);
    for (int model = HAFT_ASPERITY_SUMMITS; model <= HAFT_ASPERITY_FITTED; model++) {
        haft_contact_spec spec = spec_of(model);
        spec.has_capillary = false;
        answer a;
        get_curve(&a, &spec, z, 60, 60, 5e-9, -2e-9, 1.6e-8);
        for (int k = 0; k < LEVELS; k++) {
            assert_true(a.force[k] >= 0 && a.wet[k] == 0);
            /* merging islands push less than apart, so only summits push ever more */
            assert_true(model != HAFT_ASPERITY_SUMMITS || k == 0 || a.force[k] <= a.force[k - 1]);
        }
        assert_true(a.force[0] > 0 && a.force[LEVELS - 1] == 0);
        assert_false(haft_contact_zero_force(&a.curve).found);
    }
}

static void a_flat_patch_pushes(void **state) {
    (void)state;
    static double z[30 * 30];
    for (int model = HAFT_ASPERITY_SUMMITS; model <= HAFT_ASPERITY_FITTED; model++) {
        haft_contact_spec spec = spec_of(model);
        answer a;
        get_curve(&a, &spec, z, 30, 30, 5e-9, -1e-9, 1e-8);
        assert_true(a.force[0] > 0 && isfinite(a.force[0]));
        assert_true(a.wet[0] == 1 && a.wet[LEVELS - 1] == 0);
        assert_true(a.number[0] > 0 && a.number[LEVELS - 1] == 0);
    }
}

static void zero_force_lies_beside_the_greatest_pull(void **state) {
    (void)state;
    double d[] = {0, 1, 2, 3, 4, 5, 6}, contact[] = {6, 5, 4, 3, 2, 1, 0};
    double wet[] = {1, 1, 1, 2, 3, 4, 5}, number[] = {9, 8, 7, 6, 5, 4, 3};
    double f[] = {5, -1, 2, 1, -3, -1, 0};
    haft_curve curve = {7, d, f, contact, wet, number};
    haft_zero_force zero = haft_contact_zero_force(&curve);
    assert_true(zero.found);
    check_relative(zero.distance, 3.25, 1e-15);
    check_relative(zero.contact_area, 2.75, 1e-15);
    check_relative(zero.wet_area, 2.25, 1e-15);
    check_relative(zero.asperities, 5.75, 1e-15);
    f[2] = 3, f[3] = 0; /* exactly on a point */
    check_relative(haft_contact_zero_force(&curve).distance, 3.0, 1e-15);
    f[2] = -1; /* back from the zero it pulls: that is no change of sign */
    check_relative(haft_contact_zero_force(&curve).distance, 5.0 / 6, 1e-15);
    double lone[] = {5, -1, -3, -1, 1, -1, 0}; /* an asperity that pushes alone far out */
    haft_curve other = {7, d, lone, contact, wet, number};
    check_relative(haft_contact_zero_force(&other).distance, 5.0 / 6, 1e-15);
    f[0] = -1;
    assert_false(haft_contact_zero_force(&curve).found);
}

/* Curves asked for together have the bits of those asked for alone, whatever they share: their
 * asperities where the water alone differs, nothing else. */
static void curves_together_are_those_alone(void **state) {
    (void)state;
    enum { CURVES = 11, ROWS = 60, COLUMNS = 70 };
    static double z[MOST];
    make_patch(z, ROWS, COLUMNS, 5, 0x1p-60);
    haft_error error = {0};
    haft_maugis_table *maugis = NULL;
    check_ok(haft_maugis_table_create(&maugis, &error), error);
    haft_contact_spec spec[CURVES];
    double low[CURVES];
    for (int i = 0; i < CURVES; i++) {
        spec[i] = spec_of(HAFT_ASPERITY_ISLANDS);
        spec[i].vdw = (haft_vdw){0.17, 0.17 / 0.23e-9, 0.23e-9};
        spec[i].maugis = maugis;
        low[i] = 2e-9;
    }
    spec[1].pressure = -50e6, spec[1].capillary_range = 2e-9; /* shares all with 0 */
    spec[2].has_capillary = false;                            /* so does this */
    spec[3].has_vdw = true;
    spec[4].asperities = HAFT_ASPERITY_SUMMITS;
    spec[5].has_vdw = true, spec[5].capillary_range = 1e-9; /* with 3 */
    spec[6].modulus = 70e9;
    low[7] = 2.5e-9;
    spec[8].has_vdw = true, spec[8].vdw.energy = 0.1;
    spec[9].has_vdw = true, spec[9].asperities = HAFT_ASPERITY_SUMMITS;
    spec[10] = spec[9], spec[10].path = HAFT_VDW_APPROACH;
    answer together[CURVES], alone;
    haft_curve curve[CURVES];
    haft_contact_work *work = NULL;
    check_ok(haft_contact_work_create(&work, ROWS, COLUMNS, &error), error);
    for (int i = 0; i < CURVES; i++) {
        get_curve(&together[i], &spec[i], z, ROWS, COLUMNS, 5e-9, low[i], 14e-9);
        memset(together[i].force, 0, sizeof together[i].force);
        curve[i] = together[i].curve;
    }
    check_ok(haft_contact_curves(work, CURVES, spec, z, ROWS, COLUMNS, 5e-9, curve, &error), error);
    for (int i = 0; i < CURVES; i++) {
        get_curve(&alone, &spec[i], z, ROWS, COLUMNS, 5e-9, low[i], 14e-9);
        assert_memory_equal(together[i].force, alone.force, sizeof alone.force);
        assert_memory_equal(together[i].contact, alone.contact, sizeof alone.contact);
        assert_memory_equal(together[i].wet, alone.wet, sizeof alone.wet);
        assert_memory_equal(together[i].number, alone.number, sizeof alone.number);
        for (int j = 0; j < i; j++) { /* each spec tells in its own way */
            assert_memory_not_equal(together[i].force, together[j].force, sizeof alone.force);
        }
    }
    spec[8].vdw.range = -1;
    assert_int_equal(haft_contact_curves(work, CURVES, spec, z, ROWS, COLUMNS, 5e-9, curve, &error),
                     HAFT_ERROR_ARGUMENT);
    haft_contact_work_destroy(&work);
    haft_maugis_table_destroy(&maugis);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(capillary_gives_the_published_figures),
        cmocka_unit_test(capillary_refuses_what_has_no_menisci),
        cmocka_unit_test(modulus_of_two_bodies),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(curves_equal_the_plain_reckoning),
        cmocka_unit_test(heights_on_a_distance_are_told_exactly),
        cmocka_unit_test(curves_together_are_those_alone),
        cmocka_unit_test(curves_know_no_direction),
        cmocka_unit_test(curves_shift_and_scale),
        cmocka_unit_test(without_water_it_only_pushes),
        cmocka_unit_test(a_flat_patch_pushes),
        cmocka_unit_test(zero_force_lies_beside_the_greatest_pull),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
