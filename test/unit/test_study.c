/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a study by themselves: statistics against GSL's, the laws of a beam out of a set of
 * curves, counts and blocks. */
#include "check.h"

#include "haft/study.h"

#include <gsl/gsl_statistics_double.h>

/* ---- statistics ---- */

static void statistics_take_the_stuck_beams_alone(void **state) {
    (void)state;
    enum { N = 40 };
    haft_case c = {.beam = {.gap = 1.9e-6, .thickness = 2.62e-6, .young_modulus = 163e9}};
    haft_summary row[N];
    double stuck[N], jumps[N], seconds[N];
    double ledger = 0;
    size_t n = 0, run = 0, count[HAFT_OUTCOMES] = {0};
    haft_random_key key = {5, HAFT_RANDOM_TEST};
    for (size_t k = 0; k < N; k++) {
        uint64_t w[4];
        haft_random_words(key, k, 0, 0, w);
        int outcome = (int)(k % 5 == 4 ? (k / 5) % (HAFT_OUTCOMES + 1) : 1) - 1;
        double length = 200e-6 + 30e-6 * (double)w[0] / 0x1p64;
        bool was_run = outcome >= 0;
        row[k] = (haft_summary){.crack_length = outcome == HAFT_OUTCOME_STUCK  ? length
                                                : outcome == HAFT_OUTCOME_FREE ? 600e-6
                                                                               : (double)NAN,
                                .ledger_error = was_run ? 1e-12 * (double)(k + 1) : (double)NAN,
                                .seconds = was_run ? (double)(w[1] % 100) : (double)NAN,
                                .jumps = was_run ? (int)(w[2] % 50) : -1,
                                .unfit = was_run ? 2 : -1,
                                .outcome = outcome};
        if (was_run) {
            jumps[run] = row[k].jumps;
            seconds[run] = row[k].seconds;
            ledger = row[k].ledger_error; /* they grow */
            count[outcome]++;
            run++;
        }
        if (outcome == HAFT_OUTCOME_STUCK) {
            stuck[n++] = length;
        }
    }
    haft_statistics s = haft_study_statistics(&c, row, N);
    assert_true(count[HAFT_OUTCOME_FREE] > 0 && n < run && run < N); /* all sorts are there */
    assert_int_equal(s.run, run);
    assert_int_equal(s.stuck, n);
    assert_int_equal(s.free, count[HAFT_OUTCOME_FREE]);
    assert_int_equal(s.failed, run - n - count[HAFT_OUTCOME_FREE]);
    check_relative(s.mean, gsl_stats_mean(stuck, 1, n), 1e-14);
    check_relative(s.deviation, gsl_stats_sd(stuck, 1, n), 1e-12);
    check_relative(s.standard_error, gsl_stats_sd(stuck, 1, n) / sqrt((double)n), 1e-12);
    assert_true(s.least == gsl_stats_min(stuck, 1, n));
    assert_true(s.greatest == gsl_stats_max(stuck, 1, n));
    check_relative(s.jumps, gsl_stats_mean(jumps, 1, run), 1e-14);
    check_relative(s.seconds, gsl_stats_mean(seconds, 1, run), 1e-14);
    assert_int_equal(s.unfit, 2 * run);
    check_relative(s.ledger_error, ledger, 1e-12);
    check_relative(s.gamma, 1.5 * 163e9 * pow(1.9e-6, 2) * pow(2.62e-6, 3) / pow(s.mean, 4), 1e-12);
}

static void statistics_of_few_beams_are_no_numbers(void **state) {
    (void)state;
    haft_case c = {.beam = {.gap = 1.9e-6, .thickness = 2.62e-6, .young_modulus = 163e9}};
    haft_summary row[3] = {{.crack_length = NAN, .outcome = -1},
                           {.crack_length = 600e-6, .outcome = HAFT_OUTCOME_FREE},
                           {.crack_length = 210e-6, .outcome = HAFT_OUTCOME_STUCK}};
    haft_statistics none = haft_study_statistics(&c, row, 1);
    assert_true(none.run == 0 && isnan(none.mean) && isnan(none.deviation) && isnan(none.least) &&
                isnan(none.greatest) && isnan(none.standard_error) && isnan(none.gamma));
    haft_statistics away = haft_study_statistics(&c, row, 2);
    assert_true(away.run == 1 && away.free == 1 && isnan(away.mean) && isnan(away.gamma));
    haft_statistics one = haft_study_statistics(&c, row, 3);
    assert_true(one.stuck == 1 && one.mean == 210e-6 && one.least == 210e-6 &&
                one.greatest == 210e-6 && isnan(one.deviation) && isnan(one.standard_error));
}

/* ---- blocks ---- */

static void blocks_hold_whole_patches(void **state) {
    (void)state;
    haft_case c = {.law = {.sampler = HAFT_SAMPLER_EXPLICIT}};
    static const double sizes[] = {0.1e-6, 1e-6, 3e-6, 5e-6, 12e-6, 13e-6, 600e-6};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        c.mesh.l_meso = sizes[i];
        size_t n = haft_study_block_patches(&c);
        assert_true(n >= 1);
        assert_true(n == 1 || (double)n * sizes[i] < 13e-6);       /* short against memory */
        assert_true(n == 1 || (double)(n + 1) * sizes[i] > 10e-6); /* long against its halo */
    }
    c.law.sampler = HAFT_SAMPLER_PATCHES;
    c.mesh.l_meso = 1e-6;
    assert_int_equal(haft_study_block_patches(&c), 1);
}

/* ---- the laws of a beam ---- */

enum { SITES = 3, POINTS = 201 };

/* A beam of as many sites. */
#define BEAM .beam = {.length = SITES * 3e-6}, .mesh = {.l_meso = 3e-6}

/* Two beams of three sites. All curves are one Morse law's, sampled, but for site 1 of beam 1,
 * which is said to have two wells. */
static haft_laws *make_laws(haft_law *law) {
    haft_error error = {0};
    haft_laws *laws = NULL;
    check_ok(haft_laws_create(&laws, 2 * SITES, POINTS, &error), error);
    laws->sites = SITES;
    laws->f_limit = 5e6;
    const haft_law_vector v = {.e = 10e-3, .f_max = 2e6, .d_max = 11e-9, .d_limit = 8e-9};
    assert_int_equal(haft_law_morse(law, &v, laws->f_limit), HAFT_LAW_SOUND);
    for (size_t i = 0; i < POINTS; i++) {
        laws->distance[i] = 7e-9 + 0.25e-9 * (double)i;
        for (size_t k = 0; k < laws->m; k++) {
            laws->force[k * POINTS + i] = haft_law_evaluate(law, laws->distance[i]).force;
        }
    }
    for (size_t k = 0; k < laws->m; k++) {
        laws->vector[k] = v;
        laws->fault[k] = HAFT_LAW_SOUND;
    }
    laws->fault[SITES + 1] = HAFT_LAW_TWO_WELLS;
    laws->vector[SITES + 1] = (haft_law_vector){NAN, NAN, NAN, NAN};
    return laws;
}

static void faults_are_counted(void **state) {
    (void)state;
    haft_law law;
    haft_laws *laws = make_laws(&law);
    laws->fault[0] = HAFT_LAW_BOUND;
    laws->fault[5] = HAFT_LAW_BOUND;
    size_t count[HAFT_LAW_FAULTS];
    memset(count, 0xff, sizeof count);
    haft_study_count_faults(laws, count);
    for (int f = 0; f < HAFT_LAW_FAULTS; f++) {
        size_t expected = f == HAFT_LAW_SOUND       ? 3
                          : f == HAFT_LAW_BOUND     ? 2
                          : f == HAFT_LAW_TWO_WELLS ? 1
                                                    : 0;
        assert_int_equal(count[f], expected);
    }
    haft_laws_destroy(&laws);
}

/* Every law is the Morse law, to round-off or, where it is a table, to the table's error. */
static void check_site_laws(const haft_site_laws *s, const haft_law *law, int tables) {
    int found = 0;
    for (size_t r = 0; r < s->sites; r++) {
        bool table = s->law[r].kind == HAFT_LAW_TABLE;
        assert_int_equal(table, s->table[r] != NULL);
        found += table;
        for (double d = 8.05e-9; d < 30e-9; d += 0.61e-9) {
            check_near(haft_law_evaluate(&s->law[r], d).force, haft_law_evaluate(law, d).force,
                       table ? 0.02 * law->f_max : 1e-12 * law->f_max);
        }
    }
    assert_int_equal(found, tables);
}

static void an_unfit_curve_is_used_itself_and_counted(void **state) {
    (void)state;
    haft_error error = {0};
    haft_law law;
    haft_laws *laws = make_laws(&law);
    haft_case c = {.law = {.kind = HAFT_LAW_MORSE, .unfit = HAFT_UNFIT_TABLE}, BEAM};
    haft_site_laws *s = NULL;
    check_ok(haft_study_site_laws(&s, &c, laws, 0, &error), error);
    assert_true(s->sites == SITES && s->unfit == 0);
    check_site_laws(s, &law, 0);
    haft_site_laws_destroy(&s);
    assert_null(s);
    check_ok(haft_study_site_laws(&s, &c, laws, 1, &error), error);
    assert_true(s->unfit == 1 && s->law[1].kind == HAFT_LAW_TABLE && isnan(s->vector[1].e));
    check_site_laws(s, &law, 1);
    haft_site_laws_destroy(&s);
    c.law.kind = HAFT_LAW_TABLE; /* all as tables; the unfit are counted all the same */
    check_ok(haft_study_site_laws(&s, &c, laws, 1, &error), error);
    assert_int_equal(s->unfit, 1);
    check_site_laws(s, &law, SITES);
    haft_site_laws_destroy(&s);
    haft_laws_destroy(&laws);
}

static void an_unfit_curve_stops_where_asked(void **state) {
    (void)state;
    haft_error error = {0};
    haft_law law;
    haft_laws *laws = make_laws(&law);
    haft_case c = {.law = {.kind = HAFT_LAW_MORSE, .unfit = HAFT_UNFIT_STOP}, BEAM};
    haft_site_laws *s = NULL;
    check_ok(haft_study_site_laws(&s, &c, laws, 0, &error), error);
    haft_site_laws_destroy(&s);
    assert_int_equal(haft_study_site_laws(&s, &c, laws, 1, &error), HAFT_ERROR_INPUT);
    assert_null(s);
    assert_non_null(strstr(error.message, "site 1 (two wells)"));
    assert_non_null(strstr(error.message, "law.unfit: table"));
    /* a vector said to be sound that no Morse law takes, as a file might hold */
    laws->fault[2] = HAFT_LAW_SOUND;
    laws->vector[2].e = 1e-9;
    error = (haft_error){0};
    assert_int_equal(haft_study_site_laws(&s, &c, laws, 0, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "site 2"));
    /* and it is counted where the curve is used instead */
    c.law.unfit = HAFT_UNFIT_TABLE;
    check_ok(haft_study_site_laws(&s, &c, laws, 0, &error), error);
    assert_int_equal(s->unfit, 1);
    check_site_laws(s, &law, 1);
    haft_site_laws_destroy(&s);
    haft_laws_destroy(&laws);
}

/* A curve that pulls at its first point has no wall: not even a table of it can be used. */
static void a_curve_without_a_wall_is_refused(void **state) {
    (void)state;
    haft_law law;
    haft_laws *laws = make_laws(&law);
    laws->fault[1] = HAFT_LAW_RANGE_LEFT;
    for (size_t i = 0; i < POINTS; i++) {
        laws->force[POINTS + i] = -1e6 * exp(-0.1 * (double)i);
    }
    haft_case c = {.law = {.kind = HAFT_LAW_MORSE, .unfit = HAFT_UNFIT_TABLE}, BEAM};
    haft_error error = {0};
    haft_site_laws *s = NULL;
    assert_int_equal(haft_study_site_laws(&s, &c, laws, 0, &error), HAFT_ERROR_INPUT);
    assert_null(s);
    assert_non_null(strstr(error.message, "site 1"));
    haft_laws_destroy(&laws);
}

/* ---- sites that never come into range, and curves that are not needed ---- */

/* A Morse law that the others of make_laws() are not; of what reach is told by its energy. */
static void set_law(haft_laws *laws, size_t k, double energy) {
    laws->vector[k].e = energy;
    laws->vector[k].f_max = 2e6;
    laws->vector[k].d_max = 11e-9;
    laws->vector[k].d_limit = 8e-9;
}

/* Laws of sites 2, 3 and 4 serve a beam whose zone begins there or later: the sites before are left
 * to the law that reaches farthest. */
static void sites_before_the_zone_have_a_stand_in(void **state) {
    (void)state;
    haft_error error = {0};
    haft_law law;
    haft_laws *laws = make_laws(&law);
    laws->first_site = 2;
    set_law(laws, 0, 8e-3);
    set_law(laws, 1, 20e-3); /* the slowest to fall off */
    set_law(laws, 2, 10e-3);
    haft_case c = {.law = {.kind = HAFT_LAW_MORSE, .unfit = HAFT_UNFIT_TABLE},
                   .beam = {.length = 15e-6},
                   .mesh = {.kind = HAFT_MESH_ACTIVE, .l_meso = 3e-6, .active_from = 7e-6},
                   .realizations = 2};
    assert_int_equal(haft_study_first_site(&c), 2); /* 1.5 and 4.5 um lie before */
    assert_int_equal(haft_study_law_count(&c), 6);
    haft_site_laws *s = NULL;
    check_ok(haft_study_site_laws(&s, &c, laws, 0, &error), error);
    assert_int_equal(s->sites, 5);
    for (size_t r = 0; r < 5; r++) {
        check_near(s->vector[r].e, laws->vector[r < 2 ? 1 : r - 2].e, 0);
        assert_memory_equal(&s->law[r], &s->law[r < 2 ? 3 : r], sizeof *s->law);
    }
    haft_site_laws_destroy(&s);
    c.mesh.active_from = 10e-6; /* a later zone needs fewer of them */
    check_ok(haft_study_site_laws(&s, &c, laws, 0, &error), error);
    check_near(s->vector[0].e, 20e-3, 0);
    check_near(s->vector[3].e, 20e-3, 0);
    haft_site_laws_destroy(&s);
    c.mesh.active_from = 4e-6; /* an earlier one, or a longer beam, more than there are */
    assert_int_equal(haft_study_site_laws(&s, &c, laws, 0, &error), HAFT_ERROR_INPUT);
    assert_null(s);
    assert_non_null(strstr(error.message, "no laws of realization 0 for all its sites"));
    c.mesh.active_from = 7e-6;
    assert_true(haft_study_has_laws(&c, laws, 1) && !haft_study_has_laws(&c, laws, 2) &&
                !haft_study_has_laws(&c, NULL, 0));
    c.beam.length = 18e-6;
    assert_false(haft_study_has_laws(&c, laws, 1));
    haft_laws_destroy(&laws);
}

/* What is kept by `needed`: the curve of the law that is unfit, and a realization's of evidence. */
static void curves_that_are_needed_are_kept(void **state) {
    (void)state;
    haft_error error = {0};
    haft_law law;
    haft_laws *laws = make_laws(&law), *part[2] = {NULL, NULL}, *all = NULL;
    size_t evidence[1] = {0};
    haft_case c = {.law = {.kind = HAFT_LAW_MORSE, .unfit = HAFT_UNFIT_TABLE},
                   .evidence = {.count = 1, .realization = evidence},
                   .curves = HAFT_CURVES_NEEDED,
                   .realizations = 2,
                   BEAM};
    for (size_t k = 0; k < 2; k++) {
        check_ok(haft_study_take_laws(&part[k], &c, laws, k, k, &error), error);
        assert_int_equal(part[k]->m, SITES);
        assert_int_equal(part[k]->curves, k == 0 ? SITES : 1);
    }
    check_ok(haft_laws_join(&all, part, 2, &error), error);
    assert_true(part[0] == NULL && part[1] == NULL);
    assert_true(all->m == 2 * SITES && all->sites == SITES && all->curves == SITES + 1);
    for (size_t k = 0; k < all->m; k++) {
        const double *curve = haft_laws_curve(all, k);
        assert_int_equal(curve != NULL, k < SITES || k == SITES + 1);
        if (curve != NULL) {
            assert_memory_equal(curve, haft_laws_curve(laws, k), POINTS * sizeof(double));
        }
        assert_memory_equal(&all->vector[k], &laws->vector[k], sizeof *all->vector);
        assert_int_equal(all->fault[k], laws->fault[k]);
    }
    assert_null(haft_laws_curve(all, all->m));
    assert_true(haft_study_has_laws(&c, all, 0) && haft_study_has_laws(&c, all, 1));
    c.law.kind = HAFT_LAW_TABLE; /* now the others are missing */
    assert_true(haft_study_has_laws(&c, all, 0) && !haft_study_has_laws(&c, all, 1));
    assert_true(haft_study_has_laws(&c, laws, 1));
    haft_site_laws *s = NULL;
    assert_int_equal(haft_study_site_laws(&s, &c, all, 1, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "no curve of site 0; set output.curves: all"));
    haft_laws_destroy(&all);
    haft_laws_destroy(&laws);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(statistics_take_the_stuck_beams_alone),
        cmocka_unit_test(statistics_of_few_beams_are_no_numbers),
        cmocka_unit_test(blocks_hold_whole_patches),
        cmocka_unit_test(faults_are_counted),
        cmocka_unit_test(an_unfit_curve_is_used_itself_and_counted),
        cmocka_unit_test(an_unfit_curve_stops_where_asked),
        cmocka_unit_test(a_curve_without_a_wall_is_refused),
        cmocka_unit_test(sites_before_the_zone_have_a_stand_in),
        cmocka_unit_test(curves_that_are_needed_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
