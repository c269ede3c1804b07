/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The radial PSD of non-Gaussian surfaces without drawing one: a generated field's covariance is
 * exact (a sum over the kernel's modes, put through the marginal's Hermite series), so its PSD is a
 * transform away, and has no sampling error that could hide one of 2 %. The covariance depends on
 * the distance alone, to what the taper leaks, so a line of it gives the plane's by interpolation.
 */
#include "check.h"

#include "haft/surface.h"

#include <fftw3.h>

static const double STEP = 5e-9;

enum { HALF = 1200, STENCIL = 20, RINGS = 200 };

/* Covariance along the beam at lags 0 to HALF + STENCIL, of a plan with the marginal or without. */
static void line_covariance(const haft_psd_table *psd, const haft_marginal *marginal, double *line,
                            haft_surface_facts *facts) {
    haft_surface_spec spec = {.table = psd,
                              .marginal = marginal,
                              .grid_step = STEP,
                              .rows = HALF,
                              .columns = 2, /* lags across are not asked for */
                              .key = {1, HAFT_RANDOM_TEST}};
    haft_error error = {0};
    haft_surface_plan *plan = NULL;
    check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
    haft_surface_get_facts(plan, facts);
    assert_true(2 * facts->reach < HALF * STEP); /* it has died away on the way */
    for (long i = 0; i <= HALF + STENCIL; i++) {
        line[i] = haft_surface_covariance(plan, i, 0);
    }
    haft_surface_plan_destroy(&plan);
}

/* Lagrange's polynomial through the nearest STENCIL lags; the line is even. */
static double interpolate(const double *line, double x) {
    static double factor[STENCIL];
    if (factor[0] == 0) {
        for (int i = 0; i < STENCIL; i++) {
            factor[i] = 1;
            for (int j = 0; j < STENCIL; j++) {
                factor[i] *= i == j ? 1 : 1.0 / (i - j);
            }
        }
    }
    long first = (long)floor(x) - STENCIL / 2 + 1;
    double product = 1, sum = 0;
    for (int i = 0; i < STENCIL; i++) {
        double off = x - (double)(first + i);
        if (fabs(off) < 1e-9) {
            return line[labs(first + i)];
        }
        product *= off;
        sum += factor[i] * line[labs(first + i)] / off;
    }
    return product * sum;
}

/* Ring means of the plane's PSD over those of the wanted one: the largest deviation below 0.95
 * zeta_max; and the variance beyond zeta_max, as a share. */
static double radial_error(const haft_psd_table *psd, const double *line, double *beyond) {
    size_t n = HALF + 1;
    double *plane = fftw_alloc_real(n * n), is[RINGS] = {0}, wanted[RINGS] = {0}, outside = 0;
    fftw_plan transform =
        fftw_plan_r2r_2d((int)n, (int)n, plane, plane, FFTW_REDFT00, FFTW_REDFT00, FFTW_ESTIMATE);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j <= i; j++) {
            double r = hypot((double)i, (double)j);
            plane[i * n + j] = plane[j * n + i] = r < HALF ? interpolate(line, r) : 0;
        }
    }
    fftw_execute(transform);
    double zeta_max = psd->zeta[psd->n - 1];
    double cell = M_PI / (HALF * STEP), scale = pow(STEP / (2 * M_PI), 2);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            double zeta = cell * hypot((double)i, (double)j), s = scale * plane[i * n + j];
            double weight = (i % HALF == 0 ? 1 : 2) * (double)(j % HALF == 0 ? 1 : 2);
            int ring = (int)fmin(floor(40 * log10(fmax(1, zeta / cell))), RINGS - 1);
            if (zeta > zeta_max) {
                outside += weight * s * cell * cell;
            } else if (zeta < 0.95 * zeta_max) {
                is[ring] += weight * s;
                wanted[ring] += weight * haft_psd_table_value(psd, zeta);
            }
        }
    }
    double worst = 0;
    for (int k = 0; k < RINGS; k++) {
        worst = wanted[k] > 0 ? fmax(worst, fabs(is[k] / wanted[k] - 1)) : worst;
    }
    *beyond = outside / line[0];
    fftw_destroy_plan(transform);
    fftw_free(plane);
    return worst;
}

/* Published PSDs, and one as ragged as an estimate from a map. */
enum { RAGGED = 8 };
static void fill_ragged(haft_psd_table *table) {
    for (int k = 0; k < RAGGED; k++) {
        double share = k / (RAGGED - 1.0);
        table->zeta[k] = 50e6 * pow(5.6, share);
        table->s[k] = 5e-33 * pow(5.6, -6 * share) * (k % 3 == 1 ? 1.15 : k % 3 == 2 ? 0.9 : 1);
    }
}

static void the_radial_psd_is_the_one_asked_for(void **state) {
    (void)state;
    double delrio[2][2] = {{19.4e6, 289e6}, {6.46e-33, 6.46e-39}};
    double soylemez[2][2] = {{40e6, 283e6}, {0.5e-33, 50e-39}}, ragged[2][RAGGED];
    haft_psd_table psd[] = {{2, delrio[0], delrio[1], NULL},
                            {2, soylemez[0], soylemez[1], NULL},
                            {RAGGED, ragged[0], ragged[1], NULL}};
    static const char *const names[] = {"DelRio", "Soylemez", "ragged"};
    static const struct {
        int psd;
        double skewness, kurtosis;
    } cases[] = {{0, 0, 3}, {0, 1, 5}, {1, 0, 3}, {1, 2, 9}, {2, 0, 3}, {2, 0.545, 3.38}};
    static double line[HALF + STENCIL + 1];
    fill_ragged(&psd[2]);
    double gaussian = 0;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        haft_marginal *m = NULL;
        haft_error error = {0};
        haft_surface_facts facts;
        double beyond;
        check_ok(haft_marginal_johnson(&m, cases[k].skewness, cases[k].kurtosis, &error), error);
        line_covariance(&psd[cases[k].psd], m, line, &facts);
        double off = radial_error(&psd[cases[k].psd], line, &beyond);
        print_message("%s, skewness %g, kurtosis %g: PSD off by %.4f at most (the plan says %.4f); "
                      "%.1e of the variance beyond zeta_max (%.1e)\n",
                      names[cases[k].psd], cases[k].skewness, cases[k].kurtosis, off,
                      facts.psd_error, beyond, facts.beyond);
        check_less(off, 0.02);
        /* no worse than the Gaussian surface, whose error is the taper's, by more than it says */
        gaussian = facts.deviation == 0 ? off : gaussian;
        check_less(off, gaussian + facts.psd_error + 5e-4);
        check_near(beyond, facts.beyond, 3e-6 + 0.05 * facts.beyond);
        haft_marginal_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_radial_psd_is_the_one_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
