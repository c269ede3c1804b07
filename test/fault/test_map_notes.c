/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the reader of a map had to assume is shown where the map is: by inspect, and by check of a
 * case that uses it. */
#include "spm_files.h"

#include "program.h"

#define LINES                                                                                      \
    "\\Samps/line: 128\n\\Number of lines: 64\n\\Bytes/pixel: 2\n\\Scan size: 500 500 nm\n"        \
    "\\@2:Image Data: S [Height] \"Height\"\n"                                                     \
    "\\@2:Z scale: V [Sens. Zsens] (0.006713867 V/LSB) 4.400000 V\n"

/* Heights of hills 60 nm wide, trace and retrace, in a square frame of half the lines. */
static void write_map(const char *path) {
    spm_file f = {
        .scan = "\\Lines: 64\n\\Aspect ratio: 1:1\n",
        .channel = {
            {.lines = LINES "\\Line direction: Trace\n", .rows = 64, .columns = 128, .factor = 1},
            {.lines = LINES "\\Line direction: Retrace\n",
             .rows = 64,
             .columns = 128,
             .factor = 2}}};
    size_t size = 0;
    char *bytes = spm_bytes(&f, &size);
    write_file(path, bytes, size);
    free(bytes);
}

static void notes_are_shown(void **state) {
    (void)state;
    static const char oblong[] = "oblong pixels are assumed, so a map of 0.5 x 0.5 um";
    static const char others[] = "other channels: Height (retrace)";
    case_folder c = case_create(NULL);
    char path[400], yaml[400], figures[420];
    write_map(path_in(&c, "a.spm", path));
    snprintf(figures, sizeof figures, "--output=%s.d", path);
    ran r = run_expect(0, HAFT_LAWS, ARGS("inspect", path, figures));
    check_says(r.out, "Nanoscope, channel \"Height (trace)\"");
    check_says(r.out, oblong);
    check_says(r.out, others);
    ran_free(&r);
    r = run_expect(
        0, HAFT_LAWS,
        ARGS("inspect", path, figures, "--channel=Height (retrace)", "--size=500nm x 250nm"));
    check_says(r.out, "Nanoscope, channel \"Height (retrace)\"");
    check_says(r.out, "its size is the one given");
    check_silent_about(r.out, others);
    ran_free(&r);

    char *demo = read_whole_file(HAFT_SOURCE_DIR "/cases/afm-demo/case.yaml", NULL);
    char *ours = replaced(demo, "[surface.gsf]", "[a.spm]");
    char *text = replaced(ours, "grid_step: 10 nm", "grid_step: 5 nm\n  kernel_tolerance: 1e-3");
    write_file(path_in(&c, "case.yaml", yaml), text, strlen(text));
    free(demo);
    free(ours);
    free(text);
    r = run_expect(0, HAFT, ARGS("check", c.path));
    check_says(r.out, oblong);
    check_says(r.out, others);
    ran_free(&r);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(notes_are_shown)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
