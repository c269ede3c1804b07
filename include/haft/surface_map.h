/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file surface_map.h
 *  Measured height maps: levelling, masking, statistics and power spectral density.
 *
 *  The row index i counts along y, the column index j along x; a missing pixel is NAN. Spectra
 *  follow the convention of surface.h: the variance is the integral of s over the plane of wave
 *  vectors. */
#ifndef HAFT_SURFACE_MAP_H
#define HAFT_SURFACE_MAP_H

#include "haft/surface.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { HAFT_CHANNEL_CAPACITY = 64, HAFT_NOTE_CAPACITY = 512 };

/** Heights on a rectangular grid. The creator owns it. */
typedef struct haft_map {
    size_t rows;                         /**< at least 2 */
    size_t columns;                      /**< at least 2 */
    double step_row;                     /**< pixel along y [m] */
    double step_column;                  /**< pixel along x [m] */
    double *z;                           /**< rows x columns [m], NAN where missing */
    char channel[HAFT_CHANNEL_CAPACITY]; /**< its name in the file */
    char format[HAFT_CHANNEL_CAPACITY];  /**< the file format that it was read from */
    char note[HAFT_NOTE_CAPACITY];       /**< assumptions that the reader made; may be empty */
} haft_map;

/** Largest number of pixels along a side of a map. */
#define HAFT_MAP_SIDE_MOST 32768

/** Makes a map with zero heights. @return HAFT_ERROR_INPUT for fewer than 2 or more than
 *  HAFT_MAP_SIDE_MOST pixels along a side, or a pixel size that is not positive;
 *  HAFT_ERROR_MEMORY. */
haft_status haft_map_create(haft_map **out, size_t rows, size_t columns, double step_row,
                            double step_column, haft_error *error) HAFT_MUST_CHECK;

/** Copies a map. @return HAFT_ERROR_MEMORY. */
haft_status haft_map_copy(haft_map **out, const haft_map *map, haft_error *error) HAFT_MUST_CHECK;

/** Frees a map and sets the pointer to NULL; NULL is allowed. */
void haft_map_destroy(haft_map **map);

/** What is subtracted from a map before it is analysed, fitted by least squares over its pixels. */
typedef enum haft_level {
    HAFT_LEVEL_MEAN,      /**< its mean */
    HAFT_LEVEL_PLANE,     /**< a plane */
    HAFT_LEVEL_QUADRATIC, /**< 1, x, y, x^2, xy, y^2 */
    HAFT_LEVEL_LINES,     /**< a plane, then mean and slope of each scan line */
} haft_level;

/** How missing pixels are treated. */
typedef enum haft_missing {
    HAFT_MISSING_EXCLUDE, /**< ignored in statistics; a PSD is estimated from a filled copy */
    HAFT_MISSING_FILL,    /**< filled with drawn heights, see haft_map_fill() */
} haft_missing;

/** The window function that multiplies a map before its transform, along x and along y. */
typedef enum haft_window {
    HAFT_WINDOW_NONE,
    HAFT_WINDOW_HANN,     /**< sin^2(pi t), t from 0 to 1 over the side, pixel centres */
    HAFT_WINDOW_WELCH,    /**< 1 - (2t - 1)^2 */
    HAFT_WINDOW_BLACKMAN, /**< 0.42 - 0.5 cos(2 pi t) + 0.08 cos(4 pi t) */
    HAFT_WINDOW_TUKEY,    /**< flat, with sin^2 flanks over an eighth of the side each */
} haft_window;

/** Levels a map in place. With HAFT_LEVEL_LINES, a line without pixels is left alone, and a single
 *  pixel of a line becomes missing. @return HAFT_ERROR_INPUT if too few pixels are left to
 *  determine the terms. Thread-safe for distinct maps. */
haft_status haft_map_level(haft_map *map, haft_level level, haft_error *error) HAFT_MUST_CHECK;

/** Marks pixels as missing that lie further than `limit` times 1.4826 MAD from the median (MAD:
 *  median absolute deviation; for normal heights this is `limit` standard deviations).
 *  @return HAFT_ERROR_INPUT if more than half of the pixels would be masked, or if 1.4826 MAD is 0
 *  or less than the step that heights are rounded to: outliers cannot be identified then. */
haft_status haft_map_mask(haft_map *map, double limit, size_t *masked,
                          haft_error *error) HAFT_MUST_CHECK;

/** Number of missing pixels of a map. Thread-safe. */
size_t haft_map_count_missing(const haft_map *map);

/** Largest share of missing pixels for which a map is filled. Up to this share, tests verify that
 *  its PSD is accurate to 5 %. */
#define HAFT_MISSING_MOST 0.3

/** Fills the missing pixels of a levelled map with heights drawn from the Gaussian process with the
 *  map's own radial PSD, conditional on the known heights (sequential Gaussian simulation). Pixels
 *  are drawn one at a time, coarse grid first; mean and deviation are conditional on the nearest 24
 *  heights known or drawn. The PSD is estimated from the filled map, and the drawing is repeated
 *  until the first guess has no effect (stochastic expectation maximisation). So a filled map has,
 *  on average, the PSD of a complete one. Interpolation would lack short waves; zeros would add
 *  some.
 *  @param[in,out] map filled in place; the result for a given map is always the same
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if more than HAFT_MISSING_MOST of the pixels are missing.
 *  Not thread-safe (FFTW).
 *  Source: Deutsch and Journel (1998), V.2; Celeux and Diebolt (1985). */
haft_status haft_map_fill(haft_map *map, haft_error *error) HAFT_MUST_CHECK;

/** How a map is cleaned before it is analysed. */
typedef struct haft_clean_spec {
    haft_level level;     /**< what is subtracted */
    double outlier_limit; /**< see haft_map_mask(); 0: no masking */
    haft_missing missing; /**< how missing pixels are treated */
} haft_clean_spec;

/** Results of cleaning a map. */
typedef struct haft_clean_facts {
    size_t missing; /**< pixels missing in the file, or single in a line to be levelled */
    size_t masked;  /**< pixels masked as outliers */
} haft_clean_facts;

/** Levels, masks, levels again without the masked pixels, and fills if the spec says so.
 *  @param[in,out] map cleaned in place
 *  @param[in] spec the steps
 *  @param[out] facts may be NULL.
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_map_clean(haft_map *map, const haft_clean_spec *spec, haft_clean_facts *facts,
                           haft_error *error) HAFT_MUST_CHECK;

/** Statistics of a map over the pixels that are present; moments are about the mean. */
typedef struct haft_map_statistics {
    size_t pixels;            /**< number of pixels present */
    size_t missing;           /**< number of missing pixels */
    double mean;              /**< [m] */
    double rms;               /**< about the mean [m] */
    double skewness;          /**< m3/m2^1.5 */
    double kurtosis;          /**< m4/m2^2, 3 if normal */
    double least;             /**< [m] */
    double greatest;          /**< [m] */
    double slope_x;           /**< variance of central-difference slopes along x */
    double slope_y;           /**< and along y */
    double curvature_x;       /**< variance of second differences along x [1/m^2] */
    double curvature_y;       /**< and along y [1/m^2] */
    haft_psd_moments moments; /**< m0; m2 and m4 as means of the slope and curvature variances along
                                 x and y; NAN without three adjacent pixels in a line */
    double correlation_length; /**< distance at which the radial autocorrelation falls to 1/e [m];
                                  NAN if it does not within half the shorter side */
} haft_map_statistics;

/** Statistics by two-pass sums, and the autocorrelation by FFT of the zero-padded map, each lag
 *  divided by its number of pairs.
 *  @return HAFT_ERROR_INPUT for fewer than 4 pixels or no variance. Not thread-safe (FFTW). */
haft_status haft_map_get_statistics(haft_map_statistics *out, const haft_map *map,
                                    haft_error *error) HAFT_MUST_CHECK;

/** Areal parameters of ISO 25178-2 for a levelled and cleaned map. Heights are about the mean;
 *  missing pixels are ignored. Slopes are differences of neighbouring pixels, taken at the corners
 *  of each cell whose four pixels are present. Sdq and the area of Sdr are means over both
 *  triangulations of the cells (exact for planes, second order in the pixel size). The
 *  autocorrelation f is that of haft_map_statistics, along straight lines from lag 0 to every lag
 *  on the border of half the map's sides, bilinear between pixels. */
typedef struct haft_map_texture {
    double sq;      /**< root mean square height [m] */
    double sa;      /**< mean of |z| [m] */
    double sp;      /**< highest peak [m] */
    double sv;      /**< depth of the deepest pit, positive [m] */
    double sz;      /**< sp + sv [m] */
    double ssk;     /**< mean of z^3 / sq^3 */
    double sku;     /**< mean of z^4 / sq^4 */
    double sdq;     /**< root mean square slope; NAN without a complete cell of four pixels */
    double sdr;     /**< developed area over its projection, minus 1; NAN like sdq */
    double sal;     /**< smallest lag at which f falls to 0.2 [m]; NAN if it never does */
    double slowest; /**< largest lag, over all directions, at which f first falls to 0.2 [m];
                       INFINITY if in some direction it does not within half the map */
    double reach; /**< largest lag searched in such a direction [m]; otherwise equal to `slowest` */
    double str;   /**< sal / slowest: 1 if isotropic; 0 if slowest is INFINITY, and then sal / reach
                     is an upper bound; NAN if sal is */
} haft_map_texture;

/** The value of the autocorrelation that defines Sal and Str, the standard's default. */
#define HAFT_TEXTURE_DECAY 0.2

/** Computes the areal parameters of a map.
 *  @param[out] out all parameters
 *  @param[in] map levelled and cleaned
 *  @param[out] error one message where it fails; may be NULL
 *  Source: ISO 25178-2:2021 (as in 2012), 4.2 to 4.4.
 *  @return HAFT_ERROR_INPUT for fewer than 4 pixels or no variance. Not thread-safe (FFTW). */
haft_status haft_map_get_texture(haft_map_texture *out, const haft_map *map,
                                 haft_error *error) HAFT_MUST_CHECK;

/** Two-dimensional PSD estimate S(m, n) = dx dy / (4 pi^2 sum w^2) |DFT(w (z - mean_w))|^2 at wave
 *  vector (2 pi m / (rows step_row), 2 pi n / (columns step_column)). Its sum times the area of a
 *  wave-vector cell is sum w^2 (z - mean_w)^2 / sum w^2, the variance. mean_w is the mean weighted
 *  by w. A missing pixel has w = 0, which spreads power over all wave vectors; haft_psd_estimate()
 *  avoids this.
 *  @param[out] s rows x columns [m^4], in the order of the discrete Fourier transform
 *  @param[in] map a cleaned map
 *  @param[in] window that multiplies the map
 *  Source: Hoang et al. (2017), Eq. 9, in the convention of surface.h. Not thread-safe (FFTW).
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_map_spectrum(double *s, const haft_map *map, haft_window window,
                              haft_error *error) HAFT_MUST_CHECK;

/** Radial PSD of n cleaned maps of one surface. Rings are as wide as the largest mode spacing of
 *  the maps, or a fortieth of a decade where that is wider (which biases a fifth power by 0.5 %).
 *  zeta and s of a ring are means over its modes in all maps, each map up to the smaller of its
 *  Nyquist wave numbers. Its count is half the number of modes, as modes of real fields are
 *  conjugate pairs, over N sum w^4 / (sum w^2)^2, which accounts for the correlation of
 *  neighbouring modes due to the window. A map with missing pixels is filled first (haft_map_fill()
 *  on a copy), and its modes are weighted by the square of the known share of sum w^2.
 *  @param[out] out the PSD; NULL after a failure
 *  @param[in] n number of maps
 *  @param[in] maps [n]
 *  @param[in] window applied to each map
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT for no maps, a map without variance, or one with more than
 *  HAFT_MISSING_MOST of its pixels missing. Not thread-safe (FFTW). */
haft_status haft_psd_estimate(haft_psd_table **out, size_t n, const haft_map *const *maps,
                              haft_window window, haft_error *error) HAFT_MUST_CHECK;

/** Removes the points beyond zeta_max, which becomes the last point, with an interpolated value.
 *  @return HAFT_ERROR_INPUT if fewer than two points are left. */
haft_status haft_psd_table_cut(haft_psd_table *table, double zeta_max,
                               haft_error *error) HAFT_MUST_CHECK;

/** Largest rms curvature of the waves, as a share of the tip's curvature. From dilated maps with
 *  Hurst exponent 0.8: dilation removes 4 % of the PSD at 0.05, 10 % at 0.1 and 40 % at 0.3, for
 *  tips of 50 and of 120 nm. */
#define HAFT_TIP_SHARE 0.05

/** The highest wave number that a tip of this radius measures reliably. Up to it, the rms mean
 *  curvature of the waves, sqrt(2 pi int s (k^2/2)^2 k dk), is HAFT_TIP_SHARE/radius; INFINITY if
 *  it never reaches that. After Sanner, Noehring, Thimons, Jacobs and Pastewka (2022), who compare
 *  the sharpest curvature at a scale with half of the tip's. */
double haft_psd_tip_limit(const haft_psd_table *table, double radius);

/** PSD of the gap between two faces, s1 + s2 + 2 coherence sqrt(s1 s2). Heights are positive out of
 *  each body: coherence is 0 for independent faces (Hoang et al. 2017, Eq. 11), -1 for mating
 *  faces, 1 for mirror images. The result has the points of both tables within their common range.
 *  @param[out] out the PSD; NULL after a failure
 *  @param[in] first, second PSDs of the two faces
 *  @param[in] coherence -1 to 1
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_psd_combine(haft_psd_table **out, const haft_psd_table *first,
                             const haft_psd_table *second, double coherence,
                             haft_error *error) HAFT_MUST_CHECK;

/** A self-affine PSD fitted to a table, plus a constant floor due to white noise. */
typedef struct haft_psd_fit {
    haft_psd psd;   /**< most likely form, up to the smallest of the limits below */
    double hurst;   /**< s ~ zeta^-(2 + 2 H) beyond the roll-off */
    double low[3];  /**< lower ends of the 95 % intervals of s_0 [m^4], zeta_0 [rad/m] and H; 0 or
                       -INFINITY if the table sets no limit */
    double high[3]; /**< their upper ends; INFINITY if the table sets no limit */
    bool determined[3]; /**< whether the intervals of s_0 and of zeta_0 are within a factor of 10,
                           and that of H within 1 */
    double rms[3];      /**< sqrt(m0) of the form, and the ends of its 95 % interval [m] */
    size_t rings;       /**< number of rings fitted */
    double from;        /**< wave number of the first ring [rad/m] */
    double to;          /**< wave number of the last ring [rad/m] */
    double cut_off; /**< wave number at which the table drops below the form [rad/m]; INFINITY if
                       none */
    double floor;   /**< the constant floor [m^4] */
    double noise_limit; /**< wave number at which the floor equals the form [rad/m]; INFINITY if not
                           within the table */
    double misfit;      /**< deviance per degree of freedom, 1 on average if the form is right */
    double p_value;     /**< probability of a larger misfit if the form were right */
    double deviation; /**< s over the form, minus 1, averaged over an eighth of a decade, where this
                         exceeds its error most; 0 if nowhere */
    double deviation_at; /**< wave number of that deviation [rad/m] */
} haft_psd_fit;

/** Fits the self-affine form plus a floor to a table by maximum likelihood. s of a ring is Gamma
 *  distributed with its count N as shape (1 if there is none), so the best form m has the smallest
 *  deviance, sum 2 N (s/m - 1 - log(s/m)). The fit uses the points from twice the first wave number
 *  (levelling and window change those below) to the cut-off; a table without counts is used from
 *  its first point. A cut-off is searched for only if the p-value of the fit is below 0.001. It is
 *  the highest wave number below which the form fits and beyond which the table is less than half
 *  of form plus floor; its exact place is where a sharp edge would leave the same power. Intervals
 *  come from the profile likelihood over the roll-off, with Student's t, widened by the misfit if
 *  that exceeds 1.
 *  @param[out] out the fit
 *  @param[in] table with at least 6 points in the range used
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT for too few points; HAFT_ERROR_NUMERIC if the PSD does not fall, or
 *  falls no faster than zeta^-2 (H = 0), if the floor hides all of it, or if the form's variance of
 *  heights or slopes over the rings used differs from the table's by more than a quarter plus three
 *  standard errors; HAFT_ERROR_MEMORY. Thread-safe.
 *  Source: Jacobs, Junge and Pastewka (2017) for the limits of a measured PSD. */
haft_status haft_psd_fit_self_affine(haft_psd_fit *out, const haft_psd_table *table,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Patches composed of adjacent windows of measured maps: the surface as measured, as a reference
 *  for a generator. The map, the place and the mirroring of each window are random (a bootstrap of
 *  the maps). Windows are at most half as long as the smallest map, so that they vary. Heights jump
 *  where windows meet, so features across such a seam (an island, a slope) are cut there. Maps are
 *  resampled to the grid by natural cubic splines along x, then y. Read-only after creation. */
typedef struct haft_tiling haft_tiling;

/** What patches are composed of. */
typedef struct haft_tiling_spec {
    size_t n;                    /**< number of maps of the face, cleaned, without missing pixels */
    const haft_map *const *maps; /**< n */
    size_t opposite_n; /**< number of maps of the other face; 0: it is flat. The heights of both are
                          added */
    const haft_map *const *opposite; /**< opposite_n */
    double grid_step;                /**< [m] */
    size_t rows;                     /**< grid points of a patch along the beam */
    size_t columns;                  /**< grid points of a patch across the beam */
    uint64_t seed;                   /**< seed of the random windows */
} haft_tiling_spec;

/** Makes a tiling. @return HAFT_ERROR_INPUT for no maps, missing pixels, or a map with fewer than 4
 *  grid points along a side; HAFT_ERROR_MEMORY. */
haft_status haft_tiling_create(haft_tiling **out, const haft_tiling_spec *spec,
                               haft_error *error) HAFT_MUST_CHECK;

/** Frees a tiling and sets the pointer to NULL; NULL is allowed. */
void haft_tiling_destroy(haft_tiling **tiling);

/** Writes the patch with the number (realization, stream): z[rows][columns] [m]. Thread-safe. */
void haft_tiling_fill(const haft_tiling *tiling, uint64_t realization, uint64_t stream, double *z);

/** The number of windows in a patch, by rows and by columns. Thread-safe. */
void haft_tiling_count(const haft_tiling *tiling, size_t count[2]);

#ifdef __cplusplus
}
#endif
#endif
