/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file chaos.h
 *  The stochastic model of the law vector v = (e, f_max, d_max, d_limit): built from m vectors,
 *  it gives any number of vectors.
 *
 *  v is transformed to unbounded numbers q, and q is reduced to its principal components eta.
 *  Gaussian kernels estimate the distribution of eta. The inverse Rosenblatt map takes the unit
 *  cube to that distribution, and is expanded in polynomials that are orthonormal in a germ:
 *
 *      germ x --CDF--> xi in (0,1)^N_g --inverse Rosenblatt--> eta --PCA--> q --bounds--> v
 *      germ x --------------- polynomials ------------------> eta
 *
 *  Source: Hoang et al. (2017), Sec. 3.2, Appendices B and C. */
#ifndef HAFT_CHAOS_H
#define HAFT_CHAOS_H

#include "haft/base.h"
#include "haft/law.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Numbers in a law vector, and the largest number of principal components. */
#define HAFT_CHAOS_DIMENSION 4

/** Highest order of an expansion. */
#define HAFT_CHAOS_ORDER_LIMIT 40

/** Most Gauss points per direction. */
#define HAFT_CHAOS_POINTS_LIMIT 128

/** Most Gauss points in all. */
#define HAFT_CHAOS_GRID_LIMIT 4194304

/** Least bandwidth of the kernels, in standard deviations. */
#define HAFT_CHAOS_LEAST_BANDWIDTH 1e-6

/** Their greatest. */
#define HAFT_CHAOS_GREATEST_BANDWIDTH 1e6

/** Greatest |eta| of a centre. */
#define HAFT_CHAOS_GREATEST_CENTRE 1e9

/** Probabilities below this are not told apart from 0 by the Rosenblatt map. */
#define HAFT_CHAOS_LEAST_TAIL 1e-280

/** Which physical bounds every generated vector keeps. */
typedef enum haft_chaos_bounds {
    /** q = [ln(e - f_max/(2 a_left)), ln f_max, d_max, ln(d_max - d_limit)] / sigma: every
     *  generated vector has a Morse law. */
    HAFT_CHAOS_BOUNDS_STRICT,
    /** q = [ln e, ln f_max, d_max, ln(d_max - d_limit)] / sigma (Eq. 24): e may come out too
     *  small for a Morse law. */
    HAFT_CHAOS_BOUNDS_PAPER
} haft_chaos_bounds;

/** How the kernels stand about the data. */
typedef enum haft_chaos_kernel {
    HAFT_CHAOS_KERNEL_SCOTT,     /**< on the data: the covariance grows by h^2 (Eqs. B.2, B.3) */
    HAFT_CHAOS_KERNEL_PRESERVING /**< centres and bandwidth shrunk by 1/sqrt(1 + h^2): it stays;
                                  *   map and expansion are Scott's times that factor */
} haft_chaos_kernel;

/** The random variables of an expansion, with their orthonormal polynomials. */
typedef enum haft_chaos_germ {
    HAFT_CHAOS_GERM_LEGENDRE, /**< uniform on (0, 1); the source's */
    HAFT_CHAOS_GERM_HERMITE,  /**< standard normal */
    HAFT_CHAOS_GERM_JACOBI    /**< Beta(2,2) on (0, 1), density 6 x (1 - x) */
} haft_chaos_germ;

/** The source of a law vector. */
typedef enum haft_chaos_sampler {
    HAFT_CHAOS_SAMPLER_GPCE,      /**< the expansion at a random germ */
    HAFT_CHAOS_SAMPLER_EXACT,     /**< the inverse Rosenblatt map of the same germ, not expanded */
    HAFT_CHAOS_SAMPLER_KERNEL,    /**< a random centre plus kernel noise: the same law, directly */
    HAFT_CHAOS_SAMPLER_BOOTSTRAP, /**< one of the m vectors */
    HAFT_CHAOS_SAMPLER_MEAN /**< the same law everywhere, that of the mean q: geometric means of the
                               numbers that enter by their logarithm */
} haft_chaos_sampler;

/** A short name ("strict"), never NULL. */
const char *haft_chaos_bounds_name(haft_chaos_bounds bounds);

/** A short name ("scott"), never NULL. */
const char *haft_chaos_kernel_name(haft_chaos_kernel kernel);

/** A short name ("legendre"), never NULL. */
const char *haft_chaos_germ_name(haft_chaos_germ germ);

/** A short name ("gpce"), never NULL. */
const char *haft_chaos_sampler_name(haft_chaos_sampler sampler);

/** Choices of a model. The default is zero, except for f_limit, order and epsilon (or
 *  components). */
typedef struct haft_chaos_spec {
    haft_chaos_bounds bounds; /**< which every vector keeps */
    double f_limit;           /**< push that d_limit is defined by, as haft_law_limit() takes it */
    size_t components;        /**< N_g, 1 to 4; 0: the fewest that keep the error below epsilon */
    double epsilon;           /**< in (0, 1); read only if components is 0 (Eq. 32) */
    size_t component_order[HAFT_CHAOS_DIMENSION]; /**< the principal component that comes 1st, 2nd,
                                                   *   ... in the Rosenblatt map; all 0: 0 1 2 3 */
    haft_chaos_kernel kernel;                     /**< how the kernels lie around the data */
    double bandwidth;     /**< h in standard deviations; 0: Scott's m^(-1/(N_g + 4)) */
    haft_chaos_germ germ; /**< variables of the expansion */
    size_t order;         /**< N_d, total order, 0 to HAFT_CHAOS_ORDER_LIMIT */
    size_t points;        /**< Gauss points a direction, > N_d; 0: N_d + 1 */
} haft_chaos_spec;

/** The model, read-only once made. Any number of threads may share it. */
typedef struct haft_chaos haft_chaos;

/** Arrays for the Rosenblatt map, one a thread. */
typedef struct haft_chaos_work haft_chaos_work;

/** Builds the model of m law vectors, in parallel by OpenMP. Its bits do not depend on the
 *  number of threads.
 *  @param[out] out the model; NULL after a failure
 *  @param[in] m how many vectors
 *  @param[in] spec choices
 *  @param[in] vector m law vectors, m > N_g, finite, within the bounds chosen
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT with one sentence that names the vector or the choice and what would
 *  do; HAFT_ERROR_MEMORY. */
haft_status haft_chaos_create(haft_chaos **out, size_t m, const haft_law_vector *vector,
                              const haft_chaos_spec *spec, haft_error *error) HAFT_MUST_CHECK;

/** Frees a model and sets the pointer to NULL; NULL is allowed. */
void haft_chaos_destroy(haft_chaos **chaos);

/** Makes the arrays of one thread. @return HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_chaos_work_create(haft_chaos_work **out, const haft_chaos *chaos,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Frees them and sets the pointer to NULL; NULL is allowed. */
void haft_chaos_work_destroy(haft_chaos_work **work);

/** All parts of a model, to be written to a file and read back. Polynomials are orthonormal: the
 *  mean square of each under the germ's distribution is 1. */
typedef struct haft_chaos_parts {
    haft_chaos_bounds bounds;                /**< of q */
    double f_limit;                          /**< as haft_law_limit() takes it */
    double sigma[HAFT_CHAOS_DIMENSION];      /**< standard deviations before division [1, 1, m,
                                              *   1; logarithms of SI numbers] (Eq. 25) */
    double mean[HAFT_CHAOS_DIMENSION];       /**< mean of q (Eq. 28) */
    double eigenvalue[HAFT_CHAOS_DIMENSION]; /**< of the covariance of q, falling */
    double eigenvector[HAFT_CHAOS_DIMENSION]
                      [HAFT_CHAOS_DIMENSION]; /**< [i][j]: part of q_i in component j (Eq. 29) */
    size_t components;                        /**< N_g */
    size_t component_order[HAFT_CHAOS_DIMENSION]; /**< a permutation of 0 .. N_g - 1 */
    haft_chaos_kernel kernel;                     /**< how they stand about the data */
    double bandwidth;                             /**< h, before any shrinking */
    size_t m;                                     /**< vectors */
    const haft_law_vector *vector;                /**< [m], for the bootstrap */
    const double *centre;      /**< [m][N_g], eta of each vector, not shrunk (Eq. 30) */
    haft_chaos_germ germ;      /**< variables of the expansion */
    size_t order;              /**< N_d */
    size_t points;             /**< Gauss points a direction of the projection */
    size_t terms;              /**< (N_d + N_g)! / (N_d! N_g!) */
    const unsigned *index;     /**< [terms][N_g], degree in each germ variable, variable i being
                                *   the one of component component_order[i]; rising
                                *   lexicographically, (0, 0, 0), (0, 0, 1), ... */
    const double *coefficient; /**< [terms][N_g], column j for principal component j; 0 where the
                                *   term holds a variable that comes after j in the map */
} haft_chaos_parts;

/** The parts of a model; the arrays are the model's own. Thread-safe. */
void haft_chaos_get_parts(const haft_chaos *chaos, haft_chaos_parts *parts);

/** Creates a model from its parts, with the same bits; arrays are copied.
 *  @return HAFT_ERROR_INPUT with one sentence that names the part, its index and what would do. */
haft_status haft_chaos_create_from_parts(haft_chaos **out, const haft_chaos_parts *parts,
                                         haft_error *error) HAFT_MUST_CHECK;

/* ---- transformations ---- */

/** q of a law vector, and back. Numbers in logarithms are kept within exp(+-230), d_limit below
 *  d_max and, by the strict bounds, e above f_max/(2 a_left) by one rounding at least, so that
 *  there haft_law_morse() takes what comes back for any finite q. Accurate to rounding of q
 *  sigma; e - f_max/(2 a_left) and d_max - d_limit lose digits if they are small compared with e
 *  and d_max. Source: Hoang et al. (2017), Eqs. 24, 27; strict: Eq. 23 solved.
 *  @param[in] chaos whose bounds and scales
 *  @param[in] vector in SI
 *  @param[out] q [4]; NaN where the vector breaks the bounds. Thread-safe. */
void haft_chaos_q_from_vector(const haft_chaos *chaos, const haft_law_vector *vector, double *q);

/** The law vector of q [4], see haft_chaos_q_from_vector(). Thread-safe. */
haft_law_vector haft_chaos_vector_from_q(const haft_chaos *chaos, const double *q);

/** eta [N_g] of q [4], its first principal components scaled to unit variance, and back. The
 *  components left out are lost. Source: Hoang et al. (2017), Eqs. 29-31. Thread-safe. */
void haft_chaos_eta_from_q(const haft_chaos *chaos, const double *q, double *eta);

/** q [4] of eta [N_g], the components left out being 0 (Eq. 31). Thread-safe. */
void haft_chaos_q_from_eta(const haft_chaos *chaos, const double *eta, double *q);

/** The Rosenblatt map of the kernel density, exact to rounding: a conditional CDF is the sum of
 *  normal CDFs, weighted by the kernels of the components before. Kernels with less than m^-1
 *  e^-75 of the greatest weight are left out, which changes a tail probability p by 3e-33 at
 *  most.
 *  @param[in] chaos the model
 *  @param[in,out] work scratch of one thread
 *  @param[in] eta [N_g], finite
 *  @param[out] xi [N_g] conditional CDFs, number i being that of component component_order[i]
 *  @param[out] tail [N_g] 1 - xi, as accurate for its size as xi; may be NULL Source: Rosenblatt
 *  (1952); Hoang et al. (2017), Eqs. C.1-C.2. Thread-safe, a work a thread. */
void haft_chaos_rosenblatt(const haft_chaos *chaos, haft_chaos_work *work, const double *eta,
                           double *xi, double *tail);

/** The inverse, by Halley's iteration on the logarithm of the smaller tail, with a bracket that
 *  shrinks: d eta = d xi / density, so eta is as accurate as xi allows. Between modes so far
 *  apart that the CDF is constant to rounding, any point between them.
 *  @param[in] chaos the model
 *  @param[in,out] work scratch of one thread
 *  @param[in] xi [N_g] conditional CDFs, at least HAFT_CHAOS_LEAST_TAIL
 *  @param[in] tail [N_g] 1 - xi, at least as much; NULL: computed
 *  @param[out] eta [N_g] standard deviations
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT if some xi or tail is not. Thread-safe, a work a thread. */
haft_status haft_chaos_inverse(const haft_chaos *chaos, haft_chaos_work *work, const double *xi,
                               const double *tail, double *eta, haft_error *error) HAFT_MUST_CHECK;

/** The expansion at a germ x [N_g]: eta [N_g] = sum over terms of coefficient times product of
 *  polynomials. Source: Hoang et al. (2017), Eq. C.5. Thread-safe. */
void haft_chaos_expand(const haft_chaos *chaos, const double *x, double *eta);

/** Law vectors of sites first .. first + n - 1 of a realization. Vector (realization, site) depends
 *  on seed, realization and site alone: Philox of purpose HAFT_RANDOM_LAW_SAMPLE, draw 0 being the
 *  germ (or the choice of a centre), draw 1 the kernel noise. gpce and exact share the germ.
 *  @param[in] chaos the model
 *  @param[in] sampler what is drawn from
 *  @param[in] seed the case's
 *  @param[in] realization the beam
 *  @param[in] first its first site
 *  @param[in] n sites
 *  @param[in] work needed by HAFT_CHAOS_SAMPLER_EXACT, else may be NULL
 *  @param[out] vector [n]
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT if the work is missing. Thread-safe, a work a thread. */
haft_status haft_chaos_sample(const haft_chaos *chaos, haft_chaos_work *work,
                              haft_chaos_sampler sampler, uint64_t seed, uint64_t realization,
                              uint64_t first, size_t n, haft_law_vector *vector,
                              haft_error *error) HAFT_MUST_CHECK;

/** Which of m patches the bootstrap draws for a site: uniform, and as haft_chaos_sample() depends
 *  on seed, realization and site alone. Thread-safe.
 *  @param[in] seed of the study
 *  @param[in] realization of the beam
 *  @param[in] site of the beam
 *  @param[in] m how many patches there are, > 0
 *  @return one of 0 ... m - 1 */
size_t haft_chaos_draw_patch(uint64_t seed, uint64_t realization, uint64_t site, size_t m);

/* ---- the basis ---- */

/** Orthonormal polynomials psi[0 .. order] at x, order at most HAFT_CHAOS_POINTS_LIMIT.
 *  Thread-safe. */
void haft_chaos_polynomials(haft_chaos_germ germ, size_t order, double x, double *psi);

/** n-point Gauss rule of a germ's law: sum of weights 1, exact to degree 2 n - 1; nodes rise.
 *  @return HAFT_ERROR_ARGUMENT if n is 0 or above HAFT_CHAOS_POINTS_LIMIT. Thread-safe. */
haft_status haft_chaos_gauss(haft_chaos_germ germ, size_t n, double *x, double *weight,
                             haft_error *error) HAFT_MUST_CHECK;

/** The germ's CDF at x and its complement, each accurate for its size. Thread-safe. */
void haft_chaos_germ_cdf(haft_chaos_germ germ, double x, double *xi, double *tail);

/** The germ's quantile of 0 < xi < 1. Thread-safe. */
double haft_chaos_germ_quantile(haft_chaos_germ germ, double xi);

/** Terms of total order `order` in `directions` variables. */
size_t haft_chaos_terms(size_t directions, size_t order);

/** The degrees [terms][directions] of the terms, in rising lexicographic order. Thread-safe. */
void haft_chaos_indices(size_t directions, size_t order, unsigned *index);

/** Coefficients of a map known at the tensor Gauss points, by projection:
 *  c_a = sum_k w_k T(x_k) psi_a(x_k). Source: Hoang et al. (2017), Eqs. C.7-C.8.
 *  @param[in] germ whose law is projected on
 *  @param[in] directions variables, 1 to HAFT_CHAOS_DIMENSION
 *  @param[in] order N_d, at most HAFT_CHAOS_ORDER_LIMIT
 *  @param[in] points Gauss points a direction, > order, at most HAFT_CHAOS_POINTS_LIMIT
 *  @param[in] value [points^directions], the last direction running fastest
 *  @param[out] coefficient [terms], one by one, stride apart
 *  @param[in] stride from a coefficient to the next, in numbers
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT if sizes are out of range or points <= order; HAFT_ERROR_MEMORY.
 *  Thread-safe. */
haft_status haft_chaos_project(haft_chaos_germ germ, size_t directions, size_t order, size_t points,
                               const double *value, double *coefficient, size_t stride,
                               haft_error *error) HAFT_MUST_CHECK;

/* ---- densities ---- */

/** Gaussian kernels around samples, as a model has them around its centres. Where `kernel`
 *  preserves the variance, centres and bandwidth are shrunk by 1/sqrt(1 + h^2). */
typedef struct haft_chaos_kernels {
    size_t m;                 /**< kernels */
    const double *centre;     /**< [m][stride], the first number of each row being column 0 */
    size_t stride;            /**< numbers a row of `centre` */
    double bandwidth;         /**< h, before any shrinking; > 0 */
    haft_chaos_kernel kernel; /**< how they stand about the samples */
} haft_chaos_kernels;

/** Their marginal density in one column,
 *      p(x) = 1/m sum_k N(x; c_k, h^2).
 *  @param[in] kernels the density
 *  @param[in] column which number of each centre
 *  @param[in] n points
 *  @param[in] x [n] @param[out] density [n] Source: Hoang et al. (2017), Eq. B.3. Thread-safe. */
void haft_chaos_density(const haft_chaos_kernels *kernels, size_t column, size_t n, const double *x,
                        double *density);

/** Their joint density in two columns, p(x_i, y_j), on the product of two grids.
 *  @param[in] kernels the density
 *  @param[in] column_x, column_y which numbers of each centre
 *  @param[in] nx, ny points of the grids
 *  @param[in] x [nx] @param[in] y [ny] @param[out] density [nx][ny]
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_chaos_joint_density(const haft_chaos_kernels *kernels, size_t column_x,
                                     size_t column_y, size_t nx, const double *x, size_t ny,
                                     const double *y, double *density,
                                     haft_error *error) HAFT_MUST_CHECK;

/* ---- errors ---- */

/** The effort of measuring errors. Zeros mean 4096 maps and 65536 samples. */
typedef struct haft_chaos_effort {
    size_t maps;    /**< quasi-random points the map itself is evaluated at */
    size_t samples; /**< quasi-random points the expansion is sampled at */
} haft_chaos_effort;

/** Distance of a component's marginal from another distribution. */
typedef struct haft_chaos_distance {
    double ks;            /**< Kolmogorov-Smirnov, greatest difference of the CDFs */
    double w1;            /**< Wasserstein-1, int |F - G| [standard deviations] */
    double low_quantile;  /**< difference of the 0.1 % quantiles [standard deviations] */
    double high_quantile; /**< difference of the 99.9 % quantiles */
} haft_chaos_distance;

/** Sorts numbers in rising order. Thread-safe. */
void haft_chaos_sort(size_t n, double *x);

/** The exact distance between the empirical distributions of sorted samples x and y, in their
 *  unit.
 *  @param[in] n, m how many, at least 1
 *  @param[in] x [n] rising
 *  @param[in] y [m] rising Thread-safe. */
haft_chaos_distance haft_chaos_distance_of_samples(size_t n, const double *x, size_t m,
                                                   const double *y);

/** Errors of the expansion, [j] for principal component j. */
typedef struct haft_chaos_errors {
    double relmise_own[HAFT_CHAOS_DIMENSION];    /**< by the projection's own Gauss rule (Eq. C.9);
                                                  *   blind: 0 for one variable and N_d + 1 points */
    double relmise_own_total;                    /**< Eq. C.10 */
    double relmise[HAFT_CHAOS_DIMENSION];        /**< by a quasi-random rule of its own */
    double relmise_total;                        /**< Eq. C.10 by that rule */
    double variance[HAFT_CHAOS_DIMENSION];       /**< of the kernel density, in closed form */
    double variance_error[HAFT_CHAOS_DIMENSION]; /**< share of it that the expansion lacks */
    haft_chaos_distance kernel[HAFT_CHAOS_DIMENSION]; /**< expansion less kernel density */
    haft_chaos_distance data[HAFT_CHAOS_DIMENSION];   /**< expansion less the m vectors */
    double reduction; /**< share of q's variance in the components left out (Eq. 32) */
    double outside;   /**< share of sampled vectors without a Morse law; 0 by the strict bounds */
} haft_chaos_errors;

/** Measures the errors, in parallel; the bits do not depend on the threads. The quasi-random
 *  sets are fixed (additive recurrences: Roberts 2018). Their discrepancy limits the accuracy to
 *  about 1e-3 in ks and in w1 with the default effort.
 *  @return HAFT_ERROR_ARGUMENT if an effort is above HAFT_CHAOS_GRID_LIMIT; HAFT_ERROR_MEMORY. */
haft_status haft_chaos_measure(const haft_chaos *chaos, const haft_chaos_effort *effort,
                               haft_chaos_errors *errors, haft_error *error) HAFT_MUST_CHECK;

/** The inverse Rosenblatt map at the first n quasi-random points, in parallel, for comparing
 *  several expansions with it.
 *  @param[in] chaos the model
 *  @param[in] n points
 *  @param[out] xi [n][N_g] in the map's order @param[out] eta [n][N_g] by component
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_chaos_map(const haft_chaos *chaos, size_t n, double *xi, double *eta,
                           haft_error *error) HAFT_MUST_CHECK;

/** relMISE of a model's expansion against a map from haft_chaos_map(): its own, or that of a
 *  model of the same vectors, kernels and components with any germ and order. Heavy tails
 *  dominate it: one of 5000 vectors at 15 standard deviations holds 5 % of the variance. So n
 *  must be many times the number of vectors.
 *  @param[in] chaos the model
 *  @param[in] n points of the map
 *  @param[in] xi [n][N_g] in the order of its Rosenblatt map
 *  @param[in] eta [n][N_g] the map at them
 *  @param[out] each [N_g] Eq. C.9 @param[out] total Eq. C.10. Thread-safe. */
void haft_chaos_relmise(const haft_chaos *chaos, size_t n, const double *xi, const double *eta,
                        double *each, double *total);

#ifdef __cplusplus
}
#endif
#endif
