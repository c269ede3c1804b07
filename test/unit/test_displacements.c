/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scaled displacements against a plain loop, for numbers of sites around multiples of the SIMD
 * width and with leading sites left out. */
#include "check.h"

#include "haft/base.h"
#include "solve/displacements.h"

enum { MOST = 80 };

typedef struct displaced {
    double range[MOST], edge[MOST], wide[MOST], far[MOST], wall[MOST], gap[MOST], motion[MOST],
        to[MOST];
    haft_site_lengths lengths;
    haft_displacements by, to_gaps; /* the same displacements, given in the two ways */
} displaced;

/* Random gaps, near and far, and displacements of all sizes. */
static void draw(displaced *s, size_t inert, size_t n, uint64_t which) {
    double z[4];
    for (size_t r = 0; r < MOST; r++) {
        haft_random_normals((haft_random_key){5, HAFT_RANDOM_TEST}, which, r, 0, 4, z);
        s->range[r] = 1e-9 * exp(z[0]);
        s->edge[r] = 1.7e-8;
        s->wide[r] = s->range[r] * (r % 3 == 0 ? 30 : 1);
        s->far[r] = 2e-8;
        s->wall[r] = 1.5e-8;
        s->gap[r] = s->far[r] + 1e-8 * z[1];
        s->motion[r] = 1e-9 * z[2] * exp(z[3]);
        s->to[r] = s->gap[r] + s->motion[r];
    }
    s->lengths = (haft_site_lengths){s->range, s->edge, s->wide, s->far, s->wall};
    s->by = (haft_displacements){&s->lengths, inert, n, s->gap, s->motion, NULL};
    s->to_gaps = (haft_displacements){&s->lengths, inert, n, s->gap, NULL, s->to};
}

static double length_of(const displaced *s, size_t r) {
    double past = fmax(s->gap[r] - s->edge[r], 0), beyond = fmax(s->gap[r] - s->far[r], 0);
    return fmin(s->range[r] + past, s->wide[r]) + beyond;
}

static double step_length_of(const displaced *s, size_t r) {
    return length_of(s, r) + fmax(s->wall[r] - s->gap[r], 0); /* the gap is before the edge then */
}

static void the_largest_displacement_is_found(void **state) {
    (void)state;
    for (size_t n = 1; n <= 60; n++) {
        for (size_t inert = 0; inert < n && inert < 11; inert++) {
            displaced s;
            draw(&s, inert, n, 100 * n + inert);
            double most = 0, way = 0;
            size_t whose = MOST;
            for (size_t r = inert; r < n; r++) {
                double share = fabs(s.motion[r]) / step_length_of(&s, r);
                whose = share > most ? r : whose;
                most = fmax(most, share);
                way = fmax(way, fabs(s.to[r] - s.gap[r]) / length_of(&s, r));
            }
            assert_true(haft_displacements_largest_step(&s.by) == most);
            assert_int_equal(haft_displacements_find_step(&s.by, most), whose);
            assert_true(haft_displacements_largest(&s.to_gaps) == way);
        }
    }
}

static void zero_and_nan_do_not_count(void **state) {
    (void)state;
    for (size_t r = 3; r < 39; r++) { /* in whole vectors and in the rest */
        displaced s;
        draw(&s, 3, 40, 1);
        memset(s.motion, 0, sizeof s.motion);
        assert_true(haft_displacements_largest_step(&s.by) == 0);
        s.motion[r] = NAN; /* passed over: its cause is reported elsewhere */
        s.motion[r + 1] = -1e-9;
        double largest = haft_displacements_largest_step(&s.by);
        assert_true(largest == 1e-9 / step_length_of(&s, r + 1));
        assert_int_equal(haft_displacements_find_step(&s.by, largest), r + 1);
    }
}

static void the_last_large_one_is_found(void **state) {
    (void)state;
    for (size_t n = 4; n <= 60; n++) {
        displaced s;
        draw(&s, 3, n, n);
        for (double least = 1e-3; least < 30; least *= 1.7) {
            size_t moved = 3;
            for (size_t r = 3; r < n; r++) {
                moved = fabs(s.to[r] - s.gap[r]) > least * length_of(&s, r) ? r + 1 : moved;
            }
            assert_int_equal(haft_displacements_count(&s.to_gaps, least), moved);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_displacement_is_found),
        cmocka_unit_test(zero_and_nan_do_not_count),
        cmocka_unit_test(the_last_large_one_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
