/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 files that another program has open for writing, or did not close. HDF5 locks an open file,
 * and in its newest format marks both in the superblock. Both look like damage, but are not. */
#include "map_hdf.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

bool haft_map_hdf_is_locked(const haft_map_file *file) {
    int descriptor = open(file->path, O_RDONLY | O_CLOEXEC);
    bool locked = descriptor >= 0 && flock(descriptor, LOCK_SH | LOCK_NB) != 0 &&
                  (errno == EWOULDBLOCK || errno == EAGAIN);
    if (descriptor >= 0) {
        close(descriptor);
    }
    return locked;
}

/* Whether the superblock says that the file is open for writing: byte 20 of its versions 0 and 1,
 * byte 11 of 2 and 3. */
static bool is_marked_open(const haft_map_file *file) {
    for (size_t at = 0; at + 24 <= file->size; at = at == 0 ? 512 : 2 * at) {
        const char *block = file->bytes + at;
        if (memcmp(block, "\211HDF\r\n\032\n", 8) == 0) {
            return ((block[8] <= 1 ? block[20] : block[11]) & 5) != 0;
        }
    }
    return false;
}

haft_status haft_map_hdf_refuse(const haft_map_file *file, const char *what, haft_error *error) {
    if (haft_map_hdf_is_locked(file) || is_marked_open(file)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: is open for writing in another program, or was not closed "
                              "properly: %s; close it there, or mend a copy of it with h5clear -s",
                              file->path, what);
    }
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s: %s; it is cut short or damaged", file->path,
                          what);
}
