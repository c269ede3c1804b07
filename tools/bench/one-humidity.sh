# SPDX-License-Identifier: GPL-3.0-or-later
# One humidity of a case's sweep by itself, for the scripts beside; sourced, and reads what they set:
# scene, patches, beams, humidity, length, pressed [um] and bin.

# The case without its sweep, at the humidity, on beams of the length, over the patches' own curves.
one_humidity() {
    sed -e '/^sweep:/,$d' -e "s/^  capillary:/  capillary:\n    humidity: $humidity %/" \
        -e "s/vectors: [0-9]*/vectors: $patches/" -e "s/realizations: .*/realizations: $beams/" \
        -e 's/^law:/law:\n  kind: table\n  sampler: bootstrap/' -e "s/^beam:/beam:\n  length: $length um/" \
        -e "s/^load:/load:\n  crack_length: $pressed um/" "$scene/case.yaml"
}

# morse_of FROM TO LIMIT [SCRIPT]: the case FROM, whose laws are built, with Morse laws of a push
# limit [MPa] instead of its curves, their energies raised to what such a law needs (bench-weak), in
# the folder TO; sed's SCRIPT changes it besides. Pressed to 700 um at most: Morse laws pull more.
morse_of() {
    mkdir "$2"
    sed -e "s/f_limit_share: .*/f_limit: $3 MPa/" -e 's/kind: table/kind: morse/' -e "${4:-}" \
        -e "s/crack_length: $pressed um/crack_length: $((pressed < 700 ? pressed : 700)) um/" \
        "$1/case.yaml" >"$2/case.yaml"
    "$bin/bench-weak" "$1" "$3" >"$2/v.csv" 2>"$2/said" || { cat "$2/said" >&2; exit 1; }
    "$bin/haft-laws" fit --quiet "$2" "$2/v.csv" >/dev/null
}
