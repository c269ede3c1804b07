/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A height map as a two-dimensional HDF5 dataset, with the attributes `unit` (text) and `size`
 * (width and height, in metres). Such a file is from anywhere, and HDF5 crashes on some that are
 * damaged: a child process reads it and hands the matrix back. */
#include "child.h"
#include "hdf.h"
#include "map_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Objects that are looked at to find the map of a file. A file with more must be told which. */
enum { LINKS_MOST = 10000, SIDE_MOST = 32768 };

/* What the child hands back; rows x columns heights follow. */
typedef struct found_map {
    char name[256];
    size_t rows, columns;
    double unit, size[2]; /* 0: the file does not say */
} found_map;

/* ---- which dataset ---- */

/* Names of the two-dimensional datasets that a file holds. */
typedef struct finder {
    size_t file_bytes;
    char names[512];
    char first[256];
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
    /* One that is refused is named all the same, and what is wrong with it told when it is read. */
    bool refused = haft_hdf_inspect(&set, object, f->file_bytes) != NULL;
    if (set.rank != 2 && !(refused && set.rank == 0)) {
        return 0;
    }
    if (set.class == H5T_NO_CLASS && !refused) {
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

/* The only one there is. */
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
                           file->path, f->names);
    } else {
        memcpy(name, f->first, sizeof f->first);
    }
    haft_memory_free(f);
    return status;
}

/* The dataset of that name; if there is none, the message lists those there are. */
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
            haft_error_set(error, HAFT_ERROR_INPUT, "%s: has no dataset \"%s\"; it has: %s",
                           file->path, haft_map_quote(quoted, name, strlen(name)), f->names);
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

/* Metres of the text attribute `unit`, 0 if there is none; false if it is no length. */
static bool read_unit(hid_t set, double *unit) {
    char *text = NULL;
    haft_hdf_found found = haft_hdf_get_attribute(set, "unit", HAFT_HDF_TEXT, 1, &text);
    *unit = 0;
    bool good = found == HAFT_HDF_ABSENT ||
                (found == HAFT_HDF_FOUND && haft_map_length(1, text, unit) && *unit > 0);
    haft_memory_free(text);
    return good;
}

/* The attribute `size`; zeros if there is none. */
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
    const hsize_t *side = about.dims;
    if (about.class == H5T_NO_CLASS || about.rank != 2 || side[0] < 2 || side[1] < 2 ||
        side[0] > SIDE_MOST || side[1] > SIDE_MOST) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: \"%s\" is no matrix of numbers, 2 to %d a side", file->path,
                              name, SIDE_MOST);
    }
    map->rows = (size_t)side[0];
    map->columns = (size_t)side[1];
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

static haft_status read_set(const haft_map_file *file, hid_t set, const found_map *map,
                            void **bytes, size_t *size, haft_error *error) {
    size_t pixels = map->rows * map->columns;
    char name[48];
    haft_child_allow(4 * pixels * sizeof(double));
    *size = sizeof *map + pixels * sizeof(double);
    *bytes = haft_memory_alloc(*size, 1, error);
    if (*bytes == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    memcpy(*bytes, map, sizeof *map);
    if (H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                (char *)*bytes + sizeof *map) < 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: the pixels of \"%s\" cannot be read; the file is damaged",
                              file->path, haft_map_quote(name, map->name, strlen(map->name)));
    }
    return HAFT_OK;
}

/* In the child. */
static haft_status read_file(const void *context, void **bytes, size_t *size, haft_error *error) {
    const haft_map_file *file = context;
    found_map map = {.rows = 0};
    haft_status status = HAFT_OK;
    hid_t hdf = haft_hdf_open_image(file->bytes, file->size);
    if (hdf < 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: is an HDF5 file that cannot be opened; it is cut short or "
                              "damaged",
                              file->path);
    }
    if (file->options.channel[0] == '\0') {
        status = choose(map.name, file, hdf, error);
    } else {
        snprintf(map.name, sizeof map.name, "%.255s", file->options.channel);
    }
    hid_t set = status == HAFT_OK ? open_set(file, hdf, map.name, error) : -1;
    if (set >= 0) {
        status = check_set(&map, file, set, error);
        if (status == HAFT_OK) {
            status = read_set(file, set, &map, bytes, size, error);
        }
        H5Oclose(set);
    } else if (status == HAFT_OK) {
        status = HAFT_ERROR_INPUT;
    }
    H5Fclose(hdf);
    return status;
}

/* ---- in the parent ---- */

static haft_status take_map(haft_map **out, const haft_map_file *file, const void *bytes,
                            size_t size, haft_error *error) {
    const found_map *map = bytes;
    size_t pixels = (size - sizeof *map) / sizeof(double);
    if (size < sizeof *map || map->columns == 0 || map->rows != pixels / map->columns) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is damaged: its size does not add up",
                              file->path);
    }
    haft_status status = haft_map_from_matrix(
        out, file, map->rows, map->columns, map->size[0], map->size[1], map->unit,
        (const double *)(const void *)((const char *)bytes + sizeof *map), error);
    if (status == HAFT_OK) {
        haft_map_name((*out)->channel, map->name, strlen(map->name));
        snprintf((*out)->format, sizeof(*out)->format, "HDF5");
    }
    return status;
}

haft_status haft_map_read_hdf(haft_map **out, const haft_map_file *file, haft_error *error) {
    void *bytes = NULL;
    size_t size = 0;
    haft_child_input input = {
        .path = file->path, .remedy = "export the map anew", .bytes = file->size, .context = file};
    haft_hdf_voice voice = haft_hdf_hush();
    haft_status status = haft_child_run(&bytes, &size, read_file, &input, error);
    haft_hdf_unhush(voice);
    if (status == HAFT_OK) {
        status = take_map(out, file, bytes, size, error);
    }
    haft_memory_free(bytes);
    return status;
}
