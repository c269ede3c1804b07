/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file surface.h
 *  Power spectral densities, their moments, and Gaussian surfaces generated from them.
 *
 *  Convention: the variance is m0 = integral of s over the whole plane of wave vectors, with no
 *  factor 1/(2 pi)^2; only so do the published parameters give the published roughness. */
#ifndef HAFT_SURFACE_H
#define HAFT_SURFACE_H

#include "haft/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A self-affine isotropic PSD: s_0 up to zeta_0, then a power law down to s_1 at zeta_max, nothing
 *  beyond. Source: Hoang et al. (2017), Eq. 34. */
typedef struct haft_psd {
    double zeta_max; /**< shortest wave's number [rad/m] */
    double zeta_0;   /**< roll-off [rad/m], 0 < zeta_0 < zeta_max */
    double s_0;      /**< plateau [m^4] */
    double s_1;      /**< value at zeta_max [m^4], 0 < s_1 <= s_0 */
} haft_psd;

/** Spectral moments of a profile cut through an isotropic surface. */
typedef struct haft_psd_moments {
    double m0; /**< variance of height [m^2], 2 pi int s zeta dzeta */
    double m2; /**< variance of slope along a line, pi int s zeta^3 dzeta */
    double m4; /**< variance of curvature along a line [1/m^2], (3 pi/4) int s zeta^5 dzeta */
} haft_psd_moments;

/** Greenwood-Williamson parameters of the surface with given moments. */
typedef struct haft_gw {
    double alpha;            /**< bandwidth m0 m4 / m2^2 */
    double radius;           /**< mean summit radius [m], (3/8) sqrt(pi/m4) */
    double density;          /**< summits an area [1/m^2], m4 / (6 pi sqrt(3) m2) */
    double summit_deviation; /**< standard deviation of summit heights [m], sqrt(1-0.8968/alpha)
                                sqrt(m0) */
} haft_gw;

/** Checks 0 < zeta_0 < zeta_max and 0 < s_1 <= s_0, all finite. */
haft_status haft_psd_check(const haft_psd *psd, haft_error *error) HAFT_MUST_CHECK;

/** s(zeta) [m^4] of a checked PSD. Thread-safe. */
double haft_psd_value(const haft_psd *psd, double zeta);

/** The moments in closed form (piecewise powers). Thread-safe. */
haft_psd_moments haft_psd_get_moments(const haft_psd *psd);

/** Autocorrelation of heights a distance r apart over their variance, the Hankel transform
 *  2 pi int s J0(zeta r) zeta dzeta / m0 of a checked PSD, to about 1e-13.
 *  @param[in] psd checked
 *  @param[in] r distance [m], >= 0
 *  Thread-safe. */
double haft_psd_correlation(const haft_psd *psd, double r);

/** The least distance at which haft_psd_correlation() is 1/e [m]. Thread-safe. */
double haft_psd_get_correlation_length(const haft_psd *psd);

/** The Hurst exponent H of a checked PSD, s ~ zeta^-(2 + 2 H) beyond the roll-off; a steep PSD has
 *  one above 1, a flat one -1. Thread-safe. */
double haft_psd_get_hurst(const haft_psd *psd);

/** A self-affine PSD by what is often published of a surface. */
typedef struct haft_roughness {
    double rms;                /**< standard deviation of heights [m], sqrt(m0) */
    double correlation_length; /**< where the autocorrelation falls to 1/e [m] */
    double hurst;              /**< 0 < H <= 1 */
    double zeta_max;           /**< shortest wave's number [rad/m] */
} haft_roughness;

/** The self-affine PSD of given roughness: its roll-off is that whose correlation length is the one
 *  given, found by halving a bracket; its plateau follows from m0 in closed form.
 *  @param[out] out the PSD
 *  @param[in] roughness all four numbers
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT for numbers out of range, or a correlation length that no roll-off
 *  between zeta_max / 1e5 and zeta_max gives; the message names the nearest that one does.
 *  Thread-safe. */
haft_status haft_psd_from_roughness(haft_psd *out, const haft_roughness *roughness,
                                    haft_error *error) HAFT_MUST_CHECK;

/** Source: McCool (1987). Thread-safe. */
haft_gw haft_gw_from_moments(haft_psd_moments moments);

/** A radial PSD by points: s goes as a power between neighbours, is s[0] below zeta[0] and nothing
 *  beyond the last. */
typedef struct haft_psd_table {
    size_t n;      /**< at least 2 */
    double *zeta;  /**< increasing [rad/m] */
    double *s;     /**< positive [m^4] */
    double *count; /**< independent numbers behind s, an error of s/sqrt(count); NULL: exact */
} haft_psd_table;

/** Makes a table of n points, all 0, without counts. @return HAFT_ERROR_MEMORY. */
haft_status haft_psd_table_create(haft_psd_table **out, size_t n,
                                  haft_error *error) HAFT_MUST_CHECK;

/** Frees a table and sets the pointer to NULL; NULL is allowed. */
void haft_psd_table_destroy(haft_psd_table **table);

/** Finite, increasing, positive, at least two points. */
haft_status haft_psd_table_check(const haft_psd_table *table, haft_error *error) HAFT_MUST_CHECK;

/** s(zeta) of a checked table [m^4]. Thread-safe. */
double haft_psd_table_value(const haft_psd_table *table, double zeta);

/** The moments of a checked table, its powers integrated in closed form. Thread-safe. */
haft_psd_moments haft_psd_table_get_moments(const haft_psd_table *table);

/** Autocorrelation over the variance as haft_psd_correlation(), of a checked table. Thread-safe. */
double haft_psd_table_correlation(const haft_psd_table *table, double r);

/** The least distance at which it is 1/e [m]. Thread-safe. */
double haft_psd_table_get_correlation_length(const haft_psd_table *table);

/** The distribution of heights at a point, as a transformation q of a standard normal number: mean
 * 0, variance 1. Read-only once made, shared by any number of threads. */
typedef struct haft_marginal haft_marginal;

/** The Johnson distribution of a skewness and a kurtosis (3 if normal): unbounded (sinh), bounded
 *  (logistic), lognormal between the two, or normal. Exists for kurtosis > skewness^2 + 1.
 *  @return HAFT_ERROR_INPUT for a pair that no distribution has, or one so near to two points that
 *  no smooth one is meant; the message names the nearest kurtosis that can be had with this
 *  skewness. Source: Johnson (1949). */
haft_status haft_marginal_johnson(haft_marginal **out, double skewness, double kurtosis,
                                  haft_error *error) HAFT_MUST_CHECK;

/** The heights' own distribution: their quantile function against the normal one; beyond the
 * outermost heights it goes on as a straight line with the slope from the 1 % quantile on.
 *  @param[out] out the marginal; NULL after a failure
 *  @param[in] n heights
 *  @param[in] z heights, NAN ones left out; at least 100
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT for fewer, or no
 *  variance. */
haft_status haft_marginal_from_heights(haft_marginal **out, size_t n, const double *z,
                                       haft_error *error) HAFT_MUST_CHECK;

/** Frees a marginal and sets the pointer to NULL; NULL is allowed. */
void haft_marginal_destroy(haft_marginal **marginal);

/** q(g), by cubic interpolation of a table. Thread-safe. */
double haft_marginal_value(const haft_marginal *marginal, double g);

/** What it is ("Johnson SU", ...), and the moments of q(g), by quadrature. */
typedef struct haft_marginal_facts {
    const char *name; /**< of the family */
    double skewness;  /**< m3 / m2^1.5 */
    double kurtosis;  /**< m4 / m2^2, 3 if normal */
} haft_marginal_facts;

/** Those of a marginal. Thread-safe. */
haft_marginal_facts haft_marginal_get_facts(const haft_marginal *marginal);

/** A plan to generate surfaces: read-only once made, shared by any number of threads.
 *
 *  Method. White noise on a lattice of step p * grid_step (p the largest integer that keeps
 *  pi / lattice step >= zeta_max), numbered from the beam's corner and drawn by counter, is
 *  convolved with a kernel of compact support: the inverse transform of sqrt(s), tapered to zero at
 *  radius `reach`. A block transforms its own noise with a halo of that radius, multiplies by the
 *  kernel's transform over the fine grid, and interpolates by zero padding beyond zeta_max and what
 *  the taper smears. So the field is stationary by construction, blocks join as if they were one,
 *  any block can be had alone, and grids that share a lattice share their points. With a marginal
 *  the heights are sigma q(g), g the Gaussian surface of unit variance whose PSD is corrected until
 *  that of sigma q(g) is the one asked for (haft_surface_facts says how nearly). The
 *  reach is the smallest for which what the taper takes from the kernel's energy is below
 *  `tolerance`. Row i runs along the beam, column j across it. */
typedef struct haft_surface_plan haft_surface_plan;

/** The scratch of one thread: its buffers. */
typedef struct haft_surface_work haft_surface_work;

/** What a surface shall be like. */
typedef struct haft_surface_spec {
    haft_psd psd; /**< where there is no table */
    const haft_psd_table
        *table; /**< if not NULL, the PSD, instead of psd; only read while planning */
    const haft_marginal *marginal; /**< NULL: Gaussian; must outlive the plan */
    double grid_step;              /**< fine grid [m], pi / (64 zeta_max) to pi / zeta_max */
    size_t rows;      /**< fine rows in a block (along the beam); a multiple of the lattice ratio */
    size_t columns;   /**< fine columns (across the beam); a multiple of the lattice ratio */
    double tolerance; /**< energy the taper may take from the kernel, relative, 1e-9 to 0.1; 0 for
                           1e-5 */
    haft_random_key key; /**< of the noise */
} haft_surface_spec;

/** How many times finer than pi / zeta_max the grid of a surface may be. */
#define HAFT_SURFACE_FINEST 64

/** The number of fine steps in a lattice step for this PSD and grid, or 0 if the grid is too coarse
 *  to carry the PSD's shortest wave. */
size_t haft_surface_lattice_ratio(const haft_psd *psd, double grid_step);

/** @return HAFT_ERROR_INPUT when the grid is coarser than pi / zeta_max (or 64 times finer), a size
 *  does not fit the lattice, or the tolerance asks for a reach beyond 4000 / zeta_max; the message
 *  names the nearest value that does. Not thread-safe (FFTW planner). */
haft_status haft_surface_plan_create(haft_surface_plan **out, const haft_surface_spec *spec,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Frees a plan and sets the pointer to NULL; NULL is allowed. Not thread-safe (FFTW planner). */
void haft_surface_plan_destroy(haft_surface_plan **plan);

/** Facts of a plan. Moments are those of the generated field itself (tapered, on its grid; with a
 *  marginal those of g, scaled to the PSD's variance), exact sums over the kernel's transform, to
 * be compared with haft_psd_get_moments(). */
typedef struct haft_surface_facts {
    size_t lattice_ratio;         /**< fine steps in a lattice step */
    double reach;                 /**< the kernel's radius [m] */
    double taper_loss;            /**< kernel energy taken by the taper, relative */
    haft_psd_moments moments;     /**< of the generated field: spectral derivatives */
    haft_psd_moments differences; /**< m2, m4 by central differences on the fine grid */
    size_t work_bytes;            /**< what one haft_surface_work takes */
    size_t halo_points;           /**< fine points transformed for a block, halo included */
    double psd_error; /**< with a marginal, the largest relative error of the PSD's ring means below
                           0.95 zeta_max (0 without) */
    double beyond;    /**< with a marginal, the share of the variance beyond zeta_max */
    double deviation; /**< with a marginal, of the heights [m]: the PSD inside the band is the one
                           asked for, so its square exceeds m0 by that share */
    double leak; /**< kernel energy smeared beyond the lattice's band, relative: by how much the
                      variance may differ between fine points of a lattice cell */
} haft_surface_facts;

/** Those of a plan. Thread-safe. */
void haft_surface_get_facts(const haft_surface_plan *plan, haft_surface_facts *facts);

/** Covariance E[z(x, y) z(x + i step, y + j step)] of the generated field [m^2], exact (the mean
 *  over the fine points of a lattice cell, see haft_surface_facts.leak). Zero from twice the reach
 *  on; NAN for shorter lags that exceed the block (rows or columns). Thread-safe. */
double haft_surface_covariance(const haft_surface_plan *plan, long i, long j);

/** Thread-safe (the FFTW plans are the plan's); the work is one thread's own and must not outlive
 *  the plan. */
haft_status haft_surface_work_create(haft_surface_work **out, const haft_surface_plan *plan,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Frees it and sets the pointer to NULL; NULL is allowed. */
void haft_surface_work_destroy(haft_surface_work **work);

/** Prepares the block whose first row is `first_row` of the surface numbered (realization, stream).
 *  For a beam, stream is 0 and first_row moves along it; independent patches are blocks at row 0 of
 *  their own stream. first_row must be a multiple of the lattice ratio (negative is allowed).
 *  @return HAFT_ERROR_ARGUMENT for another first_row, one beyond 2^30, or a stream of 2^32 or more.
 *  Thread-safe for distinct work. */
haft_status haft_surface_prepare(haft_surface_work *work, uint64_t realization, uint64_t stream,
                                 long first_row, haft_error *error) HAFT_MUST_CHECK;

/** Writes rows [row, row + n) of the prepared block: z[n][columns] in metres.
 *  @return HAFT_ERROR_ARGUMENT for rows outside the block or a block not prepared. Thread-safe for
 *  distinct work. */
haft_status haft_surface_rows(haft_surface_work *work, size_t row, size_t n, double *z,
                              haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
