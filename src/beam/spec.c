/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closed forms of the cantilever: stiffness, and the energy balance of its S-shaped state. */
#include "haft/beam.h"

#include <math.h>

double haft_beam_bending_stiffness(const haft_beam_spec *beam) {
    double t = beam->thickness;
    return beam->young_modulus * beam->width * t * t * t / 12.0;
}

double haft_beam_effective_energy(const haft_beam_spec *beam, double crack_length) {
    double h = beam->gap, t = beam->thickness, l = crack_length;
    return 1.5 * beam->young_modulus * h * h * t * t * t / (l * l * l * l);
}

double haft_beam_equilibrium_crack(const haft_beam_spec *beam, double energy) {
    double h = beam->gap, t = beam->thickness;
    return sqrt(sqrt(1.5 * beam->young_modulus * h * h * t * t * t / energy));
}
