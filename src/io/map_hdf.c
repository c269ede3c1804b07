/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A height map as an HDF5 dataset of two dimensions, not counting those of length 1, with the
 * attributes `unit` (or NetCDF's `units`, text) and `size` (width and height, in metres), and
 * NetCDF's attributes for packing and missing values. Such a file may come from anywhere, and HDF5
 * crashes on some damaged ones: a child process reads it and returns the matrix. */
#include "map_hdf.h"
#include "child.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Objects that are searched for the map of a file. For a file with more, the user must name it. */
enum { LINKS_MOST = 10000, SIDE_MOST = 32768 };

/* The result of the child; rows x columns heights follow. */
typedef struct found_map {
    char name[256];
    size_t rows, columns, masked;
    double unit, size[2]; /* 0: the file does not say */
    haft_map_packing packing;
} found_map;

/* ---- which dataset ---- */

/* Finds the two sides of a dataset whose other dimensions have length 1. */
static bool find_sides(const haft_hdf_set *about, hsize_t side[2]) {
    int n = 0;
    for (int i = 0; i < about->rank; i++) {
        if (about->dims[i] != 1 && n++ < 2) {
            side[n - 1] = about->dims[i];
        }
    }
    return n == 2;
}

/* Says why an undamaged dataset is not a map. */
static void say_what_it_is(char what[160], hid_t set, const haft_hdf_set *about) {
    hid_t type = H5Dget_type(set);
    H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    if (type >= 0) {
        H5Tclose(type);
    }
    if (class == H5T_COMPOUND) {
        snprintf(what, 160, "is of compound numbers, as complex ones are; store the heights alone");
    } else if (class == H5T_STRING) {
        snprintf(what, 160, "holds texts, no numbers");
    } else if (about->class == H5T_NO_CLASS) {
        snprintf(what, 160, "is of a type that is no number");
    } else {
        size_t used = (size_t)snprintf(what, 160, "has the shape ");
        for (int i = 0; i < about->rank && used < 100; i++) {
            used += (size_t)snprintf(what + used, 160 - used, "%s%llu", i > 0 ? " x " : "",
                                     (unsigned long long)about->dims[i]);
        }
        snprintf(what + used, 160 - used, "%s; a map has two sides, of 2 to %d pixels",
                 about->rank == 0 ? "of one number" : "", SIDE_MOST);
    }
}

/* The search for the two-dimensional datasets of a file. */
typedef struct finder {
    size_t file_bytes;
    char names[512];
    char first[256];
    char other[256]; /* the first that is not a map, and why */
    haddr_t seen[LINKS_MOST];
    size_t found;
    const char *incomplete; /* why not all were found */
} finder;

static herr_t visit(void *user, const char *path, hid_t object, H5I_type_t kind, haddr_t address) {
    finder *f = user;
    haft_hdf_set set;
    if (kind != H5I_DATASET) {
        return 0;
    }
    /* A rejected dataset is listed too; the error is reported when it is read. */
    bool refused = haft_hdf_inspect(&set, object, f->file_bytes) != NULL;
    hsize_t side[2];
    bool map = set.class != H5T_NO_CLASS && find_sides(&set, side);
    if (!map && !(refused && set.rank == 0)) {
        char what[160], quoted[48];
        say_what_it_is(what, object, &set);
        if (f->other[0] == '\0') {
            snprintf(f->other, sizeof f->other, "; \"%s\" %s",
                     haft_map_quote(quoted, path + 1, strlen(path + 1)), what);
        }
        return 0;
    }
    for (size_t i = 0; i < f->found; i++) {
        if (f->seen[i] == address) {
            return 0;
        }
    }
    char quoted[48];
    size_t used = strlen(f->names);
    snprintf(f->names + used, sizeof f->names - used, "%s%s", used > 0 ? ", " : "",
             haft_map_quote(quoted, path + 1, strlen(path + 1)));
    if (f->found == 0) {
        snprintf(f->first, sizeof f->first, "%.255s", path + 1);
    }
    f->seen[f->found++] = address;
    return 0;
}

static finder *find(const haft_map_file *file, hid_t hdf, haft_error *error) {
    finder *f = haft_memory_alloc(1, sizeof *f, error);
    if (f != NULL) {
        f->file_bytes = file->size;
        f->incomplete = haft_hdf_walk(hdf, HAFT_HDF_DEPTH_MOST, LINKS_MOST, visit, f);
    }
    return f;
}

/* Chooses the only map in the file. */
static haft_status choose(char name[256], const haft_map_file *file, hid_t hdf, haft_error *error) {
    finder *f = find(file, hdf, error);
    if (f == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = HAFT_OK;
    if (f->incomplete != NULL) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: holds %s to look for the map (at most %d links, %d deep); "
                                "name its dataset as the channel, or copy it into a file of its "
                                "own",
                                file->path, f->incomplete, LINKS_MOST, HAFT_HDF_DEPTH_MOST);
    } else if (f->found != 1) {
        status =
            haft_error_set(error, HAFT_ERROR_INPUT,
                           f->found == 0 ? "%s: holds no two-dimensional dataset of numbers%s"
                                         : "%s: holds several maps; name one as the channel: %s",
                           file->path, f->found == 0 ? f->other : f->names);
    } else {
        memcpy(name, f->first, sizeof f->first);
    }
    haft_memory_free(f);
    return status;
}

/* Opens the dataset of a name; if there is none, the message lists the names in the file. */
static hid_t open_set(const haft_map_file *file, hid_t hdf, const char *name, haft_error *error) {
    char quoted[48];
    const char *reason = NULL;
    hid_t set = haft_hdf_enter(hdf, name, &reason);
    if (set >= 0 && H5Iget_type(set) == H5I_DATASET) {
        return set;
    }
    if (set >= 0 || reason == haft_hdf_missing) {
        finder *f = find(file, hdf, error);
        if (f != NULL) {
            haft_error_set(error, HAFT_ERROR_INPUT, "%s: has no dataset \"%s\"%s%s", file->path,
                           haft_map_quote(quoted, name, strlen(name)),
                           f->found > 0 ? "; it has: " : ", and no other map", f->names);
        }
        haft_memory_free(f);
    } else {
        haft_error_set(error, HAFT_ERROR_INPUT, "%s: \"%s\" %s", file->path,
                       haft_map_quote(quoted, name, strlen(name)), reason);
    }
    if (set >= 0) {
        H5Oclose(set);
    }
    return -1;
}

/* ---- its contents ---- */

/* Reads the text attribute `unit`, or NetCDF's `units`, in metres; 0 if there is neither. False if
 * it is not a length. */
static bool read_unit(hid_t set, double *unit) {
    static const char *const names[] = {"unit", "units"};
    haft_hdf_found found = HAFT_HDF_ABSENT;
    *unit = 0;
    for (int k = 0; k < 2 && found == HAFT_HDF_ABSENT; k++) {
        char *text = NULL;
        found = haft_hdf_get_attribute(set, names[k], HAFT_HDF_TEXT, 1, &text);
        if (found == HAFT_HDF_FOUND && !haft_map_length(1, text, unit)) {
            found = HAFT_HDF_FOREIGN;
        }
        haft_memory_free(text);
    }
    return found == HAFT_HDF_ABSENT || (found == HAFT_HDF_FOUND && *unit > 0);
}

/* Reads the attribute `size`; zeros if there is none. */
static bool read_size(hid_t set, double size[2]) {
    size[0] = size[1] = 0;
    haft_hdf_found found = haft_hdf_get_attribute(set, "size", HAFT_HDF_REALS, 2, size);
    return found == HAFT_HDF_ABSENT ||
           (found == HAFT_HDF_FOUND && size[0] > 0 && size[1] > 0 && isfinite(size[0] + size[1]));
}

static haft_status check_set(found_map *map, const haft_map_file *file, hid_t set,
                             haft_error *error) {
    char name[48];
    haft_map_quote(name, map->name, strlen(map->name));
    haft_hdf_set about;
    const char *reason = haft_hdf_inspect(&about, set, file->size);
    if (reason != NULL) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: the dataset \"%s\" %s", file->path,
                              name, reason);
    }
    hsize_t side[2];
    if (about.class == H5T_NO_CLASS || !find_sides(&about, side) || side[0] < 2 || side[1] < 2 ||
        side[0] > SIDE_MOST || side[1] > SIDE_MOST) {
        char what[160];
        say_what_it_is(what, set, &about);
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: \"%s\" is no matrix of numbers: it %s",
                              file->path, name, what);
    }
    map->rows = (size_t)side[0];
    map->columns = (size_t)side[1];
    reason = haft_map_packing_read(&map->packing, set, &about);
    if (reason != NULL) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: \"%s\" has an attribute `%s` that is not as NetCDF has it: a "
                              "number (scale_factor not 0, valid_range two numbers that rise)",
                              file->path, name, reason);
    }
    if (!read_unit(set, &map->unit)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: \"%s\" has an attribute `unit` that is not one text naming a "
                              "length, as nm",
                              file->path, name);
    }
    if (!read_size(set, map->size)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: \"%s\" has an attribute `size` that is not two lengths in "
                              "metres, width and height",
                              file->path, name);
    }
    return HAFT_OK;
}

static haft_status read_set(const haft_map_file *file, hid_t set, found_map *map, void **bytes,
                            size_t *size, haft_error *error) {
    size_t pixels = map->rows * map->columns;
    char name[48];
    haft_child_allow(4 * pixels * sizeof(double));
    *size = sizeof *map + pixels * sizeof(double);
    *bytes = haft_memory_alloc(*size, 1, error);
    if (*bytes == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    double *number = (double *)(void *)((char *)*bytes + sizeof *map);
    if (H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, number) < 0) {
        char what[96];
        snprintf(what, sizeof what, "the pixels of \"%s\" cannot be read",
                 haft_map_quote(name, map->name, strlen(map->name)));
        return haft_map_hdf_refuse(file, what, error);
    }
    map->masked = haft_map_packing_mask(&map->packing, number, pixels);
    memcpy(*bytes, map, sizeof *map);
    return HAFT_OK;
}

/* Runs in the child. */
static haft_status read_file(const void *context, void **bytes, size_t *size, haft_error *error) {
    const haft_map_file *file = context;
    found_map map = {.rows = 0};
    haft_status status = HAFT_OK;
    hid_t hdf = haft_hdf_open_image(file->bytes, file->size);
    if (hdf < 0) {
        return haft_map_hdf_refuse(file, "HDF5 cannot open it", error);
    }
    if (file->options.channel[0] == '\0') {
        status = choose(map.name, file, hdf, error);
    } else {
        snprintf(map.name, sizeof map.name, "%.255s", file->options.channel);
    }
    hid_t set = status == HAFT_OK ? open_set(file, hdf, map.name, error) : -1;
    if (set >= 0) {
        status = check_set(&map, file, set, error);
        HAFT_THEN(status, read_set(file, set, &map, bytes, size, error));
        H5Oclose(set);
    } else if (status == HAFT_OK) {
        status = HAFT_ERROR_INPUT;
    }
    H5Fclose(hdf);
    return status;
}

/* ---- in the parent ---- */

/* Converts the numbers to heights. Undeclared fill values are searched before that, in the numbers
 * as they are in the file. */
static haft_status unpack(haft_map **out, const haft_map_file *file, const haft_map_packing *p,
                          haft_error *error) {
    haft_map *map = *out;
    if (p->scale == 1 && p->offset == 0) {
        return HAFT_OK;
    }
    haft_status status = haft_map_check_marks(map, file, 0, error);
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        map->z[i] = p->scale * map->z[i] + p->offset;
    }
    if (status != HAFT_OK) {
        haft_map_destroy(out);
    }
    return status;
}

static void add_remarks(haft_map *map, const haft_map_file *file, const found_map *found) {
    const haft_map_packing *p = &found->packing;
    if (p->scale != 1 || p->offset != 0) {
        haft_map_remark(map,
                        "a height is %.6g times the number stored plus %.6g, by scale_factor "
                        "and add_offset",
                        p->scale, p->offset);
    }
    if (found->masked > 0) {
        haft_map_remark(map,
                        "%zu pixels are missing by its _FillValue, missing_value or valid range",
                        found->masked);
    }
    if (haft_map_hdf_is_locked(file)) {
        haft_map_remark(map, "the file is open for writing in another program: what that has not "
                             "yet written is not read");
    }
}

static haft_status take_map(haft_map **out, const haft_map_file *file, const void *bytes,
                            size_t size, haft_error *error) {
    const found_map *map = bytes;
    size_t pixels = (size - sizeof *map) / sizeof(double);
    if (size < sizeof *map || map->columns == 0 || map->rows != pixels / map->columns) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is damaged: its size does not add up",
                              file->path);
    }
    double unit = map->unit;
    haft_status status = haft_map_begin(out, file, map->rows, map->columns, map->size[0],
                                        map->size[1], &unit, error);
    if (status == HAFT_OK) {
        memcpy((*out)->z, (const char *)bytes + sizeof *map, pixels * sizeof(double));
        status = unpack(out, file, &map->packing, error);
    }
    HAFT_THEN(status, haft_map_end(out, file, unit, error));
    if (status == HAFT_OK) {
        haft_map_name((*out)->channel, map->name, strlen(map->name));
        snprintf((*out)->format, sizeof(*out)->format, "HDF5");
        add_remarks(*out, file, map);
    }
    return status;
}

haft_status haft_map_read_hdf(haft_map **out, const haft_map_file *file, haft_error *error) {
    void *bytes = NULL;
    size_t size = 0;
    haft_child_input input = {
        .path = file->path, .remedy = "export the map anew", .bytes = file->size, .context = file};
    if (haft_map_hdf_is_locked(file)) {
        input.remedy = "it is open for writing in another program; close it there";
    }
    haft_hdf_voice voice = haft_hdf_hush();
    haft_status status = haft_child_run(&bytes, &size, read_file, &input, error);
    haft_hdf_unhush(voice);
    HAFT_THEN(status, take_map(out, file, bytes, size, error));
    haft_memory_free(bytes);
    return status;
}
