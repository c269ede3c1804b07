/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formats that Haft knows but does not read, so that the message can say what the file is and what
 * to do. A format is recognised by its first bytes; if several formats share them (TIFF, ZIP), by
 * the contents that the file lists; if it has no fixed first bytes, by the file's name, and the
 * message says so. */
#include "map_file.h"

#include <stdio.h>
#include <string.h>

/* What to do with a file. */
typedef enum advice { CONVERT, UNPACK, IMAGE, CURVES, OTHER } advice;

static const char *const advices[] = {
    [CONVERT] = ("Haft does not read it; convert it to Gwyddion Simple Field (.gsf): with "
                 "`haft-import FILE` where that program is installed, or in Gwyddion by File > "
                 "Save as"),
    [UNPACK] = "unpack it first",
    [IMAGE] = ("its colours are no heights; export the heights from the instrument's program, as "
               "text or in its own format"),
    [CURVES] = "it holds force curves, no height map; export a height channel",
};

typedef struct known {
    const char *name;
    const char *begins;    /* first bytes; NULL: recognised only by the file's name */
    size_t length, offset; /* of them */
    const char *extension; /* of such files, "" if they have none of their own */
    advice advice;
    const char *remedy; /* for OTHER */
} known;

#define MAGIC(text) (text), sizeof(text) - 1, 0
#define MAGIC_AT(offset, text) (text), sizeof(text) - 1, (offset)
#define NO_MAGIC NULL, 0, 0

static const char MESH[] = "put its points onto a grid, and save the heights as text or CSV";

/* Of two beginnings that match, the longer one comes first. */
static const known formats[] = {
    {"a Digital Surf map (sur, pro)", MAGIC("DIGITAL SURF"), ".sur", CONVERT, NULL},
    {"a Digital Surf map (sur, pro)", MAGIC("DSCOMPRESSED"), ".pro", CONVERT, NULL},
    {"an ISO 25178-71 map (sdf, text)", MAGIC("aISO-1.0"), ".sdf", CONVERT, NULL},
    {"an ISO 25178-71 map (sdf, binary)", MAGIC("bISO-1.0"), ".sdf", CONVERT, NULL},
    {"an ISO 25178-71 map (sdf, text)", MAGIC("aBCR-1.0"), ".sdf", CONVERT, NULL},
    {"an ISO 25178-71 map (sdf, binary)", MAGIC("bBCR-1.0"), ".sdf", CONVERT, NULL},
    {"an ISO 28600 map", MAGIC("ISO/TC 201 SPM data transfer format"), "", CONVERT, NULL},
    {"a Nanosurf file (nid, ezd)", MAGIC("[DataSet]\r\n"), ".nid", CONVERT, NULL},
    {"a Nanosurf file (nhf)", NO_MAGIC, ".nhf", CONVERT, NULL},
    {"a Wyko (Veeco, Bruker) file (opd)", MAGIC("\001\000Directory"), ".opd", CONVERT, NULL},
    {"a Wyko file (text)", MAGIC("Wyko ASCII Data File Format"), "", CONVERT, NULL},
    {"a Dektak (Bruker) file (OPDx)", MAGIC("VCA DATA\001\000\000\125"), ".opdx", CONVERT, NULL},
    {"a WSxM file (stp, top)", MAGIC("WSxM file copyright"), ".stp", CONVERT, NULL},
    {"a Molecular Imaging file (stp)", MAGIC("UK SOFT\r\n"), "", CONVERT, NULL},
    {"a WSxM file (stp, top)", NO_MAGIC, ".top", CONVERT, NULL},
    {"a Zygo MetroPro file (dat)", MAGIC("\210\033\003\157"), "", CONVERT, NULL},
    {"a Zygo MetroPro file (dat)", MAGIC("\210\033\003\160"), "", CONVERT, NULL},
    {"a Zygo MetroPro file (dat)", MAGIC("\210\033\003\161"), "", CONVERT, NULL},
    {"an Alicona file (al3d)", MAGIC("AliconaImaging\000\r\n"), ".al3d", CONVERT, NULL},
    {"an Asylum Research file (ARDF)", MAGIC_AT(8, "ARDF"), ".ardf", CONVERT, NULL},
    {"an NT-MDT file (mdt)", MAGIC("\001\260\223\377"), ".mdt", CONVERT, NULL},
    {"an Omicron MATRIX file (mtrx)", MAGIC("ONTMATRX0101"), ".mtrx", CONVERT, NULL},
    {"an Omicron flat file", MAGIC("FLAT0100"), "", CONVERT, NULL},
    {"a Nanonis file (sxm)", MAGIC(":NANONIS_VERSION:"), ".sxm", CONVERT, NULL},
    {"a Createc file (dat)", MAGIC("[Parameter]\r\n"), "", CONVERT, NULL},
    {"a Createc file (dat)", MAGIC("[Paramet32]\r\n"), "", CONVERT, NULL},
    {"a Createc file (dat)", MAGIC("[Paramco32]\r\n"), "", CONVERT, NULL},
    {"an RHK file (sm3, sm4)", MAGIC_AT(2, "S\0T\0i\0M\0a\0g\0e\0 \0"), ".sm4", CONVERT, NULL},
    {"an RHK file (sm2)", MAGIC("STiMage 3.1"), ".sm2", CONVERT, NULL},
    {"an Igor binary wave (ibw)", NO_MAGIC, ".ibw", CONVERT, NULL},
    {"a JPK file (jpk)", NO_MAGIC, ".jpk", CONVERT, NULL},
    {"an ISO 25178-72 map (x3p)", NO_MAGIC, ".x3p", CONVERT, NULL},
    {"a Sensofar file (plu)", NO_MAGIC, ".plu", CONVERT, NULL},
    {"a Keyence file (vk4, vk6, vk7)", MAGIC("VK4_"), ".vk4", CONVERT, NULL},
    {"a Keyence file (vk4, vk6, vk7)", MAGIC("VK6"), ".vk6", CONVERT, NULL},
    {"a Keyence file (vk4, vk6, vk7)", MAGIC("VK7"), ".vk7", CONVERT, NULL},
    {"a FRT MicroProf file (frt)", MAGIC("FRTM_"), ".frt", CONVERT, NULL},
    {"a DME file (dsm)", MAGIC("RSCOPE"), "", CONVERT, NULL},
    {"a DME file (gdf)", MAGIC("GDEF\000"), "", CONVERT, NULL},
    {"a Seiko file (xqb)", MAGIC("SPIZ000"), ".xqb", CONVERT, NULL},
    {"a Shimadzu file", MAGIC("Shimadzu SPM File Format"), "", CONVERT, NULL},
    {"a Molecular Imaging file (mi)", MAGIC("fileType      Image"), ".mi", CONVERT, NULL},
    {"an Igor text file (itx)", MAGIC("IGOR"), ".itx", CONVERT, NULL},
    {"a Zygo text file", MAGIC("Zygo ASCII"), "", CONVERT, NULL},
    {"a Surfer grid (text)", MAGIC("DSAA"), ".grd", CONVERT, NULL},
    {"an Esri grid (text)", MAGIC("ncols"), ".asc", CONVERT, NULL},
    {"an Esri grid (text)", MAGIC("NCOLS"), "", CONVERT, NULL},
    {"a file of polygons (ply)", MAGIC("ply\n"), ".ply", OTHER, MESH},
    {"a file of triangles (stl)", MAGIC("solid "), ".stl", OTHER, MESH},
    {"an XML file", MAGIC("<?xml"), ".xml", OTHER, "save the heights as text or CSV"},
    {"a JSON file", MAGIC("{"), ".json", OTHER, "save the heights as text or CSV"},
    {"a BCR-STM file (bcr)", MAGIC("fileformat = bcr"), ".bcr", CONVERT, NULL},
    {"a Gwyddion file of points (gxyzf)", MAGIC("Gwyddion XYZ Field 1.0\n"), ".gxyzf", OTHER,
     "interpolate the points onto a grid in Gwyddion (Rasterize) and save that as Gwyddion Simple "
     "Field (.gsf)"},
    {"a Gwyddion file (gwy) of version 1", MAGIC("GWYOGwyContainer"), "", OTHER,
     "open it in Gwyddion 2 and save it anew"},
    {"a NetCDF file in the classic format", MAGIC("CDF\001"), "", OTHER,
     "make a NetCDF-4 file of it, which is read as HDF5: nccopy -k netCDF-4 OLD.nc NEW.nc"},
    {"a NetCDF file in the 64-bit classic format", MAGIC("CDF\002"), "", OTHER,
     "make a NetCDF-4 file of it, which is read as HDF5: nccopy -k netCDF-4 OLD.nc NEW.nc"},
    {"a NetCDF file in the 64-bit classic format", MAGIC("CDF\005"), "", OTHER,
     "make a NetCDF-4 file of it, which is read as HDF5: nccopy -k netCDF-4 OLD.nc NEW.nc"},
    {"a MATLAB file (mat, version 5)", MAGIC("MATLAB 5.0 MAT-file"), ".mat", OTHER,
     "write the heights as text: writematrix(z, \"map.txt\", \"Delimiter\", \"tab\")"},
    {"an HDF4 file", MAGIC("\016\003\023\001"), ".hdf", OTHER, "convert it to HDF5: h4toh5 FILE"},
    {"an AFM Workshop file", MAGIC("Force-Distance Curve"), "", CURVES, NULL},
    {"a PNG image", MAGIC("\211PNG\r\n\032\n"), ".png", IMAGE, NULL},
    {"a JPEG image", MAGIC("\377\330\377"), ".jpg", IMAGE, NULL},
    {"a GIF image", MAGIC("GIF8"), ".gif", IMAGE, NULL},
    {"a Windows bitmap", NO_MAGIC, ".bmp", IMAGE, NULL},
    {"a PDF document", MAGIC("%PDF-"), ".pdf", IMAGE, NULL},
    {"compressed by gzip", MAGIC("\037\213"), ".gz", OTHER, "unpack it first: gunzip FILE"},
    {"compressed by bzip2", MAGIC("BZh"), ".bz2", OTHER, "unpack it first: bunzip2 FILE"},
    {"compressed by xz", MAGIC("\3757zXZ\000"), ".xz", OTHER, "unpack it first: unxz FILE"},
    {"compressed by Zstandard", MAGIC("\050\265\057\375"), ".zst", OTHER,
     "unpack it first: unzstd FILE"},
    {"an archive of 7-Zip", MAGIC("7z\274\257\047\034"), ".7z", UNPACK, NULL},
    {"a RAR archive", MAGIC("Rar!\032\007"), ".rar", UNPACK, NULL},
    {"a web page, no height map", MAGIC("<!DOCTYPE"), ".html", OTHER,
     "the download went wrong; load the file itself"},
    {"a web page, no height map", MAGIC("<!doctype"), "", OTHER,
     "the download went wrong; load the file itself"},
    {"a web page, no height map", MAGIC("<html"), "", OTHER,
     "the download went wrong; load the file itself"},
    {"a pointer of Git LFS, no height map", MAGIC("version https://git-lfs"), "", OTHER,
     "load the file itself: git lfs pull"},
    {"an Excel table", MAGIC("\320\317\021\340\241\261\032\341"), ".xls", OTHER,
     "save the heights as text or CSV"},
};

enum { FORMATS = sizeof formats / sizeof *formats };

/* ---- formats that need more than their first bytes ---- */

static uint32_t word_at(const haft_map_file *file, size_t at, size_t n, bool big_endian) {
    uint32_t word = 0;
    for (size_t k = 0; k < n; k++) {
        word |= (uint32_t)(unsigned char)file->bytes[big_endian ? at + n - 1 - k : at + k]
                << (8 * k);
    }
    return word;
}

static bool holds(const haft_map_file *file, const char *name) {
    return memmem(file->bytes, file->size, name, strlen(name)) != NULL;
}

/* Igor's binary waves: a version, and headers whose 16-bit words have the sum 0. */
static bool is_igor(const haft_map_file *file) {
    static const struct {
        uint32_t version;
        size_t header;
    } kinds[] = {{1, 118}, {2, 126}, {3, 130}, {5, 384}};
    for (size_t k = 0; k < 2 * sizeof kinds / sizeof *kinds; k++) {
        bool big_endian = k % 2 == 1;
        uint32_t sum = 0;
        if (file->size < kinds[k / 2].header ||
            word_at(file, 0, 2, big_endian) != kinds[k / 2].version) {
            continue;
        }
        for (size_t at = 0; at < kinds[k / 2].header; at += 2) {
            sum += word_at(file, at, 2, big_endian);
        }
        if ((sum & 0xffff) == 0) {
            return true;
        }
    }
    return false;
}

/* TIFF: microscopes add tags of their own to its first directory. */
static const known *find_tiff(const haft_map_file *file) {
    static const known park = {"a Park Systems file (TIFF)", NO_MAGIC, "", CONVERT, NULL},
                       jpk = {"a JPK file (TIFF)", NO_MAGIC, "", CONVERT, NULL},
                       other = {"a TIFF image", NO_MAGIC, "", OTHER,
                                "if its pixels are heights, which the file does not say, open it "
                                "in Gwyddion, give the size and unit, and save it as Gwyddion "
                                "Simple Field (.gsf)"};
    if (file->size < 8 ||
        (memcmp(file->bytes, "II*\0", 4) != 0 && memcmp(file->bytes, "MM\0*", 4) != 0)) {
        return file->size >= 8 && (memcmp(file->bytes, "II+\0", 4) == 0 ||
                                   memcmp(file->bytes, "MM\0+", 4) == 0)
                   ? &other
                   : NULL;
    }
    bool big_endian = file->bytes[0] == 'M';
    size_t at = word_at(file, 4, 4, big_endian);
    size_t count = at + 2 <= file->size ? word_at(file, at, 2, big_endian) : 0;
    for (size_t k = 0; k < count && at + 14 + 12 * k <= file->size; k++) {
        uint32_t tag = word_at(file, at + 2 + 12 * k, 2, big_endian);
        if (tag >= 0x8000 && tag <= 0x8003) {
            return &jpk;
        }
        if (tag == 50432) {
            return &park;
        }
    }
    return &other;
}

/* ZIP: the names of its members are in it as plain text. */
static const known *find_zip(const haft_map_file *file) {
    static const struct {
        const char *holds;
        known format;
    } kinds[] = {
        {"main.xml", {"an ISO 25178-72 map (x3p)", NO_MAGIC, "", CONVERT, NULL}},
        {"jpk-qi-image", {"a JPK file (jpk-qi-data)", NO_MAGIC, "", CONVERT, NULL}},
        {"segments/0/segment-header", {"a JPK file of force curves", NO_MAGIC, "", CURVES, NULL}},
        {"header.properties", {"a JPK file", NO_MAGIC, "", CONVERT, NULL}},
        {"xl/workbook.xml",
         {"an Excel table", NO_MAGIC, "", OTHER, "save the heights as text or CSV"}},
        {"index.xml", {"a Sensofar file (plux)", NO_MAGIC, "", CONVERT, NULL}},
    };
    static const known numpy = {
        "an archive of NumPy arrays (npz)", NO_MAGIC, "", OTHER,
        "save the heights alone: numpy.save(\"map.npy\", numpy.load(\"FILE\")[\"z\"])"};
    static const known other = {"a ZIP archive", NO_MAGIC, "", OTHER,
                                "unpack it first: unzip FILE"};
    if (file->size < 4 ||
        (memcmp(file->bytes, "PK\003\004", 4) != 0 && memcmp(file->bytes, "PK\005\006", 4) != 0)) {
        return NULL;
    }
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        if (holds(file, kinds[k].holds)) {
            return &kinds[k].format;
        }
    }
    size_t length = file->size >= 30 ? word_at(file, 26, 2, false) : 0; /* of the first name */
    bool array = length >= 4 && file->size >= 30 + length &&
                 memcmp(file->bytes + 26 + length, ".npy", 4) == 0;
    return array ? &numpy : &other;
}

/* A bitmap begins with two letters, as a text may; so its size, which follows them, is checked too.
 */
static bool is_bitmap(const haft_map_file *file) {
    return file->size >= 14 && memcmp(file->bytes, "BM", 2) == 0 &&
           word_at(file, 2, 4, false) == file->size;
}

static const known *named(const char *extension) {
    for (size_t k = 0; k < FORMATS; k++) {
        if (formats[k].extension[0] != '\0' && strcasecmp(formats[k].extension, extension) == 0) {
            return &formats[k];
        }
    }
    return NULL;
}

static const known *find(const haft_map_file *file) {
    for (size_t k = 0; k < FORMATS; k++) {
        const known *f = &formats[k];
        if (f->begins != NULL && file->size >= f->offset + f->length &&
            memcmp(file->bytes + f->offset, f->begins, f->length) == 0) {
            return f;
        }
    }
    const known *inside = find_tiff(file);
    inside = inside != NULL ? inside : find_zip(file);
    return inside != NULL    ? inside
           : is_igor(file)   ? named(".ibw")
           : is_bitmap(file) ? named(".bmp")
                             : NULL;
}

static const char *remedy_of(const known *format) {
    return format->advice == OTHER ? format->remedy : advices[format->advice];
}

bool haft_map_is_known(const haft_map_file *file) {
    return find(file) != NULL;
}

haft_status haft_map_refuse_known(haft_map **out, const haft_map_file *file, haft_error *error) {
    (void)out;
    const known *format = find(file);
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is %s; %s", file->path, format->name,
                          remedy_of(format));
}

haft_status haft_map_refuse_unknown(haft_map **out, const haft_map_file *file, haft_error *error) {
    (void)out;
    const char *dot = strrchr(file->path, '.');
    const known *format = dot != NULL ? named(dot) : NULL;
    if (format != NULL) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: by its name it would be %s, but it does not begin like one; if "
                              "it is one: %s",
                              file->path, format->name, remedy_of(format));
    }
    return haft_error_set(
        error, HAFT_ERROR_INPUT,
        "%s: is no height map that Haft knows: Nanoscope (binary), Gwyddion (gwy, "
        "gsf), HDF5, NumPy (npy), or text (a matrix, or columns x y z); "
        "Gwyddion reads many more, as does `haft-import FILE` where it is "
        "installed: save the heights as Gwyddion Simple Field (.gsf)",
        file->path);
}
