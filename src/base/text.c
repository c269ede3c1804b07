/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes text from files and users safe to print. A name may contain escape sequences that control a
 * terminal, line breaks that forge a second message, or direction marks that hide its end. */
#include "haft/base.h"

#include <stdio.h>
#include <string.h>

size_t haft_text_character(const char *text, size_t size, uint32_t *code) {
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *at = (const unsigned char *)text;
    size_t n = size == 0      ? 0
               : at[0] < 0x80 ? 1
               : at[0] < 0xc2 ? 0
               : at[0] < 0xe0 ? 2
               : at[0] < 0xf0 ? 3
               : at[0] < 0xf5 ? 4
                              : 0;
    if (n == 0 || n > size) {
        return 0;
    }
    uint32_t value = n == 1 ? at[0] : at[0] & (0x7fu >> n);
    for (size_t i = 1; i < n; i++) {
        if ((at[i] & 0xc0) != 0x80) {
            return 0;
        }
        value = value << 6 | (at[i] & 0x3fu);
    }
    if (value < least[n] || value > 0x10ffff || (value >= 0xd800 && value < 0xe000)) {
        return 0;
    }
    *code = value;
    return n;
}

size_t haft_text_blank(const char *text) {
    const unsigned char *t = (const unsigned char *)text;
    if (*t == ' ' || *t == '\t') {
        return 1;
    }
    if (t[0] == 0xc2 && t[1] == 0xa0) { /* no-break */
        return 2;
    }
    if (t[0] == 0xe2 && t[1] == 0x80) { /* U+2000 to U+200B, U+202F */
        return (t[2] >= 0x80 && t[2] <= 0x8b) || t[2] == 0xaf ? 3 : 0;
    }
    bool wide = (t[0] == 0xe2 && t[1] == 0x81 && (t[2] == 0x9f || t[2] == 0xa0)) ||
                (t[0] == 0xe3 && t[1] == 0x80 && t[2] == 0x80) ||
                (t[0] == 0xef && t[1] == 0xbb && t[2] == 0xbf); /* U+205F, 2060, 3000, FEFF */
    return wide ? 3 : 0;
}

bool haft_text_is_printable(uint32_t code) {
    return code >= 0x20 && !(code >= 0x7f && code < 0xa0) && code != 0x2028 && code != 0x2029 &&
           code != 0xfeff && (code & 0xfffe) != 0xfffe;
}

/* Marks that change the direction of the text after them. */
static bool turns_text(uint32_t code) {
    return (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

size_t haft_text_spell(char spelled[HAFT_SPELLED_CAPACITY], const char *text, size_t size) {
    uint32_t code = 0;
    size_t n = haft_text_character(text, size, &code);
    if (n > 0 && haft_text_is_printable(code) && !turns_text(code)) {
        memcpy(spelled, text, n);
        spelled[n] = '\0';
    } else if (n == 1 && (code == '\n' || code == '\r' || code == '\t')) {
        snprintf(spelled, HAFT_SPELLED_CAPACITY, "\\%c",
                 code == '\n'   ? 'n'
                 : code == '\r' ? 'r'
                                : 't');
    } else if (n > 1) {
        snprintf(spelled, HAFT_SPELLED_CAPACITY, code > 0xffff ? "\\U%06x" : "\\u%04x",
                 (unsigned)code);
    } else {
        n = size > 0;
        snprintf(spelled, HAFT_SPELLED_CAPACITY, "\\x%02x", n > 0 ? (unsigned char)text[0] : 0u);
    }
    return n;
}

bool haft_text_quote(char *out, size_t capacity, const char *text, size_t size) {
    char spelled[HAFT_SPELLED_CAPACITY];
    size_t used = 0;
    for (size_t at = 0; at < size;) {
        at += haft_text_spell(spelled, text + at, size - at);
        size_t n = strlen(spelled);
        if (n >= capacity - used) {
            out[used] = '\0';
            return false;
        }
        memcpy(out + used, spelled, n);
        used += n;
    }
    out[used] = '\0';
    return true;
}
