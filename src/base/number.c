/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decimal numbers in text. strtod() alone also accepts hexadecimal numbers, "inf" and "nan", and a
 * decimal comma in some locales. So the syntax is checked first, and the conversion uses the C
 * locale. */
#include "haft/base.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char DIGITS[] = "0123456789";

/* The number of characters of the decimal number at the start of `text`, 0 if there is none. *zero:
 * whether all its digits before the exponent are 0. */
static size_t measure(const char *text, bool *zero) {
    size_t n = *text == '+' || *text == '-';
    size_t first = n, whole = strspn(text + n, DIGITS);
    n += whole;
    size_t part = text[n] == '.' ? strspn(text + n + 1, DIGITS) : 0;
    if (whole + part == 0) {
        return 0;
    }
    n += text[n] == '.' ? part + 1 : 0;
    *zero = strspn(text + first, "0.") >= n - first;
    if (text[n] == 'e' || text[n] == 'E') {
        size_t sign = text[n + 1] == '+' || text[n + 1] == '-';
        size_t power = strspn(text + n + 1 + sign, DIGITS);
        n += power > 0 ? 1 + sign + power : 0;
    }
    return n;
}

size_t haft_number_scan(const char *text, double *value) {
    bool zero = false;
    size_t n = measure(text, &zero);
    if (n == 0) {
        return 0;
    }
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    locale_t kept = plain != (locale_t)0 ? uselocale(plain) : (locale_t)0;
    char *end = NULL;
    double number = strtod(text, &end);
    if (plain != (locale_t)0) {
        uselocale(kept);
        freelocale(plain);
    }
    /* An underflow is an error like an overflow: it would become a 0 that nobody wrote. */
    *value = end != text + n || (number == 0 && !zero) ? NAN : number;
    return n;
}

bool haft_number_read(const char *text, double *value) {
    text += strspn(text, " \t");
    double number = NAN;
    size_t n = haft_number_scan(text, &number);
    if (n == 0 || !isfinite(number) || text[n + strspn(text + n, " \t")] != '\0') {
        return false;
    }
    *value = number;
    return true;
}
