/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables that a case names: a PSD by points and a film. The first byte tells which the rest is;
 * it is read with the case. */
#include "entry.h"

#include <math.h>
#include <stdio.h>

static const char HEAD[] = "name: table\nseed: 1\n";
static const char TAIL[] = "  distance: {from: 6 nm, to: 28 nm, step: 0.1 nm}\n"
                           "law: {kind: morse, f_limit: 5 MPa, unfit: table, sampler: explicit}\n"
                           "beam: {length: 600 um, width: 30 um, thickness: 2.62 um, gap: 1.9 um,\n"
                           "  young_modulus: 163 GPa, l_meso: 3 um, mesh: active}\n"
                           "load: {position: 60 um, crack_length: 120 um, crack_threshold: 1 %}\n"
                           "study: {realizations: 2}\n";
static const char CONTACT[] = "contact:\n  asperities: islands\n  young_modulus: 163 GPa\n"
                              "  poisson_ratio: 0.22\n";
static const char WATER[] = "  capillary: {humidity: 85 %, temperature: 300 K, surface_energy: 72 "
                            "mN/m, molar_volume: 18 cm^3/mol, contact_angles: [0 deg, 0 deg]";

static void put_case(bool film) {
    char text[2048];
    int n = snprintf(text, sizeof text, "%ssurface: {%s, grid_step: 5 nm}\n%s%s%s}\n%s", HEAD,
                     film ? "zeta_max: 289 rad/um, zeta_0: 19.4 rad/um, s_0: 6.46e3 nm^4, s_1: "
                            "6.46e-3 nm^4"
                          : "psd: table",
                     CONTACT, WATER, film ? ", adsorbed: table, adsorbed_table: table" : "", TAIL);
    fuzz_put(film ? "film.yaml" : "psd.yaml", text, (size_t)n);
}

static void check_table(const haft_case *c, bool film) {
    if (film) {
        for (size_t i = 0; i < c->contact.film.n; i++) {
            FUZZ_DEMAND(isfinite(c->contact.film_data[i]), "point %zu of a film", i);
        }
        return;
    }
    haft_psd_moments m = haft_case_moments(c);
    FUZZ_DEMAND(isfinite(m.m0) && isfinite(m.m2) && isfinite(m.m4), "moments %g %g %g", m.m0, m.m2,
                m.m4);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bool begun;
    haft_error error = {0};
    haft_case *c = NULL;
    if (size == 0 || size > 8192) {
        return -1;
    }
    if (!begun) {
        put_case(false);
        put_case(true);
        begun = true;
    }
    bool film = (data[0] & 1) != 0;
    fuzz_put("table", data + 1, size - 1);
    haft_status status = haft_case_read(&c, fuzz_path(film ? "film.yaml" : "psd.yaml"), &error);
    fuzz_check_status(status, &error);
    if (status == HAFT_OK) {
        check_table(c, film);
    } else { /* the rest of the case is sound */
        FUZZ_DEMAND(strstr(error.message, film ? "adsorbed" : "surface") != NULL, "%s",
                    error.message);
    }
    haft_case_destroy(&c);
    return 0;
}
