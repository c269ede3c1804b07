/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a channel as a Gwyddion Simple Field: a magic line; lines "name = value"; one to four zero
 * bytes, so that the data begin at a multiple of four; then little-endian 32-bit numbers, row by
 * row. */
#include "import.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PIXELS_MOST = 1 << 29 };

/* What 32-bit numbers may round off, relative to the range of the heights. */
static const double ROUNDING = 1e-5;

typedef struct heights {
    size_t n;
    double *z; /* NAN where missing */
} heights;

static heights take_heights(const import_channel *c, bool mask_missing) {
    const double *z = gwy_data_field_get_data_const(c->field);
    const double *mask =
        mask_missing && c->mask != NULL ? gwy_data_field_get_data_const(c->mask) : NULL;
    heights h = {.n = (size_t)gwy_data_field_get_xres(c->field) *
                      (size_t)gwy_data_field_get_yres(c->field)};
    h.z = g_new(double, h.n);
    for (size_t i = 0; i < h.n; i++) {
        h.z[i] = mask != NULL && mask[i] > 0 ? (double)NAN : z[i];
    }
    return h;
}

/* Subtracts the mean of heights that lie far from zero, since 32-bit numbers would lose their
 * roughness. Haft subtracts the mean anyway. @return what was subtracted; 0: nothing */
static double take_offset(heights *h) {
    double least = INFINITY, greatest = -INFINITY, sum = 0, count = 0;
    for (size_t i = 0; i < h->n; i++) {
        if (isfinite(h->z[i])) {
            least = fmin(least, h->z[i]);
            greatest = fmax(greatest, h->z[i]);
            sum += h->z[i];
            count++;
        }
    }
    double largest = fmax(fabs(least), fabs(greatest));
    if (count == 0 || !(greatest > least) || ldexp(largest, -24) <= ROUNDING * (greatest - least)) {
        return 0;
    }
    for (size_t i = 0; i < h->n; i++) {
        h->z[i] -= sum / count;
    }
    return sum / count;
}

static GByteArray *make_bytes(const import_channel *c, const heights *h) {
    char width[G_ASCII_DTOSTR_BUF_SIZE], height[G_ASCII_DTOSTR_BUF_SIZE];
    g_ascii_dtostr(width, sizeof width, gwy_data_field_get_xreal(c->field));
    g_ascii_dtostr(height, sizeof height, gwy_data_field_get_yreal(c->field));
    GString *header = g_string_new("Gwyddion Simple Field 1.0\n");
    g_string_append_printf(header, "XRes = %d\nYRes = %d\nXReal = %s\nYReal = %s\n",
                           gwy_data_field_get_xres(c->field), gwy_data_field_get_yres(c->field),
                           width, height);
    if (c->lateral[0] != '\0') {
        g_string_append_printf(header, "XYUnits = %s\n", c->lateral);
    }
    if (c->unit[0] != '\0') {
        g_string_append_printf(header, "ZUnits = %s\n", c->unit);
    }
    g_string_append_printf(header, "Title = %s\n", c->title);
    size_t zeros = 4 - header->len % 4;
    GByteArray *bytes = g_byte_array_sized_new((guint)(header->len + zeros + 4 * h->n));
    g_byte_array_append(bytes, (const guint8 *)header->str, (guint)header->len);
    g_byte_array_append(bytes, (const guint8 *)"\0\0\0\0", (guint)zeros);
    g_string_free(header, TRUE);
    for (size_t i = 0; i < h->n; i++) {
        float value = (float)h->z[i];
        guint32 word;
        memcpy(&word, &value, sizeof word);
        word = GUINT32_TO_LE(word);
        g_byte_array_append(bytes, (const guint8 *)&word, 4);
    }
    return bytes;
}

/* @return false with errno set */
static bool write_all(int descriptor, const GByteArray *bytes) {
    for (size_t done = 0; done < bytes->len;) {
        ssize_t n = write(descriptor, bytes->data + done, bytes->len - done);
        if (n < 0 && errno != EINTR) {
            return false;
        }
        done += n > 0 ? (size_t)n : 0;
    }
    return fsync(descriptor) == 0 || errno == EINVAL;
}

/* Writes under a temporary name, and renames the file when it is complete. */
static int put(const char *path, const GByteArray *bytes) {
    char *temporary = g_strdup_printf("%s.tmp.%ld", path, (long)getpid());
    int descriptor = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    bool good = descriptor >= 0 && write_all(descriptor, bytes);
    int why = errno;
    if (descriptor >= 0 && close(descriptor) != 0 && good) {
        why = errno;
        good = false;
    }
    if (good && rename(temporary, path) != 0) {
        why = errno;
        good = false;
    }
    if (!good) {
        if (descriptor >= 0) {
            unlink(temporary);
        }
        import_complain("%s: cannot be written: %s", path, g_strerror(why));
    }
    g_free(temporary);
    return good ? IMPORT_OK : IMPORT_IO;
}

int import_write(const import_channel *channel, bool mask_missing, const char *path, bool force) {
    struct stat facts;
    if (stat(path, &facts) == 0) {
        if (!S_ISREG(facts.st_mode)) {
            import_complain("%s: is no regular file, and is not replaced", path);
            return IMPORT_IO;
        }
        if (!force) {
            import_complain("%s is there already; add --force to replace it", path);
            return IMPORT_EXISTS;
        }
    }
    gint64 pixels =
        (gint64)gwy_data_field_get_xres(channel->field) * gwy_data_field_get_yres(channel->field);
    if (pixels > PIXELS_MOST) {
        import_complain("channel \"%s\" has more than 2^29 pixels; cut it in Gwyddion",
                        channel->title);
        return IMPORT_INPUT;
    }
    heights h = take_heights(channel, mask_missing);
    double offset = take_offset(&h);
    if (offset != 0) {
        import_complain("heights are counted from their mean, %g %s: so far from zero, 32-bit "
                        "numbers would round them",
                        offset, channel->unit);
    }
    GByteArray *bytes = make_bytes(channel, &h);
    int code = put(path, bytes);
    g_byte_array_free(bytes, TRUE);
    g_free(h.z);
    return code;
}
