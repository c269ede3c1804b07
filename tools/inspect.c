/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a height map holds: read, cleaned as a case would, its statistics, spectrum and figures. */
#include "inspect.h"
#include "gnuplot.h"
#include "inspect_print.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { BINS = 60, DRAWN_MOST = 512, SIDE_CAPACITY = 120 };

typedef inspect_wishes wishes;

/* What was found. */
typedef struct findings {
    haft_map *map;
    haft_clean_facts clean;
    haft_map_statistics statistics;
    haft_map_texture texture;
    haft_psd_table *psd;
    haft_psd_moments moments; /* of the table, up to the limit */
    double limit;             /* of the tip [rad/m] */
    bool fitted;
    haft_psd_fit fit;
    haft_error why_not; /* no spectrum, or no fit */
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

static haft_status read_length(double *value, const haft_units *units, const char *option,
                               const char *text, const char *example, haft_error *error) {
    if (text == NULL) {
        return HAFT_OK;
    }
    haft_error own = {0};
    double length = 0;
    haft_status status = haft_units_parse(units, text, "m", &length, &own);
    if (status == HAFT_ERROR_MEMORY) {
        return haft_error_set(error, status, "%s", own.message);
    }
    if (status != HAFT_OK || !(length > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "--%s \"%.80s\" is no positive length%s%s; give it as %s", option,
                              text, status != HAFT_OK ? ": " : "", own.message, example);
    }
    *value = length;
    return HAFT_OK;
}

/* "10 um x 5 um" */
static haft_status read_size(wishes *w, const haft_units *units, const char *text,
                             haft_error *error) {
    if (text == NULL) {
        return HAFT_OK;
    }
    const char *cross = strchr(text, 'x');
    size_t side = cross != NULL ? (size_t)(cross - text) : 0;
    char width[SIDE_CAPACITY] = "", height[SIDE_CAPACITY] = "";
    if (cross == NULL || side >= sizeof width || strlen(cross + 1) >= sizeof height) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "--size \"%.80s\" is no width and height; give it as \"10 um x 5 um\"", text);
    }
    memcpy(width, text, side);
    snprintf(height, sizeof height, "%s", cross + 1);
    while (side > 0 && width[side - 1] == ' ') {
        width[--side] = '\0';
    }
    haft_status status =
        read_length(&w->options.width, units, "size", width, "\"10 um x 5 um\"", error);
    return status != HAFT_OK
               ? status
               : read_length(&w->options.height, units, "size", height, "\"10 um x 5 um\"", error);
}

/* "nm" or "2 nm" */
static haft_status read_unit(double *unit, const haft_units *units, const char *option,
                             const char *text, haft_error *error) {
    char quantity[SIDE_CAPACITY + 2] = "";
    if (text == NULL) {
        return HAFT_OK;
    }
    if (strlen(text) >= SIDE_CAPACITY) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "--%s has %zu characters; give a unit such as nm", option,
                              strlen(text));
    }
    bool bare = strpbrk(text, "0123456789") == NULL;
    snprintf(quantity, sizeof quantity, "%s%s", bare ? "1 " : "", text);
    return read_length(unit, units, option, quantity, "nm", error);
}

static haft_status understand(wishes *w, const inspect_words *words, haft_error *error) {
    haft_units *units = NULL;
    *w = (wishes){.options = {.channel = words->channel},
                  .clean = {.level = HAFT_LEVEL_PLANE},
                  .window = HAFT_WINDOW_HANN};
    int level = HAFT_LEVEL_PLANE, window = HAFT_WINDOW_HANN, missing = HAFT_MISSING_EXCLUDE;
    haft_status status = haft_units_create(&units, error);
    if (status == HAFT_OK) {
        status = choose(&level, "level", words->level, levels, error);
    }
    if (status == HAFT_OK) {
        status = choose(&window, "window", words->window, windows, error);
    }
    if (status == HAFT_OK) {
        status = choose(&missing, "missing", words->missing, treatments, error);
    }
    if (status == HAFT_OK) {
        status = read_size(w, units, words->size, error);
    }
    if (status == HAFT_OK) {
        status = read_unit(&w->options.unit, units, "unit", words->unit, error);
    }
    if (status == HAFT_OK) {
        status =
            read_unit(&w->options.lateral_unit, units, "lateral-unit", words->lateral_unit, error);
    }
    if (status == HAFT_OK) {
        status =
            read_length(&w->tip_radius, units, "tip-radius", words->tip_radius, "\"8 nm\"", error);
    }
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
    w->clean.level = (haft_level)level;
    w->clean.missing = (haft_missing)missing;
    w->window = (haft_window)window;
    return status;
}

/* What a map does not give is told where it would be; but that there is no memory is no property of
 * the map. */
static haft_status pass_on_memory(haft_status status, const haft_error *why_not,
                                  haft_error *error) {
    return status == HAFT_ERROR_MEMORY ? haft_error_set(error, status, "%s", why_not->message)
                                       : HAFT_OK;
}

static haft_status find_out(findings *f, const char *path, const wishes *w, haft_error *error) {
    haft_status status = haft_map_read(&f->map, path, &w->options, NULL, error);
    if (status != HAFT_OK) {
        return status;
    }
    status = haft_map_clean(f->map, &w->clean, &f->clean, error);
    if (status == HAFT_OK) {
        status = haft_map_get_statistics(&f->statistics, f->map, error);
    }
    if (status == HAFT_OK) {
        status = haft_map_get_texture(&f->texture, f->map, error);
    }
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

static void print_fit(const findings *f) {
    if (!f->fitted) {
        terminal_print(stdout, "  no self-affine fit: %s", f->why_not.message);
        return;
    }
    const haft_psd_fit *fit = &f->fit;
    printf("  self-affine fit (misfit %.3g a degree of freedom), 95 %% intervals\n", fit->misfit);
    printf("    s_0      %10.4g nm^4     %.4g to %.4g\n", fit->psd.s_0 * 1e36, fit->low[0] * 1e36,
           fit->high[0] * 1e36);
    printf("    zeta_0   %10.4g rad/um   %.4g to %.4g\n", fit->psd.zeta_0 * 1e-6,
           fit->low[1] * 1e-6, fit->high[1] * 1e-6);
    printf("    Hurst    %10.4g          %.4g to %.4g\n", fit->hurst, fit->low[2], fit->high[2]);
    printf("    s_1      %10.4g nm^4     at zeta_max %.4g rad/um\n", fit->psd.s_1 * 1e36,
           fit->psd.zeta_max * 1e-6);
}

static void print_findings(const char *path, const findings *f, const wishes *w) {
    const haft_map *map = f->map;
    const haft_map_statistics *s = &f->statistics;
    bool named = map->channel[0] != '\0';
    terminal_print(stdout, "%s: %s%s%s%s", path, map->format, named ? ", channel \"" : "",
                   map->channel, named ? "\"" : "");
    printf("  %zu x %zu pixels of %.6g x %.6g nm, %.6g x %.6g um; %zu missing, %zu masked\n",
           map->columns, map->rows, map->step_column * 1e9, map->step_row * 1e9,
           map->step_column * 1e6 * (double)map->columns, map->step_row * 1e6 * (double)map->rows,
           f->clean.missing, f->clean.masked);
    printf("  levelled by %s\n", levels[w->clean.level]);
    printf("  rms %.4f nm, skewness %.4f, kurtosis %.4f; %.4g to %.4g nm\n", s->rms * 1e9,
           s->skewness, s->kurtosis, s->least * 1e9, s->greatest * 1e9);
    printf("  correlation length (to 1/e) %.4g nm\n", s->correlation_length * 1e9);
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
    if (isfinite(f->limit)) {
        printf("  a tip of %.3g nm is trusted up to %.4g rad/um; cut there\n", w->tip_radius * 1e9,
               f->limit * 1e-6);
    } else if (w->tip_radius > 0) {
        printf("  a tip of %.3g nm is trusted with all of it\n", w->tip_radius * 1e9);
    }
    print_fit(f);
}

/* ---- figures ---- */

/* Every so many pixels, as columns of x, y and z. */
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
    char path[PATH_CAPACITY + 16];
    snprintf(path, sizeof path, "%s/map.csv", folder);
    const haft_csv_column column[] = {
        {.name = "x [um]", .value = data, .stride = 3, .factor = 1e6},
        {.name = "y [um]", .value = data + 1, .stride = 3, .factor = 1e6},
        {.name = "z [nm]", .value = data + 2, .stride = 3, .factor = 1e9}};
    haft_status status = haft_csv_write(path, rows * columns, 3, column, error);
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
    char path[PATH_CAPACITY + 16];
    snprintf(path, sizeof path, "%s/histogram.csv", folder);
    const haft_csv_column column[] = {{.name = "height [nm]", .value = height, .factor = 1e9},
                                      {.name = "density [1/nm]", .value = density, .factor = 1e-9},
                                      {.name = "normal [1/nm]", .value = normal, .factor = 1e-9}};
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
        data[n + i] = f->fitted ? haft_psd_value(&f->fit.psd, f->psd->zeta[i]) : NAN;
    }
    char path[PATH_CAPACITY + 16];
    snprintf(path, sizeof path, "%s/psd.csv", folder);
    const haft_csv_column column[] = {
        {.name = "zeta [rad/um]", .value = f->psd->zeta, .factor = 1e-6},
        {.name = "s [nm^4]", .value = f->psd->s, .factor = 1e36},
        {.name = "relative error", .value = data},
        {.name = "fit [nm^4]", .value = data + n, .factor = 1e36}};
    haft_status status = haft_csv_write(path, n, 4, column, error);
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
    if (status == HAFT_OK) {
        status = save_histogram(f, folder, error);
    }
    if (status == HAFT_OK) {
        status = save_psd(f, folder, error);
    }
    if (status == HAFT_OK) {
        const char *name = strrchr(path, '/') != NULL ? strrchr(path, '/') + 1 : path;
        char definitions[64];
        snprintf(definitions, sizeof definitions, "fitted=%d; panels=%d", f->fitted,
                 f->psd != NULL ? 3 : 2);
        status = draw_script("map", folder, name, definitions, error);
    }
    return status;
}

haft_status inspect_read_words(inspect_wishes *w, const inspect_words *words, haft_error *error) {
    return understand(w, words, error);
}

/* The map as a case takes it, at the very end, so that it can be cut off there. */
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
    haft_status status = understand(&w, words, error);
    if (status == HAFT_OK) {
        status = find_out(&f, path, &w, error);
    }
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
