/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact curves against closed forms on paraboloids over a deep plane, and the orders at which
 * counted areas converge to them. */
#include "check.h"

#include "haft/contact.h"

enum { LEVELS = 5 };
static const double side = 4e-7; /* of the patch */
static const double modulus = 80e9;

typedef struct cap {
    double x, y, height, radius;
} cap;

static double uniform(uint64_t k, uint64_t j, double low, double high) {
    uint64_t words[4];
    haft_random_words((haft_random_key){19, HAFT_RANDOM_TEST}, k, j, 0, words);
    return low + (high - low) * haft_random_uniform(words[0]);
}

/* n x n points at the middles of their cells. */
static double *make_caps(const cap *caps, int count, size_t n) {
    double *z = malloc(n * n * sizeof *z), step = side / (double)n;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            double best = -1e-6;
            for (int k = 0; k < count; k++) {
                double x = ((double)j + 0.5) * step - caps[k].x;
                double y = ((double)i + 0.5) * step - caps[k].y;
                best = fmax(best, caps[k].height - (x * x + y * y) / (2 * caps[k].radius));
            }
            z[i * n + j] = best;
        }
    }
    return z;
}

typedef struct answer {
    double distance[LEVELS], force[LEVELS], contact[LEVELS], wet[LEVELS], number[LEVELS];
} answer;

static void get_curve(answer *a, haft_asperity_model model, double range, const double *z, size_t n,
                      double low, double high) {
    haft_contact_spec spec = {.asperities = model,
                              .modulus = modulus,
                              .has_capillary = range > 0,
                              .pressure = -22.5e6,
                              .capillary_range = range};
    for (int k = 0; k < LEVELS; k++) {
        a->distance[k] = low + (high - low) * k / (LEVELS - 1);
    }
    haft_curve curve = {LEVELS, a->distance, a->force, a->contact, a->wet, a->number};
    haft_contact_work *work = NULL;
    haft_error error = {0};
    check_ok(haft_contact_work_create(&work, n, n, &error), error);
    check_ok(haft_contact_curve(work, &spec, z, n, n, side / (double)n, &curve, &error), error);
    haft_contact_work_destroy(&work);
}

/* Hertz and Laplace on sparse caps of their own, with discs of water that do not meet. */
static void check_exact(const answer *a, const cap *caps, int count, double range, double force,
                        double area) {
    for (int k = 0; k < LEVELS; k++) {
        double push = 0, contact = 0, wet = 0, number = 0;
        for (int c = 0; c < count; c++) {
            double depth = caps[c].height - a->distance[k];
            if (depth > 0) {
                push += 4.0 / 3 * modulus * sqrt(caps[c].radius) * pow(depth, 1.5);
                contact += M_PI * caps[c].radius * depth;
                number++;
            }
            wet += 2 * M_PI * caps[c].radius * fmax(depth + range, 0);
        }
        wet = range > 0 ? wet : 0;
        double nominal = side * side, pull = range > 0 ? -22.5e6 * (wet - contact) : 0;
        check_near(a->number[k] * nominal, number, 1e-9);
        check_near(a->contact[k], contact / nominal, force * contact / nominal);
        check_near(a->wet[k], wet / nominal, area * wet / nominal);
        check_near(a->force[k], (push + pull) / nominal, (force * push - area * pull) / nominal);
    }
}

static const cap sparse[] = {{7e-8, 8e-8, 1.00e-8, 8e-8},
                             {2.9e-7, 9e-8, 0.90e-8, 1.4e-7},
                             {1.1e-7, 3e-7, 0.95e-8, 1.1e-7},
                             {3.1e-7, 3.05e-7, 1.05e-8, 6e-8}};

/* The quadratic is the paraboloid: no error but rounding, wherever the apex lies on the grid. */
static void summits_are_exact_on_paraboloids(void **state) {
    (void)state;
    for (uint64_t k = 0; k < 60; k++) {
        cap caps[4];
        memcpy(caps, sparse, sizeof caps);
        for (uint64_t c = 0; c < 4; c++) {
            caps[c].x += uniform(k, 2 * c, -1e-8, 1e-8);
            caps[c].y += uniform(k, 2 * c + 1, -1e-8, 1e-8);
        }
        double *z = make_caps(caps, 4, 100);
        answer a;
        get_curve(&a, HAFT_ASPERITY_SUMMITS, 0, z, 100, 7e-9, 1.02e-8);
        check_exact(&a, caps, 4, 0, 1e-9, 0);
        free(z);
    }
}

static void fine_grids_give_force_and_areas_to_a_thousandth(void **state) {
    (void)state;
    double *z = make_caps(sparse, 4, 2400);
    for (int model = HAFT_ASPERITY_SUMMITS; model <= HAFT_ASPERITY_FITTED; model++) {
        answer a;
        get_curve(&a, model, 6.5e-9, z, 2400, 7e-9, 8.6e-9);
        check_exact(&a, sparse, 4, 6.5e-9, 1e-3, 1e-3);
    }
    free(z);
}

/* Two discs of water that meet count once where they overlap: the lens formula. */
static void meeting_menisci_count_once(void **state) {
    (void)state;
    const cap pair[] = {{1.7e-7, 2.1e-7, 1e-8, 1e-7}, {2.4e-7, 1.9e-7, 9e-9, 1.2e-7}};
    double *z = make_caps(pair, 2, 2000), range = 6.5e-9;
    answer a;
    get_curve(&a, HAFT_ASPERITY_SUMMITS, range, z, 2000, 8e-9, 1e-8);
    double apart = hypot(pair[0].x - pair[1].x, pair[0].y - pair[1].y);
    for (int k = 0; k < LEVELS; k++) {
        double r = sqrt(2 * pair[0].radius * (pair[0].height - a.distance[k] + range));
        double s = sqrt(2 * pair[1].radius * (pair[1].height - a.distance[k] + range));
        double p = (apart * apart + r * r - s * s) / (2 * apart), q = apart - p;
        /* No chord where they do not meet. */
        double lens = r + s <= apart ? 0
                                     : r * r * acos(p / r) - p * sqrt(r * r - p * p) +
                                           s * s * acos(q / s) - q * sqrt(s * s - q * q);
        assert_true(k > 0 || lens > 0.01 * r * r);
        double wet = M_PI * (r * r + s * s) - lens;
        check_relative(a.wet[k] * side * side, wet, 1e-3);
    }
    free(z);
}

typedef struct misses {
    double force, area, wet;
} misses;

/* Root mean square relative misses of one cap's island over random places on the grid. */
static misses island_error(size_t n, uint64_t tries) {
    misses m = {0};
    double weight = 1 / (double)(tries * LEVELS), range = 6.5e-9, nominal = side * side;
    for (uint64_t t = 0; t < tries; t++) {
        cap one = {2e-7 + uniform(t, 100, -2e-8, 2e-8), 2e-7 + uniform(t, 101, -2e-8, 2e-8), 1e-8,
                   8e-7 / 2};
        double *z = make_caps(&one, 1, n);
        answer dry, wet;
        get_curve(&dry, HAFT_ASPERITY_ISLANDS, 0, z, n, 5e-9, 6e-9);
        get_curve(&wet, HAFT_ASPERITY_ISLANDS, range, z, n, 1e-8, 1.1e-8);
        free(z);
        for (int k = 0; k < LEVELS; k++) {
            double depth = one.height - dry.distance[k];
            double push = 4.0 / 3 * modulus * sqrt(one.radius) * pow(depth, 1.5) / nominal;
            double area = M_PI * one.radius * depth / nominal;
            double water = 2 * M_PI * one.radius * (one.height - wet.distance[k] + range) / nominal;
            m.force += weight * pow(dry.force[k] / push - 1, 2);
            m.area += weight * pow(dry.contact[k] / area - 1, 2);
            m.wet += weight * pow(wet.wet[k] / water - 1, 2);
        }
    }
    return (misses){sqrt(m.force), sqrt(m.area), sqrt(m.wet)};
}

/* The points in a disc of radius r number pi r^2/h^2 give or take (r/h)^(1/2) (Kendall 1948), so
 * that a counted area misses by h^(3/2); the volume, of a height that vanishes at the rim, by
 * h^(5/2), so that the force takes the area's order, and half its miss. */
static void counted_areas_converge_at_order_three_halves(void **state) {
    (void)state;
    enum { SIZES = 4 };
    double x[SIZES], force[SIZES], area[SIZES], wet[SIZES];
    for (int k = 0; k < SIZES; k++) {
        size_t n = (size_t)40 << k;
        misses m = island_error(n, 200);
        x[k] = -log((double)n);
        force[k] = log(m.force), area[k] = log(m.area), wet[k] = log(m.wet);
        print_message("n %4zu: force %.2e area %.2e wet %.2e\n", n, m.force, m.area, m.wet);
        check_relative(m.force, m.area / 2, 0.1);
    }
    double *const y[] = {force, area, wet};
    for (int q = 0; q < 3; q++) { /* slope of the least-squares line */
        double mx = 0, my = 0, xy = 0, xx = 0;
        for (int k = 0; k < SIZES; k++) {
            mx += x[k] / SIZES, my += y[q][k] / SIZES;
        }
        for (int k = 0; k < SIZES; k++) {
            xy += (x[k] - mx) * (y[q][k] - my), xx += (x[k] - mx) * (x[k] - mx);
        }
        print_message("order %.3f\n", xy / xx);
        check_near(xy / xx, 1.5, 0.1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(summits_are_exact_on_paraboloids),
        cmocka_unit_test(fine_grids_give_force_and_areas_to_a_thousandth),
        cmocka_unit_test(meeting_menisci_count_once),
        cmocka_unit_test(counted_areas_converge_at_order_three_halves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
