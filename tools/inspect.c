/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inspects a height map: reads it, cleans it as a case would, and prints and draws its statistics
 * and spectrum. */
#include "inspect.h"
#include "gnuplot.h"
#include "inspect_print.h"
#include "inspect_words.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { BINS = 60, DRAWN_MOST = 512 };

typedef inspect_wishes wishes;

/* What inspect found. */
typedef struct findings {
    haft_map *map;
    haft_clean_facts clean;
    haft_map_statistics statistics;
    haft_map_texture texture;
    haft_psd_table *psd;
    haft_psd_moments moments; /* of the PSD table, up to the tip's limit */
    double limit;             /* of the tip [rad/m]; INFINITY without one */
    bool fitted;
    haft_psd_fit fit;
    haft_error why_not; /* why there is no PSD, or no fit */
} findings;

static const char *const levels[] = {"mean", "plane", "quadratic", "lines", NULL};
static const char *const windows[] = {"none", "hann", "welch", "blackman", "tukey", NULL};
static const char *const treatments[] = {"exclude", "fill", NULL};

static haft_status choose(int *choice, const char *option, const char *word,
                          const char *const *words, haft_error *error) {
    char all[96] = "";
    for (int k = 0; words[k] != NULL; k++) {
        if (word == NULL || strcmp(word, words[k]) == 0) {
            *choice = word == NULL ? *choice : k;
            return HAFT_OK;
        }
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", k > 0 ? ", " : "", words[k]);
    }
    return haft_error_set(error, HAFT_ERROR_INPUT, "--%s %s is no choice; give one of %s", option,
                          word, all);
}

haft_status inspect_read_words(inspect_wishes *w, const inspect_words *words, haft_error *error) {
    haft_units *units = NULL;
    double size[2] = {0, 0};
    *w = (wishes){.options = {.channel = words->channel},
                  .clean = {.level = HAFT_LEVEL_PLANE},
                  .window = HAFT_WINDOW_HANN};
    int level = HAFT_LEVEL_PLANE, window = HAFT_WINDOW_HANN, missing = HAFT_MISSING_EXCLUDE;
    haft_status status = haft_units_create(&units, error);
    HAFT_THEN(status, choose(&level, "level", words->level, levels, error));
    HAFT_THEN(status, choose(&window, "window", words->window, windows, error));
    HAFT_THEN(status, choose(&missing, "missing", words->missing, treatments, error));
    HAFT_THEN(status, words_read_size(size, units, words->size, error));
    HAFT_THEN(status, words_read_unit(&w->options.unit, units, "unit", words->unit, error));
    HAFT_THEN(status, words_read_unit(&w->options.lateral_unit, units, "lateral-unit",
                                      words->lateral_unit, error));
    HAFT_THEN(status, words_read_length(&w->tip_radius, units, "tip-radius", words->tip_radius,
                                        "\"8 nm\"", error));
    if (status == HAFT_OK && words->outliers != NULL) {
        double limit = 0;
        if (haft_number_read(words->outliers, &limit) && limit >= 1) {
            w->clean.outlier_limit = limit;
        } else {
            status = haft_error_set(error, HAFT_ERROR_INPUT,
                                    "--outliers \"%s\" is no number of deviations; give 5, say",
                                    words->outliers);
        }
    }
    haft_units_destroy(&units);
    w->options.width = size[0];
    w->options.height = size[1];
    w->clean.level = (haft_level)level;
    w->clean.missing = (haft_missing)missing;
    w->window = (haft_window)window;
    return status;
}

/* Lets inspect go on without a PSD or a fit: the report says why there is none. Lack of memory is
 * an error all the same, since it says nothing about the map. */
static haft_status pass_on_memory(haft_status status, const haft_error *why_not,
                                  haft_error *error) {
    return status == HAFT_ERROR_MEMORY ? haft_error_set(error, status, "%s", why_not->message)
                                       : HAFT_OK;
}

static haft_status find_out(findings *f, const char *path, const wishes *w, haft_error *error) {
    HAFT_TRY(haft_map_read(&f->map, path, &w->options, NULL, error));
    haft_status status = haft_map_clean(f->map, &w->clean, &f->clean, error);
    HAFT_THEN(status, haft_map_get_statistics(&f->statistics, f->map, error));
    HAFT_THEN(status, haft_map_get_texture(&f->texture, f->map, error));
    if (status != HAFT_OK) {
        haft_error_prefix(error, "%s: ", path);
        return status;
    }
    const haft_map *const maps[] = {f->map};
    status = haft_psd_estimate(&f->psd, 1, maps, w->window, &f->why_not);
    if (status != HAFT_OK) {
        return pass_on_memory(status, &f->why_not, error);
    }
    f->limit = w->tip_radius > 0 ? haft_psd_tip_limit(f->psd, w->tip_radius) : INFINITY;
    status = haft_psd_table_cut(f->psd, f->limit, error);
    if (status == HAFT_OK) {
        f->moments = haft_psd_table_get_moments(f->psd);
        status = haft_psd_fit_self_affine(&f->fit, f->psd, &f->why_not);
        f->fitted = status == HAFT_OK;
        status = pass_on_memory(status, &f->why_not, error);
    }
    return status;
}

static void print_moments(const char *label, haft_psd_moments m) {
    haft_gw gw = haft_gw_from_moments(m);
    printf("  %-34s m0 %.4g nm^2, m2 %.4g, m4 %.4g 1/um^2\n", label, m.m0 * 1e18, m.m2,
           m.m4 * 1e-12);
    printf("  %-34s alpha %.3g, radius %.4g nm, density %.4g 1/um^2, deviation %.4g nm\n",
           "  Greenwood-Williamson", gw.alpha, gw.radius * 1e9, gw.density * 1e-12,
           gw.summit_deviation * 1e9);
}

/* Prints up to which wave number the map represents the surface, and why. */
static void print_limits(const haft_psd_fit *fit) {
    printf("    fitted to %zu rings from %.4g to %.4g rad/um\n", fit->rings, fit->from * 1e-6,
           fit->to * 1e-6);
    if (isfinite(fit->cut_off)) {
        printf("    cut-off: the map has no waves beyond %.4g rad/um; left out\n",
               fit->cut_off * 1e-6);
    } else {
        printf("    cut-off: none found\n");
    }
    if (isfinite(fit->noise_limit)) {
        printf("    noise floor: %.4g nm^4, which hides the surface from %.4g rad/um on\n",
               fit->floor * 1e36, fit->noise_limit * 1e-6);
    } else {
        printf("    noise floor: none that reaches the PSD\n");
    }
}

static void print_quality(const haft_psd_fit *fit) {
    printf("    misfit %.3g a degree of freedom, p = %.2g; ", fit->misfit, fit->p_value);
    if (fit->deviation != 0) {
        printf("largest deviation %+.0f %% (%+.1f dB) at %.4g rad/um\n", 100 * fit->deviation,
               10 * log10(1 + fit->deviation), fit->deviation_at * 1e-6);
    } else {
        printf("no deviation beyond its error\n");
    }
    if (fit->p_value < 1e-3) {
        printf("    the form does not fit: intervals are widened by the misfit; use the table\n");
    }
}

static void print_parameter(const char *name, const char *unit, double value, double low,
                            double high, double factor, bool determined) {
    printf("    %-8s %10.4g %-7s ", name, value * factor, unit);
    if (!determined) {
        printf("not determined by this map: ");
    }
    if (low > 0 && isfinite(high)) {
        printf("%.4g to %.4g\n", low * factor, high * factor);
    } else if (isfinite(high)) {
        printf("at most %.4g\n", high * factor);
    } else if (low > 0) {
        printf("at least %.4g\n", low * factor);
    } else {
        printf("any\n");
    }
}

static void print_fit(const findings *f) {
    if (!f->fitted) {
        terminal_print(stdout, "  no self-affine fit: %s", f->why_not.message);
        return;
    }
    const haft_psd_fit *fit = &f->fit;
    const haft_psd *psd = &fit->psd;
    printf("  self-affine fit, 95 %% intervals\n");
    print_limits(fit);
    print_quality(fit);
    print_parameter("s_0", "nm^4", psd->s_0, fit->low[0], fit->high[0], 1e36, fit->determined[0]);
    print_parameter("zeta_0", "rad/um", psd->zeta_0, fit->low[1], fit->high[1], 1e-6,
                    fit->determined[1]);
    print_parameter("Hurst", "", fit->hurst, fit->low[2], fit->high[2], 1, fit->determined[2]);
    print_parameter("rms", "nm", fit->rms[0], fit->rms[1], fit->rms[2], 1e9, isfinite(fit->rms[2]));
    printf("    s_1      %10.4g nm^4     at zeta_max %.4g rad/um\n", psd->s_1 * 1e36,
           psd->zeta_max * 1e-6);
    if (!(fit->low[1] > 0)) {
        printf(
            "    no roll-off is seen: waves longer than %.3g um are taken as flat, so the rms is\n"
            "    that of an area as large as the map; measure a larger one\n",
            2e6 * M_PI / psd->zeta_0);
    }
    if (fit->low[2] > 1) {
        printf("    the Hurst exponent lies above 1: smoother than any self-affine surface\n");
    }
}

static void print_findings(const char *path, const findings *f, const wishes *w) {
    const haft_map *map = f->map;
    const haft_map_statistics *s = &f->statistics;
    bool named = map->channel[0] != '\0';
    terminal_print(stdout, "%s: %s%s%s%s", path, map->format, named ? ", channel \"" : "",
                   map->channel, named ? "\"" : "");
    if (map->note[0] != '\0') {
        terminal_print(stdout, "  note: %s", map->note);
    }
    printf("  %zu x %zu pixels of %.6g x %.6g nm, %.6g x %.6g um; %zu missing, %zu masked\n",
           map->columns, map->rows, map->step_column * 1e9, map->step_row * 1e9,
           map->step_column * 1e6 * (double)map->columns, map->step_row * 1e6 * (double)map->rows,
           f->clean.missing, f->clean.masked);
    printf("  levelled by %s\n", levels[w->clean.level]);
    printf("  rms %.4f nm, skewness %.4f, kurtosis %.4f; %.4g to %.4g nm\n", s->rms * 1e9,
           s->skewness, s->kurtosis, s->least * 1e9, s->greatest * 1e9);
    if (isnan(s->correlation_length)) {
        printf("  correlation length: the autocorrelation does not fall to 1/e within the map\n");
    } else {
        printf("  correlation length (to 1/e) %.4g nm\n", s->correlation_length * 1e9);
    }
    printf("  rms slope along x %.4g, along y %.4g; rms curvature %.4g, %.4g 1/um\n",
           sqrt(s->slope_x), sqrt(s->slope_y), sqrt(s->curvature_x) * 1e-6,
           sqrt(s->curvature_y) * 1e-6);
    inspect_print_texture(stdout, &f->texture);
    print_moments("moments by differences", s->moments);
    if (f->psd == NULL) {
        terminal_print(stdout, "  no PSD: %s", f->why_not.message);
        return;
    }
    print_moments("moments of the radial PSD", f->moments);
    printf("  PSD: %zu rings from %.4g to %.4g rad/um, window %s\n", f->psd->n,
           f->psd->zeta[0] * 1e-6, f->psd->zeta[f->psd->n - 1] * 1e-6, windows[w->window]);
    if (f->clean.missing + f->clean.masked > 0) {
        printf("  missing pixels: heights drawn for them from the map's own PSD%s\n",
               w->clean.missing == HAFT_MISSING_FILL ? "" : ", for the PSD alone");
    }
    if (isfinite(f->limit)) {
        printf("  a tip of %.3g nm is trusted up to %.4g rad/um; cut there\n", w->tip_radius * 1e9,
               f->limit * 1e-6);
    } else if (w->tip_radius > 0) {
        printf("  a tip of %.3g nm is trusted with all of it\n", w->tip_radius * 1e9);
    }
    print_fit(f);
}

/* ---- figures ---- */

/* Saves every n-th pixel as columns x, y and z. */
static haft_status save_heights(const haft_map *map, const char *folder, haft_error *error) {
    size_t stride = (map->rows > map->columns ? map->rows : map->columns) / DRAWN_MOST + 1;
    size_t rows = (map->rows + stride - 1) / stride, columns = (map->columns + stride - 1) / stride;
    double *data = haft_memory_alloc(rows * columns, 3 * sizeof *data, error);
    if (data == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            double *point = data + 3 * (i * columns + j);
            point[0] = (double)(j * stride) * map->step_column;
            point[1] = (double)(map->rows - 1 - i * stride) * map->step_row;
            point[2] = map->z[i * stride * map->columns + j * stride];
        }
    }
    char path[PATH_CAPACITY];
    const haft_csv_column column[] = {
        {.name = "x [um]", .value = data, .stride = 3, .factor = 1e6},
        {.name = "y [um]", .value = data + 1, .stride = 3, .factor = 1e6},
        {.name = "z [nm]", .value = data + 2, .stride = 3, .factor = 1e9}};
    haft_status status = haft_path_join(path, sizeof path, folder, "map.csv", error);
    HAFT_THEN(status, haft_csv_write(path, rows * columns, 3, column, error));
    haft_memory_free(data);
    return status;
}

static haft_status save_histogram(const findings *f, const char *folder, haft_error *error) {
    const haft_map_statistics *s = &f->statistics;
    double height[BINS], density[BINS] = {0}, normal[BINS];
    double width = (s->greatest - s->least) / BINS;
    for (size_t i = 0; i < f->map->rows * f->map->columns; i++) {
        double place = (f->map->z[i] - s->least) / width;
        if (!isnan(place)) {
            density[place >= BINS ? BINS - 1 : (int)place] += 1 / (width * (double)s->pixels);
        }
    }
    for (int k = 0; k < BINS; k++) {
        height[k] = s->least + width * (k + 0.5);
        double x = (height[k] - s->mean) / s->rms;
        normal[k] = exp(-0.5 * x * x) / (s->rms * sqrt(2 * M_PI));
    }
    char path[PATH_CAPACITY];
    const haft_csv_column column[] = {{.name = "height [nm]", .value = height, .factor = 1e9},
                                      {.name = "density [1/nm]", .value = density, .factor = 1e-9},
                                      {.name = "normal [1/nm]", .value = normal, .factor = 1e-9}};
    HAFT_TRY(haft_path_join(path, sizeof path, folder, "histogram.csv", error));
    return haft_csv_write(path, BINS, 3, column, error);
}

static haft_status save_psd(const findings *f, const char *folder, haft_error *error) {
    if (f->psd == NULL) {
        return HAFT_OK;
    }
    size_t n = f->psd->n;
    double *data = haft_memory_alloc(n, 2 * sizeof *data, error);
    if (data == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < n; i++) {
        data[i] = f->psd->count[i] > 0 ? 1 / sqrt(f->psd->count[i]) : 0;
        bool seen = f->fitted && f->psd->zeta[i] <= f->fit.psd.zeta_max;
        data[n + i] = seen ? haft_psd_value(&f->fit.psd, f->psd->zeta[i]) : NAN;
    }
    char path[PATH_CAPACITY];
    const haft_csv_column column[] = {
        {.name = "zeta [rad/um]", .value = f->psd->zeta, .factor = 1e-6},
        {.name = "s [nm^4]", .value = f->psd->s, .factor = 1e36},
        {.name = "relative error", .value = data},
        {.name = "fit [nm^4]", .value = data + n, .factor = 1e36}};
    haft_status status = haft_path_join(path, sizeof path, folder, "psd.csv", error);
    HAFT_THEN(status, haft_csv_write(path, n, 4, column, error));
    haft_memory_free(data);
    return status;
}

static haft_status draw_findings(const char *path, const findings *f, const char *folder,
                                 haft_error *error) {
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be made: %s", folder,
                              strerror(errno));
    }
    haft_status status = save_heights(f->map, folder, error);
    HAFT_THEN(status, save_histogram(f, folder, error));
    HAFT_THEN(status, save_psd(f, folder, error));
    if (status == HAFT_OK) {
        const char *name = strrchr(path, '/') != NULL ? strrchr(path, '/') + 1 : path;
        char definitions[128];
        snprintf(definitions, sizeof definitions, "fitted=%d; panels=%d; first=%.6g; last=%.6g",
                 f->fitted, f->psd != NULL ? 3 : 2, f->fitted ? f->fit.from * 1e-6 : 0,
                 f->fitted ? f->fit.psd.zeta_max * 1e-6 : 0);
        status = draw_script("map", folder, name, definitions, error);
    }
    return status;
}

/* Prints the map as the surface section of a case. This comes last, so that it can be cut off. */
static haft_status print_block(const char *path, const findings *f, const wishes *w,
                               haft_error *error) {
    if (f->psd == NULL) {
        return HAFT_OK;
    }
    surface_block b = {.files = 1,
                       .file = &path,
                       .wishes = w,
                       .channel = f->map->channel,
                       .grid_step = inspect_grid_step(f->psd->zeta[f->psd->n - 1]),
                       .fit = f->fitted ? &f->fit : NULL};
    printf("\n# To paste into case.yaml; its folder is where the map's path begins.\n");
    return inspect_print_block(stdout, &b, error);
}

haft_status inspect_map(const char *path, const inspect_words *words, const char *folder,
                        bool quiet, haft_error *error) {
    wishes w;
    findings f = {.map = NULL};
    char standard[PATH_CAPACITY];
    const char *name = strrchr(path, '/') != NULL ? strrchr(path, '/') + 1 : path;
    snprintf(standard, sizeof standard, "%.255s.inspect", name);
    folder = folder != NULL ? folder : standard;
    haft_status status = inspect_read_words(&w, words, error);
    HAFT_THEN(status, find_out(&f, path, &w, error));
    if (status == HAFT_OK) {
        print_findings(path, &f, &w);
        status = draw_findings(path, &f, folder, error);
        if (status == HAFT_OK && !quiet) {
            terminal_print(stdout, "  figure and data in %s", folder);
        }
        haft_status told = print_block(path, &f, &w, status == HAFT_OK ? error : NULL);
        status = status == HAFT_OK ? told : status;
    }
    haft_psd_table_destroy(&f.psd);
    haft_map_destroy(&f.map);
    return status;
}
