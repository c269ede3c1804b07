/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits on what a file can make the library do. Only hard links are followed; only data inside the
 * file are read, only through HDF5's own filters, and only as much as the file can hold. One
 * function reads all attributes: it checks class, number of points and length before it copies a
 * byte. */
#include "hdf.h"

#include <stdio.h>
#include <string.h>

/* Largest size of an attribute, and of a chunk, which HDF5 reads whole. */
static const size_t ATTRIBUTE_MOST = (size_t)1 << 20, CHUNK_MOST = (size_t)1 << 28;
enum { NUMBER_MOST = 16 }; /* largest size of a number in a file */

/* ---- links ---- */

const char haft_hdf_missing[] = "is not there";

/* Opens a member of `group`; gives a reason if there is none. */
static hid_t step_down(hid_t group, const char *name, const char **reason) {
    H5L_info_t link;
    if (H5Lget_info(group, name, &link, H5P_DEFAULT) < 0) {
        *reason = haft_hdf_missing;
        return -1;
    }
    if (link.type != H5L_TYPE_HARD) {
        *reason =
            link.type == H5L_TYPE_EXTERNAL
                ? "is behind an external link, out of the file; put the data themselves there"
                : "is behind a soft link, which is not followed; put the data themselves there";
        return -1;
    }
    hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    *reason = object < 0 ? "cannot be opened; the file is damaged" : NULL;
    return object;
}

hid_t haft_hdf_enter(hid_t file, const char *path, const char **reason) {
    char name[256];
    hid_t at = H5Oopen(file, "/", H5P_DEFAULT);
    *reason = at < 0 ? "cannot be opened; the file is damaged" : NULL;
    for (const char *p = path + strspn(path, "/"); at >= 0 && *p != '\0'; p += strspn(p, "/")) {
        size_t n = strcspn(p, "/");
        hid_t next = -1;
        if (n >= sizeof name || H5Iget_type(at) != H5I_GROUP) {
            *reason = haft_hdf_missing;
        } else {
            memcpy(name, p, n);
            name[n] = '\0';
            next = step_down(at, name, reason);
        }
        H5Oclose(at);
        at = next;
        p += n;
    }
    return at;
}

/* ---- a bounded walk over all objects that hard links reach ---- */

typedef struct walk {
    haft_hdf_visit *visit;
    void *user;
    size_t links, links_most;
    int depth, depth_most;
    haddr_t above[HAFT_HDF_DEPTH_MOST + 1]; /* the groups that contain the object, from the root */
    char path[1024];
    const char *reason;
} walk;

/* Whether a link leads back to a group that contains it; following it would never end. */
static bool leads_back(const walk *w, haddr_t address) {
    for (int i = 0; i <= w->depth; i++) {
        if (w->above[i] == address) {
            return true;
        }
    }
    return false;
}

static herr_t step(hid_t group, const char *name, const H5L_info_t *link, void *user) {
    walk *w = user;
    size_t used = strlen(w->path), n = strlen(name);
    if (++w->links > w->links_most) {
        w->reason = "too many objects";
        return -1;
    }
    if (link->type != H5L_TYPE_HARD || leads_back(w, link->u.address)) {
        return 0;
    }
    if (w->depth >= w->depth_most || used + n + 2 > sizeof w->path) {
        w->reason = "groups nested too deep";
        return -1;
    }
    hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    if (object < 0) {
        return 0; /* damaged: a reader that needs it reports it as missing */
    }
    memcpy(w->path + used, "/", 1);
    memcpy(w->path + used + 1, name, n + 1);
    H5I_type_t kind = H5Iget_type(object);
    herr_t status = w->visit(w->user, w->path, object, kind, link->u.address);
    if (status >= 0 && kind == H5I_GROUP) {
        w->above[++w->depth] = link->u.address;
        status = H5Literate(object, H5_INDEX_NAME, H5_ITER_NATIVE, NULL, step, w);
        w->depth--;
    }
    w->path[used] = '\0';
    H5Oclose(object);
    return status < 0 ? -1 : 0;
}

const char *haft_hdf_walk(hid_t file, int depth_most, size_t links_most, haft_hdf_visit *visit,
                          void *user) {
    depth_most = depth_most < HAFT_HDF_DEPTH_MOST ? depth_most : HAFT_HDF_DEPTH_MOST;
    walk w = {.visit = visit, .user = user, .links_most = links_most, .depth_most = depth_most};
    H5O_info_t root; /* only basic information: the rest crashes on damaged headers */
    w.above[0] = H5Oget_info2(file, &root, H5O_INFO_BASIC) >= 0 ? root.addr : HADDR_UNDEF;
    herr_t status = H5Literate(file, H5_INDEX_NAME, H5_ITER_NATIVE, NULL, step, &w);
    return status >= 0 || w.reason != NULL ? w.reason : "groups that cannot be read";
}

/* ---- datasets ---- */

static const char *check_filters(hid_t creation) {
    int filters = H5Pget_nfilters(creation);
    for (int i = 0; i < filters; i++) {
        unsigned flags = 0, setting = 0;
        size_t count = 0;
        H5Z_filter_t id =
            H5Pget_filter2(creation, (unsigned)i, &flags, &count, NULL, 0, NULL, &setting);
        if (id < H5Z_FILTER_DEFLATE || id > H5Z_FILTER_SCALEOFFSET) {
            return "is packed by a filter that is no part of HDF5 itself; unpack it with h5repack "
                   "-f NONE";
        }
    }
    return NULL;
}

/* The product of extents and a size; SIZE_MAX if it overflows. */
static size_t volume(int rank, const hsize_t *dims, size_t size) {
    size_t bytes = size;
    for (int i = 0; i < rank; i++) {
        if (dims[i] > SIZE_MAX || __builtin_mul_overflow(bytes, (size_t)dims[i], &bytes)) {
            return SIZE_MAX;
        }
    }
    return bytes;
}

/* Compressed data may be at most 1032 times as large as the file (deflate), other data no larger
 * than the file. A dataset without storage could claim any size. */
static const char *check_size(hid_t creation, const haft_hdf_set *set, size_t file_bytes) {
    size_t most = file_bytes;
    if (H5Pget_layout(creation) == H5D_CHUNKED) {
        hsize_t chunk[H5S_MAX_RANK];
        int rank = H5Pget_chunk(creation, H5S_MAX_RANK, chunk);
        size_t bytes = rank < 0 ? SIZE_MAX : volume(rank, chunk, set->type_bytes);
        if (bytes > CHUNK_MOST && bytes > volume(set->rank, set->dims, set->type_bytes)) {
            return "has chunks larger than 256 MiB and than itself";
        }
        most = __builtin_mul_overflow(file_bytes, 1032, &most) ? SIZE_MAX - 1 : most;
    }
    return volume(set->rank, set->dims, set->type_bytes) > most
               ? "is of a size that the file cannot hold"
               : NULL;
}

/* To be called before the dataspace is queried: for a virtual dataset the query opens other files.
 */
static const char *check_storage(hid_t creation) {
    if (creation < 0) {
        return "cannot be opened; the file is damaged";
    }
    H5D_layout_t layout = H5Pget_layout(creation);
    if (layout == H5D_VIRTUAL) {
        return "is a virtual dataset, whose data lie in other files; copy them into this one with "
               "h5repack -l CONTI";
    }
    if (layout != H5D_COMPACT && layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED) {
        return "is stored in an unknown way";
    }
    return H5Pget_external_count(creation) != 0
               ? "lies in external storage, out of the file; copy it into the file with h5repack"
               : check_filters(creation);
}

static void measure(hid_t dataset, haft_hdf_set *set) {
    hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    bool simple = space >= 0 && H5Sget_simple_extent_type(space) == H5S_SIMPLE;
    set->rank = simple ? H5Sget_simple_extent_ndims(space) : 0;
    if (set->rank < 0 || (simple && H5Sget_simple_extent_dims(space, set->dims, NULL) < 0)) {
        set->rank = 0;
    }
    set->class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    set->type_bytes = type >= 0 ? H5Tget_size(type) : 0;
    if (space >= 0) {
        H5Sclose(space);
    }
    if (type >= 0) {
        H5Tclose(type);
    }
}

const char *haft_hdf_inspect(haft_hdf_set *set, hid_t dataset, size_t file_bytes) {
    *set = (haft_hdf_set){.class = H5T_NO_CLASS};
    hid_t creation = H5Iget_type(dataset) == H5I_DATASET ? H5Dget_create_plist(dataset) : -1;
    const char *reason = check_storage(creation);
    if (reason == NULL) {
        measure(dataset, set);
        bool number = set->class == H5T_FLOAT || set->class == H5T_INTEGER;
        if (!number || set->type_bytes == 0 || set->type_bytes > NUMBER_MOST) {
            set->class = H5T_NO_CLASS; /* a reader that needs it says which type is expected */
        } else {
            reason = check_size(creation, set, file_bytes);
        }
    }
    if (creation >= 0) {
        H5Pclose(creation);
    }
    return reason;
}

/* ---- attributes ---- */

/* Reads text of fixed length, which may lack a final 0. */
static haft_hdf_found read_fixed_text(hid_t attribute, hid_t type, char **text) {
    size_t size = H5Tget_size(type);
    if (size == 0 || size > ATTRIBUTE_MOST) {
        return HAFT_HDF_FOREIGN;
    }
    *text = haft_memory_alloc(size + 1, 1, NULL);
    if (*text == NULL) {
        return HAFT_HDF_NO_MEMORY;
    }
    return H5Aread(attribute, type, *text) < 0 ? HAFT_HDF_UNREADABLE : HAFT_HDF_FOUND;
}

static haft_hdf_found read_variable_text(hid_t attribute, hid_t type, char **text) {
    char *variable = NULL;
    haft_hdf_found found = HAFT_HDF_UNREADABLE;
    hid_t memory = H5Tcopy(H5T_C_S1);
    if (H5Tset_size(memory, H5T_VARIABLE) >= 0 && H5Tset_cset(memory, H5Tget_cset(type)) >= 0 &&
        H5Aread(attribute, memory, &variable) >= 0 && variable != NULL) {
        size_t size = strnlen(variable, ATTRIBUTE_MOST + 1);
        found = HAFT_HDF_FOREIGN;
        if (size <= ATTRIBUTE_MOST) {
            *text = haft_memory_alloc(size + 1, 1, NULL);
            found = *text == NULL ? HAFT_HDF_NO_MEMORY : HAFT_HDF_FOUND;
        }
        if (*text != NULL) {
            memcpy(*text, variable, size);
        }
    }
    H5free_memory(variable);
    H5Tclose(memory);
    return found;
}

static haft_hdf_found read_text(hid_t attribute, hid_t type, char **text) {
    *text = NULL;
    haft_hdf_found found = H5Tis_variable_str(type) > 0 ? read_variable_text(attribute, type, text)
                                                        : read_fixed_text(attribute, type, text);
    if (found != HAFT_HDF_FOUND) {
        haft_memory_free(*text);
        *text = NULL;
    }
    return found;
}

static haft_hdf_found read_value(hid_t attribute, hid_t type, haft_hdf_kind kind, void *value) {
    H5T_class_t class = H5Tget_class(type);
    if (kind == HAFT_HDF_TEXT) {
        return class == H5T_STRING ? read_text(attribute, type, value) : HAFT_HDF_FOREIGN;
    }
    bool number = class == H5T_INTEGER || (kind == HAFT_HDF_REALS && class == H5T_FLOAT);
    if (!number || H5Tget_size(type) > NUMBER_MOST) {
        return HAFT_HDF_FOREIGN;
    }
    hid_t wanted = kind == HAFT_HDF_REALS ? H5T_NATIVE_DOUBLE : H5T_NATIVE_UINT64;
    return H5Aread(attribute, wanted, value) < 0 ? HAFT_HDF_UNREADABLE : HAFT_HDF_FOUND;
}

haft_hdf_found haft_hdf_get_attribute(hid_t object, const char *name, haft_hdf_kind kind,
                                      size_t points, void *value) {
    htri_t there = H5Aexists(object, name);
    if (there == 0) {
        return HAFT_HDF_ABSENT;
    }
    hid_t attribute = there > 0 ? H5Aopen(object, name, H5P_DEFAULT) : -1;
    hid_t type = attribute >= 0 ? H5Aget_type(attribute) : -1;
    hid_t space = attribute >= 0 ? H5Aget_space(attribute) : -1;
    haft_hdf_found found = HAFT_HDF_UNREADABLE;
    if (type >= 0 && space >= 0) {
        found = H5Sget_simple_extent_npoints(space) == (hssize_t)points
                    ? read_value(attribute, type, kind, value)
                    : HAFT_HDF_FOREIGN;
    }
    if (space >= 0) {
        H5Sclose(space);
    }
    if (type >= 0) {
        H5Tclose(type);
    }
    if (attribute >= 0) {
        H5Aclose(attribute);
    }
    return found;
}
