/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nanoscope files beyond the usual: electrochemistry and force volumes, frames with fewer lines,
 * channels of the same name, scales of every form, headers that are not what they should be, and
 * files that a transfer as text has changed. */
#include "spm_files.h"

/* A volt of 10 nm, 440 V over 16 bits. */
static const double STEP = 440.0 / 65536 * 10e-9;
#define SCALE "\\@2:Z scale: V [Sens. Zsens] (0.006713867 V/LSB) 440.0000 V\n"
#define SQUARE "\\Samps/line: 16\n\\Number of lines: 16\n\\Bytes/pixel: 2\n\\Scan size: 2 2 ~m\n"
#define HEIGHT "\\@2:Image Data: S [Height] \"Height\"\n"
#define TRACE "\\Line direction: Trace\n"
#define RETRACE "\\Line direction: Retrace\n"

static spm_file one_channel(const char *lines) {
    return (spm_file){.channel = {{.lines = lines, .rows = 16, .columns = 16, .factor = 1}}};
}

static haft_status read_bytes(haft_map **map, const char *bytes, size_t size,
                              const haft_map_options *options, haft_error *error) {
    scratch s = scratch_create();
    char path[400];
    write_file(scratch_path(&s, "a.spm", path), bytes, size);
    *map = NULL;
    haft_status status = haft_map_read(map, path, options, NULL, error);
    scratch_remove(&s);
    return status;
}

static void refuse_bytes(const char *bytes, size_t size, const char *channel, const char *says) {
    haft_map *map = NULL;
    haft_error error = {0};
    haft_map_options options = {.channel = channel};
    if (read_bytes(&map, bytes, size, &options, &error) != HAFT_ERROR_INPUT || map != NULL) {
        fail_msg("read where \"%s\" was to be said: %s", says, error.message);
    }
    if (strstr(error.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", error.message, says);
    }
}

static void refuse(const spm_file *f, const char *channel, const char *says) {
    size_t size = 0;
    char *bytes = spm_bytes(f, &size);
    refuse_bytes(bytes, size, channel, says);
    free(bytes);
}

static haft_map *accept(const spm_file *f, const haft_map_options *options) {
    size_t size = 0;
    haft_map *map = NULL;
    haft_error error = {0};
    char *bytes = spm_bytes(f, &size);
    check_ok(read_bytes(&map, bytes, size, options, &error), error);
    free(bytes);
    return map;
}

static void check_heights(const haft_map *map, double step) {
    for (size_t i = 0; i < map->rows; i++) {
        for (size_t j = 0; j < map->columns; j++) {
            check_relative(map->z[i * map->columns + j], step * (double)map_raw(i, j), 1e-14);
        }
    }
}

static void check_sides(const haft_map *map, double width, double height) {
    check_relative(map->step_column * (double)map->columns, width, 1e-12);
    check_relative(map->step_row * (double)map->rows, height, 1e-12);
}

/* ---- kinds ---- */

static void kinds_of_first_lines(void **state) {
    (void)state;
    static const char *const good[] = {"\\*EC File list\n", "\\*File list\n", "\\*STM File list\n",
                                       "\\*Force file list\n"};
    spm_file f = one_channel(SQUARE HEIGHT SCALE);
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        f.first = good[k];
        haft_map *map = accept(&f, NULL);
        check_heights(map, STEP);
        check_sides(map, 2e-6, 2e-6);
        assert_string_equal(map->channel, "Height");
        assert_string_equal(map->note, "");
        haft_map_destroy(&map);
    }
    f.first = "?*File list\n";
    refuse(&f, NULL, "exported as text");
    f.first = "\\*Force file list\n";
    f.channel[0].title = "\\*Ciao force image list\n";
    refuse(&f, NULL, "force curves, no height map");
    f = one_channel(SQUARE HEIGHT SCALE);
    f.first = "\\*File list\n\\Start context: DTVAR\n";
    refuse(&f, NULL, "profiles of different lengths");
}

/* Of electrochemistry, lists of plots have no data; of force volumes, curves are no maps. */
static void curves_beside_maps(void **state) {
    (void)state;
    spm_file f = one_channel(SQUARE HEIGHT SCALE);
    f.first = "\\*EC File list\n";
    f.channel[1] = (spm_channel){.title = "\\*EC AFM plot I vs. T list\n",
                                 .lines = "\\Samps/line: 0 0\n",
                                 .rows = 2,
                                 .columns = 2,
                                 .factor = 1};
    f.channel[2] = (spm_channel){.title = "\\*Ciao force image list\n",
                                 .lines = HEIGHT,
                                 .rows = 2,
                                 .columns = 2,
                                 .factor = 1};
    haft_map *map = accept(&f, NULL);
    check_heights(map, STEP);
    assert_string_equal(map->note, "");
    haft_map_destroy(&map);
}

/* ---- damage ---- */

/* The text with one kind of line end for another. */
static char *convert(const char *bytes, size_t *size, const char *from, const char *to) {
    size_t n = strlen(from), used = 0;
    char *out = calloc(2 * *size + 1, 1);
    assert_non_null(out);
    for (size_t i = 0; i < *size;) {
        if (i + n <= *size && memcmp(bytes + i, from, n) == 0) {
            memcpy(out + used, to, strlen(to));
            used += strlen(to);
            i += n;
        } else {
            out[used++] = bytes[i++];
        }
    }
    *size = used;
    return out;
}

static void transfers_as_text(void **state) {
    (void)state;
    static const char *const kinds[][2] = {{"\r\n", "\n"}, {"\n", "\r\n"}, {"\r\n", "\r"}};
    spm_file f = one_channel(SQUARE HEIGHT SCALE);
    for (size_t k = 0; k < 3; k++) {
        size_t size = 0;
        char *bytes = spm_bytes(&f, &size);
        bytes[size - 7] = '\r'; /* in the data too */
        bytes[size - 6] = '\n';
        char *changed = convert(bytes, &size, kinds[k][0], kinds[k][1]);
        refuse_bytes(changed, size, NULL, "a transfer as text");
        refuse_bytes(changed, size, "Height", "binary mode");
        free(changed);
        free(bytes);
    }
    /* a line by itself in a note of the user is no such thing */
    f.first = "\\*File list\n\\Note: first\n";
    size_t size = 0;
    char *bytes = spm_bytes(&f, &size);
    memcpy(strstr(bytes, "first"), "fi\nst", 5);
    haft_map *map = NULL;
    haft_error error = {0};
    check_ok(read_bytes(&map, bytes, size, NULL, &error), error);
    haft_map_destroy(&map);
    free(bytes);
}

/* The first channel is whole each time. */
static void every_channel_must_fit(void **state) {
    (void)state;
    static const struct {
        const char *from, *to, *says;
    } harms[] = {
        {"\\Data offset: 4608", "\\Data offset: 4609", "the data of this channel end at byte 5121"},
        {"\\Data offset: 4608", "\\Data offset: 9999", "end at byte 10511, the file at 5120"},
        {"\\Data offset: 4608", "\\Data offset: 4607", "overlap with those of the channel in line"},
        {"\\Data offset: 4608", "\\Data offset: 200", "within the header"},
        {"\\Data offset: 4608", "\\Data offset: -1", "must be a whole number"},
        {"\\Data offset: 4608", "\\Data offset: 0x12", "must be a whole number"},
        {"\\Data offset: 4608\r\n", "", "this list has no \"Data offset\""},
    };
    spm_file f = one_channel(SQUARE HEIGHT SCALE);
    f.channel[1] = (spm_channel){.lines = SQUARE "\\@2:Image Data: S [Phase] \"Phase\"\n",
                                 .rows = 16,
                                 .columns = 16,
                                 .factor = 1};
    haft_map *map = accept(&f, NULL);
    assert_string_equal(map->note, "other channels: Phase");
    haft_map_destroy(&map);
    for (size_t k = 0; k < sizeof harms / sizeof *harms; k++) {
        size_t size = 0;
        char *bytes = spm_bytes(&f, &size);
        spm_edit(bytes, harms[k].from, harms[k].to);
        refuse_bytes(bytes, size, "Height", harms[k].says);
        free(bytes);
    }
}

static void headers_are_strict(void **state) {
    (void)state;
    static const struct {
        const char *from, *to, *says;
    } harms[] = {
        {"Samps/line: 16", "Samps/line: 0x", "a.spm:10: \"Samps/line\" is \"0x\""},
        {"Samps/line: 16", "Samps/line: -1", "a.spm:10: \"Samps/line\" is \"-1\""},
        {"Samps/line: 16", "Samps/line: ", "a.spm:10: \"Samps/line\" is \"\""},
        {"\\Samps/line: 16\r\n", "", "a.spm:7: this list has no \"Samps/line\""},
        {"Samps/line: 16", "Samps/line: 17", "512 bytes of data for 16 x 17 pixels"},
        {"lines: 16", "lines: 1", "512 bytes of data for 1 x 16 pixels"},
        {"pixel: 2", "pixel: 1", "pixels of 1 bytes"},
        {"pixel: 2", "pixel: x", "\"Bytes/pixel\" is \"x\""},
        {"size: 2 2 ~m", "size: 2 2", "a.spm:13: \"Scan size\" is \"2 2\", no length"},
        {"size: 2 2 ~m", "size: 2 -2 m", "no length"},
        {"size: 2 2 ~m", "size: 0x2 m", "no length"},
        {"size: 2 2 ~m", "size: 2 2 V", "no length"},
        {"\\Scan size: 2 2 ~m\r\n", "", "no \"Scan size\""},
        {"440.0000 V", "0x440 V", "a.spm:15: \"Z scale\" is"},
        {"440.0000 V", "-440 V", "gives no positive number"},
        {"440.0000 V", "0 V", "gives no positive number"},
        {"440.0000 V", "nan V", "gives no positive number"},
        {"440.0000 V", "", "gives no positive number"},
        {"440.0000 V", "440 A", "no z-scale in metres"},
        {"440.0000 V", "440", "no z-scale in metres"},
        {"[Sens. Zsens]", "[Sens. Zsens", "gives no positive number"},
        {"[Sens. Zsens]", "[Sens. X]", "no list gives \"@Sens. X\""},
        {"(0.006713867 V/LSB)", "(0.006713867 V", "gives no positive number"},
        {"10.00000 nm/V", "10 nA/V", "no z-scale in metres"},
        {"10.00000 nm/V", "10 nm/A", "no z-scale in metres"},
        {"10.00000 nm/V", "10 nm", "no z-scale in metres"},
        {"10.00000 nm/V", "-10 nm/V", "a.spm:5: \"@Sens. Zsens\" is"},
        {"10.00000 nm/V", "0x10 nm/V", "gives no positive number"},
        {"\\@2:Z scale", "\\@2:Zscale", "the channel has no z-scale in metres"},
    };
    spm_file f = one_channel(SQUARE HEIGHT SCALE);
    for (size_t k = 0; k < sizeof harms / sizeof *harms; k++) {
        size_t size = 0;
        char *bytes = spm_bytes(&f, &size);
        spm_edit(bytes, harms[k].from, harms[k].to);
        refuse_bytes(bytes, size, "Height", harms[k].says);
        free(bytes);
    }
}

/* ---- scales ---- */

static void scales_of_every_form(void **state) {
    (void)state;
    static const struct {
        const char *scan, *scale;
        double metres; /* the whole range */
    } forms[] = {
        {"", "\\@2:Z scale: V [Sens. Zsens] (0.006 V/LSB) 440 V\n", 4400e-9},
        {"", "\\@3:Z scale: V [Sens. Zsens] (0.006 V/LSB) 440 V\n", 4400e-9},
        {"", "\\@2:Z scale: V [Sens. Zsens] 440 V\n", 4400e-9},
        {"", "\\@2:Z scale: V [Sens. Zsens] (6 mV/LSB) 440000 mV\n", 4400e-9},
        {"\\@Sens. Zscan: V 2 \xb5m/V\n", "\\@2:Z scale: V [Sens. Zscan] (1 V/LSB) 3 V\n", 6e-6},
        {"\\@Sens. Zscan: V 2 ~m/V\n", "\\@2:Z scale: V [Sens. Zscan] (1 V/LSB) 3 V\n", 6e-6},
        {"\\@Sens. Zscan: V 2 nm/mV\n", "\\@2:Z scale: V [Sens. Zscan] (1 V/LSB) 3 V\n", 6e-6},
        {"\\@Sens. Zscan: V 2 nm\n", "\\@2:Z scale: V [Sens. Zscan] (1 V/LSB) 3\n", 6e-9},
        {"", "\\@2:Z scale: V (0.1 nm/LSB) 250 nm\n", 250e-9},
        {"", "\\@2:Z scale: 250 nm\n", 250e-9},
        {"", "\\Z scale: 250 nm (65536)\n", 250e-9},
        {"", "\\Z scale: 0.25 ~m\n", 250e-9},
        {"", "\\Z magnify image: 2.5\n", 250e-9},
    };
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++) {
        char lines[400];
        snprintf(lines, sizeof lines, "%s%s%s", SQUARE, HEIGHT, forms[k].scale);
        spm_file f = one_channel(lines);
        f.scan = forms[k].scan;
        haft_map *map = accept(&f, NULL);
        check_heights(map, forms[k].metres / 65536);
        haft_map_destroy(&map);
    }
    /* 32 bits, and (V/LSB) that tells which power is meant */
    spm_file f = one_channel("\\Samps/line: 16\n\\Number of lines: 16\n\\Bytes/pixel: 4\n"
                             "\\Scan size: 2 2 ~m\n" HEIGHT SCALE);
    f.channel[0].bytes = 4;
    f.channel[0].factor = 100003;
    haft_map *map = accept(&f, NULL);
    check_heights(map, 100003 * STEP / 65536);
    haft_map_destroy(&map);
    f.channel[0].lines = SQUARE HEIGHT SCALE;
    f.channel[0].factor = 1;
    map = accept(&f, NULL);
    check_heights(map, STEP);
    haft_map_destroy(&map);
}

/* ---- sizes ---- */

static void frames_with_fewer_lines(void **state) {
    (void)state;
    static const struct {
        const char *scan, *lines;
        size_t rows;
        double width, height;
        const char *note;
    } frames[] = {
        /* what the header says of the frame is square, whatever its lines */
        {"\\Lines: 16\n\\Aspect ratio: 1:1\n\\Scan size: 10000 nm\n",
         "\\Number of lines: 16\n\\Aspect ratio: 1:1\n\\Scan size: 10 10 ~m\n", 16, 10e-6, 10e-6,
         "oblong pixels are assumed, so a map of 10 x 10 um"},
        {"\\Lines: 16\n\\Aspect ratio: 2:1\n",
         "\\Number of lines: 16\n\\Aspect ratio: 2:1\n\\Scan size: 10 10 ~m\n", 16, 10e-6, 5e-6,
         ""},
        {"\\Lines: 8\n\\Aspect ratio: 4:1\n",
         "\\Number of lines: 8\n\\Aspect ratio: 4:1\n\\Scan size: 10 10 ~m\n", 8, 10e-6, 2.5e-6,
         ""},
        {"\\Lines: 16\n\\Aspect ratio: 2:1\n", "\\Number of lines: 16\n\\Scan size: 10000 nm\n", 16,
         10e-6, 5e-6, ""},
        {"", "\\Number of lines: 16\n\\Aspect ratio: 2:1\n\\Scan size: 10 10 ~m\n", 16, 10e-6, 5e-6,
         ""},
        {"\\Lines: 32\n\\Aspect ratio: 1:1\n",
         "\\Number of lines: 32\n\\Aspect ratio: 2:1\n\\Scan size: 10 10 ~m\n", 32, 10e-6, 5e-6,
         "oblong pixels are assumed, so a map of 10 x 5 um"},
        /* a part of the frame, and a ratio without meaning */
        {"\\Lines: 32\n\\Aspect ratio: 1:1\n",
         "\\Number of lines: 22\n\\Aspect ratio: 0.516184\n\\Scan size: 320 320 nm\n", 22, 320e-9,
         220e-9, ""},
        /* what the list says is stated */
        {"\\Lines: 16\n", "\\Number of lines: 16\n\\Scan size: 10 4 ~m\n", 16, 10e-6, 4e-6, ""},
        /* the list tells of a frame, and its data are fewer */
        {"\\Lines: 4\n\\Aspect ratio: 8:1\n",
         "\\Number of lines: 32\n\\Valid data len X: 32\n\\Valid data len Y: 4\n\\Scan size: 64 64 "
         "~m\n",
         4, 64e-6, 8e-6, "32 x 4 pixels are read by \"Valid data len\""},
        {"\\Samps/line: 32\n\\Lines: 8\n\\Aspect ratio: 4:1\n",
         "\\Number of lines: 32\n\\Scan size: 64 64 ~m\n", 8, 64e-6, 16e-6,
         "by \"Lines of the scan list\""},
        {"", "\\Number of lines: 16\n\\Scan size: 10 10 ~m\n", 16, 10e-6, 5e-6,
         "square pixels are assumed"},
        {"\\Lines: 16\n",
         "\\Number of lines: 16\n\\Scan size: 10 5 ~m\n\\Valid data len X: 32\n\\Valid data len Y: "
         "9\n",
         16, 10e-6, 5e-6, "counts 32 x 9 pixels as valid"},
    };
    for (size_t k = 0; k < sizeof frames / sizeof *frames; k++) {
        char lines[500];
        snprintf(lines, sizeof lines, "\\Samps/line: 32\n\\Bytes/pixel: 2\n%s%s%s", frames[k].lines,
                 HEIGHT, SCALE);
        spm_file f = one_channel(lines);
        f.scan = frames[k].scan;
        f.channel[0].columns = 32;
        f.channel[0].rows = frames[k].rows;
        haft_map *map = accept(&f, NULL);
        assert_int_equal(map->rows, frames[k].rows);
        check_heights(map, STEP);
        check_sides(map, frames[k].width, frames[k].height);
        if (strstr(map->note, frames[k].note) == NULL ||
            (frames[k].note[0] == '\0') != (map->note[0] == '\0')) {
            fail_msg("frame %zu: note \"%s\", not \"%s\"", k, map->note, frames[k].note);
        }
        haft_map *copy = NULL;
        haft_error error = {0};
        check_ok(haft_map_copy(&copy, map, &error), error);
        assert_string_equal(copy->note, map->note);
        haft_map_destroy(&copy);
        haft_map_destroy(&map);
        if (k == 0) { /* what the header leaves open, the user decides */
            map = accept(&f, &(haft_map_options){.width = 10e-6, .height = 5e-6});
            check_sides(map, 10e-6, 5e-6);
            haft_map_destroy(&map);
        }
    }
}

/* ---- channels ---- */

static void check_channel(const spm_file *f, const char *asked, long factor, const char *label,
                          const char *note) {
    haft_map *map = accept(f, &(haft_map_options){.channel = asked});
    check_heights(map, STEP * (double)factor);
    assert_string_equal(map->channel, label);
    assert_string_equal(map->note, note);
    haft_map_destroy(&map);
}

static void trace_and_retrace(void **state) {
    (void)state;
    static const char *const ways[] = {"Height (retrace)", "height retrace",
                                       "Height 2",         "Height(Retrace)",
                                       "HEIGHT, retrace",  "Height retrace main"};
    spm_file f = one_channel(SQUARE HEIGHT TRACE SCALE);
    f.channel[1] = f.channel[0];
    f.channel[1].lines = SQUARE HEIGHT RETRACE SCALE;
    f.channel[1].factor = -2;
    for (int turn = 0; turn < 2; turn++) {
        check_channel(&f, NULL, 1, "Height (trace)", "other channels: Height (retrace)");
        check_channel(&f, "Height", 1, "Height (trace)", "other channels: Height (retrace)");
        check_channel(&f, "Height (trace)", 1, "Height (trace)", "");
        check_channel(&f, turn == 0 ? "Height 1" : "Height 2", 1, "Height (trace)", "");
        for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
            if (turn == 0 || k != 2) {
                check_channel(&f, ways[k], -2, "Height (retrace)", "");
            }
        }
        refuse(&f, "Height 3", "no channel \"Height 3\"; it has: Height (");
        refuse(&f, "Height (sideways)", "no channel \"Height (sideways)\"");
        refuse(&f, "Height trace retrace", "no channel");
        refuse(&f, "Heigh", "no channel \"Heigh\"");
        spm_channel other = f.channel[0]; /* the retrace may come first */
        f.channel[0] = f.channel[1];
        f.channel[1] = other;
    }
}

static void names_that_leave_a_choice(void **state) {
    (void)state;
    spm_file f = one_channel(SQUARE HEIGHT TRACE SCALE);
    f.channel[1] = f.channel[0];
    f.channel[1].factor = 3;
    f.channel[2] = f.channel[0];
    f.channel[2].lines = SQUARE HEIGHT TRACE "\\Scan line: Interleave\n" SCALE;
    f.channel[2].factor = 5;
    refuse(&f, "Height",
           "several channels \"Height\"; it has: Height 1, Height 2, Height (trace, "
           "interleave)");
    check_channel(&f, "Height 2", 3, "Height 2", "");
    check_channel(&f, "Height interleave", 5, "Height (trace, interleave)", "");
    check_channel(&f, "Height (trace, interleave)", 5, "Height (trace, interleave)", "");
    /* a number may belong to the name */
    f.channel[1].lines = SQUARE "\\@2:Image Data: S [Height2] \"Height 2\"\n" RETRACE SCALE;
    check_channel(&f, "Height 2", 3, "Height 2 (retrace)", "");
    check_channel(&f, "height2", 3, "Height 2 (retrace)", "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kinds_of_first_lines),      cmocka_unit_test(curves_beside_maps),
        cmocka_unit_test(transfers_as_text),         cmocka_unit_test(every_channel_must_fit),
        cmocka_unit_test(headers_are_strict),        cmocka_unit_test(scales_of_every_form),
        cmocka_unit_test(frames_with_fewer_lines),   cmocka_unit_test(trace_and_retrace),
        cmocka_unit_test(names_that_leave_a_choice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
