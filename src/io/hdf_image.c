/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Set-up of the library, and files that it reads from memory. So it sees exactly the bytes that
 * were checked, even if the file changes meanwhile, and takes no lock. The image is not copied. */
#include "hdf.h"

#include <stdint.h>
#include <stdio.h>

haft_hdf_voice haft_hdf_hush(void) {
    haft_hdf_voice voice = {.function = NULL};
    H5Eget_auto2(H5E_DEFAULT, &voice.function, &voice.data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    voice.plugins_known = H5PLget_loading_state(&voice.plugins) >= 0;
    H5PLset_loading_state(0);
    return voice;
}

void haft_hdf_unhush(haft_hdf_voice voice) {
    H5Eset_auto2(H5E_DEFAULT, voice.function, voice.data);
    if (voice.plugins_known) {
        H5PLset_loading_state(voice.plugins);
    }
}

/* ---- an image that HDF5 neither copies nor frees ---- */

typedef struct image {
    const void *bytes;
    size_t size;
} image;

static void *lend(size_t size, H5FD_file_image_op_t operation, void *user) {
    (void)operation;
    const image *i = user;
    return size == i->size ? (void *)(uintptr_t)i->bytes : NULL;
}

static void *keep(void *to, const void *from, size_t size, H5FD_file_image_op_t operation,
                  void *user) {
    (void)size;
    (void)operation;
    (void)user;
    return to == from ? to : NULL;
}

static void *never_resize(void *bytes, size_t size, H5FD_file_image_op_t operation, void *user) {
    (void)bytes;
    (void)size;
    (void)operation;
    (void)user;
    return NULL;
}

static herr_t take_back(void *bytes, H5FD_file_image_op_t operation, void *user) {
    (void)bytes;
    (void)operation;
    (void)user;
    return 0;
}

static void *copy_image(void *user) {
    image *copy = haft_memory_alloc(1, sizeof *copy, NULL);
    if (copy != NULL) {
        *copy = *(const image *)user;
    }
    return copy;
}

static herr_t free_image(void *user) {
    haft_memory_free(user);
    return 0;
}

hid_t haft_hdf_open_image(const void *bytes, size_t size) {
    image own = {bytes, size};
    H5FD_file_image_callbacks_t callbacks = {lend,       keep,       never_resize, take_back,
                                             copy_image, free_image, &own};
    /* The name must not be a file's, and must differ between open images. */
    char name[64];
    snprintf(name, sizeof name, "/dev/null/%p", bytes);
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), file = -1;
    if (access >= 0 && size > 0 && H5Pset_fapl_core(access, 1 << 20, 0) >= 0 &&
        H5Pset_file_image_callbacks(access, &callbacks) >= 0 &&
        H5Pset_file_image(access, (void *)(uintptr_t)bytes, size) >= 0 &&
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0) {
        file = H5Fopen(name, H5F_ACC_RDONLY, access);
    }
    if (access >= 0) {
        H5Pclose(access);
    }
    return file;
}

hid_t haft_hdf_native_type(haft_hdf_type type) {
    return type == HAFT_HDF_REAL  ? H5T_NATIVE_DOUBLE
           : type == HAFT_HDF_INT ? H5T_NATIVE_INT
                                  : H5T_NATIVE_UCHAR;
}
