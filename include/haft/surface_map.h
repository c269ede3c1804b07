/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file surface_map.h
 *  Measured height maps: levelling, masking, statistics, and their power spectral density.
 *
 *  Row i runs along y and column j along x; a missing pixel is NAN. The convention for spectra is
 *  that of surface.h: the variance is the integral of s over the plane of wave vectors. */
#ifndef HAFT_SURFACE_MAP_H
#define HAFT_SURFACE_MAP_H

#include "haft/surface.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { HAFT_CHANNEL_CAPACITY = 64, HAFT_NOTE_CAPACITY = 512 };

/** Heights on a rectangular grid. Owned by whoever made it. */
typedef struct haft_map {
    size_t rows;                         /**< at least 2 */
    size_t columns;                      /**< at least 2 */
    double step_row;                     /**< pixel along y [m] */
    double step_column;                  /**< pixel along x [m] */
    double *z;                           /**< rows x columns [m], NAN where missing */
    char channel[HAFT_CHANNEL_CAPACITY]; /**< what the file calls it */
    char format[HAFT_CHANNEL_CAPACITY];  /**< what kind of file it came from */
    char note[HAFT_NOTE_CAPACITY];       /**< what its reader had to assume; may be empty */
} haft_map;

/** Most pixels of a map along one side. */
#define HAFT_MAP_SIDE_MOST 32768

/** Heights zero. @return HAFT_ERROR_INPUT for fewer than 2 or more than HAFT_MAP_SIDE_MOST pixels a
 * side, or a pixel that is not positive. */
haft_status haft_map_create(haft_map **out, size_t rows, size_t columns, double step_row,
                            double step_column, haft_error *error) HAFT_MUST_CHECK;

/** A copy of a map. @return HAFT_ERROR_MEMORY. */
haft_status haft_map_copy(haft_map **out, const haft_map *map, haft_error *error) HAFT_MUST_CHECK;

/** Frees a map and sets the pointer to NULL; NULL is allowed. */
void haft_map_destroy(haft_map **map);

/** What is taken off a map before anything is read from it, by least squares over its pixels. */
typedef enum haft_level {
    HAFT_LEVEL_MEAN,      /**< its mean */
    HAFT_LEVEL_PLANE,     /**< a plane */
    HAFT_LEVEL_QUADRATIC, /**< 1, x, y, x^2, xy, y^2 */
    HAFT_LEVEL_LINES,     /**< a plane, then each scan line's own mean and slope */
} haft_level;

/** What becomes of missing pixels. */
typedef enum haft_missing {
    HAFT_MISSING_EXCLUDE, /**< left out of statistics; a PSD is estimated from a filled copy */
    HAFT_MISSING_FILL,    /**< heights are drawn for them, see haft_map_fill() */
} haft_missing;

/** What a map is multiplied by before its transform, along x and along y. */
typedef enum haft_window {
    HAFT_WINDOW_NONE,
    HAFT_WINDOW_HANN,     /**< sin^2(pi t), t from 0 to 1 over the side, pixel centres */
    HAFT_WINDOW_WELCH,    /**< 1 - (2t - 1)^2 */
    HAFT_WINDOW_BLACKMAN, /**< 0.42 - 0.5 cos(2 pi t) + 0.08 cos(4 pi t) */
    HAFT_WINDOW_TUKEY,    /**< flat, with sin^2 flanks of an eighth of the side */
} haft_window;

/** Levels a map in place. By lines, a line without pixels stays as it is, and the only pixel of a
 *  line becomes a missing one. @return HAFT_ERROR_INPUT if too few pixels are left to tell the
 *  terms. Thread-safe for distinct maps. */
haft_status haft_map_level(haft_map *map, haft_level level, haft_error *error) HAFT_MUST_CHECK;

/** Marks as missing what lies further than `limit` times 1.4826 MAD from the median (MAD: median
 *  absolute deviation; for normal heights, `limit` standard deviations).
 *  @return HAFT_ERROR_INPUT if more than half of the pixels go, or if 1.4826 MAD is 0 or less than
 *  the step that heights are rounded to: outliers cannot be told then. */
haft_status haft_map_mask(haft_map *map, double limit, size_t *masked,
                          haft_error *error) HAFT_MUST_CHECK;

/** Pixels of a map that are missing. Thread-safe. */
size_t haft_map_count_missing(const haft_map *map);

/** Share of missing pixels up to which a map is filled: tests hold its PSD to 5 % up to here. */
#define HAFT_MISSING_MOST 0.3

/** Fills the missing pixels of a levelled map with heights drawn from the Gaussian process of its
 * own radial PSD, given the heights that are there: pixel by pixel, coarse grid first, the mean and
 * deviation being those given the nearest 24 that are known or drawn (sequential Gaussian
 * simulation). The PSD is estimated from the filled map and the drawing repeated until the first
 * guess is forgotten (stochastic expectation maximisation), so a filled map has the PSD of a whole
 * one on average. An interpolation instead lacks short waves, and a zero adds some.
 *  @param[in,out] map filled in place; the same map is always filled alike
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if more than HAFT_MISSING_MOST of the pixels are missing.
 *  Not thread-safe (FFTW).
 *  Source: Deutsch and Journel (1998), V.2; Celeux and Diebolt (1985). */
haft_status haft_map_fill(haft_map *map, haft_error *error) HAFT_MUST_CHECK;

/** What is done with a map before anything is read from it. */
typedef struct haft_clean_spec {
    haft_level level;     /**< what is taken off */
    double outlier_limit; /**< see haft_map_mask(); 0: none are masked */
    haft_missing missing; /**< what becomes of missing pixels */
} haft_clean_spec;

/** What cleaning a map found. */
typedef struct haft_clean_facts {
    size_t missing; /**< pixels that the file lacked, or that were alone in a line to be levelled */
    size_t masked;  /**< pixels masked as outliers */
} haft_clean_facts;

/** Levels, masks, levels again without what was masked, fills if asked.
 *  @param[in,out] map cleaned in place
 *  @param[in] spec what is done
 *  @param[out] facts may be
 *  NULL.
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_map_clean(haft_map *map, const haft_clean_spec *spec, haft_clean_facts *facts,
                           haft_error *error) HAFT_MUST_CHECK;

/** Moments of heights over the pixels that are there, about their mean. */
typedef struct haft_map_statistics {
    size_t pixels;             /**< in all */
    size_t missing;            /**< of them */
    double mean;               /**< [m] */
    double rms;                /**< about the mean [m] */
    double skewness;           /**< m3/m2^1.5 */
    double kurtosis;           /**< m4/m2^2, 3 if normal */
    double least;              /**< [m] */
    double greatest;           /**< [m] */
    double slope_x;            /**< variance of central-difference slopes along x */
    double slope_y;            /**< and along y */
    double curvature_x;        /**< variance of second differences along x [1/m^2] */
    double curvature_y;        /**< and along y [1/m^2] */
    haft_psd_moments moments;  /**< m0, and the means of x and y by differences; NAN without three
                                    pixels in a row */
    double correlation_length; /**< where the radial autocorrelation falls to 1/e [m]; NAN if it
                                    does not within half the shorter side */
} haft_map_statistics;

/** Two-pass sums; the autocorrelation by FFT of the zero-padded map, each lag divided by its pairs.
 *  @return HAFT_ERROR_INPUT for fewer than 4 pixels or no variance. Not thread-safe (FFTW). */
haft_status haft_map_get_statistics(haft_map_statistics *out, const haft_map *map,
                                    haft_error *error) HAFT_MUST_CHECK;

/** Areal parameters of ISO 25178-2, of a map levelled and cleaned. Heights are about the mean;
 *  missing pixels are left out. Slopes are differences of neighbouring pixels, at the corners of
 *  each cell of four that are there: Sdq and the area of Sdr are means over both triangulations of
 *  the cells (exact for planes, of second order in the pixel). The autocorrelation f is that of
 *  haft_map_statistics, along straight lines from lag 0 to every lag of half the map's sides,
 *  bilinear between pixels. */
typedef struct haft_map_texture {
    double sq;      /**< root mean square height [m] */
    double sa;      /**< mean of |z| [m] */
    double sp;      /**< highest peak [m] */
    double sv;      /**< deepest pit, counted down [m] */
    double sz;      /**< sp + sv [m] */
    double ssk;     /**< mean of z^3 / sq^3 */
    double sku;     /**< mean of z^4 / sq^4 */
    double sdq;     /**< root mean square slope; NAN without four pixels in a square */
    double sdr;     /**< developed area over its projection, less 1; NAN as sdq */
    double sal;     /**< least lag at which f falls to 0.2 [m]; NAN where it does nowhere */
    double slowest; /**< greatest lag, over all directions, at which f first falls to 0.2 [m];
                         INFINITY where in some direction it does not within half the map */
    double reach;   /**< in that direction, how far was looked [m]; else the lag of `slowest` */
    double str;     /**< sal / slowest: 1 isotropic; 0 where slowest is INFINITY, when sal / reach
                         bounds it; NAN where sal is */
} haft_map_texture;

/** The value of the autocorrelation at which Sal and Str are read, the standard's default. */
#define HAFT_TEXTURE_DECAY 0.2

/** Those of a map.
 *  @param[out] out all parameters
 *  @param[in] map levelled and cleaned
 *  @param[out] error one message where it fails; may be NULL
 *  Source: ISO 25178-2:2021 (as in 2012), 4.2 to 4.4.
 *  @return HAFT_ERROR_INPUT for fewer than 4 pixels or no variance. Not thread-safe (FFTW). */
haft_status haft_map_get_texture(haft_map_texture *out, const haft_map *map,
                                 haft_error *error) HAFT_MUST_CHECK;

/** Two-dimensional estimate S(m, n) = dx dy / (4 pi^2 sum w^2) |DFT(w (z - mean_w))|^2 at wave
 *  vector (2 pi m / (rows step_row), 2 pi n / (columns step_column)), which sums to
 *  sum w^2 (z - mean_w)^2 / sum w^2 times the cell of wave vectors: the variance. mean_w is the
 * mean weighted by w. A missing pixel has w = 0, which spreads power over all wave vectors:
 * haft_psd_estimate() does better.
 *  @param[out] s rows x columns [m^4], in the order of the transform
 *  @param[in] map cleaned
 *  @param[in] window it is multiplied by
 *  Source: Hoang et al. (2017), Eq. 9, in the convention of surface.h. Not thread-safe (FFTW).
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_map_spectrum(double *s, const haft_map *map, haft_window window,
                              haft_error *error) HAFT_MUST_CHECK;

/** Radial PSD of n maps of one surface, cleaned. Rings are as wide as the coarsest mode and from
 *  where that is finer, a fortieth of a decade (by which a fifth power is off by 0.5 %); a ring's s
 * is the mean of all modes inside, of all maps up to each one's own shorter Nyquist wave number,
 * less what a ring's width adds to it by the PSD's bend. Its count is half the modes (they are real
 * fields' conjugate pairs) over N sum w^4 / (sum w^2)^2, by which the window makes neighbours
 * depend on each other. A map with missing pixels is filled first (haft_map_fill() on a copy), and
 * its modes count by the square of the share of sum w^2 that is known.
 *  @param[out] out the PSD; NULL after a failure
 *  @param[in] n how many maps
 *  @param[in] maps [n]
 *  @param[in] window applied to each map
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT for no maps, a map without variance, or one that lacks more than
 *  HAFT_MISSING_MOST of its pixels. Not thread-safe (FFTW). */
haft_status haft_psd_estimate(haft_psd_table **out, size_t n, const haft_map *const *maps,
                              haft_window window, haft_error *error) HAFT_MUST_CHECK;

/** Drops what lies beyond zeta_max (which becomes the last point's, interpolated).
 *  @return HAFT_ERROR_INPUT if fewer than two points are left. */
haft_status haft_psd_table_cut(haft_psd_table *table, double zeta_max,
                               haft_error *error) HAFT_MUST_CHECK;

/** Share of the tip's curvature that the waves' rms curvature may reach. Measured on dilated maps
 * of Hurst exponent 0.8: at 0.05 dilation takes 4 % of the PSD, at 0.1 a tenth, at 0.3 four tenths,
 * for tips of 50 and 120 nm alike. */
#define HAFT_TIP_SHARE 0.05

/** The highest wave number a tip of this radius can be trusted with: up to it, waves have a mean
 *  curvature of rms HAFT_TIP_SHARE/radius, sqrt(2 pi int s (k^2/2)^2 k dk); INFINITY if they never
 *  have. After Sanner, Noehring, Thimons, Jacobs and Pastewka (2022), who compare a scale's
 * sharpest curvature with half of the tip's. */
double haft_psd_tip_limit(const haft_psd_table *table, double radius);

/** PSD of the gap between two faces, s1 + s2 + 2 coherence sqrt(s1 s2), heights being counted out
 * of either body: coherence 0 for independent faces (Hoang et al. 2017, Eq. 11), -1 for faces that
 *  mate, 1 for mirror images. On the points of both where both reach.
 *  @param[out] out the PSD; NULL after a failure
 *  @param[in] first, second of the faces
 *  @param[in] coherence -1 to 1
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_psd_combine(haft_psd_table **out, const haft_psd_table *first,
                             const haft_psd_table *second, double coherence,
                             haft_error *error) HAFT_MUST_CHECK;

/** A self-affine PSD fitted to a table, with a constant floor under it: what a white noise adds. */
typedef struct haft_psd_fit {
    haft_psd psd;       /**< most likely form, up to the least of the limits below */
    double hurst;       /**< s ~ zeta^-(2 + 2 H) beyond the roll-off */
    double low[3];      /**< lower ends of 95 % intervals of s_0 [m^4], zeta_0 [rad/m] and H; 0 or
                             -INFINITY where the table sets none */
    double high[3];     /**< and their upper ends; INFINITY where the table sets none */
    bool determined[3]; /**< interval of s_0 and of zeta_0 within a factor of 10, of H within 1 */
    double rms[3];      /**< of all heights that the form makes, sqrt(m0), and the ends of its 95 %
                             interval [m] */
    size_t rings;       /**< fitted */
    double from;        /**< wave number of the first of them [rad/m] */
    double to;          /**< and of the last [rad/m] */
    double cut_off;     /**< where the table drops out of the form [rad/m]; INFINITY if nowhere */
    double floor;       /**< [m^4] */
    double
        noise_limit;  /**< where the floor equals the form [rad/m]; INFINITY if that is not seen */
    double misfit;    /**< deviance a degree of freedom, 1 where the form is right */
    double p_value;   /**< chance of a greater misfit if the form were right */
    double deviation; /**< s over the form less 1, mean over an eighth of a decade, where that is
                           largest beyond its error; 0 if nowhere */
    double deviation_at; /**< and where [rad/m] */
} haft_psd_fit;

/** Fits the self-affine form plus a floor to what a table knows, by maximum likelihood: a ring's s
 *  is Gamma distributed with the shape of its count (1 where there is none), so the best form has
 *  the least deviance, sum 2 N (s/m - 1 - log(s/m)). Used are points from twice the first wave
 *  number on (levelling and window change those below; a table without counts is used whole), up to
 *  the cut-off. A cut-off is looked for where the form fits worse than by chance (1 in 1000): the
 *  highest wave number below which it fits and beyond which the table holds less than half of what
 *  form and floor say; its place is where a sharp edge would leave as much power. Intervals are
 *  those of the profile likelihood over the roll-off, with Student's t, widened by the misfit where
 *  that exceeds 1.
 *  @param[out] out the fit
 *  @param[in] table at least 6 points in the range used
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT for too few points; HAFT_ERROR_NUMERIC if the PSD does not fall, or
 *  falls as slowly as zeta^-2 (H = 0), if the floor hides all of it, or if the form's variance of
 *  heights or slopes over the rings used is off the table's by more than a quarter beyond three
 *  standard errors; HAFT_ERROR_MEMORY. Thread-safe.
 *  Source: Jacobs, Junge and Pastewka (2017) for the limits of a measured PSD. */
haft_status haft_psd_fit_self_affine(haft_psd_fit *out, const haft_psd_table *table,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Patches laid out of windows of measured maps, side by side: the surface as it was measured, to
 * judge a generator by. Each window is of a map, a place in it and a mirror image drawn at random
 * (a bootstrap of the maps); windows are at most half as long as the smallest map, so that they
 * vary. Heights jump where windows meet: what reaches over such a seam (an island, a slope) is cut
 * there. Maps are brought to the grid by natural cubic splines along x, then y. Read-only once
 * made. */
typedef struct haft_tiling haft_tiling;

/** What patches are laid out of. */
typedef struct haft_tiling_spec {
    size_t n;                    /**< maps of the face, cleaned, without missing pixels */
    const haft_map *const *maps; /**< n */
    size_t opposite_n; /**< of the other face, 0: it is flat; the heights of both are added */
    const haft_map *const *opposite; /**< opposite_n */
    double grid_step;                /**< [m] */
    size_t rows;                     /**< grid points of a patch along the beam */
    size_t columns;                  /**< and across it */
    uint64_t seed;                   /**< of what is drawn */
} haft_tiling_spec;

/** @return HAFT_ERROR_INPUT for no maps, missing pixels, or a map of fewer than 4 grid points a
 * side. */
haft_status haft_tiling_create(haft_tiling **out, const haft_tiling_spec *spec,
                               haft_error *error) HAFT_MUST_CHECK;

/** Frees a tiling and sets the pointer to NULL; NULL is allowed. */
void haft_tiling_destroy(haft_tiling **tiling);

/** The patch numbered (realization, stream): z[rows][columns] [m]. Thread-safe. */
void haft_tiling_fill(const haft_tiling *tiling, uint64_t realization, uint64_t stream, double *z);

/** How many windows a patch has along rows and columns. */
void haft_tiling_count(const haft_tiling *tiling, size_t count[2]);

#ifdef __cplusplus
}
#endif
#endif
