/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file surface.h
 *  Power spectral densities, their moments, and Gaussian surfaces generated from them.
 *
 *  Convention: the variance m0 is the integral of s over the whole plane of wave vectors, without a
 *  factor 1/(2 pi)^2. Only with this convention do the published parameters give the published
 *  roughness. */
#ifndef HAFT_SURFACE_H
#define HAFT_SURFACE_H

#include "haft/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A self-affine isotropic PSD: s_0 up to zeta_0, then a power law down to s_1 at zeta_max, zero
 *  beyond. Source: Hoang et al. (2017), Eq. 34. */
typedef struct haft_psd {
    double zeta_max; /**< wave number of the shortest wave [rad/m] */
    double zeta_0;   /**< roll-off [rad/m], 0 < zeta_0 < zeta_max */
    double s_0;      /**< plateau [m^4] */
    double s_1;      /**< value at zeta_max [m^4], 0 < s_1 <= s_0 */
} haft_psd;

/** Spectral moments of a profile along a line of an isotropic surface. */
typedef struct haft_psd_moments {
    double m0; /**< variance of height [m^2], 2 pi int s zeta dzeta */
    double m2; /**< variance of slope along a line, pi int s zeta^3 dzeta */
    double m4; /**< variance of curvature along a line [1/m^2], (3 pi/4) int s zeta^5 dzeta */
} haft_psd_moments;

/** Greenwood-Williamson parameters of a surface with given moments. */
typedef struct haft_gw {
    double alpha;            /**< bandwidth m0 m4 / m2^2 */
    double radius;           /**< mean summit radius [m], (3/8) sqrt(pi/m4) */
    double density;          /**< summits per area [1/m^2], m4 / (6 pi sqrt(3) m2) */
    double summit_deviation; /**< standard deviation of summit heights [m], sqrt(1-0.8968/alpha)
                                sqrt(m0) */
} haft_gw;

/** Checks that 0 < zeta_0 < zeta_max, 0 < s_1 <= s_0, and all are finite. */
haft_status haft_psd_check(const haft_psd *psd, haft_error *error) HAFT_MUST_CHECK;

/** s(zeta) [m^4] of a checked PSD. Thread-safe. */
double haft_psd_value(const haft_psd *psd, double zeta);

/** The moments in closed form (integrals of piecewise powers). Thread-safe. */
haft_psd_moments haft_psd_get_moments(const haft_psd *psd);

/** Normalised autocorrelation of heights at a distance r, accurate to about 1e-13: the Hankel
 *  transform 2 pi int s J0(zeta r) zeta dzeta / m0 of a checked PSD.
 *  @param[in] psd checked
 *  @param[in] r distance [m], >= 0
 *  Thread-safe. */
double haft_psd_correlation(const haft_psd *psd, double r);

/** The smallest distance at which haft_psd_correlation() is 1/e [m]. Thread-safe. */
double haft_psd_get_correlation_length(const haft_psd *psd);

/** The Hurst exponent H of a checked PSD, s ~ zeta^-(2 + 2 H) beyond the roll-off. H exceeds 1 for
 *  a steep PSD, and is -1 for a flat one. Thread-safe. */
double haft_psd_get_hurst(const haft_psd *psd);

/** A self-affine PSD in terms of quantities that are often published for surfaces. */
typedef struct haft_roughness {
    double rms;                /**< standard deviation of heights [m], sqrt(m0) */
    double correlation_length; /**< distance at which the autocorrelation falls to 1/e [m] */
    double hurst;              /**< 0 < H <= 1 */
    double zeta_max;           /**< wave number of the shortest wave [rad/m] */
} haft_roughness;

/** The self-affine PSD of a given roughness. Bisection finds the roll-off that gives the
 *  correlation length; the plateau follows from m0 in closed form.
 *  @param[out] out the PSD
 *  @param[in] roughness all four numbers
 *  @param[out] error one message on failure; may be NULL
 *  @return HAFT_ERROR_INPUT for numbers out of range, or a correlation length that no roll-off
 *  between zeta_max / 1e5 and zeta_max gives; the message names the nearest possible length.
 *  Thread-safe. */
haft_status haft_psd_from_roughness(haft_psd *out, const haft_roughness *roughness,
                                    haft_error *error) HAFT_MUST_CHECK;

/** Greenwood-Williamson parameters from moments. Source: McCool (1987). Thread-safe. */
haft_gw haft_gw_from_moments(haft_psd_moments moments);

/** A radial PSD given by points. s is a power law between neighbours, s[0] below zeta[0], and zero
 *  beyond the last point. */
typedef struct haft_psd_table {
    size_t n;      /**< at least 2 */
    double *zeta;  /**< increasing [rad/m] */
    double *s;     /**< positive [m^4] */
    double *count; /**< number of independent values averaged in s, whose standard error is
                      s/sqrt(count); NULL: s is exact */
} haft_psd_table;

/** Makes a table of n points. All numbers are 0; a count of 0 means no count. @return
 *  HAFT_ERROR_MEMORY. */
haft_status haft_psd_table_create(haft_psd_table **out, size_t n,
                                  haft_error *error) HAFT_MUST_CHECK;

/** Frees a table and sets the pointer to NULL; NULL is allowed. */
void haft_psd_table_destroy(haft_psd_table **table);

/** Checks that a table has at least two points, with finite, increasing zeta and finite, positive
 *  s. */
haft_status haft_psd_table_check(const haft_psd_table *table, haft_error *error) HAFT_MUST_CHECK;

/** s(zeta) of a checked table [m^4]. Thread-safe. */
double haft_psd_table_value(const haft_psd_table *table, double zeta);

/** The moments of a checked table in closed form (integrals of piecewise powers). Thread-safe. */
haft_psd_moments haft_psd_table_get_moments(const haft_psd_table *table);

/** Normalised autocorrelation of a checked table, as haft_psd_correlation(). Thread-safe. */
double haft_psd_table_correlation(const haft_psd_table *table, double r);

/** The smallest distance at which haft_psd_table_correlation() is 1/e [m]. Thread-safe. */
double haft_psd_table_get_correlation_length(const haft_psd_table *table);

/** The distribution of heights at a point, as a transformation q of a standard normal number, with
 *  mean 0 and variance 1. Read-only after creation; any number of threads can share it. */
typedef struct haft_marginal haft_marginal;

/** The Johnson distribution with given skewness and kurtosis (3 for normal): unbounded (sinh),
 *  bounded (logistic), lognormal on the line between the two, or normal. It exists for kurtosis >
 *  skewness^2 + 1.
 *  @return HAFT_ERROR_INPUT for a pair that no distribution has, or whose distribution is nearly
 *  two separate heights; the message names the nearest possible kurtosis for this skewness.
 *  HAFT_ERROR_MEMORY. Source: Johnson (1949). */
haft_status haft_marginal_johnson(haft_marginal **out, double skewness, double kurtosis,
                                  haft_error *error) HAFT_MUST_CHECK;

/** The empirical distribution of heights: their quantile function over the normal one. Beyond the
 *  outermost heights it is linear, with the mean slope between the 1 % quantile and the outermost
 *  height.
 *  @param[out] out the marginal; NULL after a failure
 *  @param[in] n number of heights
 *  @param[in] z heights, at least 100 that are not NAN; NANs are ignored
 *  @param[out] error one message on failure; may be NULL
 *  @return HAFT_ERROR_INPUT for fewer heights or no variance, HAFT_ERROR_MEMORY. */
haft_status haft_marginal_from_heights(haft_marginal **out, size_t n, const double *z,
                                       haft_error *error) HAFT_MUST_CHECK;

/** Frees a marginal and sets the pointer to NULL; NULL is allowed. */
void haft_marginal_destroy(haft_marginal **marginal);

/** q(g) by cubic interpolation in a table. Thread-safe. */
double haft_marginal_value(const haft_marginal *marginal, double g);

/** The family of a marginal ("Johnson SU", ...), and the moments of q(g), by quadrature. */
typedef struct haft_marginal_facts {
    const char *name; /**< of the family */
    double skewness;  /**< m3 / m2^1.5 */
    double kurtosis;  /**< m4 / m2^2, 3 if normal */
} haft_marginal_facts;

/** The facts of a marginal. Thread-safe. */
haft_marginal_facts haft_marginal_get_facts(const haft_marginal *marginal);

/** A plan to generate surfaces. Read-only after creation; any number of threads can share it.
 *
 *  Method. White noise on a lattice is convolved with a kernel of compact support. The lattice has
 *  step p * grid_step, where p is the largest integer with pi / (lattice step) >= zeta_max. Its
 *  noise is numbered from the beam's corner and drawn by counter. The kernel is the inverse
 *  transform of sqrt(s), tapered to zero at radius `reach`. A block transforms its own noise with a
 *  halo of that radius, multiplies it by the kernel's transform over the fine grid, and
 *  interpolates by zero padding beyond zeta_max plus the bandwidth of the taper. So the field is
 *  stationary by construction, adjoining blocks match, any block can be computed alone, and grids
 *  with a common lattice agree at common points. With a marginal the heights are sigma q(g), where
 *  g is a Gaussian surface of unit variance; its PSD is corrected until sigma q(g) has the required
 *  PSD (haft_surface_facts reports the error). The reach is the smallest for which the taper
 *  removes less than `tolerance` of the kernel's energy. Row i runs along the beam, column j across
 *  it. */
typedef struct haft_surface_plan haft_surface_plan;

/** The scratch buffers of one thread. */
typedef struct haft_surface_work haft_surface_work;

/** Specification of a surface. */
typedef struct haft_surface_spec {
    haft_psd psd; /**< used if there is no table */
    const haft_psd_table
        *table; /**< if not NULL, the PSD, instead of psd; read only while planning */
    const haft_marginal *marginal; /**< NULL: Gaussian; must outlive the plan */
    double grid_step;              /**< fine grid [m], pi / (64 zeta_max) to pi / zeta_max */
    size_t rows;      /**< fine rows of a block (along the beam); a multiple of the lattice ratio */
    size_t columns;   /**< fine columns (across the beam); a multiple of the lattice ratio */
    double tolerance; /**< share of the kernel's energy that the taper may remove, 1e-9 to 0.1; 0
                         means 1e-5 */
    haft_random_key key; /**< key of the noise */
} haft_surface_spec;

/** The grid of a surface may be this many times finer than pi / zeta_max. */
#define HAFT_SURFACE_FINEST 64

/** The number of fine steps in a lattice step for this PSD and grid, or 0 if the grid is too coarse
 *  to resolve the PSD's shortest wave. */
size_t haft_surface_lattice_ratio(const haft_psd *psd, double grid_step);

/** Makes a plan. @return HAFT_ERROR_INPUT if the grid is coarser than pi / zeta_max (or more than
 *  64 times finer), a size does not fit the lattice, or the tolerance needs a reach beyond 4000 /
 *  zeta_max; the message names the nearest valid value. Not thread-safe (FFTW planner). */
haft_status haft_surface_plan_create(haft_surface_plan **out, const haft_surface_spec *spec,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Frees a plan and sets the pointer to NULL; NULL is allowed. Not thread-safe (FFTW planner). */
void haft_surface_plan_destroy(haft_surface_plan **plan);

/** Facts of a plan. Its moments are those of the generated field itself (tapered, on its grid; with
 *  a marginal those of g, scaled to the PSD's variance). They are exact sums over the kernel's
 *  transform, to be compared with haft_psd_get_moments(). */
typedef struct haft_surface_facts {
    size_t lattice_ratio;         /**< fine steps in a lattice step */
    double reach;                 /**< radius of the kernel [m] */
    double taper_loss;            /**< share of the kernel's energy that the taper removes */
    haft_psd_moments moments;     /**< of the generated field, by spectral derivatives */
    haft_psd_moments differences; /**< m2, m4 by central differences on the fine grid */
    size_t work_bytes;            /**< size of one haft_surface_work */
    size_t halo_points;           /**< fine points transformed for a block, including the halo */
    double psd_error; /**< with a marginal, the largest relative error of the PSD's ring means below
                         0.95 zeta_max; 0 without */
    double
        beyond; /**< with a marginal, the share of the variance at wave numbers beyond zeta_max */
    double deviation; /**< with a marginal, the standard deviation of heights [m]. The PSD inside
                         the band is as specified, so m0 is the share 1 - beyond of its square */
    double leak; /**< share of the kernel's energy smeared beyond the lattice's band. The variance
                    may differ by this share between the fine points of a lattice cell */
} haft_surface_facts;

/** The facts of a plan. Thread-safe. */
void haft_surface_get_facts(const haft_surface_plan *plan, haft_surface_facts *facts);

/** Exact covariance E[z(x, y) z(x + i step, y + j step)] of the generated field [m^2], as the mean
 *  over the fine points of a lattice cell (see haft_surface_facts.leak). Zero for lags of at least
 *  twice the reach; NAN for shorter lags that exceed the block (rows or columns). Thread-safe. */
double haft_surface_covariance(const haft_surface_plan *plan, long i, long j);

/** Makes the scratch of one thread, which must not outlive the plan. Thread-safe (the FFTW plans
 *  belong to the plan). */
haft_status haft_surface_work_create(haft_surface_work **out, const haft_surface_plan *plan,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Frees the scratch and sets the pointer to NULL; NULL is allowed. */
void haft_surface_work_destroy(haft_surface_work **work);

/** Prepares the block that begins at row `first_row` of the surface with the number (realization,
 *  stream). For a beam, stream is 0 and first_row increases along it; independent patches are
 *  blocks at row 0, each with its own stream. first_row must be a multiple of the lattice ratio; it
 *  may be negative.
 *  @return HAFT_ERROR_ARGUMENT for a first_row that is no such multiple or beyond 2^30 in
 *  magnitude, or a stream of 2^32 or more.
 *  Thread-safe for distinct work. */
haft_status haft_surface_prepare(haft_surface_work *work, uint64_t realization, uint64_t stream,
                                 long first_row, haft_error *error) HAFT_MUST_CHECK;

/** Writes rows [row, row + n) of the prepared block: z[n][columns] in metres.
 *  @return HAFT_ERROR_ARGUMENT for rows outside the block, or if no block is prepared. Thread-safe
 *  for distinct work. */
haft_status haft_surface_rows(haft_surface_work *work, size_t row, size_t n, double *z,
                              haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
