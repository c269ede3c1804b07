/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of generated surfaces against the exact covariance of the discretised field, and of
 * that against the PSD. Samples are independent patches (streams), so standard errors are those of
 * independent draws; each z must be below 4. */
#include "check.h"

#include "haft/surface.h"

#include <fftw3.h>
#include <gsl/gsl_integration.h>

enum { SIZE = 64, BINS = 12 };

static const haft_psd PUBLISHED[2] = {{289e6, 19.4e6, 6.46e-33, 6.46e-39},
                                      {283e6, 40e6, 0.5e-33, 50e-39}};

static haft_surface_spec patch_spec(void) {
    return (haft_surface_spec){.psd = PUBLISHED[1],
                               .grid_step = 5e-9,
                               .rows = SIZE,
                               .columns = SIZE,
                               .tolerance = 1e-4,
                               .key = {11, HAFT_RANDOM_TEST}};
}

typedef struct generator {
    haft_surface_plan *plan;
    haft_surface_work *work;
    haft_surface_spec spec;
} generator;

static generator make_generator(haft_surface_spec spec) {
    haft_error error = {0};
    generator g = {.spec = spec};
    check_ok(haft_surface_plan_create(&g.plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&g.work, g.plan, &error), error);
    return g;
}

static void destroy_generator(generator *g) {
    haft_surface_work_destroy(&g->work);
    haft_surface_plan_destroy(&g->plan);
}

static void generate(generator *g, uint64_t stream, long first_row, double *z) {
    haft_error error = {0};
    check_ok(haft_surface_prepare(g->work, 0, stream, first_row, &error), error);
    check_ok(haft_surface_rows(g->work, 0, g->spec.rows, z, &error), error);
}

/* Mean and its standard error over independent samples. */
typedef struct tally {
    double n, sum, squares;
} tally;

static void add(tally *t, double x) {
    t->n++;
    t->sum += x;
    t->squares += x * x;
}

static double z_score(tally t, double expected) {
    double mean = t.sum / t.n;
    double variance = (t.squares / t.n - mean * mean) * t.n / (t.n - 1);
    return (mean - expected) / sqrt(variance / t.n);
}

#define check_z(tally_, expected)                                                                  \
    do {                                                                                           \
        double check_score = z_score(tally_, expected);                                            \
        if (!(fabs(check_score) < 4)) {                                                            \
            fail_msg("%s: mean %.6g, expected %.6g, z = %.2f", #tally_, (tally_).sum / (tally_).n, \
                     (double)(expected), check_score);                                             \
        }                                                                                          \
    } while (0)

/* Mean over a patch of z(i, j) z(i + di, j + dj). */
static double lag_product(const double *z, size_t di, size_t dj) {
    double sum = 0;
    for (size_t i = 0; i + di < SIZE; i++) {
        for (size_t j = 0; j + dj < SIZE; j++) {
            sum += z[i * SIZE + j] * z[(i + di) * SIZE + j + dj];
        }
    }
    return sum / (double)((SIZE - di) * (SIZE - dj));
}

/* Mean squares of central differences along a direction (stride in points): slope, curvature. */
static void differences(const double *z, size_t stride, double step, double out[2]) {
    double slopes = 0, curvatures = 0;
    for (size_t i = 1; i + 1 < SIZE; i++) {
        for (size_t j = 1; j + 1 < SIZE; j++) {
            const double *p = z + i * SIZE + j;
            double slope = (p[stride] - *(p - stride)) / (2 * step);
            double curvature = (p[stride] - 2 * p[0] + *(p - stride)) / (step * step);
            slopes += slope * slope;
            curvatures += curvature * curvature;
        }
    }
    out[0] = slopes / ((SIZE - 2) * (SIZE - 2));
    out[1] = curvatures / ((SIZE - 2) * (SIZE - 2));
}

static void patches_have_the_moments(void **state) {
    (void)state;
    generator g = make_generator(patch_spec());
    haft_surface_facts facts;
    haft_surface_get_facts(g.plan, &facts);
    static const size_t lags[][2] = {{0, 0}, {1, 0}, {0, 1}, {7, 0}, {0, 7}, {5, 5}, {20, 31}};
    enum { LAGS = sizeof lags / sizeof *lags, PATCHES = 2000 };
    tally mean = {0}, products[LAGS] = {{0}}, along[2] = {{0}}, across[2] = {{0}};
    tally anisotropy[2] = {{0}}, neighbours = {0}, kurtosis = {0};
    static double z[SIZE * SIZE], last[SIZE * SIZE];
    for (uint64_t k = 0; k < PATCHES; k++) {
        memcpy(last, z, sizeof z);
        generate(&g, k, 0, z);
        double sum = 0, cross = 0, fourth = 0, x[2], y[2];
        for (size_t i = 0; i < SIZE * SIZE; i++) {
            sum += z[i];
            cross += z[i] * last[i];
            fourth += pow(z[i] * z[i] / facts.moments.m0, 2);
        }
        add(&mean, sum);
        add(&kurtosis, fourth / (SIZE * SIZE));
        if (k % 2 == 1) { /* pairs, so that samples are independent */
            add(&neighbours, cross);
        }
        for (int l = 0; l < LAGS; l++) {
            add(&products[l], lag_product(z, lags[l][0], lags[l][1]));
        }
        differences(z, SIZE, g.spec.grid_step, x);
        differences(z, 1, g.spec.grid_step, y);
        for (int d = 0; d < 2; d++) {
            add(&along[d], x[d]);
            add(&across[d], y[d]);
            add(&anisotropy[d], x[d] - y[d]);
        }
    }
    check_z(mean, 0);
    check_z(neighbours, 0);
    check_z(kurtosis, 3);
    for (int l = 0; l < LAGS; l++) {
        check_z(products[l], haft_surface_covariance(g.plan, (long)lags[l][0], (long)lags[l][1]));
    }
    for (int d = 0; d < 2; d++) {
        double expected = d == 0 ? facts.differences.m2 : facts.differences.m4;
        check_z(along[d], expected);
        check_z(across[d], expected);
        check_z(anisotropy[d], 0);
    }
    destroy_generator(&g);
}

/* Covariances across the border of two blocks are those inside one. */
static void borders_do_not_show(void **state) {
    (void)state;
    generator g = make_generator(patch_spec());
    static const long lags[] = {1, 3, 10, 30};
    enum { LAGS = 4, BEAMS = 1000, BORDER = SIZE };
    tally across[LAGS] = {{0}}, inside[LAGS] = {{0}}, contrast[LAGS] = {{0}}, slope = {0};
    static double z[2 * SIZE * SIZE];
    for (uint64_t k = 0; k < BEAMS; k++) {
        generate(&g, k, SIZE, z + SIZE * SIZE);
        generate(&g, k, 0, z);
        double step = 0;
        for (int l = 0; l < LAGS; l++) {
            double over = 0, within = 0;
            for (long j = 0; j < SIZE; j++) {
                long low = BORDER - (lags[l] + 1) / 2;
                over += z[low * SIZE + j] * z[(low + lags[l]) * SIZE + j];
                within += z[(low - 32) * SIZE + j] * z[(low - 32 + lags[l]) * SIZE + j];
            }
            add(&across[l], over / SIZE);
            add(&inside[l], within / SIZE);
            add(&contrast[l], (over - within) / SIZE);
        }
        for (long j = 0; j < SIZE; j++) {
            double rise = z[BORDER * SIZE + j] - z[(BORDER - 1) * SIZE + j];
            step += rise * rise / SIZE;
        }
        add(&slope, step);
    }
    for (int l = 0; l < LAGS; l++) {
        double expected = haft_surface_covariance(g.plan, lags[l], 0);
        check_z(across[l], expected);
        check_z(inside[l], expected);
        check_z(contrast[l], 0);
    }
    check_z(slope,
            2 * (haft_surface_covariance(g.plan, 0, 0) - haft_surface_covariance(g.plan, 1, 0)));
    destroy_generator(&g);
}

/* Bin of a wave vector of the patch's transform by its length; BINS or more: left out. */
static size_t radial_bin(size_t m, size_t n) {
    double x = (double)(m <= SIZE / 2 ? m : SIZE - m), y = (double)n;
    return (size_t)(hypot(x, y) * BINS / (SIZE / 2) * 0.999999);
}

/* Mean |transform|^2 in radial bins of wave number, over a half plane. */
static void bin_power(fftw_complex *spectrum, double power[BINS]) {
    double count[BINS] = {0};
    memset(power, 0, BINS * sizeof *power);
    for (size_t m = 0; m < SIZE; m++) {
        for (size_t n = 0; n <= SIZE / 2; n++) {
            size_t bin = radial_bin(m, n);
            if (bin < BINS) {
                const double *f = spectrum[m * (SIZE / 2 + 1) + n];
                power[bin] += f[0] * f[0] + f[1] * f[1];
                count[bin]++;
            }
        }
    }
    for (size_t b = 0; b < BINS; b++) {
        power[b] /= count[b];
    }
}

/* The exact expectation of bin_power for windowed patches: the transform of the covariance times
 * the window's own autocorrelation. Lags from -(SIZE-1) fold onto the patch's wave numbers. */
static void expected_power(const generator *g, const double *window, double power[BINS]) {
    static double folded[SIZE * SIZE];
    memset(folded, 0, sizeof folded);
    double overlap[SIZE] = {0};
    for (size_t d = 0; d < SIZE; d++) {
        for (size_t i = 0; i + d < SIZE; i++) {
            overlap[d] += window[i] * window[i + d];
        }
    }
    for (long i = 0; i < SIZE; i++) {
        for (long j = 0; j < SIZE; j++) {
            double value = haft_surface_covariance(g->plan, i, j) * overlap[i] * overlap[j];
            long mirror_i = (SIZE - i) % SIZE, mirror_j = (SIZE - j) % SIZE;
            folded[i * SIZE + j] += value;
            if (i > 0) {
                folded[mirror_i * SIZE + j] += value;
            }
            if (j > 0) {
                folded[i * SIZE + mirror_j] += value;
            }
            if (i > 0 && j > 0) {
                folded[mirror_i * SIZE + mirror_j] += value;
            }
        }
    }
    double count[BINS] = {0};
    memset(power, 0, BINS * sizeof *power);
    fftw_complex *spectrum = fftw_alloc_complex(SIZE * (SIZE / 2 + 1));
    fftw_plan plan = fftw_plan_dft_r2c_2d(SIZE, SIZE, folded, spectrum, FFTW_ESTIMATE);
    fftw_execute(plan);
    for (size_t m = 0; m < SIZE; m++) {
        for (size_t n = 0; n <= SIZE / 2; n++) {
            size_t bin = radial_bin(m, n);
            if (bin < BINS) {
                power[bin] += spectrum[m * (SIZE / 2 + 1) + n][0];
                count[bin]++;
            }
        }
    }
    for (size_t b = 0; b < BINS; b++) {
        power[b] /= count[b];
    }
    fftw_destroy_plan(plan);
    fftw_free(spectrum);
}

/* Power in radial bins through a Hann window, whose side lobes sink fast enough that the bins see
 * the PSD's five decades and its end at zeta_max. */
static void patches_have_the_radial_psd(void **state) {
    (void)state;
    generator g = make_generator(patch_spec());
    double window[SIZE], expected[BINS], power[BINS];
    tally bins[BINS] = {{0}};
    for (size_t i = 0; i < SIZE; i++) {
        window[i] = 1 - cos(2 * M_PI * (double)i / SIZE);
    }
    expected_power(&g, window, expected);
    double *z = fftw_alloc_real(SIZE * SIZE);
    fftw_complex *spectrum = fftw_alloc_complex(SIZE * (SIZE / 2 + 1));
    fftw_plan plan = fftw_plan_dft_r2c_2d(SIZE, SIZE, z, spectrum, FFTW_ESTIMATE);
    for (uint64_t k = 0; k < 2000; k++) {
        generate(&g, 100000 + k, 0, z);
        for (size_t i = 0; i < SIZE * SIZE; i++) {
            z[i] *= window[i / SIZE] * window[i % SIZE];
        }
        fftw_execute(plan);
        bin_power(spectrum, power);
        for (size_t b = 0; b < BINS; b++) {
            add(&bins[b], power[b]);
        }
    }
    for (size_t b = 0; b < BINS; b++) {
        check_z(bins[b], expected[b]);
    }
    /* Bins whole inside (zeta_0, zeta_max) also follow the PSD itself: the window's leakage aside,
     * E|F|^2 = 4 pi^2 s (sum window^2)^2 / step^2, and s is convex enough to bound by bin edges. */
    double resolution = 2 * M_PI / (SIZE * g.spec.grid_step), width = (SIZE / 2.0) / BINS;
    double scale = pow(2 * M_PI / g.spec.grid_step * 1.5 * SIZE, 2);
    for (size_t b = 2; (double)(b + 1) * width * resolution < g.spec.psd.zeta_max - 2 * resolution;
         b++) {
        double low = (double)b * width - 1.5, high = (double)(b + 1) * width + 1.5;
        check_less(scale * haft_psd_value(&g.spec.psd, high * resolution), expected[b]);
        check_less(expected[b], scale * haft_psd_value(&g.spec.psd, low * resolution));
    }
    fftw_destroy_plan(plan);
    fftw_free(spectrum);
    fftw_free(z);
    destroy_generator(&g);
}

typedef struct hankel {
    haft_psd psd;
    double r;
} hankel;

static double hankel_integrand(double zeta, void *parameters) {
    const hankel *h = parameters;
    return 2 * M_PI * zeta * haft_psd_value(&h->psd, zeta) * j0(zeta * h->r);
}

static double psd_covariance(haft_psd psd, double r) {
    hankel h = {psd, r};
    gsl_function f = {hankel_integrand, &h};
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(2000);
    double low = 0, high = 0, bound = 0, m0 = haft_psd_get_moments(&psd).m0;
    gsl_integration_qag(&f, 0, psd.zeta_0, 1e-12 * m0, 0, 2000, GSL_INTEG_GAUSS61, workspace, &low,
                        &bound);
    gsl_integration_qag(&f, psd.zeta_0, psd.zeta_max, 1e-12 * m0, 0, 2000, GSL_INTEG_GAUSS61,
                        workspace, &high, &bound);
    gsl_integration_workspace_free(workspace);
    return low + high;
}

/* The generated field's covariance is the PSD's Hankel transform, but for what the taper takes: at
 * lag 0 exactly that, elsewhere at most 2 sqrt(loss) by Cauchy and Schwarz and in truth, for lags
 * well below the reach, a few times the loss. */
static void covariance_is_the_psds(void **state) {
    (void)state;
    static const double tolerances[] = {1e-3, 1e-4, 1e-5};
    for (int p = 0; p < 2; p++) {
        haft_psd_moments exact = haft_psd_get_moments(&PUBLISHED[p]);
        for (int t = 0; t < 3; t++) {
            haft_surface_spec spec = patch_spec();
            spec.psd = PUBLISHED[p];
            spec.tolerance = tolerances[t];
            haft_error error = {0};
            haft_surface_plan *plan = NULL;
            haft_surface_facts facts;
            check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
            haft_surface_get_facts(plan, &facts);
            check_less(facts.taper_loss, tolerances[t] * (1 + 1e-9));
            check_near(facts.moments.m0 / exact.m0, 1 - facts.taper_loss, 1e-8);
            for (long lag = 0; lag <= 40; lag += 8) {
                double r = (double)lag * spec.grid_step;
                check_near(haft_surface_covariance(plan, lag, 0) / exact.m0,
                           psd_covariance(PUBLISHED[p], r) / exact.m0, 4 * facts.taper_loss);
                check_relative(haft_surface_covariance(plan, 0, lag),
                               haft_surface_covariance(plan, lag, 0), 1e-9);
            }
            check_near(haft_surface_covariance(plan, 0, 1000000), 0, 0);
            /* Central differences see a wave of number k as sin(k step) / step. */
            check_less(facts.differences.m2, facts.moments.m2);
            check_less(facts.differences.m4, facts.moments.m4);
            double lag1 = haft_surface_covariance(plan, 2, 0);
            check_relative(facts.differences.m2,
                           (facts.moments.m0 - lag1) / (2 * pow(spec.grid_step, 2)), 1e-9);
            haft_surface_plan_destroy(&plan);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patches_have_the_moments),
        cmocka_unit_test(borders_do_not_show),
        cmocka_unit_test(patches_have_the_radial_psd),
        cmocka_unit_test(covariance_is_the_psds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
