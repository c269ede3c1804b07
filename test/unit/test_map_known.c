/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formats that are not read: each is named by its first bytes, whatever the file is called, with
 * what to do; a name alone is no more than a hint. */
#include "scratch.h"

#include "haft/io.h"

static void check_says_of(const scratch *s, const char *name, const void *bytes, size_t size,
                          const char *says, const char *advice) {
    char path[400];
    haft_map *map = NULL;
    haft_error error = {0};
    write_file(scratch_path(s, name, path), bytes, size);
    if (haft_map_read(&map, path, NULL, NULL, &error) != HAFT_ERROR_INPUT ||
        strstr(error.message, says) == NULL || strstr(error.message, advice) == NULL) {
        fail_msg("%s: not \"%s\" and \"%s\" but \"%s\"", name, says, advice, error.message);
    }
    assert_null(map);
    unlink(path);
}

#define TEXT(text) (text), sizeof(text) - 1

static void beginnings(void **state) {
    (void)state;
    static const struct {
        const char *bytes;
        size_t size;
        const char *says, *advice;
    } cases[] = {
        {TEXT("DIGITAL SURF\0\0\1\0"), "Digital Surf", "haft-import FILE"},
        {TEXT("DSCOMPRESSED\0\0\1\0"), "Digital Surf", "Gwyddion"},
        {TEXT("aISO-1.0\nManufacID = X\n"), "25178-71", "haft-import FILE"},
        {TEXT("bISO-1.0\0\0"), "25178-71", ".gsf"},
        {TEXT("aBCR-1.0\nManufacID = X\n"), "25178-71", "haft-import FILE"},
        {TEXT("bBCR-1.0\0\0"), "25178-71", "haft-import FILE"},
        {TEXT("[DataSet]\r\nVersion=2\r\n"), "Nanosurf", "haft-import FILE"},
        {TEXT("\1\0Directory\0\0"), "Wyko", "haft-import FILE"},
        {TEXT("VCA DATA\1\0\0\x55"), "Dektak", "haft-import FILE"},
        {TEXT("WSxM file copyright UAM\r\nSxM Image file\r\n\0\1"), "WSxM", "haft-import FILE"},
        {TEXT("UK SOFT\r\n\0"), "Molecular Imaging", "haft-import FILE"},
        {TEXT("\x88\x1b\x03\x6f\0\0"), "MetroPro", "haft-import FILE"},
        {TEXT("\x88\x1b\x03\x70\0\0"), "MetroPro", "haft-import FILE"},
        {TEXT("\x88\x1b\x03\x71\0\0"), "MetroPro", "haft-import FILE"},
        {TEXT("AliconaImaging\0\r\n"), "Alicona", "haft-import FILE"},
        {TEXT("\1\2\3\4\20\0\0\0ARDF\0\1\0\0"), "ARDF", "haft-import FILE"},
        {TEXT("\1\xb0\x93\xff\0\0"), "NT-MDT", "haft-import FILE"},
        {TEXT("ONTMATRX0101TLKB"), "MATRIX", "haft-import FILE"},
        {TEXT(":NANONIS_VERSION:\n2\n"), "Nanonis", "haft-import FILE"},
        {TEXT("[Parameter]\r\nDAC-Type"), "Createc", "haft-import FILE"},
        {TEXT("[Paramco32]\r\nDAC-Type"), "Createc", "haft-import FILE"},
        {TEXT("\xaa\0S\0T\0i\0M\0a\0g\0e\0 \0\60\0\60\0\65\0.\0"), "RHK", "haft-import FILE"},
        {TEXT("IGOR\nWAVES/D z\n"), "Igor", "haft-import FILE"},
        {TEXT("Zygo ASCII Data File - Format 2\n"), "Zygo", "haft-import FILE"},
        {TEXT("DSAA\n2 2\n"), "Surfer", "haft-import FILE"},
        {TEXT("ncols 4\nnrows 4\n"), "Esri", "haft-import FILE"},
        {TEXT("ply\nformat ascii 1.0\n"), "polygons", "grid"},
        {TEXT("solid cube\n"), "triangles", "grid"},
        {TEXT("<?xml version=\"1.0\"?>\n"), "XML", "CSV"},
        {TEXT("{\"z\": []}\n"), "JSON", "CSV"},
        {TEXT("VK4_\0\0"), "Keyence", "haft-import FILE"},
        {TEXT("GWYOGwyContainer\0"), "version 1", "save it anew"},
        {TEXT("Gwyddion XYZ Field 1.0\nNPoints = 1\n"), "points", "grid"},
        {TEXT("CDF\1\0\0\0\0"), "NetCDF", "nccopy"},
        {TEXT("CDF\2\0\0\0\0"), "NetCDF", "nccopy"},
        {TEXT("CDF\5\0\0\0\0"), "NetCDF", "nccopy"},
        {TEXT("MATLAB 5.0 MAT-file, Platform: PCWIN"), "MATLAB", "writematrix"},
        {TEXT("\x89PNG\r\n\x1a\n\0\0"), "PNG", "no heights"},
        {TEXT("\xff\xd8\xff\xe0\0\0"), "JPEG", "no heights"},
        {TEXT("GIF89a"), "GIF", "no heights"},
        {TEXT("BM\x12\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"), "bitmap", "no heights"},
        {TEXT("%PDF-1.4\n"), "PDF", "no heights"},
        {TEXT("\x1f\x8b\x08\0"), "gzip", "gunzip"},
        {TEXT("BZh91AY"), "bzip2", "bunzip2"},
        {TEXT("\xfd"
              "7zXZ\0"),
         "xz", "unxz"},
        {TEXT("\x28\xb5\x2f\xfd\0"), "Zstandard", "unzstd"},
        {TEXT("<!DOCTYPE html>\n<html>"), "web page", "download"},
        {TEXT("version https://git-lfs.github.com/spec/v1\n"), "Git LFS", "git lfs pull"},
        /* shared beginnings */
        {TEXT("MM\0*\0\0\0\10\0\1\x80\0\0\3\0\0\0\1\0\0\0\0\0\0\0\0"), "JPK", "haft-import FILE"},
        {TEXT("II*\0\10\0\0\0\1\0\0\xc5\4\0\1\0\0\0\1\3\23\16\0\0\0\0"), "Park",
         "haft-import FILE"},
        {TEXT("II*\0\10\0\0\0\1\0\0\1\4\0\1\0\0\0\1\3\23\16\0\0\0\0"), "a TIFF image", "Gwyddion"},
        {TEXT("II*\0\xff\xff\xff\xff"), "a TIFF image", "Gwyddion"},
        {TEXT("PK\3\4\24\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\10\0\0\0main.xml<p"), "x3p",
         "haft-import FILE"},
        {TEXT("PK\3\4\24\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\5\0\0\0z.npy\x93NUMPY"), "npz",
         "numpy.save"},
        {TEXT("PK\3\4\24\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\21\0\0\0header.propertiesx"),
         "JPK", "haft-import FILE"},
        {TEXT("PK\3\4\24\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\37\0\0\0"
              "header.properties segments/0/segment-header.properties"),
         "force curves", "height channel"},
        {TEXT("PK\3\4\24\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\5\0\0\0a.csv1"), "ZIP", "unzip"},
    };
    scratch s = scratch_create();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        check_says_of(&s, "map.txt", cases[k].bytes, cases[k].size, cases[k].says, cases[k].advice);
        assert_true(cases[k].size > 3); /* and cut anywhere it is no crash */
        for (size_t cut = 1; cut < cases[k].size; cut++) {
            check_says_of(&s, "cut", cases[k].bytes, cut, "cut", "");
        }
    }
    scratch_remove(&s);
}

/* An Igor binary wave has no letters of its own, but a checksum. */
static void igor(void **state) {
    (void)state;
    scratch s = scratch_create();
    for (int big_endian = 0; big_endian < 2; big_endian++) {
        unsigned char bytes[400] = {0};
        unsigned sum = 5 + 0x1234;
        bytes[big_endian] = 5;
        bytes[100 + big_endian] = 0x34;
        bytes[101 - big_endian] = 0x12;
        bytes[2 + big_endian] = (unsigned char)(0x10000 - sum);
        bytes[3 - big_endian] = (unsigned char)((0x10000 - sum) >> 8);
        check_says_of(&s, "wave", bytes, sizeof bytes, "Igor", "haft-import FILE");
        bytes[50] ^= 1;
        check_says_of(&s, "wave", bytes, sizeof bytes, "no height map that Haft knows", "Gwyddion");
        check_says_of(&s, "wave.IBW", bytes, sizeof bytes,
                      "by its name it would be an Igor binary wave (ibw), but it does not begin",
                      "haft-import FILE");
    }
    scratch_remove(&s);
}

/* A name is a hint where the contents say nothing, and nothing where they do. */
static void names(void **state) {
    (void)state;
    static const char *const extensions[] = {"sur", "pro",  "sdf",  "nid", "opd", "stp",
                                             "top", "al3d", "ardf", "mdt", "sxm", "sm4",
                                             "jpk", "x3p",  "plu",  "ibw", "mat"};
    scratch s = scratch_create();
    for (size_t k = 0; k < sizeof extensions / sizeof *extensions; k++) {
        char name[40];
        snprintf(name, sizeof name, "map.%s", extensions[k]);
        check_says_of(&s, name, TEXT("\0\1\2\3\4\5\6\7"), "by its name it would be",
                      extensions[k][0] == 'm' && extensions[k][1] == 'a' ? "writematrix" : ".gsf");
    }
    char path[400];
    haft_map *map = NULL;
    haft_error error = {0};
    haft_map_options options = {.width = 1, .height = 1, .unit = 1};
    write_file(scratch_path(&s, "map.sur", path), TEXT("1 2\n3 4\n"));
    check_ok(haft_map_read(&map, path, &options, NULL, &error), error);
    haft_map_destroy(&map);
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(beginnings), cmocka_unit_test(igor),
                                       cmocka_unit_test(names)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
