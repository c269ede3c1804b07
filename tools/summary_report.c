/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints what haft found: a table or JSON for a run, and one line for each variant of a sweep. */
#include "summary_report.h"

#include "terminal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void print_length(double metres) {
    if (isfinite(metres)) {
        printf(" %9.1f", metres * 1e6);
    } else {
        printf(" %9s", "-");
    }
}

/* Prints a number, its interval (NULL if it has none), and the values of the paper and the
 * measurement. */
static void print_row(const char *label, double ours, const haft_interval *interval, double paper,
                      double measured) {
    printf("  %-26s", label);
    print_length(ours);
    char low[16] = "-", high[16] = "-";
    if (interval != NULL && !isfinite(interval->low) && !isfinite(interval->high)) {
        interval = NULL;
    }
    if (interval != NULL && isfinite(interval->low)) {
        snprintf(low, sizeof low, "%.1f", interval->low * 1e6);
    }
    if (interval != NULL && isfinite(interval->high)) {
        snprintf(high, sizeof high, "%.1f", interval->high * 1e6);
    }
    printf(" %8s %2s %-7s", interval != NULL ? low : "", interval != NULL ? "to" : "",
           interval != NULL ? high : "");
    print_length(paper);
    print_length(measured);
    printf("\n");
}

static void print_quantiles(const haft_case *c, const haft_statistics *s) {
    static const char *const label[HAFT_STUDY_QUANTILES] = {"5 % quantile", "median",
                                                            "95 % quantile"};
    for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
        char text[40];
        bool beyond = s->quantile[i] > c->beam.length; /* stands for free beams, is no length */
        snprintf(text, sizeof text, beyond ? "%s (free)" : "%s", label[i]);
        print_row(text, s->quantile[i], &s->quantile_interval[i], NAN, NAN);
    }
}

static void print_summary(const haft_case *c, const haft_statistics *s) {
    char interval[40];
    snprintf(interval, sizeof interval, "%.4g %% interval", 100 * s->confidence);
    printf("\n");
    terminal_print(stdout, "%s", c->title);
    printf("  %-26s %9s %-20s %9s %9s\n", "crack length at rest [um]", "Haft", interval, "paper",
           "measured");
    print_row("mean", s->mean, &s->mean_interval, c->reference.paper_crack_length,
              c->reference.measured_crack_length);
    print_row("standard error of the mean", s->standard_error, NULL, NAN, NAN);
    print_row("standard deviation", s->deviation, &s->deviation_interval, NAN, NAN);
    print_quantiles(c, s);
    print_row("least", s->least, NULL, NAN, NAN);
    print_row("greatest", s->greatest, NULL, NAN, NAN);
    if (s->stuck > 0) {
        printf("  effective energy of the mean, Gamma: %.3g mJ/m2\n", s->gamma * 1e3);
    }
    printf("  beams: %zu run, %zu stuck, %zu free, %zu failed; %.1f jumps and %.3f s a beam\n",
           s->run, s->stuck, s->free, s->failed, s->jumps, s->seconds);
    if (s->stuck + s->free > 0) {
        printf("  probability to stick: %.1f %%, %s %.1f to %.1f %%\n", 100 * s->stuck_share,
               interval, 100 * s->stuck_interval.low, 100 * s->stuck_interval.high);
    }
    printf("  energy ledger closed to %.1e of the work; %zu curves that no Morse law fits\n",
           s->ledger_error, s->unfit);
}

void print_json_number(const char *key, double value, const char *end) {
    if (isfinite(value)) {
        printf("  \"%s\": %.12g%s\n", key, value, end);
    } else {
        printf("  \"%s\": null%s\n", key, end);
    }
}

static void print_json_interval(const char *key, haft_interval interval) {
    char name[80];
    snprintf(name, sizeof name, "%s_low%s", key, strcmp(key, "stuck_share") == 0 ? "" : "_m");
    print_json_number(name, interval.low, ",");
    snprintf(name, sizeof name, "%s_high%s", key, strcmp(key, "stuck_share") == 0 ? "" : "_m");
    print_json_number(name, interval.high, ",");
}

static void print_json(const haft_case *c, const haft_statistics *s) {
    static const char *const quantile[HAFT_STUDY_QUANTILES] = {
        "crack_length_quantile_05", "crack_length_median", "crack_length_quantile_95"};
    printf("{\n  \"case\": \"%s\",\n  \"version\": \"%s\",\n", c->name, haft_version());
    if (c->sweep.keys > 0) {
        printf("  \"variant\": \"%s\",\n", c->sweep.label);
    }
    for (size_t k = 0; k < c->sweep.keys; k++) {
        print_json_number(c->sweep.key[k], c->sweep.value[k], ",");
    }
    print_json_number("confidence", s->confidence, ",");
    print_json_number("crack_length_mean_m", s->mean, ",");
    print_json_interval("crack_length_mean", s->mean_interval);
    print_json_number("crack_length_standard_error_m", s->standard_error, ",");
    print_json_number("crack_length_deviation_m", s->deviation, ",");
    print_json_interval("crack_length_deviation", s->deviation_interval);
    for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
        char name[60];
        snprintf(name, sizeof name, "%s_m", quantile[i]);
        print_json_number(name, s->quantile[i], ",");
        print_json_interval(quantile[i], s->quantile_interval[i]);
    }
    print_json_number("crack_length_least_m", s->least, ",");
    print_json_number("crack_length_greatest_m", s->greatest, ",");
    print_json_number("stuck_share", s->stuck_share, ",");
    print_json_interval("stuck_share", s->stuck_interval);
    print_json_number("paper_crack_length_m", c->reference.paper_crack_length, ",");
    print_json_number("measured_crack_length_m", c->reference.measured_crack_length, ",");
    print_json_number("gamma_J_per_m2", s->gamma, ",");
    printf("  \"run\": %zu,\n  \"stuck\": %zu,\n  \"free\": %zu,\n  \"failed\": %zu,\n", s->run,
           s->stuck, s->free, s->failed);
    print_json_number("jumps_per_beam", s->jumps, ",");
    print_json_number("seconds_per_beam", s->seconds, ",");
    print_json_number("internal_energy_J", s->internal_energy, ",");
    print_json_number("dissipated_J", s->dissipated, ",");
    print_json_number("end_influence", s->end_influence, ",");
    print_json_number("ledger_error", s->ledger_error, "");
    printf("}\n");
}

void print_result(const haft_case *c, const haft_summary *summary, bool json) {
    haft_statistics s = haft_study_statistics(c, summary, c->realizations);
    if (json) {
        print_json(c, &s);
    } else {
        print_summary(c, &s);
    }
}

/* ---- a sweep ---- */

static void print_sweep_json(const haft_variant *variant, size_t variants) {
    printf("[\n");
    for (size_t i = 0; i < variants; i++) {
        print_json(variant[i].c, &variant[i].statistics);
        printf("%s", i + 1 < variants ? ",\n" : "");
    }
    printf("]\n");
}

/* Keys of references are not shown as swept keys; their values have columns of their own. */
static bool is_reference(const struct haft_case_sweep *sweep, size_t key) {
    return strncmp(sweep->key[key], "reference.", strlen("reference.")) == 0;
}

static bool has_reference(const haft_case *c) {
    return isfinite(c->reference.paper_crack_length) ||
           isfinite(c->reference.measured_crack_length);
}

/* Prints a value of the paper or the measurement, and Haft's deviation from it. */
static void print_deviation(const haft_statistics *s, double other) {
    if (isfinite(other) && s->stuck > 0) {
        printf(" %9.1f %+9.1f %+7.1f", other * 1e6, (s->mean - other) * 1e6,
               100 * (s->mean / other - 1));
    } else {
        printf(" %9s %9s %7s", "-", "-", "-");
    }
}

/* Prints the table of a sweep beside the paper's and the measured values (Tabs. 3 and 4 of the
 * paper). */
static void print_beside(const haft_variant *variant, size_t variants) {
    size_t key = 0;
    const struct haft_case_sweep *sweep = &variant[0].c->sweep;
    bool any = false;
    for (size_t i = 0; i < variants; i++) {
        any = any || has_reference(variant[i].c);
    }
    if (!any) {
        return;
    }
    while (key + 1 < sweep->keys && is_reference(sweep, key)) {
        key++;
    }
    printf(
        "\n mean crack length at rest of the beams that stuck\n %17s %9s %7s %7s %9s %9s %7s %9s "
        "%9s %7s\n",
        haft_sweep_leaf(sweep, key), "Haft", "s. e.", "free", "paper", "shift", "shift", "measured",
        "shift", "shift");
    printf(" %17s %9s %7s %7s %9s %9s %7s %9s %9s %7s\n", "", "[um]", "[um]", "[%]", "[um]", "[um]",
           "[%]", "[um]", "[um]", "[%]");
    for (size_t i = 0; i < variants; i++) {
        const haft_statistics *s = &variant[i].statistics;
        printf(" %17s %9.1f %7.2f %7.1f", variant[i].c->sweep.text[key], s->mean * 1e6,
               s->standard_error * 1e6, 100 * (1 - s->stuck_share));
        print_deviation(s, variant[i].c->reference.paper_crack_length);
        print_deviation(s, variant[i].c->reference.measured_crack_length);
        printf("\n");
    }
}

void print_sweep(const haft_variant *variant, size_t variants, bool json) {
    if (json) {
        print_sweep_json(variant, variants);
        return;
    }
    const struct haft_case_sweep *sweep = &variant[0].c->sweep;
    printf("\n");
    terminal_print(stdout, "%s", variant[0].c->title);
    printf(" %3s", "");
    size_t shown = 0;
    for (size_t k = 0; k < sweep->keys; k++) {
        if (!is_reference(sweep, k)) {
            printf(" %17s", haft_sweep_leaf(sweep, k));
            shown++;
        }
    }
    char interval[32];
    snprintf(interval, sizeof interval, "%.4g %% interval", 100 * variant[0].statistics.confidence);
    printf(" %9s %-18s %9s %9s %8s %7s %6s %6s %9s %9s %8s\n", "crack", interval, "paper",
           "measured", "s. dev.", "Gamma", "stuck", "free", "internal", "lost in", "a beam");
    printf(" %3s%*s %9s %-18s %9s %9s %8s %7s %6s %6s %9s %9s %8s\n", "", (int)(18 * shown), "",
           "[um]", "of the mean [um]", "[um]", "[um]", "[um]", "[mJ/m2]", "", "", "[pJ]",
           "jumps[pJ]", "[s]");
    for (size_t i = 0; i < variants; i++) {
        const haft_statistics *s = &variant[i].statistics;
        printf(" %3zu", i);
        for (size_t k = 0; k < sweep->keys; k++) {
            if (!is_reference(sweep, k)) {
                printf(" %17s", variant[i].c->sweep.text[k]);
            }
        }
        printf(" %9.3f %8.2f to %6.2f", s->mean * 1e6, s->mean_interval.low * 1e6,
               s->mean_interval.high * 1e6);
        print_length(variant[i].c->reference.paper_crack_length);
        print_length(variant[i].c->reference.measured_crack_length);
        printf(" %8.2f %7.3g %6zu %6zu %9.4f %9.4f %8.3f\n", s->deviation * 1e6, s->gamma * 1e3,
               s->stuck, s->free, s->internal_energy * 1e12, s->dissipated * 1e12, s->seconds);
    }
    print_beside(variant, variants);
}
